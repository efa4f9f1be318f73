/* Containment pruning: the tree against the double loop that it stands for, ellipsoids against a search for the point
 * that sticks out farthest, and hollowing. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "shape/gaussian.h"
#include "shape/prune.h"
#include "shape/random.h"
#include "shape/transform.h"

static void free_list(shape_primitives *list)
{
    free(list->spheres);
    free(list->ellipsoids);
}

static shape_primitives copy_of(const shape_primitives *list)
{
    shape_primitives copy = {0};
    shape_error error;
    assert_int_equal(shape_primitives_reserve(&copy, list->sphere_count, list->ellipsoid_count, &error),
                     SHAPE_OK);
    for (size_t i = 0; i < list->sphere_count; i++)
        shape_primitives_add_sphere(&copy, list->spheres[i], &error);
    for (size_t i = 0; i < list->ellipsoid_count; i++) {
        copy.ellipsoids[i] = list->ellipsoids[i];
        copy.ellipsoid_count++;
    }
    return copy;
}

/* --- the double loop --- */

static bool same(const shape_ellipsoid *a, const shape_ellipsoid *b)
{
    return !memcmp(a, b, sizeof *a);
}

static bool goes_for(const shape_primitives *list, size_t i, size_t j)
{
    size_t n = list->sphere_count;
    if (i == j)
        return false;
    if (i < n && j < n) {
        const shape_sphere *a = &list->spheres[i], *b = &list->spheres[j];
        double slack = (double)b->radius - a->radius;
        if (slack < 0)
            return false;
        double x = (double)a->x - b->x, y = (double)a->y - b->y, z = (double)a->z - b->z;
        bool inside = slack * slack >= x * x + y * y + z * z; /* Eq. 17 */
        return inside && (slack > 0 || j < i);
    }
    shape_ellipsoid a = i < n ? shape_ellipsoid_from_sphere(&list->spheres[i]) : list->ellipsoids[i - n];
    shape_ellipsoid b = j < n ? shape_ellipsoid_from_sphere(&list->spheres[j]) : list->ellipsoids[j - n];
    if (i >= n && j >= n && same(&a, &b))
        return j < i;
    return shape_ellipsoid_contains(&b, &a);
}

static void prune_by_double_loop(shape_primitives *list)
{
    size_t count = shape_primitives_count(list), n = list->sphere_count, kept = 0;
    bool *gone = calloc(count + 1, sizeof *gone);
    assert_non_null(gone);
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < count && !gone[i]; j++)
            gone[i] = goes_for(list, i, j);
    for (size_t i = 0; i < n; i++)
        if (!gone[i])
            list->spheres[kept++] = list->spheres[i];
    list->sphere_count = kept;
    kept = 0;
    for (size_t i = n; i < count; i++)
        if (!gone[i])
            list->ellipsoids[kept++] = list->ellipsoids[i - n];
    list->ellipsoid_count = kept;
    free(gone);
}

/* Prunes both ways and compares; returns how many went. */
static size_t compare_with_twin(shape_primitives *list, const char *what)
{
    shape_primitives twin = copy_of(list);
    size_t before = shape_primitives_count(list), removed = 0;
    shape_error error;
    assert_int_equal(shape_primitives_prune(list, &removed, &error), SHAPE_OK);
    prune_by_double_loop(&twin);
    if (list->sphere_count != twin.sphere_count || list->ellipsoid_count != twin.ellipsoid_count)
        fail_msg("%s: of %zu, the tree keeps %zu + %zu, the double loop %zu + %zu", what, before,
                 list->sphere_count, list->ellipsoid_count, twin.sphere_count, twin.ellipsoid_count);
    assert_int_equal(removed, before - shape_primitives_count(list));
    if (list->sphere_count)
        assert_memory_equal(list->spheres, twin.spheres, list->sphere_count * sizeof *list->spheres);
    if (list->ellipsoid_count)
        assert_memory_equal(list->ellipsoids, twin.ellipsoids,
                            list->ellipsoid_count * sizeof *list->ellipsoids);
    free_list(&twin);
    free_list(list);
    return removed;
}

/* --- random sets --- */

static shape_sphere random_sphere(shape_random *r, double side, double small, double large)
{
    shape_sphere s = {(float)shape_random_range(r, 0, side), (float)shape_random_range(r, 0, side),
                      (float)shape_random_range(r, 0, side), (float)shape_random_range(r, small, large)};
    return s;
}

static shape_ellipsoid random_ellipsoid(shape_random *r, double side, double small, double large)
{
    shape_sphere s = random_sphere(r, side, small, large);
    shape_ellipsoid e = {.x = s.x, .y = s.y, .z = s.z, .a = s.radius};
    e.b = (float)shape_random_range(r, small, large);
    e.c = (float)shape_random_range(r, small, large);
    shape_quat q = {(float)shape_random_normal(r), (float)shape_random_normal(r),
                    (float)shape_random_normal(r), (float)shape_random_normal(r)};
    e.q = shape_quat_normalize(q);
    return e;
}

static shape_primitives random_spheres(size_t count, uint64_t seed, double side, double small, double large)
{
    shape_primitives list = {0};
    shape_error error;
    shape_random r = shape_random_seed(seed, 3);
    for (size_t i = 0; i < count; i++)
        assert_int_equal(shape_primitives_add_sphere(&list, random_sphere(&r, side, small, large), &error),
                         SHAPE_OK);
    return list;
}

static void the_tree_gives_what_the_double_loop_gives(void **state)
{
    (void)state;
    static const size_t counts[] = {0, 1, 2, 3, 7, 34, 63, 64, 65, 66, 100, 511, 512, 513, 5000};
    for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
        /* Few overlap, many overlap, sizes over five decades. */
        static const double sides[] = {100, 10, 3};
        static const double smalls[] = {0.5, 0.5, 1e-4};
        static const double larges[] = {1.5, 3, 10};
        size_t gone = 0;
        for (int k = 0; k < 3; k++) {
            shape_primitives list =
                random_spheres(counts[c], c + 10 * (size_t)k, sides[k], smalls[k], larges[k]);
            gone += compare_with_twin(&list, "uniform");
        }
        assert_true(counts[c] < 34 || gone > 0); /* else nothing was tested */
    }
}

static void hard_sets_too(void **state)
{
    (void)state;
    enum { COUNT = 1000 };
    shape_error error;
    shape_random r = shape_random_seed(1, 4);
    shape_primitives one_centre = {0}, all_equal = {0}, twice = {0}, grid = {0}, far = {0};
    for (int i = 0; i < COUNT; i++) {
        shape_sphere s = random_sphere(&r, 5, 0.5, 1), c = {1, 2, 3, (float)shape_random_range(&r, 1, 2)};
        shape_sphere equal = {4, 4, 4, 1}, on_grid = {(float)(i % 10), (float)(i / 10 % 10), 0, 1};
        shape_sphere apart = s;
        apart.x *= i % 7 ? 1e-20f : 1e20f;
        on_grid.radius += (float)(i % 3);
        shape_primitives_add_sphere(&one_centre, c, &error);
        shape_primitives_add_sphere(&all_equal, equal, &error);
        shape_primitives_add_sphere(&twice, s, &error);
        shape_primitives_add_sphere(&twice, s, &error);
        shape_primitives_add_sphere(&grid, on_grid, &error);
        shape_primitives_add_sphere(&far, apart, &error);
    }
    assert_int_equal(compare_with_twin(&all_equal, "all equal"), COUNT - 1);
    assert_true(compare_with_twin(&one_centre, "one centre") >= COUNT - 1 - 2);
    assert_true(compare_with_twin(&twice, "each twice") >= COUNT);
    assert_true(compare_with_twin(&grid, "touching on a grid") > 0);
    assert_true(compare_with_twin(&far, "far apart") > 0);
}

static void a_cumulus_loses_nothing_by_the_sum_under_the_root(void **state)
{
    (void)state;
    /* Eq. 16 falls by less than a metre a metre, so no sphere of it lies inside another one; the inverse law's do.
     * (Clamping to the edge would make equal spheres at the corners of the base.) */
    shape_gaussian o = shape_gaussian_defaults();
    o.count = 5000;
    o.clamp_mode = SHAPE_CLAMP_REJECT;
    o.prune = false;
    shape_primitives list = {0}, inverse = {0};
    shape_error error;
    assert_int_equal(shape_gaussian_make(&o, 1, &list, NULL, &error), SHAPE_OK);
    o.radius_law = SHAPE_RADIUS_INVERSE;
    o.max_radius = 15;
    assert_int_equal(shape_gaussian_make(&o, 1, &inverse, NULL, &error), SHAPE_OK);
    assert_int_equal(compare_with_twin(&list, "Eq. 16"), 0);
    assert_true(compare_with_twin(&inverse, "Eq. 15") > 100);
}

static void mixed_with_ellipsoids_too(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 4; seed++) {
        shape_random r = shape_random_seed(seed, 5);
        shape_primitives list = {0};
        shape_error error;
        for (int i = 0; i < 150; i++) {
            shape_ellipsoid e = random_ellipsoid(&r, 6, 0.3, 3);
            shape_primitives_add_sphere(&list, random_sphere(&r, 6, 0.2, 2), &error);
            shape_primitives_add_ellipsoid(&list, e, &error);
            if (i % 5 == 0)
                shape_primitives_add_ellipsoid(&list, e, &error);
        }
        assert_true(compare_with_twin(&list, "mixed") > 30); /* the 30 doubles, and more */
    }
}

/* --- the tests themselves --- */

static void eq_17_counts_touching_as_inside(void **state)
{
    (void)state;
    shape_sphere outer = {0, 0, 0, 7}, touching = {3, 4, 0, 2}, out = {3, 4, 0, 2.0001f},
                 equal = {0, 0, 0, 7};
    assert_true(shape_sphere_contains(outer, touching));
    assert_false(shape_sphere_contains(outer, out));
    assert_false(shape_sphere_contains(touching, outer));
    assert_true(shape_sphere_contains(outer, equal));
}

static void of_equal_ones_the_first_stays_in_its_place(void **state)
{
    (void)state;
    shape_primitives list = {0};
    shape_error error;
    const shape_sphere in[] = {{9, 0, 0, 1}, {0, 0, 0, 1}, {9, 0, 0, 1},
                               {0, 0, 0, 2}, {0, 0, 0, 2}, {5, 0, 0, 1}};
    for (size_t i = 0; i < 6; i++)
        shape_primitives_add_sphere(&list, in[i], &error);
    assert_int_equal(shape_primitives_prune(&list, NULL, &error), SHAPE_OK);
    const shape_sphere out[] = {{9, 0, 0, 1}, {0, 0, 0, 2}, {5, 0, 0, 1}};
    assert_int_equal(list.sphere_count, 3);
    assert_memory_equal(list.spheres, out, sizeof out);
    free_list(&list);
}

/* v, in the space where `outer` is the unit ball. */
static shape_dvec3 into(const shape_ellipsoid *outer, shape_dvec3 v)
{
    double m[3][3];
    shape_quat_matrix(outer->q, m);
    return shape_dvec3_make((m[0][0] * v.x + m[1][0] * v.y + m[2][0] * v.z) / outer->a,
                            (m[0][1] * v.x + m[1][1] * v.y + m[2][1] * v.z) / outer->b,
                            (m[0][2] * v.x + m[1][2] * v.y + m[2][2] * v.z) / outer->c);
}

/* How far `inner` reaches in `outer`, 1 being its surface: |q + B v| climbs when v turns to B^T (q + B v), from twenty
 * starts. A lower bound of the truth, and in practice the truth. */
static double farthest(const shape_ellipsoid *outer, const shape_ellipsoid *inner, shape_random *r)
{
    double m[3][3], best = 0;
    const double axes[3] = {inner->a, inner->b, inner->c};
    shape_quat_matrix(inner->q, m);
    shape_dvec3 column[3],
        q = {(double)inner->x - outer->x, (double)inner->y - outer->y, (double)inner->z - outer->z};
    q = into(outer, q);
    for (int k = 0; k < 3; k++)
        column[k] = into(outer, shape_dvec3_make(m[0][k] * axes[k], m[1][k] * axes[k], m[2][k] * axes[k]));
    for (int start = 0; start < 20; start++) {
        double v[3] = {shape_random_normal(r), shape_random_normal(r), shape_random_normal(r)};
        double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        shape_dvec3 at = q;
        for (int step = 0; step < 300; step++) {
            at = q;
            for (int k = 0; k < 3; k++)
                at = shape_dvec3_add(at, shape_dvec3_scale(column[k], v[k] / length));
            for (int k = 0; k < 3; k++)
                v[k] = shape_dvec3_dot(column[k], at);
            length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        }
        best = fmax(best, shape_dvec3_length(at));
    }
    return best;
}

static void ellipsoids_are_inside_when_no_point_sticks_out(void **state)
{
    (void)state;
    shape_random r = shape_random_seed(1, 6);
    int inside = 0, outside = 0, close = 0;
    for (int i = 0; i < 400; i++) {
        shape_ellipsoid outer = random_ellipsoid(&r, 1, 0.2, 3), inner = random_ellipsoid(&r, 1, 0.05, 1);
        double reach = farthest(&outer, &inner, &r);
        if (i % 2) { /* scale the outer one until they nearly touch, by a hair on either side */
            double hair = i % 4 == 1 ? 1 + 2e-5 : 1 - 2e-5;
            for (int k = 0; k < 8; k++) {
                outer.a *= (float)(reach * hair), outer.b *= (float)(reach * hair),
                    outer.c *= (float)(reach * hair);
                reach = farthest(&outer, &inner, &r);
                if (fabs(reach * hair - 1) < 1e-6)
                    break;
            }
            close++;
        }
        bool contained = shape_ellipsoid_contains(&outer, &inner);
        /* The margin is 1e-6; the search's own error and the quaternion's single precision take the rest. */
        if (reach < 1 - 5e-6 && !contained)
            fail_msg("an ellipsoid that reaches %.9g is said to stick out", reach);
        if (reach > 1 + 1e-6 && contained)
            fail_msg("an ellipsoid that reaches %.9g is said to be inside", reach);
        inside += contained;
        outside += !contained;
    }
    assert_true(inside > 80 && outside > 80 && close > 150);
}

static void balls_in_ellipsoids_have_closed_forms(void **state)
{
    (void)state;
    /* A ball on the axis of a needle fits where its curvature allows: at the centre up to the short axis; at d along
     * the long axis a of an ellipsoid (a, b, b), up to b sqrt(1 - d^2 / (a^2 - b^2)). */
    shape_ellipsoid outer = {.a = 3, .b = 1, .c = 1, .q = {0, 0, 0, 1}};
    for (double d = 0; d < 2.6; d += 0.25) {
        double fits = sqrt(1 - d * d / 8);
        shape_sphere in = {(float)d, 0, 0, (float)(fits * (1 - 1e-5))},
                     out = {(float)d, 0, 0, (float)(fits * 1.00001)};
        shape_ellipsoid a = shape_ellipsoid_from_sphere(&in), b = shape_ellipsoid_from_sphere(&out);
        assert_true(shape_ellipsoid_contains(&outer, &a));
        assert_false(shape_ellipsoid_contains(&outer, &b));
    }
    /* An ellipsoid is in a ball about its centre when its longest axis is. */
    shape_sphere ball = {0, 0, 0, 3.001f}, tight = {0, 0, 0, 2.999f};
    shape_ellipsoid a = shape_ellipsoid_from_sphere(&ball), b = shape_ellipsoid_from_sphere(&tight);
    assert_true(shape_ellipsoid_contains(&a, &outer));
    assert_false(shape_ellipsoid_contains(&b, &outer));
}

static void hollowing_takes_the_core_and_never_all(void **state)
{
    (void)state;
    shape_primitives list = {0};
    shape_error error;
    const float xs[] = {-3, -1, 0, 1, 3};
    for (int i = 0; i < 125; i++) {
        shape_sphere s = {xs[i % 5], xs[i / 5 % 5], xs[i / 25], 1};
        shape_primitives_add_sphere(&list, s, &error);
    }
    shape_core core = shape_primitives_core(&list);
    for (int k = 0; k < 3; k++) { /* the five values have mean 0 and variance 4 */
        assert_true(fabs(core.centre[k]) < 1e-12);
        assert_true(fabs(core.half[k] - (k == 1 ? 2.0 / 3 : 1.5)) < 1e-12);
    }
    assert_int_equal(shape_primitives_hollow(&list, &core), 9); /* |x|, |z| < 1.5: 3 x 3; |y| < 2/3: one */
    assert_int_equal(list.sphere_count, 116);
    shape_core all = {{0, 0, 0}, {10, 10, 10}};
    assert_int_equal(shape_primitives_hollow(&list, &all), 0);
    assert_int_equal(list.sphere_count, 116);
    free_list(&list);
    shape_primitives none = {0};
    core = shape_primitives_core(&none);
    assert_int_equal(shape_primitives_hollow(&none, &core), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_tree_gives_what_the_double_loop_gives),
        cmocka_unit_test(hard_sets_too),
        cmocka_unit_test(a_cumulus_loses_nothing_by_the_sum_under_the_root),
        cmocka_unit_test(mixed_with_ellipsoids_too),
        cmocka_unit_test(eq_17_counts_touching_as_inside),
        cmocka_unit_test(of_equal_ones_the_first_stays_in_its_place),
        cmocka_unit_test(ellipsoids_are_inside_when_no_point_sticks_out),
        cmocka_unit_test(balls_in_ellipsoids_have_closed_forms),
        cmocka_unit_test(hollowing_takes_the_core_and_never_all),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
