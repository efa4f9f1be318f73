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

/* A phase function p in two parts, its peak and r = min(p, cap). */
typedef struct shape_beam_peak {
    float
        cap; /* [1/sr] what is above it is the share f that shape_delta_scaling gives (Potter 1970); infinite where f is 0 */
    float ahead; /* the peak's mean cosine, 0.001 to 1; 1 where f is 0 */
    float rest;  /* the mean cosine of r, -1 to 1 */
} shape_beam_peak;

shape_beam_peak shape_beam_peak_make(const shape_medium *medium);

/* A ray in a cloud, and the sun. */
typedef struct shape_beam {
    float blunt;  /* the phase function's value without its peak, at most the cap [1/sr] */
    float peak;   /* and what is above the cap [1/sr] */
    float share;  /* f */
    float aside;  /* minus the logarithm of the peak's mean cosine */
    float cosine; /* between the ray and the way to the sun */
} shape_beam;

/* peak: the medium's; cosine: between the ray and the way to the sun. */
shape_beam shape_beam_make(const shape_medium *medium, const shape_beam_peak *peak, float cosine);

/* Source function for a sun of irradiance 1: radiance per unit of extinction. seen: the fourth value of shape_lightgrid_seen,
 * 0 to 1; albedo: of the cloud, or of its channel there; straight: shape_beam_straight's there, 0 where no light is kept on
 * the ray. Light that was scattered n times within the peak is spread round the sun as by n turns, as Goudsmit and Saunderson
 * 1940 have it for electrons, by the distribution of von Mises and Fisher. */
float shape_beam_source(const shape_beam *beam, float albedo, float seen, float straight);

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
