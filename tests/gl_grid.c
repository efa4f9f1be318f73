/* Voxel grids in GLSL against C, point by point, and the exact view of one against the preview. Single precision on both
 * sides: 1e-5 of the largest density. */
#include "grid_sample.h"

#include "shape_gl.h"

static shape_gl_context *context;

static int open_context(void **state)
{
    (void)state;
    shape_error error;
    if (shape_gl_context_create(&context, &error)) {
        print_error("%s\n", error.text);
        return -1;
    }
    return 0;
}

static int close_context(void **state)
{
    (void)state;
    shape_gl_context_destroy(context);
    return 0;
}

static double bumps(const void *context_unused, int x, int y, int z)
{
    (void)context_unused;
    bool face = !x || !y || !z || x >= 40 || y >= 32 || z >= 36;
    return face ? 0 : 5 * fmax(sin(0.31 * x) * sin(0.23 * y + 1) * cos(0.27 * z), 0);
}

static void glsl_samples_are_the_c_samples(void **state)
{
    (void)state;
    enum { POINTS = 20000 };
    shape_error error;
    shape_gl_options options = shape_gl_defaults();
    shape_gl_renderer *renderer;
    options.method = SHAPE_GL_EXACT;
    must(shape_gl_create(&options, &renderer, &error), &error);
    shape_set *set = grid_set(grid_of(bumps, NULL, 41, 33, 37), 0.1, shape_dvec3_make(1, 2, 3));
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
    shape_gl_options options = shape_gl_defaults();
    shape_gl_renderer *renderer;
    shape_view view = shape_view_defaults();
    shape_light light = shape_light_defaults();
    light.sky = SHAPE_SKY_NONE;
    view.width = view.height = SIDE;
    view.fov = 20; /* a pixel is smaller than a voxel: the preview bakes no coarser */
    view.eye = shape_dvec3_make(3, 4, 15);
    view.target = shape_dvec3_make(3, 3.6, 4.8);
    options.method = method;
    must(shape_gl_create(&options, &renderer, &error), &error);
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
    shape_set *set = grid_set(grid_of(bumps, NULL, 41, 33, 37), 0.1, shape_dvec3_make(1, 2, 3));
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
    shape_gl_options options = shape_gl_defaults();
    shape_gl_renderer *renderer;
    options.method = SHAPE_GL_PAPER;
    must(shape_gl_create(&options, &renderer, &error), &error);
    shape_set *set = grid_set(grid_of(bumps, NULL, 41, 33, 37), 0.1, shape_dvec3_make(1, 2, 3));
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
