/* The field in GLSL against the field in C, point by point: two independent ways, equal to 1e-4 except within 1e-4 of
 * where density jumps. Runs on whatever OpenGL there is; none is a failure. */
#include "gl_context.h"

typedef struct sample_cloud {
    shape_model model;
    size_t spheres, ellipsoids;
    float kappa, noise_scale, edge;
    int octaves;
    uint64_t seed;
    double low, high; /* sizes */
} sample_cloud;

static const sample_cloud clouds[] = {
    {SHAPE_MODEL_UNIFORM, 40, 0, 0.5f, 1, 4.2f, 1, 1, 0.3, 2},
    {SHAPE_MODEL_UNIFORM, 5, 40, 0.5f, 1, 4.2f, 5, 2, 0.3, 2},
    {SHAPE_MODEL_SPHEROID, 35, 0, 0.5f, 0.3f, 4.2f, 5, 1, 0.3, 2},
    {SHAPE_MODEL_SPHEROID, 300, 0, 0, 0.1f, 4.2f, 3, 0xfedcba9876543210u, 0.1, 1},
    {SHAPE_MODEL_SPHEROID, 0, 30, 1, 0.7f, 4.2f, 8, 12345, 0.3, 3},
    {SHAPE_MODEL_SPHEROID, 1, 25, 0.8f, 2.5f, 4.2f, 16, 7, 0.5, 3},
    {SHAPE_MODEL_METABALL, 6, 0, 0.5f, 0.25f, 4.2f, 5, 3, 0.5, 2},
    {SHAPE_MODEL_METABALL, 4, 5, 0.5f, 1, 0.5f, 2, 9, 0.2, 2},
    {SHAPE_MODEL_METABALL, 20, 3, 0.5f, 0.5f, 40, 6, 10, 0.5, 1.5},
};
enum { CLOUDS = sizeof clouds / sizeof clouds[0], POINTS = 100000 / CLOUDS + 1 };

static shape_set *make_set(const sample_cloud *c)
{
    shape_set *set = new_set();
    shape_cloud *cloud = new_cloud(set, c->model);
    cloud->field.kappa = c->kappa;
    cloud->field.noise_scale = c->noise_scale;
    cloud->field.edge = c->edge;
    cloud->field.octaves = c->octaves;
    cloud->field.seed = c->seed;
    shape_random random = shape_random_seed(300, c->seed);
    add_random(set, 0, &random, c->spheres, c->ellipsoids, 4, c->low, c->high);
    return set;
}

/* How near the numbers that a point's density is decided by lie to their thresholds. */
static double doubt(const shape_volume_cloud *cloud, shape_vec3 p, double u2, double n)
{
    shape_dvec3 at = {(double)p.x, (double)p.y, (double)p.z};
    double kappa = (double)cloud->field.kappa, sum = 0, u = sqrt(u2);
    double edge = fabs(u - (double)cloud->support);
    if (cloud->field.model == SHAPE_MODEL_UNIFORM)
        return edge;
    if (cloud->field.model == SHAPE_MODEL_SPHEROID)
        return fmin(edge, fabs(n - exp(-u / fmax((1 - kappa) + 2 * kappa * n, 1e-6))));
    for (size_t i = 0; i < cloud->list->sphere_count; i++)
        sum += 1 / fmax(exact_sphere_u2(&cloud->list->spheres[i], at), 1e-6);
    for (size_t i = 0; i < cloud->list->ellipsoid_count; i++)
        sum += 1 / fmax(exact_ellipsoid_u2(&cloud->list->ellipsoids[i], at), 1e-6);
    /* Of a large sum 1e-4 of itself: it is single precision. */
    return fmin(fabs(sum - 1), fabs((double)cloud->field.edge * n - sum) / fmax(sum, 1));
}

static void compare(shape_gl_renderer *renderer, const sample_cloud *c, long *excepted, long *dense)
{
    shape_error error;
    shape_set *set = make_set(c);
    shape_volume *volume = new_volume(set);
    const shape_volume_cloud *cloud = &volume->clouds[0];
    must(shape_gl_load(renderer, volume, &error), &error);
    shape_vec3 *points = malloc(POINTS * sizeof *points);
    float *rgba = malloc(POINTS * 4 * sizeof *rgba);
    assert_true(points && rgba);
    shape_random random = shape_random_seed(301, c->seed);
    for (int i = 0; i < POINTS; i++)
        points[i] = i % 3 ? point_near(cloud->list, &random) : draw_point(&random, 6);
    must(shape_gl_densities(renderer, points, POINTS, rgba, &error), &error);
    for (int i = 0; i < POINTS; i++) {
        double u2 = exact_u2(cloud->list,
                             shape_dvec3_make((double)points[i].x, (double)points[i].y, (double)points[i].z));
        float density = shape_cloud_density(cloud, points[i]), u2_here = shape_cloud_u2(cloud, points[i]);
        double n = (double)rgba[4 * i + 2];
        shape_vec3 q = shape_vec3_scale(points[i], cloud->inverse_noise_scale);
        assert_float_equal(n, shape_noise_fbm(cloud->noise, cloud->offsets, cloud->field.octaves, q), 1e-4);
        *dense += density > 0;
        if (doubt(cloud, points[i], u2, n) < 1e-4) {
            ++*excepted;
            continue;
        }
        if (u2_here <= cloud->support * cloud->support)
            assert_float_equal(rgba[4 * i + 1], u2_here, 1e-4 * fmax(1, (double)u2_here));
        if (!(fabsf(density - rgba[4 * i]) <= 1e-4f))
            fail_msg("model %d at %g %g %g: %.7g in C, %.7g in GLSL", (int)c->model, (double)points[i].x,
                     (double)points[i].y, (double)points[i].z, (double)density, (double)rgba[4 * i]);
    }
    free(points);
    free(rgba);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

static void glsl_field_is_the_c_field(void **state)
{
    (void)state;
    shape_gl_renderer *renderer = new_renderer(SHAPE_GL_DEFAULT);
    long excepted = 0, dense = 0;
    for (int i = 0; i < CLOUDS; i++)
        compare(renderer, &clouds[i], &excepted, &dense);
    print_message("%d points, %ld dense, %ld within 1e-4 of a threshold\n", CLOUDS * POINTS, dense, excepted);
    /* Thresholds are crossed over a range of about 1: 2e-4 of that, times three of them. */
    assert_true(excepted < CLOUDS * POINTS / 500);
    assert_true(dense > CLOUDS * POINTS / 10);
    shape_gl_destroy(renderer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(glsl_field_is_the_c_field)};
    return cmocka_run_group_tests(tests, open_context, close_context);
}
