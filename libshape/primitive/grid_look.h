/* Private: a look at a voxel grid, inlined into the loops that live on it. The same numbers as shape_grid_sample's. */
#ifndef SHAPE_PRIMITIVE_GRID_LOOK_H
#define SHAPE_PRIMITIVE_GRID_LOOK_H

#include "shape/grid.h"

/* Which brick of `values`; 0: the empty one. x, y, z count bricks. */
static inline size_t grid_brick(const shape_grid *grid, unsigned x, unsigned y, unsigned z)
{
    return grid->table[((size_t)z * (size_t)grid->bricks[1] + y) * (size_t)grid->bricks[0] + x];
}

static inline float grid_mix(float a, float b, float t)
{
    return a + (b - a) * t;
}

/* Trilinear from the cell's lowest corner; never beyond the eight values by more than rounding. */
static inline float grid_in_cell(const float *v, float x, float y, float z)
{
    const float *w = v + SHAPE_GRID_SIDE * SHAPE_GRID_SIDE;
    float a = grid_mix(grid_mix(v[0], v[1], x), grid_mix(v[SHAPE_GRID_SIDE], v[SHAPE_GRID_SIDE + 1], x), y);
    float b = grid_mix(grid_mix(w[0], w[1], x), grid_mix(w[SHAPE_GRID_SIDE], w[SHAPE_GRID_SIDE + 1], x), y);
    return grid_mix(a, b, z);
}

/* The lowest corner of the cell that a place is in, and which cell; NULL where its part of the brick holds nothing. */
static inline const float *grid_find(const shape_grid *grid, float px, float py, float pz, unsigned cell[3])
{
    if (!(px >= 0 && py >= 0 && pz >= 0 && px < (float)(grid->points[0] - 1) &&
          py < (float)(grid->points[1] - 1) && pz < (float)(grid->points[2] - 1)))
        return NULL;
    unsigned x = (unsigned)px, y = (unsigned)py, z = (unsigned)pz, b = SHAPE_GRID_BRICK;
    size_t brick = grid_brick(grid, x / b, y / b, z / b);
    /* The empty brick has no filled part. */
    if (!(grid->filled[brick] >> ((z % b / 2 * 4 + y % b / 2) * 4 + x % b / 2) & 1))
        return NULL;
    cell[0] = x, cell[1] = y, cell[2] = z;
    return grid->values + brick * SHAPE_GRID_BRICK_POINTS +
           ((z % b) * SHAPE_GRID_SIDE + y % b) * SHAPE_GRID_SIDE + x % b;
}

/* The value at a place [voxels], times the gain. */
static inline float grid_look(const shape_grid *grid, float x, float y, float z)
{
    unsigned cell[3];
    const float *v = grid_find(grid, x, y, z, cell);
    return v ? grid->gain * grid_in_cell(v, x - (float)cell[0], y - (float)cell[1], z - (float)cell[2]) : 0;
}

#endif
