/* Simplification: the measured change against pictures of another renderer, from other sides; numbers asked for; what
 * must collapse and what must stay. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include <omp.h>

#include "shape/gaussian.h"
#include "shape/march.h"
#include "shape/random.h"
#include "shape/simplify.h"

static void must(shape_status status, const shape_error *error)
{
    if (status)
        fail_msg("%s", error->text);
}

static void free_list(shape_primitives *list)
{
    free(list->spheres);
    free(list->ellipsoids);
    memset(list, 0, sizeof *list);
}

static shape_primitives copy_of(const shape_primitives *list)
{
    shape_primitives copy = {0};
    shape_error error;
    must(shape_primitives_reserve(&copy, list->sphere_count, list->ellipsoid_count, &error), &error);
    for (size_t i = 0; i < list->sphere_count; i++)
        copy.spheres[copy.sphere_count++] = list->spheres[i];
    for (size_t i = 0; i < list->ellipsoid_count; i++)
        copy.ellipsoids[copy.ellipsoid_count++] = list->ellipsoids[i];
    return copy;
}

static bool same_lists(const shape_primitives *a, const shape_primitives *b)
{
    return a->sphere_count == b->sphere_count && a->ellipsoid_count == b->ellipsoid_count &&
           (!a->sphere_count || !memcmp(a->spheres, b->spheres, a->sphere_count * sizeof *a->spheres)) &&
           (!a->ellipsoid_count ||
            !memcmp(a->ellipsoids, b->ellipsoids, a->ellipsoid_count * sizeof *a->ellipsoids));
}

static shape_cloud cloud_of(shape_model model)
{
    shape_cloud cloud = {
        .frame = shape_frame_identity(), .field = shape_field_defaults(), .medium = shape_medium_defaults()};
    cloud.field.model = model;
    cloud.field.noise_scale = 0.3f;
    return cloud;
}

/* A heap whose spheres overlap much, as clouds do: big ones, and small ones on their surfaces. */
static shape_primitives heap(size_t count, uint64_t seed)
{
    shape_primitives list = {0};
    shape_error error;
    shape_random random = shape_random_seed(seed, 0);
    size_t big = count / 8 + 1;
    for (size_t i = 0; i < count; i++) {
        shape_sphere s = {
            (float)shape_random_range(&random, -4, 4), (float)shape_random_range(&random, -1, 1),
            (float)shape_random_range(&random, -3, 3), (float)shape_random_range(&random, 0.8, 1.6)};
        if (i >= big) {
            const shape_sphere *on = &list.spheres[i % big];
            shape_dvec3 d = {shape_random_normal(&random), shape_random_normal(&random),
                             shape_random_normal(&random)};
            d = shape_dvec3_scale(shape_dvec3_normalize(d), on->radius * 0.9);
            s = (shape_sphere){on->x + (float)d.x, on->y + (float)d.y, on->z + (float)d.z,
                               (float)shape_random_range(&random, 0.2, 0.5)};
        }
        must(shape_primitives_add_sphere(&list, s, &error), &error);
    }
    return list;
}

static shape_simplify_result simplify_at(int resolution, shape_primitives *list, const shape_cloud *cloud,
                                         double allowed, size_t most)
{
    shape_simplify_options options = shape_simplify_defaults();
    options.resolution = resolution;
    shape_simplify_result result;
    shape_error error;
    options.error = allowed;
    options.most = most;
    must(shape_primitives_simplify(list, cloud, &options, &result, &error), &error);
    return result;
}

/* Coarse, where the change itself is not in question. */
static shape_simplify_result simplify(shape_primitives *list, const shape_cloud *cloud, double allowed,
                                      size_t most)
{
    return simplify_at(24, list, cloud, allowed, most);
}

/* --- the bound --- */

enum { WIDTH = 64, HEIGHT = 48 };

static float *march(const shape_primitives *list, const shape_cloud *cloud, shape_dvec3 eye,
                    const shape_light *light)
{
    shape_error error;
    shape_set *set = shape_set_create(&error);
    size_t index;
    must(shape_set_add_cloud(set, "c", &index, &error), &error);
    set->clouds[0].field = cloud->field;
    set->clouds[0].medium = cloud->medium;
    set->lists[0] = copy_of(list);
    shape_volume *volume;
    must(shape_volume_create(set, &volume, &error), &error);
    shape_march_options options = shape_march_defaults();
    options.resolution = 16;
    options.step = 0.15;
    shape_marcher *marcher;
    must(shape_marcher_create(volume, light, eye, &options, &marcher, &error), &error);
    shape_view view = shape_view_defaults();
    view.width = WIDTH, view.height = HEIGHT;
    view.eye = eye, view.target = shape_dvec3_make(0, 0, 0), view.fov = 30;
    float *pixels = malloc(sizeof(float) * 3 * WIDTH * HEIGHT);
    assert_non_null(pixels);
    must(shape_march_render(marcher, &view, pixels, NULL, &error), &error);
    shape_marcher_destroy(marcher);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
    return pixels;
}

static double marched_change(const shape_primitives *from, const shape_primitives *to,
                             const shape_cloud *cloud, shape_dvec3 eye, const shape_light *light)
{
    float *a = march(from, cloud, eye, light), *b = march(to, cloud, eye, light);
    double differences = 0, squares = 0;
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++) {
        double x = (double)a[i], y = (double)b[i];
        differences += (y - x) * (y - x);
        squares += x * x;
    }
    free(a);
    free(b);
    assert_true(squares > 0);
    return sqrt(differences / squares);
}

/* The marched light is another model, with perspective and from directions between the measured ones, and the pictures
 * are chance samples of the same edges; so a change may come out larger than measured, but not by more than half. */
static void holds_in_other_pictures(void **state)
{
    (void)state;
    const shape_dvec3 eyes[] = {{17, 3, 12}, {-9, 14, 11}, {4, -6, -21}};
    for (int model = SHAPE_MODEL_UNIFORM; model <= SHAPE_MODEL_SPHEROID; model++)
        for (int step = 0; step < 2; step++) {
            double allowed = step ? 0.15 : 0.04;
            shape_cloud cloud = cloud_of((shape_model)model);
            shape_primitives list = heap(240, 1), few = copy_of(&list);
            shape_simplify_result result = simplify_at(64, &few, &cloud, allowed, 0);
            assert_true(result.error <= allowed);
            assert_true(result.after < result.before);
            assert_int_equal(result.after, shape_primitives_count(&few));
            shape_light light = shape_light_defaults();
            light.sun = shape_sun_direction(160, 35);
            light.sky = SHAPE_SKY_NONE;
            for (int e = 0; e < 3; e++) {
                double seen = marched_change(&list, &few, &cloud, eyes[e], &light);
                assert_true(seen <= 1.5 * allowed);
            }
            free_list(&list);
            free_list(&few);
        }
}

/* The measure's pictures are chance samples too: at twice the resolution the change is the same to a third. */
static void measure_keeps_with_resolution(void **state)
{
    (void)state;
    shape_error error;
    shape_cloud cloud = cloud_of(SHAPE_MODEL_SPHEROID);
    shape_primitives list = heap(240, 3), few = copy_of(&list);
    simplify(&few, &cloud, -1, 60);
    double coarse, fine, none;
    must(shape_simplify_error(&list, &few, &cloud, 64, &coarse, &error), &error);
    must(shape_simplify_error(&list, &few, &cloud, 128, &fine, &error), &error);
    must(shape_simplify_error(&list, &list, &cloud, 64, &none, &error), &error);
    assert_true(none <= 0);
    assert_true(coarse > 0.02);
    assert_true(fabs(fine / coarse - 1) < 0.33);
    free_list(&list);
    free_list(&few);
}

/* Half of a uniform cloud's cover gone: two balls side by side, seen along z, lose one. The cover of both has n pixels of
 * 1 (they are opaque), the difference n / 2: a relative RMS of the square root of 1/2, to the 2 % of pixels on the rim. */
static void measure_of_half_a_cloud(void **state)
{
    (void)state;
    shape_error error;
    shape_cloud cloud = cloud_of(SHAPE_MODEL_UNIFORM);
    cloud.medium.extinction = 1000;
    shape_primitives two = {0}, one = {0};
    must(shape_primitives_add_sphere(&two, (shape_sphere){-2, 0, 0, 1.5f}, &error), &error);
    must(shape_primitives_add_sphere(&two, (shape_sphere){2, 0, 0, 1.5f}, &error), &error);
    must(shape_primitives_add_sphere(&one, two.spheres[0], &error), &error);
    double change;
    must(shape_simplify_error(&two, &one, &cloud, 128, &change, &error), &error);
    /* Along x one ball hides the other, but a sun on the far side no longer shines on the near one through it; that and
     * the sun's shadow move the radiance by less than half. */
    assert_true(change > sqrt(0.5) * 0.98 && change < sqrt(0.5) * 1.25);
    free_list(&two);
    free_list(&one);
}

/* --- numbers and order --- */

static void keeps_the_number_asked_for(void **state)
{
    (void)state;
    const shape_model models[] = {SHAPE_MODEL_UNIFORM, SHAPE_MODEL_SPHEROID, SHAPE_MODEL_METABALL};
    const size_t numbers[] = {1, 2, 17, 59, 60, 61};
    for (size_t m = 0; m < 3; m++)
        for (size_t i = 0; i < 6; i++) {
            shape_cloud cloud = cloud_of(models[m]);
            shape_primitives list = heap(60, 4), before = copy_of(&list);
            shape_simplify_result result = simplify(&list, &cloud, -1, numbers[i]);
            size_t expected = numbers[i] < 60 ? numbers[i] : 60;
            assert_int_equal(shape_primitives_count(&list), expected);
            assert_int_equal(result.after, expected);
            assert_int_equal(result.before, 60);
            if (expected == 60)
                assert_true(same_lists(&list, &before));
            free_list(&list);
            free_list(&before);
        }
}

static void larger_error_keeps_no_more(void **state)
{
    (void)state;
    size_t kept = SIZE_MAX;
    shape_cloud cloud = cloud_of(SHAPE_MODEL_SPHEROID);
    for (double allowed = 0; allowed <= 1; allowed = allowed > 0 ? allowed * 3 : 0.01) {
        shape_primitives list = heap(150, 5);
        shape_simplify_result result = simplify(&list, &cloud, allowed, 0);
        assert_true(result.after <= kept);
        assert_true(result.error <= allowed);
        kept = result.after;
        free_list(&list);
    }
    assert_true(kept < 75);
}

static void both_limits_hold(void **state)
{
    (void)state;
    shape_cloud cloud = cloud_of(SHAPE_MODEL_SPHEROID);
    shape_primitives list = heap(100, 6), other = copy_of(&list);
    size_t by_error = simplify(&list, &cloud, 0.1, 0).after;
    assert_int_equal(simplify(&other, &cloud, 0.1, by_error - 3).after, by_error - 3);
    free_list(&other);
    other = heap(100, 6);
    assert_int_equal(simplify(&other, &cloud, 0.1, 99).after, by_error);
    assert_true(same_lists(&list, &other));
    free_list(&list);
    free_list(&other);
}

/* --- what must collapse, and what must stay --- */

static void equal_spheres_become_one(void **state)
{
    (void)state;
    shape_error error;
    const shape_sphere sphere = {1, 2, 3, 0.75f};
    for (int model = SHAPE_MODEL_UNIFORM; model <= SHAPE_MODEL_SPHEROID; model++) {
        shape_primitives list = {0};
        for (int i = 0; i < 1000; i++)
            must(shape_primitives_add_sphere(&list, sphere, &error), &error);
        shape_cloud cloud = cloud_of((shape_model)model);
        shape_simplify_result result = simplify(&list, &cloud, 0, 0);
        assert_int_equal(result.after, 1);
        assert_true(result.error <= 0);
        assert_memory_equal(&list.spheres[0], &sphere, sizeof sphere);
        free_list(&list);
    }
}

/* Four equal metaballs are felt as one of twice the radius: F = sum r^2 / d^2. The exponential and logarithm of its cube
 * root leave 1e-6. */
static void metaballs_keep_their_field(void **state)
{
    (void)state;
    shape_error error;
    shape_primitives list = {0};
    for (int i = 0; i < 4; i++)
        must(shape_primitives_add_sphere(&list, (shape_sphere){1, 2, 3, 0.5f}, &error), &error);
    shape_cloud cloud = cloud_of(SHAPE_MODEL_METABALL);
    simplify(&list, &cloud, -1, 1);
    assert_int_equal(list.sphere_count, 1);
    assert_true(fabsf(list.spheres[0].radius - 1) < 1e-6f);
    assert_true(fabsf(list.spheres[0].y - 2) < 1e-6f);
    free_list(&list);
}

static void little_stays_as_it_is(void **state)
{
    (void)state;
    shape_error error;
    shape_cloud cloud = cloud_of(SHAPE_MODEL_SPHEROID);
    shape_primitives list = {0};
    shape_simplify_result result = simplify(&list, &cloud, 0.5, 3);
    assert_int_equal(result.before, 0);
    assert_int_equal(result.after, 0);
    shape_ellipsoid e = {.x = 1, .a = 1, .b = 2, .c = 3, .q = {0, 0.6f, 0, 0.8f}};
    must(shape_primitives_add_ellipsoid(&list, e, &error), &error);
    shape_primitives before = copy_of(&list);
    result = simplify(&list, &cloud, 1, 1);
    assert_int_equal(result.after, 1);
    assert_true(same_lists(&list, &before));
    free_list(&list);
    free_list(&before);
    /* The pieces of a layer are no heap. */
    list = heap(10, 7);
    before = copy_of(&list);
    cloud.field.model = SHAPE_MODEL_LAYER;
    cloud.field.layer = shape_layer_defaults();
    assert_int_equal(simplify(&list, &cloud, 1, 2).after, 10);
    assert_true(same_lists(&list, &before));
    free_list(&list);
    free_list(&before);
}

/* Sizes of every kind at once: what comes out is what a reader accepts. */
static void awkward_heaps_stay_sound(void **state)
{
    (void)state;
    shape_error error;
    shape_set *set = shape_set_create(&error);
    size_t index;
    must(shape_set_add_cloud(set, "c", &index, &error), &error);
    shape_primitives *list = &set->lists[0];
    shape_random random = shape_random_seed(8, 0);
    for (int i = 0; i < 200; i++) {
        float size = (float)shape_exp(shape_random_range(&random, -12, 4));
        shape_ellipsoid e = {.x = (float)shape_random_range(&random, -9, 9), .a = size, .b = size, .c = size};
        e.q = shape_quat_identity();
        if (i % 2)
            e.b *= 1e-5f;
        if (i % 3 == 0)
            e.x = 1;
        must(shape_primitives_add_ellipsoid(list, e, &error), &error);
    }
    shape_cloud cloud = set->clouds[0];
    for (size_t most = 100; most >= 1; most /= 3) {
        assert_int_equal(simplify(list, &cloud, -1, most).after, most);
        must(shape_set_check(set, &error), &error);
    }
    shape_set_destroy(set);
}

static void threads_change_nothing(void **state)
{
    (void)state;
    shape_cloud cloud = cloud_of(SHAPE_MODEL_SPHEROID);
    shape_primitives one = heap(150, 9), many = copy_of(&one);
    int threads = omp_get_max_threads();
    omp_set_num_threads(1);
    shape_simplify_result alone = simplify(&one, &cloud, 0.08, 0);
    omp_set_num_threads(5);
    shape_simplify_result together = simplify(&many, &cloud, 0.08, 0);
    omp_set_num_threads(threads);
    assert_memory_equal(&alone.error, &together.error, sizeof alone.error);
    assert_true(same_lists(&one, &many));
    free_list(&one);
    free_list(&many);
}

static void refuses_wrong_options(void **state)
{
    (void)state;
    shape_error error;
    shape_simplify_options options = shape_simplify_defaults();
    assert_int_equal(shape_simplify_check(&options, &error), SHAPE_OK);
    options.error = 1.5;
    assert_int_equal(shape_simplify_check(&options, &error), SHAPE_ERROR_ARGUMENT);
    options.error = NAN;
    assert_int_equal(shape_simplify_check(&options, &error), SHAPE_ERROR_ARGUMENT);
    options = shape_simplify_defaults();
    options.resolution = 7;
    assert_int_equal(shape_simplify_check(&options, &error), SHAPE_ERROR_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(holds_in_other_pictures),    cmocka_unit_test(measure_keeps_with_resolution),
        cmocka_unit_test(measure_of_half_a_cloud),    cmocka_unit_test(keeps_the_number_asked_for),
        cmocka_unit_test(larger_error_keeps_no_more), cmocka_unit_test(both_limits_hold),
        cmocka_unit_test(equal_spheres_become_one),   cmocka_unit_test(metaballs_keep_their_field),
        cmocka_unit_test(little_stays_as_it_is),      cmocka_unit_test(awkward_heaps_stay_sound),
        cmocka_unit_test(threads_change_nothing),     cmocka_unit_test(refuses_wrong_options),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
