/* Private: one ray's way through the clouds, and what is there. */
#ifndef SHAPE_LIGHT_MARCH_H
#define SHAPE_LIGHT_MARCH_H

#include "shape/lightgrid.h"
#include "shape/march.h"

/* A cloud with what its light needs. */
typedef struct march_cloud {
    const shape_volume_cloud *cloud;
    shape_lightgrid grid; /* SHAPE_MARCH_GRID; else without cells */
    float *seen;          /* its cells as the eye sees them, RGB and 0 */
} march_cloud;

struct shape_marcher {
    const shape_volume *volume;
    shape_light light;
    shape_sky sky;
    float ambient[3]; /* mean radiance of the sky */
    shape_march_options options;
    double step, light_step;
    march_cloud *clouds;
};

/* The extinction at t along the ray [1/m], and the radiance that it adds to the ray a metre. */
typedef struct march_sample {
    double extinction, added[3];
} march_sample;

/* The ray being marched. */
typedef struct march_ray {
    const shape_marcher *marcher;
    shape_dvec3 origin, direction;
    shape_march_scratch *scratch;
    shape_random *random; /* NULL: no jitter */
    shape_status status;
    shape_error *error;
    double depth, rgb[3]; /* gathered so far */
} march_ray;

march_sample march_look(march_ray *ray, float t);

/* Adds the panel from a to b by the rule; march_rules.c. */
void march_panel(march_ray *ray, shape_rule rule, float a, float b);
/* How many steps make one panel of the rule. */
int march_panel_steps(shape_rule rule);

#endif
