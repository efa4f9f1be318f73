/* The way from a point to the sun or the lamp: its optical depth by steps, by steps that go astray in a cone, or from a
 * grid; and Harris' recurrence. */
#include <math.h>

#include "light/march.h"

static const double pi = 3.14159265358979323846;

bool march_needs_depth(shape_march_light light)
{
    return light != SHAPE_MARCH_HARRIS && light != SHAPE_MARCH_TWO_PASS && light != SHAPE_MARCH_GRID;
}

/* The eight cell centres about a point of the cloud's frame, and their shares. */
typedef struct neighbours {
    size_t cell[8];
    double share[8];
} neighbours;

static neighbours find_neighbours(const shape_lightgrid *grid, shape_vec3 p)
{
    const float *at = &p.x, *low = &grid->box.min.x, *high = &grid->box.max.x;
    size_t first[3], next[3];
    double share[3];
    neighbours found;
    for (int a = 0; a < 3; a++) {
        float side = high[a] - low[a], last = (float)grid->size[a] - 1;
        float x = side > 0 ? (at[a] - low[a]) / side * (float)grid->size[a] - 0.5f : 0;
        x = x > 0 ? x : 0;
        x = x < last ? x : last;
        first[a] = (size_t)x;
        next[a] = first[a] + 1 < (size_t)grid->size[a] ? first[a] + 1 : first[a];
        share[a] = (double)(x - (float)first[a]);
    }
    for (int k = 0; k < 8; k++) {
        size_t x = k & 1 ? next[0] : first[0], y = k & 2 ? next[1] : first[1], z = k & 4 ? next[2] : first[2];
        found.cell[k] = (z * (size_t)grid->size[1] + y) * (size_t)grid->size[0] + x;
        found.share[k] = (k & 1 ? share[0] : 1 - share[0]) * (k & 2 ? share[1] : 1 - share[1]) *
                         (k & 4 ? share[2] : 1 - share[2]);
    }
    return found;
}

double march_grid_value(const shape_lightgrid *grid, const float *cells, int values, int value, shape_vec3 p)
{
    neighbours near = find_neighbours(grid, p);
    double sum = 0;
    for (int k = 0; k < 8; k++)
        sum += near.share[k] * (double)cells[near.cell[k] * (size_t)values + (size_t)value];
    return sum;
}

void march_grid_values(const shape_lightgrid *grid, const float *seen, int values, shape_vec3 p, double *to)
{
    neighbours near = find_neighbours(grid, p);
    for (int c = 0; c < values; c++)
        to[c] = 0;
    for (int k = 0; k < 8; k++)
        for (int c = 0; c < values; c++)
            to[c] += near.share[k] * (double)seen[near.cell[k] * (size_t)values + (size_t)c];
}

/* Where a ray leaves the box around all clouds; 0 where it misses it. */
static double way_out(const shape_marcher *m, shape_dvec3 p, shape_dvec3 d)
{
    const double *at = &p.x, *way = &d.x, *low = &m->low.x, *high = &m->high.x;
    double near = 0, far = INFINITY;
    for (int a = 0; a < 3; a++) {
        if (way[a] == 0) {
            if (!(at[a] >= low[a] && at[a] <= high[a]))
                return 0;
            continue;
        }
        double t0 = (low[a] - at[a]) / way[a], t1 = (high[a] - at[a]) / way[a];
        near = fmax(near, fmin(t0, t1));
        far = fmin(far, fmax(t0, t1));
    }
    return far > near ? far : 0;
}

/* Step k leaves the way to the light by 5, 10, 15 or 20 degrees, turned round it by the golden angle (Páleník 2016 section
 * 5.1: a cone of 40 degrees). Steps are looked at in their middle; the last one before a lamp is cut short. */
static double cone_depth(const march_ray *ray, shape_dvec3 world, const march_way *to)
{
    enum { MOST_STEPS = 100000 };
    const shape_marcher *m = ray->marcher;
    shape_dvec3 axis = to->direction, other = {fabs(axis.y) < 0.9 ? 0 : 1, fabs(axis.y) < 0.9 ? 1 : 0, 0};
    shape_dvec3 x = shape_dvec3_normalize(shape_dvec3_cross(other, axis)), y = shape_dvec3_cross(axis, x);
    double longest = fmin(m->light_step, way_out(m, world, axis)), left = to->length, depth = 0;
    for (int k = 0; k < MOST_STEPS && left > 0 && way_out(m, world, axis) > 0; k++) {
        double angle = (5 + 5 * (k % 4)) * pi / 180, turn = 2.399963229728653 * k;
        bool last = longest * cos(angle) >= left;
        double step = last ? left / cos(angle) : longest, aside = step * sin(angle);
        shape_dvec3 way =
            shape_dvec3_add(shape_dvec3_scale(x, aside * cos(turn)), shape_dvec3_scale(y, aside * sin(turn)));
        way = shape_dvec3_add(way, shape_dvec3_scale(axis, step * cos(angle)));
        depth +=
            step * shape_volume_extinction(m->volume, shape_dvec3_add(world, shape_dvec3_scale(way, 0.5)));
        world = shape_dvec3_add(world, way);
        left = last ? 0 : left - step * cos(angle);
    }
    return depth;
}

/* Towards the sun through the one voxel grid that there is, as far as the sun still shines. */
static double voxel_depth(const shape_marcher *m, const march_cloud *cloud, shape_vec3 p)
{
    double extinction = (double)cloud->cloud->medium.extinction, shade = fmax(m->options.shade, 1e-6);
    return extinction * grid_way_depth(&cloud->sun, p, (float)m->light_step, m->deep / (extinction * shade));
}

double march_depth(march_ray *ray, shape_dvec3 world, const march_way *way, const march_cloud *cloud,
                   shape_vec3 p)
{
    const shape_marcher *m = ray->marcher;
    double depth = 0;
    if (m->options.opaque && shape_opaque_blocks(m->options.opaque, world, way->direction, way->length))
        return INFINITY;
    if (cloud && cloud->grid.cells && m->options.shadow == SHAPE_SHADOW_GRID)
        return march_grid_value(&cloud->grid, cloud->grid.cells, SHAPE_LIGHTGRID_VALUES, 0, p);
    if (m->options.shadow == SHAPE_SHADOW_CONE)
        return cone_depth(ray, world, way);
    if (isinf(way->length) && cloud && cloud->cloud->field.model == SHAPE_MODEL_GRID &&
        m->volume->cloud_count == 1)
        return voxel_depth(m, cloud, p);
    if (!ray->status)
        ray->status =
            shape_volume_optical_depth(m->volume, world, way->direction, 0, (float)way->length,
                                       (float)m->light_step, &ray->scratch->shadow, &depth, ray->error);
    return depth;
}

double march_shaded(double shade, double depth)
{
    return isinf(depth) ? depth : shade * depth;
}

/* Seen from the light, I_n = exp(-eta_n) (I_{n-1} + g_{n-1}) with g = forward eta I (Páleník 2016 Eq. 3.12, whose printed
 * form has exp(+eta_n) and lost exp(-eta_n) in its last term), so each step but the last, which the point stands in,
 * brings a factor (1 + forward eta). */
double march_harris(march_ray *ray, shape_dvec3 world, const march_way *way, double albedo)
{
    const shape_marcher *m = ray->marcher;
    shape_march_path *path = &ray->scratch->sun;
    double depth = 0, gain = 1, forward = m->options.forward * albedo;
    size_t count = 0;
    if (m->options.opaque && shape_opaque_blocks(m->options.opaque, world, way->direction, way->length))
        return 0;
    if (!ray->status)
        ray->status = march_path_find(m, path, world, way->direction, true, &count, ray->error);
    if (ray->status)
        return 0;
    for (size_t i = 0; i < count && (double)path->edges[i] < way->length; i += 2) {
        double from = (double)path->edges[i], length = fmin((double)path->edges[i + 1], way->length) - from;
        double steps = fmax(ceil(fmin(length / m->light_step, 1e6)), 1), width = length / steps;
        for (int k = 0; k < (int)steps; k++) {
            float t = (float)(from + width * (k + 0.5));
            double eta = m->options.shade * width * march_path_extinction(m, path, t);
            depth += eta;
            if (i || k)
                gain *= 1 + forward * eta;
        }
    }
    return exp(-depth) * gain;
}
