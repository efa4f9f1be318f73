/* Air between the eye and things (shape/air.h), against Koschmieder's closed forms in the reference and in the march: a black
 * wall far away, a sky that stays as it is, air in a shadow that is known. Where nothing is left to chance both are exact, up to
 * rounding; else four standard errors are allowed, of seeds that are fixed. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "scene_sample.h"
#include "shape/air.h"
#include "shape/march.h"

static const double visibility = 50;

/* A sky of radiance 1 and a sun above; the air's extinction is 3.912 / 50. */
static shape_light hazy(void)
{
    shape_light light = shape_light_defaults();
    light.sky = SHAPE_SKY_CONSTANT;
    for (int c = 0; c < 3; c++)
        light.sky_radiance[c] = 1;
    light.sun = shape_dvec3_make(0, 1, 0);
    light.air.visibility = visibility;
    return light;
}

/* A cloud that is far from all rays. */
static sample_scene far_cloud(void)
{
    sample_scene scene = sample_begin(SHAPE_MODEL_UNIFORM, 1);
    sample_add(&scene, 0, -1e4f, 0, 1, 1, 1);
    sample_finish(&scene);
    return scene;
}

/* A black rectangle: at depth z, across it, or level at height y from depth z0 to z1. */
static void add_black(shape_opaque *opaque, const shape_dvec3 corners[4])
{
    shape_error error;
    const float black[3] = {0, 0, 0};
    shape_dvec3 points[4];
    uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
    memcpy(points, corners, sizeof points);
    const shape_mesh mesh = {.points = points, .indices = indices, .point_count = 4, .triangle_count = 2};
    if (shape_opaque_add(opaque, &mesh, NULL, black, &error))
        fail_msg("%s", error.text);
}

static void add_wall(shape_opaque *opaque, double z)
{
    const shape_dvec3 corners[4] = {{-9, -9, z}, {9, -9, z}, {9, 9, z}, {-9, 9, z}};
    add_black(opaque, corners);
}

static void add_roof(shape_opaque *opaque, double z0, double z1)
{
    const shape_dvec3 corners[4] = {{-9, 5, z0}, {9, 5, z0}, {9, 5, z1}, {-9, 5, z1}};
    add_black(opaque, corners);
}

static shape_opaque *new_opaque(void)
{
    shape_opaque *opaque = shape_opaque_create(NULL);
    if (!opaque)
        fail_msg("out of memory");
    return opaque;
}

/* Red along +z from the origin, marched: the mean over evenly placed starts of the looks at the sun. */
static double marched(const sample_scene *scene, const shape_light *light, shape_opaque *opaque, int starts)
{
    shape_error error;
    shape_march_options options = shape_march_defaults();
    shape_march_scratch scratch;
    shape_marcher *marcher;
    double rgb[3], sum = 0;
    memset(&scratch, 0, sizeof scratch);
    options.opaque = opaque;
    if (opaque && shape_opaque_finish(opaque, &error))
        fail_msg("%s", error.text);
    if (shape_marcher_create(scene->volume, light, shape_dvec3_make(0, 0, 0), &options, &marcher, &error))
        fail_msg("%s", error.text);
    for (int i = 0; i < starts; i++) {
        scratch.air_start = (i + 0.5) / starts;
        if (shape_march_radiance(marcher, shape_dvec3_make(0, 0, 0), shape_dvec3_make(0, 0, 1), 0, &scratch,
                                 rgb, &error))
            fail_msg("%s", error.text);
        sum += rgb[0] / starts;
    }
    shape_march_scratch_free(&scratch);
    shape_marcher_destroy(marcher);
    return sum;
}

/* The same by paths; *deviation gets the standard error. */
static double traced(const sample_scene *scene, const shape_light *light, shape_opaque *opaque, int paths,
                     double *deviation)
{
    shape_error error;
    shape_tracer *tracer;
    shape_pathtrace_options options = shape_pathtrace_defaults();
    shape_random random = shape_random_seed(5, 0);
    double rgb[3], sum = 0, squares = 0;
    options.opaque = opaque;
    options.sun_angle = 0;
    if (opaque && shape_opaque_finish(opaque, &error))
        fail_msg("%s", error.text);
    if (shape_tracer_create(scene->volume, &tracer, &error))
        fail_msg("%s", error.text);
    for (int i = 0; i < paths; i++) {
        shape_pathtrace_radiance(tracer, light, &options, shape_dvec3_make(0, 0, 0),
                                 shape_dvec3_make(0, 0, 1), &random, rgb);
        sum += rgb[0];
        squares += rgb[0] * rgb[0];
    }
    shape_tracer_destroy(tracer);
    sum /= paths;
    *deviation = sqrt(fmax(squares / paths - sum * sum, 0) / paths);
    return sum;
}

/* --- along a ray --- */

static void depth_and_distance_are_inverse(void **state)
{
    (void)state;
    static const double thinnings[] = {0, 1e-12, 0.001, 0.2, -0.001, -0.2};
    for (size_t i = 0; i < sizeof thinnings / sizeof *thinnings; i++) {
        shape_air_ray ray = {.extinction = 0.03, .thinning = thinnings[i]};
        double sum = 0;
        for (int k = 0; k < 100000; k++) /* the middle rule, of error h^2 / 24 (0.2)^2: below 1e-9 */
            sum += 0.03 * exp(-thinnings[i] * (k + 0.5) * 2e-4) * 2e-4;
        assert_true(fabs(shape_air_depth(&ray, 20) - sum) < 1e-8 * sum);
        assert_true(fabs(shape_air_distance(&ray, shape_air_depth(&ray, 20)) - 20) < 1e-8);
        assert_true(shape_air_depth(&ray, 0) == 0 && shape_air_distance(&ray, 0) == 0);
        double whole = shape_air_depth(&ray, INFINITY);
        assert_true(thinnings[i] > 0 ? fabs(whole - 0.03 / thinnings[i]) < 1e-9 * whole : whole > 700);
        if (thinnings[i] > 0)
            assert_true(isinf(shape_air_distance(&ray, 1.0001 * whole)));
    }
}

/* The air thins with height: a factor e over its height, from y = 0. */
static void air_thins_with_height(void **state)
{
    (void)state;
    shape_air air = {3.912, 100};
    assert_true(fabs(shape_air_extinction(&air, 0) - 1) < 1e-12);
    assert_true(fabs(shape_air_extinction(&air, 100) - exp(-1)) < 1e-12);
    air.height = 0;
    assert_true(shape_air_extinction(&air, 1e5) == shape_air_extinction(&air, 0));
    air.visibility = 0;
    assert_true(shape_air_extinction(&air, 0) == 0);
}

/* --- Koschmieder --- */

/* At the distance d its radiance is 1 - exp(-sigma d) beneath a sky of 1; at the visibility the contrast is 0.02. */
static void a_black_wall_fades_into_the_sky(void **state)
{
    (void)state;
    sample_scene scene = far_cloud();
    shape_light light = hazy();
    static const double distances[] = {1, 20, 50, 300};
    for (int i = 0; i < 4; i++) {
        shape_opaque *opaque = new_opaque();
        double wanted = 1 - exp(-3.912 * distances[i] / visibility), deviation;
        add_wall(opaque, distances[i]);
        assert_true(fabs(marched(&scene, &light, opaque, 1) - wanted) < 1e-9);
        assert_true(fabs(traced(&scene, &light, opaque, 4, &deviation) - wanted) < 1e-9);
        if (distances[i] == visibility)
            assert_true(fabs(1 - wanted - 0.02) < 1e-5);
        shape_opaque_destroy(opaque);
    }
    sample_end(&scene);
}

/* Without shadow no air is seen before the sky, whatever its kind, and however the air thins. */
static void the_sky_stays_as_it_is(void **state)
{
    (void)state;
    sample_scene scene = far_cloud();
    for (int kind = SHAPE_SKY_NONE; kind <= SHAPE_SKY_CLEAR; kind++)
        for (int thins = 0; thins < 2; thins++) {
            shape_light light = hazy();
            double deviation;
            float sky[3];
            light.sky = (shape_sky_kind)kind;
            light.air.height = thins ? 30 : 0;
            shape_sky made = shape_sky_make(&light);
            shape_sky_radiance(&made, shape_vec3_make(0, 0, 1), sky);
            assert_true(fabs(marched(&scene, &light, NULL, 1) - (double)sky[0]) < 1e-9);
            assert_true(fabs(traced(&scene, &light, NULL, 4, &deviation) - (double)sky[0]) < 1e-9);
        }
    sample_end(&scene);
}

/* Under a roof as long as the way to the wall, the air lacks the sun's share of its light. */
static void air_in_the_shadow_lacks_the_suns_share(void **state)
{
    (void)state;
    sample_scene scene = far_cloud();
    shape_light light = hazy();
    shape_opaque *opaque = new_opaque();
    add_wall(opaque, 20);
    add_roof(opaque, -1, 21);
    /* Haze at a right angle to the sun: 0.016976 sr^-1, against a sky of 1. */
    double sun = 0.4224 / (4 * 3.14159265358979 * pow(1.5776, 1.5)) * 3.14159265358979, deviation;
    double wanted = (1 - exp(-3.912 * 20 / visibility)) * (1 - sun / (sun + 1));
    assert_true(sun > 0.05 && fabs(marched(&scene, &light, opaque, 1) - wanted) < 1e-6);
    assert_true(fabs(traced(&scene, &light, opaque, 16, &deviation) - wanted) < 1e-6);
    memset(light.sun_irradiance, 0, sizeof light.sun_irradiance); /* a sun that gives nothing takes nothing */
    assert_true(fabs(marched(&scene, &light, opaque, 1) - (1 - exp(-3.912 * 20 / visibility))) < 1e-9);
    shape_opaque_destroy(opaque);
    sample_end(&scene);
}

/* A roof from 5 m to 12 m of the way: what is lacking is the integral of sigma exp(-sigma t) there, times the share. One
 * march is off by less than two looks of 24, its mean over starts by much less. */
static void a_streak_is_as_dark_as_its_shadow_is_long(void **state)
{
    (void)state;
    sample_scene scene = far_cloud();
    shape_light light = hazy();
    shape_opaque *opaque = new_opaque();
    double sigma = 3.912 / visibility, deviation, share[3];
    const float mean[3] = {1, 1, 1};
    add_roof(opaque, 5, 12);
    shape_air_sun_share(&light, mean, 0, share);
    double wanted = 1 - share[0] * (exp(-5 * sigma) - exp(-12 * sigma));
    assert_true(1 - wanted > 0.01);
    assert_true(fabs(marched(&scene, &light, opaque, 1) - wanted) < share[0] * 2 / 24);
    assert_true(fabs(marched(&scene, &light, opaque, 200) - wanted) < 1e-4);
    double got = traced(&scene, &light, opaque, 1500, &deviation);
    assert_true(deviation < 2e-3 && fabs(got - wanted) < 4 * deviation);
    shape_opaque_destroy(opaque);
    sample_end(&scene);
}

/* A black uniform ball on the way: the air before, in and behind it, the latter two through what is left of the ball's
 * transmittance: closed form for a sun that gives nothing. Extinctions add in the ball. */
static void air_and_cloud_share_the_way(void **state)
{
    (void)state;
    sample_scene scene = sample_begin(SHAPE_MODEL_UNIFORM, 0.5f);
    sample_add(&scene, 0, 0, 10, 2, 2, 2);
    scene.set->clouds[0].medium.albedo = 0;
    sample_finish(&scene);
    shape_light light = hazy();
    memset(light.sun_irradiance, 0, sizeof light.sun_irradiance);
    double a = 3.912 / visibility, b = 0.5, deviation;
    double wanted = 1 - exp(-8 * a) + exp(-8 * a) * a / (a + b) * (1 - exp(-4 * (a + b))) +
                    exp(-8 * a) * exp(-4 * (a + b));
    double got = marched(&scene, &light, NULL, 1);
    assert_true(fabs(got - wanted) < 1e-3); /* the trapezoid rule within steps of a hundredth of 4 m */
    got = traced(&scene, &light, NULL, 1500, &deviation);
    assert_true(deviation < 2e-2 && fabs(got - wanted) < 4 * deviation);
    sample_end(&scene);
}

static void wrong_air_is_refused(void **state)
{
    (void)state;
    shape_error error;
    static const double wrong[] = {-1, 1e-4, 1e13, NAN, INFINITY};
    for (int i = 0; i < 5; i++) {
        shape_light light = hazy();
        light.air.visibility = wrong[i];
        assert_int_equal(shape_light_check(&light, &error), SHAPE_ERROR_ARGUMENT);
        light = hazy();
        light.air.height = wrong[i];
        assert_int_equal(shape_light_check(&light, &error), SHAPE_ERROR_ARGUMENT);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(depth_and_distance_are_inverse),
                                       cmocka_unit_test(air_thins_with_height),
                                       cmocka_unit_test(a_black_wall_fades_into_the_sky),
                                       cmocka_unit_test(the_sky_stays_as_it_is),
                                       cmocka_unit_test(air_in_the_shadow_lacks_the_suns_share),
                                       cmocka_unit_test(a_streak_is_as_dark_as_its_shadow_is_long),
                                       cmocka_unit_test(air_and_cloud_share_the_way),
                                       cmocka_unit_test(wrong_air_is_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
