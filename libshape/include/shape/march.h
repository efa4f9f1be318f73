/* Marched pictures: the light that a ray gathers, summed by a rule of integration at chosen places. Quick and smooth, and
 * with errors of its own: the reference (shape/pathtrace.h) tells how large. */
#ifndef SHAPE_MARCH_H
#define SHAPE_MARCH_H

#include "shape/pathtrace.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Páleník 2016 section 4.1. The order is that of the error on a density without jumps; across jumps all are of order 1. */
typedef enum shape_rule {
    SHAPE_RULE_RIEMANN_LEFT,  /* order 1 */
    SHAPE_RULE_RIEMANN_RIGHT, /* order 1 */
    SHAPE_RULE_TRAPEZOID,     /* order 2 */
    SHAPE_RULE_SIMPSON,       /* order 4; panels of two steps */
    SHAPE_RULE_SIMPSON38,     /* order 4; panels of three steps */
    SHAPE_RULE_EXPONENTIAL /* order 2: each step solved as if it were uniform, seen from its middle; the default */
} shape_rule;

/* How a point is lit. */
typedef enum shape_march_light {
    SHAPE_MARCH_SINGLE, /* the sun once scattered, by a march to it: Beer's law. The sky lights nothing */
    SHAPE_MARCH_POWDER, /* the same times 1 - exp(-2 depth) (Páleník 2016 Eq. 3.14), which darkens thin rims */
    SHAPE_MARCH_OCTAVES, /* sums of ever weaker, wider and farther-reaching copies of it (Wrenninge, Kulla and Lundqvist
                            2013), for many scatterings; the sky by its mean */
    SHAPE_MARCH_GRID /* all scatterings of sun and sky, from the light pass (shape/lightgrid.h); the default */
} shape_march_light;

typedef struct shape_march_options {
    shape_rule rule;
    shape_march_light light;
    double step; /* between samples [m]; 0: a hundredth of the longest side of all clouds */
    double
        growth; /* each step is that many times the one before, within an interval (Páleník 2016 Eq. 3.17); 1 to
                          2; default 1 */
    double light_step; /* of the march to the sun [m]; 0: twice the step */
    int resolution;    /* of the light pass, cells along a cloud's longest side, 2 to 256; default 48 */
    int samples;       /* rays a pixel, 1 to 4096; default 1 */
    bool jitter;       /* the exponential rule looks at chance places in its steps rather than the middles */
    uint64_t seed;
    shape_progress progress; /* default none; see shape/pathtrace.h */
    void *progress_context;
} shape_march_options;

shape_march_options shape_march_defaults(void);
shape_status shape_march_check(const shape_march_options *options, shape_error *error);

/* A volume lit and ready to be marched. Opaque; reading it is thread-safe. */
typedef struct shape_marcher shape_marcher;

/* Makes the light pass where it is asked for. eye is where one will look from [m, world]. volume must outlive the
 * marcher, which the caller destroys. Errors: the checks of light and options, memory. */
shape_status shape_marcher_create(const shape_volume *volume, const shape_light *light, shape_dvec3 eye,
                                  const shape_march_options *options, shape_marcher **marcher,
                                  shape_error *error);
void shape_marcher_destroy(shape_marcher *marcher); /* NULL is allowed */

/* Scratch memory of one thread: zero it before first use. */
typedef struct shape_march_scratch {
    shape_candidates *views, shadow; /* views: one list a cloud */
    size_t view_count;
    float *edges;
    size_t edge_capacity;
} shape_march_scratch;
void shape_march_scratch_free(shape_march_scratch *scratch);

/* The radiance that arrives at origin from direction (unit vector, where one looks). random (may be NULL) jitters. */
shape_status shape_march_radiance(const shape_marcher *marcher, shape_dvec3 origin, shape_dvec3 direction,
                                  shape_random *random, shape_march_scratch *scratch, double rgb[3],
                                  shape_error *error);

/* Renders: width * height RGB triples from the upper left. The same for any number of threads. cancelled may be NULL. */
shape_status shape_march_render(const shape_marcher *marcher, const shape_view *view, float *radiance,
                                bool *cancelled, shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
