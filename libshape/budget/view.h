/* Private: a few hundred of a picture's rays, and what marches of different settings see along them. */
#ifndef SHAPE_BUDGET_VIEW_H
#define SHAPE_BUDGET_VIEW_H

#include "light/march.h"
#include "shape/budget.h"

enum { PROBE_RAYS = 400, PROBE_TRIES = 32768 };

/* Rays that meet a cloud, out of so many of the picture's that were tried. */
typedef struct probe {
    const shape_view *view;
    shape_dvec3 eye, directions[PROBE_RAYS];
    int rays, tries;
    shape_march_work work; /* of all marchers that were looked through */
} probe;

/* A picture of the rays alone: red, green, blue each. */
typedef struct probe_picture {
    double rgb[3 * PROBE_RAYS];
} probe_picture;

/* Picks rays by the R2 sequence (Roberts 2018) over the pixels, so that they are spread evenly. */
shape_status probe_open(probe *p, const shape_marcher *marcher, const shape_view *view, shape_error *error);
shape_status probe_march(probe *p, const shape_marcher *marcher, probe_picture *picture, shape_error *error);
/* The square root of the relMSE that a whole picture of such pixels would have; pixels without a cloud have none. */
double probe_change(const probe *p, const probe_picture *picture, const probe_picture *reference);

/* --- sight.c --- */

/* The diameter of the sphere around a box, in pixels; infinite where the eye is near. */
double shape_budget_pixels(const shape_view *view, shape_dvec3 low, shape_dvec3 high);

#endif
