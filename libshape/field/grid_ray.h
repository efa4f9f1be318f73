/* Private: the intervals of a ray through a voxel grid. */
#ifndef SHAPE_FIELD_GRID_RAY_H
#define SHAPE_FIELD_GRID_RAY_H

#include "shape/grid.h"
#include "shape/volume.h"

/* As shape_cloud_candidates, for a cloud of the model grid: a candidate for each run of bricks that hold anything. Their
 * u^2 does not grow, so that it tells "within the support" all along. */
shape_status grid_candidates(const shape_grid *grid, shape_ray ray, float t_min, float t_max,
                             shape_candidates *found, shape_error *error);

#endif
