/* neph-chart's reference pictures: path-traced once, kept beside the results as EXR with the variance of each pixel. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "chart.h"
#include "cli.h"
#include "shape/file.h"
#include "shape/image.h"
#include "shape/imageerror.h"
#include "shape/pathtrace.h"

enum { MAX_IMAGE_FILE = 0x7fffffff, SAMPLES_MOST = 1 << 16 };

/* What noise of that variance adds to a relMSE on average: the mean of variance / (radiance^2 + epsilon). */
static double mean_noise(const float *radiance, const float *variance, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += (double)variance[i] / ((double)radiance[i] * (double)radiance[i] + SHAPE_IMAGEERROR_EPSILON);
    return sum / (double)count;
}

static void take(chart_scene *scene, const shape_image *image, const char *path)
{
    const float *variance = shape_image_layer_pixels(image, "variance");
    size_t count = (size_t)scene->view.width * (size_t)scene->view.height * 3;
    if (image->width != scene->view.width || image->height != scene->view.height || !variance)
        cli_fail("%s: is not the reference that this program wrote (remove it)", path);
    scene->reference = malloc(count * sizeof *scene->reference);
    if (!scene->reference)
        cli_fail("not enough memory");
    memcpy(scene->reference, image->pixels, count * sizeof *scene->reference);
    scene->noise2 = mean_noise(image->pixels, variance, count);
}

static shape_image *read_image(const char *path)
{
    shape_error error;
    unsigned char *bytes;
    size_t size;
    shape_image *image;
    cli_check(shape_file_read(path, MAX_IMAGE_FILE, &bytes, &size, &error), &error);
    if (shape_image_decode(bytes, size, &image, &error))
        cli_fail("%s: %s (remove it)", path, error.text);
    free(bytes);
    return image;
}

static void write_image(const char *path, const shape_image *image)
{
    shape_error error;
    unsigned char *bytes;
    size_t size;
    cli_check(shape_image_encode(image, SHAPE_IMAGE_EXR, NULL, &bytes, &size, &error), &error);
    cli_check(shape_file_write(path, bytes, size, &error), &error);
    free(bytes);
}

static bool go_on(void *context, double done)
{
    const double *deadline = context;
    cli_progress("tracing the reference", done < 0.9999 ? done : 0.9999);
    return *deadline <= 0 || chart_seconds() < *deadline;
}

static shape_image *trace(const chart_plan *plan, const chart_scene *scene, double deadline)
{
    shape_error error;
    shape_volume *volume;
    shape_tracer *tracer;
    shape_pathtrace_result result;
    shape_pathtrace_options options = shape_pathtrace_defaults();
    options.samples = SAMPLES_MOST;
    options.noise = plan->noise;
    options.seed = plan->seed;
    options.sun_angle = scene->sun_angle;
    options.progress = go_on;
    options.progress_context = &deadline;
    shape_image *image = shape_image_create(scene->view.width, scene->view.height, &error);
    if (!image)
        cli_fail("%s", error.text);
    cli_check(shape_image_add_layer(image, "variance", &error), &error);
    cli_check(shape_volume_create(scene->set, &volume, &error), &error);
    cli_check(shape_tracer_create(volume, &tracer, &error), &error);
    cli_check(shape_pathtrace_render(tracer, &scene->view, &scene->light, &options, image->pixels,
                                     shape_image_layer_pixels(image, "variance"), &result, &error),
              &error);
    shape_tracer_destroy(tracer);
    shape_volume_destroy(volume);
    cli_progress("tracing the reference", 1);
    if (result.samples < 2)
        cli_fail("%s: no time for a reference picture (make it smaller: --size, or leave out --quick)",
                 scene->path);
    cli_say("%s: reference traced, %d paths a pixel", scene->name, result.samples);
    return image;
}

void chart_reference(const chart_plan *plan, chart_scene *scene, double deadline)
{
    char name[64];
    snprintf(name, sizeof name, "reference-%s.exr", scene->digest);
    char *path = chart_path(plan, name);
    bool kept = !access(path, F_OK);
    if (!kept)
        cli_say("%s: tracing %s", scene->name, name);
    shape_image *image = kept ? read_image(path) : trace(plan, scene, deadline);
    if (kept)
        cli_say("%s: reference kept from before", scene->name);
    else
        write_image(path, image);
    take(scene, image, path);
    shape_image_destroy(image);
    free(path);
}
