/* Opaque things: rays against triangles, and the closed forms of matt surfaces under clouds, in the reference and in the
 * march. Comparisons by chance allow four standard errors; seeds are fixed. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "scene_sample.h"
#include "shape/march.h"

static const double pi = 3.14159265358979323846;

static shape_mesh *new_mesh(size_t points, size_t triangles)
{
    shape_error error;
    shape_mesh *mesh = shape_mesh_create(points, triangles, &error);
    if (!mesh)
        fail_msg("%s", error.text);
    mesh->point_count = points;
    mesh->triangle_count = triangles;
    return mesh;
}

/* Adds a mesh and builds the tree. The mesh is destroyed. */
static void add(shape_opaque *opaque, shape_mesh *mesh, const shape_frame *frame, float r, float g, float b)
{
    shape_error error;
    float albedo[3] = {r, g, b};
    if (shape_opaque_add(opaque, mesh, frame, albedo, &error) || shape_opaque_finish(opaque, &error))
        fail_msg("%s", error.text);
    shape_mesh_destroy(mesh);
}

/* The square |x|, |z| <= half at height y, or |x|, |y| <= half at depth z. */
static shape_mesh *square(double half, double at, bool upright)
{
    shape_mesh *mesh = new_mesh(4, 2);
    static const uint32_t corners[6] = {0, 1, 2, 0, 2, 3};
    for (int i = 0; i < 4; i++) {
        double u = i == 1 || i == 2 ? half : -half, v = i < 2 ? -half : half;
        mesh->points[i] = upright ? shape_dvec3_make(u, v, at) : shape_dvec3_make(u, at, v);
    }
    memcpy(mesh->indices, corners, sizeof corners);
    return mesh;
}

/* --- rays --- */

static shape_dvec3 any_point(shape_random *random, double half)
{
    double x = shape_random_range(random, -half, half), y = shape_random_range(random, -half, half);
    return shape_dvec3_make(x, y, shape_random_range(random, -half, half));
}

/* Möller and Trumbore 1997, every triangle. */
static double nearest_by_hand(const shape_mesh *mesh, shape_dvec3 o, shape_dvec3 d)
{
    double nearest = INFINITY;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *k = &mesh->indices[3 * i];
        shape_dvec3 a = mesh->points[k[0]], e = shape_dvec3_sub(mesh->points[k[1]], a),
                    f = shape_dvec3_sub(mesh->points[k[2]], a), s = shape_dvec3_sub(o, a);
        shape_dvec3 p = shape_dvec3_cross(d, f), q = shape_dvec3_cross(s, e);
        double det = shape_dvec3_dot(e, p), u = shape_dvec3_dot(s, p) / det, v = shape_dvec3_dot(d, q) / det;
        double t = shape_dvec3_dot(f, q) / det;
        if (det != 0 && u >= 0 && v >= 0 && u + v <= 1 && t > 0)
            nearest = fmin(nearest, t);
    }
    return nearest;
}

static void the_tree_finds_what_every_triangle_says(void **state)
{
    (void)state;
    enum { TRIANGLES = 500, RAYS = 2000 };
    shape_random random = shape_random_seed(1, 0);
    shape_opaque *opaque = shape_opaque_create(NULL);
    shape_mesh *mesh = new_mesh(3 * TRIANGLES, TRIANGLES), *copy = new_mesh(3 * TRIANGLES, TRIANGLES);
    for (int i = 0; i < TRIANGLES; i++) {
        shape_dvec3 middle = any_point(&random, 5);
        for (int k = 0; k < 3; k++) {
            mesh->points[3 * i + k] = shape_dvec3_add(middle, any_point(&random, 0.7));
            mesh->indices[3 * i + k] = (uint32_t)(3 * i + k);
        }
    }
    memcpy(copy->points, mesh->points, 3 * TRIANGLES * sizeof *mesh->points);
    memcpy(copy->indices, mesh->indices, 3 * TRIANGLES * sizeof *mesh->indices);
    add(opaque, mesh, NULL, 1, 1, 1);
    int hits = 0;
    for (int i = 0; i < RAYS; i++) {
        shape_dvec3 o = any_point(&random, 7), d = shape_dvec3_normalize(any_point(&random, 1));
        shape_opaque_hit hit;
        double truth = nearest_by_hand(copy, o, d);
        bool met = shape_opaque_find(opaque, o, d, INFINITY, &hit);
        assert_int_equal(met, truth < INFINITY);
        assert_int_equal(met, shape_opaque_blocks(opaque, o, d, INFINITY));
        if (!met)
            continue;
        hits++;
        assert_true(fabs(hit.t - truth) < 1e-9 * truth);
        assert_true(shape_dvec3_dot(hit.normal, d) <= 0);
        assert_false(shape_opaque_find(opaque, o, d, truth * 0.999999, &hit));
        assert_true(shape_opaque_blocks(opaque, o, d, truth * 1.000001));
    }
    assert_true(hits > RAYS / 10 && hits < RAYS);
    shape_mesh_destroy(copy);
    shape_opaque_destroy(opaque);
}

/* A closed ball of triangles, 200 km from the origin: no ray from inside gets out, not even through edges and corners. */
static void a_closed_mesh_has_no_holes(void **state)
{
    (void)state;
    enum { N = 12, M = 24 };
    shape_mesh *mesh = new_mesh((N + 1) * M, 2 * N * M);
    shape_frame frame = {{{2, 0, 0, 2e5}, {0, 1, 0, 7}, {0, 0, 1, -1.5e5}}};
    shape_opaque *opaque = shape_opaque_create(NULL);
    shape_random random = shape_random_seed(2, 0);
    for (int i = 0; i <= N; i++)
        for (int j = 0; j < M; j++) {
            double a = pi * i / N, b = 2 * pi * j / M, s = i % N ? sin(a) : 0;
            mesh->points[i * M + j] = shape_dvec3_make(s * cos(b), cos(a), s * sin(b));
        }
    for (int i = 0, t = 0; i < N; i++)
        for (int j = 0; j < M; j++, t += 6) {
            uint32_t p = (uint32_t)(i * M + j), q = (uint32_t)(i * M + (j + 1) % M);
            uint32_t corners[6] = {p, q, p + M, q, q + M, p + M};
            memcpy(mesh->indices + t, corners, sizeof corners);
        }
    shape_dvec3 corner[(N + 1) * M];
    for (int i = 0; i < (N + 1) * M; i++)
        corner[i] = shape_frame_point(&frame, mesh->points[i]);
    add(opaque, mesh, &frame, 1, 1, 1);
    assert_int_equal(shape_opaque_triangle_count(opaque), 2 * (N - 1) * M); /* the poles' have no area */
    for (int i = 0; i < 6000; i++) {
        shape_dvec3 o = shape_frame_point(&frame, any_point(&random, 0.3)), to;
        shape_dvec3 a = corner[i % ((N + 1) * M)], b = corner[(i + 1) % ((N + 1) * M)];
        double share = i % 3 == 0 ? 0 : i % 3 == 1 ? 0.5 : shape_random_unit(&random);
        to = shape_dvec3_add(a, shape_dvec3_scale(shape_dvec3_sub(b, a), share));
        shape_dvec3 d = shape_dvec3_sub(to, o);
        if (!(shape_dvec3_length(d) > 0))
            continue;
        assert_true(shape_opaque_blocks(opaque, o, shape_dvec3_normalize(d), INFINITY));
    }
    shape_opaque_destroy(opaque);
}

static void wrong_meshes_are_refused(void **state)
{
    (void)state;
    shape_error error;
    shape_opaque_hit hit;
    float albedo[3] = {0.5f, 1.5f, 0};
    shape_dvec3 min, max, o = {0, 0, 0}, d = {0, 0, 1};
    shape_opaque *opaque = shape_opaque_create(NULL);
    shape_mesh *mesh = square(1, 0, false);
    assert_int_equal(shape_opaque_add(opaque, mesh, NULL, albedo, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "colour"));
    albedo[1] = 1;
    mesh->points[2].y = INFINITY;
    assert_int_equal(shape_opaque_add(opaque, mesh, NULL, albedo, &error), SHAPE_ERROR_ARGUMENT);
    shape_mesh_destroy(mesh);
    assert_int_equal(shape_opaque_finish(opaque, &error), SHAPE_OK);
    assert_false(shape_opaque_bounds(opaque, &min, &max));
    assert_false(shape_opaque_find(opaque, o, d, INFINITY, &hit));
    assert_false(shape_opaque_find(NULL, o, d, INFINITY, &hit));
    shape_opaque_destroy(opaque);
}

/* --- light --- */

static shape_light sun_at(double cosine)
{
    shape_light light = shape_light_defaults();
    light.sky = SHAPE_SKY_NONE;
    light.sun = shape_dvec3_make(sqrt(1 - cosine * cosine), cosine, 0);
    return light;
}

typedef struct seen {
    double mean[3], error; /* of the mean of red */
} seen;

static seen trace(const sample_scene *scene, const shape_opaque *opaque, const shape_light *light,
                  int bounces, shape_dvec3 eye, shape_dvec3 direction, int paths)
{
    shape_tracer *tracer;
    shape_pathtrace_options options = shape_pathtrace_defaults();
    shape_random random = shape_random_seed(3, 0);
    seen s = {{0, 0, 0}, 0};
    double squares = 0;
    options.sun_angle = 0;
    options.max_bounces = bounces;
    options.opaque = opaque;
    assert_int_equal(shape_tracer_create(scene->volume, &tracer, NULL), SHAPE_OK);
    for (int i = 0; i < paths; i++) {
        double rgb[3];
        shape_pathtrace_radiance(tracer, light, &options, eye, direction, &random, rgb);
        for (int c = 0; c < 3; c++)
            s.mean[c] += rgb[c] / paths;
        squares += rgb[0] * rgb[0] / paths;
    }
    s.error = sqrt(fmax(squares - s.mean[0] * s.mean[0], 0) / paths);
    shape_tracer_destroy(tracer);
    return s;
}

static seen march(const sample_scene *scene, const shape_light *light, const shape_march_options *options,
                  shape_dvec3 eye, shape_dvec3 direction)
{
    shape_marcher *marcher;
    shape_march_scratch scratch;
    shape_error error;
    seen s;
    memset(&scratch, 0, sizeof scratch);
    if (shape_marcher_create(scene->volume, light, eye, options, &marcher, &error) ||
        shape_march_radiance(marcher, eye, direction, 0, &scratch, s.mean, &error))
        fail_msg("%s", error.text);
    shape_march_scratch_free(&scratch);
    shape_marcher_destroy(marcher);
    s.error = 0;
    return s;
}

/* A slab of thickness 1 about y = 2 over a plane y = 0. */
static sample_scene slab(double tau, double g, double albedo)
{
    sample_scene scene = sample_begin(SHAPE_MODEL_UNIFORM, (float)tau);
    scene.set->clouds[0].medium.g = (float)g;
    scene.set->clouds[0].medium.albedo = (float)albedo;
    sample_add(&scene, 0, 2, 0, 1000, 0.5f, 1000);
    sample_finish(&scene);
    return scene;
}

/* Lambert under Beer: albedo / pi E cos exp(-tau / cos) beneath a black slab; both renderers, no chance but in the
 * reference's shadow ray. The other colours follow from the surface's. */
static void a_plane_under_a_black_slab(void **state)
{
    (void)state;
    const double cosine = 0.6, tau = 0.8, E = pi, truth = 0.9 / pi * E * cosine * exp(-tau / cosine);
    sample_scene scene = slab(tau, 0, 0);
    shape_opaque *opaque = shape_opaque_create(NULL);
    add(opaque, square(500, 0, false), NULL, 0.9f, 0.3f, 0);
    shape_light light = sun_at(cosine);
    shape_march_options options = shape_march_defaults();
    shape_dvec3 eye = {0, 1, 0}, d = shape_dvec3_normalize(shape_dvec3_make(0.4, -1, 0.2));
    options.opaque = opaque;
    options.light = SHAPE_MARCH_SINGLE;
    options.light_step = 0.01;
    options.step = 0.01;
    seen marched = march(&scene, &light, &options, eye, d);
    seen traced = trace(&scene, opaque, &light, 16, eye, d, 40000);
    assert_true(fabs(marched.mean[0] - truth) < 1e-3 * truth);
    assert_true(fabs(marched.mean[1] - truth / 3) < 1e-3 * truth && marched.mean[2] == 0);
    assert_true(fabs(traced.mean[0] - truth) < 4 * traced.error);
    assert_true(fabs(traced.mean[1] - traced.mean[0] / 3) < 1e-6 && traced.mean[2] == 0);
    shape_opaque_destroy(opaque);
    sample_end(&scene);
}

/* All light that comes through a scattering slab (1 - .34133 of it, van de Hulst's table for tau 1, g 0) falls on a dark
 * plane, whose colour of 1 % brings back at most 1 % of it. */
static void a_plane_gets_the_transmitted_irradiance(void **state)
{
    (void)state;
    const double albedo = 0.01, truth = albedo / pi * pi * (1 - 0.34133);
    sample_scene scene = slab(1, 0, 1);
    shape_opaque *opaque = shape_opaque_create(NULL);
    add(opaque, square(500, 0, false), NULL, (float)albedo, (float)albedo, (float)albedo);
    shape_light light = sun_at(1);
    seen s =
        trace(&scene, opaque, &light, 4096, shape_dvec3_make(0, 1, 0), shape_dvec3_make(0, -1, 0), 60000);
    if (!(fabs(s.mean[0] - truth) < 4 * s.error + 0.01 * truth))
        fail_msg("%.6f +- %.6f, in truth %.6f", s.mean[0], s.error, truth);
    shape_opaque_destroy(opaque);
    sample_end(&scene);
}

/* White things and a white cloud under a white sky cannot be seen: radiance 1, path by path. */
static void white_furnace_with_things(void **state)
{
    (void)state;
    sample_scene scene = sample_cumulus(10, 5);
    shape_opaque *opaque = shape_opaque_create(NULL);
    add(opaque, square(1.5, 0.5, false), NULL, 1, 1, 1);
    add(opaque, square(1, 0.3, true), NULL, 1, 1, 1);
    shape_light light = sun_at(1);
    light.sky = SHAPE_SKY_CONSTANT;
    for (int c = 0; c < 3; c++) {
        light.sky_radiance[c] = 1;
        light.sun_irradiance[c] = 0;
    }
    for (int i = 0; i < 40; i++) {
        shape_dvec3 d = shape_dvec3_normalize(shape_dvec3_make(0.05 * (i % 8 - 4), 0.03 * (i / 8 - 2), -1));
        seen s = trace(&scene, opaque, &light, 4096, shape_dvec3_make(0, 1, 9), d, 20);
        for (int c = 0; c < 3; c++)
            assert_true(fabs(s.mean[c] - 1) < 1e-9);
    }
    shape_opaque_destroy(opaque);
    sample_end(&scene);
}

/* A square between the sun and a ball takes all of its single scattering; one that only half the ball is behind, half. */
static void things_throw_shadows_into_clouds(void **state)
{
    (void)state;
    sample_scene scene = sample_begin(SHAPE_MODEL_UNIFORM, 0.5f);
    scene.set->clouds[0].medium.phase = SHAPE_PHASE_ISOTROPIC;
    sample_add(&scene, 0, 0, 0, 2, 2, 2);
    sample_finish(&scene);
    shape_light light = sun_at(1);
    shape_march_options options = shape_march_defaults();
    shape_dvec3 eye = {0, 0, 9}, d = {0, 0, -1};
    options.resolution = 10;
    static const shape_march_light lights[] = {SHAPE_MARCH_SINGLE, SHAPE_MARCH_HARRIS, SHAPE_MARCH_TWO_PASS,
                                               SHAPE_MARCH_OCTAVES, SHAPE_MARCH_GRID};
    for (int covering = 0; covering < 2; covering++) {
        shape_opaque *opaque = shape_opaque_create(NULL);
        shape_frame aside = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, covering ? 0 : 10}}};
        add(opaque, square(10, 5, false), &aside, 0, 0, 0);
        options.opaque = opaque;
        for (int i = 0; i < 5; i++) {
            shape_march_options open = options;
            options.light = open.light = lights[i];
            open.opaque = NULL;
            double free = march(&scene, &light, &open, eye, d).mean[0];
            double covered = march(&scene, &light, &options, eye, d).mean[0];
            assert_true(free > 0.05);
            assert_true(covering ? covered == 0 : covered > 0.05 * free && covered < 0.95 * free);
        }
        seen s = trace(&scene, opaque, &light, 1, eye, d, 20000);
        options.light = SHAPE_MARCH_SINGLE;
        options.step = 0.02;
        double marched = march(&scene, &light, &options, eye, d).mean[0];
        assert_true(fabs(s.mean[0] - marched) <= 4 * s.error + 0.01 * marched);
        shape_opaque_destroy(opaque);
    }
    sample_end(&scene);
}

/* The camera's ray ends at a black square in the middle of a ball whose sun stands behind the eye: phase E (1 - exp(-2
 * depth)) / 2 of the front half. Whatever the rule, an end in the midst of a step keeps its order. */
static void rays_end_at_the_surface_exactly(void **state)
{
    (void)state;
    static const struct {
        shape_rule rule;
        double order;
    } rules[] = {{SHAPE_RULE_RIEMANN_LEFT, 1},
                 {SHAPE_RULE_TRAPEZOID, 2},
                 {SHAPE_RULE_SIMPSON, 4},
                 {SHAPE_RULE_EXPONENTIAL, 2}};
    sample_scene scene = sample_begin(SHAPE_MODEL_UNIFORM, 0.7f);
    scene.set->clouds[0].medium.phase = SHAPE_PHASE_ISOTROPIC;
    sample_add(&scene, 0, 0, 0, 2, 2, 2);
    sample_finish(&scene);
    shape_opaque *opaque = shape_opaque_create(NULL);
    add(opaque, square(5, 0.37, true), NULL, 0, 0, 0);
    shape_light light = sun_at(1);
    light.sun = shape_dvec3_make(0, 0, 1);
    shape_march_options options = shape_march_defaults();
    shape_dvec3 eye = {0, 0, 9}, d = {0, 0, -1};
    const double truth = 0.25 * (1 - exp(-2 * 0.7 * (2 - 0.37))) / 2;
    options.opaque = opaque;
    options.light = SHAPE_MARCH_SINGLE;
    options.light_step = 0.5;
    for (int end = SHAPE_END_CUT; end <= SHAPE_END_ADAPT; end++)
        for (int i = 0; i < 4; i++) {
            double off[2];
            options.end = (shape_march_end)end;
            options.rule = rules[i].rule;
            for (int k = 0; k < 2; k++) {
                options.step = k ? 0.02 : 0.16;
                off[k] = fabs(march(&scene, &light, &options, eye, d).mean[0] - truth);
            }
            double order = log2(off[0] / off[1]) / 3;
            /* Simpson's comes down to what single precision leaves of a place. */
            if (!(order > rules[i].order - 0.35 || off[1] < 2e-7))
                fail_msg("rule %d, end %d: order %.2f (%g, %g)", i, end, order, off[0], off[1]);
        }
    seen s = trace(&scene, opaque, &light, 1, eye, d, 40000);
    assert_true(fabs(s.mean[0] - truth) < 4 * s.error);
    shape_opaque_destroy(opaque);
    sample_end(&scene);
}

/* Behind a depth of 25 nothing can be seen. Cut, coarse steps show nothing of a thing there; adapted to it, as printed, they
 * show its shape (Páleník 2016 chapter 4's image negative). */
static void no_image_negative_in_dense_cloud(void **state)
{
    (void)state;
    sample_scene scene = sample_begin(SHAPE_MODEL_UNIFORM, 12);
    sample_add(&scene, 0, 0, 0, 2, 2, 2);
    sample_finish(&scene);
    shape_opaque *opaque = shape_opaque_create(NULL);
    add(opaque, square(5, -0.1, true), NULL, 1, 1, 1);
    shape_light light = sun_at(0.8);
    shape_march_options options = shape_march_defaults();
    shape_dvec3 eye = {0.1, 0.2, 9}, d = {0, 0, -1};
    options.light = SHAPE_MARCH_SINGLE;
    options.rule = SHAPE_RULE_RIEMANN_LEFT;
    options.step = 0.25;
    light.sun = shape_dvec3_make(0, 0.8, 0.6); /* the thing's own shadow does not reach what is seen */
    double without = march(&scene, &light, &options, eye, d).mean[0];
    options.opaque = opaque;
    double cut = march(&scene, &light, &options, eye, d).mean[0];
    options.end = SHAPE_END_ADAPT;
    double adapted = march(&scene, &light, &options, eye, d).mean[0];
    assert_true(without > 0 && fabs(cut - without) < 1e-7);
    assert_true(fabs(adapted - without) > 1e-3 * without);
    shape_opaque_destroy(opaque);
    sample_end(&scene);
}

/* Level ground is met from above and from below at height / cosine, as far as its side reaches, and shadows what is under
 * it; its triangles are told from a mesh's. */
static void ground_reaches_far(void **state)
{
    (void)state;
    shape_error error;
    const float colour[3] = {0.1f, 0.2f, 0.3f};
    shape_opaque *opaque = shape_opaque_create(NULL);
    add(opaque, square(1, 5, false), NULL, 1, 1, 1);
    if (shape_opaque_add_ground(opaque, -2, colour, &error) || shape_opaque_finish(opaque, &error))
        fail_msg("%s", error.text);
    size_t ground = 0, count = shape_opaque_triangle_count(opaque);
    for (size_t i = 0; i < count; i++) {
        shape_opaque_triangle t = shape_opaque_get_triangle(opaque, i);
        ground += t.ground;
        for (int k = 0; k < 3; k++)
            assert_true(t.corner[k].y == (t.ground ? -2 : 5));
        assert_true(t.albedo[1] == (t.ground ? 0.2f : 1));
    }
    assert_int_equal(count, 4);
    assert_int_equal(ground, 2);
    for (double away = 1; away < SHAPE_OPAQUE_GROUND_SIDE / 2; away *= 7) {
        shape_opaque_hit hit;
        for (int below = 0; below < 2; below++) {
            shape_dvec3 from = shape_dvec3_make(3, below ? -5 : 1, 0);
            shape_dvec3 d = shape_dvec3_normalize(shape_dvec3_make(0, below ? 3 : -3, -away));
            assert_true(shape_opaque_find(opaque, from, d, INFINITY, &hit));
            assert_float_equal(hit.t, sqrt(9 + away * away), 1e-9 * away);
            assert_true(hit.normal.y == (below ? -1 : 1) && hit.albedo[2] == 0.3f);
        }
    }
    shape_opaque_destroy(opaque);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_tree_finds_what_every_triangle_says),
        cmocka_unit_test(a_closed_mesh_has_no_holes),
        cmocka_unit_test(wrong_meshes_are_refused),
        cmocka_unit_test(a_plane_under_a_black_slab),
        cmocka_unit_test(a_plane_gets_the_transmitted_irradiance),
        cmocka_unit_test(white_furnace_with_things),
        cmocka_unit_test(things_throw_shadows_into_clouds),
        cmocka_unit_test(rays_end_at_the_surface_exactly),
        cmocka_unit_test(no_image_negative_in_dense_cloud),
        cmocka_unit_test(ground_reaches_far),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
