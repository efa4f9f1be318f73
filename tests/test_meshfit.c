/* Triangles to ellipsoids: the closed forms of Jiménez 2018 Eq. 22 to 30, with Eq. 27 mended, Steiner's circumellipse,
 * and the measure against a square whose coverage is known. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#include "shape/meshfit.h"
#include "shape/random.h"

typedef struct triangle {
    shape_dvec3 corner[3];
} triangle;

static shape_dvec3 random_point(shape_random *random)
{
    return shape_dvec3_make(shape_random_range(random, -1, 1), shape_random_range(random, -1, 1),
                            shape_random_range(random, -1, 1));
}

static triangle random_triangle(shape_random *random)
{
    triangle t = {{random_point(random), random_point(random), random_point(random)}};
    return t;
}

static shape_dvec3 barycentre(const triangle *t)
{
    return shape_dvec3_scale(shape_dvec3_add(t->corner[0], shape_dvec3_add(t->corner[1], t->corner[2])),
                             1.0 / 3);
}

static shape_ellipsoid fitted(const triangle *t, shape_meshfit_kind kind, double scale)
{
    shape_meshfit fit = shape_meshfit_defaults();
    shape_ellipsoid e;
    fit.kind = kind;
    fit.scale = scale;
    assert_true(shape_meshfit_triangle(t->corner, &fit, &e));
    return e;
}

/* Where the ellipsoid's own axis i points. */
static shape_dvec3 axis_of(const shape_ellipsoid *e, int i)
{
    double m[3][3];
    shape_quat_matrix(e->q, m);
    return shape_dvec3_make(m[0][i], m[1][i], m[2][i]);
}

static bool is_good(const shape_ellipsoid *e)
{
    double norm =
        (double)e->q.x * e->q.x + (double)e->q.y * e->q.y + (double)e->q.z * e->q.z + (double)e->q.w * e->q.w;
    return isfinite(e->x) && isfinite(e->y) && isfinite(e->z) && e->a > 0 && e->b > 0 && e->c > 0 &&
           isfinite(e->a) && isfinite(e->b) && isfinite(e->c) && fabs(norm - 1) < 1e-6;
}

/* Eq. 22, 24 to 28: centre, radii, and the longest axis along the longest spoke. Single precision keeps 6e-8 of a
 * component; a turned axis collects a few of them, hence 1e-6. */
static void check_paper(const triangle *t, double scale)
{
    shape_ellipsoid e = fitted(t, SHAPE_MESHFIT_PAPER, scale);
    shape_dvec3 b = barycentre(t), spoke[3];
    double length[3], size[3] = {(double)e.a, (double)e.b, (double)e.c};
    int longest = 0;
    for (int i = 0; i < 3; i++) {
        spoke[i] = shape_dvec3_sub(t->corner[i], b);
        length[i] = shape_dvec3_length(spoke[i]);
        if (length[i] > length[longest])
            longest = i;
    }
    assert_true(is_good(&e));
    assert_true(shape_dvec3_length(
                    shape_dvec3_sub(shape_dvec3_make((double)e.x, (double)e.y, (double)e.z), b)) < 2e-7);
    for (int i = 0; i < 3; i++) {
        double expected = scale * fmax(length[i], SHAPE_MESHFIT_THINNEST * length[longest]);
        assert_true(fabs(size[i] - expected) <= 1e-6 * scale * length[longest]);
    }
    shape_dvec3 along = shape_dvec3_scale(spoke[longest], 1 / length[longest]);
    shape_dvec3 off = shape_dvec3_sub(axis_of(&e, longest), along);
    if (shape_dvec3_length(off) > 1e-6)
        fail_msg("the axis is off by %g", shape_dvec3_length(off));
}

static void test_paper_random(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(7, 0);
    for (int i = 0; i < 20000; i++) {
        triangle t = random_triangle(&random);
        check_paper(&t, 1.1);
    }
}

/* Eq. 29 with Eq. 30: where the paper's formula is defined, the rotation is the same one, not just one that takes the
 * axis to the same place. */
static void test_rodrigues(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(8, 0);
    for (int n = 0; n < 2000; n++) {
        triangle t = random_triangle(&random);
        shape_ellipsoid e = fitted(&t, SHAPE_MESHFIT_PAPER, 1);
        double size[3] = {(double)e.a, (double)e.b, (double)e.c}, r[3][3];
        int k = size[0] >= size[1] && size[0] >= size[2] ? 0 : size[1] >= size[2] ? 1 : 2;
        shape_dvec3 axis = {k == 0, k == 1, k == 2};
        shape_dvec3 spoke = shape_dvec3_normalize(shape_dvec3_sub(t.corner[k], barycentre(&t)));
        shape_dvec3 x = shape_dvec3_cross(axis, spoke);
        double sine = shape_dvec3_length(x), angle = acos(shape_dvec3_dot(axis, spoke));
        if (sine < 0.01)
            continue; /* acos loses half the digits there */
        x = shape_dvec3_scale(x, 1 / sine);
        const double a[3][3] = {{0, -x.z, x.y}, {x.z, 0, -x.x}, {-x.y, x.x, 0}};
        shape_quat_matrix(e.q, r);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                double square = 0;
                for (int m = 0; m < 3; m++)
                    square += a[i][m] * a[m][j];
                double expected = (i == j) + sin(angle) * a[i][j] + (1 - cos(angle)) * square;
                assert_true(fabs(r[i][j] - expected) < 1e-5);
            }
    }
}

/* A triangle whose longest spoke, the first, is `direction`. */
static triangle pointed(shape_dvec3 direction, shape_dvec3 aside)
{
    shape_dvec3 half = shape_dvec3_scale(direction, -0.5);
    triangle t = {{direction, shape_dvec3_add(half, aside), shape_dvec3_sub(half, aside)}};
    return t;
}

/* Eq. 27 divides by zero here: parallel, opposite, and within rounding of either. */
static void test_parallel_opposite(void **state)
{
    (void)state;
    for (double sign = -1; sign <= 1; sign += 2)
        for (int digits = 0; digits <= 20; digits++) {
            double tilt = digits == 20 ? 0 : pow(10, -digits);
            triangle t =
                pointed(shape_dvec3_make(sign, tilt * 0.5, tilt * 0.3), shape_dvec3_make(0, 0.2, 0.1));
            check_paper(&t, 1);
            check_paper(&t, 2);
        }
}

static void test_equal_radii(void **state)
{
    (void)state;
    double h = sqrt(3) / 2;
    triangle t = {{{1, 0, 0}, {-0.5, h, 0}, {-0.5, -h, 0}}};
    shape_ellipsoid e = fitted(&t, SHAPE_MESHFIT_PAPER, 1.1);
    assert_true(is_good(&e));
    assert_true(fabs((double)e.a - 1.1) < 1e-6 && fabs((double)e.b - 1.1) < 1e-6 &&
                fabs((double)e.c - 1.1) < 1e-6);
}

static void test_degenerate(void **state)
{
    (void)state;
    const triangle cases[] = {
        {{{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}}},        /* a corner on the barycentre */
        {{{0, 0, 0}, {1, 1, 1}, {1, 1, 1}}},          /* two corners in one place */
        {{{0, 0, 0}, {3, 0, 0}, {1, 0, 0}}},          /* a line */
        {{{0, 0, 0}, {1, 0, 0}, {0.4, 1e-9, 0}}},     /* a needle */
        {{{0, 0, 0}, {0, -1, 0}, {0, -0.4, 1e-300}}}, /* thinner than squares can tell */
        {{{0, 0, 0}, {1e-20, 0, 0}, {0, 1e-20, 0}}},  /* tiny */
        {{{0, 0, 0}, {1e11, 0, 0}, {0, 1e11, 1}}},    /* huge */
        {{{1e6, 1e6, 1e6}, {1e6 + 1e-3, 1e6, 1e6}, {1e6, 1e6 + 1e-3, 1e6}}}};
    const shape_meshfit_kind kinds[] = {SHAPE_MESHFIT_PAPER, SHAPE_MESHFIT_UPRIGHT, SHAPE_MESHFIT_PLANE};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int k = 0; k < 3; k++) {
            shape_ellipsoid e = fitted(&cases[i], kinds[k], 1.1);
            assert_true(is_good(&e));
        }
    triangle point = {{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}};
    shape_meshfit fit = shape_meshfit_defaults();
    shape_ellipsoid e;
    assert_false(shape_meshfit_triangle(point.corner, &fit, &e));
}

/* Not turned: Eq. 24 alone. */
static void test_upright(void **state)
{
    (void)state;
    triangle t = {{{0, 0, 0}, {3, 0, 0}, {0, 3, 0}}}; /* barycentre 1,1,0 */
    shape_ellipsoid e = fitted(&t, SHAPE_MESHFIT_UPRIGHT, 1);
    assert_true(fabs((double)e.a - sqrt(2)) < 1e-6 && fabs((double)e.b - sqrt(5)) < 1e-6 &&
                fabs((double)e.c - sqrt(5)) < 1e-6);
    assert_true(e.q.w == 1 && e.q.x == 0 && e.q.y == 0 && e.q.z == 0);
}

/* Steiner's circumellipse goes through the corners, lies in the plane, and has 4 pi / (3 sqrt 3) times the area. */
static void test_plane(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(9, 0);
    for (int n = 0; n < 5000; n++) {
        triangle t = random_triangle(&random);
        shape_ellipsoid e = fitted(&t, SHAPE_MESHFIT_PLANE, 1);
        shape_dvec3 normal = shape_dvec3_cross(shape_dvec3_sub(t.corner[1], t.corner[0]),
                                               shape_dvec3_sub(t.corner[2], t.corner[0]));
        double area = shape_dvec3_length(normal) / 2;
        if (area < 0.02)
            continue; /* single precision of a and b against a thin minor axis */
        assert_true(fabs(fabs(shape_dvec3_dot(axis_of(&e, 2), normal)) / (2 * area) - 1) < 1e-6);
        double ab = (double)e.a * (double)e.b;
        assert_true(fabs(ab * acos(-1) / area / (4 * acos(-1) / (3 * sqrt(3))) - 1) < 1e-5);
        assert_true(fabs((double)e.c / sqrt(ab) - 0.3) < 1e-5);
        for (int i = 0; i < 3; i++) {
            shape_dvec3 d = shape_dvec3_sub(t.corner[i], barycentre(&t));
            double x = shape_dvec3_dot(d, axis_of(&e, 0)) / (double)e.a,
                   y = shape_dvec3_dot(d, axis_of(&e, 1)) / (double)e.b;
            /* An axis off by 1e-7 moves y by 1e-7 a / b, and a / b stays below 200 here. */
            assert_true(fabs(x * x + y * y - 1) < 1e-4);
        }
    }
}

static shape_mesh *square(void)
{
    static const shape_dvec3 corner[4] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    static const uint32_t index[6] = {0, 1, 2, 0, 2, 3};
    shape_mesh *mesh = shape_mesh_create(4, 2, NULL);
    assert_non_null(mesh);
    for (int i = 0; i < 4; i++)
        mesh->points[i] = corner[i];
    for (int i = 0; i < 6; i++)
        mesh->indices[i] = index[i];
    mesh->point_count = 4;
    mesh->triangle_count = 2;
    return mesh;
}

/* A sphere of radius 0.3 in the middle of a unit square covers 0.09 pi of it, sticks out by |z| of its points: 0.15 on
 * average, 0.3 at most; all as shares of the diagonal. 1e5 stratified samples: standard deviation below 2e-3; 32
 * points of a Fibonacci spiral: |z| averages exactly 1/2 of the radius. */
static void test_measure(void **state)
{
    (void)state;
    shape_mesh *mesh = square();
    shape_primitives list = {0};
    shape_meshfit_measure m;
    shape_sphere ball = {0.5f, 0.5f, 0, 0.3f};
    assert_int_equal(shape_primitives_add_sphere(&list, ball, NULL), SHAPE_OK);
    assert_int_equal(shape_meshfit_compare(mesh, &list, 100000, &m, NULL), SHAPE_OK);
    assert_true(fabs(m.covered - 0.09 * acos(-1)) < 5e-3);
    assert_true(fabs(m.mean_sticking * sqrt(2) - 0.15) < 1e-5);
    assert_true(m.max_sticking * sqrt(2) < 0.3 && m.max_sticking * sqrt(2) > 0.28);
    free(list.spheres);
    shape_mesh_destroy(mesh);
}

/* The reason for --fit: on a flat square it covers all, as the paper's does, and sticks out less. */
static void test_fit_is_tighter(void **state)
{
    (void)state;
    shape_mesh *mesh = square();
    shape_meshfit_measure m[2];
    for (int i = 0; i < 2; i++) {
        shape_primitives list = {0};
        shape_meshfit fit = shape_meshfit_defaults();
        fit.kind = i ? SHAPE_MESHFIT_PLANE : SHAPE_MESHFIT_PAPER;
        assert_int_equal(shape_meshfit_add(mesh, &fit, &list, NULL), SHAPE_OK);
        assert_int_equal(list.ellipsoid_count, 2);
        assert_int_equal(shape_meshfit_compare(mesh, &list, 20000, &m[i], NULL), SHAPE_OK);
        free(list.ellipsoids);
    }
    shape_mesh_destroy(mesh);
    assert_true(m[1].covered == 1);
    assert_true(m[1].mean_sticking < 0.8 * m[0].mean_sticking);
}

static void test_options(void **state)
{
    (void)state;
    shape_error error;
    shape_meshfit fit = shape_meshfit_defaults();
    assert_int_equal(shape_meshfit_check(&fit, &error), SHAPE_OK);
    fit.scale = 0;
    assert_int_equal(shape_meshfit_check(&fit, &error), SHAPE_ERROR_ARGUMENT);
    fit = shape_meshfit_defaults();
    fit.thickness = NAN;
    assert_int_equal(shape_meshfit_check(&fit, &error), SHAPE_ERROR_ARGUMENT);
    fit = shape_meshfit_defaults();
    fit.kind = (shape_meshfit_kind)7;
    assert_int_equal(shape_meshfit_check(&fit, &error), SHAPE_ERROR_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_paper_random),
                                       cmocka_unit_test(test_rodrigues),
                                       cmocka_unit_test(test_parallel_opposite),
                                       cmocka_unit_test(test_equal_radii),
                                       cmocka_unit_test(test_degenerate),
                                       cmocka_unit_test(test_upright),
                                       cmocka_unit_test(test_plane),
                                       cmocka_unit_test(test_measure),
                                       cmocka_unit_test(test_fit_is_tighter),
                                       cmocka_unit_test(test_options)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
