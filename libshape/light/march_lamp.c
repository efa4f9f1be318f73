/* The ways from a point to the sun and to the lamp, and how much of the lamp's intensity is left at its distance. */
#include <math.h>

#include "light/march.h"

march_way march_sun_way(const shape_marcher *marcher)
{
    march_way way = {marcher->light.sun, INFINITY};
    return way;
}

/* The mean of 1 / distance^2 over the step of `width` around a point. `along` is how far ahead the ray comes nearest to
 * the lamp, at a distance whose square is `aside`. In closed form, since a step that passes near the lamp has nearly all of
 * it in one place, which a sample would miss or see far too bright:
 * (atan(b / d) - atan(a / d)) / (d width) for a < s < b. */
static double mean_falloff(double along, double aside, double width)
{
    /* A ray through the lamp itself would be infinitely bright: it passes by at a thousandth of a step. */
    double a = -0.5 * width - along, b = 0.5 * width - along, d = fmax(sqrt(fmax(aside, 0)), 1e-3 * width);
    return atan2(d * width, d * d + a * b) / (d * width);
}

bool march_lamp_way(const march_ray *ray, shape_dvec3 world, march_way *way, double *falloff)
{
    shape_dvec3 to = shape_dvec3_sub(ray->marcher->options.lamp.position, world);
    double square = shape_dvec3_dot(to, to), along = shape_dvec3_dot(to, ray->direction);
    way->length = sqrt(square);
    if (!(way->length > 0))
        return false;
    way->direction = shape_dvec3_scale(to, 1 / way->length);
    *falloff = ray->width > 0 ? mean_falloff(along, square - along * along, ray->width) : 1 / square;
    return true;
}
