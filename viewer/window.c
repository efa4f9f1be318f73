/* The window: GLFW and input. It shows what the drawing thread has made, and never waits for it. */
#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "shape/combine.h"
#include "state_scene.h"
#include "window_private.h"

enum { PANEL_WIDTH = 700 }; /* a window narrower than this starts with the panel folded */

static double now_ms(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

/* --- the state --- */

static void copy_vector(double to[3], shape_dvec3 from)
{
    to[0] = from.x, to[1] = from.y, to[2] = from.z;
}

static bool is_at(const double v[3], shape_dvec3 p)
{
    return v[0] == p.x && v[1] == p.y && v[2] == p.z;
}

/* The camera to the state; or, where the panel has typed another eye or target, back. */
static void settle_camera(window_state *w, bool from_panel)
{
    shape_view view = view_state_view(&w->state, 1, 1);
    if (!from_panel || (is_at(w->state.eye, w->camera.eye) && is_at(w->state.target, w->camera.target))) {
        copy_vector(w->state.eye, w->camera.eye);
        copy_vector(w->state.target, w->camera.target);
        return;
    }
    double size = w->camera.size;
    view.eye = shape_dvec3_make(w->state.eye[0], w->state.eye[1], w->state.eye[2]);
    view.target = shape_dvec3_make(w->state.target[0], w->state.target[1], w->state.target[2]);
    if (shape_dvec3_length(shape_dvec3_sub(view.target, view.eye)) > 0) {
        w->camera = view_camera_start(&view, shape_dvec3_make(0, 0, 0), shape_dvec3_make(0, 0, 0));
        w->camera.size = size;
    }
}

static void begin_state(window_state *w)
{
    const view_job *job = w->job;
    view_state *s = &w->state;
    memcpy(s, job->state, sizeof *s);
    if (job->other_set && !job->scene_read) {
        s->split = true;
        s->other_method = s->method;
    }
    view_state_take_set(s, job->set, &job->generator);
    if (job->scene_read)
        view_state_load_edits(s, job->scene_read);
    memcpy(&w->base, s, sizeof *s);
    memcpy(&w->asked, s, sizeof *s);
}

static void obey(window_state *w, const view_panel_wish *wish)
{
    if (w->undo || wish->undo || w->redo || wish->redo)
        view_history_keep(w->history, &w->state); /* a change of this very moment can be undone too */
    if (w->undo || wish->undo)
        if (!view_history_undo(w->history, &w->state))
            window_say(w, "nothing to undo");
    if (w->redo || wish->redo)
        if (!view_history_redo(w->history, &w->state))
            window_say(w, "nothing to redo");
    if (w->home || wish->home)
        w->camera = w->start;
    if (wish->open_other)
        window_open_other(w, wish->other);
    if (wish->play)
        w->playing = !w->playing;
    if (w->shoot || wish->shoot)
        window_take_screenshot(w, wish);
    if (w->save || wish->save)
        window_save_scene(w, wish->save ? wish->file : "");
    if (wish->open_file || w->dropped[0])
        window_open_file(w, wish->open_file ? wish->file : w->dropped);
    w->dropped[0] = 0;
    if ((w->escape || wish->cancel) && !window_break_off(w) && w->escape)
        glfwSetWindowShouldClose(w->window, GLFW_TRUE);
    if (w->copy || wish->copy) {
        char command[8192];
        int size[2];
        glfwGetFramebufferSize(w->window, &size[0], &size[1]);
        window_make_command(w, size, false, command, sizeof command);
        glfwSetClipboardString(w->window, command);
        fputs(command, stderr);
        window_say(w, "copied, and written to standard error");
    }
    w->undo = w->redo = w->home = w->shoot = w->copy = w->save = w->escape = false;
}

/* Asks for a picture where anything is other than when one was asked for last. */
static void ask_picture(window_state *w)
{
    int width, height;
    glfwGetFramebufferSize(w->window, &width, &height);
    if (width < 1 || height < 1)
        return; /* minimised */
    bool same = w->asked_number == w->set_number && w->asked_size[0] == width && w->asked_size[1] == height &&
                !memcmp(&w->asked, &w->state, sizeof w->state);
    if (same)
        return;
    window_ask_generator(w);
    static view_request request;
    memcpy(&request.state, &w->state, sizeof request.state);
    request.width = width;
    request.height = height;
    request.number = ++w->asks;
    w->asked_at = glfwGetTime();
    const view_shown shown = {w->set, w->other_set, w->things};
    view_renderer_ask(w->renderer, &request, &shown);
    memcpy(&w->asked, &w->state, sizeof w->state);
    w->asked_size[0] = width;
    w->asked_size[1] = height;
    w->picture.done = false;
    w->asked_number = w->set_number;
}

/* --- a frame --- */

static void look_at_picture(window_state *w)
{
    view_picture picture;
    view_renderer_look(w->renderer, &picture);
    view_shared_drop(w->placed);
    w->placed = picture.placed;
    if (picture.number != w->picture.number) {
        /* A pass's time counts for the picture that it was made for, and the next ones show it no more. */
        const shape_gl_costs *is = &picture.costs, *was = &w->picture.costs;
        bool lit = is->lit_clouds != was->lit_clouds, baked = is->baked_clouds != was->baked_clouds;
        const double ms[VIEW_PASSES] = {picture.volume_ms != w->picture.volume_ms ? picture.volume_ms : 0,
                                        lit ? is->light_ms : 0, baked ? is->bake_ms : 0, picture.draw_ms};
        for (int i = 0; i < VIEW_PASSES; i++) {
            memmove(w->times[i], w->times[i] + 1, (VIEW_TIMES - 1) * sizeof *w->times[i]);
            w->times[i][VIEW_TIMES - 1] = (float)ms[i];
        }
    }
    if (strcmp(picture.text, w->picture.text) && !picture.text_is_error)
        window_say(w, picture.text);
    w->picture = picture;
}

/* The frame that has been presented is the first with a file that was saved. */
static void tell_reload(window_state *w)
{
    char text[128];
    if (!(w->saved_ms > 0) || w->picture.request < w->reload_ask)
        return;
    snprintf(text, sizeof text, "read again, shown after %.0f ms", now_ms() - w->saved_ms);
    window_say(w, text);
    cli_say("%s: %s (%.0f ms of the processors)", w->job->title, text, view_work_ms() - w->saved_work);
    w->saved_ms = 0;
}

static void show_title(window_state *w)
{
    char title[512];
    bool busy = !w->picture.done || w->opening || (w->watch && view_watch_is_busy(w->watch)) ||
                (w->other_watch && view_watch_is_busy(w->other_watch));
    snprintf(title, sizeof title, "%.440s - neph-view%s", w->job->title, busy ? " [working]" : "");
    if (strcmp(title, w->title))
        glfwSetWindowTitle(w->window, title);
    memcpy(w->title, title, sizeof title);
}

static void draw(window_state *w)
{
    int width, height;
    glfwGetFramebufferSize(w->window, &width, &height);
    if (width < 1 || height < 1)
        return;
    if (glfwGetTime() > w->said_until)
        w->said[0] = 0;
    const view_picture *p = &w->picture;
    char difference[384];
    window_describe_difference(w, difference, sizeof difference);
    double work_done;
    const char *work = window_work(w, &work_done);
    const view_panel_input input = {
        .work = work,
        .work_done = work_done,
        .chosen = w->job->chosen,
        .work_ends = window_work_ends(w),
        .longest_ms = w->pulse.longest,
        .state = &w->state,
        .base = &w->base,
        .texture = p->texture,
        .title = w->job->title,
        .doing = p->doing,
        .error = w->error[0]         ? w->error
                 : w->other_error[0] ? w->other_error
                 : p->text_is_error  ? p->text
                                     : "",
        .other = w->other_path,
        .difference = difference,
        .map = w->compared && w->difference.width ? w->map : 0,
        .map_size = {w->difference.width, w->difference.height},
        .map_scale = view_reference_scale(width, height),
        .said = w->said,
        .samples = p->samples,
        .draw_ms = p->draw_ms,
        .light_ms = p->costs.light_ms,
        .bake_ms = p->costs.bake_ms,
        .volume_ms = p->volume_ms,
        .read_ms = w->read_ms,
        .primitives = w->primitives,
        .all_clouds = view_shared_set(w->set)->cloud_count,
        .times = (const float(*)[VIEW_TIMES])w->times,
        .watched = w->watch != NULL,
        .open = w->open,
        .help = w->help,
        .playing = w->playing,
        .placed = w->placed ? view_shared_set(w->placed) : NULL,
    };
    window_clear(width, height);
    view_panel_wish wish = view_panel_draw(&input);
    settle_camera(w, true);
    window_pulse_step(&w->pulse, "draw the panel");
    obey(w, &wish);
    window_pulse_step(&w->pulse, "obey");
    glfwSwapBuffers(w->window); /* waits for the screen, and for a GPU that has other work */
    window_pulse_waited(&w->pulse);
}

/* Either thread may be the first to be told. */
static bool is_lost(const window_state *w)
{
    return w->picture.lost || shape_gl_is_lost();
}

/* Until it is closed, or its context is lost. */
static void run(window_state *w)
{
    w->last = glfwGetTime();
    bool pictured = false;
    for (int left = 3; !glfwWindowShouldClose(w->window) && !is_lost(w);) {
        /* ImGui wants a second frame and a third after an event; then there is nothing to draw until the next. */
        if (left > 0 || w->playing)
            glfwPollEvents();
        else
            glfwWaitEventsTimeout(0.5);
        left = left > 0 ? left - 1 : 2;
        window_pulse_begin(&w->pulse);
        double time = glfwGetTime(), passed = time - w->last;
        w->last = time;
        if (window_fly(w, passed))
            left = 3;
        if (w->playing)
            w->state.time += fmin(passed, 0.25);
        settle_camera(w, false);
        window_hear_news(w);
        window_pulse_step(&w->pulse, "take what was read");
        settle_camera(w, true); /* a scene may have another eye now */
        look_at_picture(w);
        window_compare(w);
        window_pulse_step(&w->pulse, "take the picture");
        settle_camera(w, false);
        draw(w);
        tell_reload(w);
        settle_camera(w, false);
        ask_picture(w);
        window_pulse_step(&w->pulse, "ask for a picture");
        show_title(w);
        if (!view_panel_is_busy() && !w->dragging && !w->looking && !w->splitting && !w->playing)
            view_history_keep(w->history, &w->state);
        window_pulse_step(&w->pulse, "keep for undo");
        window_pulse_end(&w->pulse, !pictured && w->picture.texture);
        pictured = w->picture.texture != 0;
    }
}

/* --- the beginning and the end --- */

static void make_current(void *context, bool current)
{
    glfwMakeContextCurrent(current ? context : NULL);
}

static void wake(void)
{
    glfwPostEmptyEvent();
}

static shape_status no_window(const char *what, shape_error *error)
{
    const char *why = NULL;
    glfwGetError(&why);
    return shape_error_set(error, SHAPE_ERROR_SYSTEM,
                           "%s: %s (write a picture with --headless -o cloud.png instead)", what,
                           why ? why : "no display");
}

static GLFWwindow *open_window(int width, int height, const char *title, GLFWwindow *share)
{
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET);
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    return glfwCreateWindow(width, height, title, NULL, share);
}

static shape_status copy_set(const shape_set *set, shape_set **made, shape_error *error)
{
    shape_set *copy = shape_set_create(error);
    if (!copy)
        return SHAPE_ERROR_MEMORY;
    shape_status status = shape_set_append(copy, set, error);
    if (status)
        shape_set_destroy(copy);
    else
        *made = copy;
    return status;
}

/* The second file of the command line. */
static shape_status start_other(window_state *w, shape_error *error)
{
    const view_job *job = w->job;
    shape_set *copy;
    shape_status status = copy_set(job->other_set, &copy, error);
    if (!status)
        status = window_take_other(w, copy, error);
    snprintf(w->other_path, sizeof w->other_path, "%s", job->other_path);
    if (!status && job->other_watched) {
        view_generator generator = view_generator_of_path(job->other_path, job->seed);
        w->other_watch = view_watch_start(job->other_path, &generator, NULL, wake, error);
        status = w->other_watch ? SHAPE_OK : error->status;
    }
    return status;
}

static shape_status start_files(window_state *w, shape_error *error)
{
    const view_job *job = w->job;
    shape_set *copy;
    shape_status status = copy_set(job->set, &copy, error);
    if (!status)
        status = window_take_set(w, copy, error);
    if (!status && job->other_set)
        status = start_other(w, error);
    if (status)
        return status;
    /* A morph's pairs are made once, of the file as it was opened; a volume is read once. */
    if ((!job->path[0] || view_watch_can(job->path)) && !job->morph && !job->volume_file) {
        w->watch = view_watch_start(job->path, &job->generator, &job->more, wake, error);
        if (!w->watch)
            return error->status;
    }
    w->history = view_history_create(&w->state);
    return w->history ? SHAPE_OK : shape_error_memory(error);
}

static void end_files(window_state *w)
{
    view_watch_stop(w->watch);
    view_watch_stop(w->other_watch);
    view_watch_stop(w->opening);
    view_history_destroy(w->history);
    view_shared_drop(w->other_set);
}

/* The window, not shown yet, and the drawing thread's. */
static shape_status open_windows(window_state *w, shape_error *error)
{
    int size[2] = {w->job->view.width, w->job->view.height};
    if (w->asked_size[0] > 0) /* another one in the place of one that was lost */
        memcpy(size, w->asked_size, sizeof size);
    w->window = open_window(size[0], size[1], w->title, NULL);
    if (!w->window)
        return no_window("no window with OpenGL 3.3", error);
    w->hidden = open_window(16, 16, "", w->window);
    if (!w->hidden)
        return no_window("no second OpenGL context", error);
    glfwMakeContextCurrent(w->window);
    glfwSwapInterval(1);
    window_listen(w);
    view_panel_start(w->window);
    w->panel_started = true;
    return SHAPE_OK;
}

static shape_status start_drawing(window_state *w, shape_error *error)
{
    const view_job *job = w->job;
    memset(&w->picture, 0, sizeof w->picture);
    w->picture.doing = "";
    w->picture.shot_done = -1;
    w->asked_size[0] = w->asked_size[1] = 0; /* ask anew */
    const view_render_start start = {job->options, job->morph, make_current, w->hidden, wake, job->largest};
    w->renderer = view_renderer_start(&start, error);
    return w->renderer ? SHAPE_OK : error->status;
}

static void end_drawing(window_state *w)
{
    window_stop_comparing(w);
    view_renderer_stop(w->renderer);
    view_shared_drop(w->placed);
    w->renderer = NULL;
    w->placed = NULL;
    if (w->panel_started)
        view_panel_stop();
    w->panel_started = false;
    if (w->hidden)
        glfwDestroyWindow(w->hidden);
    if (w->window)
        glfwDestroyWindow(w->window);
    w->window = w->hidden = NULL;
}

/* Reads the job's files and begins with what they say. */
static shape_status begin(window_state *w, shape_error *error)
{
    view_job *job = w->job;
    shape_dvec3 min = {-1, -1, -1}, max = {1, 1, 1};
    int width = job->view.width, height = job->view.height;
    int mistaken = window_read_files(w);
    if (mistaken) {
        end_drawing(w);
        glfwTerminate();
        exit(mistaken);
    }
    if (width != job->view.width || height != job->view.height)
        glfwSetWindowSize(w->window, job->view.width, job->view.height);
    shape_set_bounds(job->set, &min, &max);
    w->things = view_things_make(job->opaque);
    job->opaque = NULL; /* it goes with the last who looks at it */
    w->scene = job->scene_read;
    begin_state(w);
    w->camera = w->start = view_camera_start(&job->view, min, max);
    glfwGetWindowSize(w->window, &width, NULL);
    w->open = width >= PANEL_WIDTH;
    return start_files(w, error);
}

/* One window, to its end. *lost: its context was. */
static shape_status show(window_state *w, bool *lost, shape_error *error)
{
    shape_status status = open_windows(w, error);
    if (!w->set) {
        if (status)
            w->calls->read(w->calls->context); /* a file's mistakes come first */
        else
            status = begin(w, error);
    }
    if (!status)
        status = start_drawing(w, error);
    if (!status) {
        glfwShowWindow(w->window);
        run(w);
    }
    *lost = !status && !glfwWindowShouldClose(w->window);
    if (w->window && !*lost) {
        glfwHideWindow(w->window); /* what is being done may take a moment to end */
        glfwPollEvents();
    }
    int size[2] = {w->asked_size[0], w->asked_size[1]};
    end_drawing(w);
    memcpy(w->asked_size, size, sizeof size);
    return status;
}

/* A window whose context is lost is replaced by another that shows the same, a few times; a GPU that goes on losing them
 * cannot be drawn with. */
static shape_status show_on(window_state *w, shape_error *error)
{
    enum { TRIES = 5 };
    bool lost = false;
    for (int i = 0; i < TRIES; i++) {
        shape_status status = show(w, &lost, error);
        if (status || !lost)
            return status;
        cli_say("the OpenGL context was lost (the GPU was reset, or is gone); the window is opened anew");
        window_say(w, "the OpenGL context was lost; this is another one");
    }
    return shape_error_set(error, SHAPE_ERROR_SYSTEM,
                           "the OpenGL context was lost %d times (LIBGL_ALWAYS_SOFTWARE=1 lets Mesa draw "
                           "without the GPU)",
                           TRIES);
}

shape_status view_window(view_job *job, const view_window_calls *calls, shape_error *error)
{
    if (!glfwInit()) {
        calls->read(calls->context);
        return no_window("no window", error);
    }
    window_state *w = calloc(1, sizeof *w);
    if (!w) {
        glfwTerminate();
        return shape_error_memory(error);
    }
    w->job = job;
    w->calls = calls;
    w->wake = wake;
    w->picture.doing = "";
    snprintf(w->title, sizeof w->title, "%.440s - neph-view [working]", job->title);
    window_pulse_start(&w->pulse);
    shape_status status = show_on(w, error);
    end_files(w);
    window_pulse_say(&w->pulse);
    window_pulse_stop(&w->pulse);
    if (!status) {
        view_job last = *job; /* as the window was */
        last.state = &w->state;
        last.scene_read = w->scene;
        last.other_path = w->other_path;
        last.set = view_shared_set(w->set);
        last.view.width = w->asked_size[0];
        last.view.height = w->asked_size[1];
        calls->closed(&last);
    }
    view_shared_drop(w->set);
    shape_scene_destroy(w->own_scene);
    view_things_drop(w->things);
    free(w);
    glfwTerminate();
    return status;
}
