/* Private: the ellipsoid { centre + M v : |v| <= 1 } and its principal axes. */
#ifndef SHAPE_PRIMITIVE_AXES_H
#define SHAPE_PRIMITIVE_AXES_H

#include "shape/set.h"

/* Turns the columns of m into perpendicular ones that span the same ellipsoid: a one-sided Jacobi iteration (Hestenes
 * 1958), which finds the axes of flat and needle-like ellipsoids to full precision, where the eigenvalues of M M^T
 * would lose the small ones. Columns that are perpendicular already stay bit for bit. */
void shape_axes_diagonalize(shape_dvec3 m[3]);

/* R diag(a, b, c), its columns: the semi-axes as vectors. The quaternion is normalised in double precision. */
void shape_axes_of(const shape_ellipsoid *ellipsoid, shape_dvec3 m[3]);

/* A sphere as the ellipsoid that it is. */
shape_ellipsoid shape_axes_sphere(const shape_sphere *sphere);

#endif
