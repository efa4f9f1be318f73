/* Private: one cloud's columns along the sun (sun_columns.c, sun_columns_make.c). */
#ifndef SHAPE_LIGHT_SUN_COLUMNS_H
#define SHAPE_LIGHT_SUN_COLUMNS_H

#include <stdatomic.h>

#include "shape/change.h"
#include "shape/lightgrid.h"

enum { SUN_DEEPEST = 60000 }; /* a half-float's range */

/* Where columns lie. Arrays are in the order: along a row, across the rows, from layer to layer. */
typedef struct sun_layout {
    int axis[3], size[3];  /* samples in a layer's rows, rows, layers */
    float low[3], cell[3]; /* of the grid [m, cloud's frame] */
    int upward;            /* 1: the sun lies at the upper end of the layers' axis; else 0 */
    float shear[2];        /* how far a column moves from a layer to the next [cells] */
    int first[2], count[2];
    float length; /* of a column within a layer [m, world], times extinction */
} sun_layout;

/* Shared by the sweeps that have them. */
typedef struct sun_columns {
    atomic_int uses;
    sun_layout at;
    float *depth;   /* [layers, from the sun][count[1]][count[0]]: sums of optical depth */
    float *density; /* the same cells' densities; NULL: not kept */
} sun_columns;

/* What columns are made of. */
typedef struct sun_order {
    const shape_volume_cloud *cloud;
    shape_dvec3 sun;
    int resolution, threads;
    bool keep;
    const shape_change *change; /* since the earlier columns; NULL: nothing has changed */
    shape_stop stop;
} sun_order;

/* --- sun_columns_make.c --- */

/* Makes columns, or takes *earlier over (NULL: none there), where they lie as these would and have kept their densities: it is
 * shared, or, where something has changed, taken away (*earlier is NULL then) and made again where the change touches it.
 * *rows is added how many rows were evaluated. The caller drops *made. */
shape_status sun_columns_make(const sun_order *order, sun_columns **earlier, sun_columns **made,
                              uint64_t *rows, shape_error *error);
void sun_columns_drop(sun_columns *columns); /* NULL is allowed */
size_t sun_columns_cells(const sun_layout *at);

/* --- sun_columns.c --- */

/* Optical depth to the sun at a point of the cloud's frame, through this cloud alone. */
float sun_columns_depth(const sun_columns *columns, shape_vec3 p);
/* Adds it to value 0 of a row of cells of the cloud's own light grid: row y + size[1] z. */
void sun_columns_add_row(const sun_columns *columns, const shape_lightgrid *grid, int row);
/* Whether a light grid has the cells that were swept. */
bool sun_columns_same_grid(const sun_columns *columns, const shape_lightgrid *grid);
/* Value 0 of the cells of such a grid that lie in a layer. */
void sun_columns_fill_layer(const sun_columns *columns, int layer, shape_lightgrid *grid);

#endif
