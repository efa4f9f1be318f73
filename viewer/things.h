/* things.c: what is opaque, counted, since several threads look at it; and read again from its files without ending the
 * program where a file is wrong. */
#ifndef NEPHELE_VIEW_THINGS_H
#define NEPHELE_VIEW_THINGS_H

#include "shape/opaque.h"
#include "shape/scene.h"

typedef struct view_things view_things;

/* Takes the opaque over, which may be NULL: nothing is opaque. NULL where memory is out (it is destroyed). */
view_things *view_things_make(shape_opaque *opaque);
view_things *view_things_keep(view_things *things);             /* NULL is allowed */
void view_things_drop(view_things *things);                     /* NULL is allowed */
const shape_opaque *view_things_get(const view_things *things); /* NULL is allowed, and may come */

/* What besides the scene's meshes is opaque: --mesh and --ground. */
typedef struct view_more_things {
    const shape_scene *list; /* its meshes; their files are paths as they are. NULL: none */
    bool has_ground;
    double height;
    float ground_albedo[3];
} view_more_things;

/* Reads all of a scene's meshes (scene may be NULL) and more. outside: the scene may name files elsewhere. *opaque stays
 * NULL where there is nothing. */
shape_status view_things_read(const shape_scene *scene, const char *scene_path, bool outside,
                              const view_more_things *more, shape_opaque **opaque, shape_error *error);

#endif
