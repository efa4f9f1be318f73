/* Triangles to ellipsoids: the construction of Jiménez 2018 section 3.6.4 with its rotation mended, a tighter fit, and
 * a measure that compares the two. */
#ifndef SHAPE_MESHFIT_H
#define SHAPE_MESHFIT_H

#include "shape/mesh.h"
#include "shape/set.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum shape_meshfit_kind {
    SHAPE_MESHFIT_PAPER = 0, /* Jiménez 2018 Eq. 22 to 30 */
    SHAPE_MESHFIT_UPRIGHT,   /* the same without the rotation: Eq. 22 to 24 */
    SHAPE_MESHFIT_PLANE      /* axes from the triangle's plane: Steiner's circumellipse, and a thickness */
} shape_meshfit_kind;

typedef struct shape_meshfit {
    shape_meshfit_kind kind; /* default SHAPE_MESHFIT_PAPER */
    double scale;            /* of Eq. 23, above 0, at most 100; default 1.1 */
    double thickness; /* PLANE: semi-axis across the plane, as a share of the geometric mean of the two in it,
                                0.001 to 10; default 0.3 */
} shape_meshfit;

shape_meshfit shape_meshfit_defaults(void);
/* Checks every member's range; the error names the member. */
shape_status shape_meshfit_check(const shape_meshfit *fit, shape_error *error);

/* No semi-axis is smaller than this share of the largest. The paper's radius is 0 where a corner lies on the
 * barycentre, and an ellipsoid needs three that are not. */
#define SHAPE_MESHFIT_THINNEST 1e-3

/* The ellipsoid of one triangle, centre at its barycentre. Finite for every finite triangle: also where the directions
 * of Eq. 27 are parallel or opposite, for equal radii, needles and collinear corners. False, with *ellipsoid untouched,
 * where the three corners are one point, or the numbers leave single precision. */
bool shape_meshfit_triangle(const shape_dvec3 corner[3], const shape_meshfit *fit,
                            shape_ellipsoid *ellipsoid);

/* Appends an ellipsoid for each triangle of the mesh. Errors: memory, options out of range, and SHAPE_ERROR_LIMIT
 * where no triangle gave one. */
shape_status shape_meshfit_add(const shape_mesh *mesh, const shape_meshfit *fit, shape_primitives *list,
                               shape_error *error);

/* How well primitives stand for a mesh. */
typedef struct shape_meshfit_measure {
    double covered; /* share of the mesh's surface that lies inside some primitive, 0 to 1 */
    double
        mean_sticking; /* mean distance of the primitives' surface from the mesh, as a share of the box's diagonal */
    double p95_sticking; /* 95 of 100 surface points lie nearer than this, same unit */
    double max_sticking;
} shape_meshfit_measure;

/* Samples `samples` points on the mesh (uniform by area) and 32 on each ellipsoid and sphere of the list, seeded, so
 * that the same input gives the same figures. Mesh and list in the same frame. Time grows as samples times primitives
 * plus primitives times triangles. Errors: memory; no triangles or no primitives. */
shape_status shape_meshfit_compare(const shape_mesh *mesh, const shape_primitives *list, size_t samples,
                                   shape_meshfit_measure *measure, shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
