/* The options of --method march: rules, steps, light. Each choice has its formula and its source in docs/light.md. */
#include "render_march.h"

#include <math.h>

static struct march_values {
    int rule, stepping, jitter, end, light, shadow;
    int64_t steps, light_steps, resolution, octaves;
    double growth, pixels, powder, shade, forward, emission[3], ambient[3], lock, cutoff, alpha_power,
        alpha_peel;
    bool silver;
    bool any_given, steps_given, growth_given, pixels_given, end_given, shadow_given, light_steps_given,
        resolution_given, powder_given, octaves_given, shade_given, forward_given;
} values = {.rule = SHAPE_RULE_EXPONENTIAL,
            .light = SHAPE_MARCH_GRID,
            .steps = 100,
            .light_steps = 50,
            .resolution = 48,
            .growth = 1.02,
            .pixels = 4,
            .powder = 2,
            .octaves = SHAPE_MARCH_OCTAVES_MAX,
            .shade = 1,
            .forward = 0.5,
            .cutoff = 1e-8,
            .alpha_power = 1};

const cli_option render_march_options[] = {
    {"rule", 0, CLI_CHOICE, &values.rule, 0, 0,
     "riemann-left|riemann-right|trapezoid|simpson|simpson38|exponential",
     "rule of integration along a ray [exponential]", &values.any_given, false},
    {"step", 0, CLI_CHOICE, &values.stepping, 0, 0, "fixed|geometric|exponential",
     "steps: alike; each --growth times the last; as long as --step-pixels wide [fixed]", &values.any_given,
     false},
    {"steps", 0, CLI_INTEGER, &values.steps, 1, 100000, "N",
     "steps along the longest side of all clouds; geometric: sets the first [100]", &values.steps_given,
     false},
    {"growth", 0, CLI_NUMBER, &values.growth, 1, 2, "Q",
     "of geometric steps, within an interval of density [1.02]", &values.growth_given, false},
    {"step-pixels", 0, CLI_NUMBER, &values.pixels, 0.01, 1000, "P",
     "exponential steps: length in widths of a pixel there [4]", &values.pixels_given, false},
    {"step-end", 0, CLI_CHOICE, &values.end, 0, 0, "cut|adapt",
     "before a mesh: the last step is cut, or all are made to fit [cut]", &values.end_given, false},
    {"jitter", 0, CLI_CHOICE, &values.jitter, 0, 0, "none|hash|blue",
     "a pixel's steps begin later by chance: white or blue noise [none]", &values.any_given, false},
    {"light", 0, CLI_CHOICE, &values.light, 0, 0,
     "single|powder|powder-angle|beer-max|harris|two-pass|octaves|grid",
     "how a point is lit; docs/light.md has each formula [grid]", &values.any_given, false},
    {"shadow", 0, CLI_CHOICE, &values.shadow, 0, 0, "march|cone|grid",
     "depth to the sun or lamp: straight steps, steps astray, a grid made before [march]",
     &values.shadow_given, false},
    {"light-steps", 0, CLI_INTEGER, &values.light_steps, 1, 100000, "N",
     "the same as --steps for the way to the sun or lamp [50]", &values.light_steps_given, false},
    {"light-resolution", 0, CLI_INTEGER, &values.resolution, 2, 256, "N",
     "cells of a light grid's longest side [48; paper 40]", &values.resolution_given, false},
    {"powder", 0, CLI_NUMBER, &values.powder, 0, 1000, "K", "of the powder lights, 1 - exp(-K depth) [2]",
     &values.powder_given, false},
    {"light-octaves", 0, CLI_INTEGER, &values.octaves, 1, SHAPE_MARCH_OCTAVES_MAX, "N",
     "--light octaves: copies that are summed [8]", &values.octaves_given, false},
    {"shade", 0, CLI_NUMBER, &values.shade, 0, 1, "S", "multiplies depths to the sun [1]",
     &values.shade_given, false},
    {"forward", 0, CLI_NUMBER, &values.forward, 0, 1, "F",
     "--light harris: share that is scattered on ahead [0.5]", &values.forward_given, false},
    {"emission", 0, CLI_VECTOR, values.emission, 0, 1e9, "R,G,B",
     "density 1 glows with that radiance a metre [0,0,0]", &values.any_given, false},
    {"ambient", 0, CLI_VECTOR, values.ambient, 0, 1e9, "R,G,B",
     "radiance that reaches every point of a cloud alike from all round [0,0,0]", &values.any_given, false},
    {"silver", 0, CLI_FLAG, &values.silver, 0, 0, NULL,
     "phase with g = 1 - opacity of a step: bright thin rims [off]", &values.any_given, false},
    {"lock", 0, CLI_NUMBER, &values.lock, 0, 1e9, "F",
     "ray starts go to a grid of F points a metre; 0: they stay [0]", &values.any_given, false},
    {"cutoff", 0, CLI_NUMBER, &values.cutoff, 1e-12, 0.1, "T",
     "rays, and ways to the sun, end where less than T gets through [1e-8]", &values.any_given, false},
    {"alpha-power", 0, CLI_NUMBER, &values.alpha_power, 0.01, 100, "K",
     "coverage is raised to that power [1]", &values.any_given, false},
    {"alpha-peel", 0, CLI_NUMBER, &values.alpha_peel, 0, 1, "A", "pixels covered less show no cloud [0]",
     &values.any_given, false},
    {0}};

bool render_march_given(void)
{
    const struct march_values *v = &values;
    return v->any_given || v->steps_given || v->growth_given || v->pixels_given || v->end_given ||
           v->shadow_given || v->light_steps_given || v->powder_given || v->octaves_given || v->shade_given ||
           v->forward_given;
}

bool render_march_resolution(int *cells)
{
    if (values.resolution_given)
        *cells = (int)values.resolution;
    return values.resolution_given;
}

static bool asks_depth(int light)
{
    return light != SHAPE_MARCH_GRID && light != SHAPE_MARCH_TWO_PASS && light != SHAPE_MARCH_HARRIS;
}

static void check_light(bool has_things)
{
    const struct march_values *v = &values;
    bool depth = asks_depth(v->light),
         grid = depth ? v->shadow == SHAPE_SHADOW_GRID : v->light != SHAPE_MARCH_HARRIS;
    if (v->shadow_given && !depth)
        cli_wrong("--shadow goes with --light single, powder, powder-angle, beer-max and octaves");
    if (v->resolution_given && !grid)
        cli_wrong("--light-resolution goes with --light grid, two-pass or --shadow grid");
    if (v->light_steps_given && !has_things &&
        (v->light == SHAPE_MARCH_GRID || (depth && v->shadow == SHAPE_SHADOW_GRID)))
        cli_wrong("--light-steps: grids of light choose their own (set --light-resolution)");
    if (v->powder_given && v->light != SHAPE_MARCH_POWDER && v->light != SHAPE_MARCH_POWDER_ANGLE)
        cli_wrong("--powder goes with --light powder and powder-angle");
    if (v->octaves_given && v->light != SHAPE_MARCH_OCTAVES)
        cli_wrong("--light-octaves goes with --light octaves");
    if (v->shade_given && !depth && v->light != SHAPE_MARCH_HARRIS)
        cli_wrong("--shade goes with lights of a depth (not --light grid or two-pass)");
    if (v->forward_given && v->light != SHAPE_MARCH_HARRIS)
        cli_wrong("--forward goes with --light harris");
    if (v->silver && (v->light == SHAPE_MARCH_GRID || v->light == SHAPE_MARCH_OCTAVES))
        cli_wrong("--silver: --light grid and octaves have a phase function of their own (choose another)");
}

void render_march_check(bool has_things)
{
    const struct march_values *v = &values;
    if (v->growth_given && v->stepping != SHAPE_STEP_GEOMETRIC)
        cli_wrong("--growth goes with --step geometric");
    if (v->pixels_given && v->stepping != SHAPE_STEP_EXPONENTIAL)
        cli_wrong("--step-pixels goes with --step exponential");
    if (v->end_given && !has_things)
        cli_wrong("--step-end has no meaning without --mesh or a scene with meshes");
    if (v->light == SHAPE_MARCH_HARRIS && cli_given("colour-grid"))
        cli_wrong("--colour-grid: --light harris has no colours (choose another)");
    check_light(has_things);
}

bool render_march_takes_lamp(void)
{
    return shape_march_takes_lamp((shape_march_light)values.light, (shape_march_shadow)values.shadow);
}

shape_march_options render_march_make(double side, const shape_view *view)
{
    const struct march_values *v = &values;
    shape_march_options options = shape_march_defaults();
    options.rule = (shape_rule)v->rule;
    options.stepping = (shape_march_stepping)v->stepping;
    options.jitter = (shape_march_jitter)v->jitter;
    options.end = (shape_march_end)v->end;
    options.light = (shape_march_light)v->light;
    options.shadow = (shape_march_shadow)v->shadow;
    options.step = side / (double)v->steps;
    options.light_step = side / (double)v->light_steps;
    options.resolution = (int)v->resolution;
    options.growth = v->growth;
    options.share = fmin(v->pixels * 2 * tan(view->fov * 3.14159265358979 / 360) / view->height, 1);
    options.powder = v->powder;
    options.shade = v->shade;
    options.octaves = (int)v->octaves;
    options.forward = v->forward;
    for (int c = 0; c < 3; c++) {
        options.emission[c] = (float)v->emission[c];
        options.ambient[c] = (float)v->ambient[c];
    }
    options.silver = v->silver;
    options.lock = v->lock;
    options.cutoff = v->cutoff;
    options.alpha_power = v->alpha_power;
    options.alpha_peel = v->alpha_peel;
    return options;
}
