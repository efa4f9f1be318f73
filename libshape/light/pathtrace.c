/* The reference renderer: paths through the volume with next-event estimation of sun and lamp (Kajiya 1986 for volumes;
 * see shape/pathtrace.h). Albedo, phase function and extinction are grey, so a path carries one number. */
#include "shape/pathtrace.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "light/rows.h"
#include "light/track.h"
#include "shape/phase.h"

static const double pi = 3.14159265358979323846;

enum { PASS_SAMPLES = 16 };

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
    const shape_lamp *lamp = &options->lamp;
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
    for (int c = 0; c < 3; c++)
        if (!(lamp->intensity[c] >= 0) || !isfinite(lamp->intensity[c]))
            return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                                   "lamp intensity: must be finite and not negative");
    if (!isfinite(lamp->position.x) || !isfinite(lamp->position.y) || !isfinite(lamp->position.z))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "lamp position: must be finite");
    return SHAPE_OK;
}

/* All that a path needs to know, made ready once. */
typedef struct scene {
    const majorant_grid *grid;
    shape_sky sky;
    double sun[3], sun_cos, irradiance[3]; /* sun_cos: the cosine at the disc's edge */
    bool has_sun, has_lamp;
    double lamp[3], intensity[3];
    int max_bounces;
} scene;

static scene make_scene(const shape_tracer *tracer, const shape_light *light,
                        const shape_pathtrace_options *options)
{
    scene s;
    memset(&s, 0, sizeof s);
    s.grid = &tracer->grid;
    s.sky = shape_sky_make(light);
    shape_dvec3 sun = shape_dvec3_normalize(light->sun);
    s.sun[0] = sun.x, s.sun[1] = sun.y, s.sun[2] = sun.z;
    s.sun_cos = cos(options->sun_angle * (pi / 360));
    shape_dvec3 lamp = shape_dvec3_sub(options->lamp.position, tracer->grid.origin);
    s.lamp[0] = lamp.x, s.lamp[1] = lamp.y, s.lamp[2] = lamp.z;
    for (int c = 0; c < 3; c++) {
        s.irradiance[c] = (double)light->sun_irradiance[c];
        s.intensity[c] = (double)options->lamp.intensity[c];
        s.has_sun = s.has_sun || s.irradiance[c] > 0;
        s.has_lamp = s.has_lamp || s.intensity[c] > 0;
    }
    s.max_bounces = options->max_bounces;
    return s;
}

/* The direction at cosine c from d, turned by chance. The basis is that of Duff et al. 2017. */
static void turn(double d[3], double c, shape_random *random)
{
    double sign = copysign(1, d[2]), a = -1 / (sign + d[2]), b = d[0] * d[1] * a;
    double x[3] = {1 + sign * d[0] * d[0] * a, sign * b, -sign * d[0]};
    double y[3] = {b, sign + d[1] * d[1] * a, -d[1]};
    double s = sqrt(track_max(1 - c * c, 0));
    float angle = (float)(2 * pi * track_unit(random));
    double u = s * (double)cosf(angle), v = s * (double)sinf(angle), sum = 0;
    for (int i = 0; i < 3; i++) {
        d[i] = u * x[i] + v * y[i] + c * d[i];
        sum += d[i] * d[i];
    }
    for (int i = 0; i < 3; i++)
        d[i] /= sqrt(sum);
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Whether to look for light of this phase value at all: small values, most of the sphere with forward scattering, get a
 * shadow ray by chance in proportion, and are then as much heavier. Their noise stays far below that of the lobe's. */
static bool worth_a_look(double *value, shape_random *random)
{
    const double enough =
        0.3; /* less than half the time of 0, for the same variance, on a cumulus with g 0.85 */
    if (*value >= enough)
        return true;
    if (track_unit(random) * enough >= *value)
        return false;
    *value = enough;
    return true;
}

static void add_sun(const scene *s, const double p[3], const double d[3], const shape_medium *medium,
                    double weight, shape_random *random, double rgb[3])
{
    double way[3] = {s->sun[0], s->sun[1], s->sun[2]};
    if (s->sun_cos < 1)
        turn(way, 1 - track_unit(random) * (1 - s->sun_cos), random);
    weight *= (double)shape_phase(medium, (float)dot(d, way));
    if (!worth_a_look(&weight, random) || track_blocked(s->grid, p, way, INFINITY, random))
        return;
    for (int c = 0; c < 3; c++)
        rgb[c] += weight * s->irradiance[c];
}

static void add_lamp(const scene *s, const double p[3], const double d[3], const shape_medium *medium,
                     double weight, shape_random *random, double rgb[3])
{
    double way[3] = {s->lamp[0] - p[0], s->lamp[1] - p[1], s->lamp[2] - p[2]};
    double square = dot(way, way), distance = sqrt(square);
    if (!(distance > 0))
        return;
    for (int i = 0; i < 3; i++)
        way[i] /= distance;
    weight *= (double)shape_phase(medium, (float)dot(d, way)) / square;
    if (track_blocked(s->grid, p, way, distance, random))
        return;
    for (int c = 0; c < 3; c++)
        rgb[c] += weight * s->intensity[c];
}

/* Goes on with a light path by chance only; false ends it. */
static bool survives(double *weight, shape_random *random)
{
    const double least = 0.1;
    if (*weight >= least)
        return true;
    if (track_unit(random) * least >= *weight)
        return false;
    *weight = least;
    return true;
}

/* Follows a path and adds what it gathers to rgb. first is the uniform number that the first free path is made of. */
static void gather(const scene *s, double p[3], double d[3], double first, shape_random *random,
                   double rgb[3])
{
    double weight = 1, depth = -log(first);
    uint32_t cloud = 0;
    for (int bounce = 0;; bounce++) {
        if (!track_collide(s->grid, p, d, depth, random, &cloud)) {
            float sky[3];
            shape_sky_radiance(&s->sky, shape_vec3_make((float)d[0], (float)d[1], (float)d[2]), sky);
            for (int c = 0; c < 3; c++)
                rgb[c] += weight * (double)sky[c];
            return;
        }
        if (bounce == s->max_bounces)
            return;
        const shape_medium *medium = &s->grid->clouds[cloud].cloud->medium;
        weight *= (double)medium->albedo;
        if (!(weight > 0))
            return;
        if (s->has_sun)
            add_sun(s, p, d, medium, weight, random, rgb);
        if (s->has_lamp)
            add_lamp(s, p, d, medium, weight, random, rgb);
        if (!survives(&weight, random))
            return;
        turn(d, (double)shape_phase_sample(medium, (float)shape_random_u32(random) * 0x1p-32f), random);
        depth = (double)-logf((float)track_unit(random));
    }
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
    while (track_collide(grid, p, d, -log(track_unit(random)), random, &cloud)) {
        const shape_medium *medium = &grid->clouds[cloud].cloud->medium;
        walk.weight *= (double)medium->albedo;
        if (walk.bounces == max_bounces || !(walk.weight > 0)) {
            walk.weight = 0;
            break;
        }
        walk.bounces++;
        turn(d, (double)shape_phase_sample(medium, (float)shape_random_u32(random) * 0x1p-32f), random);
    }
    walk.direction = shape_dvec3_make(d[0], d[1], d[2]);
    return walk;
}

void shape_pathtrace_radiance(const shape_tracer *tracer, const shape_light *light,
                              const shape_pathtrace_options *options, shape_dvec3 origin,
                              shape_dvec3 direction, shape_random *random, double rgb[3])
{
    scene s = make_scene(tracer, light, options);
    double p[3], d[3];
    to_grid(s.grid, origin, direction, p, d);
    rgb[0] = rgb[1] = rgb[2] = 0;
    gather(&s, p, d, track_unit(random), random, rgb);
}

/* --- pictures --- */

/* Mean and sum of squared deviations of a pixel's samples (Welford 1962). */
typedef struct pixel_sums {
    double mean[3], squares[3];
} pixel_sums;

typedef struct canvas {
    const scene *scene;
    const shape_view *view;
    shape_camera camera;
    uint64_t seed;
    pixel_sums *pixels;
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
    gather(picture->scene, p, d, track_max(r[2], 0x1p-40), &random, rgb);
}

static void trace_row(const canvas *picture, int y, int samples)
{
    int before = picture->row_samples[y];
    for (int x = 0; x < picture->view->width; x++) {
        uint64_t index = (uint64_t)y * (uint64_t)picture->view->width + (uint64_t)x;
        pixel_sums *pixel = &picture->pixels[index];
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

static double pixel_variance(const pixel_sums *pixel, int channel, int samples)
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
                const pixel_sums *pixel = &picture->pixels[y * width + x];
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
                const pixel_sums *pixel = &picture->pixels[y * width + x];
                radiance[3 * (y * width + x) + c] = (float)pixel->mean[c];
                result->mean[c] += pixel->mean[c] / (double)(width * height);
                if (variance)
                    variance[3 * (y * width + x) + c] =
                        (float)pixel_variance(pixel, (int)c, picture->row_samples[y]);
            }
}

static void trace_picture(const canvas *picture, const shape_pathtrace_options *options,
                          shape_pathtrace_result *result)
{
    while (result->samples < options->samples && !result->cancelled) {
        int left = options->samples - result->samples, samples = left < PASS_SAMPLES ? left : PASS_SAMPLES;
        rows_progress progress = {options->progress, options->progress_context,
                                  (double)result->samples / options->samples,
                                  (double)(result->samples + samples) / options->samples};
        trace_work work = {picture, samples};
        rows_share(picture->view->height, work_on_row, &work, &progress, &result->cancelled);
        if (result->cancelled)
            break;
        result->samples += samples;
        if (options->noise > 0 && estimate_error(picture) <= options->noise)
            break;
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
    scene s = make_scene(tracer, light, options);
    canvas picture = {&s, view, shape_view_camera(view), options->seed, NULL, NULL};
    picture.pixels = calloc((size_t)view->width * (size_t)view->height, sizeof *picture.pixels);
    picture.row_samples = calloc((size_t)view->height, sizeof *picture.row_samples);
    memset(result, 0, sizeof *result);
    if (picture.pixels && picture.row_samples) {
        trace_picture(&picture, options, result);
        write_out(&picture, radiance, variance, result);
    } else {
        status = shape_error_memory(error);
    }
    free(picture.pixels);
    free(picture.row_samples);
    return status;
}
