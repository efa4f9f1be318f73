/* The options of neph-gauss and the cloud that they make, for the program and for scenes. */
#include <math.h>
#include <stdlib.h>

#include "cli_generator.h"
#include "shape/gaussian.h"
#include "shape/scatter.h"

static struct {
    int64_t count, field;
    double mean[3], sigma[3], clamp, max_radius, area[2];
    int clamp_mode, radius_law, preset;
    bool no_hollow, no_prune;
    bool count_given, sigma_given, clamp_given, clamp_mode_given, radius_law_given, max_radius_given,
        preset_given, field_given, area_given;
} values = {.count = 35,
            .field = 1,
            .sigma = {3.8, 1.7, 3.7},
            .clamp = 2,
            .max_radius = 2.9,
            .clamp_mode = SHAPE_CLAMP_EDGE,
            .radius_law = SHAPE_RADIUS_GAUSSIAN};

static const cli_option shape_options[] = {
    {"count", 0, CLI_INTEGER, &values.count, 1, SHAPE_GAUSSIAN_MAX_COUNT, "N",
     "spheres drawn, before any is removed [35]", &values.count_given, false},
    {"mean", 0, CLI_VECTOR, &values.mean, -1e6, 1e6, "X,Y,Z",
     "centre and base in the cloud's frame, metres [0,0,0]", NULL, false},
    {"sigma", 0, CLI_VECTOR, &values.sigma, 0, 1e6, "X,Y,Z",
     "standard deviations, metres; 0: no spread [3.8,1.7,3.7]", &values.sigma_given, false},
    {"clamp", 0, CLI_NUMBER, &values.clamp, 0.01, 10, "K", "keep x, z to +-K sigma and y to 0..K sigma [2]",
     &values.clamp_given, false},
    {"clamp-mode", 0, CLI_CHOICE, &values.clamp_mode, 0, 0, "edge|reject",
     "what lies outside moves to the edge, or is drawn anew [edge]", &values.clamp_mode_given, false},
    {"radius-law", 0, CLI_CHOICE, &values.radius_law, 0, 0, "inverse|gaussian",
     "radius by Eq. 15 or Eq. 16 of the paper [gaussian]", &values.radius_law_given, false},
    {"max-radius", 0, CLI_NUMBER, &values.max_radius, 1e-6, 1e6, "R", "radius at the centre, metres [2.9]",
     &values.max_radius_given, false},
    {"no-hollow", 0, CLI_FLAG, &values.no_hollow, 0, 0, NULL, "keep the spheres of the core", NULL, false},
    {"no-prune", 0, CLI_FLAG, &values.no_prune, 0, 0, NULL, "keep spheres that lie inside others", NULL,
     false},
    {"preset", 0, CLI_CHOICE, &values.preset, 0, 0, "humilis|mediocris|congestus",
     "count, sigma and largest radius of a species, where not given [none]", &values.preset_given, false},
    {"field", 0, CLI_INTEGER, &values.field, 1, 10000, "N", "a sky of N clouds, each with its own draws [1]",
     &values.field_given, false},
    {"area", 0, CLI_PAIR, &values.area, 1e-3, 1e9, "W,D",
     "where their centres may stand, along x and z, metres [a square, 8 sigma a cloud]", &values.area_given,
     false},
    {0}};

static const char *const species_names[] = {"humilis", "mediocris", "congestus"};

/* The options in force: a preset's, under what was given. */
static shape_gaussian options_in_force(void)
{
    shape_gaussian options = values.preset_given ? shape_gaussian_species((shape_species)values.preset)
                                                 : shape_gaussian_defaults();
    if (values.count_given)
        options.count = (size_t)values.count;
    for (int i = 0; i < 3; i++) {
        options.mean[i] = values.mean[i];
        if (values.sigma_given)
            options.sigma[i] = values.sigma[i];
    }
    if (values.clamp_given)
        options.clamp = values.clamp;
    if (values.clamp_mode_given)
        options.clamp_mode = (shape_clamp_mode)values.clamp_mode;
    if (values.radius_law_given)
        options.radius_law = (shape_radius_law)values.radius_law;
    if (values.max_radius_given)
        options.max_radius = values.max_radius;
    options.hollow = !values.no_hollow;
    options.prune = !values.no_prune;
    return options;
}

static void add_cloud(shape_set *set, const shape_gaussian *options, uint64_t seed, const shape_point2 *place,
                      const char *made_by, shape_gaussian_report *sum)
{
    shape_error error;
    shape_gaussian_report report;
    size_t index;
    cli_check(shape_set_add_cloud(set, values.preset_given ? species_names[values.preset] : "cumulus", &index,
                                  &error),
              &error);
    cli_check(shape_gaussian_make(options, seed, shape_set_list(set, index), &report, &error), &error);
    shape_cloud *cloud = &set->clouds[index];
    cloud->seed = cloud->field.seed = seed;
    cloud->frame.m[0][3] = place->x;
    cloud->frame.m[2][3] = place->z;
    for (size_t i = 0; i <= SHAPE_MADE_BY_MAX; i++)
        cloud->made_by[i] = made_by[i];
    cli_medium_apply(cloud);
    cli_check(shape_cloud_choose_noise_scale(cloud, shape_set_list(set, index), &error), &error);
    sum->drawn += report.drawn;
    sum->hollowed += report.hollowed;
    sum->pruned += report.pruned;
}

/* Where the clouds stand; the caller frees the array. */
static shape_point2 *choose_places(const shape_gaussian *options, size_t count, uint64_t seed)
{
    double side =
        8 * fmax(fmax(options->sigma[0], options->sigma[2]), options->max_radius / 2) * sqrt((double)count);
    double width = values.area_given ? values.area[0] : side,
           depth = values.area_given ? values.area[1] : side;
    shape_point2 *places = malloc(count * sizeof *places);
    if (!places)
        cli_fail("not enough memory");
    double spacing;
    shape_error error;
    cli_check(shape_scatter(count, width, depth, seed, places, &spacing, &error), &error);
    if (count > 1)
        cli_say("%zu clouds on %g by %g m, no two centres nearer than %.4g m", count, width, depth, spacing);
    return places;
}

static void report(const shape_gaussian *options, const shape_gaussian_report *sum)
{
    double percent = 100 / (double)sum->drawn;
    cli_say("%zu spheres of %zu drawn; hollowing removed %zu (%.1f %%)%s, pruning %zu (%.1f %%)%s",
            sum->drawn - sum->hollowed - sum->pruned, sum->drawn, sum->hollowed,
            percent * (double)sum->hollowed, options->hollow ? "" : " - off", sum->pruned,
            percent * (double)sum->pruned, options->prune ? "" : " - off");
    if (sum->pruned && cli_medium_values.model == SHAPE_MODEL_METABALL)
        cli_say("note: the field of metaballs is a sum over all of them, so pruning made it thinner "
                "(--no-prune)");
}

static shape_set *make(const char *input, uint64_t seed)
{
    (void)input;
    if (values.area_given && !values.field_given)
        cli_wrong("--area says where the clouds of a --field stand (give --field N too)");
    shape_gaussian options = options_in_force();
    size_t clouds = (size_t)values.field;
    if (clouds * options.count > cli_generator_limit(100000000))
        cli_wrong("--field %zu with --count %zu is more than %zu spheres (make fewer)", clouds, options.count,
                  cli_generator_limit(100000000));
    shape_error error;
    shape_set *set = shape_set_create(&error);
    if (!set)
        cli_fail("%s", error.text);
    shape_point2 *places = choose_places(&options, clouds, seed);
    char made_by[SHAPE_MADE_BY_MAX + 1] = "";
    cli_made_by(made_by);
    shape_gaussian_report sum = {0};
    for (size_t i = 0; i < clouds; i++) {
        cli_progress("making clouds", (double)i / (double)clouds);
        add_cloud(set, &options, shape_field_seed(seed, i), &places[i], made_by, &sum);
    }
    cli_progress("making clouds", 1);
    report(&options, &sum);
    free(places);
    return set;
}

static const cli_group groups[] = {{"Shape", shape_options}, {"Medium and frame", cli_medium_options}, {0}};

const cli_generator cli_gauss = {"neph-gauss", NULL, groups, make};
