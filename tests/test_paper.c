/* The 2018 methods on the CPU: Beer's law in whole steps, equality of the two where nothing overlaps, one picture for any
 * number of threads. tests/gl_paper.c holds them to the shader's picture. */
#include "volume_sample.h"

#include <omp.h>

#include "shape/paper.h"

enum { W = 32, H = 18, N = 3 * W * H };

static void render(const shape_set *set, const shape_view *view, const shape_light *light,
                   const shape_paper_options *options, float *radiance)
{
    shape_error error;
    shape_volume *volume = new_volume(set);
    must(shape_paper_render(volume, view, light, options, radiance, NULL, NULL, &error), &error);
    shape_volume_destroy(volume);
}

static shape_view small_view(void)
{
    shape_view view = shape_view_defaults();
    view.width = W, view.height = H;
    view.eye = shape_dvec3_make(0, 0, 8);
    view.fov = 35;
    return view;
}

/* A black uniform ball before a sky of 1: a ray that is in it for a length l takes whole steps of 0.1 m, the last of which
 * overhangs, so its transmittance lies between exp(-sigma l) and exp(-sigma (l + 0.1)). */
static void beers_law_in_whole_steps(void **state)
{
    (void)state;
    static float radiance[N];
    shape_set *set = new_set();
    shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_UNIFORM);
    cloud->medium.albedo = 0;
    cloud->medium.extinction = 0.6f;
    add_sphere(set, 0, 0, 0, 0, 2);
    shape_view view = small_view();
    shape_light light = shape_light_defaults();
    light.sky = SHAPE_SKY_CONSTANT;
    light.sky_radiance[0] = light.sky_radiance[1] = light.sky_radiance[2] = 1;
    shape_paper_options options = shape_paper_defaults();
    render(set, &view, &light, &options, radiance);
    shape_camera camera = shape_view_camera(&view);
    int covered = 0;
    for (int i = 0; i < W * H; i++) {
        shape_dvec3 d = shape_camera_direction(&camera, &view, i % W + 0.5, i / W + 0.5);
        double b = -shape_dvec3_dot(view.eye, d), room = b * b - 64 + 4;
        double length = room > 0 ? 2 * sqrt(room) : 0, is = (double)radiance[3 * i];
        covered += length > 0;
        assert_true(is <= exp(-0.6 * length) + 1e-4);
        assert_true(is >= exp(-0.6 * (length > 0 ? length + 0.1001 : 0)) - 1e-4);
    }
    assert_true(covered > 100);
    shape_set_destroy(set);
}

/* One ball is seen alike by both; of two that overlap, Algorithm 1 marches the common part twice and is denser. */
static void overlaps_are_marched_twice(void **state)
{
    (void)state;
    static float one[N], two[N];
    shape_set *set = new_set();
    shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_SPHEROID);
    cloud->medium.albedo = 0;
    cloud->field.noise_scale = 0.5f;
    add_sphere(set, 0, 0, 0, 0, 1.5);
    shape_view view = small_view();
    shape_light light = shape_light_defaults();
    shape_paper_options options = shape_paper_defaults();
    for (int balls = 1; balls <= 2; balls++) {
        double darker = 0;
        options.sweep = false;
        render(set, &view, &light, &options, one);
        options.sweep = true;
        render(set, &view, &light, &options, two);
        for (int i = 0; i < N; i++)
            darker += (double)two[i] - (double)one[i];
        assert_true(balls == 1 ? darker == 0 : darker > 1);
        add_sphere(set, 0, 0.8, 0, 0.5, 1.5);
    }
    shape_set_destroy(set);
}

static bool stop_at_once(void *context, double done)
{
    (void)done;
    ++*(int *)context;
    return false;
}

static void same_for_any_number_of_threads(void **state)
{
    (void)state;
    static float one[N], many[N];
    shape_error error;
    shape_set *set = new_set();
    shape_random random = shape_random_seed(7, 0);
    new_cloud(set, SHAPE_MODEL_SPHEROID)->field.noise_scale = 0.3f;
    add_random(set, 0, &random, 5, 5, 1, 0.4, 1);
    shape_view view = small_view();
    shape_light light = shape_light_defaults();
    shape_paper_options options = shape_paper_defaults();
    options.resolution = 10;
    options.samples = 2;
    int threads = omp_get_max_threads(), calls = 0;
    omp_set_num_threads(1);
    render(set, &view, &light, &options, one);
    omp_set_num_threads(3);
    render(set, &view, &light, &options, many);
    omp_set_num_threads(threads);
    assert_memory_equal(one, many, sizeof one);
    for (int i = 0; i < N; i++)
        assert_true(isfinite(one[i]) && one[i] >= 0);
    bool cancelled = false;
    shape_volume *volume = new_volume(set);
    options.progress = stop_at_once;
    options.progress_context = &calls;
    must(shape_paper_render(volume, &view, &light, &options, one, NULL, &cancelled, &error), &error);
    assert_true(cancelled && calls == 1);
    options.resolution = 1;
    assert_int_equal(shape_paper_render(volume, &view, &light, &options, one, NULL, NULL, &error),
                     SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "resolution"));
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(beers_law_in_whole_steps),
                                       cmocka_unit_test(overlaps_are_marched_twice),
                                       cmocka_unit_test(same_for_any_number_of_threads)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
