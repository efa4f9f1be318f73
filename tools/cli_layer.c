/* The options of neph-layer and the cloud that they make, for the program and for scenes. */
#include "cli_generator.h"
#include "shape/layer.h"

static struct {
    int preset, bounds, noise;
    double extent[3], altitudes[2], planet_radius;
    double frequency, stretch[3], blend, gain, worley_gain, worley_frequency;
    int64_t worley_octaves;
    double coverage, cut, ramp[2], falloff, fade_bottom, fade_top, fade_side;
} values =
    {/* what is not given is not looked at here; a panel begins with it (shape_layer_options_defaults) */
     .preset = -1,
     .noise = SHAPE_NOISE_PERLIN_WORLEY,
     .extent = {20, 6, 20},
     .altitudes = {0, 6},
     .stretch = {1, 1, 1},
     .blend = 0.5,
     .gain = 1,
     .worley_gain = 1,
     .worley_frequency = 1,
     .worley_octaves = 3,
     .coverage = 0.5,
     .ramp = {0.45, 0.65}};

static struct {
    bool preset, bounds, noise, extent, altitudes, planet_radius, frequency, stretch, blend, gain,
        worley_gain, worley_frequency, worley_octaves, coverage, cut, ramp, falloff, fade_bottom, fade_top,
        fade_side;
} given;

#define ROW(name) &values.name
#define GIVEN(name) &given.name, false

static const cli_option bounds_options[] = {
    {"preset", 0, CLI_CHOICE, ROW(preset), 0, 0, "stratus|stratocumulus|fog",
     "start from a kind of cloud; other options change it [none]", GIVEN(preset)},
    {"bounds", 0, CLI_CHOICE, ROW(bounds), 0, 0, "box|sphere|altitudes", "what the noise is bounded by [box]",
     GIVEN(bounds)},
    {"extent", 0, CLI_VECTOR, ROW(extent), 1e-3, 1e8, "X,Y,Z",
     "full size, metres; it stands on y = 0 [20,6,20]", GIVEN(extent)},
    {"altitudes", 0, CLI_PAIR, ROW(altitudes), -1e8, 1e8, "LOW,HIGH",
     "its lowest and highest y, metres; overrides the Y of --extent [0,6]", GIVEN(altitudes)},
    {"planet-radius", 0, CLI_NUMBER, ROW(planet_radius), 0, 1e8, "R",
     "with --bounds altitudes: a shell of a planet whose surface is at y = 0, metres; 0: flat [0]",
     GIVEN(planet_radius)},
    {"falloff", 0, CLI_NUMBER, ROW(falloff), 0, 1, "F",
     "thin out from the centre: share of the radius, 0 to 1; it never touches the walls [0]", GIVEN(falloff)},
    {"fade-bottom", 0, CLI_NUMBER, ROW(fade_bottom), 0, 1, "F",
     "thin out at the base: share of the thickness [0]", GIVEN(fade_bottom)},
    {"fade-top", 0, CLI_NUMBER, ROW(fade_top), 0, 1, "F", "thin out at the top: share of the thickness [0]",
     GIVEN(fade_top)},
    {"fade-side", 0, CLI_NUMBER, ROW(fade_side), 0, 1, "F",
     "thin out at the sides: share of the half width [0]", GIVEN(fade_side)},
    {0}};

static const cli_option noise_options[] = {
    {"noise", 0, CLI_CHOICE, ROW(noise), 0, 0, "lattice|perlin|worley|perlin-worley",
     "which noise [perlin-worley]", GIVEN(noise)},
    {"frequency", 0, CLI_NUMBER, ROW(frequency), 1e-9, 1e9, "F",
     "cells a metre: 1 / --noise-scale [by the size]", GIVEN(frequency)},
    {"stretch", 0, CLI_VECTOR, ROW(stretch), 1e-3, 1e3, "X,Y,Z",
     "proportions of a cell; 1,1,3: rolls along z [1,1,1]", GIVEN(stretch)},
    {"gain", 0, CLI_NUMBER, ROW(gain), 0, 100, "G",
     "contrast of lattice or Perlin noise about its middle [1]", GIVEN(gain)},
    {"blend", 0, CLI_NUMBER, ROW(blend), 0, 1, "B", "perlin-worley: share of Perlin, 0 to 1 [0.5]",
     GIVEN(blend)},
    {"worley-gain", 0, CLI_NUMBER, ROW(worley_gain), 0, 100, "G", "contrast of Worley noise [1]",
     GIVEN(worley_gain)},
    {"worley-frequency", 0, CLI_NUMBER, ROW(worley_frequency), 1e-3, 1e3, "F",
     "Worley cells a noise cell [1]", GIVEN(worley_frequency)},
    {"worley-octaves", 0, CLI_INTEGER, ROW(worley_octaves), 1, 8, "N", "octaves of Worley noise, 1 to 8 [3]",
     GIVEN(worley_octaves)},
    {"coverage", 0, CLI_NUMBER, ROW(coverage), 0, 1, "C",
     "0: nothing, 0.5: the noise as it is, 1: full [0.5]", GIVEN(coverage)},
    {"cut", 0, CLI_NUMBER, ROW(cut), 0, 0.999, "C",
     "noise up to here is nothing, the rest is stretched, 0 to 0.999 [0]", GIVEN(cut)},
    {"ramp", 0, CLI_PAIR, ROW(ramp), 0, 1, "A,B",
     "no density up to A, all from B on, smooth between [0.45,0.65]", GIVEN(ramp)},
    {0}};

static void set_float(bool is_given, double value, float *to)
{
    if (is_given)
        *to = (float)value;
}

static void apply_noise(shape_layer *l)
{
    if (given.noise)
        l->noise = (shape_noise_kind)values.noise;
    for (int i = 0; i < 3; i++)
        set_float(given.stretch, values.stretch[i], &l->stretch[i]);
    set_float(given.gain, values.gain, &l->gain);
    set_float(given.blend, values.blend, &l->blend);
    set_float(given.worley_gain, values.worley_gain, &l->worley_gain);
    set_float(given.worley_frequency, values.worley_frequency, &l->worley_frequency);
    if (given.worley_octaves)
        l->worley_octaves = (int)values.worley_octaves;
    set_float(given.coverage, values.coverage, &l->coverage);
    set_float(given.cut, values.cut, &l->cut);
    for (int i = 0; i < 2; i++)
        set_float(given.ramp, values.ramp[i], &l->ramp[i]);
}

static void apply_bounds(shape_layer_options *options)
{
    static const shape_bounds kinds[] = {SHAPE_BOUNDS_BOX, SHAPE_BOUNDS_SPHERE, SHAPE_BOUNDS_ALTITUDES};
    shape_layer *l = &options->layer;
    if (given.bounds)
        l->bounds = kinds[values.bounds];
    for (int i = 0; i < 3 && given.extent; i++)
        options->extent[i] = values.extent[i];
    if (given.altitudes) {
        options->base = values.altitudes[0];
        options->extent[1] = values.altitudes[1] - values.altitudes[0];
    }
    options->planet_radius = values.planet_radius;
    set_float(given.falloff, values.falloff, &l->falloff);
    set_float(given.fade_bottom, values.fade_bottom, &l->fade_bottom);
    set_float(given.fade_top, values.fade_top, &l->fade_top);
    set_float(given.fade_side, values.fade_side, &l->fade_side);
}

static void refuse_nonsense(const shape_layer *l)
{
    bool worley = l->noise == SHAPE_NOISE_WORLEY || l->noise == SHAPE_NOISE_PERLIN_WORLEY;
    if (given.altitudes && values.altitudes[1] - values.altitudes[0] < 1e-3)
        cli_wrong("--altitudes %g,%g: the second must be the higher one (by a millimetre or more)",
                  values.altitudes[0], values.altitudes[1]);
    if (given.ramp && values.ramp[0] > values.ramp[1])
        cli_wrong("--ramp %g,%g runs backwards (give the lower threshold first)", values.ramp[0],
                  values.ramp[1]);
    if (given.frequency && cli_medium_values.noise_scale_given)
        cli_wrong("--frequency and --noise-scale say the same (give one of them)");
    if (values.planet_radius > 0 && l->bounds != SHAPE_BOUNDS_ALTITUDES)
        cli_wrong("--planet-radius needs --bounds altitudes");
    if (given.blend && l->noise != SHAPE_NOISE_PERLIN_WORLEY)
        cli_wrong("--blend needs --noise perlin-worley");
    if ((given.worley_gain || given.worley_frequency || given.worley_octaves) && !worley)
        cli_wrong(
            "--worley-gain, --worley-frequency and --worley-octaves need --noise worley or perlin-worley");
    if (given.gain && l->noise == SHAPE_NOISE_WORLEY)
        cli_wrong("--gain is of lattice and Perlin noise (use --worley-gain)");
}

static shape_layer_options options_in_force(void)
{
    static const shape_layer_preset presets[] = {SHAPE_LAYER_STRATUS, SHAPE_LAYER_STRATOCUMULUS,
                                                 SHAPE_LAYER_FOG};
    shape_layer_options options =
        given.preset ? shape_layer_options_preset(presets[values.preset]) : shape_layer_options_defaults();
    apply_bounds(&options);
    apply_noise(&options.layer);
    refuse_nonsense(&options.layer);
    if (given.frequency)
        options.noise_scale = 1 / values.frequency;
    return options;
}

static shape_set *make(const char *input, uint64_t seed)
{
    static const char *const names[] = {"stratus", "stratocumulus", "fog"};
    (void)input;
    shape_layer_options options = options_in_force();
    shape_error error;
    size_t index;
    shape_set *set = shape_set_create(&error);
    if (!set)
        cli_fail("%s", error.text);
    cli_check(shape_set_add_cloud(set, given.preset ? names[values.preset] : "layer", &index, &error),
              &error);
    shape_cloud *cloud = &set->clouds[index];
    cli_check(shape_layer_make(&options, cloud, shape_set_list(set, index), &error), &error);
    cloud->seed = cloud->field.seed = seed;
    cli_made_by(cloud->made_by);
    cli_medium_apply(cloud);
    cli_say("%g x %g x %g m, noise cells of %g m", options.extent[0], options.extent[1], options.extent[2],
            (double)cloud->field.noise_scale);
    return set;
}

static const cli_group groups[] = {
    {"Bounds", bounds_options}, {"Noise", noise_options}, {"Medium and frame", cli_medium_options}, {0}};

const cli_generator cli_layer = {"neph-layer", NULL, groups, make};
