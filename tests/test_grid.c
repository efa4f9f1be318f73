/* Voxel grids as clouds: samples, integrals, bounds, storage, and light through them against closed forms. */
#include "grid_sample.h"

#include "field/grid_ray.h"
#include "shape/bake.h"
#include "shape/march.h"
#include "shape/neph.h"
#include "shape/pathtrace.h"

static double one(const void *context, int x, int y, int z)
{
    (void)context, (void)x, (void)y, (void)z;
    return 1;
}

static double ramp(const void *context, int x, int y, int z)
{
    (void)context;
    return 1 + 2 * x + 3 * y + 5 * z;
}

/* A trilinear sample of a linear function is that function, but for rounding: 1e-6 of its largest value. */
static void samples_of_a_ramp_are_the_ramp(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(1, 0);
    shape_grid *grid = grid_of(ramp, NULL, 23, 10, 18);
    for (int i = 0; i < 20000; i++) {
        shape_vec3 p = {draw(&random, 0, 21.999), draw(&random, 0, 8.999), draw(&random, 0, 16.999)};
        double wanted = 1 + 2 * (double)p.x + 3 * (double)p.y + 5 * (double)p.z;
        assert_true(fabs((double)shape_grid_sample(grid, p) - wanted) <= 1e-6 * 160);
    }
    assert_true(shape_grid_sample(grid, shape_vec3_make(-0.01f, 1, 1)) == 0);
    assert_true(shape_grid_sample(grid, shape_vec3_make(1, 9.01f, 1)) == 0);
    assert_true(shape_grid_sample(grid, shape_vec3_make(1, 1, NAN)) == 0);
    grid->gain = 3;
    assert_true(fabs((double)shape_grid_sample(grid, shape_vec3_make(1, 1, 1)) - 33) < 1e-4);
    double sum = 0;
    for (int z = 0; z < 18; z++)
        for (int y = 0; y < 10; y++)
            for (int x = 0; x < 23; x++)
                sum += ramp(NULL, x, y, z);
    assert_true(fabs(shape_grid_sum(grid) - 3 * sum) <= 1e-6 * sum);
    shape_grid_release(grid);
}

/* Along a line a trilinear density is a cubic in each cell: the walk is exact. Against 20,000 midpoints: 1e-4. */
static void integrals_are_exact(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(2, 0);
    shape_grid *grid = grid_of(bumps, NULL, 41, 33, 37);
    for (int i = 0; i < 60; i++) {
        shape_vec3 a = draw_point(&random, 60), d = draw_direction(&random);
        if (i % 4 == 0)
            d = shape_vec3_make(0, 0, i % 8 ? 1 : -1);
        a = shape_vec3_add(shape_vec3_make(20, 16, 18), shape_vec3_scale(a, 0.2f));
        double sum = 0, step = 140 / 20000.0;
        for (int k = 0; k < 20000; k++) {
            float t = (float)(-70 + (k + 0.5) * step);
            sum += step * (double)shape_grid_sample(grid, shape_vec3_add(a, shape_vec3_scale(d, t)));
        }
        assert_true(fabs(shape_grid_integral(grid, a, d, -70, 70) - sum) <= 1e-3 + 1e-4 * sum);
        double first = shape_grid_integral(grid, a, d, -70, 3), rest = shape_grid_integral(grid, a, d, 3, 70);
        assert_true(fabs(first + rest - shape_grid_integral(grid, a, d, -70, 70)) <= 1e-4);
    }
    shape_grid_release(grid);
}

/* No sample within a box lies beyond the bounds given for it, and some sample of many comes near each. */
static void ranges_bound_the_samples(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(3, 0);
    shape_grid *grid = grid_of(bumps, NULL, 41, 33, 37);
    for (int i = 0; i < 2000; i++) {
        double low[3], high[3];
        float least, most;
        for (int a = 0; a < 3; a++) {
            low[a] = shape_random_range(&random, -5, 42);
            high[a] = low[a] + shape_random_range(&random, 0, i % 2 ? 3 : 30);
        }
        shape_grid_range(grid, low, high, &least, &most);
        for (int k = 0; k < 50; k++) {
            shape_vec3 p = {draw(&random, low[0], high[0]), draw(&random, low[1], high[1]),
                            draw(&random, low[2], high[2])};
            float value = shape_grid_sample(grid, p);
            assert_true(value >= least && value <= most);
        }
    }
    shape_grid_release(grid);
}

/* Outside the runs of bricks that a ray is given there is no density. */
static void candidates_hold_all_density(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(4, 0);
    shape_error error;
    shape_set *set = grid_set(grid_of(bumps, NULL, 61, 33, 37), 0.5, shape_dvec3_make(3, 4, 5));
    shape_volume *volume = new_volume(set);
    shape_candidates found = {0};
    for (int i = 0; i < 300; i++) {
        shape_vec3 from = draw_point(&random, 40);
        shape_ray ray = {from, draw_direction(&random)};
        must(shape_cloud_candidates(&volume->clouds[0], ray, -80, 80, &found, &error), &error);
        for (int k = 0; k < 200; k++) {
            float t = draw(&random, -80, 80);
            shape_vec3 p = shape_vec3_add(ray.origin, shape_vec3_scale(ray.direction, t));
            bool held = false;
            for (size_t c = 0; c < found.count; c++)
                held = held || (t >= found.items[c].t_in - 1e-3f && t <= found.items[c].t_out + 1e-3f);
            assert_true(held || shape_cloud_density(&volume->clouds[0], p) == 0);
        }
    }
    shape_candidates_free(&found);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* Through n voxels of value v and an edge of e, the transmittance is exp(-n e v): half a voxel of ramp on both sides makes
 * up for the first and last half. The walk to 1e-6, midpoints of a hundredth of a voxel to 1e-4, ratio tracking to four
 * standard errors. */
static void slab_lets_through_what_beer_says(void **state)
{
    (void)state;
    shape_error error;
    unsigned char bytes[12 + 4 * 6 * 5 * 4];
    const uint32_t size[3] = {6, 5, 4};
    const float v = 0.7f;
    memcpy(bytes, size, 12);
    for (int i = 0; i < 120; i++)
        memcpy(bytes + 12 + 4 * i, &v, 4);
    shape_grid *grid;
    must(shape_volume_raw_decode("slab", bytes, sizeof bytes, 1 << 20, &grid, &error), &error);
    assert_true(fabs(shape_grid_sum(grid) - 120 * 0.7) < 1e-4);
    shape_set *set = grid_set(grid, 0.25, shape_dvec3_make(0, 0, 0));
    set->clouds[0].medium.extinction = 2;
    shape_volume *volume = new_volume(set);
    shape_candidates scratch = {0};
    shape_dvec3 from = {-10, 0.25 * 3, 0.25 * 2.5}, along_x = {1, 0, 0};
    double depth, wanted = 6 * 0.25 * 0.7 * 2;
    must(shape_volume_optical_depth(volume, from, along_x, 0, INFINITY, 0.2f, &scratch, &depth, &error),
         &error);
    assert_true(fabs(depth - wanted) <= 1e-5 * wanted);
    must(shape_volume_optical_depth(volume, from, along_x, 0, INFINITY, 0.3f, &scratch, &depth, &error),
         &error);
    assert_true(fabs(depth - wanted) <= 0.2 * wanted); /* steps longer than a voxel: midpoints */
    shape_tracer *tracer;
    must(shape_tracer_create(volume, &tracer, &error), &error);
    shape_random random = shape_random_seed(5, 0);
    double sum = 0, squares = 0;
    enum { N = 40000 };
    for (int i = 0; i < N; i++) {
        double t = shape_tracer_transmittance(tracer, from, along_x, INFINITY, &random);
        sum += t, squares += t * t;
    }
    double mean = sum / N, deviation = sqrt((squares / N - mean * mean) / N);
    assert_true(fabs(mean - exp(-wanted)) <= 4 * deviation + 1e-6);
    shape_tracer_destroy(tracer);
    shape_candidates_free(&scratch);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

static shape_set *heap(shape_model model)
{
    shape_random random = shape_random_seed(6, 0);
    shape_set *set = new_set();
    new_cloud(set, model);
    add_random(set, 0, &random, 6, 3, 1.5, 0.6, 1.4);
    return set;
}

/* What a spheroid cloud's voxels hold is what the cloud has there, to the float. */
static void grid_of_a_cloud_equals_it(void **state)
{
    (void)state;
    shape_set *set = heap(SHAPE_MODEL_SPHEROID);
    shape_volume *volume = new_volume(set);
    sampled_cloud s = {&volume->clouds[0], 0.125, {-4, -4, -4}};
    shape_set *voxels = grid_set(grid_of(of_cloud, &s, 65, 65, 65), s.edge, s.at);
    shape_volume *grid = new_volume(voxels);
    for (int i = 0; i < 5000; i++) {
        int x = i * 7 % 64, y = i * 13 % 64, z = i * 29 % 64;
        shape_dvec3 p = {s.at.x + s.edge * x, s.at.y + s.edge * y, s.at.z + s.edge * z};
        assert_true(fabs(shape_volume_extinction(grid, p) - 2 * of_cloud(&s, x, y, z)) <= 1e-5);
    }
    shape_volume_destroy(grid);
    shape_set_destroy(voxels);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* Single scattering by the reference (one bounce) and by the march, through a bright part of the grid: the two agree
 * within four standard errors and the march's own 1 %. */
static void march_and_reference_agree(void **state)
{
    (void)state;
    shape_error error;
    shape_set *set = grid_set(grid_of(bumps, NULL, 33, 33, 33), 0.1, shape_dvec3_make(-1.6, -1.6, -1.6));
    set->clouds[0].medium.extinction = 1.5;
    set->clouds[0].medium.g = 0.3f;
    shape_volume *volume = new_volume(set);
    shape_light light = shape_light_defaults();
    light.sky = SHAPE_SKY_NONE;
    shape_tracer *tracer;
    shape_marcher *marcher;
    shape_march_options march = shape_march_defaults();
    march.light = SHAPE_MARCH_SINGLE;
    march.step = march.light_step = 0.02;
    shape_pathtrace_options trace = shape_pathtrace_defaults();
    trace.max_bounces = 1;
    trace.sun_angle = 0;
    must(shape_tracer_create(volume, &tracer, &error), &error);
    shape_dvec3 eye = {0.3, 0.2, 6}, d = shape_dvec3_normalize(shape_dvec3_make(-0.08, -0.05, -1));
    must(shape_marcher_create(volume, &light, eye, &march, &marcher, &error), &error);
    shape_march_scratch scratch;
    memset(&scratch, 0, sizeof scratch);
    double marched[3], rgb[3], sum = 0, squares = 0;
    must(shape_march_radiance(marcher, eye, d, 0, &scratch, marched, &error), &error);
    shape_random random = shape_random_seed(7, 0);
    enum { N = 100000 };
    for (int i = 0; i < N; i++) {
        shape_pathtrace_radiance(tracer, &light, &trace, eye, d, &random, rgb);
        sum += rgb[0], squares += rgb[0] * rgb[0];
    }
    double mean = sum / N, deviation = sqrt((squares / N - mean * mean) / N);
    assert_true(mean > 0.01);
    assert_true(fabs(mean - marched[0]) <= 4 * deviation + 0.01 * mean);
    shape_march_scratch_free(&scratch);
    shape_marcher_destroy(marcher);
    shape_tracer_destroy(tracer);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* Densities above 1 are baked in units of the largest: within half a step of 255. */
static void baking_keeps_large_densities(void **state)
{
    (void)state;
    shape_error error;
    shape_baked baked;
    shape_grid *grid = grid_of(ramp, NULL, 9, 9, 9);
    grid->gain = 2;
    shape_set *set = grid_set(grid, 1, shape_dvec3_make(0, 0, 0));
    shape_volume *volume = new_volume(set);
    const shape_volume_cloud *c = &volume->clouds[0];
    assert_true(fabs((double)c->most - 2 * (1 + 10 * 8)) < 1e-3);
    must(shape_bake(c, 0.5f, 1, &baked, &error), &error);
    for (int z = 0; z < baked.size[2]; z++)
        for (int x = 0; x < baked.size[0]; x++) {
            shape_vec3 p = {baked.box.min.x + 0.5f * ((float)x + 0.5f), baked.box.min.y + 0.5f * 12.5f,
                            baked.box.min.z + 0.5f * ((float)z + 0.5f)};
            double wanted = (double)shape_cloud_density(c, p) / (double)c->most * 255;
            size_t i = ((size_t)z * (size_t)baked.size[1] + 12) * (size_t)baked.size[0] + (size_t)x;
            assert_true(fabs((double)baked.voxels[2 * i] - wanted) <= 0.51);
        }
    shape_baked_free(&baked);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* Empty space and even parts take no bricks of their own; the limit is told before memory is taken. */
static double two_blocks(const void *context, int x, int y, int z)
{
    (void)context, (void)y, (void)z;
    return x > 20 && x < 180 ? 0.5 : x == 199 ? 1 : 0;
}

static void storage_is_sparse_and_limited(void **state)
{
    (void)state;
    shape_error error;
    shape_grid *grid = grid_of(two_blocks, NULL, 201, 41, 41);
    /* One empty brick, one even one, two faces, and the last: a layer of each. */
    assert_true(grid->brick_count < 4 * 36);
    shape_grid_release(grid);
    grid_formula f = {one, NULL, {401, 401, 401}};
    shape_grid_source source = {{401, 401, 401}, grid_formula_brick, &f};
    assert_int_equal(shape_grid_create(&source, 1 << 20, &grid, &error), SHAPE_ERROR_LIMIT);
    assert_non_null(strstr(error.text, "--max-memory"));
    source.points[0] = SHAPE_GRID_MAX_SIDE + 1;
    assert_int_equal(shape_grid_create(&source, 1 << 20, &grid, &error), SHAPE_ERROR_LIMIT);
}

/* A .neph has no place for voxels, and says where to go. Copies of a grid's cloud share it. */
static void neph_refuses_grids(void **state)
{
    (void)state;
    shape_error error;
    unsigned char *bytes;
    size_t size, copy;
    shape_set *set = grid_set(grid_of(one, NULL, 9, 9, 9), 1, shape_dvec3_make(0, 0, 0));
    shape_frame frame = shape_frame_identity();
    assert_int_not_equal(shape_neph_encode(set, &bytes, &size, &error), SHAPE_OK);
    assert_non_null(strstr(error.text, "neph-vdb"));
    must(shape_set_add_copy(set, 0, &frame, &copy, &error), &error);
    shape_volume *volume = new_volume(set);
    assert_true(shape_cloud_density(&volume->clouds[1], shape_vec3_make(4, 4, 4)) == 1);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* Every truncation and every lie in the sizes is one line; NaN too. */
static void hostile_raw_volumes_are_refused(void **state)
{
    (void)state;
    shape_error error;
    shape_grid *grid = NULL;
    unsigned char bytes[12 + 4 * 27] = {3, 0, 0, 0, 3, 0, 0, 0, 3};
    const float nan = NAN, half = 0.5f;
    for (size_t n = 0; n < sizeof bytes; n++)
        assert_int_equal(shape_volume_raw_decode("x", bytes, n, 1 << 20, &grid, &error), SHAPE_ERROR_FORMAT);
    assert_int_equal(shape_volume_raw_decode("x", bytes, sizeof bytes, 1 << 20, &grid, &error),
                     SHAPE_ERROR_FORMAT);
    assert_non_null(strstr(error.text, "empty"));
    memcpy(bytes + 12 + 4 * 13, &nan, 4);
    assert_int_equal(shape_volume_raw_decode("x", bytes, sizeof bytes, 1 << 20, &grid, &error),
                     SHAPE_ERROR_FORMAT);
    assert_non_null(strstr(error.text, "finite"));
    memcpy(bytes + 12 + 4 * 13, &half, 4);
    assert_true(shape_volume_raw_is(bytes, sizeof bytes) && !shape_volume_raw_is(bytes, sizeof bytes - 1));
    bytes[11] = 0x7f;
    assert_int_equal(shape_volume_raw_decode("x", bytes, sizeof bytes, 1 << 20, &grid, &error),
                     SHAPE_ERROR_FORMAT);
    bytes[11] = 0, bytes[0] = 0;
    assert_int_equal(shape_volume_raw_decode("x", bytes, sizeof bytes, 1 << 20, &grid, &error),
                     SHAPE_ERROR_FORMAT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_of_a_ramp_are_the_ramp),   cmocka_unit_test(integrals_are_exact),
        cmocka_unit_test(ranges_bound_the_samples),         cmocka_unit_test(candidates_hold_all_density),
        cmocka_unit_test(slab_lets_through_what_beer_says), cmocka_unit_test(grid_of_a_cloud_equals_it),
        cmocka_unit_test(march_and_reference_agree),        cmocka_unit_test(baking_keeps_large_densities),
        cmocka_unit_test(storage_is_sparse_and_limited),    cmocka_unit_test(neph_refuses_grids),
        cmocka_unit_test(hostile_raw_volumes_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
