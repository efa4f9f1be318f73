/* Opaque things in the picture: triangles that end rays, throw shadows into clouds and catch the clouds' shadows. Their
 * surface is matt (Lambert 1760), of one colour a mesh, alike on both sides. */
#ifndef SHAPE_OPAQUE_H
#define SHAPE_OPAQUE_H

#include "shape/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Triangles in a tree of boxes. Opaque; reading it is thread-safe once it is finished. */
typedef struct shape_opaque shape_opaque;

/* An empty one, which stops nothing. The caller destroys it; NULL and *error where memory is out. */
shape_opaque *shape_opaque_create(shape_error *error);
void shape_opaque_destroy(shape_opaque *opaque); /* NULL is allowed */

/* Adds a copy of a mesh, placed by the frame (NULL: where it is), which may be thrown away then. albedo: the share of
 * light that comes back, red, green, blue, 0 to 1. Triangles without area are left out. Errors: an albedo out of range or a
 * point that is not finite (SHAPE_ERROR_ARGUMENT), more than 2^25 triangles (SHAPE_ERROR_LIMIT), memory. */
shape_status shape_opaque_add(shape_opaque *opaque, const shape_mesh *mesh, const shape_frame *frame,
                              const float albedo[3], shape_error *error);
/* Adds level ground at a height [m, world] as far as the eye reaches: a square of SHAPE_OPAQUE_GROUND_SIDE around the
 * vertical axis. One is enough; a second replaces nothing and lies above or below. Errors as of shape_opaque_add. */
#define SHAPE_OPAQUE_GROUND_SIDE 2e6 /* metres */
shape_status shape_opaque_add_ground(shape_opaque *opaque, double height, const float albedo[3],
                                     shape_error *error);
/* Builds the tree; after the last mesh, before the first ray. Adding more afterwards needs another call. */
shape_status shape_opaque_finish(shape_opaque *opaque, shape_error *error);

size_t shape_opaque_triangle_count(const shape_opaque *opaque);
/* One triangle, in the order of the tree: for programs that draw them. */
typedef struct shape_opaque_triangle {
    shape_dvec3 corner[3]; /* metres, world */
    const float *albedo;   /* red, green, blue; lives as long as the opaque */
    bool ground;           /* of shape_opaque_add_ground */
} shape_opaque_triangle;
/* Number index of shape_opaque_triangle_count. */
shape_opaque_triangle shape_opaque_get_triangle(const shape_opaque *opaque, size_t index);

/* The box around all triangles [m, world]; false where there are none. */
bool shape_opaque_bounds(const shape_opaque *opaque, shape_dvec3 *min, shape_dvec3 *max);

typedef struct shape_opaque_hit {
    double t;           /* distance along the ray [m] */
    shape_dvec3 point;  /* off the surface by a hair, on the ray's side: where the next ray begins */
    shape_dvec3 normal; /* of the triangle, unit, towards the ray's side */
    const float *albedo;
} shape_opaque_hit;

/* The nearest triangle that the ray meets between 0 and t_max [m, may be infinite]. direction is a unit vector. Watertight:
 * no ray slips through an edge that two triangles share (Woop, Benthin and Wald 2013). opaque may be NULL: nothing is
 * met. */
bool shape_opaque_find(const shape_opaque *opaque, shape_dvec3 origin, shape_dvec3 direction, double t_max,
                       shape_opaque_hit *hit);
/* Whether it meets any. */
bool shape_opaque_blocks(const shape_opaque *opaque, shape_dvec3 origin, shape_dvec3 direction, double t_max);

#ifdef __cplusplus
}
#endif
#endif
