/* neph-view: a cloud in a window, or as a picture without one. */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "cli.h"
#include "cli_picture.h"
#include "cli_scene.h"
#include "cli_volume.h"
#include "shape/image.h"
#include "view.h"

static bool headless, paper_lod;
static int method;
static int64_t bench_frames, samples = 32, light_grid = 48;
static const char *shader_folder;
static bool bench_given, light_grid_given;

static const cli_option view_options[] = {
    {"headless", 0, CLI_FLAG, &headless, 0, 0, NULL, "no window: write one picture to -o", NULL, true},
    {"method", 0, CLI_CHOICE, &method, 0, 0, "default|exact|paper|paper-ndt",
     "how to draw; the last two only for comparison [default]", NULL, true},
    {"samples", 0, CLI_INTEGER, &samples, 1, 65536, "N", "samples a pixel of a picture at rest [32]", NULL,
     true},
    {"light-grid", 0, CLI_INTEGER, &light_grid, 2, 256, "N",
     "cells along the longest side of a cloud's light grid [48; paper: 40]", &light_grid_given, true},
    {"bench", 0, CLI_INTEGER, &bench_frames, 1, 100000, "N",
     "draw N frames on an orbit of half a degree a frame, print times as JSON", &bench_given, true},
    {"paper-lod", 0, CLI_FLAG, &paper_lod, 0, 0, NULL,
     "paper methods: the printed distance formula for the step, not 0.1", NULL, true},
    {"shaders", 0, CLI_TEXT, &shader_folder, 0, 0, "FOLDER",
     "read the shaders from here, not the built-in ones", NULL, true},
    {0}};

static const cli_group groups[] = {{"View", view_options},
                                   {"Picture", cli_picture_options},
                                   {"Volumes (.vdb, raw)", cli_volume_options},
                                   {"Medium and place of volumes", cli_optics_options},
                                   {"Scene", cli_scene_options},
                                   {0}};

static const cli_program program = {
    .name = "neph-view",
    .arguments = "IN",
    .about =
        "Shows a .neph, a scene (docs/scene.md) or a volume (.vdb, raw) in a window, or writes a picture of "
        "it without one. \"-\" "
        "reads\n"
        "standard input. --save-scene writes what the window shows when it is closed.\n"
        "In the window: drag to turn, right drag to look round, wheel to come nearer, W A S D E Q to fly,\n"
        "+ and - for the exposure, Home for the first view, H for help, Esc to quit.",
    .examples = "  neph-view castellanus.neph\n"
                "  neph-lsys castellanus.lsys | neph-view - --headless --size 1280x720 -o castellanus.png\n"
                "  neph-view castellanus.neph --bench 50\n",
    .min_arguments = 1,
    .max_arguments = 1,
    .groups = groups};

static double now_ms(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

static const char *const method_names[] = {"default", "exact", "paper", "paper-ndt"};

/* Reads the picture from the renderer and writes it. */
static void write_picture(const view_job *job, shape_gl_renderer *renderer, const cli_common *common)
{
    shape_error error;
    size_t pixels = (size_t)job->view.width * (size_t)job->view.height;
    float *rgba = malloc(pixels * 4 * sizeof *rgba);
    if (!rgba)
        cli_fail("not enough memory for the picture");
    cli_check(shape_gl_read(renderer, rgba, &error), &error);
    shape_image *image = shape_image_create(job->view.width, job->view.height, &error);
    if (!image)
        cli_fail("%s", error.text);
    for (size_t i = 0; i < pixels; i++)
        memcpy(image->pixels + 3 * i, rgba + 4 * i, 3 * sizeof *rgba);
    free(rgba);
    shape_image_format format = SHAPE_IMAGE_PNG;
    if (strcmp(common->output, "-"))
        cli_check(shape_image_format_find(common->output, &format, &error), &error);
    shape_image_options options = shape_image_options_defaults();
    options.exposure = job->view.exposure;
    unsigned char *bytes;
    size_t size;
    cli_check(shape_image_encode(image, format, &options, &bytes, &size, &error), &error);
    shape_image_destroy(image);
    cli_write(common, bytes, size, true);
    free(bytes);
}

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The eye, turned about the target's vertical axis. */
static void orbit(shape_view *view, double degrees)
{
    double angle = degrees * 3.14159265358979323846 / 180, c = cos(angle), s = sin(angle);
    shape_dvec3 d = shape_dvec3_sub(view->eye, view->target);
    view->eye = shape_dvec3_add(view->target, shape_dvec3_make(c * d.x + s * d.z, d.y, c * d.z - s * d.x));
}

static size_t count_primitives(const shape_volume *volume)
{
    size_t count = 0;
    for (size_t i = 0; i < volume->cloud_count; i++)
        count += shape_primitives_count(volume->clouds[i].list);
    return count;
}

static void print_bench(const view_job *job, shape_gl_costs costs, double first_ms, double *times, int count)
{
    qsort(times, (size_t)count, sizeof *times, compare_doubles);
    int p95 = (int)ceil(0.95 * count) - 1;
    json_t *report = json_pack(
        "{s:s, s:[i,i], s:i, s:f, s:f, s:f, s:f, s:{s:f,s:f,s:f}, s:I, s:f, s:f}", "method",
        method_names[job->options.method], "size", job->view.width, job->view.height, "frames", count,
        "load_ms", job->load_ms + costs.upload_ms, "light_ms", costs.light_ms, "bake_ms", costs.bake_ms,
        "first_picture_ms", first_ms, "frame_ms", "min", times[0], "median", times[count / 2], "p95",
        times[p95], "primitives", (json_int_t)count_primitives(job->volume), "steps_per_pixel",
        costs.steps_per_pixel, "fetches_per_pixel", costs.fetches_per_pixel);
    if (!report || json_dumpf(report, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(6)) ||
        putchar('\n') == EOF)
        cli_fail("standard output: cannot write");
    json_decref(report);
}

/* Draws all frames, each to its end, and prints their times. */
static void bench(view_job *job, shape_gl_renderer *renderer, double started, const cli_common *common)
{
    shape_error error;
    double *times = calloc((size_t)bench_frames, sizeof *times), first = 0;
    size_t pixels = (size_t)job->view.width * (size_t)job->view.height;
    float *rgba = malloc(pixels * 4 * sizeof *rgba);
    if (!times || !rgba)
        cli_fail("not enough memory");
    double steps = 0, fetches = 0;
    for (int64_t i = 0; i < bench_frames; i++) {
        double start = now_ms();
        cli_check(shape_gl_draw_moving(renderer, &job->view, &error), &error);
        shape_gl_finish();
        times[i] = now_ms() - start;
        if (i == 0)
            first = now_ms() - started;
        cli_progress("drawing", (double)(i + 1) / (double)bench_frames);
        cli_check(shape_gl_read(renderer, rgba, &error), &error);
        steps += shape_gl_get_costs(renderer).steps_per_pixel;
        fetches += shape_gl_get_costs(renderer).fetches_per_pixel;
        if (i + 1 < bench_frames)
            orbit(&job->view, 0.5);
    }
    free(rgba);
    shape_gl_costs costs = shape_gl_get_costs(renderer);
    costs.steps_per_pixel = steps / (double)bench_frames;
    costs.fetches_per_pixel = fetches / (double)bench_frames;
    if (common->output_given)
        write_picture(job, renderer, common);
    print_bench(job, costs, first, times, (int)bench_frames);
    free(times);
}

static void draw_headless(view_job *job, double started, const cli_common *common)
{
    shape_error error;
    shape_gl_context *context;
    shape_gl_renderer *renderer;
    cli_check(shape_gl_context_create(&context, &error), &error);
    cli_check(shape_gl_create(&job->options, &renderer, &error), &error);
    cli_check(shape_gl_load(renderer, job->volume, &error), &error);
    cli_check(shape_gl_light(renderer, &job->light, &error), &error);
    if (bench_given) {
        bench(job, renderer, started, common);
    } else {
        for (int i = 0; i < job->samples; i++) {
            cli_check(shape_gl_draw(renderer, &job->view, i, &error), &error);
            shape_gl_finish();
            cli_progress("drawing", (double)(i + 1) / job->samples);
        }
        write_picture(job, renderer, common);
    }
    shape_gl_destroy(renderer);
    shape_gl_context_destroy(context);
}

int main(int argc, char **argv)
{
    double started = now_ms();
    cli_common common;
    cli_parse(&program, argc, argv, &common);
    shape_error error;
    view_job job = {.options = shape_gl_defaults(), .samples = (int)samples, .title = common.arguments[0]};
    bool paper = method == SHAPE_GL_PAPER || method == SHAPE_GL_PAPER_NDT;
    job.options.method = (shape_gl_method)method;
    job.options.shader_folder = shader_folder;
    job.options.paper_lod = paper_lod;
    job.options.seed = common.seed;
    job.options.background = bench_given || !headless;
    job.options.light.resolution = paper && !light_grid_given ? 40 : (int)light_grid;
    if (!headless && !bench_given && common.output_given)
        cli_wrong("-o needs --headless or --bench (a window writes no picture)");
    if (common.output_given && strcmp(common.output, "-")) {
        shape_image_format format; /* a wrong suffix is told before the work, not after */
        if (shape_image_format_find(common.output, &format, &error))
            cli_wrong("%s", error.text);
    }
    cli_save_check(&common);
    cli_input input = cli_volume_input_read(common.arguments[0]);
    job.set = input.set;
    if (input.scene)
        cli_picture_use_scene(input.scene);
    if (cli_picture_values.lamp_given)
        cli_say("note: neph-view does not show the scene's lamp (neph-render does)");
    cli_picture_apply(job.set, &job.view, &job.light);
    cli_check(shape_volume_create(job.set, &job.volume, &error), &error);
    job.load_ms = now_ms() - started;
    if (headless || bench_given)
        draw_headless(&job, started, &common);
    else
        cli_check(view_window(&job, &error), &error);
    shape_volume_destroy(job.volume);
    cli_picture_save_scene(&input, &job.view, &job.light);
    cli_input_free(&input);
    return cli_finish(&common);
}
