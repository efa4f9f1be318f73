/* What a marched ray meets at a point: extinction, emission, and light by one of the models of shape/march.h. */
#include <math.h>

#include "light/march.h"
#include "shape/phase.h"

static const double pi = 3.14159265358979323846;

enum { OCTAVES = 8 };

/* Copy k has extinction, strength and mean cosine halved k times; the strengths sum to 1. */
static double octaves(const shape_medium *medium, float cos_sun, double depth)
{
    double sum = 0, share = 0.5 / (1 - ldexp(1, -OCTAVES));
    shape_medium wide = *medium;
    if (wide.phase == SHAPE_PHASE_MIE) {
        wide.phase = SHAPE_PHASE_HG;
        wide.g = shape_phase_mean_cosine(medium);
    }
    for (int k = 0; k < OCTAVES; k++, share /= 2, depth /= 2) {
        sum += share * (double)shape_phase(k ? &wide : medium, cos_sun) * exp(-depth);
        wide.g /= 2;
        wide.g2 /= 2;
    }
    return sum;
}

/* How much of the sun's light is left at that depth, by the law. */
static double attenuation(const shape_march_options *options, double cos_sun, double depth)
{
    if (isinf(depth)) /* behind something opaque, where k = 0 would make NaN of it */
        return 0;
    switch (options->light) {
    case SHAPE_MARCH_POWDER:
        return exp(-depth) * -expm1(-options->powder * depth);
    case SHAPE_MARCH_POWDER_ANGLE:
        /* The angle lies between the way one looks and the way the light goes: 1 with the sun behind the eye. */
        return exp(-depth) * (1 - (1 - cos_sun) / 2 * exp(-options->powder * depth));
    case SHAPE_MARCH_BEER_MAX:
        return fmax(exp(-depth), 0.7 * exp(-depth / 4));
    default:
        return exp(-depth);
    }
}

/* A point of a cloud that is being lit. */
typedef struct lit_point {
    const march_cloud *cloud;
    shape_dvec3 world;
    shape_vec3 p; /* cloud's frame */
    double extinction;
} lit_point;

/* With `silver`, thin parts scatter straight on and thick ones all round. */
static double phase(const shape_marcher *m, const lit_point *at, double cos_sun)
{
    const double highest = 0.99; /* 1 is a flash in one direction */
    if (!m->options.silver)
        return (double)shape_phase(&at->cloud->cloud->medium, (float)cos_sun);
    return (double)shape_phase_hg((float)fmin(exp(-at->extinction * m->step), highest), (float)cos_sun);
}

/* Radiance that the cloud's scattering adds at a point, for extinction 1 and sun light of irradiance 1. */
static double sun_source(march_ray *ray, const lit_point *at, double cos_sun, double *depth)
{
    const shape_marcher *m = ray->marcher;
    const shape_medium *medium = &at->cloud->cloud->medium;
    double albedo = (double)medium->albedo;
    if (m->options.light == SHAPE_MARCH_HARRIS)
        return albedo * phase(m, at, cos_sun) * march_sun_harris(ray, at->world, albedo);
    if (m->options.light == SHAPE_MARCH_TWO_PASS) {
        const shape_lightgrid *grid = &at->cloud->grid;
        double received = march_grid_value(grid, grid->cells, SHAPE_LIGHTGRID_VALUES, 0, at->p);
        if (shape_opaque_blocks(m->options.opaque, at->world, m->light.sun, INFINITY))
            received = 0;
        return albedo * received * (1 + phase(m, at, cos_sun)) / pi;
    }
    *depth = march_sun_shaded(m->options.shade, march_sun_depth(ray, at->world, at->cloud, at->p));
    if (m->options.light == SHAPE_MARCH_OCTAVES)
        return albedo * octaves(medium, (float)cos_sun, *depth);
    return albedo * phase(m, at, cos_sun) * attenuation(&m->options, cos_sun, *depth);
}

static void light_point(march_ray *ray, const lit_point *at, double rgb[3])
{
    const shape_marcher *m = ray->marcher;
    const march_cloud *cloud = at->cloud;
    if (m->options.light == SHAPE_MARCH_GRID) {
        for (int c = 0; c < 3; c++)
            rgb[c] = march_grid_value(&cloud->grid, cloud->seen, 4, c, at->p);
        return;
    }
    double depth = 0;
    double value = sun_source(ray, at, shape_dvec3_dot(ray->direction, m->light.sun), &depth);
    for (int c = 0; c < 3; c++)
        rgb[c] = value * (double)m->light.sun_irradiance[c];
    if (m->options.light == SHAPE_MARCH_OCTAVES)
        for (int c = 0; c < 3; c++)
            rgb[c] += (double)cloud->cloud->medium.albedo * exp(-fmin(depth, 1e3) / 8) *
                      (double)(m->upper[c] + m->lower[c]) / 2;
}

/* The square of u at a point of cloud i; above the support's where there is nothing. */
static float find_u2(const march_ray *ray, size_t i, shape_vec3 p, float t)
{
    const shape_volume_cloud *cloud = ray->marcher->clouds[i].cloud;
    const shape_candidates *found = &ray->scratch->view.views[i];
    if (ray->marcher->options.lock > 0) /* the point is off the ray */
        return cloud->field.model == SHAPE_MODEL_GRID ? 0 : shape_cloud_u2(cloud, p);
    return found->count ? shape_candidates_u2(found, 0, found->count, cloud->support * cloud->support, t)
                        : INFINITY;
}

march_sample march_look(march_ray *ray, float t)
{
    const shape_marcher *m = ray->marcher;
    march_sample sample = {0, {0, 0, 0}};
    shape_dvec3 origin = shape_dvec3_add(ray->origin, ray->shift);
    for (size_t i = 0; i < m->volume->cloud_count; i++) {
        const shape_volume_cloud *cloud = m->clouds[i].cloud;
        if (!ray->scratch->view.views[i].count)
            continue;
        shape_ray local = shape_volume_ray(cloud, origin, ray->direction);
        shape_vec3 p = shape_vec3_add(local.origin, shape_vec3_scale(local.direction, t));
        float u2 = find_u2(ray, i, p, t);
        if (!(u2 <= cloud->support * cloud->support))
            continue;
        double density = (double)shape_cloud_density_at(cloud, p, u2), rgb[3] = {0, 0, 0};
        lit_point at = {&m->clouds[i], shape_dvec3_add(origin, shape_dvec3_scale(ray->direction, (double)t)),
                        p, density * (double)cloud->medium.extinction};
        if (!(density > 0))
            continue;
        if (at.extinction > 0)
            light_point(ray, &at, rgb);
        sample.extinction += at.extinction;
        for (int c = 0; c < 3; c++)
            sample.added[c] +=
                (at.extinction > 0 ? at.extinction * rgb[c] : 0) + density * (double)m->options.emission[c];
    }
    return sample;
}
