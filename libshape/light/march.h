/* Private: one ray's way through the clouds, and what is there. */
#ifndef SHAPE_LIGHT_MARCH_H
#define SHAPE_LIGHT_MARCH_H

#include "field/grid_ray.h"
#include "light/bluenoise.h"
#include "shape/air.h"
#include "shape/beam.h"
#include "shape/lightgrid.h"
#include "shape/march.h"

/* A cell as the eye sees it: red, green, blue and the beam (shape_lightgrid_seen); of a coloured cloud a beam for each. */
enum { MARCH_SEEN = 4, MARCH_SEEN_COLOURED = 6 };

/* A cloud with what its light needs. */
typedef struct march_cloud {
    const shape_volume_cloud *cloud;
    shape_lightgrid grid; /* of all light, of depths, or that of 2018; else without cells */
    grid_way sun;         /* model grid: towards it, t in metres */
    float *seen;          /* SHAPE_MARCH_GRID: its cells as the eye sees them, MARCH_SEEN numbers each */
    shape_beam_peak peak;
    shape_vec3
        cells; /* of the grid, in a metre of the cloud's frame, where rays keep light (shape_beam_kept); else 0 */
    bool hidden; /* it throws shadows, and is not drawn */
} march_cloud;

struct shape_marcher {
    const shape_volume *volume;
    shape_light light;
    shape_sky sky;
    float upper[3], lower[3]; /* mean radiance of the sky's halves */
    shape_march_options options;
    bool has_sun, has_lamp, has_air;
    float sky_mean[3]; /* of the whole sky, for the air */
    double step, light_step;
    double deep; /* the optical depth of options.cutoff */
    const shape_grid
        *voxels;           /* the grid of a volume that is one grid, seen along the ray itself; else NULL */
    shape_dvec3 low, high; /* the world box around all clouds */
    march_cloud *clouds;
    uint16_t *blue; /* SHAPE_JITTER_BLUE, and for the air; else NULL */
    shape_march_work *work;
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
    double first; /* the first step's length, as a share of a whole one, above 0 to 1 */
    shape_status status;
    shape_error *error;
    double width;         /* of the step that a look stands for [m]; 0: a point */
    shape_dvec3 shift;    /* from the ray to where it is looked at, where starts are locked to a grid */
    double depth, rgb[3]; /* gathered so far */
    shape_air_ray air;    /* where the marcher has air */
    const march_cloud *beam_cloud; /* that `beam` is of; NULL: none yet */
    shape_beam beam;
} march_ray;

/* --- march_path.c: the joined intervals of all clouds on a ray --- */

/* Fills path->edges with *count edges, pairs sorted by their start and apart from each other. all: of hidden clouds too. */
shape_status march_path_find(const shape_marcher *marcher, shape_march_path *path, shape_dvec3 origin,
                             shape_dvec3 direction, bool all, size_t *count, shape_error *error);
/* Extinction of all clouds at t on that ray. */
double march_path_extinction(const shape_marcher *marcher, const shape_march_path *path, float t);
void march_path_free(shape_march_path *path);

/* --- march_light.c --- */

march_sample march_look(march_ray *ray, float t);

/* --- march_lamp.c --- */

/* The way from a point to a light. */
typedef struct march_way {
    shape_dvec3 direction; /* unit */
    double length;         /* [m]; infinite to the sun */
} march_way;

march_way march_sun_way(const shape_marcher *marcher);
/* The way to the lamp, and *falloff, which its intensity becomes irradiance by. False where the point is the lamp. */
bool march_lamp_way(const march_ray *ray, shape_dvec3 world, march_way *way, double *falloff);

/* --- march_depth.c --- */

bool march_needs_depth(shape_march_light light);
/* The optical depth from a world point along the way to a light, infinite behind something opaque. cloud and p: the cloud
 * that asks, and the point in its frame; NULL: none, and it is marched. */
double march_depth(march_ray *ray, shape_dvec3 world, const march_way *way, const march_cloud *cloud,
                   shape_vec3 p);
/* A depth as `shade` thins it; what is opaque stays so, where 0 times infinity would be NaN. */
double march_shaded(double shade, double depth);
/* The share of the light that comes there along the way by Harris' recurrence. */
double march_harris(march_ray *ray, shape_dvec3 world, const march_way *way, double albedo);
/* All `values` values of `seen` at a point of its cloud's frame, as march_grid_value has each. */
void march_grid_values(const shape_lightgrid *grid, const float *seen, int values, shape_vec3 p, double *to);
/* Value `value` of a grid at a point of its cloud's frame, between cell centres; constant beyond the outermost. */
double march_grid_value(const shape_lightgrid *grid, const float *cells, int values, int value, shape_vec3 p);

/* --- march_surface.c --- */

/* What a ray sees behind all clouds: the surface that it hit, or the sky. */
void march_background(march_ray *ray, const shape_opaque_hit *hit, double rgb[3]);

/* --- march_air.c --- */

/* Keeps how deep the clouds are as far as t, which rises from call to call; nothing where there is no air. */
void march_air_knot(march_ray *ray, double t);
/* What the air before `end` sends to the eye, added to rgb, and the share of the light from there that it lets pass. gain: how
 * coverage is corrected (1 - exp(-depth) times it). */
double march_air_add(march_ray *ray, double end, double gain, double rgb[3]);

/* --- march_rules.c --- */

/* Adds the panel from a to b by the rule. */
void march_panel(march_ray *ray, shape_rule rule, float a, float b);
/* How many steps make one panel of the rule. */
int march_panel_steps(shape_rule rule);

#endif
