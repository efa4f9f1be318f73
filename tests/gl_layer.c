/* Layers and details in GLSL against C, point by point: two independent ways, equal to 1e-4 except where density jumps,
 * which shows as a jump in C itself within 1e-4 of the point's distance to its neighbours. */
#include "gl_context.h"

enum { POINTS = 6000 };

/* The same density within 2e-5 m along each axis, six times: no jump here. Rounding of a position of a few metres is a
 * hundred times smaller. */
static bool is_steady(const shape_volume_cloud *cloud, shape_vec3 p, float density)
{
    for (int axis = 0; axis < 6; axis++) {
        shape_vec3 q = p;
        (&q.x)[axis / 2] += axis % 2 ? 2e-5f : -2e-5f;
        if (!(fabsf(shape_cloud_density(cloud, q) - density) <= 1e-3f))
            return false;
    }
    return true;
}

static void compare(shape_gl_renderer *renderer, const shape_set *set, const char *what)
{
    shape_error error;
    shape_volume *volume = new_volume(set);
    const shape_volume_cloud *cloud = &volume->clouds[0];
    must(shape_gl_load(renderer, volume, &error), &error);
    shape_vec3 *points = malloc(POINTS * sizeof *points);
    float *rgba = malloc(POINTS * 4 * sizeof *rgba);
    assert_true(points && rgba);
    shape_random random = shape_random_seed(310, 1);
    for (int i = 0; i < POINTS; i++) {
        const float *low = &cloud->box.min.x, *high = &cloud->box.max.x;
        points[i] = point_near(cloud->list, &random);
        for (int axis = 0; axis < 3 && i % 3; axis++)
            (&points[i].x)[axis] = draw(&random, (double)low[axis], (double)high[axis]);
    }
    must(shape_gl_densities(renderer, points, POINTS, rgba, &error), &error);
    int dense = 0, excepted = 0, between = 0;
    for (int i = 0; i < POINTS; i++) {
        float density = shape_cloud_density(cloud, points[i]);
        dense += density > 0;
        between += density > 0 && density < 1;
        if (fabsf(density - rgba[4 * i]) <= 1e-4f)
            continue;
        excepted++;
        if (is_steady(cloud, points[i], density))
            fail_msg("%s at %.9g %.9g %.9g: %.7g in C, %.7g in GLSL", what, (double)points[i].x,
                     (double)points[i].y, (double)points[i].z, (double)density, (double)rgba[4 * i]);
    }
    print_message("%-28s %d points, %d dense, %d of them between 0 and 1, %d at a jump\n", what, POINTS,
                  dense, between, excepted);
    assert_true(dense > POINTS / 50);
    assert_true(excepted <= POINTS / 200);
    free(points);
    free(rgba);
    shape_volume_destroy(volume);
}

static void details_agree(void **state)
{
    (void)state;
    static const struct {
        const char *what;
        shape_model model;
        shape_detail detail;
    } cases[] = {
        {"smooth uniform", SHAPE_MODEL_UNIFORM, {.smoothness = 0.3f}},
        {"smooth spheroid", SHAPE_MODEL_SPHEROID, {.smoothness = 0.1f}},
        {"displaced uniform", SHAPE_MODEL_UNIFORM, {.displace = 0.7f, .displace_scale = 1.3f}},
        {"displaced spheroid", SHAPE_MODEL_SPHEROID, {.displace = 0.4f}},
        {"displaced metaball", SHAPE_MODEL_METABALL, {.displace = 0.4f}},
        {"billow and wisp, uniform", SHAPE_MODEL_UNIFORM, {.billow = 1, .wisp = 0.6f, .detail_scale = 0.9f}},
        {"billow, spheroid", SHAPE_MODEL_SPHEROID, {.billow = 0.5f, .detail_depth = 0.8f}},
        {"wisp, metaball", SHAPE_MODEL_METABALL, {.wisp = 0.7f}},
        {"all, spheroid", SHAPE_MODEL_SPHEROID, {0.2f, 0.3f, 2, 0.4f, 0.5f, 0.3f, 0.6f}}};
    shape_gl_renderer *renderer = new_renderer(SHAPE_GL_DEFAULT);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        shape_set *set = new_set();
        shape_cloud *cloud = new_cloud(set, cases[i].model);
        cloud->field.noise_scale = 0.4f;
        cloud->field.seed = 11 + i;
        cloud->field.detail = cases[i].detail;
        shape_random random = shape_random_seed(311, i);
        add_random(set, 0, &random, 12, 9, 4, 0.5, 2);
        compare(renderer, set, cases[i].what);
        shape_set_destroy(set);
    }
    shape_gl_destroy(renderer);
}

static void layers_agree(void **state)
{
    (void)state;
    shape_gl_renderer *renderer = new_renderer(SHAPE_GL_DEFAULT);
    static const char *const what[] = {"layer, lattice",       "layer, Perlin",         "layer, Worley",
                                       "layer, Perlin-Worley", "layer, hard steps",     "layer, shell",
                                       "layer, displaced",     "layer, displaced shell"};
    for (size_t i = 0; i < 8; i++) {
        shape_set *set = new_set();
        shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_LAYER);
        shape_layer *l = &cloud->field.layer;
        shape_random random = shape_random_seed(312, i);
        cloud->field.noise_scale = 0.7f;
        cloud->field.octaves = 1 + (int)i;
        cloud->field.seed = 1 + i;
        l->bounds = i < 5 ? (shape_bounds)(i % 3) : SHAPE_BOUNDS_ALTITUDES;
        l->noise = (shape_noise_kind)(i % 4);
        l->blend = 0.3f;
        l->gain = 1.5f;
        l->worley_gain = 0.8f;
        l->worley_frequency = 1.7f;
        l->coverage = 0.55f;
        l->cut = i % 2 ? 0.2f : 0;
        l->stretch[0] = 2;
        l->stretch[1] = 0.5f;
        l->ramp[0] = i == 4 ? 0.5f : 0.2f;
        l->ramp[1] = i == 4 ? 0.5f : 0.6f;
        l->falloff = i % 3 == 1 ? 0.5f : 0;
        l->fade_bottom = 0.2f;
        l->fade_top = i % 2 ? 0.6f : 0;
        l->fade_side = 0.3f;
        l->planet_radius = i == 5 || i == 7 ? 12 : 0;
        cloud->field.detail.displace = i >= 6 ? 0.5f : 0;
        add_random(set, 0, &random, 2, 2, 3, 1, 3);
        compare(renderer, set, what[i]);
        shape_set_destroy(set);
    }
    shape_gl_destroy(renderer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(details_agree), cmocka_unit_test(layers_agree)};
    return cmocka_run_group_tests(tests, open_context, close_context);
}
