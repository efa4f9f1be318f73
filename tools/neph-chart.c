/* neph-chart: what every method and setting costs in time and in error, measured on scenes, as a table, a chart and a
 * report. */
#include <sys/types.h>

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "chart.h"
#include "cli.h"
#include "cli_picture.h"
#include "cli_scene.h"
#include "shape/neph.h"

enum { SCENES_MOST = 32, QUICK_SECONDS = 48, QUICK_WIDTH = 128 };

static bool quick, appendix, runs_given, size_given;
static int64_t runs = 5, size[2];
static double noise = 0.02;

static const cli_option chart_options[] = {
    {"quick", 0, CLI_FLAG, &quick, 0, 0, NULL,
     "few settings, pictures 128 pixels wide, a rough reference: within a minute [off]", NULL, true},
    {"appendix", 0, CLI_FLAG, &appendix, 0, 0, NULL,
     "of one scene, frame times against one setting at a time instead: series.csv, .svg, .png [off]", NULL,
     true},
    {"size", 0, CLI_SIZE, size, 1, 4096, "WxH", "of the pictures, pixels [the scene's, 640x360]", &size_given,
     true},
    {"runs", 0, CLI_INTEGER, &runs, 1, CHART_RUNS, "N", "times that each is measured [5; --quick 3]",
     &runs_given, true},
    {"reference-noise", 0, CLI_NUMBER, &noise, 1e-4, 10, "T",
     "the reference is traced to this relative error [0.02]", NULL, true},
    {0}};

static const cli_group groups[] = {{"Chart", chart_options}, {"Scene", cli_outside_options}, {0}};

static const cli_help help[] = {{"output", "the folder, made where it is not there"}, {0}};

static const cli_program program = {
    .name = "neph-chart",
    .arguments = "SCENE...",
    .about =
        "Draws each scene (.neph or docs/scene.md) by every method and setting, measures time and error\n"
        "against the path tracer, and writes results.csv, chart.svg, chart.png and report.md into the\n"
        "folder -o. Started again with the same words, it goes on where it was broken off.",
    .examples = "  neph-chart --quick cloud.neph -o out\n"
                "  neph-chart --size 320x180 examples/scenes/bench/cumulus.json -o out\n"
                "  neph-chart --appendix --size 160x90 --runs 3 examples/scenes/bench/cumulus.json -o out\n",
    .min_arguments = 1,
    .max_arguments = SCENES_MOST,
    .groups = groups,
    .help = help};

/* The scene's digest: its clouds' bytes, and whatever else the reference depends on. */
static void digest_scene(const chart_plan *plan, chart_scene *scene)
{
    shape_error error;
    unsigned char *bytes;
    size_t count;
    char clouds[CHART_DIGEST + 1], all[1024];
    const shape_view *v = &scene->view;
    const shape_light *l = &scene->light;
    cli_check(shape_neph_encode(scene->set, &bytes, &count, &error), &error);
    chart_digest(bytes, count, clouds);
    free(bytes);
    int length =
        snprintf(all, sizeof all,
                 "%s %s %dx%d eye %.17g %.17g %.17g target %.17g %.17g %.17g fov %.17g sun %.17g %.17g %.17g "
                 "%.9g %.9g %.9g angle %.17g sky %d %.9g %.9g %.9g noise %.17g seed %llu %d",
                 shape_version(), clouds, v->width, v->height, v->eye.x, v->eye.y, v->eye.z, v->target.x,
                 v->target.y, v->target.z, v->fov, l->sun.x, l->sun.y, l->sun.z, (double)l->sun_irradiance[0],
                 (double)l->sun_irradiance[1], (double)l->sun_irradiance[2], scene->sun_angle, (int)l->sky,
                 (double)l->sky_radiance[0], (double)l->sky_radiance[1], (double)l->sky_radiance[2],
                 plan->noise, (unsigned long long)plan->seed, plan->quick);
    chart_digest(all, (size_t)length, scene->digest);
}

static void choose_size(const chart_plan *plan, shape_view *view)
{
    if (size_given) {
        view->width = (int)size[0];
        view->height = (int)size[1];
    } else if (plan->quick && view->width > QUICK_WIDTH) {
        int height = view->height * QUICK_WIDTH / view->width;
        view->width = QUICK_WIDTH;
        view->height = height > 1 ? height : 1;
    }
}

/* Names stand in a CSV file and in a picture. */
static void name_scene(chart_scene *scene)
{
    cli_bare_name(scene->path, "stdin", scene->name);
    for (char *c = scene->name; *c; c++)
        if ((unsigned char)*c < 32 || strchr(",\"'\\|`", *c))
            *c = '_';
}

static void read_scene(const chart_plan *plan, const char *path, chart_scene *scene)
{
    const cli_picture untouched = cli_picture_values;
    scene->path = path;
    name_scene(scene);
    cli_input input = cli_input_read(path);
    shape_dvec3 min, max;
    if (!shape_set_bounds(input.set, &min, &max))
        cli_fail("%s: there is no cloud to measure by", path);
    if (input.scene)
        cli_picture_use_scene(input.scene);
    cli_note_meshes(input.scene, "left out");
    if (cli_picture_values.lamp_given)
        cli_say("note: %s: the lamp is left out, since most methods could not show it", path);
    /* The size comes first: the view that frames a cloud depends on it. */
    shape_view sized = {.width = (int)cli_picture_values.size[0], .height = (int)cli_picture_values.size[1]};
    choose_size(plan, &sized);
    cli_picture_values.size[0] = sized.width;
    cli_picture_values.size[1] = sized.height;
    if (cli_picture_values.visibility > 0)
        cli_say("note: %s: the air is left out, since the methods of 2018 could not show it", path);
    cli_picture_values.visibility = cli_picture_values.air_height = 0;
    cli_picture_values.air_height_given = false;
    cli_picture_apply(input.set, &scene->view, &scene->light);
    scene->sun_angle = cli_picture_values.sun_angle;
    scene->side = max.x - min.x > max.y - min.y ? max.x - min.x : max.y - min.y;
    scene->side = max.z - min.z > scene->side ? max.z - min.z : scene->side;
    scene->set = input.set;
    input.set = NULL;
    cli_input_free(&input);
    cli_picture_values = untouched;
    digest_scene(plan, scene);
    chart_rows_make(plan, scene);
}

static void check_names(const chart_plan *plan)
{
    for (size_t i = 0; i < plan->scene_count; i++)
        for (size_t k = 0; k < i; k++)
            if (!strcmp(plan->scenes[i].name, plan->scenes[k].name))
                cli_fail("two scenes are called \"%s\" (rename one)", plan->scenes[i].name);
}

static void make_folder(const char *folder)
{
    struct stat info;
    if (mkdir(folder, 0777) && errno != EEXIST)
        cli_fail("%s: cannot make the folder: %s", folder, strerror(errno));
    if (stat(folder, &info) || !S_ISDIR(info.st_mode))
        cli_fail("%s: is not a folder (name one with -o)", folder);
}

static void summarise(const chart_plan *plan)
{
    size_t measured = 0, all = 0;
    for (size_t i = 0; i < plan->scene_count; i++) {
        all += plan->scenes[i].row_count;
        for (size_t k = 0; k < plan->scenes[i].row_count; k++)
            measured += plan->scenes[i].rows[k].runs[CHART_PICTURE] > 0;
    }
    cli_say("%zu of %zu settings measured; %s/report.md tells which to pick", measured, all, plan->folder);
}

int main(int argc, char **argv)
{
    cli_common common;
    cli_parse(&program, argc, argv, &common);
    if (!common.output_given || !strcmp(common.output, "-"))
        cli_wrong("results are several files (name a folder with -o)");
    if (appendix && (quick || common.argument_count != 1))
        cli_wrong("--appendix takes one scene, and no --quick (--size and --runs say how long it takes)");
    static chart_scene scenes[SCENES_MOST];
    chart_plan plan = {.folder = common.output,
                       .scenes = scenes,
                       .scene_count = (size_t)common.argument_count,
                       .runs = quick && !runs_given ? 3 : (int)runs,
                       .noise = noise,
                       .seed = common.seed,
                       .quick = quick,
                       .start = chart_seconds(),
                       .limit = quick ? QUICK_SECONDS : 0};
    for (size_t i = 0; i < plan.scene_count; i++)
        read_scene(&plan, common.arguments[i], &scenes[i]);
    check_names(&plan);
    chart_need_gnuplot();
    make_folder(plan.folder);
    if (appendix) {
        chart_series(&plan, &scenes[0]);
        shape_set_destroy(scenes[0].set);
        free(scenes[0].rows);
        return cli_finish(&common);
    }
    chart_results_read(&plan);
    chart_measure(&plan);
    chart_results_write(&plan);
    chart_draw(&plan);
    chart_report(&plan);
    summarise(&plan);
    for (size_t i = 0; i < plan.scene_count; i++) {
        shape_set_destroy(scenes[i].set);
        free(scenes[i].reference);
        free(scenes[i].rows);
    }
    return cli_finish(&common);
}
