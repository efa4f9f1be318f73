/* The light pass over a grid (Jiménez 2018 section 3.5, first pass): the optical depth to the sun by no duplicate
 * tracing, and the scattered light that the paper leaves out, by discrete ordinates. */
#include "shape/lightgrid.h"

#include <limits.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "light/lightgrid_density.h"
#include "light/lightgrid_layout.h"
#include "light/ordinates.h"
#include "light/skyspread.h"
#include "light/sunsweep.h"
#include "shape/phase.h"

static const float DEEPEST = 60000; /* a half-float's range */

shape_lightgrid_options shape_lightgrid_defaults(void)
{
    shape_lightgrid_options options = {
        .resolution = 48, .step = 0.5f, .scattering = true, .threads = 0, .channel = -1};
    return options;
}

void shape_delta_scaling(float g, float *share, float *rest)
{
    *share = g > 0 ? g * g : 0;
    *rest = g > 0 ? g / (1 + g) : g;
}

/* The step of the march to the sun: set by the finest noise of any cloud. */
static float choose_step(const shape_volume *volume, float share)
{
    /* A stranger's file may name a noise of a nanometre: no cloud needs more than a few thousand steps across. */
    const double most_steps = 4096;
    double least = INFINITY, extent = 0;
    for (size_t i = 0; i < volume->cloud_count; i++) {
        const shape_volume_cloud *cloud = &volume->clouds[i];
        double scale = cbrt(fabs(shape_frame_determinant(&cloud->frame)));
        double across = (double)shape_vec3_length(shape_vec3_sub(cloud->box.max, cloud->box.min));
        least = fmin(least, scale / (double)cloud->inverse_noise_scale);
        if (!shape_box_is_empty(cloud->box))
            extent = fmax(extent, scale * across);
    }
    return (float)fmax(least * (double)share, extent / most_steps);
}

typedef struct sun_pass {
    const shape_volume *volume;
    const shape_volume_cloud *cloud;
    shape_dvec3 sun;
    float step;
    const shape_opaque *opaque;
    shape_stop stop;
} sun_pass;

static shape_status march_row(const sun_pass *pass, shape_lightgrid *grid, int y, int z,
                              shape_candidates *scratch, shape_error *error)
{
    float *row = grid->cells + ((size_t)z * (size_t)grid->size[1] + (size_t)y) * (size_t)grid->size[0] *
                                   SHAPE_LIGHTGRID_VALUES;
    for (int x = 0; x < grid->size[0]; x++) {
        shape_vec3 p = lightgrid_point(grid, x, y, z, 0.5f, 0.5f, 0.5f);
        shape_dvec3 world = shape_frame_point(&pass->cloud->frame, shape_dvec3_make(p.x, p.y, p.z));
        double depth = (double)DEEPEST;
        shape_status status = SHAPE_OK;
        if (!shape_opaque_blocks(pass->opaque, world, pass->sun, INFINITY))
            status = shape_volume_optical_depth(pass->volume, world, pass->sun, 0, 1e30f, pass->step, scratch,
                                                &depth, error);
        if (status)
            return status;
        row[(size_t)x * SHAPE_LIGHTGRID_VALUES] = (float)fmin(depth, (double)DEEPEST);
    }
    return SHAPE_OK;
}

static shape_status march_to_sun(const sun_pass *pass, int threads, shape_lightgrid *grid, shape_error *error)
{
    int rows = grid->size[1] * grid->size[2];
    shape_status status = SHAPE_OK;
#pragma omp parallel num_threads(threads)
    {
        shape_candidates scratch = {.stop = pass->stop};
        shape_error own = {0};
#pragma omp for schedule(dynamic, 4)
        for (int i = 0; i < rows; i++) {
            if (!own.status)
                march_row(pass, grid, i % grid->size[1], i / grid->size[1], &scratch, &own);
        }
        shape_error_join(&own, &status, error);
        shape_candidates_free(&scratch);
    }
    return status;
}

/* Of a coloured cloud the channel's mean albedo of each cell, weighed by the density. */
static void fill_albedos(const shape_volume_cloud *cloud, const shape_lightgrid *grid, int channel,
                         int threads)
{
    int rows = grid->size[1] * grid->size[2];
#pragma omp parallel for schedule(dynamic, 4) num_threads(threads)
    for (int i = 0; i < rows; i++)
        for (int x = 0; x < grid->size[0]; x++) {
            float sum = 0, scattered = 0;
            for (int corner = 0; corner < 8; corner++) {
                float rgb[3];
                shape_vec3 p =
                    lightgrid_point(grid, x, i % grid->size[1], i / grid->size[1], corner & 1 ? 0.75f : 0.25f,
                                    corner & 2 ? 0.75f : 0.25f, corner & 4 ? 0.75f : 0.25f);
                float density = shape_cloud_density(cloud, p);
                shape_cloud_albedo(cloud, p, rgb);
                sum += density;
                scattered += density * rgb[channel];
            }
            grid->albedos[(size_t)i * (size_t)grid->size[0] + (size_t)x] = sum > 0 ? scattered / sum : 0;
        }
}

/* A grid of half as many cells a side: means of extinction and beam. */
static void coarsen(const int size[3], const float *fine, const int coarse_size[3], float *coarse)
{
    for (int z = 0; z < coarse_size[2]; z++)
        for (int y = 0; y < coarse_size[1]; y++)
            for (int x = 0; x < coarse_size[0]; x++) {
                float sum = 0;
                int count = 0;
                for (int corner = 0; corner < 8; corner++) {
                    int a = 2 * x + (corner & 1), b = 2 * y + (corner >> 1 & 1), c = 2 * z + (corner >> 2);
                    if (a < size[0] && b < size[1] && c < size[2]) {
                        sum += fine[((size_t)c * (size_t)size[1] + (size_t)b) * (size_t)size[0] + (size_t)a];
                        count++;
                    }
                }
                coarse[((size_t)z * (size_t)coarse_size[1] + (size_t)y) * (size_t)coarse_size[0] +
                       (size_t)x] = sum / (float)count;
            }
}

static void refine(const int coarse_size[3], const float *coarse, const int size[3], float *fine)
{
    for (int z = 0; z < size[2]; z++)
        for (int y = 0; y < size[1]; y++)
            for (int x = 0; x < size[0]; x++) {
                size_t from =
                    ((size_t)(z / 2) * (size_t)coarse_size[1] + (size_t)(y / 2)) * (size_t)coarse_size[0] +
                    (size_t)(x / 2);
                size_t to = ((size_t)z * (size_t)size[1] + (size_t)y) * (size_t)size[0] + (size_t)x;
                memcpy(fine + to * ORDINATES_CELL, coarse + from * ORDINATES_CELL,
                       ORDINATES_CELL * sizeof *fine);
            }
}

/* The same without steps between the cells: trilinear. */
static void smooth(const int coarse_size[3], const float *coarse, const int size[3], float *fine)
{
    for (int z = 0; z < size[2]; z++)
        for (int y = 0; y < size[1]; y++)
            for (int x = 0; x < size[0]; x++) {
                const int at[3] = {x, y, z};
                size_t low[3], high[3];
                float part[3],
                    *out = fine + (((size_t)z * (size_t)size[1] + (size_t)y) * (size_t)size[0] + (size_t)x) *
                                      ORDINATES_CELL;
                for (int k = 0; k < 3; k++) {
                    int below = (at[k] - 1) / 2,
                        last = coarse_size[k] - 1; /* the middle of 2 i, 2 i + 1 is i's */
                    low[k] = (size_t)below;
                    high[k] = (size_t)(at[k] > 0 && below < last ? below + 1 : below);
                    part[k] = at[k] % 2 ? 0.25f : 0.75f;
                }
                memset(out, 0, ORDINATES_CELL * sizeof *out);
                for (int corner = 0; corner < 8; corner++) {
                    size_t from = 0;
                    float weight = 1;
                    for (int k = 2; k >= 0; k--) {
                        from = from * (size_t)coarse_size[k] + (corner >> k & 1 ? high[k] : low[k]);
                        weight *= corner >> k & 1 ? part[k] : 1 - part[k];
                    }
                    for (int i = 0; i < ORDINATES_CELL; i++)
                        out[i] += weight * coarse[from * ORDINATES_CELL + (size_t)i];
                }
            }
}

/* Solves on a grid of half the size first, down to a few cells, and takes that as the first guess: light travels across
 * the coarse grid in few rounds. Grids of more than `finest` cells along their longest side are not solved but filled from
 * the next coarser one. */
static shape_status solve_levels(ordinates_problem *p, int finest, int threads, shape_error *error)
{
    enum { SMALL = 8, ROUNDS = 64, FIRST_ROUNDS = 400 };
    const float tolerance = 0.003f;
    int longest = p->size[0] > p->size[1] ? p->size[0] : p->size[1];
    longest = longest > p->size[2] ? longest : p->size[2];
    if (longest <= SMALL && longest <= finest)
        return ordinates_solve(p, FIRST_ROUNDS, finest < INT_MAX ? tolerance : 0.1f * tolerance, threads,
                               error);
    ordinates_problem half = *p;
    for (int axis = 0; axis < 3; axis++) {
        half.size[axis] = (p->size[axis] + 1) / 2;
        half.cell[axis] = 2 * p->cell[axis];
    }
    size_t cells = (size_t)half.size[0] * (size_t)half.size[1] * (size_t)half.size[2];
    float *extinction = malloc(cells * sizeof *extinction), *beam = malloc(cells * sizeof *beam);
    float *shares = p->shares ? malloc(cells * sizeof *shares) : NULL;
    half.moments = calloc(cells * ORDINATES_CELL, sizeof *half.moments);
    shape_status status = SHAPE_OK;
    if (!extinction || !beam || !half.moments || !shares != !p->shares)
        status = shape_error_memory(error);
    if (!status) {
        coarsen(p->size, p->extinction, half.size, extinction);
        coarsen(p->size, p->beam, half.size, beam);
        half.extinction = extinction;
        half.beam = beam;
        if (shares)
            coarsen(p->size, p->shares, half.size, shares);
        half.shares = shares;
        status = solve_levels(&half, finest, threads, error);
    }
    if (!status && longest <= finest) {
        refine(half.size, half.moments, p->size, p->moments);
        status = ordinates_solve(p, ROUNDS, tolerance, threads, error);
    } else if (!status) {
        smooth(half.size, half.moments, p->size, p->moments);
    }
    free(extinction);
    free(beam);
    free(shares);
    free(half.moments);
    return status;
}

static shape_vec3 to_cloud(const shape_volume_cloud *cloud, shape_dvec3 world)
{
    shape_dvec3 d = shape_dvec3_normalize(shape_frame_direction(&cloud->inverse, world));
    return shape_vec3_make((float)d.x, (float)d.y, (float)d.z);
}

static void store(const ordinates_problem *p, size_t cells, shape_lightgrid *grid)
{
    for (size_t i = 0; i < cells; i++) {
        const float *m = p->moments + i * ORDINATES_CELL;
        float *out = grid->fluxes + i * SHAPE_LIGHTGRID_FLUXES;
        out[0] = p->extinction[i];
        for (int axis = 0; axis < 3; axis++) {
            out[1 + axis] = m[(1 + axis) * ORDINATES_LANES + 1];
            out[4 + axis] = m[(1 + axis) * ORDINATES_LANES + 2];
        }
    }
    for (size_t i = 0; i < cells; i++) {
        const float *m = p->moments + i * ORDINATES_CELL;
        float *out = grid->cells + i * SHAPE_LIGHTGRID_VALUES;
        out[1] = m[0], out[2] = m[1], out[3] = m[2];
        out[4] = m[ORDINATES_LANES], out[5] = m[2 * ORDINATES_LANES], out[6] = m[3 * ORDINATES_LANES];
        out[7] = m[ORDINATES_LANES + 1] * p->up.x + m[2 * ORDINATES_LANES + 1] * p->up.y +
                 m[3 * ORDINATES_LANES + 1] * p->up.z;
    }
}

/* The delta scaling of one cell: what is scattered within `peak` of the forward direction is not lost. Returns the albedo
 * of the rest. */
static float scale_cell(const shape_lightgrid *grid, size_t cell, float albedo, float peak, float *extinction,
                        float *beam)
{
    float thin = 1 - albedo * peak;
    extinction[cell] *= thin;
    beam[cell] = expf(-thin * grid->cells[cell * SHAPE_LIGHTGRID_VALUES]);
    return thin > 0 ? albedo * (1 - peak) / thin : 0;
}

/* The densities: from an earlier grid where there is one, which lies where this one lies. */
static shape_status find_densities(const shape_volume_cloud *cloud, const shape_lightgrid_options *options,
                                   int threads, shape_lightgrid *grid, shape_error *error)
{
    const shape_lightgrid *from = options->from;
    const shape_change *change = NULL;
    size_t cells = (size_t)grid->size[0] * (size_t)grid->size[1] * (size_t)grid->size[2];
    grid->densities = malloc(cells * sizeof *grid->densities);
    if (!grid->densities)
        return shape_error_memory(error);
    if (from && from->densities && !(options->change && options->change->all)) {
        static const shape_change none = {0};
        change = options->change ? options->change : &none;
        memcpy(grid->densities, from->densities, cells * sizeof *grid->densities);
    }
    shape_volume_cloud copy = *cloud;
    copy.stop = &options->stop;
    return lightgrid_fill_densities(&copy, grid, change, threads, options->stop, error);
}

static shape_status scatter(const shape_volume_cloud *cloud, const shape_light *light,
                            const shape_lightgrid_options *options, int threads, shape_lightgrid *grid,
                            shape_error *error)
{
    const int channel = options->channel,
              finest = options->scattering_resolution > 0 ? options->scattering_resolution : INT_MAX;
    size_t cells = (size_t)grid->size[0] * (size_t)grid->size[1] * (size_t)grid->size[2];
    float *extinction = calloc(cells, sizeof *extinction), *beam = malloc(cells * sizeof *beam);
    float *moments = calloc(cells * ORDINATES_CELL, sizeof *moments), *shares = NULL;
    float directions[ORDINATES_DIRECTIONS];
    const shape_sky sky = shape_sky_make(light);
    grid->fluxes = malloc(cells * SHAPE_LIGHTGRID_FLUXES * sizeof *grid->fluxes);
    shape_status status =
        extinction && beam && moments && grid->fluxes ? SHAPE_OK : shape_error_memory(error);
    ordinates_sky_shares(&sky, cloud, directions);
    if (!status && channel >= 0 && shape_cloud_is_coloured(cloud)) {
        grid->albedos = malloc(cells * sizeof *grid->albedos);
        shares = malloc(cells * sizeof *shares);
        status = grid->albedos && shares ? SHAPE_OK : shape_error_memory(error);
    }
    if (!status) {
        float peak, rest, albedo = 0;
        shape_delta_scaling(shape_phase_mean_cosine(&cloud->medium), &peak, &rest);
        for (size_t i = 0; i < cells; i++)
            extinction[i] = cloud->medium.extinction * grid->densities[i];
        if (shares)
            fill_albedos(cloud, grid, channel, threads);
        for (size_t i = 0; i < cells && !status; i++) {
            albedo =
                scale_cell(grid, i, shares ? grid->albedos[i] : cloud->medium.albedo, peak, extinction, beam);
            if (shares)
                shares[i] = albedo;
        }
        ordinates_problem p = {.extinction = extinction,
                               .beam = beam,
                               .albedo = shares ? 1 : albedo,
                               .shares = shares,
                               .g = rest,
                               .sun_travel = shape_vec3_scale(to_cloud(cloud, light->sun), -1),
                               .up = to_cloud(cloud, shape_dvec3_make(0, 1, 0)),
                               .sky = directions,
                               .moments = moments,
                               .stop = options->stop,
                               .visits = &grid->visits};
        for (int axis = 0; axis < 3; axis++) {
            p.size[axis] = grid->size[axis];
            double column = sqrt(cloud->frame.m[0][axis] * cloud->frame.m[0][axis] +
                                 cloud->frame.m[1][axis] * cloud->frame.m[1][axis] +
                                 cloud->frame.m[2][axis] * cloud->frame.m[2][axis]);
            p.cell[axis] = (float)column * ((&grid->box.max.x)[axis] - (&grid->box.min.x)[axis]) /
                           (float)grid->size[axis];
        }
        if (!status && peak > 0 && sky.kind == SHAPE_SKY_CLEAR)
            status = skyspread_make(&sky, &cloud->medium, threads, &grid->sky, error);
        if (!status)
            status = solve_levels(&p, finest, threads, error);
        if (!status)
            store(&p, cells, grid);
    }
    free(extinction);
    free(beam);
    free(shares);
    free(moments);
    return status;
}

/* The optical depths by a march from every cell, through the clouds that may stand between the grid and the sun. */
static shape_status find_depths(const shape_volume *volume, size_t cloud, const shape_light *light,
                                const shape_lightgrid_options *options, int threads, shape_lightgrid *grid,
                                shape_error *error)
{
    shape_volume between = *volume;
    size_t count = 0;
    between.clouds = malloc((volume->cloud_count + 1) * sizeof *between.clouds);
    if (!between.clouds)
        return shape_error_memory(error);
    for (size_t i = 0; i < volume->cloud_count; i++)
        if (i == cloud || shape_sun_may_shade(&volume->clouds[i], &volume->clouds[cloud], light->sun)) {
            between.clouds[count] = volume->clouds[i];
            between.clouds[count++].stop = &options->stop;
        }
    between.cloud_count = count;
    sun_pass pass = {&between,        &volume->clouds[cloud], light->sun, choose_step(volume, options->step),
                     options->opaque, options->stop};
    shape_status status = march_to_sun(&pass, threads, grid, error);
    free(between.clouds);
    return status;
}

/* Cells that something opaque keeps in the dark. */
static void darken(const shape_volume_cloud *cloud, const shape_light *light, const shape_opaque *opaque,
                   int threads, shape_lightgrid *grid)
{
    int rows = grid->size[1] * grid->size[2];
#pragma omp parallel for schedule(dynamic, 4) num_threads(threads)
    for (int i = 0; i < rows; i++)
        for (int x = 0; x < grid->size[0]; x++) {
            shape_vec3 p = lightgrid_point(grid, x, i % grid->size[1], i / grid->size[1], 0.5f, 0.5f, 0.5f);
            shape_dvec3 world = shape_frame_point(&cloud->frame, shape_dvec3_make(p.x, p.y, p.z));
            if (shape_opaque_blocks(opaque, world, light->sun, INFINITY))
                grid->cells[((size_t)i * (size_t)grid->size[0] + (size_t)x) * SHAPE_LIGHTGRID_VALUES] =
                    DEEPEST;
        }
}

static shape_status check(const shape_volume *volume, size_t cloud, const shape_lightgrid_options *options,
                          shape_error *error)
{
    if (cloud >= volume->cloud_count)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "there is no cloud number %zu", cloud);
    if (options->resolution < 2 || options->resolution > 256)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "a light grid of %d cells (it must be 2 to 256)",
                               options->resolution);
    if (options->channel < -1 || options->channel > 2)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "there is no colour channel %d (it must be -1 to 2)", options->channel);
    if (!(options->step > 0))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "the light grid's step is %g (it must be above 0)", (double)options->step);
    if (options->scattering_resolution < 0 || options->scattering_resolution == 1)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "scattered light by %d cells (it must be 2 or more, or 0)",
                               options->scattering_resolution);
    if (options->sweep && !sunsweep_has(options->sweep, cloud))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "cloud number %zu was not swept", cloud);
    return SHAPE_OK;
}

static bool lies_alike(const shape_lightgrid *a, const shape_lightgrid *b)
{
    return !memcmp(a->size, b->size, sizeof a->size) && !memcmp(&a->box, &b->box, sizeof a->box);
}

/* The scattered light of an earlier grid, as it was. */
static void keep_scattered(const shape_lightgrid *from, shape_lightgrid *grid)
{
    size_t cells = (size_t)grid->size[0] * (size_t)grid->size[1] * (size_t)grid->size[2];
    for (size_t i = 0; i < cells; i++)
        memcpy(grid->cells + i * SHAPE_LIGHTGRID_VALUES + 1, from->cells + i * SHAPE_LIGHTGRID_VALUES + 1,
               (SHAPE_LIGHTGRID_VALUES - 1) * sizeof *grid->cells);
}

shape_status shape_lightgrid_build(const shape_volume *volume, size_t cloud, const shape_light *light,
                                   const shape_lightgrid_options *options, shape_lightgrid *grid,
                                   shape_error *error)
{
    shape_status status = check(volume, cloud, options, error);
    if (status)
        return status;
    memset(grid, 0, sizeof *grid);
    int threads = options->threads > 0 ? options->threads : omp_get_max_threads();
    const shape_volume_cloud *c = &volume->clouds[cloud];
    lightgrid_lay_out(c, options->resolution, grid);
    shape_lightgrid_options earlier = *options;
    if (earlier.from && !lies_alike(earlier.from, grid))
        earlier.from = NULL;
    size_t cells = (size_t)grid->size[0] * (size_t)grid->size[1] * (size_t)grid->size[2];
    grid->cells = calloc(cells * SHAPE_LIGHTGRID_VALUES, sizeof *grid->cells);
    if (!grid->cells)
        return shape_error_memory(error);
    if (options->sweep) {
        status = sunsweep_fill(options->sweep, cloud, threads, options->stop, grid, error);
        if (!status && options->opaque)
            darken(c, light, options->opaque, threads, grid);
    } else {
        status = find_depths(volume, cloud, light, options, threads, grid, error);
    }
    if (!status && (options->scattering || (earlier.from && earlier.from->densities)))
        status = find_densities(c, &earlier, threads, grid, error);
    if (!status && options->scattering)
        status = scatter(c, light, options, threads, grid, error);
    else if (!status && earlier.from)
        keep_scattered(earlier.from, grid);
    if (status)
        shape_lightgrid_free(grid);
    return status;
}

void shape_lightgrid_free(shape_lightgrid *grid)
{
    free(grid->cells);
    free(grid->albedos);
    free(grid->densities);
    free(grid->fluxes);
    free(grid->sky);
    memset(grid, 0, sizeof *grid);
}
