/* Private: the intervals of a ray through a voxel grid. */
#ifndef SHAPE_FIELD_GRID_RAY_H
#define SHAPE_FIELD_GRID_RAY_H

#include "shape/grid.h"
#include "shape/volume.h"

/* As shape_cloud_candidates, for a cloud of the model grid: a candidate for each run of bricks that hold anything. Their
 * u^2 does not grow, so that it tells "within the support" all along. */
shape_status grid_candidates(const shape_grid *grid, shape_ray ray, float t_min, float t_max,
                             shape_candidates *found, shape_error *error);

/* A direction in which many rays go through a grid, made ready: towards the sun. */
typedef struct grid_way {
    const shape_grid *grid;
    shape_vec3 direction; /* voxels a unit of t */
    double inverse[3], delta[3];
} grid_way;

grid_way grid_way_make(const shape_grid *grid, shape_vec3 direction);

/* The integral of density over t along that way: cell by cell where a step of t is at most a voxel, else by such steps,
 * seen from their middles, that begin where bricks do that hold anything. It ends where the sum passes `enough`. */
double grid_way_depth(const grid_way *way, shape_vec3 from, float step, double enough);

#endif
