/* Random streams and elementary functions (shape/random.h): held to published values, to the C library and to the
 * moments that theory gives; first values frozen, since files depend on them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "shape/random.h"

typedef double (*function)(double);
typedef long double (*reference)(long double);

/* |got - want| in units of the last place of a double at want. */
static double ulps(double got, long double want)
{
    if (got == (double)want)
        return 0;
    double unit = nextafter(fabs((double)want), INFINITY) - fabs((double)want);
    return (double)(fabsl((long double)got - want) / (long double)unit);
}

/* The largest error over n points drawn from low to high, and the point. */
static double worst(function f, reference g, double low, double high, int n)
{
    shape_random random = shape_random_seed(2024, (uint64_t)n);
    double largest = 0;
    for (int i = 0; i < n; i++) {
        double x = i == 0 ? low : i == 1 ? high : shape_random_range(&random, low, high);
        double error = ulps(f(x), g((long double)x));
        if (!(error <= largest))
            largest = error;
    }
    return largest;
}

static void expect_within(const char *name, double error, double allowed)
{
    if (!(error <= allowed))
        fail_msg("%s is wrong by %g units in the last place, %g are allowed", name, error, allowed);
}

/* Two units in the last place are what the header promises; the references carry 11 bits more (x86-64), or 60. */
static void exp_and_log_are_within_two_units(void **state)
{
    (void)state;
    expect_within("exp near 0", worst(shape_exp, expl, -1, 1, 200000), 2);
    expect_within("exp", worst(shape_exp, expl, -700, 700, 200000), 2);
    expect_within("log near 1", worst(shape_log, logl, 0.5, 2, 200000), 2);
    expect_within("log very near 1", worst(shape_log, logl, 1 - 1e-6, 1 + 1e-6, 100000), 2);
    expect_within("log", worst(shape_log, logl, 1e-300, 1e-290, 50000), 2);
    expect_within("log of large", worst(shape_log, logl, 1, 1e300, 50000), 2);
    expect_within("log of subnormal", worst(shape_log, logl, 5e-324, 1e-310, 50000), 2);
}

static void sin_and_cos_are_within_two_units(void **state)
{
    (void)state;
    const double limits[] = {0.8, 7, 100, 1e5};
    for (int i = 0; i < 4; i++) {
        expect_within("sin", worst(shape_sin, sinl, -limits[i], limits[i], 200000), 2);
        expect_within("cos", worst(shape_cos, cosl, -limits[i], limits[i], 200000), 2);
    }
    expect_within("sin of little", worst(shape_sin, sinl, -1e-5, 1e-5, 100000), 2);
    /* the doubles nearest to multiples of a quarter turn, where the leading digits cancel */
    for (int k = -63000; k <= 63000; k++) {
        double x = k * 1.5707963267948966;
        expect_within("sin at a quarter turn", ulps(shape_sin(x), sinl((long double)x)), 2);
        expect_within("cos at a quarter turn", ulps(shape_cos(x), cosl((long double)x)), 2);
    }
}

/* A relative 2^-53, at most a unit, is lost by the reciprocal, by each product, and again by each squaring of what was
 * lost before: no more than 2 |y| in all. Without a whole y, the rounding of log x and of its product with y, at most
 * 2 * 2^-53 of y log x, becomes a relative error of the result, that is at most 2 |y log x| units, beside exp's own 2. */
static void pow_is_as_exact_as_its_logarithm(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(9, 9);
    for (int i = 0; i < 200000; i++) {
        double x = shape_random_range(&random, 0.01, 30), y = shape_random_range(&random, -20, 20);
        if (i % 4 == 0)
            y = floor(y);
        double allowed = y == floor(y) ? 2 * fabs(y) + 1 : 2 + 2 * fabs(y * log(x));
        expect_within("pow", ulps(shape_pow(x, y), powl((long double)x, (long double)y)), allowed);
    }
    assert_true(shape_pow(3, 4) == 81 && shape_pow(-2, 3) == -8 && shape_pow(2, -2) == 0.25);
    assert_true(shape_pow(0, 0) == 1 && shape_pow(0, 2.5) == 0 && shape_pow(5, 0) == 1);
}

static void edges_of_the_functions(void **state)
{
    (void)state;
    assert_true(shape_exp(0) == 1 && shape_exp(710) == INFINITY && shape_exp(-746) == 0);
    assert_true(shape_exp(-INFINITY) == 0 && shape_exp(INFINITY) == INFINITY && isnan(shape_exp(NAN)));
    assert_true(shape_exp(709.78) < INFINITY && shape_exp(-745) > 0);
    assert_true(shape_log(1) == 0 && shape_log(0) == -INFINITY && isnan(shape_log(-1)) &&
                isnan(shape_log(NAN)));
    assert_true(shape_log(INFINITY) == INFINITY && shape_log(DBL_MAX) < 710);
    assert_true(shape_sin(0) == 0 && shape_cos(0) == 1 && isnan(shape_sin(INFINITY)) &&
                isnan(shape_cos(NAN)));
}

/* The first numbers of pcg32-demo (O'Neill, pcg-random.org), which seeds with state 42, sequence 54. */
static void the_generator_is_pcg32(void **state)
{
    (void)state;
    const uint32_t published[6] = {0xa15c02b7, 0x7b47f409, 0xba1d3330, 0x83d2f293, 0xbfa4784b, 0xcbed606e};
    shape_random random = {0, 54 << 1 | 1};
    shape_random_u32(&random);
    random.state += 42;
    shape_random_u32(&random);
    for (int i = 0; i < 6; i++)
        assert_int_equal(shape_random_u32(&random), published[i]);
    /* and the hash is splitmix64: its first outputs from the seeds 0 and 1234567 (Vigna's reference) */
    assert_true(shape_hash(0) == UINT64_C(0xe220a8397b1dcdaf));
    assert_true(shape_hash(1234567) == UINT64_C(6457827717110365317));
}

/* Files made by generators rest on these: the same on every machine, with every compiler, for ever. */
static void first_values_are_frozen(void **state)
{
    (void)state;
    const uint32_t words[4] = {0x6167a336, 0xd7851a61, 0xb1156a02, 0xc71571df};
    shape_random random = shape_random_seed(1, 0);
    for (int i = 0; i < 4; i++)
        assert_int_equal(shape_random_u32(&random), words[i]);
    random = shape_random_seed(UINT64_MAX, 3);
    assert_int_equal(shape_random_u32(&random), 0x2021854a);
    assert_int_equal(shape_random_u32(&random), 0x90bda344);
    random = shape_random_seed(1, 0);
    assert_true(shape_random_unit(&random) == 0x1.859e8cdb5e146p-2);
    random = shape_random_seed(1, 0);
    const double normals[3] = {-0x1.e2c838433ed73p-1, -0x1.6afe7fb14a1cdp+0, -0x1.33c6fee549bb7p+1};
    for (int i = 0; i < 3; i++)
        assert_true(shape_random_normal(&random) == normals[i]);
    assert_true(shape_exp(1.25) == 0x1.bec38edb0fafp+1 && shape_log(10) == 0x1.26bb1bbb55516p+1);
    assert_true(shape_sin(2.5) == 0x1.326af0dcfcabp-1 && shape_cos(1e4) == -0x1.e780e88ec4409p-1);
    assert_true(shape_pow(2.5, 0.3) == 0x1.50fe6c94a6e58p+0);
}

static void uniform_numbers_have_the_moments_of_theory(void **state)
{
    (void)state;
    enum { N = 1000000 };
    shape_random random = shape_random_seed(1, 0);
    double sum = 0, squares = 0, products = 0, before = 0.5;
    for (int i = 0; i < N; i++) {
        double u = shape_random_unit(&random);
        assert_true(u >= 0 && u < 1);
        sum += u - 0.5;
        squares += (u - 0.5) * (u - 0.5);
        products += (u - 0.5) * (before - 0.5);
        before = u;
    }
    /* five standard deviations of each mean: sqrt(1/12/N), sqrt((1/80 - 1/144)/N), 1/12/sqrt(N) */
    assert_true(fabs(sum / N) < 1.5e-3);
    assert_true(fabs(squares / N - 1.0 / 12) < 4e-4);
    assert_true(fabs(products / N) < 4.2e-4);
}

static void normal_numbers_have_the_moments_of_theory(void **state)
{
    (void)state;
    enum { N = 1000000 };
    shape_random random = shape_random_seed(1, 0);
    double moments[5] = {0};
    for (int i = 0; i < N; i++) {
        double x = shape_random_normal(&random), power = 1;
        for (int k = 1; k < 5; k++)
            moments[k] += (power *= x) / N;
    }
    /* five standard deviations: sqrt(1/N), sqrt(2/N), sqrt(15/N), sqrt(96/N) */
    assert_true(fabs(moments[1]) < 5e-3);
    assert_true(fabs(moments[2] - 1) < 7.1e-3);
    assert_true(fabs(moments[3]) < 2e-2);
    assert_true(fabs(moments[4] - 3) < 4.9e-2);
}

/* First numbers of neighbouring seeds and of neighbouring streams: no trend, no likeness. */
static void neighbouring_streams_are_independent(void **state)
{
    (void)state;
    enum { N = 100000 };
    for (int kind = 0; kind < 2; kind++) {
        double sum = 0, squares = 0, products = 0, before = 0;
        for (uint64_t i = 0; i < N; i++) {
            shape_random random = kind ? shape_random_seed(1, i) : shape_random_seed(i, 1);
            double u = shape_random_unit(&random) - 0.5;
            sum += u;
            squares += u * u;
            products += u * before;
            before = u;
        }
        assert_true(fabs(sum / N) < 4.6e-3); /* five standard deviations, as above */
        assert_true(fabs(squares / N - 1.0 / 12) < 1.2e-3);
        assert_true(fabs(products / N) < 1.4e-3);
    }
}

static void ranges_hold_their_ends(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(3, 3), copy = random;
    for (int i = 0; i < 100000; i++) {
        double x = shape_random_range(&random, 0.8, 1.0);
        assert_true(x >= 0.8 && x < 1.0);
        assert_true(shape_random_range(&random, 7, 7) == 7);
        /* a copy goes the same way: each range took one draw of 64 bits */
        shape_random_unit(&copy);
        shape_random_unit(&copy);
    }
    assert_int_equal(shape_random_u32(&random), shape_random_u32(&copy));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exp_and_log_are_within_two_units),
        cmocka_unit_test(sin_and_cos_are_within_two_units),
        cmocka_unit_test(pow_is_as_exact_as_its_logarithm),
        cmocka_unit_test(edges_of_the_functions),
        cmocka_unit_test(the_generator_is_pcg32),
        cmocka_unit_test(first_values_are_frozen),
        cmocka_unit_test(uniform_numbers_have_the_moments_of_theory),
        cmocka_unit_test(normal_numbers_have_the_moments_of_theory),
        cmocka_unit_test(neighbouring_streams_are_independent),
        cmocka_unit_test(ranges_hold_their_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
