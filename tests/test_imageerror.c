/* Image errors against closed forms. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "shape/imageerror.h"

#define assert_near(a, b, e) assert_true(fabs((double)(a) - (double)(b)) <= (e))

enum { W = 7, H = 5, N = W * H * 3 };

/* Some picture with values from 0 to about 2. */
static void fill(float *values, unsigned seed)
{
    for (int i = 0; i < N; i++) {
        seed = seed * 1664525u + 1013904223u;
        values[i] = (float)(seed >> 8) * 0x1p-23f;
    }
}

static void equal_pictures_have_no_error(void **state)
{
    (void)state;
    float a[N];
    shape_imageerror e;
    fill(a, 1);
    assert_int_equal(shape_imageerror_measure(a, a, W, H, &e, NULL), SHAPE_OK);
    assert_true(e.rmse == 0 && e.relmse == 0 && e.largest == 0 && e.exposure == 1 && e.exposed_relmse == 0);
}

/* Constant pictures: all sums have one term, so only rounding in double is allowed for. */
static void constants_give_closed_forms(void **state)
{
    (void)state;
    float a[N], b[N];
    shape_imageerror e;
    for (int i = 0; i < N; i++) {
        a[i] = 0.75f;
        b[i] = 0.5f;
    }
    assert_int_equal(shape_imageerror_measure(a, b, W, H, &e, NULL), SHAPE_OK);
    assert_near(e.rmse, 0.25, 1e-12);
    assert_near(e.relmse, 0.0625 / (0.25 + 1e-2), 1e-12);
    assert_near(e.exposure, 0.5 / 0.75, 1e-12);
    assert_near(e.exposed_relmse, 0, 1e-12);
    for (int c = 0; c < 3; c++) {
        assert_near(e.mean_a[c], 0.75, 1e-12);
        assert_near(e.mean_b[c], 0.5, 1e-12);
    }
}

static void the_largest_is_found_where_it_is(void **state)
{
    (void)state;
    float a[N], b[N];
    shape_imageerror e;
    fill(a, 2);
    memcpy(b, a, sizeof a);
    int x = 4, y = 3, channel = 2;
    a[(y * W + x) * 3 + channel] += 8;
    a[5] += 4;
    assert_int_equal(shape_imageerror_measure(a, b, W, H, &e, NULL), SHAPE_OK);
    assert_true(e.x == x && e.y == y && e.channel == channel);
    assert_near(e.largest, 8, 1e-6); /* float's rounding of a value below 16 */
    assert_near(e.rmse, sqrt(80.0 / N), 1e-6);
}

/* The fitted exposure is where the derivative vanishes: a little more or less is worse. */
static void the_exposure_is_the_best(void **state)
{
    (void)state;
    float a[N], b[N], scaled[N];
    shape_imageerror e, near;
    fill(a, 3);
    fill(b, 4);
    assert_int_equal(shape_imageerror_measure(a, b, W, H, &e, NULL), SHAPE_OK);
    assert_true(e.exposed_relmse < e.relmse);
    for (int side = -1; side <= 1; side += 2) {
        for (int i = 0; i < N; i++)
            scaled[i] = (float)(a[i] * e.exposure * (1 + 0.01 * side));
        assert_int_equal(shape_imageerror_measure(scaled, b, W, H, &near, NULL), SHAPE_OK);
        assert_true(near.relmse > e.exposed_relmse);
        assert_near(near.exposure, 1 / (1 + 0.01 * side), 1e-6); /* rounding of `scaled` to float */
    }
    memset(a, 0, sizeof a);
    assert_int_equal(shape_imageerror_measure(a, b, W, H, &e, NULL), SHAPE_OK);
    assert_true(e.exposure == 0 && e.exposed_relmse == e.relmse);
}

static void bad_values_are_named(void **state)
{
    (void)state;
    float a[N], b[N], heat[N];
    shape_imageerror e = {.x = 77};
    shape_error error;
    fill(a, 5);
    fill(b, 6);
    b[(2 * W + 6) * 3 + 1] = NAN;
    assert_int_equal(shape_imageerror_measure(a, b, W, H, &e, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "second picture"));
    assert_non_null(strstr(error.text, "x 6, y 2 (green)"));
    assert_int_equal(e.x, 77);
    assert_int_equal(shape_imageerror_map(a, b, W, H, 1, heat, &error), SHAPE_ERROR_ARGUMENT);
    fill(b, 6);
    a[0] = INFINITY;
    assert_int_equal(shape_imageerror_measure(a, b, W, H, &e, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "first picture holds inf at x 0, y 0 (red)"));
    fill(a, 5);
    assert_int_equal(shape_imageerror_measure(a, b, 0, H, &e, &error), SHAPE_ERROR_ARGUMENT);
    assert_int_equal(shape_imageerror_map(a, b, W, H, 0, heat, &error), SHAPE_ERROR_ARGUMENT);
}

/* Black at a thousandth of full, white at full, and brighter for a larger error in between. */
static void the_heat_map_rises_with_the_error(void **state)
{
    (void)state;
    float a[N], b[N], heat[N];
    double before = -1;
    for (int i = 0; i < W * H; i++)
        for (int c = 0; c < 3; c++) {
            b[3 * i + c] = 1;
            a[3 * i + c] = 1 + (float)pow(10, -3.5 + 4.0 * i / (W * H - 1));
        }
    assert_int_equal(shape_imageerror_map(a, b, W, H, 1, heat, NULL), SHAPE_OK);
    for (int i = 0; i < W * H; i++) {
        const float *h = heat + 3 * i;
        double luminance = 0.2126 * h[0] + 0.7152 * h[1] + 0.0722 * h[2];
        double e = (a[3 * i] - 1.0) / sqrt(1.01);
        for (int c = 0; c < 3; c++)
            assert_true(h[c] >= 0 && h[c] <= 1);
        if (e <= 1e-3)
            assert_true(luminance == 0);
        else if (e < 1)
            assert_true(luminance > before);
        else
            assert_true(h[0] == 1 && h[1] == 1 && h[2] == 1);
        before = luminance;
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_pictures_have_no_error),
        cmocka_unit_test(constants_give_closed_forms),
        cmocka_unit_test(the_largest_is_found_where_it_is),
        cmocka_unit_test(the_exposure_is_the_best),
        cmocka_unit_test(bad_values_are_named),
        cmocka_unit_test(the_heat_map_rises_with_the_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
