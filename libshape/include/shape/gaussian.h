/* The 3-D Gaussian cumulus: spheres at normally distributed places over a flat base, large in the middle and smaller
 * towards the rim (Jiménez 2018 section 3.6.1, Eq. 15, 16, Table 2). What is corrected against the paper stands in
 * docs/gaussian.md. */
#ifndef SHAPE_GAUSSIAN_H
#define SHAPE_GAUSSIAN_H

#include "shape/random.h"
#include "shape/set.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What becomes of a draw outside Table 2's interval. */
typedef enum shape_clamp_mode {
    SHAPE_CLAMP_EDGE =
        0, /* it moves to the interval's end, as in the paper: half of all centres lie on the base */
    SHAPE_CLAMP_REJECT = 1 /* it is drawn anew: the truncated normal distribution */
} shape_clamp_mode;

typedef enum shape_radius_law {
    SHAPE_RADIUS_INVERSE = 0, /* Eq. 15: falls with 1 / (|x| + |z| + 1 m) */
    SHAPE_RADIUS_GAUSSIAN = 1 /* Eq. 16: falls by a tenth for each two sigma */
} shape_radius_law;

enum { SHAPE_GAUSSIAN_MAX_COUNT = 10000000 };

typedef struct shape_gaussian {
    size_t count; /* spheres drawn, 1 to SHAPE_GAUSSIAN_MAX_COUNT; default 35 */
    double
        mean[3]; /* mu, the cloud's centre and the height of its base [m, cloud's frame], +-1e6; default 0 */
    double sigma[3]; /* standard deviation of each axis [m], 0 to 1e6; default 3.8, 1.7, 3.7. 0: no spread */
    double clamp;    /* K: x and z keep to +-K sigma, y to 0..K sigma above the mean; 0.01 to 10, default 2 */
    shape_clamp_mode clamp_mode; /* default edge */
    shape_radius_law radius_law; /* default Gaussian */
    double max_radius;           /* epsilon of Eq. 15 and 16 [m], 1e-6 to 1e6; default 2.9 */
    bool hollow;                 /* leave the core box out; default true */
    bool prune;                  /* drop spheres inside others (Eq. 17); default true */
} shape_gaussian;

/* What became of the spheres drawn. kept = drawn - hollowed - pruned. */
typedef struct shape_gaussian_report {
    size_t drawn, hollowed, pruned;
} shape_gaussian_report;

shape_gaussian shape_gaussian_defaults(void);
/* Checks every member's range; the error names the member. */
shape_status shape_gaussian_check(const shape_gaussian *options, shape_error *error);

/* One centre, relative to the mean: three normal draws (more with SHAPE_CLAMP_REJECT), clamped. The options must have
 * passed the check. */
shape_dvec3 shape_gaussian_point(const shape_gaussian *options, shape_random *random);
/* The radius at a place relative to the mean [m]: Eq. 15 with P - C for P, or Eq. 16 with the squared terms added; an
 * axis whose sigma is 0 has no term. */
double shape_gaussian_radius(const shape_gaussian *options, shape_dvec3 from_mean);
/* Whether a place relative to the mean lies in the core that hollowing takes out, |x| < 3/4 sigma_x,
 * |y| < sigma_y / 3, |z| < 3/4 sigma_z. With a sigma of 0 there is no core. */
bool shape_gaussian_in_core(const shape_gaussian *options, shape_dvec3 from_mean);

/* Appends a cumulus to an empty list. Hollowing that would leave nothing is not done. The same options and seed give
 * the same spheres everywhere. *report (may be NULL) is filled. Errors: the check's, or memory. */
shape_status shape_gaussian_make(const shape_gaussian *options, uint64_t seed, shape_primitives *list,
                                 shape_gaussian_report *report, shape_error *error);

/* The seed of the index-th cloud of a field: the field's own for the first, a hash of both for the others. A cloud of
 * a field is the one that its seed alone makes. */
uint64_t shape_field_seed(uint64_t seed, uint64_t index);

/* The species of cumulus (WMO, International Cloud Atlas). */
typedef enum shape_species {
    SHAPE_SPECIES_HUMILIS = 0,   /* small and flat */
    SHAPE_SPECIES_MEDIOCRIS = 1, /* about as tall as wide */
    SHAPE_SPECIES_CONGESTUS = 2  /* a tower, taller than wide */
} shape_species;

/* The defaults with the count, sigma and maximum radius of a species. */
shape_gaussian shape_gaussian_species(shape_species species);

#ifdef __cplusplus
}
#endif
#endif
