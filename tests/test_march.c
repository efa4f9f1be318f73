/* The marched methods: each rule's order of convergence, agreement with the reference, conservation. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "scene_sample.h"
#include "shape/march.h"

static shape_light sun_only(void)
{
    shape_light light = shape_light_defaults();
    light.sky = SHAPE_SKY_NONE;
    return light;
}

static double look(const sample_scene *scene, const shape_light *light, const shape_march_options *options,
                   shape_dvec3 eye, shape_dvec3 direction)
{
    shape_marcher *marcher;
    shape_march_scratch scratch;
    shape_error error;
    double rgb[3];
    memset(&scratch, 0, sizeof scratch);
    if (shape_marcher_create(scene->volume, light, eye, options, &marcher, &error))
        fail_msg("%s", error.text);
    assert_int_equal(shape_march_radiance(marcher, eye, direction, 0, &scratch, rgb, &error), SHAPE_OK);
    shape_march_scratch_free(&scratch);
    shape_marcher_destroy(marcher);
    return rgb[0];
}

/* In a uniform ball the shadow march is exact (its density is one number), so what is left is the rule's own error on a
 * smooth function. Halving the step divides it by 2 to the order. */
static void rules_converge_at_their_order(void **state)
{
    (void)state;
    static const struct {
        shape_rule rule;
        double order, coarse;
    } rules[] = {{SHAPE_RULE_RIEMANN_LEFT, 1, 16}, {SHAPE_RULE_RIEMANN_RIGHT, 1, 16},
                 {SHAPE_RULE_TRAPEZOID, 2, 16},    {SHAPE_RULE_SIMPSON, 4, 24},
                 {SHAPE_RULE_SIMPSON38, 4, 24},    {SHAPE_RULE_EXPONENTIAL, 2, 16}};
    sample_scene scene = sample_begin(SHAPE_MODEL_UNIFORM, 1);
    scene.set->clouds[0].medium.phase = SHAPE_PHASE_ISOTROPIC;
    sample_add(&scene, 0, 0, 0, 2, 2, 2);
    sample_finish(&scene);
    shape_light light = sun_only();
    shape_march_options options = shape_march_defaults();
    shape_dvec3 eye = {1.2, 0.3, 9}, direction = {0, 0, -1};
    /* The ray's way through the ball, a hair more, so that a whole number of steps fills it. */
    const double length = 2 * sqrt(4 - 1.2 * 1.2 - 0.3 * 0.3) * (1 + 1e-5);
    light.sun = shape_dvec3_make(1, 0, 0); /* the way to it, sqrt(1.44 + x) - 1.2 for some x > 0, is smooth */
    options.light = SHAPE_MARCH_SINGLE;
    options.light_step = 0.5;
    options.rule = SHAPE_RULE_SIMPSON;
    options.step = 4.0 / 480;
    double truth = look(&scene, &light, &options, eye, direction);
    for (int growing = 0; growing < 2; growing++)
        for (int i = 0; i < 6; i++) {
            options.rule = rules[i].rule;
            options.step = length / rules[i].coarse;
            double coarse = look(&scene, &light, &options, eye, direction) - truth;
            options.step /= 2;
            /* Steps that grow by q must become growing by sqrt(q) as they are halved. */
            options.stepping = growing ? SHAPE_STEP_GEOMETRIC : SHAPE_STEP_FIXED;
            double fine = look(&scene, &light, &options, eye, direction) - truth;
            options.stepping = SHAPE_STEP_FIXED;
            if (growing) { /* the sum is still that of a fine rule */
                assert_true(fabs(fine) < fabs(coarse));
                continue;
            }
            double order = log2(fabs(coarse) / fabs(fine));
            if (!(fabs(order - rules[i].order) < 0.25))
                fail_msg("rule %d converges at order %.2f, not %g (%g, %g)", i, order, rules[i].order, coarse,
                         fine);
        }
    sample_end(&scene);
}

/* Closed form: with no shadow on the way (the sun behind the eye, entering where the ray does), radiance
 * phase E (1 - exp(-2 depth)) / 2. */
static void matches_the_closed_form_with_the_sun_behind(void **state)
{
    (void)state;
    sample_scene scene = sample_begin(SHAPE_MODEL_UNIFORM, 0.7f);
    scene.set->clouds[0].medium.phase = SHAPE_PHASE_ISOTROPIC;
    sample_add(&scene, 0, 0, 0, 2, 2, 2);
    sample_finish(&scene);
    shape_light light = sun_only();
    light.sun = shape_dvec3_make(0, 0, 1);
    shape_march_options options = shape_march_defaults();
    options.light = SHAPE_MARCH_SINGLE;
    options.rule = SHAPE_RULE_SIMPSON;
    options.step = 0.02;
    double seen = look(&scene, &light, &options, shape_dvec3_make(0, 0, 9), shape_dvec3_make(0, 0, -1));
    assert_true(fabs(seen - 0.25 * (1 - exp(-2 * 2.8)) / 2) < 1e-5);
    sample_end(&scene);
}

/* On `spheroid`, whose density jumps at its threshold, rays' mean error falls at order 1 whatever the rule: it is at most
 * proportional to the step, and a rule of order 4 gains no more than one of order 1 would by much. */
static void jumps_bring_every_rule_to_order_one(void **state)
{
    (void)state;
    static const shape_rule rules[] = {SHAPE_RULE_RIEMANN_LEFT, SHAPE_RULE_TRAPEZOID, SHAPE_RULE_SIMPSON,
                                       SHAPE_RULE_EXPONENTIAL};
    sample_scene scene = sample_cumulus(6, 3);
    shape_light light = shape_light_defaults();
    shape_march_options options = shape_march_defaults();
    enum { RAYS = 40 };
    double truth[RAYS];
    light.sky = SHAPE_SKY_CONSTANT;
    light.sky_radiance[0] = 1;
    light.sun_irradiance[0] = 0; /* the transmittance alone: quick */
    options.light = SHAPE_MARCH_POWDER;
    options.light_step = 10;
    for (int r = -1; r < 4; r++) {
        double error[2] = {0, 0};
        for (int fine = 0; fine < 2; fine++) {
            options.rule = r < 0 ? SHAPE_RULE_TRAPEZOID : rules[r];
            options.step = r < 0 ? 5e-4 : fine ? 0.0125 : 0.1;
            for (int i = 0; i < RAYS; i++) {
                shape_dvec3 d = {0.3 * (i - RAYS / 2) / RAYS, 0.002 * i, -1};
                double seen =
                    look(&scene, &light, &options, shape_dvec3_make(0, 1, 12), shape_dvec3_normalize(d));
                if (r < 0)
                    truth[i] = seen;
                else
                    error[fine] += fabs(seen - truth[i]) / RAYS;
            }
            if (r < 0)
                break;
        }
        if (r < 0)
            continue;
        double order = log2(error[0] / error[1]) / 3; /* the step fell by 8 */
        if (!(order > 0.6 && order < 1.6))
            fail_msg("rule %d converges at order %.2f (%g, %g)", r, order, error[0], error[1]);
    }
    sample_end(&scene);
}

/* The single-scatter march against the reference with one bounce: five standard errors of the latter. */
static void single_scattering_agrees_with_the_reference(void **state)
{
    (void)state;
    sample_scene scene = sample_cumulus(8, 2);
    scene.set->clouds[0].medium.g = 0.3f;
    scene.volume->clouds[0].medium.g = 0.3f;
    shape_light light = sun_only();
    shape_march_options options = shape_march_defaults();
    shape_pathtrace_options paths = shape_pathtrace_defaults();
    shape_tracer *tracer;
    shape_random random = shape_random_seed(1, 1);
    options.light = SHAPE_MARCH_SINGLE;
    options.step = 0.01;
    options.light_step = 0.02;
    paths.max_bounces = 1;
    paths.sun_angle = 0;
    assert_int_equal(shape_tracer_create(scene.volume, &tracer, NULL), SHAPE_OK);
    for (int ray = 0; ray < 3; ray++) {
        shape_dvec3 eye = {9, 1, 8}, d = shape_dvec3_normalize(shape_dvec3_make(-9 + ray, 0.3 * ray, -8));
        double sum = 0, squares = 0, n = 30000, rgb[3];
        for (int i = 0; i < (int)n; i++) {
            shape_pathtrace_radiance(tracer, &light, &paths, eye, d, &random, rgb);
            sum += rgb[0];
            squares += rgb[0] * rgb[0];
        }
        double mean = sum / n, deviation = sqrt((squares / n - mean * mean) / n);
        double seen = look(&scene, &light, &options, eye, d);
        if (!(fabs(seen - mean) < 5 * deviation + 0.01 * mean))
            fail_msg("ray %d: marched %.6f, traced %.6f +- %.6f", ray, seen, mean, deviation);
    }
    shape_tracer_destroy(tracer);
    sample_end(&scene);
}

/* Weights sum to at most what the light gives: under a sky of 1 and with the light pass, no pixel exceeds it by more than
 * the pass's own error. Nothing is negative, with any rule, also at huge depths. */
static void stays_in_bounds(void **state)
{
    (void)state;
    sample_scene scene = sample_cumulus(8, 200);
    shape_light light = shape_light_defaults();
    shape_view view = shape_view_defaults();
    enum { W = 16, H = 9 };
    float radiance[3 * W * H];
    shape_dvec3 min, max;
    view.width = W, view.height = H;
    assert_true(shape_set_bounds(scene.set, &min, &max));
    shape_view_frame(&view, &light, min, max);
    for (int rule = SHAPE_RULE_RIEMANN_LEFT; rule <= SHAPE_RULE_EXPONENTIAL; rule++)
        for (int kind = SHAPE_MARCH_SINGLE; kind <= SHAPE_MARCH_GRID; kind++) {
            shape_march_options options = shape_march_defaults();
            shape_marcher *marcher;
            options.rule = (shape_rule)rule;
            options.light = (shape_march_light)kind;
            options.resolution = 12;
            options.jitter = SHAPE_JITTER_HASH;
            assert_int_equal(shape_marcher_create(scene.volume, &light, view.eye, &options, &marcher, NULL),
                             SHAPE_OK);
            assert_int_equal(shape_march_render(marcher, &view, radiance, NULL, NULL), SHAPE_OK);
            for (int i = 0; i < 3 * W * H; i++)
                assert_true(isfinite(radiance[i]) && radiance[i] >= 0);
            shape_marcher_destroy(marcher);
        }
    sample_end(&scene);
}

static void checks_name_what_is_wrong(void **state)
{
    (void)state;
    shape_error error;
    shape_march_options options = shape_march_defaults();
    assert_int_equal(shape_march_check(&options, &error), SHAPE_OK);
    options.growth = 0.5;
    assert_int_equal(shape_march_check(&options, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "growth"));
    options = shape_march_defaults();
    options.step = NAN;
    assert_int_equal(shape_march_check(&options, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "step"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rules_converge_at_their_order),
        cmocka_unit_test(matches_the_closed_form_with_the_sun_behind),
        cmocka_unit_test(jumps_bring_every_rule_to_order_one),
        cmocka_unit_test(single_scattering_agrees_with_the_reference),
        cmocka_unit_test(stays_in_bounds),
        cmocka_unit_test(checks_name_what_is_wrong),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
