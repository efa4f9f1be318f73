/* How large the voxels of a fog volume may be for a view: rays of the picture are marched through the density and through
 * what trilinear voxels make of it, lit alike. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "budget/view.h"

enum { STEPS = 200, RUNGS = 24, CELLS = 12 };
static const double pi = 3.14159265358979323846, widest = 8; /* pixels */

/* Extinction of a cloud at a world point [1/m]. */
static double extinction_at(const shape_volume_cloud *cloud, shape_dvec3 world)
{
    shape_dvec3 p = shape_frame_point(&cloud->inverse, world);
    shape_vec3 at = {(float)p.x, (float)p.y, (float)p.z};
    return (double)(cloud->medium.extinction * shape_cloud_density(cloud, at));
}

/* The same between the eight voxel centres around it, at whole multiples of the edge. */
static double voxel_at(const shape_volume_cloud *cloud, shape_dvec3 world, double edge)
{
    double v[3] = {world.x / edge, world.y / edge, world.z / edge}, sum = 0;
    for (int corner = 0; corner < 8; corner++) {
        double at[3], weight = 1;
        for (int k = 0; k < 3; k++) {
            double low = floor(v[k]), part = v[k] - low;
            bool up = corner >> k & 1;
            at[k] = (low + up) * edge;
            weight *= up ? part : 1 - part;
        }
        if (weight > 0)
            sum += weight * extinction_at(cloud, shape_dvec3_make(at[0], at[1], at[2]));
    }
    return sum;
}

/* One ray, from a voxel before its first interval to one behind its last. edge 0: through the density itself. */
static void march_ray_through(const shape_marcher *m, const probe *p, int i, const float range[2],
                              double edge, double rgb[3])
{
    double width = ((double)range[1] - (double)range[0]) / STEPS, depth = 0;
    march_ray behind = {.marcher = m, .origin = p->eye, .direction = p->directions[i]};
    double back[3];
    memset(rgb, 0, 3 * sizeof *rgb);
    for (int k = 0; k < STEPS; k++) {
        double sigma = 0, added[3] = {0, 0, 0};
        shape_dvec3 world = shape_dvec3_add(
            p->eye, shape_dvec3_scale(p->directions[i], (double)range[0] + (k + 0.5) * width));
        for (size_t c = 0; c < m->volume->cloud_count; c++) {
            const march_cloud *lit = &m->clouds[c];
            if (!lit->seen)
                continue;
            double own = edge > 0 ? voxel_at(lit->cloud, world, edge) : extinction_at(lit->cloud, world);
            shape_dvec3 at = shape_frame_point(&lit->cloud->inverse, world);
            sigma += own;
            for (int k3 = 0; k3 < 3 && own > 0; k3++)
                added[k3] += own * march_grid_value(&lit->grid, lit->seen, 4, k3,
                                                    shape_vec3_make((float)at.x, (float)at.y, (float)at.z));
        }
        if (sigma > 0)
            for (int k3 = 0; k3 < 3; k3++)
                rgb[k3] += exp(-depth) * -expm1(-sigma * width) * added[k3] / sigma;
        depth += sigma * width;
    }
    march_background(&behind, NULL, back);
    for (int k = 0; k < 3; k++)
        rgb[k] += exp(-depth) * back[k];
}

/* Where each ray is in clouds, and two of the widest voxels more. */
static shape_status find_ranges(const shape_marcher *m, const probe *p, double margin, float (*ranges)[2],
                                shape_error *error)
{
    shape_march_scratch scratch;
    shape_status status = SHAPE_OK;
    memset(&scratch, 0, sizeof scratch);
    for (int i = 0; i < p->rays && !status; i++) {
        size_t count;
        status = march_path_find(m, &scratch.view, p->eye, p->directions[i], false, &count, error);
        ranges[i][0] = count ? fmaxf(scratch.view.edges[0] - (float)margin, 0) : 0;
        ranges[i][1] = count ? scratch.view.edges[count - 1] + (float)margin : 0;
    }
    shape_march_scratch_free(&scratch);
    return status;
}

static void march_all(const shape_marcher *m, const probe *p, float (*ranges)[2], double edge,
                      probe_picture *picture)
{
#pragma omp parallel for schedule(dynamic, 8)
    for (int i = 0; i < p->rays; i++)
        march_ray_through(m, p, i, (const float *)ranges[i], edge, picture->rgb + 3 * i);
}

/* A pixel's size at the nearest of the clouds seen, and their longest side [m]. */
static double footprint(const shape_volume *volume, const shape_view *view, const shape_budget_sight *sights,
                        double *side)
{
    double nearest = INFINITY;
    *side = 0;
    for (size_t i = 0; i < volume->cloud_count; i++) {
        const shape_volume_cloud *cloud = &volume->clouds[i];
        shape_dvec3 low, high;
        if (sights[i] != SHAPE_BUDGET_SEEN)
            continue;
        shape_frame_box(&cloud->frame, cloud->box, &low, &high);
        double across = shape_dvec3_length(shape_dvec3_sub(high, low));
        shape_dvec3 middle = shape_dvec3_scale(shape_dvec3_add(low, high), 0.5);
        double distance = shape_dvec3_length(shape_dvec3_sub(middle, view->eye)) - 0.5 * across;
        *side = fmax(*side, across);
        nearest = fmin(nearest, fmax(distance, 0.1 * across)); /* an eye within looks at what is before it */
    }
    return nearest * 2 * tan(view->fov * pi / 360) / view->height;
}

static shape_status choose(const shape_marcher *m, probe *p, const shape_view *view, double pixel,
                           double side, double allowed, double *edge, double *predicted, shape_error *error)
{
    float(*ranges)[2] = calloc(PROBE_RAYS, sizeof *ranges);
    probe_picture *pictures = malloc(2 * sizeof *pictures);
    shape_status status = ranges && pictures ? SHAPE_OK : shape_error_memory(error);
    *edge = fmin(widest * pixel, side / 8);
    if (!status)
        status = probe_open(p, m, view, error);
    if (!status)
        status = find_ranges(m, p, 2 * *edge, ranges, error);
    if (!status) {
        march_all(m, p, ranges, 0, &pictures[0]);
        for (int rung = 0; rung < RUNGS; rung++, *edge /= sqrt(2)) {
            march_all(m, p, ranges, *edge, &pictures[1]);
            *predicted = probe_change(p, &pictures[1], &pictures[0]);
            if (*predicted <= allowed || rung == RUNGS - 1)
                break;
        }
    }
    free(ranges);
    free(pictures);
    return status;
}

shape_status shape_budget_voxel(const shape_volume *volume, const shape_view *view, const shape_light *light,
                                double allowed, double *edge, double *predicted, bool *seen,
                                shape_error *error)
{
    shape_march_options options = shape_march_defaults();
    shape_marcher *marcher = NULL;
    double side;
    *seen = false;
    if (!(allowed >= 1e-4 && allowed <= 1))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "an error of %g (it must be 0.0001 to 1)",
                               allowed);
    shape_status status = shape_view_check(view, error);
    if (!status)
        status = shape_light_check(light, error);
    if (status)
        return status;
    shape_budget_sight *sights = calloc(volume->cloud_count + 1, sizeof *sights);
    int *resolutions = calloc(volume->cloud_count + 1, sizeof *resolutions);
    probe *p = malloc(sizeof *p);
    if (!sights || !resolutions || !p)
        status = shape_error_memory(error);
    if (!status) {
        shape_budget_sights(volume, view, light, NULL, allowed, sights);
        for (size_t i = 0; i < volume->cloud_count; i++) {
            resolutions[i] = sights[i] == SHAPE_BUDGET_SEEN ? CELLS : 0;
            *seen = *seen || resolutions[i];
        }
        options.resolutions = resolutions;
    }
    if (!status && *seen)
        status = shape_marcher_create(volume, light, view->eye, &options, &marcher, error);
    if (!status && *seen) {
        double pixel = footprint(volume, view, sights, &side);
        status = choose(marcher, p, view, pixel, side, allowed, edge, predicted, error);
    }
    shape_marcher_destroy(marcher);
    free(sights);
    free(resolutions);
    free(p);
    return status;
}
