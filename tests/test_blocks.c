/* The quick ways through one voxel grid (light/blocks.c, primitive/grid_look.h, field/grid_ray.c) against the plain ones:
 * values from the formula, closed forms of free paths, the general march. */
#include "grid_sample.h"

#ifdef _OPENMP
#include <omp.h>
#endif

#include "field/grid_ray.h"
#include "light/blocks.h"
#include "light/track.h"
#include "primitive/grid_look.h"
#include "shape/march.h"
#include "shape/pathtrace.h"

/* Ragged: most points 0, so that bricks have parts that are empty, full, and in between. */
static double ragged(const void *context, int x, int y, int z)
{
    uint64_t place = ((uint64_t)z * 64 + (uint64_t)y) * 64 + (uint64_t)x;
    return shape_hash(place) % 3 || (x / 6 + y / 7 + z / 5) % 2 ? 0 : 0.2 + bumps(context, x, y, z);
}

static double value_at(int x, int y, int z)
{
    return x < 41 && y < 33 && z < 37 ? ragged(NULL, x, y, z) : 0;
}

/* Trilinear as the textbook has it, from the formula's values, without bricks. */
static double plain(double x, double y, double z)
{
    int i = (int)x, j = (int)y, k = (int)z;
    double sum = 0;
    for (int c = 0; c < 8; c++) {
        int a = c & 1, b = c >> 1 & 1, d = c >> 2;
        sum += (a ? x - i : 1 - x + i) * (b ? y - j : 1 - y + j) * (d ? z - k : 1 - z + k) *
               value_at(i + a, j + b, k + d);
    }
    return sum;
}

/* Values reach 1.2: single precision gives 1e-6 of that, places up to 40 in single precision 4e-6 a voxel. */
static void look_is_the_plain_one(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(3, 0);
    shape_grid *grid = grid_of(ragged, NULL, 41, 33, 37);
    int empty = 0, full = 0;
    for (int i = 0; i < 200000; i++) {
        float x = (float)shape_random_range(&random, 0, 40), y = (float)shape_random_range(&random, 0, 32),
              z = (float)shape_random_range(&random, 0, 36);
        if (i % 3 == 0)
            x = floorf(x), z = floorf(z);
        if (!(x < 40 && y < 32 && z < 36))
            continue;
        unsigned cell[3];
        double wanted = plain((double)x, (double)y, (double)z);
        assert_true(fabs((double)grid_look(grid, x, y, z) - wanted) <= 1e-5);
        assert_true(grid_look(grid, x, y, z) == shape_grid_sample(grid, shape_vec3_make(x, y, z)));
        bool found = grid_find(grid, x, y, z, cell) != NULL;
        assert_true(found || wanted == 0);
        empty += !found;
        full += wanted > 0;
    }
    assert_true(empty > 1000 && full > 1000);
    shape_grid_release(grid);
}

static shape_volume *ragged_volume(shape_set **set, float extinction)
{
    *set = grid_set(grid_of(ragged, NULL, 41, 33, 37), 0.1, shape_dvec3_make(0, 0, 0));
    (*set)->clouds[0].medium.extinction = extinction;
    (*set)->clouds[0].medium.g = 0.3f;
    return new_volume(*set);
}

/* Of the walk's blocks and of their parts, at random points. */
static void bounds_hold(void **state)
{
    (void)state;
    shape_error error;
    shape_random random = shape_random_seed(4, 0);
    for (int dense = 0; dense < 2; dense++) {
        shape_set *set;
        shape_volume *volume = ragged_volume(&set, dense ? 30 : 2);
        const shape_grid *grid = volume->clouds[0].list->grid;
        block_grid b;
        must(block_grid_build(&b, &volume->clouds[0], shape_dvec3_make(0, 0, 0), &error), &error);
        assert_int_equal(b.edge, dense ? 4 : 8);
        for (int i = 0; i < 100000; i++) {
            float p[3] = {(float)shape_random_range(&random, 0, 39.9),
                          (float)shape_random_range(&random, 0, 31.9),
                          (float)shape_random_range(&random, 0, 35.9)};
            size_t index = 0;
            int part = 0;
            for (int a = 2; a >= 0; a--) {
                index = index * (size_t)b.n[a] + (size_t)((int)p[a] / b.edge + 1);
                part = part * BLOCK_PARTS + (int)p[a] % b.edge / (b.edge / BLOCK_PARTS);
            }
            float extinction = b.extinction * grid_look(grid, p[0], p[1], p[2]);
            const block_bound *block = &b.blocks[index];
            assert_true(extinction <= block->max);
            if (!(block->max > 0))
                continue;
            assert_true(extinction <= block->max * (float)b.parts[block->parts].high[part] / 255 * 1.000001f);
            assert_true(extinction >= block->max * (float)b.parts[block->parts].low[part] / 255 * 0.999999f);
        }
        block_grid_free(&b);
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
}

/* Free paths: exp(-depth) at the collisions is even between the transmittance T and 1, and a share T of the rays has none;
 * ratio tracking has the mean T. Depth is the exact integral. Each within 4.5 standard errors. */
static void check_ray(const block_grid *b, const shape_grid *grid, const double p[3], const double d[3],
                      double length, shape_random *random)
{
    enum { N = 20000 };
    shape_vec3 from = shape_vec3_make((float)p[0] * 10, (float)p[1] * 10, (float)p[2] * 10),
               way = shape_vec3_make((float)d[0] * 10, (float)d[1] * 10, (float)d[2] * 10);
    double missed = 0, place = 0, ratio = 0, squares = 0, t;
    double through = exp(-(double)b->extinction * shape_grid_integral(grid, from, way, 0, (float)length));
    for (int i = 0; i < N; i++) {
        bool hit = block_collide(b, p, d, length, (double)-logf((float)track_unit(random)), random, &t);
        missed += !hit;
        place += hit ? exp(-(double)b->extinction * shape_grid_integral(grid, from, way, 0, (float)t)) : 0;
        double weight = block_transmittance(b, p, d, length, random);
        ratio += weight;
        squares += weight * weight;
    }
    double hits = N - missed, deviation = sqrt(through * (1 - through) / N);
    assert_true(fabs(missed / N - through) <= 4.5 * deviation + 1e-6);
    assert_true(fabs(place / hits - (1 + through) / 2) <= 4.5 * (1 - through) / sqrt(12 * hits) + 1e-5);
    deviation = sqrt(fmax(squares / N - ratio / N * (ratio / N), 0) / N);
    assert_true(fabs(ratio / N - through) <= 4.5 * deviation + 1e-6);
}

static void free_paths_are_exact(void **state)
{
    (void)state;
    shape_error error;
    shape_random random = shape_random_seed(5, 0);
    for (int dense = 0; dense < 2; dense++) {
        shape_set *set;
        shape_volume *volume = ragged_volume(&set, dense ? 6 : 1.5f);
        block_grid b;
        must(block_grid_build(&b, &volume->clouds[0], shape_dvec3_make(0, 0, 0), &error), &error);
        assert_int_equal(b.edge, dense ? 4 : 8);
        for (int i = 0; i < 8; i++) {
            shape_vec3 to = draw_direction(&random);
            double d[3] = {(double)to.x, (double)to.y, (double)to.z}, p[3] = {2, 1.6, 1.8};
            if (i == 0)
                d[0] = 0, d[1] = 0, d[2] = -1;
            for (int a = 0; a < 3; a++)
                p[a] -= (i % 2 ? 3 : 0.3) * d[a];
            check_ray(&b, volume->clouds[0].list->grid, p, d, i % 3 ? INFINITY : 3.7, &random);
        }
        block_grid_free(&b);
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
}

/* Rounding of places far off is many blocks; a gain of 0 leaves none at all. No ray leaves the table, which the address
 * sanitizer would tell, and what is empty is never met. */
static void far_and_empty_are_safe(void **state)
{
    (void)state;
    shape_error error;
    shape_random random = shape_random_seed(8, 0);
    for (int k = 0; k < 2; k++) {
        shape_set *set;
        shape_volume *volume = ragged_volume(&set, 2);
        volume->clouds[0].list->grid->gain = k ? 0 : 1;
        block_grid b;
        must(block_grid_build(&b, &volume->clouds[0], shape_dvec3_make(0, 0, 0), &error), &error);
        int met = 0;
        for (int i = 0; i < 20000; i++) {
            shape_vec3 to = draw_direction(&random);
            double far = pow(10, shape_random_range(&random, 0, 20)), t;
            double d[3] = {(double)to.x, (double)to.y, (double)to.z}, p[3] = {2, 1.6, 1.8};
            for (int a = 0; a < 3; a++)
                p[a] -= far * d[a];
            met += block_collide(&b, p, d, INFINITY, 0.01, &random, &t);
            double weight = block_transmittance(&b, p, d, INFINITY, &random);
            assert_true(weight >= 0 && weight < 10);
        }
        assert_true(k ? met == 0 : met > 1000);
        block_grid_free(&b);
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
}

/* Against the exact integral: cell by cell the same, by steps of 1.5 voxels within 6 % of a smooth density's depth; and an
 * early end is one past what is enough. */
static void way_has_the_integral(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(6, 0);
    shape_grid *grid = grid_of(bumps, NULL, 41, 33, 37);
    double wanted_sum = 0, found_sum = 0;
    for (int i = 0; i < 200; i++) {
        shape_vec3 d = draw_direction(&random), p = {20, 16, 18};
        p = shape_vec3_add(p, shape_vec3_scale(draw_point(&random, 1), 8));
        grid_way way = grid_way_make(grid, d);
        double wanted = shape_grid_integral(grid, p, d, 0, INFINITY);
        assert_true(fabs(grid_way_depth(&way, p, 0.9f, INFINITY) - wanted) <= 1e-4 * (1 + wanted));
        double found = grid_way_depth(&way, p, 1.5f, INFINITY);
        assert_true(fabs(found - wanted) <= 0.06 * wanted + 0.2);
        wanted_sum += wanted, found_sum += found;
        if (wanted < 1)
            continue;
        double cut = grid_way_depth(&way, p, 1.5f, 0.3), fine = grid_way_depth(&way, p, 0.9f, 0.3);
        assert_true(cut >= 0.3 * 0.999 && cut <= 0.3 + 1.5);
        assert_true(fine >= 0.3 && fine <= wanted * 1.0001);
    }
    assert_true(fabs(found_sum / wanted_sum - 1) < 0.01);
    shape_grid_release(grid);
}

static void render_march(const shape_set *set, double cutoff, float *picture)
{
    shape_error error;
    shape_volume *volume = new_volume(set);
    shape_light light = shape_light_defaults();
    shape_march_options options = shape_march_defaults();
    shape_marcher *marcher;
    shape_view view = shape_view_defaults();
    view.width = 40, view.height = 30;
    view.eye = shape_dvec3_make(2, 2, 9);
    view.target = shape_dvec3_make(2, 1.6, 1.8);
    options.light = SHAPE_MARCH_SINGLE;
    options.step = 0.1;
    options.light_step = 0.05;
    options.cutoff = cutoff;
    must(shape_marcher_create(volume, &light, view.eye, &options, &marcher, &error), &error);
    must(shape_march_render(marcher, &view, picture, NULL, &error), &error);
    shape_marcher_destroy(marcher);
    shape_volume_destroy(volume);
}

/* A second grid far behind the eye sends the march down the general way. Radiance is of the order of 1. With a cutoff the
 * picture changes by about as much as it leaves out. */
static void march_is_the_general_one(void **state)
{
    (void)state;
    shape_error error;
    enum { N = 40 * 30 * 3 };
    float alone[N], beside[N], cut[N];
    double largest = 0, changed = 0;
    shape_set *set;
    shape_volume_destroy(ragged_volume(&set, 8));
    render_march(set, 1e-8, alone);
    render_march(set, 0.04, cut);
    shape_frame far = {{{0.1, 0, 0, 0}, {0, 0.1, 0, 0}, {0, 0, 0.1, 500}}};
    must(shape_set_add_grid(set, "far", grid_of(bumps, NULL, 41, 33, 37), &far, NULL, &error), &error);
    render_march(set, 1e-8, beside);
    for (int i = 0; i < N; i++) {
        largest = fmax(largest, fabs((double)alone[i] - (double)beside[i]));
        changed = fmax(changed, fabs((double)alone[i] - (double)cut[i]));
    }
    assert_true(largest <= 1e-4);
    assert_true(changed > 0 && changed <= 0.08);
    shape_set_destroy(set);
    shape_march_options options = shape_march_defaults();
    options.cutoff = 0;
    assert_int_equal(shape_march_check(&options, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "cutoff"));
}

#ifdef _OPENMP
/* Both methods, bit for bit. */
static void threads_change_nothing(void **state)
{
    (void)state;
    shape_error error;
    enum { N = 40 * 30 * 3 };
    static float pictures[2][2][N];
    shape_set *set;
    shape_volume *volume = ragged_volume(&set, 3);
    shape_light light = shape_light_defaults();
    shape_pathtrace_options options = shape_pathtrace_defaults();
    shape_pathtrace_result result;
    shape_view view = shape_view_defaults();
    view.width = 40, view.height = 30;
    view.eye = shape_dvec3_make(2, 2, 9);
    view.target = shape_dvec3_make(2, 1.6, 1.8);
    options.samples = 4;
    for (int k = 0; k < 2; k++) {
        shape_tracer *tracer;
        omp_set_num_threads(k ? 3 : 1);
        must(shape_tracer_create(volume, &tracer, &error), &error);
        must(shape_pathtrace_render(tracer, &view, &light, &options, pictures[k][0], NULL, &result, &error),
             &error);
        render_march(set, 1e-8, pictures[k][1]);
        shape_tracer_destroy(tracer);
    }
    assert_memory_equal(pictures[0], pictures[1], sizeof pictures[0]);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}
#endif

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(look_is_the_plain_one),  cmocka_unit_test(bounds_hold),
        cmocka_unit_test(far_and_empty_are_safe), cmocka_unit_test(free_paths_are_exact),
        cmocka_unit_test(way_has_the_integral),   cmocka_unit_test(march_is_the_general_one),
#ifdef _OPENMP
        cmocka_unit_test(threads_change_nothing),
#endif
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
