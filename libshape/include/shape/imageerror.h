/* How far one picture is from another, in linear radiance. Nothing here needs the image formats. All functions are
 * pure: different threads may call them at once. */
#ifndef SHAPE_IMAGEERROR_H
#define SHAPE_IMAGEERROR_H

#include "shape/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Keeps relative errors finite where the reference is black: epsilon of relMSE [radiance squared], the radiance 0.1
 * counting as dark (a white surface in the default sun has 1). After Rousselle et al. 2011, "Adaptive sampling and
 * reconstruction using greedy error minimization", section 5. */
#define SHAPE_IMAGEERROR_EPSILON 1e-2

/* a is the picture that is judged, b the reference. */
typedef struct shape_imageerror {
    double rmse;    /* square root of the mean of (a - b)^2 over pixels and channels [radiance] */
    double relmse;  /* mean of (a - b)^2 / (b^2 + epsilon), no unit */
    double largest; /* largest |a - b| [radiance] ... */
    int x, y,
        channel; /* ... and where: column, row from the top, 0 to 2 for red, green, blue; the first of equals */
    double
        exposure; /* the factor on a that makes relmse least: 1 where a is as bright as b; 0 where a is black */
    double exposed_relmse;       /* relmse with that factor: what is wrong besides the brightness */
    double mean_a[3], mean_b[3]; /* mean radiance of each picture, by channel */
} shape_imageerror;

/* Compares two pictures of width * height RGB triples. Sums are taken in a fixed order, in double precision.
 * SHAPE_ERROR_ARGUMENT where a size is not positive, or a value is NaN or infinite (the text says in which picture and
 * where); *result is untouched then. */
shape_status shape_imageerror_measure(const float *a, const float *b, int width, int height,
                                      shape_imageerror *result, shape_error *error);

/* A picture of where the error is. Each pixel's e = square root of the mean over its channels of (a - b)^2 /
 * (b^2 + epsilon) goes by its logarithm through black, blue, red, yellow and white: black at full / 1000 and below,
 * white at full and above. heat takes width * height linear RGB triples from 0 to 1, to be written without tone curve.
 * Errors: those of shape_imageerror_measure, and full not above 0. */
shape_status shape_imageerror_map(const float *a, const float *b, int width, int height, double full,
                                  float *heat, shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
