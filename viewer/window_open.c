/* Another file in the place of the first: read on a thread, and shown when it is there. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "shape/combine.h"
#include "state_scene.h"
#include "window_private.h"

void window_open_file(window_state *w, const char *path)
{
    shape_error error;
    view_generator generator = view_generator_of_path(path, w->job->seed);
    view_watch_leave(w->opening);
    snprintf(w->opening_path, sizeof w->opening_path, "%s", path);
    w->opening = view_watch_start(w->opening_path, &generator, NULL, w->wake, &error);
    if (w->opening)
        view_watch_ask(w->opening, &generator);
    else
        snprintf(w->error, sizeof w->error, "%s", error.text);
}

/* Whatever the panel had set is gone; what a scene does not say is as a new window has it. */
static void begin_anew(window_state *w, const shape_set *set, const view_contents *contents)
{
    view_state *s = &w->state;
    shape_view view = view_state_view(s, w->asked_size[0], w->asked_size[1]);
    shape_light light;
    shape_dvec3 min = {-1, -1, -1}, max = {1, 1, 1};
    shape_error error;
    view_state_reset(s);
    if (contents->scene) {
        view_state_load_light(s, contents->scene);
        view_state_load_view(s, contents->scene, NULL, &error); /* it has been checked */
    }
    light = view_state_light(s);
    view.fov = s->fov;
    shape_set_bounds(set, &min, &max);
    shape_view_frame(&view, &light, min, max);
    if (!contents->scene || !contents->scene->eye_given)
        memcpy(s->eye, &view.eye, sizeof s->eye);
    if (!contents->scene || !contents->scene->target_given)
        memcpy(s->target, &view.target, sizeof s->target);
    view_state_take_set(s, set, &contents->used);
    memcpy(&w->asked.generator, &s->generator, sizeof s->generator); /* it has just been made by that */
    if (contents->scene)
        view_state_load_edits(s, contents->scene);
    view = view_state_view(s, 1, 1);
    w->camera = w->start = view_camera_start(&view, min, max);
    memcpy(&w->base, s, sizeof *s);
}

static void take_path(window_state *w)
{
    snprintf(w->own_path, sizeof w->own_path, "%s", w->opening_path);
    w->job->path = w->job->title = w->own_path;
    w->job->volume_file = false;
    w->job->morph_path = NULL;
    w->job->opening[0] = w->job->things[0] = 0;
    memset(&w->job->more, 0, sizeof w->job->more);
    w->watch = w->opening;
    w->opening = NULL;
}

static void show_opened(window_state *w, view_contents *contents)
{
    shape_error error;
    view_watch_leave(w->watch);
    take_path(w);
    w->error[0] = 0;
    begin_anew(w, contents->set, contents);
    if (window_take_set(w, contents->set, &error))
        snprintf(w->error, sizeof w->error, "%s", error.text);
    contents->set = NULL; /* taken */
    view_things_drop(w->things);
    w->things = view_things_make(contents->opaque);
    contents->opaque = NULL;
    w->job->scene = contents->scene != NULL;
    shape_scene_destroy(w->own_scene);
    w->scene = w->own_scene = contents->scene;
    contents->scene = NULL;
    view_history *fresh = view_history_create(&w->state);
    if (fresh) {
        view_history_destroy(w->history);
        w->history = fresh;
    }
    const char *compare = w->scene ? w->scene->compare : NULL;
    char *path = NULL;
    if (compare && shape_scene_find_file(w->job->path, compare, cli_outside_allowed(), &path, &error))
        window_say(w, error.text);
    bool split = w->state.split;
    window_open_other(w, path ? path : "");
    w->state.split = split;
    free(path);
}

void window_hear_opening(window_state *w)
{
    view_news news;
    if (!w->opening || !view_watch_take(w->opening, &news))
        return;
    if (news.contents.set) {
        show_opened(w, &news.contents);
        view_contents_free(&news.contents);
        return;
    }
    memcpy(w->error, news.text, sizeof w->error);
    view_watch_leave(w->opening);
    w->opening = NULL;
}
