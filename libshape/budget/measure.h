/* Private: pictures of a cloud from six sides, and how two sets of them differ. Equal on every machine. */
#ifndef SHAPE_BUDGET_MEASURE_H
#define SHAPE_BUDGET_MEASURE_H

#include "shape/set.h"

/* What all pictures of one cloud share. */
typedef struct budget_stage {
    shape_cloud cloud; /* field, medium and frame */
    shape_box box;     /* what is seen, cloud's frame */
    int size[3];       /* cells, and so pixels, along x, y, z */
    double length[3];  /* of a cell along x, y, z [m, world] */
    size_t values;     /* in all pictures */
} budget_stage;

/* Sets the stage round a list: its box and an eighth of it on every side. */
shape_status budget_stage_set(budget_stage *stage, const shape_primitives *list, const shape_cloud *cloud,
                              int resolution, shape_error *error);
/* Draws the pictures of a list into stage->values numbers. */
shape_status budget_pictures_draw(const budget_stage *stage, const shape_primitives *list, double *pictures,
                                  shape_error *error);
/* The largest relative RMS difference of one of them. */
double budget_pictures_change(const budget_stage *stage, const double *from, const double *to);

#endif
