/* The light pass: what the sun and the sky give at the cells of a grid around a cloud, computed once and looked up by
 * the view pass (the two passes of Jiménez 2018 section 3.5). */
#ifndef SHAPE_LIGHTGRID_H
#define SHAPE_LIGHTGRID_H

#include "shape/change.h"
#include "shape/opaque.h"
#include "shape/sunsweep.h"
#include "shape/view.h"
#include "shape/volume.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Values a cell, all for sources of unit strength, so that colours can change without a new pass:
 *   0     optical depth to the sun, through every cloud
 *   1     mean over directions of the radiance scattered at least once, for a sun of irradiance 1
 *   2, 3  the same for a sky of mean radiance 1 above the horizon and of 1 below it (a clear sky's halves
 *         are spread as they are); unscattered sky light included
 *   4..6  first moment of 1 (mean of radiance times direction of travel), cloud's frame
 *   7     first moment of 2 along the world's y
 */
enum { SHAPE_LIGHTGRID_VALUES = 8 };

/* What shape_lightgrid_seen needs beside them: 0 the extinction after the delta scaling [1/m], 1..3 the first moment of value
 * 2, 4..6 that of value 3, cloud's frame. */
enum { SHAPE_LIGHTGRID_FLUXES = 7 };

typedef struct shape_lightgrid {
    int size[3];      /* cells along x, y, z; cell centres lie half a cell inside the box */
    shape_box box;    /* cloud's frame */
    float *cells;     /* [size z][size y][size x][SHAPE_LIGHTGRID_VALUES] */
    float *fluxes;    /* [cells][SHAPE_LIGHTGRID_FLUXES]; NULL where scattering was not asked for */
    float *densities; /* mean densities of the cells, where scattered light has been solved for; else NULL */
    float *albedos;   /* of a coloured cloud: the means of the channel's albedo in the cells; else NULL */
    struct skyspread *sky; /* private: a clear sky through the phase function's peak; else NULL */
    uint64_t visits;       /* what it took: cells times rounds of the solution for scattered light */
} shape_lightgrid;

typedef struct shape_lightgrid_options {
    int resolution;  /* cells along the longest side, 2 to 256; default 48 */
    float step;      /* of the march to the sun, in cells of the noise's first octave; default 0.5 */
    bool scattering; /* solve for the scattered light too; default true. Else values 1 to 7 are 0 */
    int threads;     /* 0: all; the result does not depend on it */
    int channel; /* of a coloured cloud's albedo, 0 red, 1 green, 2 blue, -1 the medium's alone; default -1. No matter for
                    clouds without colour */
    const shape_opaque *opaque; /* finished; throws shadows on the cells' middles; default NULL */
    const shape_sunsweep
        *sweep; /* of this volume and light, with this cloud: take value 0 from it; default NULL: march */
    int scattering_resolution; /* solve the scattered light by no more cells along the longest side than this, and
                                    interpolate; default 0: by all */
    /* A grid of the same cloud, made earlier: of what it was, or under another light; default NULL. Where it has the same cells
     * its densities are kept, but those that `change` touches; without scattering, values 1 to 7, and densities, too. The
     * grid then is what it would be without `from`, to the bit, but for those values. */
    const struct shape_lightgrid *from;
    const shape_change *change; /* what has changed of the cloud since; default NULL: nothing */
    shape_stop stop;            /* to break off; default none */
} shape_lightgrid_options;

shape_lightgrid_options shape_lightgrid_defaults(void);

/* Builds the grid of one cloud of the volume. The optical depth of a cell is marched over the joined intervals from
 * the cell's centre to the sun. The scattered light is solved by discrete ordinates (S4, upwind differences, source
 * iteration from a coarser grid) on the grid's mean extinction, with the phase function's peak taken out by the
 * delta-Eddington scaling (Joseph, Wiscombe and Weinman 1976). The caller frees by shape_lightgrid_free. */
shape_status shape_lightgrid_build(const shape_volume *volume, size_t cloud, const shape_light *light,
                                   const shape_lightgrid_options *options, shape_lightgrid *grid,
                                   shape_error *error);
/* The light grid of 2018, for comparison only: resolution^3 cells over the cloud's box, value 0 is Jiménez 2018 Eq. 7
 * (a light of 1 outside), marched by Algorithm 2's sweep with steps of `step` metres; the other values are 0. */
shape_status shape_lightgrid_build_2018(const shape_volume *volume, size_t cloud, const shape_light *light,
                                        int resolution, float step, shape_lightgrid *grid,
                                        shape_error *error);
/* The same, but it can be broken off. */
shape_status shape_lightgrid_build_2018_with(const shape_volume *volume, size_t cloud,
                                             const shape_light *light, int resolution, float step,
                                             shape_stop stop, shape_lightgrid *grid, shape_error *error);
void shape_lightgrid_free(shape_lightgrid *grid);

/* What an eye sees of the grid's light: the source function (radiance per unit of extinction, albedo included; of a grid
 * with albedos left out, so that the caller takes it where it looks) of each cell towards the eye [world], red, green and blue
 * of all but the sun's first scattering, and what shape_beam_source makes that of for a ray, into rgba [cells][4]. Light scattered within the phase
 * function's peak is what arrives at the cell from behind, as followed along the ray through the grid, from the sky on, but for
 * what stays on the ray near the eye: there a ray's extinction is less (shape_beam_kept; not of a grid with albedos). The rest is
 * the grid's to first order. Near the eye a cell stands for the
 * directions to all points that are interpolated from it, and gets their mean. sky is shape_sky_make's of that light,
 * sky_upper and sky_lower are shape_sky_mean's of it. Errors: memory. */
shape_status shape_lightgrid_seen(const shape_lightgrid *grid, const shape_volume_cloud *cloud,
                                  const shape_light *light, const shape_sky *sky, const float sky_upper[3],
                                  const float sky_lower[3], shape_dvec3 eye, float *rgba, shape_error *error);

/* The share f of scattering in the forward peak and the asymmetry g' of the rest, for a phase function of mean cosine
 * g: f = g^2 and g' = g / (1 + g) for g > 0; f = 0, g' = g else. */
void shape_delta_scaling(float g, float *share, float *rest);

#ifdef __cplusplus
}
#endif
#endif
