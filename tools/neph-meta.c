/* neph-meta: metaball cumuli, a few balls that flow into one another (Jiménez 2018 section 3.6.3). */
#include <string.h>

#include "cli.h"
#include "shape/metaball.h"

static struct {
    int64_t count;
    double sigma[3], min_radius, max_radius;
    bool min_radius_given;
} values = {.count = 6, .sigma = {3.6, 1.5, 2.8}, .min_radius = 1.25, .max_radius = 2.5};

static const cli_option shape_options[] = {
    {"count", 0, CLI_INTEGER, &values.count, 1, 100000, "N", "balls [6]", NULL, false},
    {"sigma", 0, CLI_VECTOR, &values.sigma, 0, 1e6, "X,Y,Z",
     "standard deviations of their places, metres; y from 0 up [3.6,1.5,2.8]", NULL, false},
    {"max-radius", 0, CLI_NUMBER, &values.max_radius, 1e-6, 1e6, "R", "largest radius, metres [2.5]", NULL,
     false},
    {"min-radius", 0, CLI_NUMBER, &values.min_radius, 1e-6, 1e6, "R",
     "smallest radius, metres [half the largest]", &values.min_radius_given, false},
    {0}};

static cli_option medium_options[64];

static const cli_group groups[] = {{"Shape", shape_options}, {"Medium and frame", medium_options}, {0}};

static const cli_program program = {.name = "neph-meta",
                                    .arguments = "",
                                    .about = "Makes a metaball cumulus: balls of random radius at normally "
                                             "distributed places over a flat base, which\n"
                                             "their common field joins into one body.",
                                    .examples =
                                        "  neph-meta -o puff.neph\n"
                                        "  neph-meta --count 12 --sigma 6,2,3 --seed 4 | neph-view -\n"
                                        "  neph-meta --edge 2 --extinction 4 -o dense.neph\n",
                                    .min_arguments = 0,
                                    .max_arguments = 0,
                                    .groups = groups};

/* The medium's options with this program's own default for the model in their help. */
static void prepare_medium_options(void)
{
    for (size_t i = 0; cli_medium_options[i].name && i + 1 < sizeof medium_options / sizeof *medium_options;
         i++) {
        medium_options[i] = cli_medium_options[i];
        if (!strcmp(medium_options[i].name, "model"))
            medium_options[i].help = "density model [metaball]";
    }
}

static shape_metaball options_in_force(void)
{
    shape_metaball options = shape_metaball_defaults();
    double share = options.min_radius / options.max_radius;
    options.count = (size_t)values.count;
    for (int i = 0; i < 3; i++)
        options.sigma[i] = values.sigma[i];
    options.max_radius = values.max_radius;
    options.min_radius = values.min_radius_given ? values.min_radius : share * values.max_radius;
    if (options.min_radius < 1e-6)
        options.min_radius = options.max_radius;
    return options;
}

int main(int argc, char **argv)
{
    cli_common common;
    prepare_medium_options();
    cli_parse(&program, argc, argv, &common);
    shape_metaball options = options_in_force();
    if (options.min_radius > options.max_radius)
        cli_wrong("--min-radius %g is above --max-radius %g", options.min_radius, options.max_radius);
    shape_error error;
    size_t index;
    shape_set *set = shape_set_create(&error);
    if (!set)
        cli_fail("%s", error.text);
    cli_check(shape_set_add_cloud(set, "metaballs", &index, &error), &error);
    cli_check(shape_metaball_make(&options, common.seed, shape_set_list(set, index), &error), &error);
    shape_cloud *cloud = &set->clouds[index];
    cloud->seed = cloud->field.seed = common.seed;
    cloud->field.model = SHAPE_MODEL_METABALL;
    cli_made_by(cloud->made_by);
    cli_medium_apply(cloud);
    cli_check(shape_cloud_choose_noise_scale(cloud, shape_set_list(set, index), &error), &error);
    cli_say("%zu balls", shape_primitives_count(shape_set_list(set, index)));
    cli_write_set(&common, set);
    shape_set_destroy(set);
    return cli_finish(&common);
}
