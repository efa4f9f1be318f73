/* A lamp in the march: the closed form of its light in thin air, a lamp far away as a sun, shadows that end at it, and one
 * scattering as the reference has it. */
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

static const double pi = 3.14159265358979323846;

static shape_light dark(void)
{
    shape_light light = shape_light_defaults();
    light.sky = SHAPE_SKY_NONE;
    light.sun_irradiance[0] = light.sun_irradiance[1] = light.sun_irradiance[2] = 0;
    return light;
}

static shape_march_options lit_by(double x, double y, double z, float intensity)
{
    shape_march_options options = shape_march_defaults();
    options.light = SHAPE_MARCH_SINGLE;
    options.lamp.position = shape_dvec3_make(x, y, z);
    for (int c = 0; c < 3; c++)
        options.lamp.intensity[c] = intensity * (float)(c + 1);
    return options;
}

static void look(const sample_scene *scene, const shape_light *light, const shape_march_options *options,
                 shape_dvec3 eye, shape_dvec3 direction, double rgb[3])
{
    shape_marcher *marcher;
    shape_march_scratch scratch;
    shape_error error;
    memset(&scratch, 0, sizeof scratch);
    if (shape_marcher_create(scene->volume, light, eye, options, &marcher, &error))
        fail_msg("%s", error.text);
    assert_int_equal(shape_march_radiance(marcher, eye, direction, 0, &scratch, rgb, &error), SHAPE_OK);
    shape_march_scratch_free(&scratch);
    shape_marcher_destroy(marcher);
}

static void assert_near(double is, double truth, double share)
{
    if (!(fabs(is - truth) <= share * fabs(truth)))
        fail_msg("%.7g instead of %.7g", is, truth);
}

/* In air so thin that nothing is lost on the way (depth 1e-6), a ray that passes an isotropic lamp at distance d gathers
 * sigma I / (4 pi) times the integral of 1 / (d^2 + s^2), an arc tangent, whatever the step: each step of the exponential
 * rule takes its own share in closed form. Rules of points need steps that are short beside d. */
static void light_gathered_in_thin_air(void **state)
{
    (void)state;
    const double sigma = 1e-8, radius = 50;
    sample_scene scene = sample_begin(SHAPE_MODEL_UNIFORM, (float)sigma);
    scene.set->clouds[0].medium.phase = SHAPE_PHASE_ISOTROPIC;
    sample_add(&scene, 0, 0, 0, (float)radius, (float)radius, (float)radius);
    sample_finish(&scene);
    static const struct {
        shape_rule rule;
        double step, aside;
    } all[] = {{SHAPE_RULE_EXPONENTIAL, 1e3, 2},
               {SHAPE_RULE_EXPONENTIAL, 1, 2},
               {SHAPE_RULE_EXPONENTIAL, 1, 0.01},
               {SHAPE_RULE_SIMPSON, 0.1, 2}};
    shape_light light = dark();
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        double d = all[i].aside, along = 10, half = sqrt(radius * radius - d * d), rgb[3];
        shape_march_options options = lit_by(along, 0, 0, 7);
        options.rule = all[i].rule;
        options.step = all[i].step;
        look(&scene, &light, &options, shape_dvec3_make(-90, d, 0), shape_dvec3_make(1, 0, 0), rgb);
        double arc = atan((half - along) / d) - atan((-half - along) / d);
        for (int c = 0; c < 3; c++)
            assert_near(rgb[c], sigma * 7 * (c + 1) / (4 * pi * d) * arc, 1e-4);
    }
    /* Straight through the lamp the truth is infinite; a picture must not be. */
    double rgb[3];
    shape_march_options options = lit_by(10, 0, 0, 7);
    look(&scene, &light, &options, shape_dvec3_make(-90, 0, 0), shape_dvec3_make(1, 0, 0), rgb);
    assert_true(isfinite(rgb[0]) && rgb[0] > 0);
    sample_end(&scene);
}

/* A lamp so far away that its rays are parallel, and as much brighter, is a sun for every light that shows lamps; to a
 * thousandth, since a few samples at the density's jumps fall on the other side. */
static void a_lamp_far_away_is_a_sun(void **state)
{
    (void)state;
    static const shape_march_light lights[] = {SHAPE_MARCH_SINGLE,       SHAPE_MARCH_POWDER,
                                               SHAPE_MARCH_POWDER_ANGLE, SHAPE_MARCH_BEER_MAX,
                                               SHAPE_MARCH_HARRIS,       SHAPE_MARCH_OCTAVES};
    const double far = 1e7;
    sample_scene scene = sample_cumulus(8, 2);
    shape_light night = dark(), day = night;
    shape_dvec3 eye = {9, 1, 8}, d = shape_dvec3_normalize(shape_dvec3_make(-9, 0.3, -8));
    for (int c = 0; c < 3; c++)
        day.sun_irradiance[c] = (float)(c + 1);
    for (size_t i = 0; i < 2 * sizeof lights / sizeof *lights; i++) {
        shape_march_options lamp =
                                lit_by(far * day.sun.x, far * day.sun.y, far * day.sun.z, (float)(far * far)),
                            sun;
        double by_lamp[3], by_sun[3];
        lamp.light = lights[i / 2];
        lamp.shadow = i % 2 && lamp.light != SHAPE_MARCH_HARRIS ? SHAPE_SHADOW_CONE : SHAPE_SHADOW_MARCH;
        sun = lamp;
        memset(sun.lamp.intensity, 0, sizeof sun.lamp.intensity);
        look(&scene, &night, &lamp, eye, d, by_lamp);
        look(&scene, &day, &sun, eye, d, by_sun);
        assert_true(by_sun[0] > 0);
        for (int c = 0; c < 3; c++)
            assert_near(by_lamp[c], by_sun[c], 1e-3);
        double both[3]; /* and what two lights give is the sum */
        look(&scene, &day, &lamp, eye, d, both);
        for (int c = 0; c < 3; c++)
            assert_near(both[c], by_lamp[c] + by_sun[c], 1e-6);
    }
    sample_end(&scene);
}

static void add_triangle(shape_opaque *opaque, shape_dvec3 a, shape_dvec3 b, shape_dvec3 c)
{
    static const uint32_t corners[3] = {0, 1, 2};
    const float half[3] = {0.5f, 0.5f, 0.5f};
    shape_error error;
    shape_mesh *mesh = shape_mesh_create(3, 1, &error);
    assert_non_null(mesh);
    mesh->point_count = 3, mesh->triangle_count = 1;
    mesh->points[0] = a, mesh->points[1] = b, mesh->points[2] = c;
    memcpy(mesh->indices, corners, sizeof corners);
    if (shape_opaque_add(opaque, mesh, NULL, half, &error) || shape_opaque_finish(opaque, &error))
        fail_msg("%s", error.text);
    shape_mesh_destroy(mesh);
}

/* The floor z = 0, seen from above, with a lamp 5 m away at a cosine of 4/5: I / 25 * 4/5 * albedo / pi, times
 * exp(-depth) through a ball half way; what stands beyond the lamp throws no shadow, what stands before it does. */
static void shadows_end_at_the_lamp(void **state)
{
    (void)state;
    sample_scene scene = sample_begin(SHAPE_MODEL_UNIFORM, 1);
    scene.set->clouds[0].medium.albedo = 0;
    sample_add(&scene, 0, 1.5f, 2, 1, 1, 1);
    sample_add(&scene, 0, 6, 8, 1, 1, 1); /* beyond the lamp */
    sample_finish(&scene);
    shape_light light = dark();
    shape_march_options options = lit_by(0, 3, 4, 7);
    shape_opaque *opaque = shape_opaque_create(NULL);
    shape_dvec3 eye = {0, 0, 9}, down = {0, 0, -1};
    double rgb[3], bright = 7.0 / 25 * 0.8 * 0.5 / pi;
    options.opaque = opaque;
    add_triangle(opaque, shape_dvec3_make(-9, -9, 0), shape_dvec3_make(9, -9, 0), shape_dvec3_make(0, 9, 0));
    add_triangle(opaque, shape_dvec3_make(-1, 9, 7.5), shape_dvec3_make(1, 9, 7.5),
                 shape_dvec3_make(0, 3.5, 5));
    static const shape_march_light lights[] = {SHAPE_MARCH_SINGLE, SHAPE_MARCH_OCTAVES, SHAPE_MARCH_HARRIS};
    for (size_t i = 0; i < 3; i++) {
        options.light = lights[i];
        options.forward = 0; /* Harris' recurrence is Beer's law then */
        look(&scene, &light, &options, eye, down, rgb);
        for (int c = 0; c < 3; c++)
            assert_near(rgb[c], bright * (c + 1) * exp(-2), 1e-4);
    }
    options.lamp.position.z = -4; /* below the floor */
    look(&scene, &light, &options, eye, down, rgb);
    assert_true(rgb[0] == 0);
    options.lamp.position.z = 4;
    add_triangle(opaque, shape_dvec3_make(-1, 3, 3), shape_dvec3_make(1, 3, 3), shape_dvec3_make(0, 1, 3));
    look(&scene, &light, &options, eye, down, rgb);
    assert_true(rgb[0] == 0);
    shape_opaque_destroy(opaque);
    sample_end(&scene);
}

/* In fog the cone's crooked way to a lamp is as much longer as its four angles say, and no longer; a hundredth for the last
 * step, which is cut. The fog takes no more than exp(-depth) on the way to the eye, as it scatters nothing. */
static void the_cone_ends_at_the_lamp(void **state)
{
    (void)state;
    const double sigma = 0.2;
    sample_scene scene = sample_begin(SHAPE_MODEL_UNIFORM, (float)sigma);
    scene.set->clouds[0].medium.albedo = 0;
    sample_add(&scene, 0, 0, 0, 50, 50, 50);
    sample_finish(&scene);
    shape_light light = dark();
    shape_march_options options = lit_by(0, 0, 5, 7);
    shape_opaque *opaque = shape_opaque_create(NULL);
    double rgb[3], bright = 7.0 / 25 * 0.5 / pi, cosines = 0;
    add_triangle(opaque, shape_dvec3_make(-9, -9, 0), shape_dvec3_make(9, -9, 0), shape_dvec3_make(0, 9, 0));
    options.opaque = opaque;
    options.shadow = SHAPE_SHADOW_CONE;
    options.light_step = 0.1;
    for (int k = 1; k <= 4; k++)
        cosines += cos(5 * k * pi / 180) / 4;
    look(&scene, &light, &options, shape_dvec3_make(0, 0, 3), shape_dvec3_make(0, 0, -1), rgb);
    assert_near(rgb[0], bright * exp(-sigma * (3 + 5 / cosines)), 0.01);
    shape_opaque_destroy(opaque);
    sample_end(&scene);
}

/* A lamp beside a small cumulus and one inside it, seen by rays that miss it: five standard errors of 150,000 paths, and
 * a hundredth for the march's own steps. */
static void single_scattering_agrees_with_the_reference(void **state)
{
    (void)state;
    static const double places[][3] = {{4, 5, 3}, {0.5, 2.5, 1}};
    sample_scene scene = sample_cumulus(8, 2);
    scene.set->clouds[0].medium.g = 0.3f;
    scene.volume->clouds[0].medium.g = 0.3f;
    shape_light light = dark();
    shape_pathtrace_options paths = shape_pathtrace_defaults();
    shape_tracer *tracer;
    shape_random random = shape_random_seed(1, 1);
    paths.max_bounces = 1;
    assert_int_equal(shape_tracer_create(scene.volume, &tracer, NULL), SHAPE_OK);
    for (int i = 0; i < 4; i++) {
        const double *place = places[i / 2];
        shape_march_options options = lit_by(place[0], place[1], place[2], 30);
        shape_dvec3 eye = {9, 1, 8},
                    d = shape_dvec3_normalize(shape_dvec3_make(-9 + i % 2, 0.3 * (i % 2), -8));
        double sum = 0, squares = 0, n = 150000, rgb[3];
        options.step = 0.01;
        options.light_step = 0.02;
        paths.lamp = options.lamp;
        for (int k = 0; k < (int)n; k++) {
            shape_pathtrace_radiance(tracer, &light, &paths, eye, d, &random, rgb);
            sum += rgb[0];
            squares += rgb[0] * rgb[0];
        }
        double mean = sum / n, deviation = sqrt((squares / n - mean * mean) / n);
        look(&scene, &light, &options, eye, d, rgb);
        assert_true(deviation < 0.025 * mean);
        if (!(fabs(rgb[0] - mean) < 5 * deviation + 0.01 * mean))
            fail_msg("ray %d: marched %.6f, traced %.6f +- %.6f", i, rgb[0], mean, deviation);
    }
    shape_tracer_destroy(tracer);
    sample_end(&scene);
}

static void grids_made_for_the_sun_are_refused(void **state)
{
    (void)state;
    shape_march_options options = lit_by(0, 0, 0, 1);
    shape_error error;
    assert_int_equal(shape_march_check(&options, &error), SHAPE_OK);
    options.lamp.intensity[1] = -1;
    assert_int_equal(shape_march_check(&options, &error), SHAPE_ERROR_ARGUMENT);
    options.lamp.intensity[1] = 1;
    options.shadow = SHAPE_SHADOW_GRID;
    assert_int_equal(shape_march_check(&options, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "lamp"));
    options.shadow = SHAPE_SHADOW_MARCH;
    static const shape_march_light lights[] = {SHAPE_MARCH_GRID, SHAPE_MARCH_TWO_PASS};
    for (int i = 0; i < 2; i++) {
        options.light = lights[i];
        assert_int_equal(shape_march_check(&options, &error), SHAPE_ERROR_ARGUMENT);
        assert_non_null(strstr(error.text, "lamp"));
    }
    memset(options.lamp.intensity, 0, sizeof options.lamp.intensity);
    assert_int_equal(shape_march_check(&options, &error), SHAPE_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(light_gathered_in_thin_air),
        cmocka_unit_test(a_lamp_far_away_is_a_sun),
        cmocka_unit_test(shadows_end_at_the_lamp),
        cmocka_unit_test(the_cone_ends_at_the_lamp),
        cmocka_unit_test(single_scattering_agrees_with_the_reference),
        cmocka_unit_test(grids_made_for_the_sun_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
