/* The options of neph-lsys and the cloud that they make, for the program and for scenes. */
#include "cli_lsys.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "shape/file.h"

static int64_t iterations, max_primitives = 1000000;
static double angle[2], radius[2], length[2], shrink[2];
static bool iterations_given, angle_given, radius_given, length_given, shrink_given;

static const cli_option derivation_options[] = {
    {"iterations", 0, CLI_INTEGER, &iterations, 0, SHAPE_GRAMMAR_ITERATIONS_MAX, "N",
     "derivation levels [the file's, 5]", &iterations_given, false},
    {"angle", 0, CLI_RANGE, angle, -1e6, 1e6, "A|A..B",
     "turn of + - & ^ \\ / without argument, degrees [the file's, 25]", &angle_given, false},
    {"radius", 0, CLI_RANGE, radius, 1e-9, 1e9, "R|R..S",
     "radius of a puff without argument, metres [the file's, 1]", &radius_given, false},
    {"length", 0, CLI_RANGE, length, 0, 1e9, "L|L..M",
     "step of a puff without argument, metres [the file's, 1]", &length_given, false},
    {"shrink", 0, CLI_RANGE, shrink, 1e-9, 1000, "F|F..E",
     "factor on radius and length a derivation level [the file's, 1]", &shrink_given, false},
    {"max-primitives", 0, CLI_INTEGER, &max_primitives, 1, 1e12, "N",
     "more end the work with an error [1000000]", NULL, CLI_SCENE_ONLY},
    {0}};

shape_grammar *cli_lsys_read(const char *path)
{
    const char *shown = strcmp(path, "-") ? path : "standard input";
    shape_error error;
    unsigned char *bytes;
    size_t size;
    cli_check(shape_file_read(path, SHAPE_GRAMMAR_TEXT_MAX, &bytes, &size, &error), &error);
    cli_note_input(path, bytes, size);
    static shape_mistakes mistakes;
    shape_grammar *grammar;
    shape_status status = shape_grammar_parse(bytes, size, shown, &grammar, &mistakes, &error);
    free(bytes);
    if (status != SHAPE_ERROR_FORMAT) {
        cli_check(status, &error);
        return grammar;
    }
    for (int i = 0; i < mistakes.count; i++)
        cli_error("%s:%d:%d: %s", shown, mistakes.items[i].line, mistakes.items[i].column,
                  mistakes.items[i].text);
    if (mistakes.more)
        cli_error("%s: there are more mistakes (mend these first)", shown);
    exit(CLI_FAILED);
}

static void override(bool given, const double values[2], shape_grammar_range *range)
{
    if (given) {
        range->low = values[0];
        range->high = values[1];
    }
}

shape_derive_options cli_lsys_options(const shape_grammar *grammar, uint64_t seed)
{
    shape_derive_options options = shape_derive_defaults(grammar);
    options.seed = seed;
    options.max_primitives = cli_generator_limit((size_t)max_primitives);
    if (iterations_given)
        options.iterations = (int)iterations;
    override(angle_given, angle, &options.angle);
    override(radius_given, radius, &options.radius);
    override(length_given, length, &options.length);
    override(shrink_given, shrink, &options.shrink);
    return options;
}

static void summarize(const shape_set *set, const shape_derive_options *options,
                      const shape_derive_counts *counts)
{
    const shape_primitives *list = shape_set_list_const(set, 0);
    shape_dvec3 min = {0, 0, 0}, max = {0, 0, 0};
    shape_set_bounds(set, &min, &max);
    cli_say("%s: %zu spheres, %zu ellipsoids; %.3g x %.3g x %.3g m; %llu symbols by %d iterations",
            set->clouds[0].name, list->sphere_count, list->ellipsoid_count, max.x - min.x, max.y - min.y,
            max.z - min.z, (unsigned long long)counts->symbols, options->iterations);
}

shape_set *cli_lsys_make(const shape_grammar *grammar, const shape_derive_options *options, const char *path)
{
    const char *shown = strcmp(path, "-") ? path : "standard input";
    shape_error error;
    shape_derive_counts counts;
    char name[SHAPE_NAME_MAX + 1];
    shape_set *set = shape_set_create(&error);
    if (!set)
        cli_fail("%s", error.text);
    cli_bare_name(path, "grammar", name);
    cli_check(shape_set_add_cloud(set, name, NULL, &error), &error);
    cli_check(shape_grammar_grow(grammar, options, shape_set_list(set, 0), &counts, &error), &error);
    if (!counts.primitives)
        cli_fail("%s: the derived string sets no puff (write an upper-case letter other than G into it, or "
                 "name its "
                 "letters by \"puffs\")",
                 shown);
    shape_cloud *cloud = &set->clouds[0];
    cloud->field = shape_grammar_get_settings(grammar)->field;
    cloud->medium = shape_grammar_get_settings(grammar)->medium;
    cloud->seed = cloud->field.seed = options->seed;
    cli_made_by(cloud->made_by);
    cli_medium_apply(cloud);
    cli_check(shape_cloud_choose_noise_scale(cloud, shape_set_list(set, 0), &error), &error);
    summarize(set, options, &counts);
    return set;
}

static shape_set *make(const char *input, uint64_t seed)
{
    shape_grammar *grammar = cli_lsys_read(input);
    shape_derive_options options = cli_lsys_options(grammar, seed);
    shape_set *set = cli_lsys_make(grammar, &options, input);
    shape_grammar_destroy(grammar);
    return set;
}

static const cli_group groups[] = {
    {"Derivation", derivation_options}, {"Medium and frame", cli_medium_options}, {0}};

const cli_generator cli_lsys = {"neph-lsys", "GRAMMAR", groups, make};
