/* The light grid of 2018, for comparison only: Jiménez Eq. 7, marched from each cell to the sun by the sweep of
 * Algorithm 2, each step with the density of the sphere that the sweep is in. */
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "base/stop.h"
#include "shape/lightgrid.h"

static float own_density(const shape_volume_cloud *cloud, shape_ray ray, const shape_candidate *c, float t)
{
    float u2 = cloud->support * cloud->support + c->a * (t - c->t_in) * (t - c->t_out);
    return shape_cloud_density_at(cloud, shape_vec3_add(ray.origin, shape_vec3_scale(ray.direction, t)),
                                  u2 < 0 ? 0 : u2);
}

/* Marches one cloud; transmittance runs on, *scattered collects Eq. 6's forward light. False where it was broken off. */
static bool sweep(const shape_volume_cloud *cloud, shape_ray ray, const shape_candidates *found, float step,
                  stop_watch *watch, double *transmittance, double *scattered)
{
    enum { STEP_WORK = 16 };
    const double forward = 0.5 * 0.0001 / (4 * 3.14159265358979323846); /* Eq. 6 */
    float t = 0;
    for (size_t i = 0; i < found->count; i++) {
        const shape_candidate *c = &found->items[i];
        if (t > c->t_out)
            continue;
        /* Below a millionth of t a step would stand still. */
        for (t = t > c->t_in ? t : c->t_in; t <= c->t_out && *transmittance > 1e-9;
             t += fmaxf(step, 1e-6f * t)) {
            if (stop_after(watch, STEP_WORK))
                return false;
            *scattered += forward * *transmittance * (double)step;
            *transmittance *= exp(-(double)(own_density(cloud, ray, c, t) * cloud->medium.extinction * step));
        }
    }
    return true;
}

static shape_status receive(const shape_volume *volume, shape_dvec3 point, shape_dvec3 sun, float step,
                            shape_candidates *scratch, stop_watch *watch, float *light, shape_error *error)
{
    double transmittance = 1, scattered = 0;
    for (size_t i = 0; i < volume->cloud_count; i++) {
        const shape_volume_cloud *cloud = &volume->clouds[i];
        shape_ray ray = shape_volume_ray(cloud, point, sun);
        float t0 = 0, t1 = 1e30f;
        if (!shape_box_intersect(cloud->box, ray, &t0, &t1))
            continue;
        shape_status status = shape_cloud_candidates(cloud, ray, t0, t1, scratch, error);
        if (status)
            return status;
        if (!sweep(cloud, ray, scratch, step, watch, &transmittance, &scattered))
            return stop_error(error);
    }
    *light = (float)(transmittance + scattered);
    return SHAPE_OK;
}

shape_status shape_lightgrid_build_2018(const shape_volume *volume, size_t index, const shape_light *light,
                                        int resolution, float step, shape_lightgrid *grid, shape_error *error)
{
    return shape_lightgrid_build_2018_with(volume, index, light, resolution, step, (shape_stop){0}, grid,
                                           error);
}

shape_status shape_lightgrid_build_2018_with(const shape_volume *volume, size_t index,
                                             const shape_light *light, int resolution, float step,
                                             shape_stop stop, shape_lightgrid *grid, shape_error *error)
{
    memset(grid, 0, sizeof *grid);
    if (index >= volume->cloud_count || resolution < 2 || resolution > 256 || !(step > 0))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "a light grid of %d cells with step %g (2 to 256, above 0)", resolution,
                               (double)step);
    const shape_volume_cloud *cloud = &volume->clouds[index];
    int rows = resolution * resolution, n = resolution;
    grid->size[0] = grid->size[1] = grid->size[2] = n;
    grid->box = shape_box_is_empty(cloud->box) ? (shape_box){{0, 0, 0}, {1, 1, 1}} : cloud->box;
    grid->cells = calloc((size_t)rows * (size_t)n * SHAPE_LIGHTGRID_VALUES, sizeof *grid->cells);
    if (!grid->cells)
        return shape_error_memory(error);
    shape_vec3 low = grid->box.min, size = shape_vec3_sub(grid->box.max, grid->box.min);
    shape_status status = SHAPE_OK;
#pragma omp parallel
    {
        shape_candidates scratch = {.stop = stop};
        stop_watch watch = {.stop = stop};
        shape_error own = {0};
#pragma omp for schedule(dynamic, 8)
        for (int row = 0; row < rows; row++)
            for (int x = 0; x < n && !own.status; x++) {
                double p[3] = {low.x + size.x * (x + 0.5f) / n, low.y + size.y * (row % n + 0.5f) / n,
                               low.z + size.z * (row / n + 0.5f) / n};
                shape_dvec3 world = shape_frame_point(&cloud->frame, shape_dvec3_make(p[0], p[1], p[2]));
                receive(volume, world, light->sun, step, &scratch, &watch,
                        grid->cells + ((size_t)row * (size_t)n + (size_t)x) * SHAPE_LIGHTGRID_VALUES, &own);
            }
        shape_candidates_free(&scratch);
        shape_error_join(&own, &status, error);
    }
    if (status)
        shape_lightgrid_free(grid);
    return status;
}
