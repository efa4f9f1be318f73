/* Private: the march's settings on offer, and what rays of the picture told of each. choose.c decides, rungs.c measures. */
#ifndef SHAPE_BUDGET_CHOOSER_H
#define SHAPE_BUDGET_CHOOSER_H

#include "budget/view.h"

/* On offer: steps by the square root of 2, cells that end at the default of all programs, and octaves down to cells of so
 * many pixels. Of the light grids only the first few are made. */
enum { STEP_RUNGS = 22, CELL_RUNGS = 9, CUTS = 5, GRIDS_MOST = 6 };
extern const int chooser_cells[CELL_RUNGS];
extern const double chooser_pixels[CUTS];

typedef struct chooser {
    const shape_volume *volume;
    const shape_view *view;
    const shape_light *light;
    shape_march_options options;
    double allowed;
    shape_budget_choice *choice;
    double *across;         /* of each cloud in pixels, over that of the largest seen */
    double side, seen_side; /* longest side of all clouds, and of the largest seen [m] */
    probe probe;
    shape_volume cut; /* with fewer octaves */
    shape_marcher *grids[GRIDS_MOST];
    /* Found out: */
    int step_count, cut_count, tried;
    probe_picture
        best; /* as near as may be to the picture without the shortcut, but for the light's `tail` */
    double step_error[STEP_RUNGS], looks[STEP_RUNGS];     /* looks: a ray of the picture */
    double cut_error[CUTS], cut_cost[CUTS];               /* cost: of a look, over that with all octaves */
    double cell_error[CELL_RUNGS], cell_cost[CELL_RUNGS]; /* cost: looks */
    double tail;                                          /* the error of the finest light grid made */
} chooser;

/* Cells of each cloud's grid, into the choice: the fewer, the smaller it is in the picture, but at the last rung. */
void chooser_set_cells(const chooser *c, int cells);
int chooser_steps(const chooser *c, int rung);
/* How many octaves have cells of at least so many pixels, seen at the nearest. */
int chooser_octaves(const chooser *c, size_t cloud, double pixels);
void chooser_cut(shape_volume_cloud *cloud, int octaves);

/* Measures errors and costs of all that is on offer, each for itself. */
shape_status chooser_measure(chooser *c, shape_error *error);
/* The error of three settings together, light grids that were not made standing for their error alone. */
shape_status chooser_try(chooser *c, int step, int cut, int cell, double *found, shape_error *error);
/* A layer with a light grid that was not made, and whose light a step may miss: makes it, and raises the steps until twice as
 * many change little. */
shape_status chooser_confirm(chooser *c, int *step, int cut, int cell, double *found, shape_error *error);
void chooser_drop(chooser *c);

#endif
