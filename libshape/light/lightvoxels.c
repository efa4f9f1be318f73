/* The mean radiance at a point from a light grid: its zeroth moment, with the sun's direct beam, thinned by what is
 * scattered out of the forward peak only (the delta-Eddington scaling of Joseph, Wiscombe and Weinman 1976). */
#include "shape/lightvoxels.h"

#include <stdlib.h>
#include <string.h>

#include "shape/phase.h"

shape_status shape_lightvoxels_build(const shape_volume *volume, const shape_light *light, int resolution,
                                     int threads, shape_lightvoxels *made, shape_error *error)
{
    memset(made, 0, sizeof *made);
    made->volume = volume;
    made->grids = calloc(volume->cloud_count + 1, sizeof *made->grids);
    made->thin = calloc(volume->cloud_count + 1, sizeof *made->thin);
    shape_status status = made->grids && made->thin ? SHAPE_OK : shape_error_memory(error);
    shape_lightgrid_options options = shape_lightgrid_defaults();
    options.resolution = resolution;
    options.threads = threads;
    for (size_t i = 0; i < volume->cloud_count && !status; i++) {
        const shape_medium *medium = &volume->clouds[i].medium;
        float peak, rest;
        shape_delta_scaling(shape_phase_mean_cosine(medium), &peak, &rest);
        made->thin[i] = 1 - medium->albedo * peak;
        if (shape_primitives_count(volume->clouds[i].list))
            status = shape_lightgrid_build(volume, i, light, &options, &made->grids[i], error);
    }
    shape_sky sky = shape_sky_make(light);
    shape_sky_mean(&sky, made->upper, made->lower);
    memcpy(made->sun, light->sun_irradiance, sizeof made->sun);
    if (status)
        shape_lightvoxels_free(made);
    return status;
}

void shape_lightvoxels_free(shape_lightvoxels *made)
{
    for (size_t i = 0; made->grids && i < made->volume->cloud_count; i++)
        shape_lightgrid_free(&made->grids[i]);
    free(made->grids);
    free(made->thin);
    memset(made, 0, sizeof *made);
}

/* The first four values of a grid at a point, trilinear; at the border the outermost cells'. */
static void look_up(const shape_lightgrid *grid, shape_vec3 p, float value[4])
{
    size_t low[3], high[3];
    float part[3];
    for (int k = 0; k < 3; k++) {
        float min = (&grid->box.min.x)[k], max = (&grid->box.max.x)[k], last = (float)(grid->size[k] - 1);
        float at = ((&p.x)[k] - min) / (max - min) * (float)grid->size[k] - 0.5f;
        at = at > 0 ? at < last ? at : last : 0;
        low[k] = (size_t)at;
        high[k] = low[k] + 1 < (size_t)grid->size[k] ? low[k] + 1 : low[k];
        part[k] = at - (float)low[k];
    }
    for (int i = 0; i < 4; i++)
        value[i] = 0;
    for (int corner = 0; corner < 8; corner++) {
        size_t at[3];
        float weight = 1;
        for (int k = 0; k < 3; k++) {
            at[k] = corner >> k & 1 ? high[k] : low[k];
            weight *= corner >> k & 1 ? part[k] : 1 - part[k];
        }
        const float *cell =
            grid->cells + ((at[2] * (size_t)grid->size[1] + at[1]) * (size_t)grid->size[0] + at[0]) *
                              SHAPE_LIGHTGRID_VALUES;
        for (int i = 0; i < 4; i++)
            value[i] += weight * cell[i];
    }
}

void shape_lightvoxels_sample(const void *context, size_t cloud, shape_vec3 p, float value[3])
{
    const shape_lightvoxels *light = context;
    float cell[4];
    look_up(&light->grids[cloud], p, cell);
    float sun = expf(-light->thin[cloud] * cell[0]) / 12.566371f + cell[1];
    for (int i = 0; i < 3; i++)
        value[i] = light->sun[i] * sun + light->upper[i] * cell[2] + light->lower[i] * cell[3];
}
