/* The reference: unbiased path tracing of a volume. Every faster method is measured against it.
 *
 * Free paths are drawn by delta tracking (Woodcock et al. 1965) through a grid of majorants and minorants (decomposition,
 * Kutz et al. 2017); light from the sun and the lamp is looked for at every collision, by a second
 * free path; the sky is found by paths that leave. */
#ifndef SHAPE_PATHTRACE_H
#define SHAPE_PATHTRACE_H

#include "shape/opaque.h"
#include "shape/random.h"
#include "shape/view.h"
#include "shape/volume.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A volume made ready to be traced. Opaque; reading it is thread-safe. */
typedef struct shape_tracer shape_tracer;

/* Builds the grid. The volume must outlive the tracer. The caller destroys it. Error: memory. */
shape_status shape_tracer_create(const shape_volume *volume, shape_tracer **tracer, shape_error *error);
void shape_tracer_destroy(shape_tracer *tracer); /* NULL is allowed */

/* One unbiased estimate, 0 or more and above 1 now and then, of the transmittance between origin and origin + length
 * direction (a unit vector); length [m] may be infinite. */
double shape_tracer_transmittance(const shape_tracer *tracer, shape_dvec3 origin, shape_dvec3 direction,
                                  double length, shape_random *random);

/* A path that was followed until it left the volume. */
typedef struct shape_walk {
    shape_dvec3 direction; /* in which it left; the starting one where nothing was met */
    double
        weight;  /* the product of the media's albedos met, a grid's colour left out; 0 where max_bounces was
                              passed */
    int bounces; /* collisions met */
} shape_walk;

/* Follows one path from origin along direction (a unit vector). */
shape_walk shape_tracer_walk(const shape_tracer *tracer, shape_dvec3 origin, shape_dvec3 direction,
                             int max_bounces, shape_random *random);

/* A lamp that shines alike in all directions; irradiance at distance d is intensity / d^2. */
typedef struct shape_lamp {
    shape_dvec3 position; /* metres, world */
    float intensity[3];   /* 0 each: no lamp */
} shape_lamp;

/* Whether it shines at all. */
bool shape_lamp_shines(const shape_lamp *lamp);
/* SHAPE_ERROR_ARGUMENT where a number is negative or not finite. */
shape_status shape_lamp_check(const shape_lamp *lamp, shape_error *error);

/* Mean and sum of squared deviations of a pixel's samples (Welford 1962), red, green, blue. */
typedef struct shape_pathtrace_pixel {
    double mean[3], squares[3];
} shape_pathtrace_pixel;

/* Called by the thread that renders whenever every pixel has the same number of samples; false ends the work there. */
typedef bool (*shape_pathtrace_keep)(void *context, int samples);

typedef struct shape_pathtrace_options {
    int samples; /* paths a pixel, 1 to 2^20; default 64. With `noise`: the most */
    double
        noise; /* stop once the estimated relative error (see the result) is at most this; 0: never; default 0 */
    int max_bounces; /* collisions, with surfaces too, that a path may have, 0 to 2^20; default 4096: more than paths of real clouds have */
    uint64_t seed;   /* default 1 */
    double sun_angle; /* the disc's diameter, degrees, 0 (a direction) to 90; default 0.53 */
    shape_lamp lamp;  /* default none */
    const shape_opaque *
        opaque; /* finished; ends rays, scatters them as matt surfaces do, throws and catches shadows; default NULL */
    shape_pathtrace_pixel *
        pixels; /* width * height sums, the caller's: zeros, or those of an earlier rendering of the same picture, which
                      is gone on with; they end as the sums of this one. Default NULL: none are handed out */
    int samples_before;        /* paths that each of *pixels has, 0 to `samples`; default 0 */
    shape_pathtrace_keep keep; /* a moment to keep *pixels; default none */
    void *keep_context;
    shape_progress progress; /* default none */
    void *progress_context;
} shape_pathtrace_options;

shape_pathtrace_options shape_pathtrace_defaults(void);
shape_status shape_pathtrace_check(const shape_pathtrace_options *options, shape_error *error);

typedef struct shape_pathtrace_result {
    int samples;    /* paths a pixel that were traced */
    double mean[3]; /* mean radiance of the picture */
    double
        rel_error; /* square root of the mean over pixels and channels of variance / (radiance^2 + 0.01): an
                         estimate of the square root of the picture's relMSE (shape/imageerror.h) */
    bool cancelled;
} shape_pathtrace_result;

/* Renders. radiance gets width * height RGB triples from the upper left; variance (may be NULL) the estimated variance
 * of each of these means. The same options give the same picture for any number of threads, and also where the work was
 * ended by `keep` and gone on with from what it kept. Errors:
 * SHAPE_ERROR_ARGUMENT from the checks of view, light and options; memory. Cancelled: SHAPE_OK, with what there is. */
shape_status shape_pathtrace_render(const shape_tracer *tracer, const shape_view *view,
                                    const shape_light *light, const shape_pathtrace_options *options,
                                    float *radiance, float *variance, shape_pathtrace_result *result,
                                    shape_error *error);

/* One estimate of the radiance that arrives at origin from direction (unit vector, where one looks). */
void shape_pathtrace_radiance(const shape_tracer *tracer, const shape_light *light,
                              const shape_pathtrace_options *options, shape_dvec3 origin,
                              shape_dvec3 direction, shape_random *random, double rgb[3]);

#ifdef __cplusplus
}
#endif
#endif
