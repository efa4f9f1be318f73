/* A light grid as one eye sees it: the sum of shaders/light/lightgrid.glsl, once a cell rather than once a step. */
#include <math.h>

#include "shape/lightgrid.h"
#include "shape/phase.h"

typedef struct seen_light {
    float sun[3], upper[3], lower[3]; /* albedo included, but of a grid with albedos */
    float mean_cosine, peak, rest;
} seen_light;

static float hg(float g, float cosine)
{
    float d = 1 + g * g - 2 * g * cosine;
    return (1 - g * g) / (12.566371f * d * sqrtf(d));
}

static void see_cell(const seen_light *l, const float *cell, float albedo, float phase, float cos_sun,
                     shape_vec3 travel, float travel_up, float *rgba)
{
    float direct = expf(-cell[0]), wide = expf(-(1 - albedo * l->peak) * cell[0]);
    float beam = direct * phase + (1 - l->peak) * (wide - direct) * hg(l->rest, cos_sun);
    float sun = cell[1] + 3 * l->mean_cosine * (cell[4] * travel.x + cell[5] * travel.y + cell[6] * travel.z);
    float upper = cell[2] + 3 * l->mean_cosine * cell[7] * travel_up;
    sun = beam + (sun > 0 ? sun : 0);
    upper = upper > 0 ? upper : 0;
    for (int i = 0; i < 3; i++)
        rgba[i] = l->sun[i] * sun + l->upper[i] * upper + l->lower[i] * cell[3];
    rgba[3] = 0;
}

void shape_lightgrid_seen(const shape_lightgrid *grid, const shape_volume_cloud *cloud,
                          const shape_light *light, const float sky_upper[3], const float sky_lower[3],
                          shape_dvec3 eye, float *rgba)
{
    const shape_medium *medium = &cloud->medium;
    seen_light l = {.mean_cosine = shape_phase_mean_cosine(medium)};
    shape_delta_scaling(l.mean_cosine, &l.peak, &l.rest);
    float albedo = grid->albedos ? 1 : medium->albedo;
    for (int i = 0; i < 3; i++) {
        l.sun[i] = albedo * light->sun_irradiance[i];
        l.upper[i] = albedo * sky_upper[i];
        l.lower[i] = albedo * sky_lower[i];
    }
    const double(*m)[4] = cloud->frame.m;
    shape_dvec3 e = shape_frame_point(&cloud->inverse, eye);
    shape_vec3 size = shape_vec3_sub(grid->box.max, grid->box.min);
    int rows = grid->size[1] * grid->size[2];
#pragma omp parallel for schedule(static) if (rows > 256)
    for (int row = 0; row < rows; row++)
        for (int x = 0; x < grid->size[0]; x++) {
            size_t cell = (size_t)row * (size_t)grid->size[0] + (size_t)x;
            shape_vec3 v = {
                grid->box.min.x + size.x * ((float)x + 0.5f) / (float)grid->size[0] - (float)e.x,
                grid->box.min.y + size.y * ((float)(row % grid->size[1]) + 0.5f) / (float)grid->size[1] -
                    (float)e.y,
                grid->box.min.z + size.z * ((float)(row / grid->size[1]) + 0.5f) / (float)grid->size[2] -
                    (float)e.z};
            /* The direction in which one looks, in the cloud's frame and in the world. */
            v = shape_vec3_scale(v, 1 / fmaxf(shape_vec3_length(v), 1e-20f));
            shape_vec3 w = {(float)(m[0][0] * (double)v.x + m[0][1] * (double)v.y + m[0][2] * (double)v.z),
                            (float)(m[1][0] * (double)v.x + m[1][1] * (double)v.y + m[1][2] * (double)v.z),
                            (float)(m[2][0] * (double)v.x + m[2][1] * (double)v.y + m[2][2] * (double)v.z)};
            w = shape_vec3_scale(w, 1 / fmaxf(shape_vec3_length(w), 1e-20f));
            float cos_sun = w.x * (float)light->sun.x + w.y * (float)light->sun.y + w.z * (float)light->sun.z;
            float phase =
                medium->phase == SHAPE_PHASE_HG ? hg(medium->g, cos_sun) : shape_phase(medium, cos_sun);
            see_cell(&l, grid->cells + cell * SHAPE_LIGHTGRID_VALUES,
                     grid->albedos ? grid->albedos[cell] : medium->albedo, phase, cos_sun,
                     shape_vec3_scale(v, -1), -w.y, rgba + cell * 4);
        }
}
