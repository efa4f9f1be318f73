/* state_scene.c: what can be set in the window as a scene holds it (docs/scene.md), and back. */
#ifndef NEPHELE_VIEW_STATE_SCENE_H
#define NEPHELE_VIEW_STATE_SCENE_H

#include "shape/scene.h"
#include "state.h"

/* What the state is where a scene says nothing: the defaults of the command line, and no cloud. */
void view_state_reset(view_state *state);

/* Puts the state into a scene: light, camera, exposure, "view" and "edits", in place of what it had. made: the clouds as
 * the scene's files and generators make them, without edits. Of the camera it is the one at time 0. */
shape_status view_state_save(const view_state *state, const shape_set *made, shape_scene *scene,
                             shape_error *error);

/* The double of the fewest digits that is that float: 0.1, where the float itself is 0.100000001490116. */
double view_neat(float value);

/* Takes over what "view" says, but for the names that `given` returns true for (NULL: none). Errors: the name and what
 * is wrong; the state then has some of it. */
shape_status view_state_load_view(view_state *state, const shape_scene *scene,
                                  bool (*given)(const char *name), shape_error *error);
/* Checks it and changes nothing. */
shape_status view_state_check_view(const shape_scene *scene, shape_error *error);
/* Takes over light, camera and exposure, as far as the scene has any. */
void view_state_load_light(view_state *state, const shape_scene *scene);
/* Takes over the edits, which have been checked, of the clouds that the state has. */
void view_state_load_edits(view_state *state, const shape_scene *scene);

#endif
