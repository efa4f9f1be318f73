/* What a ray knows better than the cells of a light grid, each of which stands for many directions near the eye: the sun's first
 * scattering, since the phase function's value is a constant of the ray, and what is scattered straight on, since it is on the
 * ray already. By cells, steps of a cell's size were seen where the peak of forward scattering is, and in thin cloud around
 * the eye a veil of light from all directions. */
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

/* Light that is scattered straight on (f) goes through cells where they are far from the eye, and stays on the ray near it, as if
 * it had not been scattered (which is what the delta scaling of Joseph, Wiscombe and Weinman 1976 says of it): the ray's share
 * of it at a distance, 1 at the eye, a half at four cells. cells2: the distance's square, in cells. */
float shape_beam_straight(float cells2);
/* What of the extinction the ray is left with there, above 0 to 1: 1 - albedo f and the ray's share of it, as it is
 * interpolated between cells. Sources stay per unit of the whole extinction. */
float shape_beam_kept(const shape_beam *beam, float albedo, float cells2);

#ifdef __cplusplus
}
#endif
#endif
