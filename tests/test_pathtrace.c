/* The reference path tracer against closed forms, published tables, conservation, reciprocity and its slow twin. Every
 * comparison by chance allows four standard errors of the estimate; the seeds are fixed. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "scene_sample.h"
#include "shape/pathtrace.h"
#include "twin_delta.h"

static const double pi = 3.14159265358979323846;

/* A mean of estimates and its standard error. */
typedef struct estimate {
    double sum, squares, n;
} estimate;

static void add(estimate *e, double value)
{
    e->sum += value;
    e->squares += value * value;
    e->n++;
}

static double mean(const estimate *e)
{
    return e->sum / e->n;
}

static double standard_error(const estimate *e)
{
    return sqrt(fmax(e->squares / e->n - mean(e) * mean(e), 0) / e->n);
}

static void assert_estimate(const estimate *e, double truth, double allowance)
{
    double off = fabs(mean(e) - truth), room = 4 * standard_error(e) + allowance;
    if (!(off <= room))
        fail_msg("%.6f instead of %.6f (%.6f allowed)", mean(e), truth, room);
}

static shape_tracer *trace(const sample_scene *scene)
{
    shape_tracer *tracer;
    shape_error error;
    if (shape_tracer_create(scene->volume, &tracer, &error))
        fail_msg("%s", error.text);
    return tracer;
}

/* A slab of thickness 1 and optical thickness tau about the plane y = 0: an ellipsoid flattened 2000 to 1. */
static sample_scene slab(double tau, double g, double albedo)
{
    sample_scene scene = sample_begin(SHAPE_MODEL_UNIFORM, (float)tau);
    scene.set->clouds[0].medium.g = (float)g;
    scene.set->clouds[0].medium.albedo = (float)albedo;
    sample_add(&scene, 0, 0, 0, 1000, 0.5f, 1000);
    sample_finish(&scene);
    return scene;
}

static shape_light sun_only(double cosine)
{
    shape_light light = shape_light_defaults();
    light.sky = SHAPE_SKY_NONE;
    light.sun = shape_dvec3_make(sqrt(1 - cosine * cosine), cosine, 0);
    return light;
}

/* Reflectance and transmittance by walks from above, at incidence cosine `cosine`. */
static void measure_slab(double tau, double g, double albedo, double cosine, int bounces, int walks,
                         estimate *r, estimate *t)
{
    sample_scene scene = slab(tau, g, albedo);
    shape_tracer *tracer = trace(&scene);
    shape_dvec3 down = {sqrt(1 - cosine * cosine), -cosine, 0};
    shape_dvec3 origin = shape_dvec3_scale(down, -2 / cosine);
    shape_random random = shape_random_seed(11, (uint64_t)(tau * 100));
    memset(r, 0, sizeof *r);
    memset(t, 0, sizeof *t);
    for (int i = 0; i < walks; i++) {
        shape_walk walk = shape_tracer_walk(tracer, origin, down, bounces, &random);
        add(r, walk.direction.y > 0 ? walk.weight : 0);
        add(t, walk.direction.y > 0 ? 0 : walk.weight);
    }
    shape_tracer_destroy(tracer);
    sample_end(&scene);
}

/* Adding-doubling with 32 quadrature points; tau 1 also in van de Hulst's tables. The whole table: bench_slab. */
static void slab_reflects_as_the_tables_say(void **state)
{
    (void)state;
    static const struct {
        double tau, g, truth;
    } rows[] = {{1, 0, 0.34133}, {1, 0.75, 0.07874}, {4, 0.5, 0.50897}, {8, 0.85, 0.35843}};
    estimate r, t;
    for (int i = 0; i < 4; i++) {
        measure_slab(rows[i].tau, rows[i].g, 1, 1, 4096, 40000, &r, &t);
        assert_estimate(&r, rows[i].truth, 2e-4);
        assert_true(fabs(mean(&r) + mean(&t) - 1) < 1e-9); /* nothing is absorbed */
    }
}

static void absorbing_slab_as_the_tables_say(void **state)
{
    (void)state;
    estimate r, t;
    measure_slab(1, 0, 0.99, 0.5, 4096, 40000, &r, &t);
    assert_estimate(&r, 0.48652, 2e-4);
    assert_estimate(&t, 0.49163, 2e-4);
    measure_slab(4, 0.5, 0.99, 0.5, 4096, 40000, &r, &t);
    assert_estimate(&r, 0.61996, 2e-4);
    assert_estimate(&t, 0.30605, 2e-4);
}

/* Closed form: half the integral over the slab of exp(-t) E2(t) dt. */
static void single_scattering_of_an_isotropic_slab(void **state)
{
    (void)state;
    estimate r, t;
    measure_slab(1, 0, 1, 1, 1, 60000, &r, &t);
    assert_estimate(&r, 0.142015, 2e-4);
    measure_slab(4, 0, 1, 1, 1, 60000, &r, &t);
    assert_estimate(&r, 0.153413, 2e-4);
}

static estimate slab_radiance(double tau, double g, double sun, double view, int paths)
{
    sample_scene scene = slab(tau, g, 1);
    shape_tracer *tracer = trace(&scene);
    shape_light light = sun_only(sun);
    shape_pathtrace_options options = shape_pathtrace_defaults();
    options.sun_angle = 0;
    /* Away from the sun's azimuth by a right angle: the table's mean over azimuths is for a sun overhead. */
    shape_dvec3 down = {0, -view, sqrt(1 - view * view)};
    shape_dvec3 eye = shape_dvec3_scale(down, -2 / view);
    shape_random random = shape_random_seed(5, 3);
    estimate e = {0, 0, 0};
    for (int i = 0; i < paths; i++) {
        double rgb[3];
        shape_pathtrace_radiance(tracer, &light, &options, eye, down, &random, rgb);
        assert_true(rgb[0] == rgb[1] && rgb[1] == rgb[2]);
        add(&e, rgb[0]);
    }
    shape_tracer_destroy(tracer);
    sample_end(&scene);
    return e;
}

static void camera_sees_the_slabs_radiance(void **state)
{
    (void)state;
    estimate grazing = slab_radiance(1, 0.75, 1, 0.1, 60000);
    estimate oblique = slab_radiance(1, 0.75, 1, 0.5, 60000), nadir = slab_radiance(1, 0.75, 1, 1, 60000);
    estimate thick = slab_radiance(8, 0.75, 1, 1, 12000);
    assert_estimate(&grazing, 0.15139, 5e-5);
    assert_estimate(&oblique, 0.10125, 5e-5);
    assert_estimate(&nadir, 0.03908, 5e-5);
    assert_estimate(&thick, 0.4925, 4e-4);
}

/* The same light from the other end: of photons that fall straight down, a share leaves upwards between two cosines, and
 * radiance is that share times E over pi (b^2 - a^2). The camera's mean over the same range, drawn by the cosine, agrees. */
static void traced_from_the_sun_as_from_the_camera(void **state)
{
    (void)state;
    static const double range[3][2] = {{0.05, 0.3}, {0.4, 0.6}, {0.8, 1}};
    const int walks = 150000, looks = 20000;
    sample_scene scene = slab(1, 0.75, 1);
    shape_tracer *tracer = trace(&scene);
    shape_light light = sun_only(1);
    shape_pathtrace_options options = shape_pathtrace_defaults();
    shape_random random = shape_random_seed(9, 1);
    shape_dvec3 down = {0, -1, 0}, above = {0, 2, 0};
    estimate from_sun[3] = {{0, 0, 0}}, from_camera[3] = {{0, 0, 0}};
    options.sun_angle = 0;
    for (int i = 0; i < walks; i++) {
        double cosine = shape_tracer_walk(tracer, above, down, 4096, &random).direction.y;
        for (int k = 0; k < 3; k++) {
            double a = range[k][0], b = range[k][1];
            add(&from_sun[k], cosine > a && cosine <= b ? pi / (pi * (b * b - a * a)) : 0);
        }
    }
    for (int i = 0; i < 3 * looks; i++) {
        double a = range[i % 3][0], b = range[i % 3][1], rgb[3];
        double view = sqrt(a * a + (b * b - a * a) * shape_random_unit(&random));
        shape_dvec3 d = {0, -view, sqrt(1 - view * view)};
        shape_pathtrace_radiance(tracer, &light, &options, shape_dvec3_scale(d, -2 / view), d, &random, rgb);
        add(&from_camera[i % 3], rgb[0]);
    }
    for (int k = 0; k < 3; k++)
        assert_estimate(&from_sun[k], mean(&from_camera[k]), 4 * standard_error(&from_camera[k]));
    shape_tracer_destroy(tracer);
    sample_end(&scene);
}

/* Helmholtz: radiance over the sun's cosine stays the same when sun and camera change places. */
static void slab_is_reciprocal(void **state)
{
    (void)state;
    estimate a = slab_radiance(2, 0.6, 0.4, 0.9, 40000), b = slab_radiance(2, 0.6, 0.9, 0.4, 40000);
    double difference = mean(&a) / 0.4 - mean(&b) / 0.9;
    assert_true(fabs(difference) <= 4 * hypot(standard_error(&a) / 0.4, standard_error(&b) / 0.9));
}

/* 2 [1 - (1 + D) exp(-D)] / D^2 for parallel light through a ball of optical diameter D. */
static void ball_transmits_as_its_closed_form(void **state)
{
    (void)state;
    for (int k = 0; k < 3; k++) {
        double depth = k == 0 ? 0.5 : k == 1 ? 3 : 12;
        sample_scene scene = sample_begin(SHAPE_MODEL_UNIFORM, (float)(depth / 4));
        sample_add(&scene, 1, 2, 3, 2, 2, 2);
        sample_finish(&scene);
        shape_tracer *tracer = trace(&scene);
        shape_random random = shape_random_seed(2, (uint64_t)k);
        estimate e = {0, 0, 0};
        for (int i = 0; i < 40000; i++) {
            double radius = 2 * sqrt(shape_random_unit(&random)), angle = 2 * pi * shape_random_unit(&random);
            shape_dvec3 origin = {1 + radius * cos(angle), 2 + radius * sin(angle), 20};
            add(&e,
                shape_tracer_transmittance(tracer, origin, shape_dvec3_make(0, 0, -1), INFINITY, &random));
        }
        assert_estimate(&e, 2 * (1 - (1 + depth) * exp(-depth)) / (depth * depth), 0);
        shape_tracer_destroy(tracer);
        sample_end(&scene);
    }
}

/* Radiance 1 from everywhere, no absorption: radiance 1 wherever one looks, path by path. */
static void white_furnace_is_white(void **state)
{
    (void)state;
    sample_scene scene = sample_cumulus(35, 15);
    shape_tracer *tracer = trace(&scene);
    shape_light light = sun_only(1);
    shape_pathtrace_options options = shape_pathtrace_defaults();
    shape_random random = shape_random_seed(1, 1);
    light.sky = SHAPE_SKY_CONSTANT;
    for (int c = 0; c < 3; c++) {
        light.sky_radiance[c] = 1;
        light.sun_irradiance[c] = 0;
    }
    for (int i = 0; i < 1500; i++) {
        double rgb[3];
        shape_dvec3 eye = {20, 1, 0},
                    target = {0, 2.5 * shape_random_unit(&random), 4 * shape_random_unit(&random) - 2};
        shape_dvec3 direction = shape_dvec3_normalize(shape_dvec3_sub(target, eye));
        shape_pathtrace_radiance(tracer, &light, &options, eye, direction, &random, rgb);
        for (int c = 0; c < 3; c++)
            assert_true(fabs(rgb[c] - 1) < 1e-12);
    }
    shape_tracer_destroy(tracer);
    sample_end(&scene);
}

/* The same expectation from the grid and from the naive twin, along the same rays. */
static void agrees_with_the_naive_twin(void **state)
{
    (void)state;
    sample_scene scene = sample_cumulus(12, 6);
    shape_tracer *tracer = trace(&scene);
    shape_light light = shape_light_defaults();
    shape_pathtrace_options options = shape_pathtrace_defaults();
    options.sun_angle = 0;
    shape_random random = shape_random_seed(3, 1);
    estimate ours[3] = {{0, 0, 0}}, twins[3] = {{0, 0, 0}};
    for (int i = 0; i < 6000; i++) {
        double rgb[3];
        shape_dvec3 eye = {12, 0, 9};
        shape_dvec3 target = {4 * shape_random_unit(&random) - 2, 2.5 * shape_random_unit(&random), 0};
        shape_dvec3 direction = shape_dvec3_normalize(shape_dvec3_sub(target, eye));
        shape_pathtrace_radiance(tracer, &light, &options, eye, direction, &random, rgb);
        for (int c = 0; c < 3; c++)
            add(&ours[c], rgb[c]);
        twin_radiance(scene.volume, &light, eye, direction, &random, rgb);
        for (int c = 0; c < 3; c++)
            add(&twins[c], rgb[c]);
    }
    for (int c = 0; c < 3; c++)
        assert_estimate(&ours[c], mean(&twins[c]), 4 * standard_error(&twins[c]));
    shape_tracer_destroy(tracer);
    sample_end(&scene);
}

/* Two equal balls in one place, of albedo 1 and 0.5, are one of the double extinction and albedo 0.75. */
static void overlapping_clouds_share_collisions(void **state)
{
    (void)state;
    estimate e[2] = {{0, 0, 0}};
    shape_random random = shape_random_seed(4, 1);
    for (int two = 0; two < 2; two++) {
        sample_scene scene = sample_begin(SHAPE_MODEL_UNIFORM, two ? 0.5f : 1);
        sample_add(&scene, 0, 0, 0, 2, 2, 2);
        if (two) {
            shape_frame frame = shape_frame_identity();
            assert_int_equal(shape_set_add_copy(scene.set, 0, &frame, NULL, NULL), SHAPE_OK);
            scene.set->clouds[1].medium.albedo = 0.5f;
        } else {
            scene.set->clouds[0].medium.albedo = 0.75f;
        }
        sample_finish(&scene);
        shape_tracer *tracer = trace(&scene);
        for (int i = 0; i < 30000; i++)
            add(&e[two], shape_tracer_walk(tracer, shape_dvec3_make(0.5, 0, 9), shape_dvec3_make(0, 0, -1),
                                           4096, &random)
                             .weight);
        shape_tracer_destroy(tracer);
        sample_end(&scene);
    }
    assert_estimate(&e[0], mean(&e[1]), 4 * standard_error(&e[1]));
}

/* A thin isotropic ball, once scattered: the integral of sigma / (4 pi) intensity / distance^2 along the ray. */
static void lamp_lights_by_the_square_of_distance(void **state)
{
    (void)state;
    const double sigma = 1e-3;
    sample_scene scene = sample_begin(SHAPE_MODEL_UNIFORM, (float)sigma);
    scene.set->clouds[0].medium.phase = SHAPE_PHASE_ISOTROPIC;
    sample_add(&scene, 0, 0, 0, 2, 2, 2);
    sample_finish(&scene);
    shape_tracer *tracer = trace(&scene);
    shape_light light = sun_only(1);
    shape_pathtrace_options options = shape_pathtrace_defaults();
    light.sun_irradiance[0] = light.sun_irradiance[1] = light.sun_irradiance[2] = 0;
    options.max_bounces = 1;
    options.lamp.position = shape_dvec3_make(0, 1, 0.5);
    options.lamp.intensity[0] = 7;
    shape_random random = shape_random_seed(6, 1);
    estimate e = {0, 0, 0};
    for (int i = 0; i < 500000; i++) {
        double rgb[3];
        shape_pathtrace_radiance(tracer, &light, &options, shape_dvec3_make(0, 0, 9),
                                 shape_dvec3_make(0, 0, -1), &random, rgb);
        add(&e, rgb[0]);
    }
    /* The integral of dz / (1 + (z - 0.5)^2) from -2 to 2. Extinction takes up to 0.6 % (six thousandths of depth). */
    double truth = sigma / (4 * pi) * 7 * (atan(1.5) + atan(2.5));
    assert_estimate(&e, truth, 0.006 * truth);
    shape_tracer_destroy(tracer);
    sample_end(&scene);
}

static bool stop_at_once(void *context, double done)
{
    (void)done;
    ++*(int *)context;
    return false;
}

static void picture_is_the_same_for_any_number_of_threads(void **state)
{
    (void)state;
    enum { W = 24, H = 14, N = 3 * W * H };
    static float one[N], many[N], variance[N], other[N];
    sample_scene scene = sample_cumulus(10, 5);
    shape_tracer *tracer = trace(&scene);
    shape_light light = shape_light_defaults();
    shape_view view = shape_view_defaults();
    shape_pathtrace_options options = shape_pathtrace_defaults();
    shape_pathtrace_result result;
    shape_dvec3 min, max;
    int threads = omp_get_max_threads(), calls = 0;
    view.width = W, view.height = H;
    options.samples = 4;
    assert_true(shape_set_bounds(scene.set, &min, &max));
    shape_view_frame(&view, &light, min, max);
    omp_set_num_threads(1);
    assert_int_equal(shape_pathtrace_render(tracer, &view, &light, &options, one, NULL, &result, NULL),
                     SHAPE_OK);
    omp_set_num_threads(3);
    assert_int_equal(shape_pathtrace_render(tracer, &view, &light, &options, many, variance, &result, NULL),
                     SHAPE_OK);
    omp_set_num_threads(threads);
    assert_memory_equal(one, many, sizeof one);
    for (int i = 0; i < N; i++)
        assert_true(isfinite(one[i]) && one[i] >= 0 && isfinite(variance[i]) && variance[i] >= 0);
    options.seed = 2;
    assert_int_equal(shape_pathtrace_render(tracer, &view, &light, &options, other, NULL, &result, NULL),
                     SHAPE_OK);
    assert_memory_not_equal(one, other, sizeof one);
    options.noise = 0.5;
    options.samples = 100000;
    assert_int_equal(shape_pathtrace_render(tracer, &view, &light, &options, other, NULL, &result, NULL),
                     SHAPE_OK);
    assert_true(result.rel_error <= 0.5 && result.samples < 100000);
    options.progress = stop_at_once;
    options.progress_context = &calls;
    assert_int_equal(shape_pathtrace_render(tracer, &view, &light, &options, other, NULL, &result, NULL),
                     SHAPE_OK);
    assert_true(result.cancelled && calls == 1);
    options.samples = 0;
    assert_int_equal(shape_pathtrace_render(tracer, &view, &light, &options, other, NULL, &result, NULL),
                     SHAPE_ERROR_ARGUMENT);
    shape_tracer_destroy(tracer);
    sample_end(&scene);
}

static bool end_at(void *context, int samples)
{
    return samples < *(const int *)context;
}

/* Ended between two passes and gone on with, a picture is the same to the last bit, and so is its variance. */
static void picture_in_pieces_is_the_same(void **state)
{
    (void)state;
    enum { W = 12, H = 7, N = 3 * W * H };
    float whole[N], whole_variance[N], pieces[N], pieces_variance[N];
    static shape_pathtrace_pixel pixels[W * H];
    sample_scene scene = sample_cumulus(6, 5);
    shape_tracer *tracer = trace(&scene);
    shape_light light = shape_light_defaults();
    shape_view view = shape_view_defaults();
    shape_pathtrace_options options = shape_pathtrace_defaults();
    shape_pathtrace_result result;
    shape_error error;
    shape_dvec3 min, max;
    int end = 20;
    view.width = W, view.height = H;
    options.samples = 70;
    assert_true(shape_set_bounds(scene.set, &min, &max));
    shape_view_frame(&view, &light, min, max);
    assert_int_equal(
        shape_pathtrace_render(tracer, &view, &light, &options, whole, whole_variance, &result, &error),
        SHAPE_OK);
    options.pixels = pixels;
    options.keep = end_at;
    options.keep_context = &end;
    assert_int_equal(
        shape_pathtrace_render(tracer, &view, &light, &options, pieces, pieces_variance, &result, &error),
        SHAPE_OK);
    assert_true(result.cancelled && result.samples >= 20 && result.samples < 70);
    assert_memory_not_equal(whole, pieces, sizeof whole);
    options.samples_before = result.samples;
    options.keep = NULL;
    assert_int_equal(
        shape_pathtrace_render(tracer, &view, &light, &options, pieces, pieces_variance, &result, &error),
        SHAPE_OK);
    assert_int_equal(result.samples, 70);
    assert_memory_equal(whole, pieces, sizeof whole);
    assert_memory_equal(whole_variance, pieces_variance, sizeof whole_variance);
    options.samples_before = 71;
    assert_int_equal(shape_pathtrace_render(tracer, &view, &light, &options, pieces, NULL, &result, &error),
                     SHAPE_ERROR_ARGUMENT);
    options.samples_before = 1;
    options.pixels = NULL;
    assert_int_equal(shape_pathtrace_render(tracer, &view, &light, &options, pieces, NULL, &result, &error),
                     SHAPE_ERROR_ARGUMENT);
    shape_tracer_destroy(tracer);
    sample_end(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slab_reflects_as_the_tables_say),
        cmocka_unit_test(absorbing_slab_as_the_tables_say),
        cmocka_unit_test(single_scattering_of_an_isotropic_slab),
        cmocka_unit_test(camera_sees_the_slabs_radiance),
        cmocka_unit_test(traced_from_the_sun_as_from_the_camera),
        cmocka_unit_test(slab_is_reciprocal),
        cmocka_unit_test(ball_transmits_as_its_closed_form),
        cmocka_unit_test(white_furnace_is_white),
        cmocka_unit_test(agrees_with_the_naive_twin),
        cmocka_unit_test(overlapping_clouds_share_collisions),
        cmocka_unit_test(lamp_lights_by_the_square_of_distance),
        cmocka_unit_test(picture_is_the_same_for_any_number_of_threads),
        cmocka_unit_test(picture_in_pieces_is_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
