/* Work that takes long: reading, deriving, picture files. It is done by other threads; here is what is said of it, and how
 * it is broken off. */
#include <stdio.h>

#include "window_private.h"

enum { MOMENT_MS = 300 }; /* shorter work is not worth a word */

/* It is done before there is any picture of the clouds. */
static const char light_work[] = "light and density";

static bool takes_long(view_watch *watch)
{
    return watch && view_watch_busy_for(watch) > MOMENT_MS;
}

const char *window_work(window_state *w, double *done)
{
    *done = -1;
    if (w->picture.shot_done >= 0) {
        *done = w->picture.shot_done;
        return "picture file";
    }
    if (takes_long(w->opening))
        return "opening the file";
    if (takes_long(w->watch))
        return "making the cloud anew";
    if (takes_long(w->other_watch))
        return "reading the right file";
    bool late = w->asks && w->picture.request < w->asks && glfwGetTime() - w->asked_at > MOMENT_MS / 1e3;
    return late && !w->picture.text_is_error ? light_work : NULL;
}

bool window_work_ends(window_state *w)
{
    double done;
    const char *what = window_work(w, &done);
    return what != NULL;
}

bool window_break_off(window_state *w)
{
    double done;
    const char *what = window_work(w, &done);
    char text[160];
    if (!what)
        return false;
    if (what == light_work) {
        view_renderer_break_off(w->renderer);
    } else if (done >= 0) {
        view_renderer_cancel(w->renderer);
        w->picture.shot_done = -1;
    } else if (takes_long(w->opening)) {
        view_watch_leave(w->opening);
        w->opening = NULL;
    } else {
        view_watch_cancel(takes_long(w->watch) ? w->watch : w->other_watch);
    }
    snprintf(text, sizeof text, "broken off: %s", what);
    window_say(w, text);
    cli_say("%s", text);
    return true;
}
