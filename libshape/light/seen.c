/* A light grid as one eye sees it: the sum of shaders/light/lightgrid.glsl, once a cell rather than once a step. What is
 * between cells is interpolated, so a cell stands for the directions from the eye to all points around its middle, and near
 * the eye these are many: there the means over them are taken, or whole pictures would flash when the eye passes a cell
 * that lies before the sun. */
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

/* A phase function's mean over the points that a cell stands for, at a mean distance of `away2` cells, squared; same: see
 * see_cell. That of Henyey and Greenstein with its peak cut: the form and the two numbers were fitted to means by drawing
 * such points, as tests/test_lightgrid.c does. */
static float mean_phase(const shape_medium *medium, float cosine, float same, float away2)
{
    float blunt = 0.2f * same / (away2 + 1.5f), g = same * medium->g;
    if (medium->phase != SHAPE_PHASE_HG)
        return same * shape_phase(medium, fmaxf(cosine - 0.6f * blunt, -1)) + (1 - same) / 12.566371f;
    float d = 1 + g * g - 2 * g * cosine + blunt;
    return (1 - g * g) / (12.566371f * d * sqrtf(d));
}

/* same: the mean cosine between the direction to the cell's middle and those to the points that it stands for. */
static void see_cell(const seen_light *l, const float *cell, float albedo, float phase, float cos_sun,
                     float same, shape_vec3 travel, float travel_up, float *rgba)
{
    float direct = expf(-cell[0]), wide = expf(-(1 - albedo * l->peak) * cell[0]);
    float beam = direct * phase + (1 - l->peak) * (wide - direct) * hg(same * l->rest, cos_sun);
    float turned = 3 * same * l->mean_cosine;
    float sun = cell[1] + turned * (cell[4] * travel.x + cell[5] * travel.y + cell[6] * travel.z);
    float upper = cell[2] + turned * cell[7] * travel_up;
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
    float edge2 = 0;
    for (int axis = 0; axis < 3; axis++) {
        float edge = (&size.x)[axis] / (float)grid->size[axis];
        edge2 += edge * edge / 3;
    }
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
            /* A point lies beside the middle that it is interpolated from by the square root of a sixth of a cell, rms,
             * along each axis: two of them turn the direction, by a cosine of 1 - 1/6 over the distance's square, in cells;
             * nearly the same, with the limit 0 at the eye: */
            float away2 = shape_vec3_dot(v, v) / fmaxf(edge2, 1e-30f), same = away2 / (away2 + 1.0f / 6);
            /* The direction in which one looks, in the cloud's frame and in the world. */
            v = shape_vec3_scale(v, 1 / fmaxf(shape_vec3_length(v), 1e-20f));
            shape_vec3 w = {(float)(m[0][0] * (double)v.x + m[0][1] * (double)v.y + m[0][2] * (double)v.z),
                            (float)(m[1][0] * (double)v.x + m[1][1] * (double)v.y + m[1][2] * (double)v.z),
                            (float)(m[2][0] * (double)v.x + m[2][1] * (double)v.y + m[2][2] * (double)v.z)};
            w = shape_vec3_scale(w, 1 / fmaxf(shape_vec3_length(w), 1e-20f));
            float cos_sun = w.x * (float)light->sun.x + w.y * (float)light->sun.y + w.z * (float)light->sun.z;
            float phase = mean_phase(medium, cos_sun, same, away2);
            see_cell(&l, grid->cells + cell * SHAPE_LIGHTGRID_VALUES,
                     grid->albedos ? grid->albedos[cell] : medium->albedo, phase, cos_sun, same,
                     shape_vec3_scale(v, -1), -w.y, rgba + cell * 4);
        }
}
