/* Sets made one, and lists that are changed for some of their clouds. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "shape/combine.h"

/* Clouds a, b and a copy of a; list 0 has a sphere of this radius, list 1 one of twice that; one unknown chunk. */
static shape_set *sample_set(float radius)
{
    shape_error error;
    shape_set *set = shape_set_create(&error);
    shape_set_add_cloud(set, "a", NULL, &error);
    shape_set_add_cloud(set, "b", NULL, &error);
    shape_sphere s = {1, 2, 3, radius}, t = {1, 2, 3, 2 * radius};
    shape_primitives_add_sphere(shape_set_list(set, 0), s, &error);
    shape_primitives_add_sphere(shape_set_list(set, 1), t, &error);
    shape_frame frame = shape_frame_identity();
    frame.m[0][3] = radius;
    shape_set_add_copy(set, 0, &frame, NULL, &error);
    set->clouds[0].seed = 17;
    set->clouds[2].field.kappa = 0.25f;
    shape_set_add_extra(set, "Xtra", 1, "hello", 5, &error);
    return set;
}

static void appending_keeps_what_is_shared(void **state)
{
    (void)state;
    shape_set *set = sample_set(1), *other = sample_set(10);
    shape_error error;
    assert_int_equal(shape_set_append(set, other, &error), SHAPE_OK);
    assert_int_equal(shape_set_append(set, other, &error), SHAPE_OK);
    shape_set_destroy(other);
    assert_int_equal(shape_set_check(set, &error), SHAPE_OK); /* names are unique, lists in range */
    assert_int_equal(set->cloud_count, 9);
    assert_int_equal(set->list_count, 6);
    static const uint32_t lists[] = {0, 1, 0, 2, 3, 2, 4, 5, 4};
    for (size_t i = 0; i < 9; i++)
        assert_int_equal(set->clouds[i].list, lists[i]);
    assert_true(set->lists[3].spheres[0].radius == 20 && set->lists[1].spheres[0].radius == 2);
    assert_int_equal(set->clouds[6].seed, 17);
    assert_true(set->clouds[8].field.kappa == 0.25f && set->clouds[8].frame.m[0][3] == 10);
    assert_string_equal(set->clouds[0].name, "a");
    assert_int_equal(set->extra_count, 3);
    assert_int_equal(set->extras[2].list, 5);
    assert_memory_equal(set->extras[2].bytes, "hello", 5);
    shape_set_destroy(set);
}

/* The key is the cloud's own factor. */
static shape_status describe(const shape_set *set, size_t cloud, void *key, void *context, shape_error *error)
{
    (void)set, (void)error;
    memcpy(key, (const float *)context + cloud, sizeof(float));
    return SHAPE_OK;
}

static shape_status apply(shape_primitives *list, uint32_t number, const void *key, void *context,
                          shape_error *error)
{
    (void)number, (void)context, (void)error;
    float factor;
    memcpy(&factor, key, sizeof factor);
    for (size_t i = 0; i < list->sphere_count; i++)
        list->spheres[i].radius *= factor;
    return factor > 0 ? SHAPE_OK : shape_error_set(error, SHAPE_ERROR_ARGUMENT, "a factor of 0");
}

static float radius_of(const shape_set *set, size_t cloud)
{
    return shape_set_list_const(set, cloud)->spheres[0].radius;
}

static void change(shape_set *set, const bool *selected, float a, float b, float copy)
{
    float factors[] = {a, b, copy};
    shape_list_change what = {sizeof(float), describe, apply, factors};
    shape_error error;
    assert_int_equal(shape_set_change_lists(set, selected, &what, &error), SHAPE_OK);
    assert_int_equal(shape_set_check(set, &error), SHAPE_OK);
}

static void equal_changes_go_on_sharing(void **state)
{
    (void)state;
    shape_set *set = sample_set(1);
    change(set, NULL, 3, 5, 3);
    assert_int_equal(set->list_count, 2);
    assert_true(radius_of(set, 0) == 3 && radius_of(set, 1) == 10 && radius_of(set, 2) == 3);
    assert_int_equal(set->clouds[0].list, 0); /* numbers stay, since unknown chunks may speak of them */
    assert_int_equal(set->clouds[1].list, 1);
    assert_int_equal(set->clouds[2].list, 0);
    shape_set_destroy(set);
}

static void unequal_changes_part(void **state)
{
    (void)state;
    shape_set *set = sample_set(1);
    change(set, NULL, 3, 5, 7);
    assert_int_equal(set->list_count, 3);
    assert_true(radius_of(set, 0) == 3 && radius_of(set, 1) == 10 && radius_of(set, 2) == 7);
    shape_set_destroy(set);
}

static void the_others_keep_theirs(void **state)
{
    (void)state;
    shape_set *set = sample_set(1);
    const bool copy_only[] = {false, false, true}, b_only[] = {false, true, false},
               none[] = {false, false, false};
    change(set, copy_only, 3, 5, 7);
    assert_int_equal(set->list_count, 3);
    assert_true(radius_of(set, 0) == 1 && radius_of(set, 1) == 2 && radius_of(set, 2) == 7);
    change(set, b_only, 3, 5, 7);
    assert_int_equal(set->list_count, 3);
    assert_true(radius_of(set, 0) == 1 && radius_of(set, 1) == 10 && radius_of(set, 2) == 7);
    change(set, none, 3, 5, 7);
    assert_true(radius_of(set, 0) == 1 && radius_of(set, 1) == 10 && radius_of(set, 2) == 7);
    shape_set_destroy(set);
}

static void errors_come_through(void **state)
{
    (void)state;
    shape_set *set = sample_set(1);
    float factors[] = {1, 0, 1};
    shape_list_change what = {sizeof(float), describe, apply, factors};
    shape_error error;
    assert_int_equal(shape_set_change_lists(set, NULL, &what, &error), SHAPE_ERROR_ARGUMENT);
    assert_string_equal(error.text, "a factor of 0");
    shape_set_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(appending_keeps_what_is_shared),
        cmocka_unit_test(equal_changes_go_on_sharing),
        cmocka_unit_test(unequal_changes_part),
        cmocka_unit_test(the_others_keep_theirs),
        cmocka_unit_test(errors_come_through),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
