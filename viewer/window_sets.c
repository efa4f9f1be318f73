/* The clouds that the window shows: those of its file, and another file's in the right half. */
#include <stdio.h>

#include "window_private.h"

static size_t count_primitives(const shape_set *set)
{
    size_t count = 0;
    for (size_t i = 0; i < set->cloud_count; i++)
        count += shape_primitives_count(shape_set_list_const(set, i));
    return count;
}

shape_status window_take_set(window_state *w, shape_set *set, shape_error *error)
{
    view_shared *shared = view_shared_make(set);
    if (!shared)
        return shape_error_memory(error);
    view_shared_drop(w->set);
    w->set = shared;
    w->set_number++;
    w->primitives = count_primitives(set);
    return SHAPE_OK;
}

void window_open_other(window_state *w, const char *path)
{
    shape_error error;
    view_watch_leave(w->other_watch);
    w->other_watch = NULL;
    w->other_error[0] = 0;
    view_shared_drop(w->other_set);
    w->other_set = NULL;
    w->set_number++;
    snprintf(w->other_path, sizeof w->other_path, "%s", path);
    if (!path[0])
        return;
    view_generator generator = view_generator_of_path(path, w->job->seed);
    w->other_watch = view_watch_start(path, &generator, NULL, w->wake, &error);
    if (w->other_watch)
        view_watch_ask(w->other_watch, &generator);
    else
        snprintf(w->other_error, sizeof w->other_error, "%s", error.text);
    w->state.split = true;
    w->state.other_method = w->state.method;
}

shape_status window_take_other(window_state *w, shape_set *set, shape_error *error)
{
    view_shared *shared = view_shared_make(set);
    if (!shared)
        return shape_error_memory(error);
    view_shared_drop(w->other_set);
    w->other_set = shared;
    w->set_number++;
    return SHAPE_OK;
}
