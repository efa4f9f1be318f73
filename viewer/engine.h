/* engine.c: for the drawing thread alone: a set as it is seen, and one renderer with how far it is. */
#ifndef NEPHELE_VIEW_ENGINE_H
#define NEPHELE_VIEW_ENGINE_H

#include "render.h"
#include "things.h"

/* A set as it is seen, ready to be drawn. It goes with the last engine that has it. */
typedef struct view_scene {
    view_shared *placed;
    shape_volume *volume;
    int uses;
} view_scene;

/* Places the set as the state says, at the state's time. edited: by what was changed of the clouds, too. before: NULL, or what
 * was shown until now, whose clouds' boxes stay where they can (shape_volume_keep_boxes). */
shape_status view_scene_make(const view_state *state, view_shared *set, bool edited, const shape_morph *morph,
                             const view_scene *before, view_scene **made, shape_error *error);
void view_scene_drop(view_scene *scene); /* NULL is allowed */

/* One renderer and how far it is. Zeroed: none yet. */
typedef struct view_engine {
    shape_gl_renderer *gl;
    view_scene *scene; /* what it has loaded */
    view_things *things;
    int method, resolution;
    bool quick;      /* coarse grids, waited for; else fine ones, made on a thread by the default method */
    bool lit;        /* the scene is the present one, under the present light */
    double pixel_ms; /* of the last picture */
} view_engine;

/* Makes it ready for a scene under the state's light. */
shape_status view_engine_light(view_engine *engine, const shape_gl_options *usual, const view_state *state,
                               int method, view_scene *scene, view_things *things, shape_error *error);
/* Draws a sample; below 0: a picture of a view that moves. */
shape_status view_engine_draw(view_engine *engine, const view_state *state, int width, int height, int sample,
                              shape_error *error);
/* Tone-mapped, or as heat, into the framebuffer that is bound. */
void view_engine_show(const view_engine *engine, const view_state *state, int width, int height);
void view_engine_free(view_engine *engine);

#endif
