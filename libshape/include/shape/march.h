/* Marched pictures: the light that a ray gathers, summed by a rule of integration at chosen places. Quick and smooth, and
 * with errors of its own: the reference (shape/pathtrace.h) tells how large. docs/light.md has each choice's formula, its
 * source, and when it fails. */
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

/* How long steps are. Within an interval that holds density they are made to fill it exactly. */
typedef enum shape_march_stepping {
    SHAPE_STEP_FIXED,     /* all alike; the default */
    SHAPE_STEP_GEOMETRIC, /* each `growth` times the one before it (Páleník 2016 Eq. 3.17) */
    SHAPE_STEP_EXPONENTIAL /* a fixed share, `share`, of the distance from the eye (section 3.4 there): cubes that look
                              alike; nearer than `step` one step */
} shape_march_stepping;

/* Where the steps of a ray begin. */
typedef enum shape_march_jitter {
    SHAPE_JITTER_NONE, /* at the interval; bands appear where steps are long */
    SHAPE_JITTER_HASH, /* a chance share of a step later: bands become grain */
    SHAPE_JITTER_BLUE  /* the same from a tile of blue noise (Ulichney 1993), whose grain is finest */
} shape_march_jitter;

/* What the steps do where something opaque ends the ray. */
typedef enum shape_march_end {
    SHAPE_END_CUT, /* they stay where they would be without it; the last is cut short. The default */
    SHAPE_END_ADAPT /* they are made to end there (Páleník 2016 Eq. 4.1, 4.2): the thing's shape shows through dense
                       cloud, as an image negative, where steps are long */
} shape_march_end;

/* How a point is lit; depth is the optical depth to the sun, or to the lamp for what the lamp gives. */
typedef enum shape_march_light {
    SHAPE_MARCH_SINGLE,       /* the sun once scattered: Beer's law, exp(-depth). The sky lights nothing */
    SHAPE_MARCH_POWDER,       /* the same times 1 - exp(-k depth) (Páleník 2016 Eq. 3.14): dark rims */
    SHAPE_MARCH_POWDER_ANGLE, /* times 1 - (cos + 1)/2 exp(-k depth) (Eq. 3.15): only with the sun behind the eye */
    SHAPE_MARCH_BEER_MAX, /* max(exp(-depth), 0.7 exp(-depth / 4)): lighter depths (Schneider 2017, quoted in 001) */
    SHAPE_MARCH_HARRIS, /* what is scattered on within a small angle is not lost (Harris and Lastra 2001; Páleník
                             2016 Eq. 3.12, corrected) */
    SHAPE_MARCH_TWO_PASS, /* the light grid of Jiménez 2018 Eq. 5 to 7, and his Eq. 8 in the view */
    SHAPE_MARCH_OCTAVES, /* sums of ever weaker, wider and farther-reaching copies of it (Wrenninge, Kulla and Lundqvist
                            2013), for many scatterings; the sky by its mean */
    SHAPE_MARCH_GRID /* all scatterings of sun and sky, from the light pass (shape/lightgrid.h); the default */
} shape_march_light;

/* How the optical depth to the sun and the lamp is found, where the light asks for it. */
typedef enum shape_march_shadow {
    SHAPE_SHADOW_MARCH, /* steps straight to the sun; the default */
    SHAPE_SHADOW_CONE, /* steps that go astray by 5, 10, 15, 20 degrees in turn (Páleník 2016 section 5.1): soft */
    SHAPE_SHADOW_GRID /* kept in a grid around each cloud, computed once (003) */
} shape_march_shadow;

enum { SHAPE_MARCH_OCTAVES_MAX = 8 };

typedef struct shape_march_options {
    shape_rule rule;
    shape_march_light light;
    shape_march_shadow shadow;
    shape_march_stepping stepping;
    shape_march_jitter jitter; /* default none */
    shape_march_end end;
    double
        step; /* between samples [m]; 0: a hundredth of the longest side of all clouds. Geometric: the first */
    double growth; /* of geometric steps, 1 to 2; default 1.02 */
    double share;  /* of the distance, for exponential steps, above 0 to 1; default 0.01. A pixel's size is
                      2 tan(fov / 2) / height */
    double light_step; /* of the march to the sun [m]; 0: twice the step */
    int resolution;    /* of grids of light, cells along a cloud's longest side, 2 to 256; default 48 */
    const int *
        resolutions; /* one a cloud, in place of `resolution`; 0: the cloud is not drawn and has no grid, and only
                               throws shadows. Read by shape_marcher_create alone. NULL (default): all alike */
    int samples;     /* rays a pixel, 1 to 4096; default 1 */
    double powder; /* k of the powder laws, 0 to 1000; default 2 */
    int octaves;   /* copies that SHAPE_MARCH_OCTAVES sums, 1 to SHAPE_MARCH_OCTAVES_MAX; default that */
    double shade; /* multiplies depths to the sun, 0 to 1 (sigma' of Páleník 2016 section 3.3); default 1 */
    double forward;    /* share of scattering that Harris' light keeps, 0 to 1; default 0.5 */
    float emission[3]; /* of density 1, radiance a metre (epsilon of section 3.3 there); default 0 */
    float ambient
        [3]; /* radiance that reaches every point alike from all round, whatever lies between (001); default 0 */
    bool silver; /* Henyey-Greenstein with g = 1 - opacity of a step (section 2.3): bright thin rims */
    double lock; /* ray starts are moved to a grid of so many points a metre (section 5.1); 0: not */
    /* A ray ends where less than this share of what is behind gets through, and a way to the sun through voxels where
     * less of the sun does; 1e-12 to 0.1; default 1e-8. */
    double cutoff;
    double alpha_power; /* coverage is raised to it, 0.01 to 100 (alpha correction); default 1 */
    double alpha_peel;  /* pixels with less coverage show no cloud, 0 to 1; default 0 */
    uint64_t seed;      /* of the jitter */
    /* Default none; takes a light of a depth or Harris', and no SHAPE_SHADOW_GRID: the grids are the sun's. */
    shape_lamp lamp;
    const shape_opaque *opaque; /* finished; default NULL */
    shape_progress progress;    /* default none */
    void *progress_context;
} shape_march_options;

shape_march_options shape_march_defaults(void);
shape_status shape_march_check(const shape_march_options *options, shape_error *error);

/* Whether such a light and shadow can show a lamp. */
bool shape_march_takes_lamp(shape_march_light light, shape_march_shadow shadow);

/* A volume lit and ready to be marched. Opaque; reading it is thread-safe. */
typedef struct shape_marcher shape_marcher;

/* Makes the light pass where it is asked for. eye is where one will look from [m, world]. volume and options->opaque
 * must outlive the marcher, which the caller destroys. Errors: the checks of light and options, memory. */
shape_status shape_marcher_create(const shape_volume *volume, const shape_light *light, shape_dvec3 eye,
                                  const shape_march_options *options, shape_marcher **marcher,
                                  shape_error *error);
void shape_marcher_destroy(shape_marcher *marcher); /* NULL is allowed */

/* Scratch memory of one thread: zero it before first use. */
typedef struct shape_march_path {
    shape_candidates *views; /* one list a cloud */
    shape_ray *rays;         /* the ray in each cloud's frame */
    size_t view_count;
    float *edges;
    size_t edge_capacity;
} shape_march_path;
typedef struct shape_march_scratch {
    shape_march_path view, sun;
    shape_candidates shadow;
    uint64_t looks;   /* at points on the rays so far */
    double (*air)[2]; /* distances along the ray, and how deep the clouds are so far, where there is air */
    size_t air_count, air_capacity;
    double air_start; /* 0 to below 1: where its looks at the sun begin; like start, another in each pixel */
} shape_march_scratch;
void shape_march_scratch_free(shape_march_scratch *scratch);

/* The radiance that arrives at origin from direction (unit vector, where one looks). start, 0 to below 1, is the share of
 * a step by which steps begin later than without jitter. */
shape_status shape_march_radiance(const shape_marcher *marcher, shape_dvec3 origin, shape_dvec3 direction,
                                  double start, shape_march_scratch *scratch, double rgb[3],
                                  shape_error *error);

/* Renders: width * height RGB triples from the upper left. The same for any number of threads. cancelled may be NULL. */
shape_status shape_march_render(const shape_marcher *marcher, const shape_view *view, float *radiance,
                                bool *cancelled, shape_error *error);

/* What a marcher has done: cells of all light grids, these times rounds of the solution for their scattered light, and
 * points of the pictures' rays that were looked at. */
typedef struct shape_march_work {
    uint64_t cells, visits, looks;
} shape_march_work;
shape_march_work shape_marcher_work(const shape_marcher *marcher);

#ifdef __cplusplus
}
#endif
#endif
