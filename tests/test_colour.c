/* The colour of a grid's scattering: a constant colour is an albedo of that value, channel by channel, and two halves of
 * different colour scatter each its own; in the reference and in the march. Comparisons by chance allow five standard
 * errors; seeds are fixed. */
#include "grid_sample.h"

#include "shape/march.h"

static double constant(const void *context, int x, int y, int z)
{
    (void)x, (void)y, (void)z;
    return *(const double *)context;
}

/* 1 in the half of small x or of large x. */
static double half(const void *context, int x, int y, int z)
{
    (void)y, (void)z;
    return (x < 20) == *(const bool *)context;
}

typedef struct coloured {
    shape_set *set;
    shape_volume *volume;
} coloured;

/* Bumps of half a metre a voxel, with a medium of that albedo and three channels, which the set takes over; NULL: grey. */
static coloured make(float albedo, shape_grid *const colour[3])
{
    shape_grid *grid = grid_of(bumps, NULL, 41, 33, 37);
    for (int c = 0; c < 3 && colour; c++)
        grid->colour[c] = colour[c];
    grid->coloured = colour != NULL;
    coloured made = {grid_set(grid, 0.5, shape_dvec3_make(0, 0, 0)), NULL};
    made.set->clouds[0].medium.extinction = 0.8f;
    made.set->clouds[0].medium.albedo = albedo;
    made.set->clouds[0].medium.g = 0.3f;
    made.volume = new_volume(made.set);
    return made;
}

static coloured make_constant(float albedo, const double rgb[3])
{
    shape_grid *colour[3];
    for (int c = 0; c < 3; c++)
        colour[c] = rgb[c] > 0 ? grid_of(constant, &rgb[c], 41, 33, 37) : NULL;
    return make(albedo, colour);
}

static coloured make_halves(void)
{
    static const bool left = true, right = false;
    shape_grid *colour[3] = {grid_of(half, &left, 41, 33, 37), NULL, grid_of(half, &right, 41, 33, 37)};
    return make(1, colour);
}

static void drop(coloured *made)
{
    shape_volume_destroy(made->volume);
    shape_set_destroy(made->set);
}

static shape_light lit(float sky)
{
    shape_light light = shape_light_defaults();
    light.sky = SHAPE_SKY_CONSTANT;
    light.sky_radiance[0] = light.sky_radiance[1] = light.sky_radiance[2] = sky;
    return light;
}

/* Straight through the cloud, at x and y, along z. */
static const shape_dvec3 forward = {0, 0, 1};
static shape_dvec3 eye_at(double x, double y)
{
    return shape_dvec3_make(x, y, -3);
}

static void march(const coloured *made, shape_march_light how, const shape_light *light, shape_dvec3 eye,
                  double rgb[3])
{
    shape_error error;
    shape_marcher *marcher;
    shape_march_scratch scratch;
    shape_march_options options = shape_march_defaults();
    memset(&scratch, 0, sizeof scratch);
    options.light = how;
    options.step = options.light_step = 0.1;
    options.resolution = 20;
    must(shape_marcher_create(made->volume, light, eye, &options, &marcher, &error), &error);
    must(shape_march_radiance(marcher, eye, forward, 0, &scratch, rgb, &error), &error);
    shape_march_scratch_free(&scratch);
    shape_marcher_destroy(marcher);
}

static void trace(const coloured *made, int bounces, int paths, const shape_light *light, shape_dvec3 eye,
                  double mean[3], double deviation[3])
{
    shape_error error;
    shape_tracer *tracer;
    shape_random random = shape_random_seed(3, 0);
    shape_pathtrace_options options = shape_pathtrace_defaults();
    double sum[3] = {0}, squares[3] = {0}, rgb[3], n = paths;
    options.max_bounces = bounces;
    options.sun_angle = 0;
    must(shape_tracer_create(made->volume, &tracer, &error), &error);
    for (int i = 0; i < paths; i++) {
        shape_pathtrace_radiance(tracer, light, &options, eye, forward, &random, rgb);
        for (int c = 0; c < 3; c++) {
            sum[c] += rgb[c];
            squares[c] += rgb[c] * rgb[c];
        }
    }
    for (int c = 0; c < 3; c++) {
        mean[c] = sum[c] / n;
        deviation[c] = sqrt((squares[c] / n - mean[c] * mean[c]) / n);
    }
    shape_tracer_destroy(tracer);
}

static const double some_rgb[3] = {0.25, 1, 0};

/* Every light of the march but Harris' is the same sum for either; to single precision, and for the light grid to where its
 * iteration stops, 0.003 of the largest. */
static void a_constant_colour_is_an_albedo_in_the_march(void **state)
{
    (void)state;
    static const shape_march_light lights[] = {SHAPE_MARCH_SINGLE,   SHAPE_MARCH_POWDER,
                                               SHAPE_MARCH_BEER_MAX, SHAPE_MARCH_TWO_PASS,
                                               SHAPE_MARCH_OCTAVES,  SHAPE_MARCH_GRID};
    shape_light light = lit(0.4f);
    coloured cloud = make_constant(0.8f, some_rgb);
    for (size_t i = 0; i < sizeof lights / sizeof *lights; i++) {
        double rgb[3], grey[3];
        march(&cloud, lights[i], &light, eye_at(4, 4), rgb);
        for (int c = 0; c < 3; c++) {
            coloured other = make(0.8f * (float)some_rgb[c], NULL);
            march(&other, lights[i], &light, eye_at(4, 4), grey);
            double tolerance = lights[i] == SHAPE_MARCH_GRID ? 0.003 : 2e-6;
            if (!(fabs(rgb[c] - grey[c]) <= tolerance * grey[c]))
                fail_msg("light %d, channel %d: %.8g, not %.8g", (int)lights[i], c, rgb[c], grey[c]);
            drop(&other);
        }
        assert_true(rgb[1] > 1.1 * rgb[0] && rgb[0] > 1.02 * rgb[2]);
    }
    drop(&cloud);
}

static void a_constant_colour_is_an_albedo_in_the_reference(void **state)
{
    (void)state;
    shape_light light = lit(0.4f);
    coloured cloud = make_constant(0.8f, some_rgb);
    double rgb[3], deviation[3], grey[3], own[3];
    trace(&cloud, 1000, 4000, &light, eye_at(4, 4), rgb, deviation);
    for (int c = 0; c < 3; c++) {
        coloured other = make(0.8f * (float)some_rgb[c], NULL);
        trace(&other, 1000, 4000, &light, eye_at(4, 4), grey, own);
        if (!(fabs(rgb[c] - grey[c]) <= 5 * hypot(deviation[c], own[c])))
            fail_msg("channel %d: %.6g, not %.6g +- %.2g", c, rgb[c], grey[c], hypot(deviation[c], own[c]));
        drop(&other);
    }
    drop(&cloud);
}

/* Albedo times colour is cut at 1: a furnace of radiance 1 gives 1 for a colour of 5, and less for one below 1 / albedo. */
static void colours_are_cut_at_one(void **state)
{
    (void)state;
    static const double bright[3] = {5, 1.25, 0.5};
    shape_light furnace = lit(1);
    coloured cloud = make_constant(0.8f, bright);
    double rgb[3], deviation[3];
    float albedo[3];
    furnace.sun_irradiance[0] = furnace.sun_irradiance[1] = furnace.sun_irradiance[2] = 0;
    shape_cloud_albedo(&cloud.volume->clouds[0], shape_vec3_make(8, 8, 8), albedo);
    assert_true(albedo[0] == 1 && fabsf(albedo[1] - 1) < 1e-6f && fabsf(albedo[2] - 0.4f) < 1e-6f);
    trace(&cloud, 100000, 1000, &furnace, eye_at(4, 4), rgb, deviation);
    assert_true(fabs(rgb[0] - 1) < 1e-6 && fabs(rgb[1] - 1) < 1e-5);
    assert_true(rgb[2] < 0.8);
    drop(&cloud);
}

/* One scattering: rays through the red half see the grey cloud's light in red and none in blue, and the other way round. The
 * reference within five standard errors and the march's own 1 %. */
static void halves_scatter_their_own_colour(void **state)
{
    (void)state;
    coloured cloud = make_halves(), grey = make(1, NULL);
    shape_light light = lit(0);
    for (int side = 0; side < 2; side++) {
        shape_dvec3 eye = eye_at(side ? 13 : 3, side ? 8 : 4);
        double rgb[3], white[3], traced[3], deviation[3];
        int own = side ? 2 : 0;
        march(&cloud, SHAPE_MARCH_SINGLE, &light, eye, rgb);
        march(&grey, SHAPE_MARCH_SINGLE, &light, eye, white);
        assert_true(white[0] > 0.001);
        assert_true(rgb[1] == 0 && rgb[2 - own] == 0 && fabs(rgb[own] - white[0]) <= 1e-6 * white[0]);
        trace(&cloud, 1, 10000, &light, eye, traced, deviation);
        assert_true(traced[1] == 0 && traced[2 - own] == 0);
        if (!(fabs(traced[own] - rgb[own]) <= 5 * deviation[own] + 0.01 * rgb[own]))
            fail_msg("side %d: marched %g, traced %g +- %g", side, rgb[own], traced[own], deviation[own]);
    }
    drop(&cloud);
    drop(&grey);
}

/* All scatterings: the light grid, solved once a channel with the albedo of each cell, is as near to the reference as it is
 * on a grey cloud: the mean of four rays within 5 % in each channel; with one albedo for all cells this fails. */
static void all_scatterings_of_two_halves(void **state)
{
    (void)state;
    coloured cloud = make_halves();
    shape_light light = lit(0.4f);
    double sum[3] = {0}, truth[3] = {0}, noise[3] = {0};
    for (int i = 0; i < 4; i++) {
        double rgb[3], traced[3], deviation[3];
        shape_dvec3 eye = eye_at(i < 2 ? 3 + i : 12 + i, 4 + i);
        march(&cloud, SHAPE_MARCH_GRID, &light, eye, rgb);
        trace(&cloud, 1000, 3000, &light, eye, traced, deviation);
        for (int c = 0; c < 3; c++) {
            sum[c] += rgb[c];
            truth[c] += traced[c];
            noise[c] += deviation[c];
        }
    }
    for (int c = 0; c < 3; c++)
        assert_true(fabs(sum[c] - truth[c]) <= 0.05 * truth[c] + noise[c]);
    drop(&cloud);
}

static void harris_light_has_no_colours(void **state)
{
    (void)state;
    coloured cloud = make_constant(0.8f, some_rgb);
    shape_light light = lit(0);
    shape_march_options options = shape_march_defaults();
    shape_marcher *marcher;
    shape_error error;
    options.light = SHAPE_MARCH_HARRIS;
    assert_int_equal(shape_marcher_create(cloud.volume, &light, eye_at(4, 4), &options, &marcher, &error),
                     SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "colour"));
    drop(&cloud);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_constant_colour_is_an_albedo_in_the_march),
        cmocka_unit_test(a_constant_colour_is_an_albedo_in_the_reference),
        cmocka_unit_test(colours_are_cut_at_one),
        cmocka_unit_test(halves_scatter_their_own_colour),
        cmocka_unit_test(all_scatterings_of_two_halves),
        cmocka_unit_test(harris_light_has_no_colours),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
