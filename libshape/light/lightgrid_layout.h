/* Private: where the cells of a cloud's light grid lie. */
#ifndef SHAPE_LIGHT_LIGHTGRID_LAYOUT_H
#define SHAPE_LIGHT_LIGHTGRID_LAYOUT_H

#include "shape/lightgrid.h"

/* A grid of nearly cubic cells (flat ones for a thin layer) around the cloud's box and a cell more on every side, so that
 * its border is clear air. Fills box and size; takes no memory. */
void lightgrid_lay_out(const shape_volume_cloud *cloud, int resolution, shape_lightgrid *grid);
/* A point of a cell, at fx, fy, fz (0 to 1) of its edges, in the cloud's frame. */
shape_vec3 lightgrid_point(const shape_lightgrid *grid, int x, int y, int z, float fx, float fy, float fz);

#endif
