/* shot.c: a picture file of what the window shows. */
#ifndef NEPHELE_VIEW_SHOT_H
#define NEPHELE_VIEW_SHOT_H

#include "shape_gl.h"
#include "state.h"

typedef struct view_shot {
    char path[4096], comment[8192]; /* comment: kept in the file as the text "nephele" */
    char *scene;                    /* kept as SHAPE_SCENE_PICTURE_KEY; NULL: none. The renderer frees it */
    int width, height;
    int largest; /* side of what is drawn at once; 0: what the GPU can */
    bool alpha;
} view_shot;

/* Draws all samples and writes the file; the format is that of the path's suffix. The volume is that of the state. An
 * OpenGL context is current. go_on is told the share of the work that is done, and ends it by false; SHAPE_ERROR_LIMIT. */
shape_status view_shot_take(const view_shot *shot, const view_state *state, const shape_volume *volume,
                            const shape_gl_options *options, shape_progress go_on, void *context,
                            shape_error *error);

#endif
