/* Air: what lies between the eye and what it sees grows paler with the distance (aerial perspective), and where clouds or
 * things keep the sun from the air, it is darker: shafts and streaks. docs/light.md, "Air", has the formulas.
 *
 * The air's extinction is 3.912 / visibility (Koschmieder 1924: the contrast of a black thing is then 0.02), times
 * exp(-y / height) where it thins with the height y. Its light is the sky's own: air that lies in the sun sends the radiance
 * L of the sky behind it, so that all things fade into the sky and the sky itself stays as it is (Koschmieder's horizon,
 * in every direction). A share s of that light is the sun's, once scattered; what lies in the shadow lacks it:
 *
 *     L(seen) = passed L(thing) + integral of sigma exp(-depth) L (1 - s (1 - V)) dt,   V: whether the sun is seen
 *
 * s = p E / (p E + M), of the sun's irradiance E, the sky's mean M, and the phase function p of haze (Henyey-Greenstein,
 * g = 0.76: Bruneton and Neyret 2008); so shafts are seen towards the sun, and hardly away from it (single scattering with
 * shadows along the ray: Max 1986). Only the way to the eye has air: it weakens no light on its way into clouds or onto things. */
#ifndef SHAPE_AIR_H
#define SHAPE_AIR_H

#include "shape/view.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The air on one ray. */
typedef struct shape_air_ray {
    double extinction; /* where the ray begins [1/m]; 0: there is no air */
    double thinning;   /* it falls by exp(-thinning t) along the ray [1/m]; negative: it grows */
    double sky[3];     /* L: the sky's radiance there, which the air in the sun has */
    double share[3];   /* s: how much of it is the sun's, 0 to 1 */
} shape_air_ray;

/* Whether there is any. */
bool shape_air_is(const shape_air *air);
/* At the world's height y [1/m]; 0 where there is none. */
double shape_air_extinction(const shape_air *air, double y);
/* The sun's share in the light of the air where one looks at cos_sun from the sun. mean: of the whole sky's radiance. */
void shape_air_sun_share(const shape_light *light, const float mean[3], double cos_sun, double share[3]);
/* sky must be made of light; mean is shape_air_mean's. origin in metres, world; direction a unit vector. */
shape_air_ray shape_air_along(const shape_light *light, const shape_sky *sky, const float mean[3],
                              shape_dvec3 origin, shape_dvec3 direction);
/* The mean radiance of the whole sky: of its two halves. */
void shape_air_mean(const shape_sky *sky, float mean[3]);
/* The optical depth of the first t metres; t may be infinite. */
double shape_air_depth(const shape_air_ray *ray, double t);
/* Where that depth is reached [m]; infinite where it never is. */
double shape_air_distance(const shape_air_ray *ray, double depth);

#ifdef __cplusplus
}
#endif
#endif
