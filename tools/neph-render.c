/* neph-render: a .neph or a volume to a picture on the CPU, and the comparison of two pictures. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <jansson.h>

#include "cli.h"
#include "cli_picture.h"
#include "cli_scene.h"
#include "cli_volume.h"
#include "render_march.h"
#include "render_opaque.h"
#include "opaque_scene.h"
#include "render_resume.h"
#include "shape/budget.h"
#include "shape/denoise.h"
#include "shape/file.h"
#include "shape/image.h"
#include "shape/imageerror.h"
#include "shape/march.h"
#include "shape/paper.h"
#include "shape/pathtrace.h"

enum { MAX_IMAGE_FILE = 0x7fffffff };

enum { REFERENCE, MARCH, PAPER, PAPER_NDT };
static const char *const method_names[] = {"reference", "march", "paper", "paper-ndt"};

static int method;
static int64_t samples = 64, max_bounces = 4096;
static double noise, allowed, tolerance;
static bool denoise, stats, compare, samples_given, noise_given, error_given, tolerance_given, bounces_given,
    paper_lod;

static const cli_option render_options[] = {
    {"method", 0, CLI_CHOICE, &method, 0, 0, "reference|march|paper|paper-ndt",
     "path tracing; sums along each ray; Jiménez 2018 Algorithm 1, 2 [reference]", NULL, false},
    {"spp", 0, CLI_INTEGER, &samples, 1, 1 << 20, "N",
     "paths a pixel; with --noise or --error the most; rays of other methods [64; others 1]", &samples_given,
     false},
    {"error", 0, CLI_NUMBER, &allowed, 1e-6, 10, "E",
     "reference: the same as --noise; march, 0.0001 to 1: choose steps, octaves and light grid for it "
     "(docs/error.md) [off]",
     &error_given, false},
    {"noise", 0, CLI_NUMBER, &noise, 1e-6, 10, "T", "stop at this relative error of the picture [off]",
     &noise_given, false},
    {"max-bounces", 0, CLI_INTEGER, &max_bounces, 0, 1 << 20, "N", "collisions that a path may have [4096]",
     &bounces_given, false},
    {"sun-angle", 0, CLI_NUMBER, &cli_picture_values.sun_angle, 0, 90, "DEGREES",
     "the sun's diameter; 0: a direction [0.53]", &cli_picture_values.sun_angle_given, false},
    {"lamp", 0, CLI_VECTOR, cli_picture_values.lamp, -1e12, 1e12, "X,Y,Z",
     "a lamp stands there, metres; reference, and march with the lights that look along a way [none]",
     &cli_picture_values.lamp_given, false},
    {"lamp-intensity", 0, CLI_VECTOR, cli_picture_values.lamp_intensity, 0, 1e18, "R,G,B",
     "of the lamp: irradiance times distance squared [10,10,10]", &cli_picture_values.lamp_intensity_given,
     false},
    {"denoise", 0, CLI_FLAG, &denoise, 0, 0, NULL,
     "smooth the grain of the paths where their variance explains it; no longer unbiased", NULL, false},
    {"stats", 0, CLI_FLAG, &stats, 0, 0, NULL, "JSON about the picture on standard output (needs -o)", NULL,
     true},
    {0}};

static const cli_option paper_options[] = {{"paper-lod", 0, CLI_FLAG, &paper_lod, 0, 0, NULL,
                                            "the printed distance formula for the step, not 0.1 m", NULL,
                                            false},
                                           {0}};

static const cli_option compare_options[] = {
    {"compare", 0, CLI_FLAG, &compare, 0, 0, NULL,
     "the arguments are two pictures: how far the first is from the second, as JSON; -o writes a heat map",
     NULL, true},
    {"tolerance", 0, CLI_NUMBER, &tolerance, 0, 1e9, "T",
     "with --compare: exit 1 where the relative MSE is above T [off]", &tolerance_given, true},
    {0}};

static const cli_group groups[] = {{"Picture", cli_picture_options},
                                   {"Volumes (.vdb, raw)", cli_volume_options},
                                   {"Colour of volumes (.vdb)", cli_volume_colour_options},
                                   {"Medium and place of volumes", cli_optics_options},
                                   {"Rendering", render_options},
                                   {"Opaque things", render_opaque_options},
                                   {"Marching (--method march)", render_march_options},
                                   {"The methods of 2018 (--method paper, paper-ndt)", paper_options},
                                   {"Long work (--method reference)", render_resume_options},
                                   {"Comparing", compare_options},
                                   {"Scene", cli_scene_options},
                                   {0}};

static const cli_program program = {
    .name = "neph-render",
    .arguments = "IN | --compare A B",
    .about = "Renders a .neph, a scene (docs/scene.md) or a volume (.vdb, raw) on "
             "the CPU to PNG (tone-mapped), EXR or\n"
             "PFM (linear radiance). An EXR also holds the variance of each pixel.",
    .examples = "  neph-render cloud.neph -o cloud.png --spp 256\n"
                "  neph-render cloud.neph -o cloud.exr --noise 0.02 --sun 120,20\n"
                "  neph-render cloud.neph -o cloud.exr --spp 4096 --resume cloud.sums\n"
                "  neph-render cloud.neph -o cloud.png --method march --steps 200\n"
                "  neph-render cloud.neph -o cloud.png --method march --error 0.05\n"
                "  neph-render smoke.vdb -o smoke.png --density-gain 3 --extinction 0.5\n"
                "  neph-render smoke.vdb -o smoke.png --grid density --colour-grid Cd\n"
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

static shape_lamp make_lamp(void)
{
    const cli_picture *v = &cli_picture_values;
    shape_lamp lamp = {shape_dvec3_make(v->lamp[0], v->lamp[1], v->lamp[2]), {0, 0, 0}};
    for (int c = 0; c < 3 && v->lamp_given; c++)
        lamp.intensity[c] = (float)v->lamp_intensity[c];
    return lamp;
}

static shape_pathtrace_options pathtrace_options(const cli_common *common)
{
    shape_pathtrace_options options = shape_pathtrace_defaults();
    options.samples = (int)samples;
    options.max_bounces = (int)max_bounces;
    options.seed = common->seed;
    const cli_picture *v = &cli_picture_values;
    options.sun_angle = v->sun_angle;
    if (noise_given || error_given) {
        options.noise = noise_given ? noise : allowed;
        options.samples = samples_given ? (int)samples : 1 << 16;
    }
    options.lamp = make_lamp();
    options.progress = show_progress;
    return options;
}

static shape_image *make_image(const shape_view *view, shape_image_format format)
{
    shape_error error;
    shape_image *image = shape_image_create(view->width, view->height, &error);
    if (!image)
        cli_fail("%s", error.text);
    if (format == SHAPE_IMAGE_EXR && method == REFERENCE)
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

/* What is in the picture, and from where. */
typedef struct picture {
    const cli_input *input;
    const shape_set *set;
    shape_volume *volume;
    const shape_opaque *opaque;
    shape_view view;
    shape_light light;
    shape_image *image;
} picture;

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

static picture_outcome trace(const cli_common *common, const picture *p)
{
    shape_error error;
    shape_tracer *tracer;
    shape_pathtrace_result result;
    shape_pathtrace_options options = pathtrace_options(common);
    options.opaque = p->opaque;
    float *layer = shape_image_layer_pixels(p->image, "variance"), *variance = layer;
    if (denoise && !layer) {
        variance = malloc(3 * (size_t)p->image->width * (size_t)p->image->height * sizeof *variance);
        if (!variance)
            cli_fail("out of memory");
    }
    render_resume_start(p->input, &p->view, &p->light, &options);
    cli_check(shape_tracer_create(p->volume, &tracer, &error), &error);
    cli_check(shape_pathtrace_render(tracer, &p->view, &p->light, &options, p->image->pixels, variance,
                                     &result, &error),
              &error);
    shape_tracer_destroy(tracer);
    render_resume_end(&options, result.samples);
    if (denoise)
        smooth(p->image, variance);
    if (!layer)
        free(variance);
    picture_outcome outcome = {method_names[REFERENCE], result.samples,
                               isfinite(result.rel_error) ? result.rel_error : -1};
    return outcome;
}

/* Steps, octaves and light for --error, and what they are. */
static shape_budget_choice choose(const picture *p, shape_march_options *options)
{
    shape_error error;
    shape_budget_choice choice;
    cli_check(shape_budget_march(p->volume, &p->view, &p->light, options, allowed, &choice, &error), &error);
    cli_say("%d steps, light grid of %d cells, %d of %d octaves, %zu of %zu clouds: an error of %.2g is "
            "expected%s",
            choice.steps, choice.cells, choice.octaves, choice.octaves_of, choice.seen, choice.clouds,
            choice.predicted,
            choice.predicted > allowed ? " (more than --error; there is nothing finer)" : "");
    shape_budget_apply(&choice, p->volume, options);
    return choice;
}

static picture_outcome march(const cli_common *common, const picture *p)
{
    shape_error error;
    shape_marcher *marcher;
    shape_dvec3 min = {0, 0, 0}, max = {1, 1, 1};
    shape_set_bounds(p->set, &min, &max);
    shape_march_options options =
        render_march_make(fmax(max.x - min.x, fmax(max.y - min.y, max.z - min.z)), &p->view);
    options.samples = samples_given ? (int)samples : 1;
    options.seed = common->seed;
    options.opaque = p->opaque;
    if (render_march_takes_lamp())
        options.lamp = make_lamp();
    options.progress = show_progress;
    shape_budget_choice choice = {0};
    if (error_given)
        choice = choose(p, &options);
    cli_check(shape_marcher_create(p->volume, &p->light, p->view.eye, &options, &marcher, &error), &error);
    cli_check(shape_march_render(marcher, &p->view, p->image->pixels, NULL, &error), &error);
    shape_marcher_destroy(marcher);
    shape_budget_free(&choice);
    picture_outcome outcome = {method_names[MARCH], options.samples, -1};
    return outcome;
}

static picture_outcome paper(const picture *p)
{
    shape_error error;
    shape_paper_options options = shape_paper_defaults();
    options.sweep = method == PAPER_NDT;
    options.lod = paper_lod;
    render_march_resolution(&options.resolution);
    options.samples = samples_given ? (int)samples : 1;
    options.progress = show_progress;
    cli_check(
        shape_paper_render(p->volume, &p->view, &p->light, &options, p->image->pixels, NULL, NULL, &error),
        &error);
    picture_outcome outcome = {method_names[method], options.samples, -1};
    return outcome;
}

static void check_error(void)
{
    static const char *const chosen[] = {"steps", "step", "light", "light-resolution"};
    if (noise_given && error_given)
        cli_wrong("--noise --error: they are the same (give one of them)");
    if (error_given && method >= PAPER)
        cli_wrong("--error: the methods of 2018 have one quality (choose reference or march)");
    if (!error_given || method != MARCH)
        return;
    for (size_t i = 0; i < sizeof chosen / sizeof *chosen; i++)
        if (cli_given(chosen[i]))
            cli_wrong("--error --%s: --error chooses steps and light grid itself (give one of them)",
                      chosen[i]);
    if (!(allowed >= 1e-4 && allowed <= 1))
        cli_wrong("--error %g: --method march takes 0.0001 to 1", allowed);
}

static void check_method(void)
{
    int cells;
    if (method != MARCH && render_march_given())
        cli_wrong("rules, steps, --jitter, alpha and the light options belong to --method march");
    if (method != REFERENCE && denoise)
        cli_wrong("--denoise belongs to --method reference");
    if (method != REFERENCE && render_resume_given())
        cli_wrong("--%s belongs to --method reference", render_resume_given());
    render_resume_check();
    if (method == REFERENCE && render_march_resolution(&cells))
        cli_wrong("--light-resolution: --method reference has no light grid");
    check_error();
    if (method == MARCH) /* before the input is read: whether that brings meshes is asked afterwards */
        render_march_check(true);
    if (method != REFERENCE && (noise_given || bounces_given || cli_picture_values.sun_angle_given))
        cli_wrong("--noise, --max-bounces and --sun-angle belong to --method reference");
    if (method >= PAPER && (cli_picture_values.lamp_given || cli_picture_values.lamp_intensity_given))
        cli_wrong("--lamp: the methods of 2018 know the sun alone (choose reference or march)");
    if (method == MARCH && cli_picture_values.lamp_given && !render_march_takes_lamp())
        cli_wrong(
            "--lamp: light grids, two-pass and --shadow grid are made for the sun alone (choose --light "
            "octaves or another that looks along a way)");
    if (method != REFERENCE && samples_given && samples > 4096)
        cli_wrong("--spp %d: --method %s takes at most 4096", (int)samples, method_names[method]);
    if (method >= PAPER && cli_given("visibility") && cli_picture_values.visibility > 0)
        cli_wrong("--visibility: the methods of 2018 have no air (choose reference or march)");
    if (method >= PAPER && render_opaque_given())
        cli_wrong("--mesh: the methods of 2018 have no opaque things (choose reference or march)");
    if (method < PAPER && paper_lod)
        cli_wrong("--paper-lod belongs to --method paper and paper-ndt");
}

static void check_command(const cli_common *common)
{
    if (common->argument_count != 1)
        cli_wrong("\"%s\" is one argument too many (see --help)", common->arguments[1]);
    if (stats && !strcmp(common->output, "-"))
        cli_wrong("--stats writes to standard output (name the picture with -o)");
    if (tolerance_given)
        cli_wrong("--tolerance belongs to --compare");
    check_method();
}

/* Camera and light of a scene; what this method leaves out of them is said. */
static void use_scene(const cli_input *input)
{
    if (!input->scene)
        return;
    cli_picture_use_scene(input->scene);
    if (method >= PAPER && input->scene->air_given)
        cli_say("note: --method %s does not show the scene's air (reference and march do)",
                method_names[method]);
    if (method >= PAPER && input->scene->lamp_given)
        cli_say("note: --method %s does not show the scene's lamp (reference and march do)",
                method_names[method]);
    if (method == MARCH && input->scene->lamp_given && !render_march_takes_lamp())
        cli_say("note: light grids, two-pass and --shadow grid do not show the scene's lamp (--light octaves "
                "and --method reference do)");
    if (method != REFERENCE && input->scene->sun_angle_given && input->scene->sun_angle > 0)
        cli_say("note: --method %s takes the sun as a direction, not a disc (--method reference has it)",
                method_names[method]);
    if (method >= PAPER)
        cli_note_meshes(input->scene, "not shown by this method");
}

static void render(const cli_common *common)
{
    shape_error error;
    shape_volume *volume;
    picture p;
    check_command(common);
    shape_image_format format = choose_format(common);
    cli_save_check(common);
    if (cli_save_wanted())
        render_opaque_save_check();
    cli_input input = cli_volume_input_read(common->arguments[0]);
    const shape_set *set = input.set;
    use_scene(&input);
    if (method == MARCH)
        render_march_check(render_opaque_given() || (input.scene && input.scene->mesh_count));
    if (cli_given("lamp-intensity") && !cli_picture_values.lamp_given)
        cli_wrong("--lamp-intensity: there is no lamp (give --lamp X,Y,Z)");
    opaque_scene_tell(render_resume_note_mesh);
    shape_opaque *opaque = render_opaque_read(&input);
    double ground;
    float ground_albedo[3];
    if (render_opaque_ground(&ground, ground_albedo))
        render_resume_note_ground(ground, ground_albedo);
    cli_picture_apply(set, &p.view, &p.light);
    p.image = make_image(&p.view, format);
    double start = seconds();
    cli_check(shape_volume_create(set, &volume, &error), &error);
    p.input = &input;
    p.set = set;
    p.volume = volume;
    p.opaque = opaque;
    picture_outcome outcome = method == REFERENCE ? trace(common, &p)
                              : method == MARCH   ? march(common, &p)
                                                  : paper(&p);
    cli_progress("tracing", 1);
    shape_image_options image_options = shape_image_options_defaults();
    image_options.exposure = p.view.exposure;
    write_image(common, p.image, format, &image_options);
    report(&outcome, p.image, seconds() - start);
    shape_image_destroy(p.image);
    shape_volume_destroy(volume);
    shape_opaque_destroy(opaque);
    cli_picture_save_scene(&input, &p.view, &p.light, render_opaque_save);
    cli_input_free(&input);
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
    for (const cli_group *group = groups; group->title; group++) {
        const char *name = group->options == compare_options ? NULL : cli_given_of(group->options);
        if (name)
            cli_wrong("--%s has no meaning with --compare", name);
    }
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
