/* A scene that has been saved by somebody: what changed in its light and camera changes in the window; what did not stays
 * as it was set there. */
#include <string.h>

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

static void take_light(window_state *w, const shape_scene *n)
{
    const shape_scene *o = &w->scene_was;
    static const double dark[3] = {0, 0, 0};
    if (is_new(n->sun_given, o->sun_given, n->sun, o->sun, sizeof n->sun)) {
        memcpy(w->state.sun, n->sun, sizeof n->sun);
        memcpy(w->base.sun, n->sun, sizeof n->sun);
    }
    if (n->sun_none && !o->sun_none)
        take_floats(dark, w->state.sun_irradiance, w->base.sun_irradiance);
    if (is_new(n->sun_irradiance_given, o->sun_irradiance_given, n->sun_irradiance, o->sun_irradiance,
               sizeof n->sun_irradiance))
        take_floats(n->sun_irradiance, w->state.sun_irradiance, w->base.sun_irradiance);
    if (is_new(n->sky_given, o->sky_given, &n->sky, &o->sky, sizeof n->sky) ||
        is_new(n->sky_given, o->sky_given, n->sky_radiance, o->sky_radiance, sizeof n->sky_radiance)) {
        w->state.sky = w->base.sky = n->sky;
        take_floats(n->sky_radiance, w->state.sky_radiance, w->base.sky_radiance);
    }
    if (n->air_given != o->air_given || n->visibility != o->visibility || n->air_height != o->air_height) {
        const shape_air air = {n->visibility, n->air_height};
        w->state.air = w->base.air = air;
    }
}

void window_take_scene(window_state *w, const shape_scene *n)
{
    const shape_scene *o = &w->scene_was;
    take_light(w, n);
    if (is_new(n->exposure_given, o->exposure_given, &n->exposure, &o->exposure, sizeof n->exposure))
        w->state.exposure = w->base.exposure = (float)n->exposure;
    if (is_new(n->fov_given, o->fov_given, &n->fov, &o->fov, sizeof n->fov))
        w->state.fov = w->base.fov = n->fov;
    /* The panel's way: settle_camera sees that they are not the camera's, and moves it. */
    if (is_new(n->eye_given, o->eye_given, n->eye, o->eye, sizeof n->eye))
        memcpy(w->state.eye, n->eye, sizeof n->eye);
    if (is_new(n->target_given, o->target_given, n->target, o->target, sizeof n->target))
        memcpy(w->state.target, n->target, sizeof n->target);
    w->scene_was = *n;
}
