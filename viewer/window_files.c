/* The opened files of the window, read again when they are saved, and what it writes: commands and screenshots. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "state_scene.h"
#include "window_private.h"

static void hear_other(window_state *w)
{
    view_news news;
    shape_error error;
    if (!w->other_watch || !view_watch_take(w->other_watch, &news))
        return;
    memcpy(w->other_error, news.text, sizeof w->other_error);
    if (news.contents.set && window_take_other(w, news.contents.set, &error))
        snprintf(w->other_error, sizeof w->other_error, "%s", error.text);
    news.contents.set = NULL;           /* taken */
    view_contents_free(&news.contents); /* of another scene, light and things are not shown */
}

static void take_things(window_state *w, view_contents *contents)
{
    view_things *things = view_things_make(contents->opaque);
    contents->opaque = NULL;
    if (!things)
        return;
    view_things_drop(w->things);
    w->things = things;
    w->set_number++;
}

static void hear_own(window_state *w)
{
    view_news news;
    shape_error error;
    if (!w->watch || !view_watch_take(w->watch, &news))
        return;
    memcpy(w->error, news.text, sizeof w->error);
    if (!news.contents.set)
        return;
    view_state next;
    memcpy(&next, &w->base, sizeof next);
    view_state_take_set(&next, news.contents.set, &news.contents.used);
    if (news.contents.scene)
        view_state_load_edits(&next, news.contents.scene);
    view_state_merge(&w->state, &w->base, &next);
    view_history_merge(w->history, &w->base, &next);
    memcpy(w->base.clouds, next.clouds, sizeof next.clouds);
    if (next.generator.entry) /* as the file has it */
        memcpy(&w->base.generator, &next.generator, sizeof next.generator);
    w->base.cloud_count = next.cloud_count;
    w->read_ms = news.milliseconds;
    w->saved_ms = news.saved;
    w->saved_work = news.work;
    w->reload_ask = w->asks + 1;
    if (window_take_set(w, news.contents.set, &error))
        snprintf(w->error, sizeof w->error, "%s", error.text);
    news.contents.set = NULL; /* taken */
    if (news.contents.scene)
        window_take_scene(w, news.contents.scene);
    news.contents.scene = NULL; /* taken */
    if (news.contents.things_read)
        take_things(w, &news.contents);
    view_contents_free(&news.contents);
}

void window_hear_news(window_state *w)
{
    hear_own(w);
    hear_other(w);
    window_hear_opening(w);
}

void window_make_command(const window_state *w, const int size[2], bool alpha, char *text, size_t room)
{
    const view_command command = {.path = w->job->path,
                                  .morph = w->job->morph_path,
                                  .opening = w->job->opening,
                                  .things = w->job->things,
                                  .alpha = alpha,
                                  .paper_lod = w->job->options.paper_lod,
                                  .volume = w->job->volume_file,
                                  .scene = w->job->scene,
                                  .size = {size[0], size[1]},
                                  .seed = w->job->options.seed};
    view_command_write(&w->state, &w->base, &command, text, room);
}

/* A picture of what a scene cannot hold has the commands alone. */
void window_take_screenshot(window_state *w, const view_panel_wish *wish)
{
    char path[SHAPE_NAME_MAX + 32], command[8192];
    shape_error error;
    size_t length;
    window_free_name(w, wish->shoot_exr ? "exr" : "png", path, sizeof path);
    int size[2] = {wish->shoot_size[0], wish->shoot_size[1]};
    if (size[0] < 1 || size[1] < 1)
        glfwGetFramebufferSize(w->window, &size[0], &size[1]);
    window_make_command(w, size, wish->shoot_alpha, command, sizeof command);
    char *scene = window_scene_text(w, path, size, &length, &error);
    view_renderer_shoot(w->renderer, path, size[0], size[1], wish->shoot_alpha, command, scene);
}

void window_ask_generator(window_state *w)
{
    if (w->watch && w->state.generator.which >= 0 &&
        !view_generator_same(&w->state.generator, &w->asked.generator))
        view_watch_ask(w->watch, &w->state.generator);
}
