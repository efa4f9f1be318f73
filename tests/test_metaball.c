/* The metaball generator: ranges, moments of the radii, the same balls for the same seed. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "shape/metaball.h"

static shape_primitives make(const shape_metaball *options, uint64_t seed)
{
    shape_primitives list = {0};
    shape_error error;
    if (shape_metaball_make(options, seed, &list, &error))
        fail_msg("%s", error.text);
    return list;
}

static void free_list(shape_primitives *list)
{
    free(list->spheres);
    free(list->ellipsoids);
}

static void balls_lie_in_their_ranges(void **state)
{
    (void)state;
    shape_metaball o = shape_metaball_defaults();
    shape_primitives six = make(&o, 1);
    assert_int_equal(six.sphere_count, 6); /* Fig. 13 */
    free_list(&six);
    o.count = 20000;
    shape_primitives list = make(&o, 1);
    double sum = 0;
    for (size_t i = 0; i < list.sphere_count; i++) {
        const shape_sphere *s = &list.spheres[i];
        assert_true(s->radius >= 1.25f && s->radius <= 2.5f);
        assert_true(fabsf(s->x) <= 7.2001f && s->y >= 0 && s->y <= 3.0001f && fabsf(s->z) <= 5.6001f);
        sum += s->radius;
    }
    /* A uniform radius has mean (min + max) / 2 and standard deviation (max - min) / sqrt(12); four standard errors. */
    assert_true(fabs(sum / 20000 - 1.875) < 4 * 1.25 / sqrt(12 * 20000.0));
    free_list(&list);
}

static void the_seed_decides(void **state)
{
    (void)state;
    shape_metaball o = shape_metaball_defaults();
    shape_primitives a = make(&o, 5), b = make(&o, 5), c = make(&o, 6);
    assert_memory_equal(a.spheres, b.spheres, 6 * sizeof *a.spheres);
    assert_true(memcmp(a.spheres, c.spheres, 6 * sizeof *a.spheres));
    free_list(&a);
    free_list(&b);
    free_list(&c);
}

static void equal_radii_and_no_spread(void **state)
{
    (void)state;
    shape_metaball o = {.count = 3, .sigma = {0, 0, 0}, .min_radius = 2, .max_radius = 2};
    shape_primitives list = make(&o, 1);
    for (size_t i = 0; i < 3; i++)
        assert_true(list.spheres[i].radius == 2 && list.spheres[i].x == 0 && list.spheres[i].y == 0);
    free_list(&list);
}

static void wrong_options_are_refused(void **state)
{
    (void)state;
    shape_metaball good = shape_metaball_defaults();
    shape_metaball wrong[5] = {good, good, good, good, good};
    static const char *const names[] = {"count", "sigma z", "max-radius", "min-radius", "min-radius"};
    wrong[0].count = 0;
    wrong[1].sigma[2] = -1;
    wrong[2].max_radius = NAN;
    wrong[3].min_radius = 3;
    wrong[4].min_radius = 0;
    for (int i = 0; i < 5; i++) {
        shape_primitives list = {0};
        shape_error error;
        assert_int_equal(shape_metaball_make(&wrong[i], 1, &list, &error), SHAPE_ERROR_ARGUMENT);
        assert_non_null(strstr(error.text, names[i]));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(balls_lie_in_their_ranges),
        cmocka_unit_test(the_seed_decides),
        cmocka_unit_test(equal_radii_and_no_spread),
        cmocka_unit_test(wrong_options_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
