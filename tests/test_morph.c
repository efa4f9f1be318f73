/* One set into another: the ends are the ends, the way is short, and what hangs together stays together. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "shape/morph.h"
#include "shape/random.h"

static shape_set *empty_set(void)
{
    shape_error error;
    shape_set *set = shape_set_create(&error);
    shape_set_add_cloud(set, "a", NULL, &error);
    set->clouds[0].field.noise_scale = 0.2f;
    return set;
}

/* A chain of touching spheres along a direction, given in a mixed order. */
static shape_set *chain(int count, float dx, float dy, float dz, int step)
{
    shape_error error;
    shape_set *set = empty_set();
    for (int j = 0; j < count; j++) {
        float i = (float)((j * step) % count);
        shape_sphere s = {dx * i, dy * i, dz * i, 1};
        assert_int_equal(shape_primitives_add_sphere(shape_set_list(set, 0), s, &error), SHAPE_OK);
    }
    return set;
}

static shape_set *heap(uint64_t seed, int count)
{
    shape_error error;
    shape_set *set = empty_set();
    shape_random random = shape_random_seed(seed, 0);
    for (int i = 0; i < count; i++) {
        shape_sphere s = {(float)shape_random_range(&random, -3, 3), (float)shape_random_range(&random, 0, 2),
                          (float)shape_random_range(&random, -2, 2),
                          (float)shape_random_range(&random, 0.6, 1.2)};
        assert_int_equal(shape_primitives_add_sphere(shape_set_list(set, 0), s, &error), SHAPE_OK);
    }
    return set;
}

static shape_set *at(const shape_morph *morph, double share)
{
    shape_error error;
    shape_set *set = NULL;
    assert_int_equal(shape_morph_at(morph, share, &set, &error), SHAPE_OK);
    assert_int_equal(shape_set_check(set, &error), SHAPE_OK);
    return set;
}

/* Into how many pieces a union of spheres falls. */
static int pieces(const shape_primitives *list)
{
    int count = (int)list->sphere_count, found = 0, *piece = calloc((size_t)count + 1, sizeof *piece);
    int *stack = calloc((size_t)count + 1, sizeof *stack);
    for (int i = 0; i < count; i++) {
        if (piece[i])
            continue;
        int top = 0;
        stack[top++] = i;
        piece[i] = ++found;
        while (top) {
            const shape_sphere *a = &list->spheres[stack[--top]];
            for (int j = 0; j < count; j++) {
                const shape_sphere *b = &list->spheres[j];
                float dx = a->x - b->x, dy = a->y - b->y, dz = a->z - b->z, r = a->radius + b->radius;
                if (!piece[j] && dx * dx + dy * dy + dz * dz <= r * r) {
                    piece[j] = found;
                    stack[top++] = j;
                }
            }
        }
    }
    free(piece);
    free(stack);
    return found;
}

/* Whether each sphere of a is in b. */
static bool all_in(const shape_primitives *a, const shape_primitives *b)
{
    for (size_t i = 0; i < a->sphere_count; i++) {
        bool found = false;
        for (size_t j = 0; j < b->sphere_count && !found; j++)
            found = !memcmp(&a->spheres[i], &b->spheres[j], sizeof *a->spheres);
        if (!found)
            return false;
    }
    return true;
}

static void the_ends_are_the_ends(void **state)
{
    (void)state;
    shape_error error;
    shape_set *a = heap(1, 90), *b = heap(2, 13);
    b->clouds[0].medium.extinction = 7;
    b->clouds[0].field.noise_scale = 0.8f;
    b->clouds[0].frame.m[0][3] = 5;
    shape_morph *morph;
    assert_int_equal(shape_morph_create(a, b, &morph, &error), SHAPE_OK);
    shape_set *start = at(morph, 0), *middle = at(morph, 0.5), *end = at(morph, 1);
    assert_true(all_in(&a->lists[0], &start->lists[0]) && all_in(&start->lists[0], &a->lists[0]));
    assert_true(all_in(&b->lists[0], &end->lists[0]) && all_in(&end->lists[0], &b->lists[0]));
    assert_int_equal(middle->lists[0].sphere_count, 90);
    assert_true(end->clouds[0].medium.extinction == 7 && start->clouds[0].medium.extinction == 2);
    assert_float_equal(middle->clouds[0].field.noise_scale, 0.4, 1e-6); /* sqrt(0.2 * 0.8) */
    assert_float_equal(middle->clouds[0].frame.m[0][3], 2.5, 1e-12);
    shape_set *sets[] = {start, middle, end, a, b};
    shape_morph_destroy(morph);
    for (int i = 0; i < 5; i++)
        shape_set_destroy(sets[i]);
}

/* The pairing depends on places, not on numbers: a set goes to itself in another order without moving, and to itself
 * elsewhere by everything moving as one. Coordinates are small whole numbers, so nothing is rounded. */
static void the_same_shape_moves_as_one(void **state)
{
    (void)state;
    shape_error error;
    shape_set *a = chain(64, 1, 0, 0, 1), *b = chain(64, 1, 0, 0, 27);
    shape_morph *morph;
    assert_int_equal(shape_morph_create(a, b, &morph, &error), SHAPE_OK);
    shape_set *half = at(morph, 0.5);
    assert_true(all_in(&a->lists[0], &half->lists[0]));
    shape_set_destroy(half);
    shape_morph_destroy(morph);
    for (size_t i = 0; i < 64; i++)
        b->lists[0].spheres[i].y += 8;
    assert_int_equal(shape_morph_create(a, b, &morph, &error), SHAPE_OK);
    half = at(morph, 0.5);
    for (size_t i = 0; i < 64; i++)
        half->lists[0].spheres[i].y -= 4;
    assert_true(all_in(&a->lists[0], &half->lists[0]));
    shape_set_destroy(half);
    shape_morph_destroy(morph);
    shape_set_destroy(a);
    shape_set_destroy(b);
}

/* Between one piece and one piece there is one piece at every step: no tear. */
static void what_hangs_together_stays_together(void **state)
{
    (void)state;
    shape_error error;
    shape_set *ends[][2] = {{chain(50, 1, 0, 0, 7), chain(80, 0.5f, 0.7f, 0, 3)},
                            {heap(3, 60), heap(4, 100)},
                            {chain(30, 1, 0.2f, 0, 1), heap(5, 120)}};
    for (int i = 0; i < 3; i++) {
        shape_morph *morph;
        assert_int_equal(pieces(&ends[i][0]->lists[0]), 1);
        assert_int_equal(pieces(&ends[i][1]->lists[0]), 1);
        assert_int_equal(shape_morph_create(ends[i][0], ends[i][1], &morph, &error), SHAPE_OK);
        for (int step = 0; step <= 40; step++) {
            shape_set *set = at(morph, step / 40.0);
            assert_int_equal(pieces(&set->lists[0]), 1);
            shape_set_destroy(set);
        }
        shape_morph_destroy(morph);
        shape_set_destroy(ends[i][0]);
        shape_set_destroy(ends[i][1]);
    }
}

/* One ellipsoid, described twice: its axes renamed. The way from one to the other leaves it as it is. */
static void equal_ellipsoids_do_not_turn(void **state)
{
    (void)state;
    shape_error error;
    shape_set *a = empty_set(), *b = empty_set();
    const float h = 0.70710678f;
    shape_ellipsoid e = {1, 2, 3, 0, 3, 2, 1, 0, {0, 0, 0, 1}};
    shape_ellipsoid f = {1, 2, 3, 0, 2, 3, 1, 0, {0, 0, h, h}}; /* a quarter turn about z: x to y */
    shape_primitives_add_ellipsoid(shape_set_list(a, 0), e, &error);
    shape_primitives_add_ellipsoid(shape_set_list(b, 0), f, &error);
    shape_morph *morph;
    assert_int_equal(shape_morph_create(a, b, &morph, &error), SHAPE_OK);
    for (int step = 0; step <= 10; step++) {
        shape_set *set = at(morph, step / 10.0);
        shape_ellipsoid g = set->lists[0].ellipsoids[0];
        shape_box box = shape_ellipsoid_box(&g, 1);
        assert_float_equal(box.max.x, 4, 1e-5);
        assert_float_equal(box.max.y, 4, 1e-5);
        assert_float_equal(box.max.z, 4, 1e-5);
        shape_set_destroy(set);
    }
    shape_morph_destroy(morph);
    shape_set_destroy(a);
    shape_set_destroy(b);
}

static void a_cloud_without_a_partner_vanishes(void **state)
{
    (void)state;
    shape_error error;
    shape_set *a = heap(1, 5), *b = heap(1, 5), *none = shape_set_create(&error);
    shape_set_add_cloud(a, "second", NULL, &error);
    shape_sphere s = {9, 9, 9, 2};
    shape_primitives_add_sphere(shape_set_list(a, 1), s, &error);
    shape_morph *morph;
    assert_int_equal(shape_morph_create(a, b, &morph, &error), SHAPE_OK);
    shape_set *half = at(morph, 0.5), *end = at(morph, 1);
    assert_true(half->lists[1].spheres[0].radius == 1 && half->lists[1].spheres[0].x == 9);
    assert_int_equal(end->lists[1].sphere_count, 0);
    shape_set_destroy(half);
    shape_set_destroy(end);
    shape_morph_destroy(morph);
    assert_int_equal(shape_morph_create(none, none, &morph, &error), SHAPE_OK);
    half = at(morph, 0.5);
    assert_int_equal(half->cloud_count, 0);
    shape_set_destroy(half);
    assert_int_equal(shape_morph_at(morph, 1.5, &half, &error), SHAPE_ERROR_ARGUMENT);
    shape_morph_destroy(morph);
    b->clouds[0].field.model = SHAPE_MODEL_METABALL;
    assert_int_equal(shape_morph_create(a, b, &morph, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "models"));
    shape_set_destroy(a);
    shape_set_destroy(b);
    shape_set_destroy(none);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_ends_are_the_ends),
        cmocka_unit_test(the_same_shape_moves_as_one),
        cmocka_unit_test(what_hangs_together_stays_together),
        cmocka_unit_test(equal_ellipsoids_do_not_turn),
        cmocka_unit_test(a_cloud_without_a_partner_vanishes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
