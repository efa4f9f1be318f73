/* One renderer of the drawing thread: what it has loaded, under which light, and how long its pictures take. */
#include "engine.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "lighting.h"

enum { QUICK_LIGHT = 14, QUICK_VOXELS = 250000 };

static double now_ms(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

shape_status view_scene_make(const view_state *state, view_shared *set, bool edited, const shape_morph *morph,
                             const view_scene *before, view_scene **made, shape_error *error)
{
    shape_set *placed;
    view_scene *scene = calloc(1, sizeof *scene);
    view_state *as_it_is = malloc(sizeof *as_it_is);
    if (!scene || !as_it_is) {
        free(scene);
        free(as_it_is);
        return shape_error_memory(error);
    }
    memcpy(as_it_is, state, sizeof *state);
    if (!edited)
        as_it_is->cloud_count = 0;
    scene->uses = 1;
    shape_status status = view_state_set(as_it_is, view_shared_set(set), morph, &placed, error);
    free(as_it_is);
    if (!status) {
        scene->placed = view_shared_make(placed);
        status =
            scene->placed ? shape_volume_create(placed, &scene->volume, error) : shape_error_memory(error);
    }
    if (!status && before)
        shape_volume_keep_boxes(scene->volume, before->volume);
    if (status)
        view_scene_drop(scene);
    else
        *made = scene;
    return status;
}

void view_scene_drop(view_scene *scene)
{
    if (!scene || --scene->uses)
        return;
    shape_volume_destroy(scene->volume);
    view_shared_drop(scene->placed);
    free(scene);
}

void view_engine_free(view_engine *e)
{
    bool quick = e->quick;
    shape_gl_destroy(e->gl);
    view_scene_drop(e->scene);
    view_things_drop(e->things);
    memset(e, 0, sizeof *e);
    e->quick = quick;
}

static shape_status create(view_engine *e, const shape_gl_options *usual, const shape_gl_lighting *lighting,
                           shape_error *error)
{
    shape_gl_options options = *usual;
    options.method = (shape_gl_method)e->method;
    options.light.resolution = e->resolution;
    options.lighting = *lighting;
    options.light.opaque = view_things_get(e->things);
    options.background = !e->quick;
    options.early = true;
    if (e->quick)
        options.bake_voxels = QUICK_VOXELS;
    return shape_gl_create(&options, &e->gl, error);
}

shape_status view_engine_light(view_engine *e, const shape_gl_options *usual, const view_state *state,
                               int method, view_scene *scene, view_things *things, shape_error *error)
{
    int resolution = e->quick ? QUICK_LIGHT : state->light_grid;
    shape_gl_lighting lighting = view_lighting_gl(&state->lighting);
    shape_status status = SHAPE_OK;
    if (e->gl && (e->method != method || e->resolution != resolution || e->things != things))
        view_engine_free(e);
    if (e->lit)
        return SHAPE_OK;
    e->method = method;
    e->resolution = resolution;
    if (!e->gl && !e->things)
        e->things = view_things_keep(things);
    if (!e->gl)
        status = create(e, usual, &lighting, error);
    shape_light light = view_state_light(state);
    if (!status && e->scene != scene) {
        status = shape_gl_load(e->gl, scene->volume, error);
        view_scene_drop(e->scene);
        e->scene = scene;
        scene->uses++;
    }
    if (!status)
        status = shape_gl_set_lighting(e->gl, &lighting, error);
    if (!status)
        status = shape_gl_light(e->gl, &light, error);
    if (status)
        view_engine_free(e);
    else
        e->lit = true;
    return status;
}

shape_status view_engine_draw(view_engine *e, const view_state *state, int width, int height, int sample,
                              shape_error *error)
{
    shape_view view = view_state_view(state, width, height);
    bool moving = sample < 0;
    double start = now_ms();
    shape_status status =
        moving ? shape_gl_draw_moving(e->gl, &view, error) : shape_gl_draw(e->gl, &view, sample, error);
    shape_gl_finish();
    if (moving && e->pixel_ms > 0)
        e->pixel_ms = fmax(now_ms() - start, 0.1) / ((double)width * (double)height);
    else if (moving)
        e->pixel_ms = 1e-9; /* the first one made grids too, and tells nothing */
    return status;
}

void view_engine_show(const view_engine *e, const view_state *state, int width, int height)
{
    static const struct {
        shape_gl_heat kind;
        float full;
    } maps[VIEW_HEATS] = {[VIEW_HEAT_STEPS] = {SHAPE_GL_HEAT_STEPS, 64},
                          [VIEW_HEAT_FETCHES] = {SHAPE_GL_HEAT_FETCHES, 128},
                          [VIEW_HEAT_CANDIDATES] = {SHAPE_GL_HEAT_CANDIDATES, 32},
                          [VIEW_HEAT_DEPTH] = {SHAPE_GL_HEAT_DEPTH, 5}};
    if (state->heat == VIEW_HEAT_NONE)
        shape_gl_show(e->gl, state->exposure, width, height);
    else
        shape_gl_show_heat(e->gl, maps[state->heat].kind, maps[state->heat].full, width, height);
}
