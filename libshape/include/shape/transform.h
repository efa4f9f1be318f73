/* Moving, turning, scaling and mirroring clouds. Translation, rotation, mirroring and equal scaling change a cloud's
 * frame alone, so its noise comes along and copies go on sharing their list; unequal scaling changes the primitives,
 * and spheres become ellipsoids. */
#ifndef SHAPE_TRANSFORM_H
#define SHAPE_TRANSFORM_H

#include "shape/set.h"

#ifdef __cplusplus
extern "C" {
#endif

/* In world space, about the pivot, in this order: scale, mirror, rotate, translate. */
typedef struct shape_transform {
    double scale[3];     /* factors along the world's axes, 1e-6 to 1e6; default 1 */
    bool mirror[3];      /* turn x, y, z round; default false */
    double rotate[3];    /* degrees about x, then y, then z; +-1e6; default 0 */
    double translate[3]; /* [m], +-1e12; default 0 */
    double pivot[3]; /* the point that scale, mirror and rotate leave where it is [m], +-1e12; default 0 */
    bool keep_depth; /* divide the extinction by the scale, so that the optical depth stays; default false */
} shape_transform;

shape_transform shape_transform_defaults(void);
/* Checks every member's range; the error names the member. */
shape_status shape_transform_check(const shape_transform *transform, shape_error *error);
/* The whole transformation as one placement. Multiples of 90 degrees turn exactly. */
shape_frame shape_transform_frame(const shape_transform *transform);

/* Applies it to the clouds whose `selected` is true (NULL: to all). With unequal factors the cloud's primitives are
 * mapped by L^-1 S L, where L is the frame's linear part and S the scale, about the frame's origin, and the field's
 * lengths are multiplied by the cube root of the three factors; keep_depth divides the extinction by that root. Lists that
 * unselected clouds share are copied first. Errors: the check's, memory, primitives or extinction that leave their
 * range; the set is then to be destroyed. */
shape_status shape_set_transform(shape_set *set, const bool *selected, const shape_transform *transform,
                                 shape_error *error);

/* Applies it to one cloud by its frame alone, which takes equal factors of scale (SHAPE_ERROR_ARGUMENT where they
 * differ). Errors: the check's too, and an extinction that leaves its range. */
shape_status shape_cloud_transform(shape_cloud *cloud, const shape_transform *transform, shape_error *error);

/* The image of an ellipsoid under a placement: exact, but for the single precision it is stored in. */
shape_ellipsoid shape_ellipsoid_transform(const shape_ellipsoid *ellipsoid, const shape_frame *map);
/* A sphere as the ellipsoid that it is. */
shape_ellipsoid shape_ellipsoid_from_sphere(const shape_sphere *sphere);
/* Maps a list's primitives. A similarity (equal scaling, rotation, mirroring) keeps spheres as spheres; any other map
 * makes every sphere an ellipsoid, in order, before those that are there. Errors: memory; a primitive whose size
 * leaves single precision (the list is then half done). */
shape_status shape_primitives_transform(shape_primitives *list, const shape_frame *map, shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
