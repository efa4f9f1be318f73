/* Private: one light path through the clouds and between surfaces. */
#ifndef SHAPE_LIGHT_PATH_H
#define SHAPE_LIGHT_PATH_H

#include "light/track.h"
#include "shape/air.h"
#include "shape/pathtrace.h"

/* All that a path needs to know, made ready once. */
typedef struct path_scene {
    const majorant_grid *grid;
    shape_sky sky;
    double sun[3], sun_cos, irradiance[3]; /* sun_cos: the cosine at the disc's edge */
    bool has_sun, has_lamp;
    double lamp[3], intensity[3];
    int max_bounces;
    const shape_opaque *opaque;
    bool has_air;
    shape_light light; /* what the air is made of, and the sky's mean */
    float sky_mean[3];
} path_scene;

path_scene path_scene_make(const majorant_grid *grid, const shape_light *light,
                           const shape_pathtrace_options *options);

/* Follows a path from p (metres from the grid's origin) backwards along the unit vector d, and adds what it gathers to
 * rgb. first is the uniform number, above 0 and below 1, that the first free path is made of. */
void path_gather(const path_scene *scene, const double p[3], const double d[3], double first,
                 shape_random *random, double rgb[3]);

/* Turns d by chance to a direction at cosine c from it. */
void path_turn(double d[3], double c, shape_random *random);

#endif
