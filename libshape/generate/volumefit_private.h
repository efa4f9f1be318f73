/* Private: what the files of the volume fit share. */
#ifndef SHAPE_GENERATE_VOLUMEFIT_PRIVATE_H
#define SHAPE_GENERATE_VOLUMEFIT_PRIVATE_H

#include <stdint.h>

#include "shape/volumefit.h"

/* The volume at the middles of cubic cells [world axes]. */
typedef struct fit_lattice {
    int n[3];
    size_t count;
    shape_dvec3 middle; /* of the lattice, world */
    double cell, level; /* see the report */
    float *extinction;  /* [1/m] */
    float *target;      /* extinction / level, at most 1: what the union should be */
    uint8_t *solid;     /* target above a half */
    float *depth;       /* in a solid cell: distance to the nearest cell that is not [cells] */
} fit_lattice;

/* One ellipsoid in lattice coordinates (cell i reaches from i to i + 1): u = |m (p - c)|. gradient is of the last round,
 * mean and square are Adam's moments (Kingma and Ba 2015). Twelve numbers: c, then m row by row. */
typedef struct fit_primitive {
    double value[12], gradient[12], mean[12], square[12];
    int steps;
    /* made ready for a round */
    double radius;         /* of the ball of its volume [cells] */
    int low[3], high[3];   /* cells that it may touch */
    double inner2, outer2; /* u^2 below and above which it is plainly 1, 0 */
} fit_primitive;

/* The union's soft complement: product of (1 - o_i), o_i rising from 0 to 1 across the surface. */
typedef struct fit_union {
    const fit_lattice *lattice;
    fit_primitive *items;
    size_t count, capacity;
    double width; /* half the thickness of a surface [cells] */
    float *left;  /* the product, one a cell */
} fit_union;

/* --- volumefit_lattice.c --- */

shape_status fit_lattice_make(const shape_volume *volume, int resolution, fit_lattice *lattice,
                              shape_error *error);
void fit_lattice_free(fit_lattice *lattice);
/* Distances to the nearest cell whose mark is 0 (Felzenszwalb and Huttenlocher 2012), 0 there [cells]. */
shape_status fit_distances(const int n[3], const uint8_t *marks, float *distance, shape_error *error);

/* --- volumefit_union.c --- */

/* Makes items ready and fills `left`. */
void fit_union_fill(fit_union *u);
/* Fills each item's gradient of the sum of (union - target)^2. */
void fit_union_gradients(fit_union *u);
/* By how much that sum would grow without item i. */
double fit_union_use(const fit_union *u, size_t i);
/* One step of descent; rate is the length of a step, as a share of a primitive's size. */
void fit_union_step(fit_union *u, double rate);
/* A ball as an item. */
fit_primitive fit_ball(const double centre[3], double radius);

#endif
