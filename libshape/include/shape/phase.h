/* Phase functions. cos_theta is taken between the direction of travel before and after scattering: 1 is straight on. */
#ifndef SHAPE_PHASE_H
#define SHAPE_PHASE_H

#include "shape/set.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Value per steradian; integrates to 1 over the sphere for every kind. Finite for |g| < 1. */
float shape_phase(const shape_medium *medium, float cos_theta);
/* Henyey and Greenstein 1941 (Jiménez 2018 Eq. 14). */
float shape_phase_hg(float g, float cos_theta);
/* Its renormalised form, Páleník 2016 Eq. 2.6; by definition it does not integrate to 1. */
float shape_phase_hg_renormalised(float g, float cos_theta);
/* Draws cos_theta with density shape_phase (per steradian), from a uniform number in [0, 1). */
float shape_phase_sample(const shape_medium *medium, float uniform);
/* The mean cosine. */
float shape_phase_mean_cosine(const shape_medium *medium);

#ifdef __cplusplus
}
#endif
#endif
