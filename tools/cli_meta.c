/* The options of neph-meta and the cloud that they make, for the program and for scenes. */
#include "cli_generator.h"
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

static shape_set *make(const char *input, uint64_t seed)
{
    (void)input;
    shape_metaball options = options_in_force();
    if (options.min_radius > options.max_radius)
        cli_wrong("--min-radius %g is above --max-radius %g", options.min_radius, options.max_radius);
    shape_error error;
    size_t index;
    shape_set *set = shape_set_create(&error);
    if (!set)
        cli_fail("%s", error.text);
    cli_check(shape_set_add_cloud(set, "metaballs", &index, &error), &error);
    cli_check(shape_metaball_make(&options, seed, shape_set_list(set, index), &error), &error);
    shape_cloud *cloud = &set->clouds[index];
    cloud->seed = cloud->field.seed = seed;
    cloud->field.model = SHAPE_MODEL_METABALL;
    cli_made_by(cloud->made_by);
    cli_medium_apply(cloud);
    cli_check(shape_cloud_choose_noise_scale(cloud, shape_set_list(set, index), &error), &error);
    cli_say("%zu balls", shape_primitives_count(shape_set_list(set, index)));
    return set;
}

static const cli_group groups[] = {{"Shape", shape_options}, {"Medium and frame", cli_medium_options}, {0}};

const cli_generator cli_meta = {"neph-meta", NULL, groups, make};
