/* Perlin's and Worley's noise, beside the lattice: range, mean, tiling, spectrum, the law of the nearest point. What a
 * sample's mean may be off follows from its own spread (5 standard errors; samples are cells apart). */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "shape/noise.h"
#include "shape/random.h"

enum { KEY = 12345 };

/* A place with a fraction of 1/1024, so that adding the period to it is exact. */
static shape_vec3 draw_place(shape_random *random, double half)
{
    float q[3];
    for (int i = 0; i < 3; i++)
        q[i] = (float)(floor(shape_random_range(random, -half, half) * 1024) / 1024);
    return shape_vec3_make(q[0], q[1], q[2]);
}

typedef struct moments {
    double mean, deviation, low, high;
} moments;

static float perlin(shape_vec3 q)
{
    return shape_noise_perlin(q, KEY);
}
static float perlin_y(shape_vec3 q)
{
    return shape_noise_perlin3(q, KEY).y;
}
static float perlin_z(shape_vec3 q)
{
    return shape_noise_perlin3(q, KEY).z;
}
static float perlin_fbm(shape_vec3 q)
{
    return shape_noise_perlin_fbm(q, 5, KEY);
}
static float worley(shape_vec3 q)
{
    return shape_noise_worley(q, KEY);
}
static float worley_fbm(shape_vec3 q)
{
    return shape_noise_worley_fbm(q, 3, KEY);
}

static moments measure(float (*noise)(shape_vec3), int count)
{
    shape_random random = shape_random_seed(5, 1);
    moments m = {0, 0, INFINITY, -INFINITY};
    for (int i = 0; i < count; i++) {
        double v = (double)noise(draw_place(&random, 500));
        m.mean += v;
        m.deviation += v * v;
        m.low = fmin(m.low, v);
        m.high = fmax(m.high, v);
    }
    m.mean /= count;
    m.deviation = sqrt(m.deviation / count - m.mean * m.mean);
    return m;
}

static void gradient_noise_is_centred_and_bounded(void **state)
{
    (void)state;
    enum { COUNT = 100000 };
    float (*const noises[])(shape_vec3) = {perlin, perlin_y, perlin_z, perlin_fbm};
    for (size_t i = 0; i < sizeof noises / sizeof *noises; i++) {
        moments m = measure(noises[i], COUNT);
        assert_true(m.low >= -1 && m.high <= 1);
        assert_true(fabs(m.mean) <= 5 * m.deviation / sqrt(COUNT));
        assert_true(m.deviation > 0.1 && m.high > 0.5 && m.low < -0.5); /* it uses its range */
    }
    shape_random random = shape_random_seed(5, 2);
    for (int i = 0; i < 1000; i++) {
        shape_vec3 q = draw_place(&random, 100);
        q = shape_vec3_make(floorf(q.x), floorf(q.y), floorf(q.z));
        assert_true(shape_noise_perlin(q, KEY) == 0);
    }
}

static void the_scalar_is_the_first_of_three(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(5, 3);
    double products[3] = {0, 0, 0};
    enum { COUNT = 20000 };
    for (int i = 0; i < COUNT; i++) {
        shape_vec3 q = draw_place(&random, 500), three = shape_noise_perlin3(q, KEY);
        assert_true(three.x == shape_noise_perlin(q, KEY));
        products[0] += (double)(three.x * three.y);
        products[1] += (double)(three.y * three.z);
        products[2] += (double)(three.z * three.x);
    }
    /* Independent: products average to 0, with a spread of about 0.07 (the square of the deviation, 0.27). */
    for (int i = 0; i < 3; i++)
        assert_true(fabs(products[i] / COUNT) <= 5 * 0.08 / sqrt(COUNT));
}

static void noises_tile_without_a_seam(void **state)
{
    (void)state;
    float (*const noises[])(shape_vec3) = {perlin, perlin_z, perlin_fbm, worley, worley_fbm};
    shape_random random = shape_random_seed(5, 4);
    const float period = SHAPE_NOISE_PERIOD;
    for (size_t n = 0; n < sizeof noises / sizeof *noises; n++)
        for (int i = 0; i < 2000; i++) {
            shape_vec3 q = draw_place(&random, 500), moved = q;
            (&moved.x)[i % 3] += i % 2 ? period : -period;
            assert_true(noises[n](q) == noises[n](moved));
            /* and continuous over the tile's wall: steep at the most by some units a cell and octave */
            shape_vec3 wall = q;
            (&wall.x)[i % 3] = period;
            shape_vec3 before = wall;
            (&before.x)[i % 3] = period - 1.0f / 1024;
            assert_true(fabsf(noises[n](wall) - noises[n](before)) <= 16.0f / 1024);
        }
}

static void keys_make_independent_noises(void **state)
{
    (void)state;
    enum { COUNT = 20000 };
    shape_random random = shape_random_seed(5, 5);
    double products = 0, squares = 0;
    for (int i = 0; i < COUNT; i++) {
        shape_vec3 q = draw_place(&random, 500);
        double a = (double)shape_noise_perlin(q, KEY), b = (double)shape_noise_perlin(q, KEY + 1);
        products += a * b;
        squares += a * a;
    }
    assert_true(fabs(products) <= 0.05 * squares);
    assert_int_not_equal(shape_noise_key(1, 0), shape_noise_key(2, 0));
    assert_int_not_equal(shape_noise_key(1, 0), shape_noise_key(1, 1));
}

/* One point a cell at a uniform place: for a ball of volume V, 1 - exp(-V) <= P(F1 < d) <= V. The upper bound is the
 * expected number of points in it; the lower since the chance of none, the product of 1 - V_cell, is at most that of
 * points thrown without cells. */
static void worley_has_the_law_of_the_nearest_point(void **state)
{
    (void)state;
    enum { COUNT = 60000 };
    shape_random random = shape_random_seed(5, 6);
    static double found[COUNT];
    for (int i = 0; i < COUNT; i++)
        found[i] = (double)shape_noise_worley(draw_place(&random, 500), KEY);
    for (double d = 0.1; d < 0.95; d += 0.1) {
        double volume = 4.18879020478639 * d * d * d, below = 0;
        for (int i = 0; i < COUNT; i++)
            below += found[i] < d;
        below /= COUNT;
        double slack = 5 * sqrt(below * (1 - below) / COUNT);
        assert_true(below <= volume + slack);
        assert_true(below >= 1 - exp(-volume) - slack);
    }
    moments m = measure(worley_fbm, COUNT);
    assert_true(m.low >= 0 && m.high <= 1 && m.mean > 0.4 && m.mean < 0.6);
}

/* Distances fall no faster than one walks. */
static void worley_is_a_distance(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(5, 7);
    for (int i = 0; i < 20000; i++) {
        shape_vec3 q = draw_place(&random, 50), d = draw_place(&random, 0.3);
        float change = shape_noise_worley(q, KEY) - shape_noise_worley(shape_vec3_add(q, d), KEY);
        assert_true(fabsf(change) <= shape_vec3_length(d) + 1e-5f);
    }
}

/* --- spectrum: a cube of 16 cells, four samples a cell; |k| in cycles a cell --- */

enum { SIDE = 64, CELLS = 16 };

static void transform_row(double *re, double *im, size_t stride)
{
    double out[2][SIDE];
    for (int k = 0; k < SIDE; k++) {
        out[0][k] = out[1][k] = 0;
        for (int i = 0; i < SIDE; i++) {
            static double cosine[SIDE], sine[SIDE];
            static bool ready;
            if (!ready) {
                for (int n = 0; n < SIDE; n++) {
                    cosine[n] = cos(6.283185307179586 * n / SIDE);
                    sine[n] = sin(6.283185307179586 * n / SIDE);
                }
                ready = true;
            }
            int turn = i * k % SIDE;
            double a = re[(size_t)i * stride], b = im[(size_t)i * stride];
            out[0][k] += a * cosine[turn] + b * sine[turn];
            out[1][k] += b * cosine[turn] - a * sine[turn];
        }
    }
    for (int k = 0; k < SIDE; k++) {
        re[(size_t)k * stride] = out[0][k];
        im[(size_t)k * stride] = out[1][k];
    }
}

/* The shares of the power (without the mean) with |k| below and in [low, high). */
static void find_shares(float (*noise)(shape_vec3), double low, double high, double *below, double *within)
{
    size_t count = (size_t)SIDE * SIDE * SIDE;
    double *re = malloc(count * sizeof *re), *im = calloc(count, sizeof *im), mean = 0, total = 0;
    assert_true(re && im);
    for (size_t i = 0; i < count; i++) {
        size_t x = i % SIDE, y = i / SIDE % SIDE, z = i / SIDE / SIDE;
        const float step = (float)CELLS / SIDE;
        re[i] = (double)noise(shape_vec3_make((float)x * step, (float)y * step, (float)z * step));
        mean += re[i] / (double)count;
    }
    for (size_t i = 0; i < count; i++) {
        /* A Hann window: the cube is no period of the noise. */
        size_t at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        re[i] -= mean;
        for (int axis = 0; axis < 3; axis++)
            re[i] *= 0.5 - 0.5 * cos(6.283185307179586 * (double)at[axis] / SIDE);
    }
    for (size_t i = 0; i < (size_t)SIDE * SIDE; i++) {
        transform_row(re + i * SIDE, im + i * SIDE, 1);
    }
    for (size_t i = 0; i < (size_t)SIDE * SIDE; i++)
        transform_row(re + i / SIDE * SIDE * SIDE + i % SIDE, im + i / SIDE * SIDE * SIDE + i % SIDE, SIDE);
    for (size_t i = 0; i < (size_t)SIDE * SIDE; i++)
        transform_row(re + i, im + i, (size_t)SIDE * SIDE);
    *below = *within = 0;
    for (size_t i = 0; i < count; i++) {
        double k2 = 0, power = re[i] * re[i] + im[i] * im[i];
        size_t at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        for (int axis = 0; axis < 3; axis++) {
            double k = (double)(at[axis] < SIDE / 2 ? at[axis] : SIDE - at[axis]) / CELLS;
            k2 += k * k;
        }
        total += power;
        *below += sqrt(k2) < low ? power : 0;
        *within += sqrt(k2) >= low && sqrt(k2) < high ? power : 0;
    }
    *below /= total;
    *within /= total;
    free(re);
    free(im);
}

static shape_noise *lattice_noise;
static float lattice(shape_vec3 q)
{
    return shape_noise_value(lattice_noise, q);
}

static float white(shape_vec3 q)
{
    uint64_t x = (uint64_t)(q.x * 1024), y = (uint64_t)(q.y * 1024), z = (uint64_t)(q.z * 1024);
    return (float)(shape_hash(shape_hash(shape_hash(x) + y) + z) >> 40) * 0x1p-24f;
}

static void spectra_differ_as_they_should(void **state)
{
    (void)state;
    shape_error error;
    assert_int_equal(shape_noise_create(&lattice_noise, &error), SHAPE_OK);
    double below, within;
    /* White noise spreads over all of the cube of side 4: the shell from 0.3 to 1.5 has 4/3 pi (1.5^3 - 0.3^3) / 64 of it. */
    find_shares(white, 0.3, 1.5, &below, &within);
    assert_true(fabs(within - 0.219) < 0.02);
    /* Gradients push power away from low frequencies, to about one cycle a cell. */
    find_shares(perlin, 0.3, 1.5, &below, &within);
    print_message("Perlin: %.3f of the power below 0.3 cycles a cell, %.3f up to 1.5\n", below, within);
    assert_true(within > 0.9 && below < 0.05);
    /* The values of a lattice are white: their low frequencies stay. */
    double lattice_below;
    find_shares(lattice, 0.3, 1.5, &lattice_below, &within);
    print_message("lattice: %.3f, %.3f\n", lattice_below, within);
    assert_true(lattice_below > 5 * below);
    double worley_below;
    find_shares(worley, 0.3, 1.5, &worley_below, &within);
    print_message("Worley: %.3f, %.3f\n", worley_below, within);
    assert_true(within > 0.7 && worley_below < lattice_below);
    shape_noise_destroy(lattice_noise);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gradient_noise_is_centred_and_bounded),
        cmocka_unit_test(the_scalar_is_the_first_of_three),
        cmocka_unit_test(noises_tile_without_a_seam),
        cmocka_unit_test(keys_make_independent_noises),
        cmocka_unit_test(worley_has_the_law_of_the_nearest_point),
        cmocka_unit_test(worley_is_a_distance),
        cmocka_unit_test(spectra_differ_as_they_should),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
