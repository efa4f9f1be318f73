/* The exact view's lists of primitives: the same picture as by the trees, and work that grows with what a ray meets. */
#include "gl_picture.h"

/* A heap of spheres and ellipsoids in a cloud that is turned and scaled, with an eye outside and one within. */
static shape_set *heap(size_t spheres, size_t ellipsoids)
{
    shape_random random = shape_random_seed(520, spheres);
    shape_set *set = new_set();
    shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_SPHEROID);
    cloud->field.noise_scale = 0.5f;
    cloud->medium.extinction = 1.5f;
    cloud->medium.albedo = 0;
    const double turned[3][4] = {{0, -1.3, 0, 0.4}, {1.3, 0, 0, -0.2}, {0, 0, 1.3, 0.7}};
    memcpy(cloud->frame.m, turned, sizeof turned);
    add_random(set, 0, &random, spheres, ellipsoids, 2.5, 0.2, 0.9);
    return set;
}

/* A second cloud, without anything in it, makes the view walk the trees. Black clouds before a white sky: the pictures
 * differ by where steps begin anew (where a window ends), so by a few samples of noise. */
static void lists_show_what_trees_show(void **state)
{
    (void)state;
    static const size_t counts[][2] = {{30, 0}, {0, 30}, {300, 40}};
    shape_light light = white_sky();
    for (int i = 0; i < 6; i++) {
        shape_set *set = heap(counts[i / 2][0], counts[i / 2][1]);
        shape_view view = view_of(61, 35, shape_dvec3_make(i % 2 ? 1 : 8, 0.5, i % 2 ? 0.5 : 5),
                                  shape_dvec3_make(0, 0, i % 2 ? 2 : 0), 50);
        float *by_lists = render(set, SHAPE_GL_EXACT, &view, &light, false, 8);
        new_cloud(set, SHAPE_MODEL_SPHEROID);
        float *by_trees = render(set, SHAPE_GL_EXACT, &view, &light, false, 8);
        double sum = 0, mean[2] = {0, 0};
        for (int k = 0; k < 61 * 35 * 4; k++) {
            sum += pow((double)by_lists[k] - (double)by_trees[k], 2);
            mean[0] += (double)by_lists[k] / (61 * 35 * 4);
            mean[1] += (double)by_trees[k] / (61 * 35 * 4);
        }
        double rms = sqrt(sum / (61 * 35 * 4));
        print_message("%zu spheres, %zu ellipsoids, eye %d: rms %.5f, means %.5f %.5f\n", counts[i / 2][0],
                      counts[i / 2][1], i % 2, rms, mean[0], mean[1]);
        assert_true(rms < 0.02 * mean[1]);
        assert_float_equal(mean[0], mean[1], 0.002 * mean[1]);
        free(by_lists);
        free(by_trees);
        shape_set_destroy(set);
    }
}

static shape_gl_costs costs_of(int count, float radius)
{
    shape_random random = shape_random_seed(521, 0);
    shape_set *set = new_set();
    shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_SPHEROID);
    cloud->field.noise_scale = 0.2f * radius;
    for (int i = 0; i < count; i++) {
        shape_vec3 p = draw_point(&random, 4);
        add_sphere(set, 0, p.x, 0.4f * p.y, p.z, radius);
    }
    shape_view view = view_of(160, 90, shape_dvec3_make(0, 1, 14), shape_dvec3_make(0, 0, 0), 45);
    shape_light light = shape_light_defaults();
    float *rgba = render(set, SHAPE_GL_EXACT, &view, &light, false, 1);
    shape_gl_costs costs = shape_gl_get_costs(find_renderer(SHAPE_GL_EXACT, false));
    free(rgba);
    shape_set_destroy(set);
    return costs;
}

/* A hundred times the spheres over the same ground, each a quarter as wide. Counts do not depend on the machine. */
static void work_grows_with_what_a_ray_meets(void **state)
{
    (void)state;
    shape_gl_costs few = costs_of(35, 1.6f), many = costs_of(3500, 0.4f);
    print_message("35: %.2f steps, %.2f fetches a pixel; 3500: %.2f, %.2f\n", few.steps_per_pixel,
                  few.fetches_per_pixel, many.steps_per_pixel, many.fetches_per_pixel);
    assert_true(many.steps_per_pixel < 3 * few.steps_per_pixel);
    assert_true(many.fetches_per_pixel < 5 * few.fetches_per_pixel);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lists_show_what_trees_show),
        cmocka_unit_test(work_grows_with_what_a_ray_meets),
    };
    return cmocka_run_group_tests(tests, open_context, close_pictures);
}
