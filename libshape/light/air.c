/* Air along a ray: Koschmieder 1924, with the sun's share of its light apart (see shape/air.h). */
#include "shape/air.h"

#include <math.h>

/* -ln 0.02: the contrast that a black thing at the visibility's distance has left. */
static const double least_contrast = 3.912;
/* Haze scatters forwards (Bruneton and Neyret 2008). */
static const double haze_g = 0.76;
static const double pi = 3.14159265358979323846;

bool shape_air_is(const shape_air *air)
{
    return air->visibility > 0;
}

double shape_air_extinction(const shape_air *air, double y)
{
    if (!shape_air_is(air))
        return 0;
    /* Far below, air is opaque anyhow; its numbers stay finite. */
    double thinner = air->height > 0 ? exp(-fmax(y / air->height, -100)) : 1;
    return least_contrast / air->visibility * thinner;
}

void shape_air_mean(const shape_sky *sky, float mean[3])
{
    float upper[3], lower[3];
    shape_sky_mean(sky, upper, lower);
    for (int c = 0; c < 3; c++)
        mean[c] = 0.5f * (upper[c] + lower[c]);
}

void shape_air_sun_share(const shape_light *light, const float mean[3], double cos_sun, double share[3])
{
    double base = (1 - haze_g) * (1 - haze_g) + 2 * haze_g * fmax(1 - cos_sun, 0);
    double phase = (1 - haze_g * haze_g) / (4 * pi * base * sqrt(base));
    for (int c = 0; c < 3; c++) {
        double sun = phase * (double)light->sun_irradiance[c], sum = sun + (double)mean[c];
        share[c] = sum > 0 ? sun / sum : 0;
    }
}

shape_air_ray shape_air_along(const shape_light *light, const shape_sky *sky, const float mean[3],
                              shape_dvec3 origin, shape_dvec3 direction)
{
    shape_air_ray ray = {.extinction = shape_air_extinction(&light->air, origin.y)};
    float rgb[3];
    if (light->air.height > 0)
        ray.thinning = direction.y / light->air.height;
    shape_sky_radiance(sky, shape_vec3_make((float)direction.x, (float)direction.y, (float)direction.z), rgb);
    for (int c = 0; c < 3; c++)
        ray.sky[c] = (double)rgb[c];
    shape_air_sun_share(light, mean, shape_dvec3_dot(direction, light->sun), ray.share);
    return ray;
}

double shape_air_depth(const shape_air_ray *ray, double t)
{
    double x = ray->thinning * t;
    if (!(ray->extinction > 0))
        return 0;
    if (ray->thinning == 0 || fabs(x) < 1e-9)
        return ray->extinction * t;
    /* Beyond exp(700) there is no number; nothing is seen through a ten-thousandth of that. */
    return ray->extinction * -expm1(-fmax(x, -690)) / ray->thinning;
}

double shape_air_distance(const shape_air_ray *ray, double depth)
{
    double x = ray->thinning * depth / ray->extinction;
    if (!(ray->extinction > 0))
        return INFINITY;
    if (ray->thinning == 0 || fabs(x) < 1e-9)
        return depth / ray->extinction;
    return x < 1 ? -log1p(-x) / ray->thinning : INFINITY;
}
