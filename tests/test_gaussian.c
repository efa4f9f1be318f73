/* The Gaussian cumulus against its equations: radii, clamping, moments of the truncated normal distribution, what
 * hollowing takes, and the same shape wherever the cloud stands. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "shape/gaussian.h"
#include "shape/scatter.h"

/* Distribution and density of the standard normal distribution. */
static double below(double x)
{
    return 0.5 * erfc(-x / sqrt(2));
}
static double density(double x)
{
    return exp(-x * x / 2) / sqrt(2 * acos(-1));
}

static void expect_near(const char *what, double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance))
        fail_msg("%s is %.9g, expected %.9g to %.3g", what, value, expected, tolerance);
}

static void free_list(shape_primitives *list)
{
    free(list->spheres);
    free(list->ellipsoids);
}

static shape_primitives make(const shape_gaussian *options, uint64_t seed, shape_gaussian_report *report)
{
    shape_primitives list = {0};
    shape_error error;
    if (shape_gaussian_make(options, seed, &list, report, &error))
        fail_msg("%s", error.text);
    return list;
}

static void radii_follow_the_equations(void **state)
{
    (void)state;
    shape_gaussian o = shape_gaussian_defaults();
    /* Eq. 16 with a sum under the root. Double rounding only. */
    expect_near("Eq. 16 at the centre", shape_gaussian_radius(&o, shape_dvec3_make(0, 0, 0)), 2.9, 1e-15);
    expect_near("Eq. 16 at two sigma of x", shape_gaussian_radius(&o, shape_dvec3_make(-7.6, 0, 0)),
                2.9 * 0.9, 1e-14);
    expect_near("Eq. 16 at the corner", shape_gaussian_radius(&o, shape_dvec3_make(7.6, 3.4, -7.4)),
                2.9 * (1 - 0.1 * sqrt(3)), 1e-14);
    o.sigma[1] = 0;
    expect_near("Eq. 16 without a spread in y", shape_gaussian_radius(&o, shape_dvec3_make(7.6, 0, -7.4)),
                2.9 * (1 - 0.1 * sqrt(2)), 1e-14);
    o.radius_law = SHAPE_RADIUS_INVERSE;
    o.max_radius = 16;
    expect_near("Eq. 15", shape_gaussian_radius(&o, shape_dvec3_make(3, 100, -4)), 2, 1e-15);
    /* The largest clamp still gives a positive radius at the farthest corner. */
    o = shape_gaussian_defaults();
    o.clamp = 10;
    assert_true(shape_gaussian_radius(&o, shape_dvec3_make(10 * 3.8, 10 * 1.7, 10 * 3.7)) >
                0.1 * o.max_radius);
}

enum { DRAWS = 200000 };

/* Mean and mean square of the draws of one axis in units of sigma, and the shares at the ends. */
typedef struct moments {
    double mean[3], square[3], low[3], high[3];
} moments;

static moments measure(shape_clamp_mode mode, double clamp)
{
    shape_gaussian o = shape_gaussian_defaults();
    o.clamp = clamp;
    o.clamp_mode = mode;
    shape_random random = shape_random_seed(11, 0);
    moments m = {{0}, {0}, {0}, {0}};
    for (int i = 0; i < DRAWS; i++) {
        shape_dvec3 p = shape_gaussian_point(&o, &random);
        const double v[3] = {p.x / o.sigma[0], p.y / o.sigma[1], p.z / o.sigma[2]};
        for (int k = 0; k < 3; k++) {
            double low = k == 1 ? 0 : -clamp;
            assert_true(v[k] >= low - 1e-12 && v[k] <= clamp + 1e-12);
            m.mean[k] += v[k] / DRAWS;
            m.square[k] += v[k] * v[k] / DRAWS;
            m.low[k] += (v[k] <= low + 1e-12) / (double)DRAWS;
            m.high[k] += (v[k] >= clamp - 1e-12) / (double)DRAWS;
        }
    }
    return m;
}

static void edge_mode_heaps_up_at_the_edges(void **state)
{
    (void)state;
    moments m = measure(SHAPE_CLAMP_EDGE, 2);
    for (int k = 0; k < 3; k++) {
        double low = k == 1 ? 0.5 : below(-2), high = below(-2);
        /* Shares of DRAWS yes-or-no draws, within four standard errors. */
        expect_near("the share at the lower edge", m.low[k], low, 4 * sqrt(low * (1 - low) / DRAWS));
        expect_near("the share at the upper edge", m.high[k], high, 4 * sqrt(high * (1 - high) / DRAWS));
    }
}

static void reject_mode_is_the_truncated_normal(void **state)
{
    (void)state;
    for (double k = 0.5; k < 4; k += 1.5) {
        moments m = measure(SHAPE_CLAMP_REJECT, k);
        double inside = 2 * below(k) - 1, variance = 1 - 2 * k * density(k) / inside;
        double half = below(k) - 0.5, mean = (density(0) - density(k)) / half;
        double y_variance = 1 - k * density(k) / half - mean * mean;
        /* The fourth moment about the mean of a variable within a width w is at most w^2 times its variance, so the
         * standard error of the variance is at most w sqrt(variance / n). */
        for (int axis = 0; axis < 3; axis += 2) {
            expect_near("a mean", m.mean[axis], 0, 4 * sqrt(variance / DRAWS));
            expect_near("a variance", m.square[axis], variance, 4 * k * sqrt(variance / DRAWS));
        }
        expect_near("the mean of y", m.mean[1], mean, 4 * sqrt(y_variance / DRAWS));
        expect_near("the variance of y", m.square[1] - m.mean[1] * m.mean[1], y_variance,
                    4 * k * sqrt(y_variance / DRAWS));
    }
}

/* The mean share that hollowing takes over 1,000 seeds. */
static double hollowed_share(const shape_gaussian *options)
{
    size_t hollowed = 0;
    for (uint64_t seed = 1; seed <= 1000; seed++) {
        shape_gaussian_report report;
        shape_primitives list = make(options, seed, &report);
        assert_int_equal(report.drawn, options->count);
        assert_int_equal(list.sphere_count, report.drawn - report.hollowed - report.pruned);
        hollowed += report.hollowed;
        free_list(&list);
    }
    return (double)hollowed / (1000.0 * (double)options->count);
}

static void hollowing_takes_what_the_distribution_says(void **state)
{
    (void)state;
    shape_gaussian o = shape_gaussian_defaults();
    double side = 2 * below(0.75) - 1, n = 1000.0 * (double)o.count;
    double expected = side * side * below(1.0 / 3); /* half of all y lie on the base, inside the core */
    double share = hollowed_share(&o);
    expect_near("the share hollowed", share, expected, 4 * sqrt(expected * (1 - expected) / n));
    /* The paper says "about 20 %": we find 18.8 %. */
    assert_true(share > 0.18 && share < 0.20);
    /* Drawn anew instead of moved to the edge, fewer lie low: 9.0 %. */
    o.clamp_mode = SHAPE_CLAMP_REJECT;
    double side2 = side / (2 * below(2) - 1);
    expected = side2 * side2 * (below(1.0 / 3) - 0.5) / (below(2) - 0.5);
    expect_near("the share hollowed with reject", hollowed_share(&o), expected,
                4 * sqrt(expected * (1 - expected) / n));
}

static void hollowing_and_pruning_can_be_left_out(void **state)
{
    (void)state;
    shape_gaussian o = shape_gaussian_defaults();
    shape_gaussian_report report;
    shape_primitives hollow = make(&o, 3, &report);
    assert_true(report.hollowed > 0);
    for (size_t i = 0; i < hollow.sphere_count; i++) {
        const shape_sphere *s = &hollow.spheres[i];
        assert_false(fabsf(s->x) < 0.749 * 3.8 && fabsf(s->y) < 0.332 * 1.7 && fabsf(s->z) < 0.749 * 3.7);
    }
    o.hollow = o.prune = false;
    shape_primitives whole = make(&o, 3, &report);
    assert_int_equal(whole.sphere_count, 35);
    assert_int_equal(report.hollowed + report.pruned, 0);
    /* Hollowing leaves the others as they were: they are a subsequence of the whole. */
    size_t found = 0;
    for (size_t i = 0; i < whole.sphere_count && found < hollow.sphere_count; i++)
        found += !memcmp(&whole.spheres[i], &hollow.spheres[found], sizeof *whole.spheres);
    assert_int_equal(found, hollow.sphere_count);
    free_list(&hollow);
    free_list(&whole);
}

static void a_moved_cloud_keeps_its_shape(void **state)
{
    (void)state;
    for (int law = 0; law < 2; law++) {
        shape_gaussian o = shape_gaussian_defaults();
        o.radius_law = (shape_radius_law)law;
        shape_primitives here = make(&o, 4, NULL);
        o.mean[0] = 1000, o.mean[1] = -300, o.mean[2] = 50;
        shape_primitives there = make(&o, 4, NULL);
        assert_int_equal(here.sphere_count, there.sphere_count);
        for (size_t i = 0; i < here.sphere_count; i++) {
            const shape_sphere *a = &here.spheres[i], *b = &there.spheres[i];
            assert_true(a->radius == b->radius);
            /* Single precision at 1000 m: half a unit in the last place is 3e-5 m. */
            expect_near("x", b->x - 1000.0, a->x, 4e-5);
            expect_near("y", b->y + 300.0, a->y, 4e-5);
            expect_near("z", b->z - 50.0, a->z, 4e-5);
        }
        free_list(&here);
        free_list(&there);
    }
}

static void no_cloud_is_empty(void **state)
{
    (void)state;
    shape_gaussian o = shape_gaussian_defaults();
    o.count = 1;
    for (uint64_t seed = 0; seed < 100; seed++) {
        shape_primitives list = make(&o, seed, NULL);
        assert_int_equal(list.sphere_count, 1);
        free_list(&list);
    }
    /* No spread at all: a single ball stands in the middle, the others fall to pruning. */
    o.count = 10;
    o.sigma[0] = o.sigma[1] = o.sigma[2] = 0;
    shape_gaussian_report report;
    shape_primitives list = make(&o, 1, &report);
    assert_int_equal(list.sphere_count, 1);
    assert_int_equal(report.pruned, 9);
    assert_true(list.spheres[0].x == 0 && list.spheres[0].y == 0 && list.spheres[0].radius == 2.9f);
    free_list(&list);
}

static void wrong_options_are_refused(void **state)
{
    (void)state;
    const struct {
        size_t offset;
        double value;
        const char *name;
    } wrong[] = {{offsetof(shape_gaussian, clamp), 0, "clamp"},
                 {offsetof(shape_gaussian, clamp), 11, "clamp"},
                 {offsetof(shape_gaussian, max_radius), 0, "max-radius"},
                 {offsetof(shape_gaussian, sigma), -1, "sigma x"},
                 {offsetof(shape_gaussian, sigma) + 8, NAN, "sigma y"},
                 {offsetof(shape_gaussian, mean) + 16, INFINITY, "mean z"}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        shape_gaussian o = shape_gaussian_defaults();
        memcpy((char *)&o + wrong[i].offset, &wrong[i].value, sizeof wrong[i].value);
        shape_error error;
        shape_primitives list = {0};
        assert_int_equal(shape_gaussian_make(&o, 1, &list, NULL, &error), SHAPE_ERROR_ARGUMENT);
        assert_non_null(strstr(error.text, wrong[i].name));
        assert_null(list.spheres);
    }
    shape_gaussian o = shape_gaussian_defaults();
    o.count = 0;
    shape_error error;
    assert_int_equal(shape_gaussian_check(&o, &error), SHAPE_ERROR_ARGUMENT);
}

/* Height over width of the box around a species' spheres, over 20 seeds. */
static double slenderness(shape_species species)
{
    double ratio = 0;
    shape_gaussian o = shape_gaussian_species(species);
    for (uint64_t seed = 1; seed <= 20; seed++) {
        shape_primitives list = make(&o, seed, NULL);
        shape_box box = shape_box_empty();
        for (size_t i = 0; i < list.sphere_count; i++)
            box = shape_box_join(box, shape_sphere_box(&list.spheres[i], 1));
        ratio += (box.max.y - box.min.y) / (box.max.x - box.min.x + (box.max.z - box.min.z)) * 2 / 20;
        free_list(&list);
    }
    return ratio;
}

static void each_species_has_its_proportions(void **state)
{
    (void)state;
    double humilis = slenderness(SHAPE_SPECIES_HUMILIS), mediocris = slenderness(SHAPE_SPECIES_MEDIOCRIS),
           congestus = slenderness(SHAPE_SPECIES_CONGESTUS);
    assert_true(humilis < 0.5);
    assert_true(mediocris > 0.8 && mediocris < 1.2);
    assert_true(congestus > 1.3);
}

static void clouds_of_a_field_differ_and_keep_their_seed(void **state)
{
    (void)state;
    assert_true(shape_field_seed(7, 0) == 7);
    shape_gaussian o = shape_gaussian_defaults();
    shape_primitives first = make(&o, shape_field_seed(7, 0), NULL),
                     second = make(&o, shape_field_seed(7, 1), NULL);
    assert_true(first.spheres[0].x != second.spheres[0].x);
    free_list(&first);
    free_list(&second);
}

static void scattered_points_keep_their_distance(void **state)
{
    (void)state;
    static const struct {
        size_t count;
        double width, depth;
    } cases[] = {{1, 10, 10}, {2, 10, 10}, {7, 100, 1}, {100, 300, 200}, {1000, 1, 1}, {50, 0.01, 1e6}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        static shape_point2 points[1000], again[1000];
        double spacing, w = cases[c].width, d = cases[c].depth;
        size_t n = cases[c].count;
        shape_error error;
        assert_int_equal(shape_scatter(n, w, d, 5, points, &spacing, &error), SHAPE_OK);
        assert_int_equal(shape_scatter(n, w, d, 5, again, NULL, &error), SHAPE_OK);
        assert_memory_equal(points, again, n * sizeof *points);
        for (size_t i = 0; i < n; i++) {
            assert_true(fabs(points[i].x) <= w / 2 && fabs(points[i].z) <= d / 2);
            for (size_t j = 0; j < i; j++)
                assert_true(hypot(points[i].x - points[j].x, points[i].z - points[j].z) >=
                            spacing * (1 - 1e-12));
        }
        /* Random points saturate at a share of 0.547 for discs of half the distance (Feder 1980), at a distance s with
         * n pi s^2 = 2.19 area; a strip holds more. 1.7 allows for the finite number of darts and steps of 5 %. */
        if (n > 1 && !(((double)n * acos(-1) * spacing * spacing >= 1.7 * w * d)))
            fail_msg("%zu points on %g x %g keep only %g m", n, w, d, spacing);
        /* Points on a line saturate at 0.7476 of the closest packing (Renyi 1958). */
        if (d > 1e5)
            assert_true(spacing > 0.65 * d / (double)n);
    }
    shape_error error;
    shape_point2 point;
    assert_int_equal(shape_scatter(0, 1, 1, 1, &point, NULL, &error), SHAPE_ERROR_ARGUMENT);
    assert_int_equal(shape_scatter(1, 0, 1, 1, &point, NULL, &error), SHAPE_ERROR_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(radii_follow_the_equations),
        cmocka_unit_test(edge_mode_heaps_up_at_the_edges),
        cmocka_unit_test(reject_mode_is_the_truncated_normal),
        cmocka_unit_test(hollowing_takes_what_the_distribution_says),
        cmocka_unit_test(hollowing_and_pruning_can_be_left_out),
        cmocka_unit_test(a_moved_cloud_keeps_its_shape),
        cmocka_unit_test(no_cloud_is_empty),
        cmocka_unit_test(wrong_options_are_refused),
        cmocka_unit_test(each_species_has_its_proportions),
        cmocka_unit_test(clouds_of_a_field_differ_and_keep_their_seed),
        cmocka_unit_test(scattered_points_keep_their_distance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
