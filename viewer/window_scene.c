/* A scene that has been saved by somebody: what changed in its light, camera and view changes in the window; what did not
 * stays as it was set there. And the scene of what is seen, for saving. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene_file.h"
#include "shape/file.h"
#include "state_scene.h"

#include "window_private.h"

/* Whether a value is in the new file and was not, or was another, in the old one. */
static bool is_new(bool given, bool was_given, const void *value, const void *was, size_t size)
{
    return given && (!was_given || memcmp(value, was, size));
}

static void take_floats(const double from[3], float to[3], float base[3])
{
    for (int i = 0; i < 3; i++)
        to[i] = base[i] = (float)from[i];
}

static void take_light(window_state *w, const shape_scene *n, const shape_scene *o)
{
    static const double dark[3] = {0, 0, 0};
    view_state *s = &w->state, *b = &w->base;
    if (is_new(n->sun_given, o->sun_given, n->sun, o->sun, sizeof n->sun)) {
        memcpy(s->sun, n->sun, sizeof n->sun);
        memcpy(b->sun, n->sun, sizeof n->sun);
    }
    if (n->day_given != o->day_given || is_new(n->day_given, o->day_given, &n->day, &o->day, sizeof n->day)) {
        s->course.day_runs = b->course.day_runs = n->day_given;
        if (n->day_given)
            s->course.day = b->course.day = n->day;
    }
    if (n->sun_none && !o->sun_none)
        take_floats(dark, s->sun_irradiance, b->sun_irradiance);
    if (is_new(n->sun_irradiance_given, o->sun_irradiance_given, n->sun_irradiance, o->sun_irradiance,
               sizeof n->sun_irradiance))
        take_floats(n->sun_irradiance, s->sun_irradiance, b->sun_irradiance);
    if (is_new(n->sky_given, o->sky_given, &n->sky, &o->sky, sizeof n->sky) ||
        is_new(n->sky_given, o->sky_given, n->sky_radiance, o->sky_radiance, sizeof n->sky_radiance)) {
        s->sky = b->sky = n->sky;
        take_floats(n->sky_radiance, s->sky_radiance, b->sky_radiance);
    }
    if (n->air_given != o->air_given || n->visibility != o->visibility || n->air_height != o->air_height) {
        const shape_air air = {n->visibility, n->air_height};
        w->state.air = w->base.air = air;
    }
}

static void take_camera(window_state *w, const shape_scene *n, const shape_scene *o)
{
    if (is_new(n->exposure_given, o->exposure_given, &n->exposure, &o->exposure, sizeof n->exposure))
        w->state.exposure = w->base.exposure = (float)n->exposure;
    if (is_new(n->fov_given, o->fov_given, &n->fov, &o->fov, sizeof n->fov))
        w->state.fov = w->base.fov = n->fov;
    /* The panel's way: settle_camera sees that they are not the camera's, and moves it. */
    if (is_new(n->eye_given, o->eye_given, n->eye, o->eye, sizeof n->eye))
        memcpy(w->state.eye, n->eye, sizeof n->eye);
    if (is_new(n->target_given, o->target_given, n->target, o->target, sizeof n->target))
        memcpy(w->state.target, n->target, sizeof n->target);
}

static bool same_options(const shape_scene_options *a, const shape_scene_options *b)
{
    bool same = a->count == b->count;
    for (size_t i = 0; i < a->count && same; i++) {
        const char *s = a->items[i].text, *t = b->items[i].text;
        same = !strcmp(a->items[i].name, b->items[i].name) && !s == !t && (!s || !strcmp(s, t));
    }
    return same;
}

void window_take_scene(window_state *w, shape_scene *n)
{
    static const shape_scene none;
    const shape_scene *o = w->scene ? w->scene : &none;
    shape_error error;
    take_light(w, n, o);
    take_camera(w, n, o);
    if (!same_options(&n->view, &o->view)) {
        view_state_load_view(&w->state, n, NULL, &error); /* it has been checked */
        view_state_load_view(&w->base, n, NULL, &error);
    }
    shape_scene_destroy(w->own_scene);
    w->scene = w->own_scene = n;
}

/* --- saving --- */

char *window_scene_text(window_state *w, const char *target, const int size[2], size_t *length,
                        shape_error *error)
{
    char *text;
    bool outside;
    const view_scene_parts parts = {.state = &w->state,
                                    .made = view_shared_set(w->set),
                                    .scene = w->scene,
                                    .path = w->job->path,
                                    .volume = w->job->volume_file,
                                    .more = &w->job->more,
                                    .other = w->other_path,
                                    .size = {size[0], size[1]}};
    return view_scene_text(&parts, target, &text, length, &outside, error) ? NULL : text;
}

void window_save_scene(window_state *w, const char *path)
{
    char name[VIEW_PATH_MAX], said[600];
    shape_error error;
    int size[2];
    size_t length;
    snprintf(name, sizeof name, "%s", path);
    if (!path[0])
        window_free_name(w, "json", name, sizeof name);
    glfwGetFramebufferSize(w->window, &size[0], &size[1]);
    char *text = window_scene_text(w, name, size, &length, &error);
    bool wrote = text && !shape_file_write(name, text, length, &error);
    free(text);
    if (wrote)
        snprintf(said, sizeof said, "wrote %.480s", name);
    else
        snprintf(said, sizeof said, "scene: %.480s", error.text);
    window_say(w, said);
    cli_say("%s", said);
}
