/* neph-render: a .neph to a picture on the CPU, and the comparison of two pictures. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <jansson.h>

#include "cli.h"
#include "cli_picture.h"
#include "shape/denoise.h"
#include "shape/file.h"
#include "shape/image.h"
#include "shape/imageerror.h"
#include "shape/march.h"
#include "shape/pathtrace.h"

enum { MAX_IMAGE_FILE = 0x7fffffff };

static int method, rule = SHAPE_RULE_EXPONENTIAL, lighting = SHAPE_MARCH_GRID;
static int64_t samples = 64, max_bounces = 4096, steps = 100, light_steps = 50, light_resolution = 48;
static double growth = 1, noise, sun_angle = 0.53, lamp[3], lamp_intensity[3] = {10, 10, 10}, tolerance;
static bool jitter, denoise, stats, compare, samples_given, noise_given, lamp_given, tolerance_given,
    march_given, bounces_given, angle_given;

static const cli_option render_options[] = {
    {"method", 0, CLI_CHOICE, &method, 0, 0, "reference|march",
     "reference: path tracing; march: sums along each ray [reference]", NULL, false},
    {"spp", 0, CLI_INTEGER, &samples, 1, 1 << 20, "N",
     "paths a pixel; with --noise or --error the most; rays a pixel of march [64; march 1]", &samples_given,
     false},
    {"error", 0, CLI_NUMBER, &noise, 1e-6, 10, "E", "the same as --noise", &noise_given, false},
    {"noise", 0, CLI_NUMBER, &noise, 1e-6, 10, "T", "stop at this relative error of the picture [off]",
     &noise_given, false},
    {"max-bounces", 0, CLI_INTEGER, &max_bounces, 0, 1 << 20, "N", "collisions that a path may have [4096]",
     NULL, false},
    {"sun-angle", 0, CLI_NUMBER, &sun_angle, 0, 90, "DEGREES", "the sun's diameter; 0: a direction [0.53]",
     NULL, false},
    {"lamp", 0, CLI_VECTOR, lamp, -1e12, 1e12, "X,Y,Z", "a lamp stands there, metres [none]", &lamp_given,
     false},
    {"lamp-intensity", 0, CLI_VECTOR, lamp_intensity, 0, 1e18, "R,G,B",
     "of the lamp: irradiance times distance squared [10,10,10]", NULL, false},
    {"denoise", 0, CLI_FLAG, &denoise, 0, 0, NULL,
     "smooth the grain of the paths where their variance explains it; no longer unbiased", NULL, false},
    {"stats", 0, CLI_FLAG, &stats, 0, 0, NULL, "JSON about the picture on standard output (needs -o)", NULL,
     true},
    {0}};

static const cli_option march_options[] = {
    {"rule", 0, CLI_CHOICE, &rule, 0, 0, "riemann-left|riemann-right|trapezoid|simpson|simpson38|exponential",
     "rule of integration along a ray [exponential]", &march_given, false},
    {"steps", 0, CLI_INTEGER, &steps, 1, 100000, "N", "samples along the longest side of all clouds [100]",
     &march_given, false},
    {"growth", 0, CLI_NUMBER, &growth, 1, 2, "Q",
     "each step is Q times the one before, within an interval [1]", &march_given, false},
    {"jitter", 0, CLI_FLAG, &jitter, 0, 0, NULL, "the exponential rule looks at chance places in its steps",
     &march_given, false},
    {"light", 0, CLI_CHOICE, &lighting, 0, 0, "single|powder|octaves|grid",
     "how a point is lit: sun once; dark rims; halved copies; all scatterings [grid]", &march_given, false},
    {"light-steps", 0, CLI_INTEGER, &light_steps, 1, 100000, "N",
     "the same as --steps for the way to the sun [50]", &march_given, false},
    {"light-resolution", 0, CLI_INTEGER, &light_resolution, 2, 256, "N",
     "cells of the light grid's longest side [48]", &march_given, false},
    {0}};

static const cli_option compare_options[] = {
    {"compare", 0, CLI_FLAG, &compare, 0, 0, NULL,
     "the arguments are two pictures: how far the first is from the second, as JSON; -o writes a heat map",
     NULL, true},
    {"tolerance", 0, CLI_NUMBER, &tolerance, 0, 1e9, "T",
     "with --compare: exit 1 where the relative MSE is above T [off]", &tolerance_given, true},
    {0}};

static const cli_group groups[] = {{"Picture", cli_picture_options},
                                   {"Rendering", render_options},
                                   {"Marching (--method march)", march_options},
                                   {"Comparing", compare_options},
                                   {0}};

static const cli_program program = {.name = "neph-render",
                                    .arguments = "IN.neph | --compare A B",
                                    .about = "Renders clouds on the CPU to PNG (tone-mapped), EXR or PFM "
                                             "(linear radiance). An EXR also holds the\n"
                                             "variance of each pixel.",
                                    .examples =
                                        "  neph-render cloud.neph -o cloud.png --spp 256\n"
                                        "  neph-render cloud.neph -o cloud.exr --noise 0.02 --sun 120,20\n"
                                        "  neph-render cloud.neph -o cloud.png --method march --steps 200\n"
                                        "  neph-render --compare a.exr b.exr --tolerance 1e-3\n",
                                    .min_arguments = 1,
                                    .max_arguments = 2,
                                    .groups = groups};

static double seconds(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static json_t *three(const double v[3])
{
    return json_pack("[f, f, f]", v[0], v[1], v[2]);
}

static void print_json(json_t *object)
{
    if (!object || json_dumpf(object, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(9)) ||
        putchar('\n') == EOF)
        cli_fail("standard output: cannot write");
    json_decref(object);
}

static void write_image(const cli_common *common, const shape_image *image, shape_image_format format,
                        const shape_image_options *options)
{
    shape_error error;
    unsigned char *bytes;
    size_t size;
    cli_check(shape_image_encode(image, format, options, &bytes, &size, &error), &error);
    cli_write(common, bytes, size, true);
    free(bytes);
}

/* The format from the output's name; on standard output PNG. */
static shape_image_format choose_format(const cli_common *common)
{
    shape_error error;
    shape_image_format format = SHAPE_IMAGE_PNG;
    if (strcmp(common->output, "-") && shape_image_format_find(common->output, &format, &error))
        cli_wrong("%s", error.text);
    return format;
}

/* --- rendering --- */

static bool show_progress(void *context, double done)
{
    (void)context;
    cli_progress("tracing", done < 0.9999 ? done : 0.9999);
    return true;
}

static shape_pathtrace_options pathtrace_options(const cli_common *common)
{
    shape_pathtrace_options options = shape_pathtrace_defaults();
    options.samples = (int)samples;
    options.max_bounces = (int)max_bounces;
    options.seed = common->seed;
    options.sun_angle = sun_angle;
    if (noise_given) {
        options.noise = noise;
        options.samples = samples_given ? (int)samples : 1 << 16;
    }
    options.lamp.position = shape_dvec3_make(lamp[0], lamp[1], lamp[2]);
    for (int c = 0; c < 3 && lamp_given; c++)
        options.lamp.intensity[c] = (float)lamp_intensity[c];
    options.progress = show_progress;
    return options;
}

static shape_image *make_image(const shape_view *view, shape_image_format format)
{
    shape_error error;
    shape_image *image = shape_image_create(view->width, view->height, &error);
    if (!image)
        cli_fail("%s", error.text);
    if (format == SHAPE_IMAGE_EXR && method == 0)
        cli_check(shape_image_add_layer(image, "variance", &error), &error);
    return image;
}

/* What a method tells of its picture. */
typedef struct picture_outcome {
    const char *method;
    int samples;
    double rel_error; /* negative: not known */
} picture_outcome;

static void report(const picture_outcome *outcome, const shape_image *image, double time)
{
    double mean[3] = {0, 0, 0};
    size_t count = (size_t)image->width * (size_t)image->height;
    for (size_t i = 0; i < 3 * count; i++)
        mean[i % 3] += (double)image->pixels[i] / (double)count;
    if (outcome->rel_error >= 0)
        cli_say("%d paths a pixel, %.2f s, relative error %.4f", outcome->samples, time, outcome->rel_error);
    else
        cli_say("%d rays a pixel, %.2f s", outcome->samples, time);
    if (!stats)
        return;
    json_t *rel_error = outcome->rel_error >= 0 ? json_real(outcome->rel_error) : json_null();
    print_json(json_pack("{s:s, s:i, s:f, s:o, s:o}", "method", outcome->method, "spp", outcome->samples,
                         "seconds", time, "mean", three(mean), "rel_error", rel_error));
}

/* The picture without its grain, in place. variance: of its pixels. */
static void smooth(shape_image *image, const float *variance)
{
    shape_error error;
    size_t bytes = 3 * (size_t)image->width * (size_t)image->height * sizeof(float);
    float *result = malloc(bytes);
    if (!result)
        cli_fail("out of memory");
    cli_check(shape_denoise(image->pixels, variance, image->width, image->height, result, &error), &error);
    memcpy(image->pixels, result, bytes);
    free(result);
}

static picture_outcome trace(const cli_common *common, const shape_volume *volume, const shape_view *view,
                             const shape_light *light, shape_image *image)
{
    shape_error error;
    shape_tracer *tracer;
    shape_pathtrace_result result;
    shape_pathtrace_options options = pathtrace_options(common);
    float *layer = shape_image_layer_pixels(image, "variance"), *variance = layer;
    if (denoise && !layer) {
        variance = malloc(3 * (size_t)image->width * (size_t)image->height * sizeof *variance);
        if (!variance)
            cli_fail("out of memory");
    }
    cli_check(shape_tracer_create(volume, &tracer, &error), &error);
    cli_check(shape_pathtrace_render(tracer, view, light, &options, image->pixels, variance, &result, &error),
              &error);
    shape_tracer_destroy(tracer);
    if (denoise)
        smooth(image, variance);
    if (!layer)
        free(variance);
    picture_outcome outcome = {"reference", result.samples,
                               isfinite(result.rel_error) ? result.rel_error : -1};
    return outcome;
}

static picture_outcome march(const cli_common *common, const shape_set *set, const shape_volume *volume,
                             const shape_view *view, const shape_light *light, shape_image *image)
{
    shape_error error;
    shape_marcher *marcher;
    shape_march_options options = shape_march_defaults();
    shape_dvec3 min = {0, 0, 0}, max = {1, 1, 1};
    shape_set_bounds(set, &min, &max);
    double side = fmax(max.x - min.x, fmax(max.y - min.y, max.z - min.z));
    options.rule = (shape_rule)rule;
    options.light = (shape_march_light)lighting;
    options.step = side / (double)steps;
    options.light_step = side / (double)light_steps;
    options.growth = growth;
    options.jitter = jitter;
    options.resolution = (int)light_resolution;
    options.samples = samples_given ? (int)samples : 1;
    options.seed = common->seed;
    options.progress = show_progress;
    cli_check(shape_marcher_create(volume, light, view->eye, &options, &marcher, &error), &error);
    cli_check(shape_march_render(marcher, view, image->pixels, NULL, &error), &error);
    shape_marcher_destroy(marcher);
    picture_outcome outcome = {"march", options.samples, -1};
    return outcome;
}

static void check_command(const cli_common *common)
{
    if (common->argument_count != 1)
        cli_wrong("\"%s\" is one argument too many (see --help)", common->arguments[1]);
    if (stats && !strcmp(common->output, "-"))
        cli_wrong("--stats writes to standard output (name the picture with -o)");
    if (tolerance_given)
        cli_wrong("--tolerance belongs to --compare");
    if (method == 0 && march_given)
        cli_wrong("--rule, --steps, --growth, --jitter and the light options belong to --method march");
    if (method == 1 && (noise_given || lamp_given || bounces_given || angle_given))
        cli_wrong("--noise, --error, --lamp, --max-bounces and --sun-angle belong to --method reference");
    if (method == 1 && denoise)
        cli_wrong("--denoise belongs to --method reference");
    if (jitter && rule != SHAPE_RULE_EXPONENTIAL)
        cli_wrong("--jitter goes with --rule exponential only");
    if (method == 1 && samples_given && samples > 4096)
        cli_wrong("--spp %d: --method march takes at most 4096", (int)samples);
}

static void render(const cli_common *common)
{
    shape_error error;
    shape_view view;
    shape_light light;
    shape_volume *volume;
    check_command(common);
    shape_image_format format = choose_format(common);
    shape_set *set = cli_read_set(common->arguments[0]);
    cli_picture_apply(set, &view, &light);
    shape_image *image = make_image(&view, format);
    double start = seconds();
    cli_check(shape_volume_create(set, &volume, &error), &error);
    picture_outcome outcome = method ? march(common, set, volume, &view, &light, image)
                                     : trace(common, volume, &view, &light, image);
    cli_progress("tracing", 1);
    shape_image_options image_options = shape_image_options_defaults();
    image_options.exposure = view.exposure;
    write_image(common, image, format, &image_options);
    report(&outcome, image, seconds() - start);
    shape_image_destroy(image);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* --- comparing --- */

static shape_image *read_image(const char *path)
{
    shape_error error;
    unsigned char *bytes;
    size_t size;
    shape_image *image;
    cli_check(shape_file_read(path, MAX_IMAGE_FILE, &bytes, &size, &error), &error);
    if (shape_image_decode(bytes, size, &image, &error))
        cli_fail("%s: %s", path, error.text);
    free(bytes);
    return image;
}

static void write_heat_map(const cli_common *common, const shape_image *a, const shape_image *b)
{
    shape_error error;
    shape_image_format format = choose_format(common);
    shape_image *heat = shape_image_create(a->width, a->height, &error);
    if (!heat)
        cli_fail("%s", error.text);
    cli_check(shape_imageerror_map(a->pixels, b->pixels, a->width, a->height, 1, heat->pixels, &error),
              &error);
    shape_image_options options = shape_image_options_defaults();
    options.tone = false;
    options.dither = false;
    write_image(common, heat, format, &options);
    shape_image_destroy(heat);
}

/* Returns the exit code. */
static int compare_pictures(const cli_common *common)
{
    shape_error error;
    shape_imageerror e;
    if (common->argument_count != 2)
        cli_wrong("--compare takes two pictures");
    shape_image *a = read_image(common->arguments[0]), *b = read_image(common->arguments[1]);
    if (a->width != b->width || a->height != b->height)
        cli_fail("%s is %dx%d and %s is %dx%d (compare pictures of one size)", common->arguments[0], a->width,
                 a->height, common->arguments[1], b->width, b->height);
    cli_check(shape_imageerror_measure(a->pixels, b->pixels, a->width, a->height, &e, &error), &error);
    if (common->output_given && strcmp(common->output, "-"))
        write_heat_map(common, a, b);
    print_json(json_pack("{s:f, s:f, s:f, s:[i, i], s:i, s:f, s:f, s:o, s:o}", "rmse", e.rmse, "relmse",
                         e.relmse, "largest", e.largest, "at", e.x, e.y, "channel", e.channel, "exposure",
                         e.exposure, "exposed_relmse", e.exposed_relmse, "mean_a", three(e.mean_a), "mean_b",
                         three(e.mean_b)));
    shape_image_destroy(a);
    shape_image_destroy(b);
    if (tolerance_given && !(e.relmse <= tolerance)) {
        cli_error("the relative MSE %.6g is above the tolerance %.6g", e.relmse, tolerance);
        return CLI_FAILED;
    }
    return CLI_DONE;
}

int main(int argc, char **argv)
{
    cli_common common;
    cli_parse(&program, argc, argv, &common);
    int code = CLI_DONE;
    if (compare)
        code = compare_pictures(&common);
    else
        render(&common);
    int finished = cli_finish(&common);
    return code ? code : finished;
}
