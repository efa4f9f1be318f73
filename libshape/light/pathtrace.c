/* The reference renderer: pictures as means of light paths (path.c; see shape/pathtrace.h). */
#include "shape/pathtrace.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "light/path.h"
#include "light/rows.h"
#include "shape/phase.h"

/* Samples a pixel between two looks at the noise, or at most in one go where nobody looks. */
enum { PASS_SAMPLES = 16, LONG_PASS = 64 };

shape_status shape_tracer_create(const shape_volume *volume, shape_tracer **tracer, shape_error *error)
{
    shape_tracer *made = calloc(1, sizeof *made);
    if (!made)
        return shape_error_memory(error);
    shape_status status = majorant_grid_build(&made->grid, volume, error);
    if (status) {
        shape_tracer_destroy(made);
        return status;
    }
    *tracer = made;
    return SHAPE_OK;
}

void shape_tracer_destroy(shape_tracer *tracer)
{
    if (!tracer)
        return;
    majorant_grid_free(&tracer->grid);
    free(tracer);
}

shape_pathtrace_options shape_pathtrace_defaults(void)
{
    shape_pathtrace_options options;
    memset(&options, 0, sizeof options);
    options.samples = 64;
    options.max_bounces = 4096;
    options.seed = 1;
    options.sun_angle = 0.53;
    return options;
}

shape_status shape_pathtrace_check(const shape_pathtrace_options *options, shape_error *error)
{
    if (options->samples < 1 || options->samples > 1 << 20)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "samples %d: must be from 1 to 1048576",
                               options->samples);
    if (!(options->noise >= 0))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "noise %g: must not be negative", options->noise);
    if (options->max_bounces < 0 || options->max_bounces > 1 << 20)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "max_bounces %d: must be from 0 to 1048576",
                               options->max_bounces);
    if (!(options->sun_angle >= 0 && options->sun_angle <= 90))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "sun_angle %g: must be from 0 to 90 degrees",
                               options->sun_angle);
    if (options->samples_before < 0 || options->samples_before > options->samples ||
        (options->samples_before && !options->pixels))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "samples_before %d: must be from 0 to samples, %d, with their pixels",
                               options->samples_before, options->samples);
    return shape_lamp_check(&options->lamp, error);
}

static void to_grid(const majorant_grid *grid, shape_dvec3 origin, shape_dvec3 direction, double p[3],
                    double d[3])
{
    shape_dvec3 from = shape_dvec3_sub(origin, grid->origin);
    p[0] = from.x, p[1] = from.y, p[2] = from.z;
    d[0] = direction.x, d[1] = direction.y, d[2] = direction.z;
}

double shape_tracer_transmittance(const shape_tracer *tracer, shape_dvec3 origin, shape_dvec3 direction,
                                  double length, shape_random *random)
{
    double p[3], d[3];
    to_grid(&tracer->grid, origin, direction, p, d);
    return track_transmittance(&tracer->grid, p, d, length, random);
}

shape_walk shape_tracer_walk(const shape_tracer *tracer, shape_dvec3 origin, shape_dvec3 direction,
                             int max_bounces, shape_random *random)
{
    shape_walk walk = {direction, 1, 0};
    const majorant_grid *grid = &tracer->grid;
    double p[3], d[3];
    uint32_t cloud = 0;
    to_grid(grid, origin, direction, p, d);
    while (track_collide(grid, p, d, INFINITY, -log(track_unit(random)), random, &cloud)) {
        const shape_medium *medium = &grid->clouds[cloud].cloud->medium;
        walk.weight *= (double)medium->albedo;
        if (walk.bounces == max_bounces || !(walk.weight > 0)) {
            walk.weight = 0;
            break;
        }
        walk.bounces++;
        path_turn(d, (double)shape_phase_sample(medium, (float)shape_random_u32(random) * 0x1p-32f), random);
    }
    walk.direction = shape_dvec3_make(d[0], d[1], d[2]);
    return walk;
}

void shape_pathtrace_radiance(const shape_tracer *tracer, const shape_light *light,
                              const shape_pathtrace_options *options, shape_dvec3 origin,
                              shape_dvec3 direction, shape_random *random, double rgb[3])
{
    path_scene s = path_scene_make(&tracer->grid, light, options);
    double p[3], d[3];
    to_grid(s.grid, origin, direction, p, d);
    rgb[0] = rgb[1] = rgb[2] = 0;
    path_gather(&s, p, d, track_unit(random), random, rgb);
}

/* --- pictures --- */

typedef struct canvas {
    const path_scene *scene;
    const shape_view *view;
    shape_camera camera;
    uint64_t seed;
    shape_pathtrace_pixel *pixels;
    int *row_samples; /* how many each row has */
} canvas;

static double fraction(double x)
{
    return x - floor(x);
}

/* Sample i of a pixel: place in the pixel and first free path come from the R3 sequence (Roberts 2018), shifted by
 * chance in each pixel (Cranley and Patterson 1976). */
static void trace_sample(const canvas *picture, int x, int y, int i, const double shift[3], double rgb[3])
{
    const double step[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
    uint64_t index = (uint64_t)y * (uint64_t)picture->view->width + (uint64_t)x;
    shape_random random = shape_random_seed(shape_hash(picture->seed) ^ index, (uint64_t)i + 1);
    double r[3], p[3], d[3];
    for (int a = 0; a < 3; a++)
        r[a] = fraction(shift[a] + step[a] * i);
    shape_dvec3 direction = shape_camera_direction(&picture->camera, picture->view, x + r[0], y + r[1]);
    to_grid(picture->scene->grid, picture->camera.origin, direction, p, d);
    rgb[0] = rgb[1] = rgb[2] = 0;
    path_gather(picture->scene, p, d, track_max(r[2], 0x1p-40), &random, rgb);
}

static void trace_row(const canvas *picture, int y, int samples)
{
    int before = picture->row_samples[y];
    for (int x = 0; x < picture->view->width; x++) {
        uint64_t index = (uint64_t)y * (uint64_t)picture->view->width + (uint64_t)x;
        shape_pathtrace_pixel *pixel = &picture->pixels[index];
        shape_random random = shape_random_seed(shape_hash(picture->seed) ^ index, 0);
        double shift[3] = {track_unit(&random), track_unit(&random), track_unit(&random)}, rgb[3];
        for (int i = before; i < before + samples; i++) {
            trace_sample(picture, x, y, i, shift, rgb);
            for (int c = 0; c < 3; c++) {
                double change = rgb[c] - pixel->mean[c];
                pixel->mean[c] += change / (i + 1);
                pixel->squares[c] += change * (rgb[c] - pixel->mean[c]);
            }
        }
    }
    picture->row_samples[y] = before + samples;
}

/* One pass over all rows. */
typedef struct trace_work {
    const canvas *picture;
    int samples;
} trace_work;

static shape_status work_on_row(void *context, int y)
{
    const trace_work *work = context;
    trace_row(work->picture, y, work->samples);
    return SHAPE_OK;
}

static double pixel_variance(const shape_pathtrace_pixel *pixel, int channel, int samples)
{
    return samples > 1 ? pixel->squares[channel] / samples / (samples - 1) : 0;
}

static double estimate_error(const canvas *picture)
{
    double sum = 0;
    size_t width = (size_t)picture->view->width, height = (size_t)picture->view->height;
    for (size_t y = 0; y < height; y++) {
        double row = 0;
        if (picture->row_samples[y] < 2)
            return INFINITY;
        for (size_t x = 0; x < width; x++)
            for (int c = 0; c < 3; c++) {
                const shape_pathtrace_pixel *pixel = &picture->pixels[y * width + x];
                row += pixel_variance(pixel, c, picture->row_samples[y]) /
                       (pixel->mean[c] * pixel->mean[c] + 0.01);
            }
        sum += row;
    }
    return sqrt(sum / (double)(3 * width * height));
}

static void write_out(const canvas *picture, float *radiance, float *variance, shape_pathtrace_result *result)
{
    size_t width = (size_t)picture->view->width, height = (size_t)picture->view->height;
    for (size_t y = 0; y < height; y++)
        for (size_t x = 0; x < width; x++)
            for (size_t c = 0; c < 3; c++) {
                const shape_pathtrace_pixel *pixel = &picture->pixels[y * width + x];
                radiance[3 * (y * width + x) + c] = (float)pixel->mean[c];
                result->mean[c] += pixel->mean[c] / (double)(width * height);
                if (variance)
                    variance[3 * (y * width + x) + c] =
                        (float)pixel_variance(pixel, (int)c, picture->row_samples[y]);
            }
}

/* Samples of the next pass. Looks at the noise come after every PASS_SAMPLES, wherever the work began. */
static int next_pass(const shape_pathtrace_options *options, int done)
{
    int left = options->samples - done;
    int most = options->noise > 0 || options->keep ? PASS_SAMPLES - done % PASS_SAMPLES : LONG_PASS;
    return left < most ? left : most;
}

static bool quiet_enough(const canvas *picture, const shape_pathtrace_options *options, int done)
{
    return options->noise > 0 && done > 0 && done % PASS_SAMPLES == 0 &&
           estimate_error(picture) <= options->noise;
}

static void trace_picture(const canvas *picture, const shape_pathtrace_options *options,
                          shape_pathtrace_result *result)
{
    result->samples = options->samples_before;
    while (result->samples < options->samples && !quiet_enough(picture, options, result->samples)) {
        int samples = next_pass(options, result->samples);
        rows_progress progress = {options->progress, options->progress_context,
                                  (double)result->samples / options->samples,
                                  (double)(result->samples + samples) / options->samples};
        trace_work work = {picture, samples};
        rows_share(picture->view->height, work_on_row, &work, &progress, &result->cancelled);
        if (result->cancelled)
            break;
        result->samples += samples;
        if (options->keep && !options->keep(options->keep_context, result->samples)) {
            result->cancelled = true;
            break;
        }
    }
    result->rel_error = estimate_error(picture);
}

shape_status shape_pathtrace_render(const shape_tracer *tracer, const shape_view *view,
                                    const shape_light *light, const shape_pathtrace_options *options,
                                    float *radiance, float *variance, shape_pathtrace_result *result,
                                    shape_error *error)
{
    shape_status status = shape_view_check(view, error);
    if (!status)
        status = shape_light_check(light, error);
    if (!status)
        status = shape_pathtrace_check(options, error);
    if (status)
        return status;
    path_scene s = path_scene_make(&tracer->grid, light, options);
    canvas picture = {&s, view, shape_view_camera(view), options->seed, options->pixels, NULL};
    if (!options->pixels)
        picture.pixels = calloc((size_t)view->width * (size_t)view->height, sizeof *picture.pixels);
    picture.row_samples = calloc((size_t)view->height, sizeof *picture.row_samples);
    memset(result, 0, sizeof *result);
    if (picture.pixels && picture.row_samples) {
        for (int y = 0; y < view->height; y++)
            picture.row_samples[y] = options->samples_before;
        trace_picture(&picture, options, result);
        write_out(&picture, radiance, variance, result);
    } else {
        status = shape_error_memory(error);
    }
    if (!options->pixels)
        free(picture.pixels);
    free(picture.row_samples);
    return status;
}
