/* Private: one shape for two, and what it costs. */
#ifndef SHAPE_BUDGET_PAIR_H
#define SHAPE_BUDGET_PAIR_H

#include "shape/set.h"

enum { BUDGET_SAMPLES = 96 }; /* points in which a shape is compared */

/* A primitive as it is merged: { centre + axes v : |v| <= 1 }, axes perpendicular, and their inverse rows. */
typedef struct budget_shape {
    shape_dvec3 centre, axes[3], rows[3];
    double volume;
} budget_shape;

/* What the cloud as it was has at a shape's sample points: profile, and which primitive it is due to. */
typedef struct budget_samples {
    float profile[BUDGET_SAMPLES];
    uint32_t owner[BUDGET_SAMPLES]; /* UINT32_MAX: none */
} budget_samples;

typedef enum budget_choice { BUDGET_FIRST, BUDGET_SECOND, BUDGET_JOINED } budget_choice;

/* Points spread over the unit ball, the same always. */
typedef struct budget_ball {
    shape_dvec3 points[BUDGET_SAMPLES];
} budget_ball;
budget_ball budget_ball_make(void);

budget_shape budget_shape_of(const shape_primitives *list, size_t number);
shape_dvec3 budget_shape_point(const budget_shape *shape, shape_dvec3 ball);
double budget_shape_u2(const budget_shape *shape, shape_dvec3 p);
/* The ellipsoid of the two's joint moments, with the volume of their union. */
budget_shape budget_shape_join(const budget_shape *a, const budget_shape *b, const budget_ball *ball);
/* The metaball that is felt from afar as the two are. */
budget_shape budget_ball_join(const budget_shape *a, const budget_shape *b, double *cost);
/* Density, in the mean over noise, at u2 of a model's primitive: 1 at the centre, 0 from the surface on. */
double budget_profile(shape_model model, double u2);

#endif
