/* Private: mean densities of a light grid's cells. */
#ifndef SHAPE_LIGHT_LIGHTGRID_DENSITY_H
#define SHAPE_LIGHT_LIGHTGRID_DENSITY_H

#include "shape/lightgrid.h"

/* Fills grid->densities, which has room for them. change: NULL, or what has changed since they were filled last: only rows
 * that it touches are filled again. */
shape_status lightgrid_fill_densities(const shape_volume_cloud *cloud, const shape_lightgrid *grid,
                                      const shape_change *change, int threads, shape_stop stop,
                                      shape_error *error);

#endif
