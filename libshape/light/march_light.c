/* What a marched ray meets at a point: extinction, and light by one of the models of shape/march.h. */
#include "light/march.h"

#include <math.h>

#include "shape/phase.h"

enum { OCTAVES = 8 };

/* The optical depth from the ray's point at t to the sun. */
static double sun_depth(march_ray *ray, float t)
{
    const shape_marcher *m = ray->marcher;
    shape_dvec3 point = shape_dvec3_add(ray->origin, shape_dvec3_scale(ray->direction, (double)t));
    double depth = 0;
    if (!ray->status)
        ray->status =
            shape_volume_optical_depth(m->volume, point, m->light.sun, 0, INFINITY, (float)m->light_step,
                                       &ray->scratch->shadow, &depth, ray->error);
    return depth;
}

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

/* The radiance that a cloud's scattering adds at a point, for extinction 1. */
static void sun_source(const march_ray *ray, const shape_medium *medium, double depth, double rgb[3])
{
    const shape_marcher *m = ray->marcher;
    float cos_sun = (float)shape_dvec3_dot(ray->direction, m->light.sun);
    bool many = m->options.light == SHAPE_MARCH_OCTAVES;
    double value =
        many ? octaves(medium, cos_sun, depth) : (double)shape_phase(medium, cos_sun) * exp(-depth);
    if (m->options.light == SHAPE_MARCH_POWDER)
        value *= -expm1(-2 * depth);
    for (int c = 0; c < 3; c++)
        rgb[c] = (double)medium->albedo * (value * (double)m->light.sun_irradiance[c] +
                                           (many ? (double)m->ambient[c] * exp(-depth / 8) : 0));
}

/* Trilinear between cell centres, constant beyond the outermost. */
static void grid_source(const march_cloud *cloud, shape_vec3 p, double rgb[3])
{
    const shape_lightgrid *grid = &cloud->grid;
    float at[3] = {p.x - grid->box.min.x, p.y - grid->box.min.y, p.z - grid->box.min.z};
    float side[3] = {grid->box.max.x - grid->box.min.x, grid->box.max.y - grid->box.min.y,
                     grid->box.max.z - grid->box.min.z};
    int low[3], high[3];
    double share[3];
    for (int a = 0; a < 3; a++) {
        float x = side[a] > 0 ? at[a] / side[a] * (float)grid->size[a] - 0.5f : 0;
        x = fminf(fmaxf(x, 0), (float)grid->size[a] - 1);
        low[a] = (int)x;
        high[a] = low[a] + 1 < grid->size[a] ? low[a] + 1 : low[a];
        share[a] = (double)(x - (float)low[a]);
    }
    rgb[0] = rgb[1] = rgb[2] = 0;
    for (int k = 0; k < 8; k++) {
        int x = k & 1 ? high[0] : low[0], y = k & 2 ? high[1] : low[1], z = k & 4 ? high[2] : low[2];
        double weight = (k & 1 ? share[0] : 1 - share[0]) * (k & 2 ? share[1] : 1 - share[1]) *
                        (k & 4 ? share[2] : 1 - share[2]);
        const float *cell =
            cloud->seen +
            4 * ((size_t)x + (size_t)grid->size[0] * ((size_t)y + (size_t)grid->size[1] * (size_t)z));
        for (int c = 0; c < 3; c++)
            rgb[c] += weight * (double)cell[c];
    }
}

march_sample march_look(march_ray *ray, float t)
{
    const shape_marcher *m = ray->marcher;
    march_sample sample = {0, {0, 0, 0}};
    double depth = -1;
    for (size_t i = 0; i < m->volume->cloud_count; i++) {
        const shape_volume_cloud *cloud = m->clouds[i].cloud;
        const shape_candidates *found = &ray->scratch->views[i];
        if (!found->count)
            continue;
        float u2 = shape_candidates_u2(found, 0, found->count, cloud->support * cloud->support, t);
        if (!(u2 <= cloud->support * cloud->support))
            continue;
        shape_ray local = shape_volume_ray(cloud, ray->origin, ray->direction);
        shape_vec3 p = shape_vec3_add(local.origin, shape_vec3_scale(local.direction, t));
        double extinction = (double)cloud->medium.extinction * (double)shape_cloud_density_at(cloud, p, u2),
               rgb[3];
        if (!(extinction > 0))
            continue;
        if (m->options.light == SHAPE_MARCH_GRID) {
            grid_source(&m->clouds[i], p, rgb);
        } else {
            depth = depth < 0 ? sun_depth(ray, t) : depth;
            sun_source(ray, &cloud->medium, depth, rgb);
        }
        sample.extinction += extinction;
        for (int c = 0; c < 3; c++)
            sample.added[c] += extinction * rgb[c];
    }
    return sample;
}
