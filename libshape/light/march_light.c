/* What a marched ray meets at a point: extinction, emission, and light by one of the models of shape/march.h. */
#include <math.h>

#include "light/march.h"
#include "primitive/grid_look.h"
#include "shape/phase.h"

static const double pi = 3.14159265358979323846;

/* Copy k has extinction, strength and mean cosine halved k times; the strengths sum to 1. */
static double octaves(const shape_medium *medium, int count, float cosine, double depth)
{
    double sum = 0, share = 0.5 / (1 - ldexp(1, -count));
    shape_medium wide = *medium;
    if (wide.phase == SHAPE_PHASE_MIE) {
        wide.phase = SHAPE_PHASE_HG;
        wide.g = shape_phase_mean_cosine(medium);
    }
    for (int k = 0; k < count; k++, share /= 2, depth /= 2) {
        sum += share * (double)shape_phase(k ? &wide : medium, cosine) * exp(-depth);
        wide.g /= 2;
        wide.g2 /= 2;
    }
    return sum;
}

/* How much of a light is left at that depth, by the law. cosine: between the way one looks and the way to the light. */
static double attenuation(const shape_march_options *options, double cosine, double depth)
{
    if (isinf(depth)) /* behind something opaque, where k = 0 would make NaN of it */
        return 0;
    switch (options->light) {
    case SHAPE_MARCH_POWDER:
        return exp(-depth) * -expm1(-options->powder * depth);
    case SHAPE_MARCH_POWDER_ANGLE:
        /* The angle lies between the way one looks and the way the light goes: 1 with the sun behind the eye. */
        return exp(-depth) * (1 - (1 - cosine) / 2 * exp(-options->powder * depth));
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
    float cells2; /* cells_away */
} lit_point;

/* With `silver`, thin parts scatter straight on and thick ones all round. */
static double phase(const shape_marcher *m, const lit_point *at, double cosine)
{
    const double highest = 0.99; /* 1 is a flash in one direction */
    if (!m->options.silver)
        return (double)shape_phase(&at->cloud->cloud->medium, (float)cosine);
    return (double)shape_phase_hg((float)fmin(exp(-at->extinction * m->step), highest), (float)cosine);
}

/* Radiance that the cloud's scattering adds at a point, for extinction 1, albedo 1 and a light of irradiance 1 there. */
static double scattered(march_ray *ray, const lit_point *at, const march_way *way, double *depth)
{
    const shape_marcher *m = ray->marcher;
    const shape_medium *medium = &at->cloud->cloud->medium;
    double cosine = shape_dvec3_dot(ray->direction, way->direction);
    if (m->options.light == SHAPE_MARCH_HARRIS)
        return phase(m, at, cosine) * march_harris(ray, at->world, way, (double)medium->albedo);
    if (m->options.light == SHAPE_MARCH_TWO_PASS) {
        const shape_lightgrid *grid = &at->cloud->grid;
        double received = march_grid_value(grid, grid->cells, SHAPE_LIGHTGRID_VALUES, 0, at->p);
        if (shape_opaque_blocks(m->options.opaque, at->world, way->direction, way->length))
            received = 0;
        return received * (1 + phase(m, at, cosine)) / pi;
    }
    *depth = march_shaded(m->options.shade, march_depth(ray, at->world, way, at->cloud, at->p));
    if (m->options.light == SHAPE_MARCH_OCTAVES)
        return octaves(medium, m->options.octaves, (float)cosine, *depth);
    return phase(m, at, cosine) * attenuation(&m->options, cosine, *depth);
}

static void add_lamp(march_ray *ray, const lit_point *at, double rgb[3])
{
    const shape_lamp *lamp = &ray->marcher->options.lamp;
    march_way way;
    double falloff, depth;
    if (!march_lamp_way(ray, at->world, &way, &falloff))
        return;
    double value = falloff * scattered(ray, at, &way, &depth);
    for (int c = 0; c < 3; c++)
        rgb[c] += value * (double)lamp->intensity[c];
}

/* The eye's own grid has the albedo in it, but for clouds of several colours. */
static void look_up(march_ray *ray, const lit_point *at, const float albedo[3], double rgb[3])
{
    const march_cloud *cloud = at->cloud;
    const shape_light *light = &ray->marcher->light;
    const bool coloured = shape_cloud_is_coloured(cloud->cloud);
    const float straight = shape_beam_straight(at->cells2);
    double seen[MARCH_SEEN_COLOURED];
    if (ray->beam_cloud != cloud)
        ray->beam = shape_beam_make(&cloud->cloud->medium, &cloud->peak,
                                    (float)shape_dvec3_dot(ray->direction, light->sun));
    ray->beam_cloud = cloud;
    march_grid_values(&cloud->grid, cloud->seen, coloured ? MARCH_SEEN_COLOURED : MARCH_SEEN, at->p, seen);
    for (int c = 0; c < 3; c++) {
        float own = coloured ? albedo[c] : cloud->cloud->medium.albedo;
        float beam = shape_beam_source(&ray->beam, own, (float)seen[coloured ? 3 + c : 3], straight);
        rgb[c] = (coloured ? (double)own : 1) * seen[c] + (double)(light->sun_irradiance[c] * beam);
    }
}

static void light_point(march_ray *ray, const lit_point *at, double rgb[3])
{
    const shape_marcher *m = ray->marcher;
    bool sky = m->options.light == SHAPE_MARCH_OCTAVES, grid = m->options.light == SHAPE_MARCH_GRID;
    float albedo[3];
    shape_cloud_albedo(at->cloud->cloud, at->p, albedo);
    if (grid)
        look_up(ray, at, albedo, rgb);
    double depth = 0, value = 0;
    march_way sun = march_sun_way(m);
    if (!grid && (m->has_sun || sky))
        value = scattered(ray, at, &sun, &depth);
    double through = sky ? exp(-fmin(depth, 1e3) / 8) : 0;
    for (int c = 0; c < 3 && !grid; c++)
        rgb[c] =
            value * (double)m->light.sun_irradiance[c] + through * (double)(m->upper[c] + m->lower[c]) / 2;
    if (m->has_lamp)
        add_lamp(ray, at, rgb);
    for (int c = 0; c < 3; c++)
        rgb[c] =
            (grid ? rgb[c] : rgb[c] * (double)albedo[c]) + (double)albedo[c] * (double)m->options.ambient[c];
}

/* The square of the distance t in cells of the light grid, infinite where rays keep no light; `direction` is the ray's, in
 * the cloud's frame. */
static float cells_away(const march_cloud *cloud, shape_vec3 direction, float t)
{
    if (!(cloud->cells.x > 0))
        return INFINITY;
    const shape_vec3 way =
        shape_vec3_scale(shape_vec3_make(direction.x * cloud->cells.x, direction.y * cloud->cells.y,
                                         direction.z * cloud->cells.z),
                         t);
    return shape_vec3_dot(way, way);
}

/* What a ray is left with of a cloud's extinction. */
static double kept(const march_ray *ray, const lit_point *at)
{
    if (ray->beam_cloud != at->cloud)
        return 1;
    return (double)shape_beam_kept(&ray->beam, at->cloud->cloud->medium.albedo, at->cells2);
}

/* The square of u at a point of cloud i; above the support's where there is nothing. */
static float find_u2(const march_ray *ray, size_t i, shape_vec3 p, float t)
{
    const shape_volume_cloud *cloud = ray->marcher->clouds[i].cloud;
    const shape_candidates *found = &ray->scratch->view.views[i];
    if (cloud->field.model == SHAPE_MODEL_GRID) /* density is 0 where there is nothing */
        return 0;
    if (ray->marcher->options.lock > 0) /* the point is off the ray */
        return shape_cloud_u2(cloud, p);
    return found->count ? shape_candidates_u2(found, 0, found->count, cloud->support * cloud->support, t)
                        : INFINITY;
}

march_sample march_look(march_ray *ray, float t)
{
    const shape_marcher *m = ray->marcher;
    march_sample sample = {0, {0, 0, 0}};
    shape_dvec3 origin = shape_dvec3_add(ray->origin, ray->shift);
    ray->scratch->looks++;
    for (size_t i = 0; i < m->volume->cloud_count; i++) {
        const shape_volume_cloud *cloud = m->clouds[i].cloud;
        if (!ray->scratch->view.views[i].count)
            continue;
        shape_ray local = m->options.lock > 0 ? shape_volume_ray(cloud, origin, ray->direction)
                                              : ray->scratch->view.rays[i];
        shape_vec3 p = shape_vec3_add(local.origin, shape_vec3_scale(local.direction, t));
        float u2 = find_u2(ray, i, p, t);
        if (!(u2 <= cloud->support * cloud->support))
            continue;
        double density = cloud->field.model == SHAPE_MODEL_GRID
                             ? (double)grid_look(cloud->list->grid, p.x, p.y, p.z)
                             : (double)shape_cloud_density_at(cloud, p, u2);
        double rgb[3] = {0, 0, 0};
        if (!(density > 0))
            continue;
        lit_point at = {&m->clouds[i], shape_dvec3_add(origin, shape_dvec3_scale(ray->direction, (double)t)),
                        p, density * (double)cloud->medium.extinction,
                        cells_away(&m->clouds[i], local.direction, t)};
        if (at.extinction > 0)
            light_point(ray, &at, rgb);
        sample.extinction += at.extinction * kept(ray, &at);
        for (int c = 0; c < 3; c++)
            sample.added[c] +=
                (at.extinction > 0 ? at.extinction * rgb[c] : 0) + density * (double)m->options.emission[c];
    }
    if (m->has_air) {
        double passed = exp(-shape_air_depth(&ray->air, (double)t));
        for (int c = 0; c < 3; c++)
            sample.added[c] *= passed;
    }
    return sample;
}
