/* Private: which points are nearest to a point, by a k-d tree (Bentley 1975). */
#ifndef SHAPE_BUDGET_NEAREST_H
#define SHAPE_BUDGET_NEAREST_H

#include <stddef.h>
#include <stdint.h>

#include "shape/status.h"
#include "shape/vector.h"

/* A balanced tree in an array: the middle of a range divides it, along the axis where the range is widest. */
typedef struct budget_nearest {
    const shape_dvec3 *points; /* the caller's */
    uint32_t *order;
    unsigned char *axis;
    size_t count;
} budget_nearest;

/* Builds the tree over the points whose numbers are given; of equal coordinates the lower number comes first. */
shape_status budget_nearest_build(budget_nearest *tree, const shape_dvec3 *points, const uint32_t *numbers,
                                  size_t count, shape_error *error);
void budget_nearest_free(budget_nearest *tree);
/* Finds up to `wanted` (at most 16) points nearest to point `number`, itself left out; returns how many. */
size_t budget_nearest_find(const budget_nearest *tree, uint32_t number, size_t wanted, uint32_t *found);

#endif
