/* Points that keep their distance: where the clouds of a field stand (dart throwing: Cook, "Stochastic sampling in
 * computer graphics", 1986; the grid is that of Bridson, "Fast Poisson disk sampling in arbitrary dimensions", 2007). */
#ifndef SHAPE_SCATTER_H
#define SHAPE_SCATTER_H

#include <stddef.h>
#include <stdint.h>

#include "shape/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shape_point2 {
    double x, z;
} shape_point2;

enum { SHAPE_SCATTER_MAX = 100000 };

/* Fills points[0..count) with a Poisson-disk pattern in the rectangle width x depth [m] about the origin: no two
 * nearer than *spacing (may be NULL), which is chosen as large as `count` points allow (in steps of 5 %). One point
 * stands in the middle. The same arguments give the same points everywhere. Errors: count not 1 to
 * SHAPE_SCATTER_MAX, a side not 1e-3 to 1e9, memory. */
shape_status shape_scatter(size_t count, double width, double depth, uint64_t seed, shape_point2 *points,
                           double *spacing, shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
