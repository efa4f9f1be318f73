/* The viewer's comparison with the reference: an empty sky of radiance 1 has no noise, so that a picture's difference from
 * it is known; a cloud's gets less noisy with the paths; what is not wanted any more ends. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

#include "../viewer/reference.h"
#include "volume_sample.h"

static void no_wake(void) {}

static void nap(void)
{
    const struct timespec pause = {0, 2000000};
    nanosleep(&pause, NULL);
}

static shape_light white_sky(void)
{
    shape_light light = shape_light_defaults();
    light.sky = SHAPE_SKY_CONSTANT;
    for (int i = 0; i < 3; i++) {
        light.sky_radiance[i] = 1;
        light.sun_irradiance[i] = 0;
    }
    return light;
}

static view_reference *start(void)
{
    shape_error error;
    view_reference *reference = view_reference_start(no_wake, &error);
    if (!reference)
        fail_msg("%s", error.text);
    return reference;
}

/* Asks for a comparison of a picture of one brightness with the set under a white sky. The set is taken over. */
static void ask(view_reference *reference, shape_set *set, int width, int height, float brightness,
                uint64_t number)
{
    view_reference_job job = {
        .view = shape_view_defaults(), .light = white_sky(), .seed = 1, .number = number};
    job.placed = view_shared_make(set);
    job.view.width = width, job.view.height = height;
    job.view.eye = shape_dvec3_make(0, 0, 9);
    job.radiance = malloc((size_t)width * (size_t)height * 3 * sizeof *job.radiance);
    assert_non_null(job.radiance);
    for (int i = 0; i < 3 * width * height; i++)
        job.radiance[i] = brightness;
    view_reference_ask(reference, &job);
    view_shared_drop(job.placed);
}

static unsigned char map[VIEW_REFERENCE_PIXELS * 4];

/* Waits, some minutes at most (its threads give way to whatever else runs), for so many paths of a comparison. */
static view_difference wait_for(view_reference *reference, uint64_t number, int paths)
{
    view_difference d = {0};
    for (int i = 0; i < 100000; i++, nap()) {
        view_reference_look(reference, &d, map);
        if (d.text[0])
            fail_msg("%s", d.text);
        if (d.width && d.number == number && d.paths >= paths)
            return d;
    }
    fail_msg("nothing came");
    return d;
}

static void a_known_difference_is_found(void **state)
{
    (void)state;
    view_reference *reference = start();
    static const struct {
        float shown;
        int red, green, blue; /* heat (shown - 1) / (shown + 0.02) / 0.3, doubled, then less 1; of 255 */
    } cases[] = {{1, 0, 0, 0}, {1.1f, 152, 0, 0}, {0.9f, 0, 0, 185}, {3, 255, 255, 0}, {0.25f, 0, 255, 255}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double shown = (double)cases[i].shown;
        ask(reference, new_set(), 8, 5, cases[i].shown, i + 1);
        view_difference d = wait_for(reference, i + 1, 4);
        assert_true(d.width == 8 && d.height == 5 && d.noise < 1e-6);
        assert_float_equal(d.off, fabs(shown - 1) / sqrt(shown * shown + 0.01), 1e-5);
        for (int k = 0; k < 8 * 5; k++) {
            assert_true(abs(map[4 * k] - cases[i].red) <= 1 && abs(map[4 * k + 1] - cases[i].green) <= 1);
            assert_true(abs(map[4 * k + 2] - cases[i].blue) <= 1 && map[4 * k + 3] == 255);
        }
    }
    view_reference_stop(reference);
}

static shape_set *new_ball(void)
{
    shape_set *set = new_set();
    shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_UNIFORM);
    cloud->medium.extinction = 2;
    cloud->medium.albedo = 0.5f; /* 1 would be as bright as the sky, without noise */
    add_sphere(set, 0, 0, 0, 0, 2);
    return set;
}

/* The noise of a mean falls as the root of the paths; that of the noise's own estimate is below a tenth here. */
static void passes_become_finer(void **state)
{
    (void)state;
    view_reference *reference = start();
    ask(reference, new_ball(), 12, 8, 1, 1);
    view_difference first = wait_for(reference, 1, 4);
    view_difference later = wait_for(reference, 1, 8 * first.paths);
    double ratio = later.noise / first.noise / sqrt((double)first.paths / later.paths);
    print_message("%d paths: %.4f, %d paths: %.4f\n", first.paths, first.noise, later.paths, later.noise);
    assert_true(first.noise > 0 && ratio > 0.75 && ratio < 1.33);
    view_reference_stop(reference);
}

/* A comparison that would take minutes gives way to another, to a cancellation and to the end. */
static void what_is_not_wanted_ends(void **state)
{
    (void)state;
    view_reference *reference = start();
    ask(reference, new_ball(), 128, 128, 1, 1);
    nap();
    ask(reference, new_set(), 4, 4, 1, 2);
    view_difference d = wait_for(reference, 2, 8);
    assert_int_equal(d.width, 4);
    ask(reference, new_ball(), 128, 128, 1, 3);
    nap();
    view_reference_cancel(reference);
    for (int i = 0; i < 100; i++, nap()) {
        view_reference_look(reference, &d, map);
        assert_int_equal(d.width, 0);
    }
    ask(reference, new_ball(), 128, 128, 1, 4);
    view_reference_stop(reference);
}

/* The small view is the middle of the large one: its pixels are means of whole ones, seen in the same directions. */
static void the_small_picture_is_the_large_one(void **state)
{
    (void)state;
    static const int sizes[][2] = {{640, 360}, {1, 1},       {1, 16384},    {16384, 1},
                                   {129, 128}, {1999, 1001}, {16384, 16384}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        shape_view view = shape_view_defaults();
        view.width = sizes[i][0], view.height = sizes[i][1];
        int by = view_reference_scale(view.width, view.height);
        shape_view small = view_reference_view(&view);
        assert_true(small.width >= 1 && small.height >= 1 &&
                    small.width * small.height <= VIEW_REFERENCE_PIXELS);
        assert_true(small.width * by <= view.width && small.height * by <= view.height);
        assert_true(tan(small.fov / 360 * 3.14159265358979) <=
                    tan(view.fov / 360 * 3.14159265358979) * 1.0000001);
        shape_camera a = shape_view_camera(&view), b = shape_view_camera(&small);
        double left = (view.width - small.width * by) / 2.0, top = (view.height - small.height * by) / 2.0;
        shape_dvec3 p = shape_camera_direction(&a, &view, left + by / 2.0, top + by / 2.0);
        shape_dvec3 q = shape_camera_direction(&b, &small, 0.5, 0.5);
        assert_float_equal(shape_dvec3_length(shape_dvec3_sub(p, q)), 0, 1e-9);
    }
    enum { WIDTH = 200, HEIGHT = 150, BY = 2 };
    float *rgba = malloc(WIDTH * HEIGHT * 4 * sizeof *rgba);
    assert_non_null(rgba);
    assert_int_equal(view_reference_scale(WIDTH, HEIGHT), BY);
    for (int i = 0; i < WIDTH * HEIGHT * 4; i++)
        rgba[i] = (float)(i % 4 + 10 * (i / 4 % WIDTH) + 10000 * (i / 4 / WIDTH));
    float *small = view_reference_reduce(rgba, WIDTH, HEIGHT);
    assert_non_null(small);
    for (int y = 0; y < HEIGHT / BY; y++)
        for (int x = 0; x < WIDTH / BY; x++)
            for (int c = 0; c < 3; c++)
                assert_float_equal((double)small[3 * (y * (WIDTH / BY) + x) + c],
                                   c + 10 * (2 * x + 0.5) + 10000 * (2 * y + 0.5), 0.1);
    free(rgba);
    free(small);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_known_difference_is_found), cmocka_unit_test(passes_become_finer),
        cmocka_unit_test(what_is_not_wanted_ends), cmocka_unit_test(the_small_picture_is_the_large_one)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
