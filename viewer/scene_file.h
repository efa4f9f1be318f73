/* scene_file.c: the scene of what is seen, for a file: what made the clouds, what was changed of them, light, camera, view. */
#ifndef NEPHELE_VIEW_SCENE_FILE_H
#define NEPHELE_VIEW_SCENE_FILE_H

#include "state.h"
#include "things.h"

/* What a scene is written of. */
typedef struct view_scene_parts {
    const view_state *state;
    const shape_set *made;    /* the clouds without edits */
    const shape_scene *scene; /* that was opened; NULL */
    const char *path;         /* of what was opened; "" where a generator takes nothing */
    bool volume;
    const view_more_things *more; /* of the command line; NULL */
    const char *other;            /* the file right of the line; "" or NULL: none */
    int size[2];                  /* pixels */
} view_scene_parts;

/* The scene as JSON, its files named as seen from the folder of `target`, where it will lie. *outside tells that one of them
 * lies outside that folder, so that it can be opened with --allow-outside only. The caller frees *text. Errors: standard
 * input, volumes, which a scene cannot name; memory. */
shape_status view_scene_text(const view_scene_parts *parts, const char *target, char **text, size_t *size,
                             bool *outside, shape_error *error);

#endif
