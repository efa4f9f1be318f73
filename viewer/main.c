/* neph-view: a cloud in a window, or as a picture without one. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "cli_picture.h"
#include "cli_scene.h"
#include "cli_volume.h"
#include "shape/file.h"
#include "lighting.h"
#include "render_opaque.h"
#include "ready.h"
#include "scene_file.h"
#include "setting.h"
#include "shape/image.h"
#include "state_scene.h"
#include "view.h"
#include "watch.h"

static bool headless, paper_lod, flight;
static int method, maker = -1;
static const char *const makers[] = {"neph-gauss", "neph-meta", "neph-layer"};
static int64_t bench_frames, largest, samples = 32, light_grid = 48;
static const char *const method_names[] = {"default", "exact", "paper", "paper-ndt"};
static const char *shader_folder, *morph_path, *frames_file;
static bool bench_given, light_grid_given, samples_given, error_given, frames_given, overwrite, alpha,
    day_given, decay_given, time_given;
static double allowed_error, split_share = 0.5, frame_range[2], fps = 25, moment_time, decay_range[2];
static view_course course;

static const cli_option view_options[] = {
    {"headless", 0, CLI_FLAG, &headless, 0, 0, NULL, "no window: write one picture to -o", NULL, true},
    {"method", 0, CLI_CHOICE, &method, 0, 0, "default|exact|paper|paper-ndt",
     "how to draw; the last two only for comparison [default]", NULL, true},
    {"samples", 0, CLI_INTEGER, &samples, 1, 65536, "N", "samples a pixel of a picture at rest [32]",
     &samples_given, true},
    {"light-grid", 0, CLI_INTEGER, &light_grid, 2, 256, "N",
     "cells along the longest side of a cloud's light grid [48; paper: 40]", &light_grid_given, true},
    {"error", 0, CLI_NUMBER, &allowed_error, 1e-4, 1, "E",
     "as fine as needed for the picture to change by no more than E when drawn twice as fine; a window "
     "begins so [off]",
     &error_given, true},
    {"make", 0, CLI_CHOICE, &maker, 0, 0, "gauss|meta|layer",
     "no IN: what neph-gauss, neph-meta or neph-layer makes, whose options are in the panel [IN]", NULL,
     true},
    {"split", 0, CLI_NUMBER, &split_share, 0, 1, "S",
     "of two files: the share of the width that shows the first [0.5]", NULL, true},
    {"bench", 0, CLI_INTEGER, &bench_frames, 1, 100000, "N",
     "draw N frames on an orbit of half a degree a frame, print times as JSON", &bench_given, true},
    {"flight", 0, CLI_FLAG, &flight, 0, 0, NULL,
     "--bench: fly straight on through the target and out behind it, rather than round it", NULL, true},
    {"bench-frames", 0, CLI_TEXT, &frames_file, 0, 0, "FILE",
     "--bench: also write a row a frame: times, work, change, camera (.csv)", NULL, true},
    {"paper-lod", 0, CLI_FLAG, &paper_lod, 0, 0, NULL,
     "paper methods: the printed distance formula for the step, not 0.1", NULL, true},
    {"alpha", 0, CLI_FLAG, &alpha, 0, 0, NULL,
     "pictures with coverage as alpha, the sky left out (.png, .exr)", NULL, true},
    {"largest", 0, CLI_INTEGER, &largest, 0, 16384, "PIXELS",
     "longest side of what is drawn at once, for GPUs with little memory; 0: what the GPU can [0]", NULL,
     true},
    {"shaders", 0, CLI_TEXT, &shader_folder, 0, 0, "FOLDER",
     "read the shaders from here, not the built-in ones", NULL, true},
    {0}};

static const cli_option motion_options[] = {
    {"frames", 0, CLI_RANGE, frame_range, 0, 1e9, "A..B",
     "write frames A to B without a window, to -o with a place for the number: frame.%04d.png", &frames_given,
     true},
    {"overwrite", 0, CLI_FLAG, &overwrite, 0, 0, NULL,
     "draw frames anew whose files are there and whole [they are left alone]", NULL, true},
    {"fps", 0, CLI_NUMBER, &fps, 1e-3, 1e6, "F", "frames a second: frame N is the time N / F [25]", NULL,
     true},
    {"time", 0, CLI_NUMBER, &moment_time, -1e9, 1e9, "T",
     "time of a single picture and of the window, seconds [0]", &time_given, true},
    {"turntable", 0, CLI_NUMBER, &course.turn_seconds, 1e-3, 1e9, "T",
     "turn the eye round its target once in T seconds [it stands]", NULL, true},
    {"wind", 0, CLI_VECTOR, course.motion.wind, -1000, 1000, "X,Y,Z",
     "carries the clouds, noise and all, metres a second [0,0,0]", NULL, true},
    {"shear", 0, CLI_NUMBER, &course.motion.shear, -10, 10, "S",
     "how much faster the wind is a metre higher, 1/s [0]", NULL, true},
    {"drift", 0, CLI_VECTOR, course.motion.drift, -1000, 1000, "X,Y,Z",
     "moves the noise through clouds that stay, metres a second [0,0,0]", NULL, true},
    {"life", 0, CLI_NUMBER, &course.motion.life, 1e-3, 1e9, "T",
     "each primitive grows, lasts and decays within T seconds, again and again [for ever]", NULL, true},
    {"grow", 0, CLI_NUMBER, &course.motion.grow, 0, 1e9, "T",
     "the clouds grow out of their bases in T seconds [they are there]", NULL, true},
    {"decay", 0, CLI_RANGE, decay_range, 0, 1e9, "A..B", "the clouds decay from second A to second B [never]",
     &decay_given, true},
    {"morph", 0, CLI_TEXT, &morph_path, 0, 0, "OTHER",
     "the clouds become those of another .neph or grammar [none]", NULL, true},
    {"morph-time", 0, CLI_NUMBER, &course.morph_seconds, 1e-3, 1e9, "T", "in so many seconds [4]", NULL,
     true},
    {"day", 0, CLI_NUMBER, &course.day.hour, 0, 24, "HOUR",
     "the sun by the time of day, solar hours at time 0 [it stands by --sun]", &day_given, true},
    {"day-speed", 0, CLI_NUMBER, &course.day_speed, -1000, 1000, "H", "hours of the day a second [0.5]", NULL,
     true},
    {"latitude", 0, CLI_NUMBER, &course.day.latitude, -90, 90, "DEGREES", "for --day [50]", NULL, true},
    {"declination", 0, CLI_NUMBER, &course.day.declination, -23.45, 23.45, "DEGREES",
     "of the sun, for --day: 23.44 in June, -23.44 in December [0]", NULL, true},
    {0}};

static const cli_group groups[] = {{"View", view_options},
                                   {"Picture", cli_picture_options},
                                   {"Light in clouds", view_light_options},
                                   {"Opaque things", render_opaque_options},
                                   {"Time", motion_options},
                                   {"Volumes (.vdb, raw)", cli_volume_options},
                                   {"Medium and place of volumes", cli_optics_options},
                                   {"Scene", cli_scene_options},
                                   {0}};

static const cli_program program = {
    .name = "neph-view",
    .arguments = "IN [OTHER]",
    .about =
        "Shows a .neph, a grammar, a mesh as neph-mesh makes a cloud of it, a scene (docs/scene.md) or a\n"
        "volume (.vdb, raw) in a window, or writes pictures of it without one. A second file is shown "
        "beside\n"
        "it, right of a line that can be dragged, in the same view and light.\n"
        "\"-\" reads standard input. --save-scene writes what the window shows when it is closed. A grammar\n"
        "is derived as neph-lsys does it, by --seed. The window watches the file and shows it anew when it "
        "is\n"
        "saved. In it: Tab for the panel, H for all keys; drag to turn, right drag to look round, wheel to "
        "come\n"
        "nearer, W A S D E Q to fly, + and - for the exposure, Home for the first view, Esc to quit.",
    .examples = "  neph-view castellanus.lsys\n"
                "  neph-lsys castellanus.lsys | neph-view - --headless --size 1280x720 -o castellanus.png\n"
                "  neph-view castellanus.neph --frames 0..99 --wind 1,0,0 --shear 0.02 -o frame.%04d.png\n"
                "  neph-view before.neph after.neph\n"
                "  neph-view --make gauss --seed 7\n"
                "  neph-view castellanus.neph --bench 50\n",
    .min_arguments = 0, /* --make takes none */
    .max_arguments = 2,
    .groups = groups};

/* Reads the picture from the renderer and writes it. */
static void write_picture(const view_job *job, const shape_view *view, shape_gl_renderer *renderer,
                          const cli_common *common)
{
    shape_error error;
    unsigned char *bytes;
    size_t size;
    cli_check(view_encode(renderer, view, job->alpha, common->output, &bytes, &size, &error), &error);
    cli_write(common, bytes, size, true);
    free(bytes);
}

static void describe_choice(const view_quality *chosen, double change, char *text, size_t room)
{
    snprintf(text, room,
             "light grid of %d cells, %.3g million voxels at most, %d samples a pixel: %.4f from the picture "
             "half as fine%s",
             chosen->light_cells, (double)chosen->voxels * 1e-6, chosen->samples, change,
             change > allowed_error ? " (more than --error; there is no finer one)" : "");
}

/* A picture to --error, and what was chosen for it. */
static void draw_within(const view_job *job, const shape_view *view, const shape_light *light,
                        const cli_common *common)
{
    shape_error error;
    shape_gl_renderer *renderer;
    view_quality chosen;
    double change;
    cli_check(view_draw_within(job, view, light, allowed_error, &renderer, &chosen, &change, &error), &error);
    char text[192];
    describe_choice(&chosen, change, text, sizeof text);
    cli_say("%s", text);
    write_picture(job, view, renderer, common);
    shape_gl_destroy(renderer);
}

/* A window to --error begins with what its first view needs, found before it is opened. */
static void choose_for_window(view_job *job)
{
    shape_error error;
    shape_gl_context *context;
    shape_gl_renderer *renderer;
    view_quality chosen;
    double change;
    shape_view view = job->view;
    shape_light light = job->light;
    view_course_view(&job->course, job->time, &view);
    view_course_light(&job->course, job->time, &light);
    cli_check(view_job_place(job, job->time, &error), &error);
    cli_check(shape_gl_context_create(&context, &error), &error);
    cli_check(view_draw_within(job, &view, &light, allowed_error, &renderer, &chosen, &change, &error),
              &error);
    shape_gl_destroy(renderer);
    shape_gl_context_destroy(context);
    view_job_free(job);
    job->options.bake_voxels = chosen.voxels;
    job->options.fixed_light = true;
    job->options.light.resolution = job->state->light_grid = chosen.light_cells;
    job->samples = job->state->samples = chosen.samples;
    describe_choice(&chosen, change, job->chosen, sizeof job->chosen);
    cli_say("%s", job->chosen);
}

static void draw_headless(view_job *job, double began, double libraries_ms, const cli_common *common)
{
    shape_error error;
    shape_gl_context *context;
    shape_gl_renderer *renderer;
    shape_view view = job->view;
    shape_light light = job->light;
    view_course_view(&job->course, job->time, &view);
    view_course_light(&job->course, job->time, &light);
    view_ready *ready;
    shape_gl_first *first;
    cli_check(view_ready_start(job, &view, &light, &ready, &error), &error);
    shape_error no_context;
    double context_ms = view_now_ms();
    shape_status opened = shape_gl_context_create(&context, &no_context);
    context_ms = view_now_ms() - context_ms;
    cli_check(view_ready_end(ready, &first, &error), &error);
    cli_check(opened, &no_context);
    if (job->other_set) {
        unsigned char *bytes;
        size_t size;
        cli_check(view_encode_split(job, &view, &light, common->output, &bytes, &size, &error), &error);
        cli_write(common, bytes, size, true);
        free(bytes);
        shape_gl_context_destroy(context);
        return;
    }
    if (error_given) {
        draw_within(job, &view, &light, common);
        shape_gl_context_destroy(context);
        return;
    }
    cli_check(shape_gl_create(&job->options, &renderer, &error), &error);
    cli_check(shape_gl_load(renderer, job->volume, &error), &error);
    cli_check(shape_gl_light(renderer, &light, &error), &error);
    shape_gl_take_first(renderer, first);
    if (bench_given) {
        const view_bench plan = {(int)bench_frames,
                                 flight,
                                 method_names[job->options.method],
                                 frames_file,
                                 began - libraries_ms,
                                 libraries_ms,
                                 context_ms};
        shape_view last = view;
        cli_check(view_bench_run(job, renderer, &plan, &last, &error), &error);
        if (common->output_given)
            write_picture(job, &last, renderer, common);
    } else {
        const view_plan plan = {
            .samples = job->samples, .largest = job->largest, .alpha = job->alpha, .progress = cli_progress};
        unsigned char *bytes;
        size_t size;
        cli_check(view_encode_drawn(renderer, &view, &plan, common->output, &bytes, &size, &error), &error);
        cli_write(common, bytes, size, true);
        free(bytes);
    }
    shape_gl_destroy(renderer);
    shape_gl_context_destroy(context);
}

/* Two files are two pictures of one moment. */
static void check_second(const cli_common *common)
{
    if (bench_given || frames_given || error_given || morph_path)
        cli_wrong("\"%s\": --bench, --frames, --error and --morph take one file", common->arguments[1]);
    if (!strcmp(common->arguments[0], "-") && !strcmp(common->arguments[1], "-"))
        cli_wrong("- - : standard input is one file");
}

/* A wrong command is told before the work, not after. */
static void check_command(const cli_common *common, view_frames *frames)
{
    shape_error error;
    if (!common->argument_count && maker < 0)
        cli_wrong("%s is missing (see --help)", program.arguments);
    if (common->argument_count && maker >= 0)
        cli_wrong("\"%s\": --make takes no file", common->arguments[0]);
    if (!headless && !bench_given && !frames_given && common->output_given)
        cli_wrong("-o needs --headless, --frames or --bench (a window writes no picture)");
    if (error_given && (bench_given || frames_given))
        cli_wrong("--error is for a picture or a window (leave --bench and --frames out)");
    if (error_given && (samples_given || light_grid_given || method >= SHAPE_GL_PAPER))
        cli_wrong("--error chooses samples and light grid itself, for the methods default and exact");
    if (alpha && !headless && !frames_given)
        cli_wrong("--alpha needs --headless or --frames");
    if (flight && !bench_given)
        cli_wrong("--flight needs --bench");
    if (frames_file && !bench_given)
        cli_wrong("--bench-frames needs --bench");
    if (bench_given && frames_given)
        cli_wrong("--bench and --frames are two ways to draw (give one of them)");
    if (overwrite && !frames_given)
        cli_wrong("--overwrite needs --frames");
    if (largest && largest < SHAPE_GL_PART_STEP)
        cli_wrong("--largest %d: must be 0 or at least %d", (int)largest, SHAPE_GL_PART_STEP);
    if (largest && (bench_given || error_given))
        cli_wrong("--largest: --bench and --error draw a picture at once");
    if (paper_lod && method < SHAPE_GL_PAPER)
        cli_wrong("--paper-lod belongs to --method paper and paper-ndt");
    if (cli_given("fps") && !frames_given)
        cli_wrong("--fps needs --frames");
    for (const char *const *name = (const char *const[]){"day-speed", "latitude", "declination", NULL}; *name;
         name++)
        if (cli_given(*name) && !day_given)
            cli_wrong("--%s needs --day", *name);
    if (cli_given("morph-time") && !morph_path)
        cli_wrong("--morph-time needs --morph");
    if (common->argument_count > 1)
        check_second(common);
    else if (cli_given("split"))
        cli_wrong("--split needs a second file to stand right of the line");
    if (samples_given && bench_given)
        cli_wrong("--samples: --bench draws moving views, of one sample each");
    if (morph_path && (cli_has_suffix(morph_path, ".json") || cli_is_volume(morph_path)))
        cli_wrong("--morph %s: takes a .neph or a grammar", morph_path);
    if (frames_given && time_given)
        cli_wrong("--time is for one picture (frame N is the time N / --fps)");
    if (frames_given) {
        frames->first = (int64_t)frame_range[0];
        frames->last = (int64_t)frame_range[1];
        if ((double)frames->first != frame_range[0] || (double)frames->last != frame_range[1])
            cli_wrong("--frames %.9g..%.9g: expected whole numbers A..B", frame_range[0], frame_range[1]);
        frames->fps = fps;
        frames->overwrite = overwrite;
        frames->output = common->output;
        if (view_frames_check(frames, &error))
            cli_wrong("%s", error.text);
    }
    if (common->output_given && strcmp(common->output, "-")) {
        shape_image_format format;
        if (shape_image_format_find(common->output, &format, &error))
            cli_wrong("%s", error.text);
        if (alpha && format == SHAPE_IMAGE_PFM)
            cli_wrong("--alpha: a .pfm holds no alpha (write .png or .exr)");
    }
}

static void plan(view_job *job, const cli_common *common)
{
    bool paper = method == SHAPE_GL_PAPER || method == SHAPE_GL_PAPER_NDT;
    job->options = shape_gl_defaults();
    job->options.method = (shape_gl_method)method;
    job->options.shader_folder = shader_folder;
    job->options.paper_lod = paper_lod;
    job->options.no_background = alpha;
    job->options.background = job->options.early = bench_given;
    job->options.seed = common->seed;
    job->options.light.resolution = paper && !light_grid_given ? 40 : (int)light_grid;
    job->samples = (int)samples;
    job->path = common->argument_count ? common->arguments[0] : "";
    job->title = common->argument_count ? job->path : makers[maker];
    job->other_path = common->argument_count > 1 ? common->arguments[1] : NULL;
    job->divider = (float)split_share;
    job->largest = (int)largest;
    cli_given_text(cli_volume_options, job->opening, sizeof job->opening);
    cli_given_text(cli_optics_options, job->opening, sizeof job->opening);
    cli_given_text(cli_scene_options + 1, job->opening, sizeof job->opening); /* --allow-outside */
    render_opaque_text(job->things, sizeof job->things);
    job->alpha = alpha;
    job->morph_path = morph_path;
    job->time = moment_time;
    job->seed = common->seed;
    job->generator =
        maker < 0 ? view_generator_none(common->seed) : view_generator_named(makers[maker], common->seed);
    course.motion.seed = common->seed;
    course.day_runs = day_given;
    if (decay_given) {
        course.motion.decay_start = decay_range[0];
        course.motion.decay = decay_range[1] - decay_range[0];
        if (!(course.motion.decay > 0))
            cli_wrong("--decay %g: expected a range A..B of seconds", decay_range[0]);
    }
    job->course = course;
}

static void take_opened(view_job *job, const view_opened *opened)
{
    job->set = opened->input.set;
    job->scene = opened->scene || opened->volume;
    job->volume_file = opened->volume;
    job->generator = opened->used;
}

/* Whether the command line says what a scene's "view" calls so; --split says where the line stands. */
static bool is_said(const char *name)
{
    return cli_given(strcmp(name, "divider") ? name : "split");
}

/* What the scene's "view" says goes for what the command line does not say. */
static void take_scene(view_job *job, const shape_scene *scene)
{
    shape_error error;
    view_state *s = job->state;
    if (!scene)
        return;
    if (view_state_load_view(s, scene, is_said, &error))
        cli_fail("%s: %s", job->path, error.text);
    cli_picture_use_scene(scene);
    if (cli_picture_values.day_given && !day_given) {
        job->course.day_runs = s->course.day_runs = true;
        s->course.day = cli_picture_values.day;
    }
    cli_picture_values.day_given = false; /* the course lights by it */
    job->course = s->course;
    job->time = s->time;
    job->samples = s->samples;
    job->options.light.resolution = s->light_grid;
    job->options.method = (shape_gl_method)s->method;
    job->divider = s->divider;
}

/* The same the other way round: a window's state, but for clouds, camera and light. */
static void begin_state(view_job *job)
{
    view_state *s = job->state = calloc(1, sizeof *s);
    if (!s)
        cli_fail("not enough memory");
    s->course = job->course;
    s->time = job->time;
    s->method = (int)job->options.method;
    s->other_method = s->method == SHAPE_GL_EXACT ? SHAPE_GL_DEFAULT : SHAPE_GL_EXACT;
    s->lighting = view_lighting_given();
    s->samples = job->samples;
    s->light_grid = job->options.light.resolution;
    s->divider = job->divider;
}

/* Camera and light, as they are at time 0. */
static void finish_state(view_job *job)
{
    view_state *s = job->state;
    const shape_dvec3 *eye = &job->view.eye, *target = &job->view.target;
    memcpy(s->eye, eye, sizeof s->eye);
    memcpy(s->target, target, sizeof s->target);
    s->fov = job->view.fov;
    s->exposure = job->view.exposure;
    memcpy(s->sun, cli_picture_values.sun, sizeof s->sun);
    memcpy(s->sun_irradiance, job->light.sun_irradiance, sizeof s->sun_irradiance);
    s->sky = job->light.sky;
    memcpy(s->sky_radiance, job->light.sky_radiance, sizeof s->sky_radiance);
    s->air = job->light.air;
    s->generator = job->generator;
}

/* --save-scene: what was shown, by the state of the window or of the picture. */
static void save_scene(const view_job *job)
{
    shape_error error;
    char *text;
    size_t size;
    bool outside;
    if (!cli_save_wanted())
        return;
    const view_scene_parts parts = {.state = job->state,
                                    .made = job->set,
                                    .scene = job->scene_read,
                                    .path = job->path,
                                    .volume = job->volume_file,
                                    .more = &job->more,
                                    .other = job->other_path,
                                    .size = {job->view.width, job->view.height}};
    cli_check(view_scene_text(&parts, cli_save_path(), &text, &size, &outside, &error), &error);
    cli_check(shape_file_write(cli_save_path(), text, size, &error), &error);
    free(text);
    if (outside)
        cli_say("note: %s names files outside its folder, and can be opened with --allow-outside only",
                cli_save_path());
}

/* Of a scene, it is known only now whether there are meshes. */
static void check_opaque(const view_job *job)
{
    if (!job->opaque || job->options.method < SHAPE_GL_PAPER)
        return;
    if (render_opaque_given())
        cli_wrong("--mesh, --ground: the methods of 2018 have no opaque things (choose default or exact)");
    cli_say("note: meshes of the scene are not shown by --method %s", method_names[job->options.method]);
}

/* The file that a scene is compared with, where the command line names none and one picture is not wanted by itself. */
static char *find_compared(view_job *job, const shape_scene *scene)
{
    if (!scene || !scene->compare || job->other_path || bench_given || frames_given || error_given ||
        morph_path)
        return NULL;
    char *path = cli_scene_file(job->path, scene->compare);
    job->other_path = path;
    return path;
}

/* What the job looks at, kept until the end. */
typedef struct opened_files {
    view_job *job;
    view_opened first, second;
    shape_set *turned; /* what --morph turns the clouds into */
    shape_morph *morph;
    shape_scene *list; /* --mesh */
    char *compared;
} opened_files;

static void check_air(void)
{
    if (!(method >= SHAPE_GL_PAPER && cli_picture_values.visibility > 0))
        return;
    if (cli_given("visibility"))
        cli_wrong("--visibility: the methods of 2018 have no air (choose default or exact)");
    cli_say("note: the scene's air is not shown by --method %s", method_names[method]);
}

static void read_morph(opened_files *files)
{
    shape_error error;
    view_job *job = files->job;
    view_generator none = view_generator_none(job->seed);
    if (!morph_path)
        return;
    files->turned = view_open_source(morph_path, &none);
    cli_check(shape_morph_create(job->set, files->turned, &files->morph, &error), &error);
    job->morph = files->morph;
}

/* All files of the command line, into the job. Mistakes end the program. */
static void read_files(void *context)
{
    opened_files *files = context;
    view_job *job = files->job;
    files->first = view_open(job->path, &job->generator);
    take_opened(job, &files->first);
    take_scene(job, files->first.input.scene);
    view_lighting_check(&job->state->lighting, (int)job->options.method);
    job->options.lighting = view_lighting_gl(&job->state->lighting);
    files->compared = find_compared(job, files->first.input.scene);
    if (job->other_path) {
        view_generator none = view_generator_none(job->seed);
        files->second = view_open(job->other_path, &none);
        job->other_set = files->second.input.set;
        job->other_watched = view_watch_can(job->other_path) && !files->second.volume;
    }
    if (!files->first.volume && !files->second.volume)
        cli_refuse_volume_options();
    check_air();
    if (cli_picture_values.lamp_given)
        cli_say("note: neph-view does not show the scene's lamp (neph-render does)");
    job->opaque = render_opaque_read(&files->first.input);
    job->options.light.opaque = job->opaque;
    files->list = render_opaque_list();
    job->more.list = files->list;
    job->more.has_ground = render_opaque_ground(&job->more.height, job->more.ground_albedo);
    job->scene_read = files->first.input.scene;
    check_opaque(job);
    cli_picture_apply(job->set, &job->view, &job->light);
    finish_state(job);
    read_morph(files);
}

static void read_for_window(void *context)
{
    opened_files *files = context;
    read_files(files);
    if (error_given)
        choose_for_window(files->job);
}

int main(int argc, char **argv)
{
    const double libraries_ms = view_processor_ms(),
                 began = view_now_ms(); /* one thread until here, never waiting */
    cli_common common;
    course = view_course_defaults();
    cli_parse(&program, argc, argv, &common);
    shape_error error;
    view_frames frames = {0};
    view_job job = {0};
    opened_files files = {.job = &job};
    bool window = !headless && !bench_given && !frames_given;
    check_command(&common, &frames);
    plan(&job, &common);
    begin_state(&job);
    if (window)
        cli_scene_leave_edits(VIEW_CLOUDS_MAX); /* the panel has them */
    cli_save_check(&common);
    if (cli_save_wanted())
        render_opaque_save_check();
    if (window) {
        job.view.width = (int)cli_picture_values.size[0]; /* until a scene says otherwise */
        job.view.height = (int)cli_picture_values.size[1];
        const view_window_calls calls = {read_for_window, save_scene, &files};
        cli_check(view_window(&job, &calls, &error), &error);
    } else {
        read_files(&files);
        if (frames_given) {
            cli_check(view_frames_draw(&job, &frames, &error), &error);
        } else {
            job.load_ms = view_now_ms() - began;
            draw_headless(&job, began, libraries_ms, &common);
        }
    }
    view_job_free(&job);
    shape_morph_destroy(files.morph);
    shape_set_destroy(files.turned);
    if (!window)
        save_scene(&job);
    free(job.state);
    free(files.compared);
    shape_opaque_destroy(job.opaque);
    shape_scene_destroy(files.list);
    cli_input_free(&files.first.input);
    cli_input_free(&files.second.input);
    return cli_finish(&common);
}
