/* The table of docs/stability.md, one row a place where a method fails. A row measures one quantity twice, by the plain way
 * and by ours, and states between which bounds the truth lies: the test holds that ours is inside and the plain way is
 * not, and the page is printed from the same rows, so that neither can say what the other does not. */
#ifndef STABILITY_ROW_H
#define STABILITY_ROW_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene_sample.h"
#include "shape/march.h"

typedef struct stability_row {
    const char *where;    /* the case */
    const char *plain;    /* the plain way, and what becomes of it */
    const char *ours;     /* what is done here */
    const char *quantity; /* what is measured */
    double low, high;     /* bounds of the truth and what rounding adds, both included */
    void (*measure)(double x, double *plain, double *ours);
    double x; /* for measure: rows of one family share it */
} stability_row;

typedef struct stability_part {
    const char *title;
    const stability_row *rows;
    size_t count;
} stability_part;

extern const stability_part stability_steps, stability_rays, stability_forms, stability_places,
    stability_amounts;

/* The energy table: which light sends back no more than it gets, and whether it claims so. */
typedef struct stability_energy {
    const char *light;
    double flux, furnace; /* how near to 1 it claims to be; 0: it claims nothing */
    int march;            /* a shape_march_light; -1: the reference */
} stability_energy;

enum { STABILITY_ENERGIES = 9 };
extern const stability_energy stability_energies[STABILITY_ENERGIES];
/* Of the sun's light that a white ball of optical diameter `depth` scatters, the share that leaves it; and the radiance
 * seen through it in a white furnace (NAN for lights without sky). */
void stability_energy_measure(const stability_energy *energy, double depth, double *flux, double *furnace);
/* Whether both are as near to 1 as claimed; false for lights that claim nothing. */
bool stability_energy_holds(const stability_energy *energy, double flux, double furnace);

static inline void stability_must(shape_status status, const shape_error *error)
{
    if (status) {
        fprintf(stderr, "%s\n", error->text);
        abort();
    }
}

/* Radiance of the march along one ray, red. */
static inline double stability_look(const sample_scene *scene, const shape_light *light,
                                    const shape_march_options *options, shape_dvec3 eye,
                                    shape_dvec3 direction)
{
    shape_marcher *marcher;
    shape_march_scratch scratch;
    shape_error error;
    double rgb[3];
    memset(&scratch, 0, sizeof scratch);
    stability_must(shape_marcher_create(scene->volume, light, eye, options, &marcher, &error), &error);
    stability_must(shape_march_radiance(marcher, eye, direction, 0, &scratch, rgb, &error), &error);
    shape_march_scratch_free(&scratch);
    shape_marcher_destroy(marcher);
    return rgb[0];
}

/* No sun, a sky of radiance 1 all round: seen through a black cloud it is the transmittance. */
static inline shape_light stability_white_sky(void)
{
    shape_light light = shape_light_defaults();
    light.sky = SHAPE_SKY_CONSTANT;
    for (int c = 0; c < 3; c++) {
        light.sky_radiance[c] = 1;
        light.sun_irradiance[c] = 0;
    }
    return light;
}

/* One `uniform` ball of that radius about the origin, black or white. */
static inline sample_scene stability_ball(double radius, double extinction, double albedo)
{
    sample_scene scene = sample_begin(SHAPE_MODEL_UNIFORM, (float)extinction);
    scene.set->clouds[0].medium.albedo = (float)albedo;
    scene.set->clouds[0].medium.phase = SHAPE_PHASE_ISOTROPIC;
    sample_add(&scene, 0, 0, 0, (float)radius, (float)radius, (float)radius);
    sample_finish(&scene);
    return scene;
}

#endif
