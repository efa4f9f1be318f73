/* What stands behind the clouds on a marched ray: the sky, or a matt surface (Lambert 1760) in the sun and the lamp, in the
 * clouds' and the things' shadow. Many-scattered light that comes through the clouds is not on it: only the beam is. */
#include <math.h>

#include "light/march.h"

static const double pi = 3.14159265358979323846;

/* The share of a light that reaches a surface, by the law that lights the clouds where it is one of depth alone. */
static double beam(march_ray *ray, shape_dvec3 point, const march_way *way)
{
    const shape_marcher *m = ray->marcher;
    shape_vec3 nowhere = {0, 0, 0};
    if (m->options.light == SHAPE_MARCH_HARRIS)
        return march_harris(ray, point, way, 1);
    double shade = march_needs_depth(m->options.light) ? m->options.shade : 1;
    return exp(-march_shaded(shade, march_depth(ray, point, way, NULL, nowhere)));
}

/* Radiance of a white surface for a light of irradiance 1 on a plane that faces it. */
static double reflected(march_ray *ray, const shape_opaque_hit *hit, const march_way *way)
{
    double facing = shape_dvec3_dot(hit->normal, way->direction);
    return facing > 0 ? facing * beam(ray, hit->point, way) / pi : 0;
}

static bool sky_lights(shape_march_light light)
{
    return light == SHAPE_MARCH_OCTAVES || light == SHAPE_MARCH_GRID;
}

void march_background(march_ray *ray, const shape_opaque_hit *hit, double rgb[3])
{
    const shape_marcher *m = ray->marcher;
    shape_dvec3 d = ray->direction;
    float sky[3];
    if (!hit) {
        shape_sky_radiance(&m->sky, shape_vec3_make((float)d.x, (float)d.y, (float)d.z), sky);
        for (int c = 0; c < 3; c++)
            rgb[c] = (double)sky[c];
        return;
    }
    march_way to_sun = march_sun_way(m), to_lamp;
    double sun = reflected(ray, hit, &to_sun), lamp = 0, falloff;
    ray->width = 0;
    if (m->has_lamp && march_lamp_way(ray, hit->point, &to_lamp, &falloff))
        lamp = falloff * reflected(ray, hit, &to_lamp);
    /* The mean of a sky of two halves over the surface's cosine. */
    double upper = sky_lights(m->options.light) ? (1 + hit->normal.y) / 2 : 0;
    double lower = sky_lights(m->options.light) ? (1 - hit->normal.y) / 2 : 0;
    for (int c = 0; c < 3; c++)
        rgb[c] = (double)hit->albedo[c] *
                 (sun * (double)m->light.sun_irradiance[c] + lamp * (double)m->options.lamp.intensity[c] +
                  upper * (double)m->upper[c] + lower * (double)m->lower[c]);
}
