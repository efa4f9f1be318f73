/* A light grid as one eye sees it, once a cell rather than once a step: the source function towards the eye. What is
 * between cells is interpolated, so a cell stands for the directions from the eye to all points around its middle, and
 * near the eye these are many: there the means over them are taken. The sun's first scattering, whose phase function is
 * a constant of the ray, is left to the rays (beam.c): by cells, pictures flashed when the eye passed one that lay
 * before the sun.
 *
 * With f the share of scattering that the delta scaling takes as going straight on, p the phase function and r = min(p,
 * cap) what is left of it without its peak (Potter 1970: the cap makes r's integral 1 - f), the source is, with the
 * rays' share,
 *
 *   E B + f (1 - h) L + (1 - f) (mean + 3 g_r flux of what was scattered otherwise)
 *
 * B is the rays' share (beam.c), in cells only its part with r, since that is what L is made of; g_r is the mean cosine
 * of r: with g', that of the delta scaling, a surface lit from the eye's side was up to a fifth too bright. L is the
 * radiance that comes through the grid along the ray (seen_sweep.c), the sky behind it as often turned as it was
 * scattered within the peak (skyspread.c), and h is what stays on the ray itself near the eye (shape_beam_straight; of
 * clouds of several colours nothing, whose extinction is one for all). To first order it would be mean + 3 flux, which
 * at the cloud's surface, where all light goes one way, is a fifth too much: the light there is a step, not a cosine. */
#include <math.h>
#include <stdlib.h>

#include "light/seen.h"
#include "light/skyspread.h"
#include "shape/beam.h"
#include "shape/phase.h"

typedef struct seen_light {
    float sun[3], upper[3], lower[3];
    shape_vec3 to_sun;
    shape_beam_peak peak;
} seen_light;

static seen_grid make_grid(const shape_lightgrid *grid, const shape_volume_cloud *cloud, const shape_sky *sky,
                           shape_dvec3 eye)
{
    seen_grid s = {.grid = grid, .cloud = cloud, .sky = sky};
    shape_dvec3 e = shape_frame_point(&cloud->inverse, eye);
    shape_vec3 size = shape_vec3_sub(grid->box.max, grid->box.min);
    s.eye = shape_vec3_make((float)e.x, (float)e.y, (float)e.z);
    for (int axis = 0; axis < 3; axis++) {
        float edge = (&size.x)[axis] / (float)grid->size[axis];
        float before = ((&s.eye.x)[axis] - (&grid->box.min.x)[axis]) / fmaxf(edge, 1e-30f);
        (&s.edge.x)[axis] = edge;
        s.turn[axis] = before > 0.5f ? (int)fminf(before + 0.5f, (float)grid->size[axis]) : 0;
    }
    return s;
}

/* A cell's light that was scattered before, in one direction. */
static float first_order(float mean, float turned, const float *flux, shape_vec3 travel)
{
    return fmaxf(mean + turned * (flux[0] * travel.x + flux[1] * travel.y + flux[2] * travel.z), 0);
}

/* All that a cell sends to the eye but f L and the sun's first scattering goes into rgba, whose [3] is the share of L that is
 * meant; what a ray takes on in it into added. */
static void add_sources(const seen_grid *s, const seen_light *l, const seen_cell *look, size_t index,
                        float *rgba, seen_lanes *added)
{
    static const float none[SHAPE_LIGHTGRID_FLUXES] = {0};
    const shape_medium *medium = &s->cloud->medium;
    const float *cell = s->grid->cells + index * SHAPE_LIGHTGRID_VALUES;
    const float *fluxes = s->grid->fluxes ? s->grid->fluxes + index * SHAPE_LIGHTGRID_FLUXES : none;
    const shape_vec3 v = look->v, e = s->edge,
                     travel = shape_vec3_scale(v, -1 / fmaxf(shape_vec3_length(v), 1e-20f));
    /* A point lies beside the middle that it is interpolated from by the square root of a sixth of a cell, rms, along each
     * axis: two of them turn the direction, by a cosine of 1 - 1/6 over the distance's square, in cells; nearly the same,
     * with the limit 0 at the eye: */
    float edge2 = (e.x * e.x + e.y * e.y + e.z * e.z) / 3;
    float away2 = shape_vec3_dot(v, v) / fmaxf(edge2, 1e-30f), same = away2 / (away2 + 1.0f / 6);
    float phase = shape_phase(medium, shape_vec3_dot(look->world, l->to_sun));
    float blunt = fminf(same * phase + (1 - same) / 12.566371f, l->peak.cap);
    float albedo = s->grid->albedos ? s->grid->albedos[index] : medium->albedo, thin = 1 - albedo * s->peak;
    float turned = 3 * same * l->peak.rest, kept = 1 - s->peak, beam = expf(-thin * cell[0]) * blunt;
    float sun = kept * first_order(cell[1], turned, cell + 4, travel);
    float upper = kept * first_order(cell[2], turned, fluxes + 1, travel);
    float lower = kept * first_order(cell[3], turned, fluxes + 4, travel);
    const shape_vec3 cells = shape_vec3_make(v.x / e.x, v.y / e.y, v.z / e.z);
    float straight = s->peak * (s->grid->albedos ? 1 : 1 - shape_beam_straight(shape_vec3_dot(cells, cells)));
    float even = straight * (s->swept ? 1 - same : 1);
    float scattered = thin > 1e-6f ? fluxes[0] * albedo / thin : 0;
    for (int c = 0; c < 3; c++) {
        float source = l->sun[c] * sun + l->upper[c] * upper + l->lower[c] * lower;
        (*added)[c] = scattered * (source + l->sun[c] * beam);
        rgba[c] = source + even * (l->sun[c] * cell[1] + l->upper[c] * cell[2] + l->lower[c] * cell[3]);
    }
    (*added)[3] = fluxes[0];
    rgba[3] = s->swept ? straight * same : 0;
}

static void add_all(const seen_grid *s, const seen_light *l, float *rgba, seen_lanes *added,
                    seen_lanes *arriving)
{
    const int *n = s->grid->size, rows = n[1] * n[2];
#pragma omp parallel for schedule(static) if (rows > 256)
    for (int row = 0; row < rows; row++)
        for (int x = 0; x < n[0]; x++) {
            const int at[3] = {x, row % n[1], row / n[1]};
            size_t i = (size_t)row * (size_t)n[0] + (size_t)x;
            seen_cell look = seen_look(s, at);
            add_sources(s, l, &look, i, rgba + 4 * i, &added[i]);
            arriving[i] = (seen_lanes){0, 0, 0, look.away};
        }
}

/* The sky from behind: what comes through has been scattered within the peak on its way, and is so once more. */
static void add_sky(const seen_grid *s, seen_lanes *arriving)
{
    const float least = 1e-5f, inside = s->cloud->medium.albedo * s->peak;
    const float each = inside / fmaxf(1 - inside, 1e-5f); /* of such scatterings to one that ends the way */
    const int *n = s->grid->size, rows = n[1] * n[2];
#pragma omp parallel for schedule(dynamic, 8) if (rows > 256)
    for (int row = 0; row < rows; row++)
        for (int x = 0; x < n[0]; x++) {
            const int at[3] = {x, row % n[1], row / n[1]};
            const size_t i = (size_t)row * (size_t)n[0] + (size_t)x;
            const float through = arriving[i][3];
            if (!(through > least))
                continue;
            const shape_vec3 from = seen_look(s, at).world;
            float rgb[3];
            if (s->grid->sky) {
                arriving[i] += through * skyspread_look(s->grid->sky, from, 1 - each * logf(through));
            } else {
                shape_sky_radiance(s->sky, from, rgb);
                arriving[i] += through * (seen_lanes){rgb[0], rgb[1], rgb[2], 0};
            }
        }
}

shape_status shape_lightgrid_seen(const shape_lightgrid *grid, const shape_volume_cloud *cloud,
                                  const shape_light *light, const shape_sky *sky, const float sky_upper[3],
                                  const float sky_lower[3], shape_dvec3 eye, float *rgba, shape_error *error)
{
    const size_t cells = (size_t)grid->size[0] * (size_t)grid->size[1] * (size_t)grid->size[2];
    seen_grid s = make_grid(grid, cloud, sky, eye);
    seen_light l = {.to_sun = shape_vec3_make((float)light->sun.x, (float)light->sun.y, (float)light->sun.z)};
    seen_lanes *added = malloc(cells * sizeof *added), *arriving = malloc(cells * sizeof *arriving);
    if (!added || !arriving) {
        free(added);
        free(arriving);
        return shape_error_memory(error);
    }
    float rest;
    shape_delta_scaling(shape_phase_mean_cosine(&cloud->medium), &s.peak, &rest);
    l.peak = shape_beam_peak_make(&cloud->medium);
    for (int c = 0; c < 3; c++) {
        l.sun[c] = light->sun_irradiance[c];
        l.upper[c] = sky_upper[c];
        l.lower[c] = sky_lower[c];
    }
    s.swept = s.peak > 0 && grid->fluxes;
    add_all(&s, &l, rgba, added, arriving);
    if (s.swept) {
        seen_sweep(&s, added, arriving);
        add_sky(&s, arriving);
    }
    float albedo = grid->albedos ? 1 : cloud->medium.albedo;
    for (size_t i = 0; i < cells; i++) {
        float thin = fmaxf(1 - s.peak * (grid->albedos ? grid->albedos[i] : cloud->medium.albedo), 1e-6f);
        for (int c = 0; c < 3; c++)
            rgba[4 * i + (size_t)c] = albedo * (rgba[4 * i + (size_t)c] + rgba[4 * i + 3] * arriving[i][c]);
        rgba[4 * i + 3] = expf(-thin * grid->cells[i * SHAPE_LIGHTGRID_VALUES]);
    }
    free(added);
    free(arriving);
    return SHAPE_OK;
}
