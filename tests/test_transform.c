/* Transforms: what lies in a primitive before lies in it after, and as deep; frames, copies, order, exact turns. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "shape/random.h"
#include "shape/transform.h"

/* u of the field's definition: | diag(1/a) R^T (p - c) |, in double precision. */
static double depth(const shape_ellipsoid *e, shape_dvec3 p)
{
    double m[3][3], sum = 0;
    const double axes[3] = {e->a, e->b, e->c}, d[3] = {p.x - e->x, p.y - e->y, p.z - e->z};
    shape_quat_matrix(e->q, m);
    for (int k = 0; k < 3; k++) {
        double along = (m[0][k] * d[0] + m[1][k] * d[1] + m[2][k] * d[2]) / axes[k];
        sum += along * along;
    }
    return sqrt(sum);
}

static shape_ellipsoid random_ellipsoid(shape_random *r, double ratio)
{
    shape_quat q = {(float)shape_random_normal(r), (float)shape_random_normal(r),
                    (float)shape_random_normal(r), (float)shape_random_normal(r)};
    shape_ellipsoid e = {.x = (float)shape_random_normal(r),
                         .y = (float)shape_random_normal(r),
                         .z = (float)shape_random_normal(r),
                         .a = (float)shape_random_range(r, 1, ratio),
                         .b = (float)shape_random_range(r, 1, ratio),
                         .c = (float)shape_random_range(r, 1, ratio),
                         .q = shape_quat_normalize(q)};
    return e;
}

static shape_frame random_map(shape_random *r)
{
    shape_frame map;
    do
        for (int i = 0; i < 12; i++)
            map.m[i / 4][i % 4] = shape_random_range(r, -1, 1);
    while (fabs(shape_frame_determinant(&map)) < 0.1);
    return map;
}

static shape_dvec3 random_point(shape_random *r)
{
    return shape_dvec3_make(shape_random_range(r, -4, 4), shape_random_range(r, -4, 4),
                            shape_random_range(r, -4, 4));
}

static void points_stay_as_deep_as_they_were(void **state)
{
    (void)state;
    shape_random r = shape_random_seed(2, 0);
    for (int i = 0; i < 500; i++) {
        shape_ellipsoid e = random_ellipsoid(&r, 3);
        shape_frame map = random_map(&r);
        shape_ellipsoid image = shape_ellipsoid_transform(&e, &map);
        for (int k = 0; k < 20; k++) {
            shape_dvec3 p = random_point(&r);
            double before = depth(&e, p), after = depth(&image, shape_frame_point(&map, p));
            /* Single precision of centre, axes and quaternion, times the map's condition (up to about 30). */
            if (!(fabs(after - before) <= 1e-5 * (1 + before)))
                fail_msg("u was %.9g and is %.9g", before, after);
        }
    }
}

static void needles_keep_their_thin_axes(void **state)
{
    (void)state;
    /* Axes 1 : 1e-4 : 1e-6, scaled 3, 2, 5 along themselves: the products are known. Eigenvalues of A A^T in double
     * precision would lose the smallest. */
    shape_ellipsoid e = {.a = 1e-6f, .b = 1, .c = 1e-4f, .q = {0, 0, 0, 1}};
    shape_frame map = {{{3, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 5, 0}}};
    shape_ellipsoid image = shape_ellipsoid_transform(&e, &map);
    assert_true(fabs(image.a - 3e-6) < 1e-12 && fabs(image.b - 2.0) < 1e-6 && fabs(image.c - 5e-4) < 1e-10);
    /* Sheared by x += 1000 y, a unit ball has axes s and 1/s with s - 1/s = 1000. */
    shape_sphere ball = {0, 0, 0, 1};
    e = shape_ellipsoid_from_sphere(&ball);
    shape_frame shear = {{{1, 1000, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    image = shape_ellipsoid_transform(&e, &shear);
    double s = 500 + sqrt(250001.0), large = fmax(image.a, image.b), small = fmin(image.a, image.b);
    assert_true(fabs(large / s - 1) < 1e-6 && fabs(small * s - 1) < 1e-6 && fabs(image.c - 1.0) < 1e-6);
}

static shape_set *sample_set(void)
{
    shape_error error;
    shape_set *set = shape_set_create(&error);
    shape_set_add_cloud(set, "a", NULL, &error);
    shape_set_add_cloud(set, "b", NULL, &error);
    shape_random r = shape_random_seed(3, 0);
    for (size_t cloud = 0; cloud < 2; cloud++) {
        shape_primitives *list = shape_set_list(set, cloud);
        for (int i = 0; i < 5; i++) {
            shape_dvec3 p = random_point(&r);
            shape_sphere s = {(float)p.x, (float)p.y, (float)p.z, (float)shape_random_range(&r, 0.5, 2)};
            shape_primitives_add_sphere(list, s, &error);
            shape_primitives_add_ellipsoid(list, random_ellipsoid(&r, 3), &error);
        }
    }
    set->clouds[0].field.noise_scale = 0.5f;
    shape_frame copy = {{{0, 0, 1, 100}, {0, 1, 0, 0}, {-1, 0, 0, -50}}}; /* turned by 90 degrees */
    shape_set_add_copy(set, 0, &copy, NULL, &error);
    return set;
}

/* Primitive i of a cloud, spheres first. */
static shape_ellipsoid primitive(const shape_set *set, size_t cloud, size_t i)
{
    const shape_primitives *list = shape_set_list_const(set, cloud);
    return i < list->sphere_count ? shape_ellipsoid_from_sphere(&list->spheres[i])
                                  : list->ellipsoids[i - list->sphere_count];
}

/* Holds every primitive's u at random world points before against u at the mapped points after. */
static void expect_mapped(const shape_set *before, const shape_set *after, size_t cloud,
                          const shape_frame *map)
{
    shape_random r = shape_random_seed(4, cloud);
    shape_frame into_before, into_after;
    assert_true(shape_frame_invert(&before->clouds[cloud].frame, &into_before));
    assert_true(shape_frame_invert(&after->clouds[cloud].frame, &into_after));
    size_t count = shape_primitives_count(shape_set_list_const(before, cloud));
    assert_int_equal(count, shape_primitives_count(shape_set_list_const(after, cloud)));
    for (int k = 0; k < 50; k++) {
        shape_dvec3 local = random_point(&r), world = shape_frame_point(&before->clouds[cloud].frame, local);
        shape_dvec3 there = shape_frame_point(&into_after, shape_frame_point(map, world));
        for (size_t i = 0; i < count; i++) {
            shape_ellipsoid a = primitive(before, cloud, i), b = primitive(after, cloud, i);
            double u = depth(&a, shape_frame_point(&into_before, world)), v = depth(&b, there);
            if (!(fabs(u - v) <= 1e-5 * (1 + u)))
                fail_msg("cloud %zu primitive %zu: u was %.9g and is %.9g", cloud, i, u, v);
        }
    }
}

static void clouds_move_as_the_world_does(void **state)
{
    (void)state;
    static const shape_transform cases[] = {
        {.scale = {1, 1, 1}, .translate = {10, -20, 1e6}},
        {.scale = {1, 1, 1}, .rotate = {10, 20, 30}, .pivot = {3, 4, 5}},
        {.scale = {2.5, 2.5, 2.5}, .rotate = {90, 0, -45}, .translate = {1, 2, 3}},
        {.scale = {2, 1, 0.5}, .translate = {1, 2, 3}},
        {.scale = {2, 1, 3}, .mirror = {true, false, true}, .rotate = {0, 77, 5}, .pivot = {-1, 0, 2}},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        shape_set *before = sample_set(), *after = sample_set();
        shape_error error;
        assert_int_equal(shape_set_transform(after, NULL, &cases[c], &error), SHAPE_OK);
        assert_int_equal(shape_set_check(after, &error), SHAPE_OK);
        shape_frame map = shape_transform_frame(&cases[c]);
        for (size_t cloud = 0; cloud < 3; cloud++)
            expect_mapped(before, after, cloud, &map);
        shape_set_destroy(before);
        shape_set_destroy(after);
    }
}

static void the_order_is_scale_rotate_translate(void **state)
{
    (void)state;
    shape_transform t = shape_transform_defaults();
    t.scale[0] = 2;
    t.rotate[1] = 90; /* z goes to x, x to -z */
    t.translate[0] = 10;
    shape_frame frame = shape_transform_frame(&t);
    shape_dvec3 p = shape_frame_point(&frame, shape_dvec3_make(1, 2, 3));
    assert_true(p.x == 13 && p.y == 2 && p.z == -2); /* exact: right angles are */
    t.rotate[0] = -270, t.rotate[1] = 360, t.rotate[2] = 180;
    frame = shape_transform_frame(&t); /* x first: y to z, z to -y; then z: x and y turn round */
    p = shape_frame_point(&frame, shape_dvec3_make(1, 2, 3));
    assert_true(p.x == 8 && p.y == 3 && p.z == 2);
}

static void equal_scaling_leaves_the_primitives_and_the_noise(void **state)
{
    (void)state;
    shape_set *before = sample_set(), *after = sample_set();
    shape_transform t = {.scale = {4, 4, 4}, .rotate = {1, 2, 3}, .mirror = {true, false, false}};
    shape_error error;
    assert_int_equal(shape_set_transform(after, NULL, &t, &error), SHAPE_OK);
    assert_int_equal(after->list_count, before->list_count);
    assert_memory_equal(after->lists[0].spheres, before->lists[0].spheres, 5 * sizeof(shape_sphere));
    assert_true(after->clouds[0].field.noise_scale == 0.5f);
    assert_true(after->clouds[0].medium.extinction == 2); /* so it is four times as deep */
    assert_true(shape_frame_determinant(&after->clouds[0].frame) < 0);
    t.keep_depth = true;
    assert_int_equal(shape_set_transform(after, NULL, &t, &error), SHAPE_OK);
    assert_true(after->clouds[0].medium.extinction == 0.5f);
    shape_set_destroy(before);
    shape_set_destroy(after);
}

/* One cloud at a time comes out as all of them at once. */
static void one_cloud_moves_as_a_set_does(void **state)
{
    (void)state;
    shape_set *one = sample_set(), *all = sample_set();
    shape_transform t = {.scale = {3, 3, 3}, .rotate = {1, 2, 3}, .translate = {4, 5, 6}, .keep_depth = true};
    shape_error error;
    assert_int_equal(shape_set_transform(all, NULL, &t, &error), SHAPE_OK);
    for (size_t i = 0; i < one->cloud_count; i++) {
        assert_int_equal(shape_cloud_transform(&one->clouds[i], &t, &error), SHAPE_OK);
        assert_memory_equal(&one->clouds[i].frame, &all->clouds[i].frame, sizeof(shape_frame));
        assert_true(one->clouds[i].medium.extinction == all->clouds[i].medium.extinction);
    }
    t.scale[1] = 2;
    assert_int_equal(shape_cloud_transform(&one->clouds[0], &t, &error), SHAPE_ERROR_ARGUMENT);
    shape_set_destroy(one);
    shape_set_destroy(all);
}

static void unequal_scaling_makes_ellipsoids(void **state)
{
    (void)state;
    shape_set *set = sample_set();
    shape_transform t = shape_transform_defaults();
    t.scale[0] = 8, t.keep_depth = true;
    bool only_b[] = {false, true, false};
    shape_error error;
    assert_int_equal(shape_set_transform(set, only_b, &t, &error), SHAPE_OK);
    assert_int_equal(set->lists[0].sphere_count, 5);
    assert_int_equal(set->lists[1].sphere_count, 0);
    assert_int_equal(set->lists[1].ellipsoid_count, 10);
    assert_true(set->clouds[1].medium.extinction == 1); /* the cube root of 8 is 2 */
    assert_true(set->clouds[0].medium.extinction == 2);
    /* a and its turned copy share a list, but are stretched along different axes of it: now they have one each. */
    bool a_and_copy[] = {true, false, true};
    t.keep_depth = false;
    assert_int_equal(shape_set_transform(set, a_and_copy, &t, &error), SHAPE_OK);
    assert_true(set->clouds[0].list != set->clouds[2].list);
    assert_true(set->clouds[0].field.noise_scale == 1);
    assert_int_equal(set->list_count, 3);
    assert_int_equal(shape_set_check(set, &error), SHAPE_OK);
    shape_set_destroy(set);
}

static void similar_maps_keep_spheres(void **state)
{
    (void)state;
    shape_transform t = {.scale = {3, 3, 3}, .rotate = {12, 34, 56}, .translate = {7, 8, 9}};
    shape_frame map = shape_transform_frame(&t);
    shape_primitives list = {0};
    shape_error error;
    shape_sphere s = {1, 2, 3, 0.5f};
    shape_primitives_add_sphere(&list, s, &error);
    assert_int_equal(shape_primitives_transform(&list, &map, &error), SHAPE_OK);
    assert_int_equal(list.sphere_count, 1);
    assert_true(fabsf(list.spheres[0].radius - 1.5f) < 1e-6f);
    /* A size that leaves single precision is an error, and the list stays. */
    shape_frame huge = {{{1e39, 0, 0, 0}, {0, 1e39, 0, 0}, {0, 0, 1e39, 0}}};
    assert_int_equal(shape_primitives_transform(&list, &huge, &error), SHAPE_ERROR_ARGUMENT);
    assert_int_equal(list.sphere_count, 1);
    free(list.spheres);
    free(list.ellipsoids);
}

static void wrong_options_are_refused(void **state)
{
    (void)state;
    shape_transform wrong[4];
    for (int i = 0; i < 4; i++)
        wrong[i] = shape_transform_defaults();
    wrong[0].scale[1] = 0;
    wrong[1].rotate[2] = NAN;
    wrong[2].translate[0] = INFINITY;
    wrong[3].scale[0] = -1;
    for (int i = 0; i < 4; i++) {
        shape_error error;
        shape_set *set = sample_set();
        assert_int_equal(shape_set_transform(set, NULL, &wrong[i], &error), SHAPE_ERROR_ARGUMENT);
        shape_set_destroy(set);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_stay_as_deep_as_they_were),
        cmocka_unit_test(needles_keep_their_thin_axes),
        cmocka_unit_test(clouds_move_as_the_world_does),
        cmocka_unit_test(the_order_is_scale_rotate_translate),
        cmocka_unit_test(equal_scaling_leaves_the_primitives_and_the_noise),
        cmocka_unit_test(one_cloud_moves_as_a_set_does),
        cmocka_unit_test(unequal_scaling_makes_ellipsoids),
        cmocka_unit_test(similar_maps_keep_spheres),
        cmocka_unit_test(wrong_options_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
