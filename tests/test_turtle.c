/* The turtle against closed forms: directions, a square, a helix, brackets, sizes, ellipsoids, refusals. Positions are
 * single precision near 1, so 1e-6 covers their rounding. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

#include "shape/turtle.h"

/* The primitives of a grammar's text, in a set that the caller destroys. */
static shape_set *grow(const char *text, uint64_t seed, shape_status expected, shape_error *error)
{
    static shape_mistakes mistakes;
    shape_grammar *grammar;
    shape_set *set = shape_set_create(error);
    assert_non_null(set);
    assert_int_equal(shape_set_add_cloud(set, "cloud", NULL, error), SHAPE_OK);
    if (shape_grammar_parse(text, strlen(text), "t", &grammar, &mistakes, error))
        fail_msg("%s", error->text);
    shape_derive_options options = shape_derive_defaults(grammar);
    options.seed = seed;
    error->text[0] = 0;
    shape_status status = shape_grammar_grow(grammar, &options, shape_set_list(set, 0), NULL, error);
    if (status != expected)
        fail_msg("status %d, not %d: %s", status, expected, error->text);
    shape_grammar_destroy(grammar);
    return set;
}

static shape_set *grown(const char *text)
{
    shape_error error;
    return grow(text, 1, SHAPE_OK, &error);
}

static void expect_at(const shape_sphere *s, double x, double y, double z)
{
    if (!(fabs(s->x - x) < 1e-6 && fabs(s->y - y) < 1e-6 && fabs(s->z - z) < 1e-6))
        fail_msg("at %g %g %g, expected %g %g %g", s->x, s->y, s->z, x, y, z);
}

static void each_turn_has_its_direction(void **state)
{
    (void)state;
    /* Where the second sphere lies after one step: head +y, left -x, up +z. */
    static const struct {
        const char *walk;
        double x, y, z;
    } cases[] = {{"F F", 0, 1, 0},
                 {"+(90) F F", -1, 0, 0},
                 {"-(90) F F", 1, 0, 0},
                 {"&(90) F F", 0, 0, -1},
                 {"^(90) F F", 0, 0, 1},
                 {"| F F", 0, -1, 0},
                 {"\\(90) +(90) F F", 0, 0, -1}, /* rolled left: the left side points down */
                 {"/(90) +(90) F F", 0, 0, 1},
                 {"\\(90) ^(90) F F", -1, 0, 0}, /* and the back to the left */
                 {"/(90) ^(90) F F", 1, 0, 0},
                 {"+(30) F F", -0.5, 0.8660254037844386, 0},
                 {"&(60) F F", 0, 0.5, -0.8660254037844386},
                 {"+(-90) F F", 1, 0, 0},
                 {"+(450) F F", -1, 0, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[128];
        snprintf(text, sizeof text, "axiom %s", cases[i].walk);
        shape_set *set = grown(text);
        const shape_primitives *list = shape_set_list_const(set, 0);
        assert_int_equal(list->sphere_count, 2);
        expect_at(&list->spheres[0], 0, 0, 0);
        expect_at(&list->spheres[1], cases[i].x, cases[i].y, cases[i].z);
        shape_set_destroy(set);
    }
}

static void a_square_closes_exactly(void **state)
{
    (void)state;
    shape_set *set = grown("axiom F+F+F+F+F angle 90 length 2");
    const shape_sphere *s = shape_set_list_const(set, 0)->spheres;
    static const float corners[5][2] = {{0, 0}, {0, 2}, {-2, 2}, {-2, 0}, {0, 0}};
    for (int i = 0; i < 5; i++) /* quarter turns are exact, so these are equalities */
        assert_true(s[i].x == corners[i][0] && s[i].y == corners[i][1] && s[i].z == 0);
    shape_set_destroy(set);
}

static void a_helix_keeps_its_radius_and_pitch(void **state)
{
    (void)state;
    /* A step s after a rotation by a about an axis at angle b to the head walks on a helix about that axis. A turn t
     * (about up) followed by a roll p (about the head) is one rotation: its cosine and axis give radius and pitch
     * (closed form by quaternions). Here t = 20, p = 30 degrees and the points lie on a cylinder about that axis. */
    enum { N = 60 };
    shape_set *set = grown("axiom X\nX -> F +(20) \\(30) X\npuffs F\niterations 60");
    const shape_sphere *s = shape_set_list_const(set, 0)->spheres;
    assert_int_equal(shape_set_list_const(set, 0)->sphere_count, N);
    double d2r = acos(-1.0) / 180, ct = cos(10 * d2r), st = sin(10 * d2r), cp = cos(15 * d2r),
           sp = sin(15 * d2r);
    /* In the turtle's axes (head, left, up): turn = (ct, 0, 0, st), roll left = (cp, -sp, 0, 0); head x left = up. */
    double w = ct * cp, h = -ct * sp, l = -st * sp, u = st * cp;
    double sine = sqrt(h * h + l * l + u * u), angle = 2 * atan2(sine, w);
    double along = h / sine;                                        /* advance along the axis, a step */
    double radius = sqrt(1 - along * along) / (2 * sin(angle / 2)); /* chord to radius */
    double chord2 = along * along;
    for (int k = 1; k < N; k++) {
        /* The distance of points k steps apart is the same everywhere on a helix. */
        double expected = sqrt(chord2 * k * k + pow(2 * radius * sin(k * angle / 2), 2));
        double dx = s[k].x - s[0].x, dy = s[k].y - s[0].y, dz = s[k].z - s[0].z;
        assert_true(fabs(sqrt(dx * dx + dy * dy + dz * dz) - expected) <
                    1e-4); /* floats at 30 m: 2e-6 each */
    }
    shape_set_destroy(set);
}

static void brackets_restore_everything(void **state)
{
    (void)state;
    shape_set *set = grown("axiom F [ !(0.5) +(90) F @(1,2,1) &(40) F ] F ! F shrink 0.25 puffs F");
    const shape_primitives *list = shape_set_list_const(set, 0);
    const shape_sphere *s = list->spheres;
    assert_int_equal(list->sphere_count, 4);
    assert_int_equal(list->ellipsoid_count, 1);
    expect_at(&s[1], 0, 1, 0);
    assert_true(s[1].radius == 0.5f);
    expect_at(&s[2], 0, 1, 0);
    assert_true(s[2].radius == 1);
    expect_at(&s[3], 0, 2, 0); /* the step after '!' is a quarter, but it comes after this sphere */
    assert_true(s[3].radius == 0.25f);
    shape_set_destroy(set);
}

static void arguments_and_settings_give_sizes(void **state)
{
    (void)state;
    shape_set *set = grown("axiom F F(2) F(3,5) G(-4) F G F radius 0.5 length 0.25");
    const shape_sphere *s = shape_set_list_const(set, 0)->spheres;
    static const double y[] = {0, 0.25, 0.5, 1.5, 2}, r[] = {0.5, 2, 3, 0.5, 0.5};
    for (int i = 0; i < 5; i++) {
        expect_at(&s[i], 0, y[i], 0);
        assert_true(s[i].radius == (float)r[i]);
    }
    shape_set_destroy(set);
    set = grown("axiom X\nX -> F X\npuffs F\nshrink 0.5\niterations 4"); /* 1/2, 1/4, 1/8, 1/16 */
    s = shape_set_list_const(set, 0)->spheres;
    double at = 0;
    for (int i = 0; i < 4; i++) {
        assert_true(s[i].radius == (float)ldexp(1, -i - 1));
        expect_at(&s[i], 0, at, 0);
        at += s[i].radius;
    }
    shape_set_destroy(set);
}

static void ellipsoids_follow_the_turtle(void **state)
{
    (void)state;
    shape_set *set = grown("axiom @(1,3,0.5) -(90) F(2) @(2,2,2) F(1) @ F(1) puffs F");
    const shape_primitives *list = shape_set_list_const(set, 0);
    assert_int_equal(list->ellipsoid_count, 1);
    assert_int_equal(list->sphere_count, 2);
    const shape_ellipsoid *e = list->ellipsoids;
    assert_true(e->a == 2 && e->b == 6 && e->c == 1);
    /* Turned right, forward is +x, right is -y, up still +z. */
    shape_box box = shape_ellipsoid_box(e, 1);
    assert_true(fabsf(box.max.x - 6) < 1e-5f && fabsf(box.max.y - 2) < 1e-5f && fabsf(box.max.z - 1) < 1e-5f);
    shape_vec3 forward = shape_quat_rotate(e->q, shape_vec3_make(0, 1, 0));
    assert_true(fabsf(forward.x - 1) < 1e-6f);
    assert_true(list->spheres[0].radius == 2 && list->spheres[1].radius == 1);
    shape_set_destroy(set);
    set = grown("axiom F stretch 1,1,2");
    assert_int_equal(shape_set_list_const(set, 0)->ellipsoid_count, 1);
    shape_set_destroy(set);
}

static void ranges_are_drawn_at_each_use(void **state)
{
    (void)state;
    /* Fifty radii in [1, 2): all different and in range; the same seed gives the same, another one others. */
    const char *text = "axiom X\nX -> F X\npuffs F\nradius 1..2 length 0..1 angle 0..90\niterations 50";
    shape_error error;
    shape_set *a = grow(text, 1, SHAPE_OK, &error), *b = grow(text, 1, SHAPE_OK, &error),
              *c = grow(text, 2, SHAPE_OK, &error);
    const shape_sphere *s = shape_set_list_const(a, 0)->spheres, *t = shape_set_list_const(b, 0)->spheres,
                       *u = shape_set_list_const(c, 0)->spheres;
    assert_memory_equal(s, t, 50 * sizeof *s);
    for (int i = 0; i < 50; i++) {
        assert_true(s[i].radius >= 1 && s[i].radius <= 2);
        assert_true(s[i].radius != u[i].radius);
        for (int j = 0; j < i; j++)
            assert_true(s[i].radius != s[j].radius);
        if (i)
            assert_true(s[i].y >= s[i - 1].y && s[i].y - s[i - 1].y <= 1);
    }
    shape_set_destroy(a);
    shape_set_destroy(b);
    shape_set_destroy(c);
}

static void refusals_name_the_place(void **state)
{
    (void)state;
    static const struct {
        const char *text, *part;
        shape_status status;
    } cases[] = {
        {"axiom X(2)\nX(n) -> F(n) X(n-1)\npuffs F", "t:2:9: the radius is 0", SHAPE_ERROR_ARGUMENT},
        {"axiom F(0-1)", "t:1:7: the radius is -1", SHAPE_ERROR_ARGUMENT},
        {"axiom X\nX -> F X\nshrink 0.001 iterations 9", "t:2:6: the radius is 1e-12", SHAPE_ERROR_ARGUMENT},
        {"axiom G(2e9)", "t:1:7: the distance from the origin is 2e+09", SHAPE_ERROR_LIMIT},
        {"axiom +(1e10)", "t:1:7: the turn is 1e+10", SHAPE_ERROR_ARGUMENT},
        {"axiom F !(0)", "t:1:9: the factor on the radius is 0", SHAPE_ERROR_ARGUMENT},
        {"axiom @(0,1,1)", "t:1:7: a stretch factor is 0", SHAPE_ERROR_ARGUMENT},
        {"axiom x\nx -> [[x]]\niterations 60000", "t:2:6: the number of open brackets", SHAPE_ERROR_LIMIT},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        shape_error error;
        shape_set_destroy(grow(cases[i].text, 1, cases[i].status, &error));
        if (!strstr(error.text, cases[i].part))
            fail_msg("\"%s\" does not say \"%s\"", error.text, cases[i].part);
    }
}

static void the_examples_grow(void **state)
{
    (void)state;
    /* Every example makes a cloud of 60 to 600 puffs, all with finite boxes, whatever the seed. */
    static const char *const names[] = {"castellanus", "spiral", "tree-of-puffs", "jet-stream",
                                        "tower",       "anvil",  "cirrus-wisps",  "scattered"};
    static char text[16384];
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char path[512];
        snprintf(path, sizeof path, "%s/%s.lsys", EXAMPLES, names[i]);
        FILE *file = fopen(path, "rb");
        assert_non_null(file);
        text[fread(text, 1, sizeof text - 1, file)] = 0;
        fclose(file);
        for (uint64_t seed = 1; seed <= 5; seed++) {
            shape_error error;
            shape_set *set = grow(text, seed, SHAPE_OK, &error);
            size_t count = shape_primitives_count(shape_set_list_const(set, 0));
            if (count < 60 || count > 600)
                fail_msg("%s has %zu primitives with seed %d", names[i], count, (int)seed);
            shape_set_destroy(set);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_turn_has_its_direction),
        cmocka_unit_test(a_square_closes_exactly),
        cmocka_unit_test(a_helix_keeps_its_radius_and_pitch),
        cmocka_unit_test(brackets_restore_everything),
        cmocka_unit_test(arguments_and_settings_give_sizes),
        cmocka_unit_test(ellipsoids_follow_the_turtle),
        cmocka_unit_test(ranges_are_drawn_at_each_use),
        cmocka_unit_test(refusals_name_the_place),
        cmocka_unit_test(the_examples_grow),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
