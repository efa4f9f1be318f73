/* The window while the first files are read, on a thread of their own: what takes no longer than a moment is waited for
 * before the window is shown, so that a file with mistakes shows none; anything longer has a bar, and Esc ends the program. */
#include <epoxy/gl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "window_private.h"

enum { MOMENT_MS = 100, LOOK_MS = 40 };

typedef struct reading {
    const view_window_calls *calls;
    void (*wake)(void);
    pthread_mutex_t mutex;
    bool done, failed; /* under the mutex; failed: the program is to end with the code */
    int code;
} reading;

/* One process has one; cli_before_end knows no other way. */
static reading first = {.mutex = PTHREAD_MUTEX_INITIALIZER};
static _Thread_local bool is_reader;

static void tell(bool failed, int code)
{
    pthread_mutex_lock(&first.mutex);
    first.done = true;
    first.failed = failed;
    first.code = code;
    pthread_mutex_unlock(&first.mutex);
    first.wake();
}

/* A mistake has been said. The window's thread ends the program, since OpenGL's memory is not to go while it is drawn with. */
static void end_here(int code)
{
    if (!is_reader)
        return;
    tell(true, code);
    for (;;)
        pause();
}

static void *read_thread(void *unused)
{
    is_reader = true;
    first.calls->read(first.calls->context);
    tell(false, 0);
    return unused;
}

static bool is_done(bool *failed)
{
    pthread_mutex_lock(&first.mutex);
    bool done = first.done;
    *failed = first.failed;
    pthread_mutex_unlock(&first.mutex);
    return done;
}

/* The bar; whether the reading is to be broken off. */
static bool draw_bar(window_state *w)
{
    int width, height;
    char text[200];
    glfwGetFramebufferSize(w->window, &width, &height);
    if (width < 1 || height < 1)
        return w->escape;
    snprintf(text, sizeof text, "reading %.180s", w->job->title);
    const view_panel_input input = {.work = text,
                                    .work_done = -1,
                                    .work_ends = true,
                                    .state = &w->state,
                                    .base = &w->base,
                                    .title = w->job->title,
                                    .doing = "",
                                    .error = "",
                                    .said = "",
                                    .difference = "",
                                    .chosen = "",
                                    .other = "",
                                    .help = w->help};
    window_clear(width, height);
    view_panel_wish wish = view_panel_draw(&input);
    window_pulse_step(&w->pulse, "draw the bar");
    glfwSwapBuffers(w->window);
    window_pulse_waited(&w->pulse);
    return w->escape || wish.cancel;
}

/* The user would rather not wait. Nothing waits for the thread either: what it reads may never end. */
static void leave(const window_state *w)
{
    glfwHideWindow(w->window);
    glfwPollEvents();
    if (cli_save_wanted())
        cli_error("--save-scene: %s was not read to its end (nothing was written)", w->job->title);
    _exit(cli_save_wanted() ? CLI_FAILED : CLI_DONE);
}

static int wait_for_files(window_state *w)
{
    bool failed, shown = false;
    double start = glfwGetTime();
    while (!is_done(&failed)) {
        glfwWaitEventsTimeout((shown ? LOOK_MS : MOMENT_MS) / 1e3);
        window_pulse_begin(&w->pulse);
        if (!shown && (glfwGetTime() - start) * 1e3 < MOMENT_MS)
            continue;
        if (!shown)
            glfwShowWindow(w->window);
        shown = true;
        if (draw_bar(w) || glfwWindowShouldClose(w->window))
            leave(w);
        window_pulse_end(&w->pulse, false);
    }
    w->undo = w->redo = w->home = w->shoot = w->copy = w->save = w->escape = false;
    return failed ? first.code : 0;
}

int window_read_files(window_state *w)
{
    pthread_t thread;
    first.calls = w->calls;
    first.wake = w->wake;
    cli_before_end(end_here);
    if (pthread_create(&thread, NULL, read_thread, NULL)) {
        cli_before_end(NULL);
        w->calls->read(w->calls->context); /* without a thread it is only not seen */
        return 0;
    }
    int code = wait_for_files(w);
    if (!code) { /* else it waits for the end */
        pthread_join(thread, NULL);
        cli_before_end(NULL);
    }
    return code;
}
