/* Each light, step, jitter and alpha of the march against its closed form. The scene is mostly a uniform ball of radius 2
 * before the eye with the sun behind the eye: a point at depth x from the eye is at depth x from the sun, and radiance is
 * phase E times the integral of exp(-x) L(x) over the ball's depth D. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "light/bluenoise.h"
#include "scene_sample.h"
#include "shape/march.h"
#include "shape/phase.h"

static const double pi = 3.14159265358979323846, SIGMA = 0.7, D = 2.8;

static sample_scene ball(float extinction)
{
    sample_scene scene = sample_begin(SHAPE_MODEL_UNIFORM, extinction);
    scene.set->clouds[0].medium.phase = SHAPE_PHASE_ISOTROPIC;
    sample_add(&scene, 0, 0, 0, 2, 2, 2);
    sample_finish(&scene);
    return scene;
}

static shape_light sun_behind(double z)
{
    shape_light light = shape_light_defaults();
    light.sky = SHAPE_SKY_NONE;
    light.sun = shape_dvec3_make(0, 0, z);
    return light;
}

static shape_march_options fine(shape_march_light light)
{
    shape_march_options options = shape_march_defaults();
    options.light = light;
    options.rule = SHAPE_RULE_SIMPSON;
    options.step = 0.02;
    options.light_step = 0.02;
    options.resolution = 32;
    return options;
}

static double look(const sample_scene *scene, const shape_light *light, const shape_march_options *options,
                   double start)
{
    shape_marcher *marcher;
    shape_march_scratch scratch;
    shape_error error;
    double rgb[3];
    shape_dvec3 eye = {0, 0, 9}, direction = {0, 0, -1};
    memset(&scratch, 0, sizeof scratch);
    if (shape_marcher_create(scene->volume, light, eye, options, &marcher, &error) ||
        shape_march_radiance(marcher, eye, direction, start, &scratch, rgb, &error))
        fail_msg("%s", error.text);
    shape_march_scratch_free(&scratch);
    shape_marcher_destroy(marcher);
    return rgb[0];
}

static void assert_near(double is, double truth, double share)
{
    if (!(fabs(is - truth) <= share * fabs(truth)))
        fail_msg("%.7g instead of %.7g", is, truth);
}

/* The integral of exp(-a x) from 0 to D. */
static double decay(double a)
{
    return (1 - exp(-a * D)) / a;
}

/* --- the lights --- */

static void laws_of_depth(void **state)
{
    (void)state;
    sample_scene scene = ball((float)SIGMA);
    shape_light light = sun_behind(1);
    shape_march_options options = fine(SHAPE_MARCH_SINGLE);
    const double unit = 0.25; /* phase times E */
    assert_near(look(&scene, &light, &options, 0), unit * decay(2), 1e-4);
    options.shade = 0.3;
    assert_near(look(&scene, &light, &options, 0), unit * decay(1.3), 1e-4);
    options.shade = 1;
    options.light = SHAPE_MARCH_POWDER;
    assert_near(look(&scene, &light, &options, 0), unit * (decay(2) - decay(4)), 1e-4);
    options.powder = 5;
    assert_near(look(&scene, &light, &options, 0), unit * (decay(2) - decay(7)), 1e-4);
    options.light = SHAPE_MARCH_POWDER_ANGLE;
    assert_near(look(&scene, &light, &options, 0), unit * (decay(2) - decay(7)), 1e-4);
    /* Towards the sun there is none of it; there every way through the ball is D long. */
    shape_light before = sun_behind(-1);
    assert_near(look(&scene, &before, &options, 0), unit * D * exp(-D), 1e-4);
    options.light = SHAPE_MARCH_BEER_MAX;
    double truth = 0, steps = 100000;
    for (int i = 0; i < (int)steps; i++) {
        double x = (i + 0.5) / steps * D;
        truth += exp(-x) * fmax(exp(-x), 0.7 * exp(-x / 4)) * D / steps;
    }
    assert_near(look(&scene, &light, &options, 0), unit * truth, 1e-3);
    sample_end(&scene);
}

/* In the limit of small steps dI = -(1 - forward) I dx; the recurrence is of order 1 in its step. */
static void harris_recurrence(void **state)
{
    (void)state;
    sample_scene scene = ball((float)SIGMA);
    shape_light light = sun_behind(1);
    shape_march_options options = fine(SHAPE_MARCH_HARRIS);
    double off[2];
    for (int k = 0; k < 2; k++) {
        options.forward = 0.7;
        options.light_step = k ? 0.02 : 0.08;
        off[k] = fabs(look(&scene, &light, &options, 0) / (0.25 * decay(1.3)) - 1);
    }
    assert_true(off[1] < 0.02); /* forward eta, the step without gain */
    assert_true(off[0] / off[1] > 3 && off[0] / off[1] < 5);
    options.forward = 0;
    assert_near(look(&scene, &light, &options, 0), 0.25 * decay(2), 1e-4);
    sample_end(&scene);
}

/* Eq. 7's light is the transmittance, with whole steps, and four millionths; Eq. 8 adds 1 to the phase function. */
static void two_passes(void **state)
{
    (void)state;
    sample_scene scene = ball((float)SIGMA);
    shape_light light = sun_behind(1);
    shape_march_options options = fine(SHAPE_MARCH_TWO_PASS);
    options.resolution = 64;
    assert_near(look(&scene, &light, &options, 0), (1 + 0.25 / pi) * decay(2), 0.03);
    sample_end(&scene);
}

static void emission_of_a_dark_cloud(void **state)
{
    (void)state;
    shape_light light = sun_behind(1);
    for (int dark = 0; dark < 2; dark++) {
        sample_scene scene = ball(dark ? 0 : (float)SIGMA);
        scene.volume->clouds[0].medium.albedo = 0;
        shape_march_options options = fine(SHAPE_MARCH_SINGLE);
        options.emission[0] = 0.9f;
        for (int rule = SHAPE_RULE_TRAPEZOID; rule <= SHAPE_RULE_EXPONENTIAL; rule++) {
            options.rule = (shape_rule)rule;
            double truth = dark ? 0.9 * 4 : 0.9 / SIGMA * decay(1);
            assert_near(look(&scene, &light, &options, 0), truth, 2e-4);
        }
        sample_end(&scene);
    }
}

/* Copies of the sun's light at depth x / 2^n, each half as strong as the last, 1 in all; one copy is Beer's law. */
static void octaves_sum_to_one(void **state)
{
    (void)state;
    sample_scene scene = ball((float)SIGMA);
    shape_light light = sun_behind(1);
    shape_march_options options = fine(SHAPE_MARCH_OCTAVES);
    for (int count = 1; count <= SHAPE_MARCH_OCTAVES_MAX; count++) {
        double truth = 0, weights = 0;
        for (int n = 0; n < count; n++) {
            truth += ldexp(decay(1 + ldexp(1, -n)), -n);
            weights += ldexp(1, -n);
        }
        options.octaves = count;
        assert_near(look(&scene, &light, &options, 0), 0.25 * truth / weights, 1e-4);
    }
    sample_end(&scene);
}

/* Without sun and sky: the same radiance everywhere, of which the albedo is scattered, in every light and whatever shines
 * besides. */
static void ambient_light_reaches_every_point(void **state)
{
    (void)state;
    shape_light light = sun_behind(1);
    sample_scene scene = ball((float)SIGMA);
    scene.volume->clouds[0].medium.albedo = 0.6f;
    for (int which = SHAPE_MARCH_SINGLE; which <= SHAPE_MARCH_GRID; which++) {
        shape_march_options options = fine((shape_march_light)which);
        double without = look(&scene, &light, &options, 0);
        options.ambient[0] = 0.8f;
        assert_near(look(&scene, &light, &options, 0) - without, 0.6 * 0.8 * decay(1), 2e-4);
    }
    sample_end(&scene);
}

/* Thin steps scatter ahead: g = exp(-sigma step). */
static void silver_lining(void **state)
{
    (void)state;
    sample_scene scene = ball((float)SIGMA);
    shape_light light = sun_behind(1);
    shape_march_options options = fine(SHAPE_MARCH_SINGLE);
    options.silver = true;
    options.step = 0.5;
    options.light_step = 0.5;
    options.rule = SHAPE_RULE_SIMPSON38;
    double g = exp(-SIGMA * 0.5), phase = (double)shape_phase_hg((float)g, -1);
    assert_near(look(&scene, &light, &options, 0), phase * pi * decay(2), 0.01);
    options.light = SHAPE_MARCH_GRID;
    assert_int_equal(shape_march_check(&options, NULL), SHAPE_ERROR_ARGUMENT);
    sample_end(&scene);
}

/* --- the ways to the sun --- */

/* A black slab of optical depth 1 over a white plane: the plane shows the way to the sun alone. Steps that go astray by 5,
 * 10, 15, 20 degrees make it longer by the mean of their cosines. */
static void shadows_by_steps_cone_and_grid(void **state)
{
    (void)state;
    sample_scene scene = sample_begin(SHAPE_MODEL_UNIFORM, 1);
    scene.set->clouds[0].medium.albedo = 0;
    sample_add(&scene, 0, 0, 2, 1000, 1000, 0.5f);
    sample_finish(&scene);
    shape_mesh *mesh = shape_mesh_create(3, 1, NULL);
    mesh->point_count = 3, mesh->triangle_count = 1;
    mesh->points[0] = shape_dvec3_make(-50, -50, 0);
    mesh->points[1] = shape_dvec3_make(50, -50, 0);
    mesh->points[2] = shape_dvec3_make(0, 90, 0);
    mesh->indices[0] = 0, mesh->indices[1] = 1, mesh->indices[2] = 2;
    shape_opaque *opaque = shape_opaque_create(NULL);
    float white[3] = {1, 1, 1};
    assert_int_equal(shape_opaque_add(opaque, mesh, NULL, white, NULL), SHAPE_OK);
    assert_int_equal(shape_opaque_finish(opaque, NULL), SHAPE_OK);
    shape_mesh_destroy(mesh);
    shape_light light = sun_behind(1);
    shape_march_options options = fine(SHAPE_MARCH_SINGLE);
    options.opaque = opaque;
    options.light_step = 1.0 / 400;
    /* The eye looks through the slab too. */
    assert_near(look(&scene, &light, &options, 0), exp(-2), 1e-3);
    options.shadow = SHAPE_SHADOW_CONE;
    double cosines = (cos(5 * pi / 180) + cos(10 * pi / 180) + cos(15 * pi / 180) + cos(20 * pi / 180)) / 4;
    assert_near(look(&scene, &light, &options, 0), exp(-1 - 1 / cosines), 2e-3);
    shape_opaque_destroy(opaque);
    sample_end(&scene);
    /* Inside a ball, the grid of depths and the steps agree to what 32 cells are worth. */
    scene = ball((float)SIGMA);
    options = fine(SHAPE_MARCH_SINGLE);
    options.shadow = SHAPE_SHADOW_GRID;
    assert_near(look(&scene, &light, &options, 0), 0.25 * decay(2), 0.02);
    sample_end(&scene);
}

/* --- steps --- */

/* Steps that grow with the distance converge as others do: Riemann's rule at order 1 in their share of it. */
static void exponential_steps(void **state)
{
    (void)state;
    sample_scene scene = ball((float)SIGMA);
    shape_light light = sun_behind(1);
    shape_march_options options = fine(SHAPE_MARCH_SINGLE);
    double off[2];
    options.stepping = SHAPE_STEP_EXPONENTIAL;
    options.rule = SHAPE_RULE_RIEMANN_LEFT;
    for (int k = 0; k < 2; k++) {
        options.share = k ? 0.0025 : 0.01;
        off[k] = fabs(look(&scene, &light, &options, 0) - 0.25 * decay(2));
    }
    assert_true(off[0] / off[1] > 3.5 && off[0] / off[1] < 4.5);
    options.rule = SHAPE_RULE_SIMPSON;
    assert_near(look(&scene, &light, &options, 0), 0.25 * decay(2), 1e-4);
    sample_end(&scene);
}

/* Wherever steps begin they fill the interval; the mean over all starts is nearer to the truth than one alone. */
static void starts_of_rays(void **state)
{
    (void)state;
    enum { STARTS = 64 };
    sample_scene scene = ball((float)SIGMA);
    shape_light light = sun_behind(1);
    shape_march_options options = fine(SHAPE_MARCH_SINGLE);
    options.rule = SHAPE_RULE_RIEMANN_LEFT;
    options.step = 0.25;
    double truth = 0.25 * decay(2), mean = 0;
    for (int i = 0; i < STARTS; i++) {
        double seen = look(&scene, &light, &options, (i + 0.5) / STARTS);
        mean += seen / STARTS;
        assert_near(seen, truth, 0.25); /* half of sigma step, doubled by the light */
    }
    assert_true(fabs(mean - truth) < fabs(look(&scene, &light, &options, 0) - truth));
    sample_end(&scene);
}

/* A fine grid of starts changes little, by about the shift of the way to the sun; a coarse one much. */
static void starts_locked_to_a_grid(void **state)
{
    (void)state;
    sample_scene scene = ball((float)SIGMA);
    shape_light light = sun_behind(1);
    shape_march_options options = fine(SHAPE_MARCH_SINGLE);
    options.step = 0.005;
    options.rule = SHAPE_RULE_EXPONENTIAL;
    double free = look(&scene, &light, &options, 0);
    options.lock = 200.3;
    assert_near(look(&scene, &light, &options, 0), free, 0.01);
    options.lock = 0.3;
    assert_true(fabs(look(&scene, &light, &options, 0) - free) > 0.02 * free);
    sample_end(&scene);
}

/* --- coverage --- */

static void alpha_correction_and_peeling(void **state)
{
    (void)state;
    sample_scene scene = ball(0.2f);
    scene.volume->clouds[0].medium.albedo = 0;
    shape_light light = sun_behind(1);
    light.sky = SHAPE_SKY_CONSTANT;
    light.sky_radiance[0] = 1;
    shape_march_options options = fine(SHAPE_MARCH_SINGLE);
    double alpha = 1 - exp(-0.8);
    assert_near(look(&scene, &light, &options, 0), 1 - alpha, 1e-5);
    options.alpha_power = 3;
    assert_near(look(&scene, &light, &options, 0), 1 - alpha * alpha * alpha, 1e-5);
    options.alpha_peel = alpha * 0.99;
    assert_near(look(&scene, &light, &options, 0), 1 - alpha * alpha * alpha, 1e-5);
    options.alpha_peel = alpha * 1.01;
    assert_true(look(&scene, &light, &options, 0) == 1);
    sample_end(&scene);
}

/* --- blue noise --- */

/* Each rank once; and blue: the mean over 8x8 blocks varies far less than that of white noise, whose variance is the
 * rank's over 64. (Measured: by a seventeenth; what is left comes from the blocks' sharp edges.) */
static void blue_noise_is_even(void **state)
{
    (void)state;
    static uint16_t rank[BLUENOISE_COUNT], again[BLUENOISE_COUNT];
    static bool seen[BLUENOISE_COUNT];
    enum { N = BLUENOISE_SIZE, BLOCK = 8 };
    assert_int_equal(bluenoise_make(1, rank, NULL), SHAPE_OK);
    assert_int_equal(bluenoise_make(1, again, NULL), SHAPE_OK);
    assert_memory_equal(rank, again, sizeof rank);
    for (int i = 0; i < BLUENOISE_COUNT; i++) {
        assert_true(rank[i] < BLUENOISE_COUNT && !seen[rank[i]]);
        seen[rank[i]] = true;
    }
    double squares = 0;
    for (int by = 0; by < N; by += BLOCK)
        for (int bx = 0; bx < N; bx += BLOCK) {
            double mean = 0;
            for (int k = 0; k < BLOCK * BLOCK; k++)
                mean +=
                    (rank[(by + k / BLOCK) * N + bx + k % BLOCK] + 0.5) / BLUENOISE_COUNT / (BLOCK * BLOCK);
            squares += (mean - 0.5) * (mean - 0.5) / (N / BLOCK * N / BLOCK);
        }
    double white = 1.0 / 12 / (BLOCK * BLOCK);
    print_message("block means vary by %.4f of white noise\n", squares / white);
    assert_true(squares < 0.1 * white);
}

static void checks_name_what_is_wrong(void **state)
{
    (void)state;
    shape_error error;
    shape_march_options options = shape_march_defaults();
    options.share = 0;
    assert_int_equal(shape_march_check(&options, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "share"));
    options = shape_march_defaults();
    options.alpha_power = 0;
    assert_int_equal(shape_march_check(&options, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "alpha_power"));
    options = shape_march_defaults();
    options.emission[2] = NAN;
    assert_int_equal(shape_march_check(&options, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "emission"));
    options = shape_march_defaults();
    options.ambient[1] = -1;
    assert_int_equal(shape_march_check(&options, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "ambient"));
    options = shape_march_defaults();
    options.octaves = SHAPE_MARCH_OCTAVES_MAX + 1;
    assert_int_equal(shape_march_check(&options, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "octaves"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(laws_of_depth),
        cmocka_unit_test(harris_recurrence),
        cmocka_unit_test(two_passes),
        cmocka_unit_test(emission_of_a_dark_cloud),
        cmocka_unit_test(octaves_sum_to_one),
        cmocka_unit_test(ambient_light_reaches_every_point),
        cmocka_unit_test(silver_lining),
        cmocka_unit_test(shadows_by_steps_cone_and_grid),
        cmocka_unit_test(exponential_steps),
        cmocka_unit_test(starts_of_rays),
        cmocka_unit_test(starts_locked_to_a_grid),
        cmocka_unit_test(alpha_correction_and_peeling),
        cmocka_unit_test(blue_noise_is_even),
        cmocka_unit_test(checks_name_what_is_wrong),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
