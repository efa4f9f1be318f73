/* Voxel grids in GLSL against C, point by point, and the exact view of one against the preview. Single precision on both
 * sides: 1e-5 of the largest density. */
#include "gl_context.h"
#include "grid_sample.h"

/* Densities above 1. */
static double dense_bumps(const void *unused, int x, int y, int z)
{
    return 5 * bumps(unused, x, y, z);
}

static void glsl_samples_are_the_c_samples(void **state)
{
    (void)state;
    enum { POINTS = 20000 };
    shape_error error;
    shape_gl_renderer *renderer = new_renderer(SHAPE_GL_EXACT);
    shape_set *set = grid_set(grid_of(dense_bumps, NULL, 41, 33, 37), 0.1, shape_dvec3_make(1, 2, 3));
    shape_volume *volume = new_volume(set);
    const shape_volume_cloud *cloud = &volume->clouds[0];
    must(shape_gl_load(renderer, volume, &error), &error);
    shape_vec3 *points = malloc(POINTS * sizeof *points);
    float *rgba = malloc(POINTS * 4 * sizeof *rgba);
    assert_true(points && rgba);
    shape_random random = shape_random_seed(1, 0);
    int dense = 0;
    for (int i = 0; i < POINTS; i++)
        points[i] = shape_vec3_make(draw(&random, -2, 42), draw(&random, -2, 34), draw(&random, -2, 38));
    must(shape_gl_densities(renderer, points, POINTS, rgba, &error), &error);
    for (int i = 0; i < POINTS; i++) {
        float density = shape_cloud_density(cloud, points[i]) / cloud->most;
        assert_float_equal(density, rgba[4 * i], 1e-5);
        dense += density > 0;
    }
    assert_true(dense > POINTS / 5);
    free(points);
    free(rgba);
    shape_gl_destroy(renderer);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* The mean radiance of a picture over black. */
static double mean_of(const shape_volume *volume, shape_gl_method method)
{
    enum { SIDE = 64 };
    shape_error error;
    shape_gl_renderer *renderer = new_renderer(method);
    shape_view view = shape_view_defaults();
    shape_light light = shape_light_defaults();
    light.sky = SHAPE_SKY_NONE;
    view.width = view.height = SIDE;
    view.fov = 20; /* a pixel is smaller than a voxel: the preview bakes no coarser */
    view.eye = shape_dvec3_make(3, 4, 15);
    view.target = shape_dvec3_make(3, 3.6, 4.8);
    must(shape_gl_load(renderer, volume, &error), &error);
    must(shape_gl_light(renderer, &light, &error), &error);
    for (int i = 0; i < 4; i++)
        must(shape_gl_draw(renderer, &view, i, &error), &error);
    float *rgba = malloc(sizeof(float) * SIDE * SIDE * 4);
    assert_non_null(rgba);
    must(shape_gl_read(renderer, rgba, &error), &error);
    double sum = 0;
    for (int i = 0; i < SIDE * SIDE; i++)
        sum += (double)rgba[4 * i];
    free(rgba);
    shape_gl_destroy(renderer);
    return sum / (SIDE * SIDE);
}

/* Baked and exact see the same cloud: 3 % of the mean, the preview's own error on soft clouds. */
static void exact_and_preview_agree(void **state)
{
    (void)state;
    shape_set *set = grid_set(grid_of(dense_bumps, NULL, 41, 33, 37), 0.1, shape_dvec3_make(1, 2, 3));
    shape_volume *volume = new_volume(set);
    double exact = mean_of(volume, SHAPE_GL_EXACT), preview = mean_of(volume, SHAPE_GL_DEFAULT);
    assert_true(exact > 0.005);
    if (!(fabs(exact - preview) <= 0.03 * exact))
        fail_msg("exact %g, preview %g", exact, preview);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

static void paper_methods_refuse_grids(void **state)
{
    (void)state;
    shape_error error;
    shape_gl_renderer *renderer = new_renderer(SHAPE_GL_PAPER);
    shape_set *set = grid_set(grid_of(dense_bumps, NULL, 41, 33, 37), 0.1, shape_dvec3_make(1, 2, 3));
    shape_volume *volume = new_volume(set);
    assert_int_equal(shape_gl_load(renderer, volume, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "primitives"));
    shape_gl_destroy(renderer);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(glsl_samples_are_the_c_samples),
                                       cmocka_unit_test(exact_and_preview_agree),
                                       cmocka_unit_test(paper_methods_refuse_grids)};
    return cmocka_run_group_tests(tests, open_context, close_context);
}
