/* The primitive set and its vectors: boxes against sampled surfaces, rotations against their matrices, frames against
 * their inverses, names, checks. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "shape/random.h"
#include "shape/combine.h"
#include "shape/set.h"

static shape_error error;

static float draw(shape_random *random, double low, double high)
{
    return (float)shape_random_range(random, low, high);
}

static shape_quat draw_quat(shape_random *random)
{
    shape_quat q = {draw(random, -1, 1), draw(random, -1, 1), draw(random, -1, 1), draw(random, -1, 1)};
    return shape_quat_normalize(q);
}

static shape_dvec3 draw_direction(shape_random *random)
{
    shape_dvec3 d = {shape_random_normal(random), shape_random_normal(random), shape_random_normal(random)};
    return shape_dvec3_normalize(d);
}

static shape_ellipsoid draw_ellipsoid(shape_random *random)
{
    shape_ellipsoid e = {.x = draw(random, -5, 5),
                         .y = draw(random, -5, 5),
                         .z = draw(random, -5, 5),
                         .a = draw(random, 0.1, 4),
                         .b = draw(random, 0.1, 4),
                         .c = draw(random, 0.1, 4),
                         .q = draw_quat(random)};
    return e;
}

static shape_set *new_set(void)
{
    shape_set *set = shape_set_create(&error);
    assert_non_null(set);
    return set;
}

/* The point of an ellipsoid's surface, `grow` times as large, that belongs to the unit vector d. */
static shape_dvec3 surface_point(const shape_ellipsoid *e, shape_dvec3 d, double grow)
{
    shape_vec3 local = {(float)(grow * e->a * d.x), (float)(grow * e->b * d.y), (float)(grow * e->c * d.z)};
    shape_vec3 p = shape_quat_rotate(e->q, local);
    return shape_dvec3_make((double)e->x + (double)p.x, (double)e->y + (double)p.y,
                            (double)e->z + (double)p.z);
}

/* No sampled point of the surface is outside, and the samples come near every face: a box too large fails too. */
static void ellipsoid_boxes_are_tight(void **state)
{
    (void)state;
    enum { SAMPLES = 20000 };
    shape_random random = shape_random_seed(1, 1);
    for (int step = 0; step < 40; step++) {
        shape_ellipsoid e = draw_ellipsoid(&random);
        double grow = step % 2 ? 1 : 3;
        shape_box box = shape_ellipsoid_box(&e, (float)grow);
        double longest = grow * fmax(e.a, fmax(e.b, e.c));
        double low[3] = {DBL_MAX, DBL_MAX, DBL_MAX}, high[3] = {-DBL_MAX, -DBL_MAX, -DBL_MAX};
        for (int i = 0; i < SAMPLES; i++) {
            shape_dvec3 p = surface_point(&e, draw_direction(&random), grow);
            const double xyz[3] = {p.x, p.y, p.z};
            for (int k = 0; k < 3; k++) {
                low[k] = fmin(low[k], xyz[k]);
                high[k] = fmax(high[k], xyz[k]);
            }
        }
        const double min[3] = {box.min.x, box.min.y, box.min.z}, max[3] = {box.max.x, box.max.y, box.max.z};
        for (int k = 0; k < 3; k++) {
            /* rounding to single precision: a few 2^-24 of 20 m */
            assert_true(low[k] >= min[k] - 1e-5 && high[k] <= max[k] + 1e-5);
            /* of 20,000 directions the nearest to a face's is within 0.05 rad of it: short by 0.05^2 / 2, and slack */
            assert_true(low[k] - min[k] < 5e-3 * longest && max[k] - high[k] < 5e-3 * longest);
        }
    }
}

/* An ellipsoid of three equal axes is a sphere, however it is turned. */
static void round_ellipsoids_have_sphere_boxes(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(2, 2);
    for (int step = 0; step < 100; step++) {
        shape_ellipsoid e = draw_ellipsoid(&random);
        e.b = e.c = e.a;
        shape_sphere s = {e.x, e.y, e.z, e.a};
        shape_box a = shape_ellipsoid_box(&e, 1.5f), b = shape_sphere_box(&s, 1.5f);
        /* the quaternion's length is 1 to 2^-23, the coordinates are below 16 */
        assert_true(fabsf(a.min.x - b.min.x) < 1e-5f && fabsf(a.min.y - b.min.y) < 1e-5f);
        assert_true(fabsf(a.min.z - b.min.z) < 1e-5f && fabsf(a.max.x - b.max.x) < 1e-5f);
        assert_true(fabsf(a.max.y - b.max.y) < 1e-5f && fabsf(a.max.z - b.max.z) < 1e-5f);
    }
}

static void cloud_boxes_hold_their_supports(void **state)
{
    (void)state;
    shape_set *set = new_set();
    assert_int_equal(shape_set_add_cloud(set, "c", NULL, &error), SHAPE_OK);
    assert_true(shape_box_is_empty(shape_cloud_box(&set->clouds[0], &set->lists[0])));
    shape_dvec3 min, max;
    assert_false(shape_set_bounds(set, &min, &max));
    for (int i = 0; i < 4; i++) {
        shape_sphere s = {(float)(10 * i), 0, 0, 1};
        assert_int_equal(shape_primitives_add_sphere(&set->lists[0], s, &error), SHAPE_OK);
    }
    shape_box box = shape_cloud_box(&set->clouds[0], &set->lists[0]);
    assert_true(box.min.x == -1 && box.max.x == 31 && box.min.y == -1 && box.max.z == 1);
    /* metaballs: F >= 1 needs r^2 / d^2 >= 1 / N, so the support is sqrt(4) radii wide */
    set->clouds[0].field.model = SHAPE_MODEL_METABALL;
    box = shape_cloud_box(&set->clouds[0], &set->lists[0]);
    assert_true(box.min.x == -2 && box.max.x == 32 && box.min.y == -2 && box.max.z == 2);
    /* in the world: scaled by 2, x to y, and far away, where single precision has metres */
    const shape_frame frame = {{{0, -2, 0, 1e9}, {2, 0, 0, 0.25}, {0, 0, 2, 0}}};
    set->clouds[0].frame = frame;
    assert_true(shape_set_bounds(set, &min, &max));
    assert_true(min.x == 1e9 - 4 && max.x == 1e9 + 4 && min.y == -3.75 && max.y == 64.25 && min.z == -4 &&
                max.z == 4);
    shape_set_destroy(set);
}

static void an_empty_box_adds_nothing(void **state)
{
    (void)state;
    const shape_box box = {{-1, 2, -3}, {4, 5, 6}}, empty = shape_box_empty();
    shape_box a = shape_box_join(box, empty), b = shape_box_join(empty, box);
    assert_memory_equal(&a, &box, sizeof box);
    assert_memory_equal(&b, &box, sizeof box);
    assert_true(shape_box_is_empty(shape_box_join(empty, empty)));
    assert_true(shape_box_is_empty(empty) && !shape_box_is_empty(box));
    a = shape_box_add_point(empty, box.min);
    assert_true(!shape_box_is_empty(a) && a.min.x == -1 && a.max.x == -1);
}

static void quaternions_and_matrices_agree(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(3, 3);
    for (int step = 0; step < 20000; step++) {
        shape_quat q = draw_quat(&random), p = draw_quat(&random);
        if (step % 3 ==
            0) { /* half turns and nearly so: where a formula by the trace alone loses its digits */
            q.w = step % 2 ? 0 : 1e-6f;
            q = shape_quat_normalize(q);
        }
        double m[3][3], n[3][3];
        shape_quat_matrix(q, m);
        shape_quat back = shape_quat_from_columns(shape_dvec3_make(m[0][0], m[1][0], m[2][0]),
                                                  shape_dvec3_make(m[0][1], m[1][1], m[2][1]),
                                                  shape_dvec3_make(m[0][2], m[1][2], m[2][2]));
        shape_quat_matrix(back, n);
        shape_vec3 v = {draw(&random, -1, 1), draw(&random, -1, 1), draw(&random, -1, 1)};
        shape_vec3 turned = shape_quat_rotate(q, v),
                   there = shape_quat_rotate(shape_quat_conjugate(q), turned);
        const double by_matrix[3] = {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z,
                                     m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
                                     m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
        /* single precision: a dozen operations on numbers up to 3 */
        assert_true(fabs(turned.x - by_matrix[0]) < 2e-6 && fabs(turned.y - by_matrix[1]) < 2e-6 &&
                    fabs(turned.z - by_matrix[2]) < 2e-6);
        assert_true(fabsf(there.x - v.x) < 2e-6f && fabsf(there.y - v.y) < 2e-6f &&
                    fabsf(there.z - v.z) < 2e-6f);
        for (int i = 0; i < 9; i++)
            assert_true(fabs(m[i / 3][i % 3] - n[i / 3][i % 3]) < 2e-6);
        /* a product turns by its right factor first */
        shape_vec3 both = shape_quat_rotate(shape_quat_multiply(p, q), v), one = shape_quat_rotate(p, turned);
        assert_true(fabsf(both.x - one.x) < 3e-6f && fabsf(both.y - one.y) < 3e-6f &&
                    fabsf(both.z - one.z) < 3e-6f);
    }
    shape_quat zero = {0, 0, 0, 0}, identity = shape_quat_normalize(zero);
    assert_true(identity.w == 1 && identity.x == 0);
}

static void frames_have_inverses(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(4, 4);
    for (int step = 0; step < 20000; step++) {
        shape_frame f, g;
        for (int i = 0; i < 12; i++)
            f.m[i / 4][i % 4] =
                shape_random_range(&random, -1, 1) + (i % 5 == 0 ? 5 : 0) + (i % 4 == 3 ? 1e5 : 0);
        assert_true(shape_frame_invert(&f, &g));
        shape_frame one = shape_frame_multiply(&g, &f);
        shape_dvec3 p = {shape_random_range(&random, -9, 9), 1, 2}, q = shape_frame_point(&f, p);
        q = shape_frame_point(&g, q);
        /* 1e5 m away, 2^-53 of it is 1e-11 m; its diagonal outweighs the rest, so its condition is below 10 */
        assert_true(fabs(q.x - p.x) < 1e-8 && fabs(q.y - p.y) < 1e-8 && fabs(q.z - p.z) < 1e-8);
        for (int i = 0; i < 12; i++)
            assert_true(fabs(one.m[i / 4][i % 4] - (i % 5 == 0)) < 1e-8);
    }
    shape_frame flat = shape_frame_identity(), inverse;
    flat.m[1][1] = 0;
    assert_false(shape_frame_invert(&flat, &inverse));
    for (int i = 0; i < 3; i++)
        flat.m[i][i] = 1e150; /* the determinant passes what a double holds */
    assert_false(shape_frame_invert(&flat, &inverse));
}

static void names_are_made_unique_and_whole(void **state)
{
    (void)state;
    shape_set *set = new_set();
    char longest[200];
    memset(longest, 'x', sizeof longest - 1);
    longest[sizeof longest - 1] = 0;
    memcpy(longest + 50, "\xe2\x98\x81", 3); /* a character of three bytes, where names are cut */
    const char *const wanted[] = {"puff", "puff", "puff", "", "", longest, longest, "puff-2"};
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++)
        assert_int_equal(shape_set_add_cloud(set, wanted[i], NULL, &error), SHAPE_OK);
    for (int i = 0; i < 20; i++)
        assert_int_equal(shape_set_add_copy(set, (size_t)i, &set->clouds[0].frame, NULL, &error), SHAPE_OK);
    assert_string_equal(set->clouds[0].name, "puff");
    assert_string_equal(set->clouds[1].name, "puff-2");
    assert_string_equal(set->clouds[2].name, "puff-3");
    assert_string_equal(set->clouds[3].name, "cloud");
    for (size_t i = 0; i < set->cloud_count; i++) {
        const char *name = set->clouds[i].name;
        size_t length = strlen(name);
        assert_in_range(length, 1, SHAPE_NAME_MAX);
        for (size_t k = 0; k < i; k++)
            assert_string_not_equal(name, set->clouds[k].name);
        /* no character is cut in two: every first byte of three has its two others */
        const char *first = strchr(name, '\xe2');
        assert_true(!first || (first[1] == '\x98' && first[2] == '\x81'));
    }
    assert_int_equal(shape_set_check(set, &error), SHAPE_OK);
    shape_set_destroy(set);
}

/* Many names, some of them copied in by appending, stay unique, and adding them takes no time that grows with their
 * square: 60,000 compared one with another would be minutes under the sanitizers. */
static void many_names_stay_unique(void **state)
{
    (void)state;
    enum { MANY = 30000 };
    shape_set *set = shape_set_create(&error), *more = shape_set_create(&error);
    for (int i = 0; i < MANY; i++) {
        char name[32];
        snprintf(name, sizeof name, "cloud-%d",
                 i % 100); /* also of the form that a number behind a name has */
        assert_int_equal(shape_set_add_cloud(set, i % 2 ? name : "cloud", NULL, &error), SHAPE_OK);
    }
    for (int i = 0; i < MANY; i++)
        assert_int_equal(shape_set_add_cloud(more, "cloud", NULL, &error), SHAPE_OK);
    assert_int_equal(shape_set_append(set, more, &error), SHAPE_OK);
    assert_int_equal(set->cloud_count, 2 * MANY);
    assert_int_equal(shape_set_check(set, &error), SHAPE_OK); /* it refuses two clouds of one name */
    set->cloud_count = 3; /* who takes clouds away again may go on adding */
    assert_int_equal(shape_set_add_cloud(set, "cloud", NULL, &error), SHAPE_OK);
    assert_int_equal(shape_set_check(set, &error), SHAPE_OK);
    shape_set_destroy(set);
    shape_set_destroy(more);
}

static void copies_share_a_list_and_a_description(void **state)
{
    (void)state;
    shape_set *set = new_set();
    size_t index = 99;
    assert_int_equal(shape_set_add_cloud(set, "a", &index, &error), SHAPE_OK);
    assert_int_equal(index, 0);
    set->clouds[0].medium.g = 0.25f;
    const shape_frame frame = {{{1, 0, 0, 5}, {0, 1, 0, 6}, {0, 0, 1, 7}}};
    assert_int_equal(shape_set_add_copy(set, 0, &frame, &index, &error), SHAPE_OK);
    assert_true(index == 1 && set->list_count == 1 && set->clouds[1].medium.g == 0.25f);
    assert_true(shape_set_list(set, 0) == shape_set_list(set, 1));
    assert_memory_equal(&set->clouds[1].frame, &frame, sizeof frame);
    assert_int_equal(shape_set_add_copy(set, 2, &frame, &index, &error), SHAPE_ERROR_ARGUMENT);
    shape_set_destroy(set);
}

static void bad_primitives_are_refused(void **state)
{
    (void)state;
    shape_set *set = new_set();
    assert_int_equal(shape_set_add_cloud(set, "a", NULL, &error), SHAPE_OK);
    const shape_sphere spheres[] = {{NAN, 0, 0, 1}, {0, INFINITY, 0, 1}, {0, 0, 0, 0},
                                    {0, 0, 0, -1},  {0, 0, 0, NAN},      {0, 0, 0, INFINITY}};
    for (size_t i = 0; i < sizeof spheres / sizeof *spheres; i++)
        assert_int_equal(shape_primitives_add_sphere(&set->lists[0], spheres[i], &error),
                         SHAPE_ERROR_ARGUMENT);
    for (int i = 0; i < 12; i++) {
        if (i == 3 || i == 7)
            continue; /* paddings are written over */
        shape_ellipsoid e = {.a = 1, .b = 1, .c = 1, .q = {0, 0, 0, 1}};
        float values[12];
        memcpy(values, &e, sizeof e);
        values[i] = NAN;
        memcpy(&e, values, sizeof e);
        assert_int_equal(shape_primitives_add_ellipsoid(&set->lists[0], e, &error), SHAPE_ERROR_ARGUMENT);
    }
    assert_int_equal(shape_primitives_count(&set->lists[0]), 0);
    /* a quaternion of any length becomes a unit one, paddings become zero */
    shape_ellipsoid e = {.pad0 = 3, .a = 1, .b = 1, .c = 1, .pad1 = NAN, .q = {0, 30, 0, 40}};
    assert_int_equal(shape_primitives_add_ellipsoid(&set->lists[0], e, &error), SHAPE_OK);
    e = set->lists[0].ellipsoids[0];
    assert_true(e.q.y == 0.6f && e.q.w == 0.8f && e.pad0 == 0 && e.pad1 == 0);
    assert_int_equal(shape_set_check(set, &error), SHAPE_OK);
    set->lists[0].ellipsoids[0].q.w = 0.9f;
    assert_int_equal(shape_set_check(set, &error), SHAPE_ERROR_FORMAT);
    shape_set_destroy(set);
}

static void checks_name_what_is_out_of_range(void **state)
{
    (void)state;
    const struct {
        const char *name;
        size_t offset;
        float low, high, below, above; /* low and high are good, below and above are not */
    } rows[] = {
        {"kappa", offsetof(shape_cloud, field.kappa), 0, 1, -0.01f, 1.01f},
        {"noise-scale", offsetof(shape_cloud, field.noise_scale), 0, 1e9f, -1, 2e9f},
        {"edge", offsetof(shape_cloud, field.edge), 0, 1e9f, -1, INFINITY},
        {"extinction", offsetof(shape_cloud, medium.extinction), 0, 1e9f, -1, INFINITY},
        {"albedo", offsetof(shape_cloud, medium.albedo), 0, 1, -0.01f, 1.01f},
        {"g is", offsetof(shape_cloud, medium.g), -0.999f, 0.999f, -1, 1},
        {"g2", offsetof(shape_cloud, medium.g2), -0.999f, 0.999f, -1, 1},
        {"lobe-mix", offsetof(shape_cloud, medium.lobe_mix), 0, 1, -1, 2},
        {"droplet", offsetof(shape_cloud, medium.droplet), 5, 50, 4.9f, 50.1f},
    };
    shape_set *set = new_set();
    assert_int_equal(shape_set_add_cloud(set, "a", NULL, &error), SHAPE_OK);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char *at = (char *)&set->clouds[0] + rows[i].offset;
        float kept;
        memcpy(&kept, at, sizeof kept);
        const float values[5] = {rows[i].low, rows[i].high, rows[i].below, rows[i].above, NAN};
        for (int k = 0; k < 5; k++) {
            memcpy(at, &values[k], sizeof values[k]);
            assert_int_equal(shape_set_check(set, &error) == SHAPE_OK, k < 2);
            if (k >= 2 && !strstr(error.text, rows[i].name))
                fail_msg("\"%s\" does not name %s", error.text, rows[i].name);
        }
        memcpy(at, &kept, sizeof kept);
    }
    assert_int_equal(shape_set_check(set, &error), SHAPE_OK);
    set->clouds[0].list = 1;
    assert_int_equal(shape_set_check(set, &error), SHAPE_ERROR_FORMAT);
    set->clouds[0].list = 0;
    set->clouds[0].frame.m[2][3] = NAN;
    assert_int_equal(shape_set_check(set, &error), SHAPE_ERROR_FORMAT);
    shape_set_destroy(set);
}

static void noise_scale_is_a_fifth_of_the_median_radius(void **state)
{
    (void)state;
    shape_set *set = new_set();
    assert_int_equal(shape_set_add_cloud(set, "a", NULL, &error), SHAPE_OK);
    const float radii[4] = {8, 1, 3, 100};
    for (int i = 0; i < 4; i++) {
        shape_sphere s = {0, 0, 0, radii[i]};
        assert_int_equal(shape_primitives_add_sphere(&set->lists[0], s, &error), SHAPE_OK);
    }
    shape_ellipsoid e = {.a = 1, .b = 2, .c = 12, .q = {0, 0, 0, 1}}; /* mean 5: the median of 1 3 5 8 100 */
    assert_int_equal(shape_primitives_add_ellipsoid(&set->lists[0], e, &error), SHAPE_OK);
    assert_int_equal(shape_cloud_choose_noise_scale(&set->clouds[0], &set->lists[0], &error), SHAPE_OK);
    assert_true(set->clouds[0].field.noise_scale == 1);
    set->lists[0].sphere_count = 0;
    assert_int_equal(shape_cloud_choose_noise_scale(&set->clouds[0], &set->lists[0], &error), SHAPE_OK);
    assert_true(set->clouds[0].field.noise_scale == 1); /* what was chosen stays */
    shape_set_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ellipsoid_boxes_are_tight),
        cmocka_unit_test(round_ellipsoids_have_sphere_boxes),
        cmocka_unit_test(cloud_boxes_hold_their_supports),
        cmocka_unit_test(an_empty_box_adds_nothing),
        cmocka_unit_test(quaternions_and_matrices_agree),
        cmocka_unit_test(frames_have_inverses),
        cmocka_unit_test(names_are_made_unique_and_whole),
        cmocka_unit_test(many_names_stay_unique),
        cmocka_unit_test(copies_share_a_list_and_a_description),
        cmocka_unit_test(bad_primitives_are_refused),
        cmocka_unit_test(checks_name_what_is_out_of_range),
        cmocka_unit_test(noise_scale_is_a_fifth_of_the_median_radius),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
