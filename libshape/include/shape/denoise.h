/* A path-traced picture without its grain. Nothing here needs the image formats. Pure: different threads may call it at
 * once. */
#ifndef SHAPE_DENOISE_H
#define SHAPE_DENOISE_H

#include "shape/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Non-local means with the variance known (Rousselle, Knaus and Zwicker 2012, "Adaptive rendering with non-local means
 * filtering", section 4, in one buffer): each pixel becomes the mean of those within 7 pixels of it whose surroundings
 * of 5x5 pixels differ from its own by no more than their noise explains. No pixel moves by more than three standard
 * deviations, so a plain without noise keeps its radiance, and edges that stand out of the noise stay; what is as faint
 * as the noise is lost with it, so the result is no longer unbiased. It does not depend on the number of threads.
 *
 * radiance, variance (of each pixel's mean, radiance squared, as shape_pathtrace_render gives it) and result hold
 * width * height RGB triples, row by row; result must not overlap the others.
 * SHAPE_ERROR_ARGUMENT: a side below 1, a radiance that is NaN or infinite, a variance that is so too or negative;
 * SHAPE_ERROR_MEMORY. *result is undefined then. */
shape_status shape_denoise(const float *radiance, const float *variance, int width, int height, float *result,
                           shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
