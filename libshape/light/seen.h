/* Private: a light grid's cells as one eye sees them. */
#ifndef SHAPE_LIGHT_SEEN_H
#define SHAPE_LIGHT_SEEN_H

#include "shape/lightgrid.h"

/* A grid and an eye. */
typedef struct seen_grid {
    const shape_lightgrid *grid;
    const shape_volume_cloud *cloud;
    const shape_sky *sky;
    shape_vec3 eye, edge; /* the eye, and a cell's edges; cloud's frame */
    int turn[3];          /* along each axis the first cell whose middle is not before the eye's */
    float peak;           /* share of scattering that goes straight on */
    bool swept;           /* light is followed to the eye */
} seen_grid;

/* A cell from the eye. */
typedef struct seen_cell {
    shape_vec3 v;     /* from the eye to the middle, cloud's frame */
    shape_vec3 world; /* the same, unit, world */
    float away;       /* [m of the world] */
} seen_cell;

seen_cell seen_look(const seen_grid *s, const int at[3]);

/* Four values of a cell at once. */
typedef float seen_lanes __attribute__((vector_size(16), aligned(16)));

/* Follows light through the grid to the eye. added: a cell's radiance scattered towards the eye a metre, red, green, blue,
 * and its extinction, both after the delta scaling. arriving: in, [3] the cell's distance from the eye [m of the world];
 * out, red, green, blue of the radiance that passes its middle towards the eye and comes from cells, and [3] the share of the sky
 * behind them that does (seen_sweep.c). */
void seen_sweep(const seen_grid *s, const seen_lanes *added, seen_lanes *arriving);

#endif
