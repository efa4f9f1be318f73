/* Thinning out, growing and clipping against what their definitions promise. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "shape/gaussian.h"
#include "shape/refine.h"
#include "shape/transform.h"

static void free_list(shape_primitives *list)
{
    free(list->spheres);
    free(list->ellipsoids);
}

static void thinning_keeps_an_ordered_choice(void **state)
{
    (void)state;
    int kept_times[20] = {0};
    for (uint64_t seed = 0; seed < 2000; seed++) {
        shape_primitives list = {0};
        shape_error error;
        for (int i = 0; i < 10; i++) {
            shape_sphere s = {(float)i, 0, 0, 1};
            shape_ellipsoid e = {.x = (float)(10 + i), .a = 1, .b = 2, .c = 3, .q = {0, 0, 0, 1}};
            shape_primitives_add_sphere(&list, s, &error);
            shape_primitives_add_ellipsoid(&list, e, &error);
        }
        assert_int_equal(shape_primitives_thin(&list, 20, seed), 0);
        assert_int_equal(shape_primitives_thin(&list, 8, seed), 12);
        assert_int_equal(shape_primitives_count(&list), 8);
        float last = -1;
        for (size_t i = 0; i < 8; i++) {
            float x = i < list.sphere_count ? list.spheres[i].x : list.ellipsoids[i - list.sphere_count].x;
            assert_true(x > last);
            last = x;
            kept_times[(int)x]++;
        }
        free_list(&list);
    }
    /* Each is kept with probability 0.4: four standard errors of 2000 draws (five, for the largest of twenty). */
    for (int i = 0; i < 20; i++)
        assert_true(fabs(kept_times[i] / 2000.0 - 0.4) < 5 * sqrt(0.24 / 2000));
}

static shape_primitives cumulus(void)
{
    shape_primitives list = {0};
    shape_error error;
    shape_gaussian o = shape_gaussian_defaults();
    assert_int_equal(shape_gaussian_make(&o, 1, &list, NULL, &error), SHAPE_OK);
    return list;
}

static double distance(const shape_sphere *a, const shape_sphere *b)
{
    double x = (double)a->x - b->x, y = (double)a->y - b->y, z = (double)a->z - b->z;
    return sqrt(x * x + y * y + z * z);
}

static void what_grows_stands_on_a_surface_and_is_seen(void **state)
{
    (void)state;
    shape_primitives list = cumulus();
    size_t before = list.sphere_count, added;
    shape_grow o = shape_grow_defaults();
    o.levels = 1;
    shape_error error;
    assert_int_equal(shape_primitives_grow(&list, &o, 1, &added, &error), SHAPE_OK);
    assert_true(added > before && added <= before * (size_t)o.count);
    assert_int_equal(list.sphere_count, before + added);
    for (size_t i = before; i < list.sphere_count; i++) {
        const shape_sphere *child = &list.spheres[i];
        bool rests = false;
        for (size_t k = 0; k < before; k++) {
            const shape_sphere *parent = &list.spheres[k];
            double d = distance(child, parent), ratio = child->radius / (double)parent->radius;
            /* On one surface, to single precision at 10 m; inside none. */
            assert_true(d > parent->radius - 1e-5);
            rests = rests || (fabs(d - parent->radius) < 1e-5 && ratio > 0.3499 && ratio < 0.6001);
        }
        assert_true(rests);
    }
    free_list(&list);
}

static void growing_goes_level_by_level(void **state)
{
    (void)state;
    shape_primitives one = cumulus(), two = cumulus();
    shape_grow o = shape_grow_defaults();
    shape_error error;
    o.levels = 1;
    size_t first, both;
    shape_primitives_grow(&one, &o, 9, &first, &error);
    o.levels = 2;
    shape_primitives_grow(&two, &o, 9, &both, &error);
    assert_true(both > first);
    assert_memory_equal(one.spheres, two.spheres, one.sphere_count * sizeof *one.spheres);
    /* The second level's are at most 0.36 of the largest. */
    for (size_t i = one.sphere_count; i < two.sphere_count; i++)
        assert_true(two.spheres[i].radius <= 0.6f * 0.6f * 2.9f * 1.0001f);
    free_list(&one);
    free_list(&two);
}

static void growing_on_an_ellipsoid_and_its_limit(void **state)
{
    (void)state;
    shape_primitives list = {0};
    shape_error error;
    shape_ellipsoid e = {.x = 1, .a = 3, .b = 2, .c = 1, .q = {0, 0, 0, 1}};
    shape_primitives_add_ellipsoid(&list, e, &error);
    shape_grow o = {.levels = 1, .count = 50, .ratio = {0.5, 0.5}, .max_primitives = 51};
    assert_int_equal(shape_primitives_grow(&list, &o, 1, NULL, &error), SHAPE_OK);
    assert_int_equal(list.sphere_count, 50);
    for (size_t i = 0; i < 50; i++) {
        const shape_sphere *s = &list.spheres[i];
        double u = pow((s->x - 1) / 3, 2) + pow(s->y / 2, 2) + pow(s->z, 2);
        assert_true(fabs(u - 1) < 1e-6 && s->radius == 0.5f);
    }
    assert_int_equal(shape_primitives_grow(&list, &o, 1, NULL, &error), SHAPE_ERROR_LIMIT);
    o.count = 0;
    assert_int_equal(shape_primitives_grow(&list, &o, 1, NULL, &error), SHAPE_ERROR_ARGUMENT);
    free_list(&list);
}

/* A set of one cumulus in a turned, scaled and moved frame. */
static shape_set *placed_cumulus(void)
{
    shape_error error;
    shape_set *set = shape_set_create(&error);
    shape_set_add_cloud(set, "c", NULL, &error);
    shape_gaussian o = shape_gaussian_defaults();
    assert_int_equal(shape_gaussian_make(&o, 1, shape_set_list(set, 0), NULL, &error), SHAPE_OK);
    shape_transform t = {.scale = {2, 2, 2}, .rotate = {20, 30, 40}, .translate = {100, 200, 300}};
    assert_int_equal(shape_set_transform(set, NULL, &t, &error), SHAPE_OK);
    return set;
}

/* Lowest and highest point of a primitive along a world direction. */
static void reach_along(const shape_set *set, const shape_ellipsoid *e, const double n[3], double *low,
                        double *high)
{
    const shape_frame *frame = &set->clouds[0].frame;
    double m[3][3], square = 0;
    const double axes[3] = {e->a, e->b, e->c};
    shape_quat_matrix(e->q, m);
    shape_dvec3 c = shape_frame_point(frame, shape_dvec3_make(e->x, e->y, e->z));
    for (int k = 0; k < 3; k++) {
        shape_dvec3 axis = {m[0][k] * axes[k], m[1][k] * axes[k], m[2][k] * axes[k]};
        axis = shape_frame_direction(frame, axis);
        square += pow(axis.x * n[0] + axis.y * n[1] + axis.z * n[2], 2);
    }
    double centre = c.x * n[0] + c.y * n[1] + c.z * n[2];
    *low = centre - sqrt(square);
    *high = centre + sqrt(square);
}

static void clipping_ends_at_the_plane(void **state)
{
    (void)state;
    shape_set *whole = placed_cumulus(), *set = placed_cumulus();
    shape_clip o = shape_clip_defaults();
    const double n[3] = {0.6, 0.8, 0};
    memcpy(o.normal, n, sizeof n);
    o.lowest = false;
    o.height = 224; /* through the middle: the cloud stands about 0.6 * 100 + 0.8 * 200 = 220 */
    size_t removed, squashed, low_before = 0, crossing = 0;
    shape_error error;
    const shape_primitives *list = shape_set_list_const(whole, 0);
    double high_before = -INFINITY, low, high;
    for (size_t i = 0; i < list->sphere_count; i++) {
        shape_ellipsoid e = shape_ellipsoid_from_sphere(&list->spheres[i]);
        reach_along(whole, &e, n, &low, &high);
        low_before += (low + high) / 2 < 224;
        crossing += (low + high) / 2 >= 224 && low < 224;
        high_before = fmax(high_before, high);
    }
    assert_int_equal(shape_set_clip(set, NULL, &o, &removed, &squashed, &error), SHAPE_OK);
    assert_int_equal(removed, low_before);
    assert_int_equal(squashed, crossing);
    assert_true(removed > 3 && squashed > 3);
    list = shape_set_list_const(set, 0);
    assert_int_equal(list->ellipsoid_count, squashed);
    double high_after = -INFINITY;
    for (size_t i = 0; i < shape_primitives_count(list); i++) {
        shape_ellipsoid e = i < list->sphere_count ? shape_ellipsoid_from_sphere(&list->spheres[i])
                                                   : list->ellipsoids[i - list->sphere_count];
        reach_along(set, &e, n, &low, &high);
        /* Single precision at 10 m, scaled by 2: 4e-6 m, and the same again from the quaternion. */
        assert_true(low > 224 - 1e-5);
        if (i >= list->sphere_count)
            assert_true(fabs(low - 224) < 1e-5);
        high_after = fmax(high_after, high);
    }
    assert_true(fabs(high_after - high_before) < 1e-5);
    shape_set_destroy(whole);
    shape_set_destroy(set);
}

static void the_default_cut_makes_a_flat_base(void **state)
{
    (void)state;
    shape_error error;
    shape_set *set = shape_set_create(&error);
    shape_set_add_cloud(set, "c", NULL, &error);
    shape_gaussian o = shape_gaussian_defaults();
    shape_gaussian_make(&o, 1, shape_set_list(set, 0), NULL, &error);
    size_t count = shape_set_list(set, 0)->sphere_count, removed, squashed;
    shape_frame there = shape_frame_identity();
    there.m[1][3] = 50;
    shape_set_add_copy(set, 0, &there, NULL, &error);
    shape_clip clip = shape_clip_defaults();
    assert_int_equal(shape_set_clip(set, NULL, &clip, &removed, &squashed, &error), SHAPE_OK);
    assert_int_equal(removed, 0);
    assert_int_equal(shape_primitives_count(shape_set_list(set, 0)), count);
    shape_box box = shape_cloud_box(&set->clouds[0], shape_set_list(set, 0));
    assert_true(fabsf(box.min.y) < 1e-6f);
    assert_true(set->clouds[0].list == set->clouds[1].list); /* a copy higher up is cut alike */
    /* A ragged base hangs down by up to the noise, and not everywhere as far. */
    shape_set_destroy(set);
    set = shape_set_create(&error);
    shape_set_add_cloud(set, "c", NULL, &error);
    shape_gaussian_make(&o, 1, shape_set_list(set, 0), NULL, &error);
    clip.noise = 1;
    assert_int_equal(shape_set_clip(set, NULL, &clip, &removed, &squashed, &error), SHAPE_OK);
    assert_int_equal(removed, 0);
    const shape_primitives *list = shape_set_list_const(set, 0);
    float lowest = 1, highest = -2;
    for (size_t i = 0; i < list->ellipsoid_count; i++) {
        float low = shape_ellipsoid_box(&list->ellipsoids[i], 1).min.y;
        assert_true(low >= -1 - 1e-5f && low <= 1e-5f);
        lowest = low < lowest ? low : lowest;
        highest = low > highest ? low : highest;
    }
    assert_true(list->ellipsoid_count > 10 && highest - lowest > 0.3f);
    shape_set_destroy(set);
}

static void wrong_options_are_refused(void **state)
{
    (void)state;
    shape_clip wrong[4];
    for (int i = 0; i < 4; i++)
        wrong[i] = shape_clip_defaults();
    wrong[0].normal[1] = 0;
    wrong[1].height = NAN;
    wrong[2].noise = -1;
    wrong[3].noise_size = 0;
    for (int i = 0; i < 4; i++) {
        shape_error error;
        assert_int_equal(shape_clip_check(&wrong[i], &error), SHAPE_ERROR_ARGUMENT);
    }
    shape_grow grow = shape_grow_defaults();
    grow.ratio[0] = 0.7;
    shape_error error;
    assert_int_equal(shape_grow_check(&grow, &error), SHAPE_ERROR_ARGUMENT);
    grow = shape_grow_defaults();
    grow.levels = 9;
    assert_int_equal(shape_grow_check(&grow, &error), SHAPE_ERROR_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(thinning_keeps_an_ordered_choice),
        cmocka_unit_test(what_grows_stands_on_a_surface_and_is_seen),
        cmocka_unit_test(growing_goes_level_by_level),
        cmocka_unit_test(growing_on_an_ellipsoid_and_its_limit),
        cmocka_unit_test(clipping_ends_at_the_plane),
        cmocka_unit_test(the_default_cut_makes_a_flat_base),
        cmocka_unit_test(wrong_options_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
