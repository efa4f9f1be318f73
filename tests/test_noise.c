/* The lattice noise: values, period, continuity, mean and range, seeds, packed cells, awkward coordinates. */
#include "volume_sample.h"

#include "shape/noise.h"

static shape_noise *noise;

static int make_noise(void **state)
{
    (void)state;
    return shape_noise_create(&noise, NULL);
}

static int drop_noise(void **state)
{
    (void)state;
    shape_noise_destroy(noise);
    return 0;
}

/* Largest value of a 16-bit number's step: what packing may lose. */
static const float grain = 1.0f / 65535;

static void is_the_lattice_at_whole_coordinates(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(1, 0);
    for (int i = 0; i < 20000; i++) {
        int x = (int)draw(&random, -300, 300), y = (int)draw(&random, -300, 300),
            z = (int)draw(&random, -300, 300);
        shape_vec3 q = {(float)x, (float)y, (float)z};
        /* No interpolation takes place: only the scaling may round. */
        assert_float_equal(shape_noise_value(noise, q), shape_noise_lattice(x, y, z), 1e-7);
        assert_true(shape_noise_lattice(x, y, z) == shape_noise_lattice(x + 64, y - 128, z + 64 * 7));
    }
}

static void packed_cells_hold_the_lattice(void **state)
{
    (void)state;
    const uint16_t *cell = noise->cells;
    for (int z = 0; z < SHAPE_NOISE_SIZE; z++)
        for (int y = 0; y < SHAPE_NOISE_SIZE; y++)
            for (int x = 0; x < SHAPE_NOISE_SIZE; x++, cell += 8)
                for (int corner = 0; corner < 8; corner++) {
                    float value =
                        shape_noise_lattice(x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2));
                    assert_true(cell[corner] == lrintf(value * 65535));
                }
}

/* The weighted sum of eight corners in double precision. */
static double trilinear(shape_dvec3 q)
{
    double fx = floor(q.x), fy = floor(q.y), fz = floor(q.z), sum = 0;
    for (int corner = 0; corner < 8; corner++) {
        int i = corner & 1, j = corner >> 1 & 1, k = corner >> 2;
        double wx = i ? q.x - fx : 1 - (q.x - fx), wy = j ? q.y - fy : 1 - (q.y - fy),
               wz = k ? q.z - fz : 1 - (q.z - fz);
        sum += wx * wy * wz * (double)shape_noise_lattice((int)fx + i, (int)fy + j, (int)fz + k);
    }
    return sum;
}

static void is_trilinear_between_and_repeats(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(2, 0);
    for (int i = 0; i < 50000; i++) {
        shape_vec3 q = draw_point(&random, 100);
        double truth = trilinear(shape_dvec3_make((double)q.x, (double)q.y, (double)q.z));
        /* About ten roundings of numbers below 1. */
        assert_float_equal(shape_noise_value(noise, q), truth, 2e-6);
        /* Multiples of 1/64 stay exact when 64 is added, and so does the value. */
        q = shape_vec3_make(rintf(q.x * 64) / 64, rintf(q.y * 64) / 64, rintf(q.z * 64) / 64);
        shape_vec3 far = {q.x + 64, q.y - 64, q.z + 640};
        assert_true(shape_noise_value(noise, q) == shape_noise_value(noise, far));
    }
}

static void has_no_jump_at_cell_borders(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(3, 0);
    for (int i = 0; i < 30000; i++) {
        shape_vec3 q = draw_point(&random, 70);
        float *axis = i % 3 == 0 ? &q.x : i % 3 == 1 ? &q.y : &q.z;
        *axis = rintf(*axis);
        float here = shape_noise_value(noise, q);
        float border = *axis;
        *axis = nextafterf(border, -1e9f);
        float before = shape_noise_value(noise, q);
        *axis = nextafterf(border, 1e9f);
        float after = shape_noise_value(noise, q);
        /* The slope is at most 1 a cell and a float's step below 128 is at most 7.7e-6. */
        assert_float_equal(before, here, 1e-5);
        assert_float_equal(after, here, 1e-5);
    }
}

static void fbm_has_its_mean_and_range(void **state)
{
    (void)state;
    enum { POINTS = 200000 };
    for (int octaves = 1; octaves <= SHAPE_OCTAVES_MAX; octaves += 5) {
        int offsets[SHAPE_OCTAVES_MAX][3];
        shape_noise_offsets(11, octaves, offsets);
        shape_random random = shape_random_seed(4, (uint64_t)octaves);
        double sum = 0, squares = 0, least = 2, most = -1;
        for (int i = 0; i < POINTS; i++) {
            shape_vec3 q = draw_point(&random, 500);
            double n = (double)shape_noise_fbm(noise, offsets, octaves, q);
            sum += n;
            squares += n * n;
            least = fmin(least, n);
            most = fmax(most, n);
        }
        double mean = sum / POINTS, variance = squares / POINTS - mean * mean, top = 1 - pow(0.5, octaves);
        /* Two chances: which points were drawn, and which 64^3 numbers the lattice holds (variance 1/12 each). */
        double lattice = 1.0 / 12 / (64.0 * 64 * 64) * top * top;
        assert_true(fabs(mean - top / 2) < 4 * sqrt(variance / POINTS + lattice));
        assert_true(least >= 0 && most <= top + 1e-6);
        /* It uses its range: trilinear values vary by 1/12 (2/3)^3 over a cell, the first octave's weight is 1/2. */
        double expected = 1.0 / 12 * 8 / 27 * (1 - pow(0.25, octaves)) / 3;
        assert_true(variance > 0.8 * expected && variance < 1.2 * expected);
    }
}

static void fbm_is_the_sum_of_its_octaves(void **state)
{
    (void)state;
    int offsets[SHAPE_OCTAVES_MAX][3];
    shape_noise_offsets(77, 6, offsets);
    shape_random random = shape_random_seed(5, 0);
    for (int i = 0; i < 20000; i++) {
        shape_vec3 q = draw_point(&random, 20);
        double sum = 0;
        for (int k = 0; k < 6; k++) {
            double s = pow(2, k);
            sum += pow(0.5, k + 1) * trilinear(shape_dvec3_make((double)q.x * s + offsets[k][0],
                                                                (double)q.y * s + offsets[k][1],
                                                                (double)q.z * s + offsets[k][2]));
        }
        assert_float_equal(shape_noise_fbm(noise, offsets, 6, q), sum, 5e-6);
    }
}

static void seeds_and_octaves_begin_elsewhere(void **state)
{
    (void)state;
    int a[SHAPE_OCTAVES_MAX][3], b[SHAPE_OCTAVES_MAX][3], again[SHAPE_OCTAVES_MAX][3];
    shape_noise_offsets(1, SHAPE_OCTAVES_MAX, a);
    shape_noise_offsets(1, SHAPE_OCTAVES_MAX, again);
    assert_memory_equal(a, again, sizeof a);
    for (uint64_t seed = 2; seed < 200; seed++) {
        shape_noise_offsets(seed, SHAPE_OCTAVES_MAX, b);
        int same = 0;
        for (int i = 0; i < SHAPE_OCTAVES_MAX; i++) {
            for (int axis = 0; axis < 3; axis++)
                assert_true(b[i][axis] >= 0 && b[i][axis] < SHAPE_NOISE_SIZE);
            same += !memcmp(a[i], b[i], sizeof a[i]);
        }
        /* One octave agrees with a chance of 16 in 262144; two do not in 198 seeds. */
        assert_true(same <= 1);
    }
    /* A cloud's noise at the origin is not the same number in every octave. */
    float first = shape_noise_lattice(a[0][0], a[0][1], a[0][2]);
    int equal = 0;
    for (int i = 1; i < SHAPE_OCTAVES_MAX; i++)
        equal += fabsf(shape_noise_lattice(a[i][0], a[i][1], a[i][2]) - first) <= grain;
    assert_true(equal <= 1);
}

static void stays_finite_at_awkward_coordinates(void **state)
{
    (void)state;
    static const float awkward[] = {0.0f,     -0.0f,     1e-45f,     -1e-45f, 0.99999994f, 63.999996f,
                                    64,       -64,       8388607.5f, 1.6e7f,  1e8f,        -2.2e9f,
                                    INFINITY, -INFINITY, NAN,        FLT_MAX, -FLT_MAX};
    enum { COUNT = sizeof awkward / sizeof awkward[0] };
    int offsets[SHAPE_OCTAVES_MAX][3];
    shape_noise_offsets(3, SHAPE_OCTAVES_MAX, offsets);
    for (int i = 0; i < COUNT * COUNT * COUNT; i++) {
        shape_vec3 q = {awkward[i % COUNT], awkward[i / COUNT % COUNT], awkward[i / COUNT / COUNT]};
        float value = shape_noise_value(noise, q),
              sum = shape_noise_fbm(noise, offsets, SHAPE_OCTAVES_MAX, q);
        assert_true(value >= 0 && value <= 1);
        assert_true(sum >= 0 && sum <= 1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(is_the_lattice_at_whole_coordinates),
        cmocka_unit_test(packed_cells_hold_the_lattice),
        cmocka_unit_test(is_trilinear_between_and_repeats),
        cmocka_unit_test(has_no_jump_at_cell_borders),
        cmocka_unit_test(fbm_has_its_mean_and_range),
        cmocka_unit_test(fbm_is_the_sum_of_its_octaves),
        cmocka_unit_test(seeds_and_octaves_begin_elsewhere),
        cmocka_unit_test(stays_finite_at_awkward_coordinates),
    };
    return cmocka_run_group_tests(tests, make_noise, drop_noise);
}
