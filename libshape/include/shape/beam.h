/* The sun's first scattering towards an eye, for each ray: of a ray the phase function's value is a constant, while cells of a
 * light grid, each with a value of its own, would leave steps of a cell's size where the peak of forward scattering is. */
#ifndef SHAPE_BEAM_H
#define SHAPE_BEAM_H

#include "shape/volume.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The value [1/sr] at which the medium's phase function is cut off so that the share f of it that shape_delta_scaling gives is
 * above (Potter 1970); infinite where f is 0. */
float shape_beam_cap(const shape_medium *medium);

/* A ray in a cloud, and the sun. */
typedef struct shape_beam {
    float blunt; /* the phase function's value without its peak, at most the cap [1/sr] */
    float peak;  /* and what is above the cap [1/sr] */
    float share; /* f */
} shape_beam;

/* cap: shape_beam_cap's of the medium; cosine: between the ray and the way to the sun. */
shape_beam shape_beam_make(const shape_medium *medium, float cap, float cosine);

/* Source function for a sun of irradiance 1: radiance per unit of extinction. seen: the fourth value of shape_lightgrid_seen,
 * 0 to 1; albedo: of the cloud, or of its channel there. */
float shape_beam_source(const shape_beam *beam, float albedo, float seen);

#ifdef __cplusplus
}
#endif
#endif
