/* Clouds in time: what stands still, what moves how far, and that nothing jumps; the sun's way over a day. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "shape/day.h"
#include "shape/motion.h"
#include "shape/neph.h"
#include "shape/volume.h"

/* A heap of spheres and an ellipsoid in a placed, turned frame, and a copy of it. */
static shape_set *sample_set(void)
{
    shape_error error;
    shape_set *set = shape_set_create(&error);
    shape_set_add_cloud(set, "a", NULL, &error);
    for (int i = 0; i < 40; i++) {
        shape_sphere s = {(float)(i % 5), (float)(i / 5), (float)(i % 3), 0.8f};
        assert_int_equal(shape_primitives_add_sphere(shape_set_list(set, 0), s, &error), SHAPE_OK);
    }
    shape_ellipsoid e = {1, 2, 3, 0, 2, 1, 0.5f, 0, {0, 0, 0, 1}};
    assert_int_equal(shape_primitives_add_ellipsoid(shape_set_list(set, 0), e, &error), SHAPE_OK);
    set->clouds[0].field.noise_scale = 0.25f;
    /* A quarter turn about y: x goes to -z. */
    static const shape_frame turned = {{{0, 0, 1, 10}, {0, 1, 0, 20}, {-1, 0, 0, 30}}};
    set->clouds[0].frame = turned;
    shape_frame copy = turned;
    copy.m[0][3] += 50;
    shape_set_add_copy(set, 0, &copy, NULL, &error);
    return set;
}

static shape_set *move(const shape_set *set, const shape_motion *motion, double time)
{
    shape_error error;
    shape_set *moved = NULL;
    assert_int_equal(shape_motion_apply(set, motion, time, &moved, &error), SHAPE_OK);
    assert_int_equal(shape_set_check(moved, &error), SHAPE_OK);
    return moved;
}

static void same_bytes(const shape_set *a, const shape_set *b, bool same)
{
    shape_error error;
    unsigned char *x, *y;
    size_t n, m;
    assert_int_equal(shape_neph_encode(a, &x, &n, &error), SHAPE_OK);
    assert_int_equal(shape_neph_encode(b, &y, &m, &error), SHAPE_OK);
    assert_int_equal(n == m && !memcmp(x, y, n), same);
    free(x);
    free(y);
}

static void nothing_moves_without_motion_or_time(void **state)
{
    (void)state;
    shape_set *set = sample_set();
    shape_motion none = {0}, all = {.wind = {1, 2, 3}, .shear = 0.1, .drift = {1, 0, 0}};
    assert_false(shape_motion_is_on(&none));
    assert_true(shape_motion_is_on(&all));
    shape_set *later = move(set, &none, 1234.5), *now = move(set, &all, 0);
    same_bytes(set, later, true);
    same_bytes(set, now, true);
    shape_set_destroy(later);
    shape_set_destroy(now);
    shape_set_destroy(set);
}

static void a_moment_is_the_same_every_time(void **state)
{
    (void)state;
    shape_set *set = sample_set();
    shape_motion motion = {
        .wind = {1, 0, 2}, .shear = 0.1, .drift = {0, 1, 0}, .life = 7, .grow = 3, .seed = 5};
    shape_set *a = move(set, &motion, 11.25), *between = move(set, &motion, 2),
              *b = move(set, &motion, 11.25);
    same_bytes(a, b, true);
    same_bytes(a, between, false);
    motion.seed = 6;
    shape_set *c = move(set, &motion, 11.25);
    same_bytes(a, c, false);
    shape_set_destroy(a);
    shape_set_destroy(b);
    shape_set_destroy(c);
    shape_set_destroy(between);
    shape_set_destroy(set);
}

/* Extinction at p now is what it was where the wind came from. Frames are in double precision and the noise's lattice
 * values are whole, so only the rounding of points to single precision (1e-7 of 60 m) separates the two: with the
 * noise's slope of 1 / 0.25 m at most 2 * 6e-6 / 0.25 m of density, over steps at the edges looked over. */
static void wind_carries_shape_and_noise(void **state)
{
    (void)state;
    shape_error error;
    shape_set *set = sample_set();
    shape_motion motion = {.wind = {3, 0, -1}};
    shape_set *moved = move(set, &motion, 8);
    shape_volume *before, *after;
    assert_int_equal(shape_volume_create(set, &before, &error), SHAPE_OK);
    assert_int_equal(shape_volume_create(moved, &after, &error), SHAPE_OK);
    int full = 0, unlike = 0;
    for (int i = 0; i < 4000; i++) {
        shape_dvec3 p = {10 + 0.01 * (i % 61) * 5, 20 + 0.11 * (i % 67), 30 - 0.09 * (i % 47)};
        shape_dvec3 q = shape_dvec3_add(p, shape_dvec3_make(24, 0, -8));
        double x = shape_volume_extinction(before, p), y = shape_volume_extinction(after, q);
        full += x > 0;
        unlike += fabs(x - y) > 1e-3;
    }
    assert_true(full > 400);
    assert_true(unlike <= full / 100); /* points on the edge of Eq. 2's step fall to the other side */
    shape_volume_destroy(before);
    shape_volume_destroy(after);
    shape_set_destroy(moved);
    shape_set_destroy(set);
}

/* Shear leaves the base where it is and moves a point h above it by shear * time * h. */
static void shear_grows_with_height(void **state)
{
    (void)state;
    shape_set *set = sample_set();
    shape_dvec3 min, max;
    shape_set_bounds(set, &min, &max);
    shape_motion motion = {.wind = {0, 0, 2}, .shear = 0.05};
    shape_set *moved = move(set, &motion, 4);
    for (double y = 0; y < 8; y += 0.5) {
        shape_dvec3 p = {1, y, -2}, a = shape_frame_point(&set->clouds[1].frame, p),
                    b = shape_frame_point(&moved->clouds[1].frame, p);
        assert_float_equal(b.z - a.z, 2 * 4 + 0.05 * 4 * (a.y - min.y), 1e-5); /* cmocka compares floats */
        assert_float_equal(b.x, a.x, 1e-9);
        assert_float_equal(b.y, a.y, 1e-9);
    }
    assert_int_equal(moved->clouds[0].list, moved->clouds[1].list); /* copies still share */
    shape_set_destroy(moved);
    shape_set_destroy(set);
}

/* The noise drifts and the shape stays: the world's bounds are what they were, and after 64 cells along an axis of the
 * noise everything is. */
static void drift_moves_the_noise_alone(void **state)
{
    (void)state;
    shape_set *set = sample_set();
    shape_motion motion = {.drift = {0, 0.5, 0}};
    double period = 64 * 0.25 / 0.5; /* the frame's y is the world's */
    shape_dvec3 min, max, low, high;
    shape_set_bounds(set, &min, &max);
    shape_set *moved = move(set, &motion, 5), *round = move(set, &motion, period);
    shape_set_bounds(moved, &low, &high);
    assert_float_equal(shape_dvec3_length(shape_dvec3_sub(low, min)), 0, 1e-5);
    assert_float_equal(shape_dvec3_length(shape_dvec3_sub(high, max)), 0, 1e-5);
    assert_float_equal(moved->clouds[0].frame.m[1][3], 22.5, 1e-12);
    same_bytes(set, round, true);
    shape_set_destroy(moved);
    shape_set_destroy(round);
    shape_set_destroy(set);
}

static double total_volume(const shape_set *set)
{
    const shape_primitives *list = shape_set_list_const(set, 0);
    double sum = 0;
    for (size_t i = 0; i < list->sphere_count; i++)
        sum += pow((double)list->spheres[i].radius, 3);
    return sum;
}

/* Births lie evenly, so the cloud's volume stays near its mean, the mean of size^3 over a life: 1/2 + 2/4 of the integral
 * of s(x)^3 with s = x^2 (3 - 2x), which is 0.3409; so 0.670. 40 phases a golden ratio apart leave a few percent. */
static void lives_follow_each_other_without_jumps(void **state)
{
    (void)state;
    shape_set *set = sample_set();
    shape_motion motion = {.life = 10, .shear = 0.02};
    double full = total_volume(set), last = -1;
    for (int i = 0; i <= 400; i++) {
        shape_set *moved = move(set, &motion, 0.05 * i);
        double share = total_volume(moved) / full;
        assert_in_range((int)(100 * share), 60, 74);
        /* In 0.05 s, 1/200 of a life, a size changes by 4 * 1.5 / 200 at most, a volume by three times that, and only
         * half of all do. */
        if (last >= 0)
            assert_true(fabs(share - last) < 3 * 4 * 1.5 / 200 / 2);
        last = share;
        shape_set_destroy(moved);
    }
    /* A life later all is as before. */
    shape_set *a = move(set, &motion, 2.5), *b = move(set, &motion, 12.5);
    assert_float_equal(total_volume(a), total_volume(b), 1e-5 * full);
    shape_set_destroy(a);
    shape_set_destroy(b);
    shape_set_destroy(set);
}

static void growth_begins_at_the_base_and_decay_ends_all(void **state)
{
    (void)state;
    shape_set *set = sample_set();
    shape_motion motion = {.grow = 10, .decay_start = 20, .decay = 5};
    shape_dvec3 min, max, low, high;
    shape_set_bounds(set, &min, &max);
    shape_set *start = move(set, &motion, 0), *early = move(set, &motion, 3), *grown = move(set, &motion, 15),
              *gone = move(set, &motion, 25);
    assert_false(shape_set_bounds(start, &low, &high));
    assert_true(shape_set_bounds(early, &low, &high));
    assert_true(high.y < min.y + 0.6 * (max.y - min.y) && low.y < min.y + 0.1 * (max.y - min.y));
    same_bytes(set, grown, true);
    assert_false(shape_set_bounds(gone, &low, &high));
    shape_set_destroy(start);
    shape_set_destroy(early);
    shape_set_destroy(grown);
    shape_set_destroy(gone);
    shape_set_destroy(set);
}

static void wrong_motions_are_refused(void **state)
{
    (void)state;
    shape_error error;
    shape_set *set = sample_set(), *moved;
    const shape_motion wrong[] = {{.wind = {0, NAN, 0}}, {.shear = 11},          {.life = -1},
                                  {.grow = INFINITY},    {.drift = {1e9, 0, 0}}, {.decay = -1}};
    static const char *const names[] = {"wind", "shear", "life", "grow", "drift", "decay"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_int_equal(shape_motion_apply(set, &wrong[i], 1, &moved, &error), SHAPE_ERROR_ARGUMENT);
        assert_non_null(strstr(error.text, names[i]));
    }
    shape_motion none = {0};
    assert_int_equal(shape_motion_apply(set, &none, NAN, &moved, &error), SHAPE_ERROR_ARGUMENT);
    shape_set_destroy(set);
}

/* At an equinox the sun rises in the east at 6, stands 90 - latitude high in the south at 12, sets in the west. In June
 * at 50 degrees it is up at 5 already. */
static void the_sun_goes_round(void **state)
{
    (void)state;
    double azimuth, height;
    shape_day day = {6, 50, 0};
    shape_day_sun(&day, &azimuth, &height);
    assert_float_equal(azimuth, 90, 1e-9);
    assert_float_equal(height, 0, 1e-9);
    day.hour = 12 + 24 * 3;
    shape_day_sun(&day, &azimuth, &height);
    assert_float_equal(azimuth, 0, 1e-9);
    assert_float_equal(height, 40, 1e-9);
    day.hour = 18;
    shape_day_sun(&day, &azimuth, &height);
    assert_float_equal(azimuth, -90, 1e-9);
    day.hour = 0;
    shape_day_sun(&day, &azimuth, &height);
    assert_float_equal(height, -40, 1e-9);
    day.hour = 5;
    day.declination = 23.44;
    shape_day_sun(&day, &azimuth, &height);
    assert_true(height > 5 && azimuth > 90);
}

static void a_low_sun_is_red_and_a_set_sun_dark(void **state)
{
    (void)state;
    float rgb[3], last[3] = {0, 0, 0};
    shape_day_transmittance(40, rgb);
    for (int i = 0; i < 3; i++)
        assert_float_equal(rgb[i], 1, 1e-6);
    for (double height = -1; height < 90; height += 0.5) {
        shape_day_transmittance(height, rgb);
        for (int i = 0; i < 3; i++) {
            assert_true(rgb[i] >= last[i]);
            last[i] = rgb[i];
        }
        assert_true(height >= 40 || (rgb[0] >= rgb[1] && rgb[1] >= rgb[2]));
        assert_true(height > -0.833 || rgb[0] == 0);
    }
    shape_light light = shape_light_defaults();
    shape_day day = {0, 50, 0};
    shape_day_apply(&day, &light);
    assert_true(light.sun_irradiance[0] == 0 && light.sun.y < 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_moves_without_motion_or_time),
        cmocka_unit_test(a_moment_is_the_same_every_time),
        cmocka_unit_test(wind_carries_shape_and_noise),
        cmocka_unit_test(shear_grows_with_height),
        cmocka_unit_test(drift_moves_the_noise_alone),
        cmocka_unit_test(lives_follow_each_other_without_jumps),
        cmocka_unit_test(growth_begins_at_the_base_and_decay_ends_all),
        cmocka_unit_test(wrong_motions_are_refused),
        cmocka_unit_test(the_sun_goes_round),
        cmocka_unit_test(a_low_sun_is_red_and_a_set_sun_dark),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
