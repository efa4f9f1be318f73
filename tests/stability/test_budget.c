/* What an allowed error chooses (shape/budget.h): pictures within it, nothing spent on clouds that are not seen, counted by
 * cells and looks rather than by time. error_scenes.c asks the same of many more scenes. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <omp.h>

#include "generated_scene.h"
#include "scene_sample.h"
#include "shape/budget.h"

enum { WIDTH = 96, HEIGHT = 54, VALUES = 3 * WIDTH * HEIGHT };

static void must(shape_status status, const shape_error *error)
{
    if (status)
        fail_msg("%s", error->text);
}

static shape_view test_view(void)
{
    shape_view view = shape_view_defaults();
    view.width = WIDTH, view.height = HEIGHT;
    view.eye = shape_dvec3_make(0, 2, 25);
    view.target = shape_dvec3_make(0, 1, 0);
    return view;
}

/* --- clouds that are not seen --- */

/* The sample's cloud once more, elsewhere and of another size. */
static void add_copy(sample_scene *scene, double x, double y, double z, double scale)
{
    shape_frame frame = shape_frame_identity();
    for (int i = 0; i < 3; i++)
        frame.m[i][i] = scale;
    frame.m[0][3] = x, frame.m[1][3] = y, frame.m[2][3] = z;
    must(shape_set_add_copy(scene->set, 0, &frame, NULL, NULL), NULL);
}

/* A wall of 40 m across the view, 60 m behind the first cloud. */
static shape_opaque *make_wall(void)
{
    static const uint32_t corners[6] = {0, 1, 2, 0, 2, 3};
    const float white[3] = {1, 1, 1};
    shape_error error;
    shape_opaque *wall = shape_opaque_create(NULL);
    shape_mesh *mesh = shape_mesh_create(4, 2, NULL);
    assert_non_null(wall);
    assert_non_null(mesh);
    mesh->point_count = 4, mesh->triangle_count = 2;
    for (int i = 0; i < 4; i++)
        mesh->points[i] = shape_dvec3_make(i == 1 || i == 2 ? 20 : -20, i < 2 ? -20 : 20, -60);
    memcpy(mesh->indices, corners, sizeof corners);
    must(shape_opaque_add(wall, mesh, NULL, white, &error), &error);
    must(shape_opaque_finish(wall, &error), &error);
    shape_mesh_destroy(mesh);
    return wall;
}

static shape_march_work draw(const sample_scene *scene, const shape_view *view,
                             const shape_march_options *options)
{
    static float radiance[VALUES];
    shape_light light = shape_light_defaults();
    shape_marcher *marcher;
    shape_error error;
    must(shape_marcher_create(scene->volume, &light, view->eye, options, &marcher, &error), &error);
    must(shape_march_render(marcher, view, radiance, NULL, &error), &error);
    shape_march_work work = shape_marcher_work(marcher);
    shape_marcher_destroy(marcher);
    return work;
}

/* What is behind the eye, behind a wall or below a pixel adds no cell of light and no look: the picture takes exactly as many as
 * that of the one cloud alone. */
static void test_what_is_not_seen_costs_nothing(void **state)
{
    (void)state;
    shape_error error;
    shape_view view = test_view();
    shape_light light = shape_light_defaults();
    shape_budget_choice choice;
    shape_opaque *wall = make_wall();
    sample_scene all = sample_cumulus(12, 4), one = sample_cumulus(12, 4);
    shape_volume_destroy(all.volume);
    add_copy(&all, 0, 0, 60, 1);     /* behind the eye */
    add_copy(&all, 0, 0, -90, 1);    /* behind the wall */
    add_copy(&all, 300, 0, 0, 1);    /* beside the picture */
    add_copy(&all, 6, 6, -30, 0.01); /* 9 cm, 55 m away: a tenth of a pixel */
    must(shape_volume_create(all.set, &all.volume, &error), &error);
    shape_march_options options = shape_march_defaults();
    options.opaque = wall;
    must(shape_budget_march(all.volume, &view, &light, &options, 0.05, &choice, &error), &error);
    static const shape_budget_sight sights[] = {SHAPE_BUDGET_SEEN, SHAPE_BUDGET_OUTSIDE, SHAPE_BUDGET_BEHIND,
                                                SHAPE_BUDGET_OUTSIDE, SHAPE_BUDGET_TINY};
    for (size_t i = 0; i < sizeof sights / sizeof *sights; i++)
        assert_int_equal(choice.sights[i], sights[i]);
    assert_int_equal(choice.seen, 1);
    shape_budget_apply(&choice, all.volume, &options);
    shape_march_work work = draw(&all, &view, &options);
    shape_march_options plain = shape_march_defaults();
    plain.step = options.step, plain.resolution = options.resolution, plain.opaque = wall;
    shape_march_work alone = draw(&one, &view, &plain);
    assert_int_equal(work.cells, alone.cells);
    assert_int_equal(work.looks, alone.looks);
    assert_true(alone.looks > 100);
    /* Without the choice they do cost. */
    assert_true(draw(&all, &view, &plain).cells > 4 * alone.cells);
    shape_budget_free(&choice);
    sample_end(&all);
    sample_end(&one);
    shape_opaque_destroy(wall);
}

/* A thousand clouds below a pixel together are seen: they are kept. */
static void test_many_tiny_clouds_stay(void **state)
{
    (void)state;
    shape_error error;
    shape_view view = test_view();
    shape_light light = shape_light_defaults();
    sample_scene scene = sample_cumulus(3, 4);
    shape_volume_destroy(scene.volume);
    for (int i = 0; i < 1000; i++)
        add_copy(&scene, i % 40 - 20.0, i / 40 - 12.0, -30, 0.02);
    must(shape_volume_create(scene.set, &scene.volume, &error), &error);
    shape_budget_sight sights[1001];
    shape_budget_sights(scene.volume, &view, &light, NULL, 0.05, sights);
    int tiny = 0, seen = 0;
    for (int i = 1; i <= 1000; i++) {
        tiny += sights[i] == SHAPE_BUDGET_TINY;
        seen += sights[i] == SHAPE_BUDGET_SEEN;
    }
    /* 0.1 * 0.05^2 of 5184 pixels is 1.3 of them. */
    assert_in_range(tiny, 1, 20);
    assert_true(seen > 500);
    sample_end(&scene);
}

/* Nothing at all in view is a choice too. */
static void test_empty_view(void **state)
{
    (void)state;
    shape_error error;
    shape_view view = test_view();
    shape_light light = shape_light_defaults();
    shape_march_options options = shape_march_defaults();
    shape_budget_choice choice;
    sample_scene scene = sample_cumulus(5, 4);
    view.target = shape_dvec3_make(0, 0, 100);
    must(shape_budget_march(scene.volume, &view, &light, &options, 0.05, &choice, &error), &error);
    assert_int_equal(choice.seen, 0);
    shape_budget_apply(&choice, scene.volume, &options);
    shape_march_work work = draw(&scene, &view, &options);
    assert_int_equal(work.cells, 0);
    assert_int_equal(work.looks, 0);
    shape_budget_free(&choice);
    sample_end(&scene);
}

/* --- the error --- */

static void draw_generated(const generated_scene *s, const shape_volume *volume,
                           const shape_march_options *options, float *radiance)
{
    shape_error error;
    shape_marcher *marcher;
    must(shape_marcher_create(volume, &s->light, s->view.eye, options, &marcher, &error), &error);
    must(shape_march_render(marcher, &s->view, radiance, NULL, &error), &error);
    shape_marcher_destroy(marcher);
}

static double scene_side(const generated_scene *s)
{
    shape_dvec3 low = {0, 0, 0}, high = {1, 1, 1};
    shape_set_bounds(s->set, &low, &high);
    return fmax(high.x - low.x, fmax(high.y - low.y, high.z - low.z));
}

/* The truth is the march with all octaves, 600 steps and 48 cells. */
static void test_the_picture_is_within_the_error(void **state)
{
    (void)state;
    static float truth[VALUES], picture[VALUES];
    for (long number = 2001; number <= 2005; number++) {
        generated_scene s;
        shape_error error;
        shape_budget_choice choice;
        double change;
        generated_open(&s, number);
        shape_march_options options = shape_march_defaults();
        options.step = scene_side(&s) / 600;
        draw_generated(&s, s.volume, &options, truth);
        options = shape_march_defaults();
        must(shape_budget_march(s.volume, &s.view, &s.light, &options, s.error, &choice, &error), &error);
        shape_budget_apply(&choice, s.volume, &options);
        draw_generated(&s, s.volume, &options, picture);
        must(shape_budget_change(picture, truth, s.view.width, s.view.height, &change, &error), &error);
        if (change > s.error)
            fail_msg("scene %ld: an error of %g where %g is allowed", number, change, s.error);
        assert_true(choice.predicted <= s.error);
        shape_budget_free(&choice);
        generated_close(&s);
    }
}

/* Where the default's cells are chosen, since no others will do, the smaller ones of several clouds have them too: with their share
 * of them this scene was at twice the error allowed. */
static void test_the_last_cells_are_for_all_clouds(void **state)
{
    (void)state;
    generated_scene s;
    shape_error error;
    shape_budget_choice choice;
    const shape_march_options options = shape_march_defaults();
    generated_open(&s, 6020);
    must(shape_budget_march(s.volume, &s.view, &s.light, &options, s.error, &choice, &error), &error);
    assert_int_equal(choice.cells, options.resolution);
    assert_true(choice.seen > 1);
    for (size_t i = 0; i < s.volume->cloud_count; i++)
        if (choice.sights[i] == SHAPE_BUDGET_SEEN)
            assert_int_equal(choice.resolutions[i], options.resolution);
    shape_budget_free(&choice);
    generated_close(&s);
}

/* A layer's light is much finer with 48 cells than with the 24 that are tried: its steps, told with these, were too few, and
 * four times as many changed 1.5 times what is allowed. */
static void test_steps_of_a_layer_are_told_with_its_own_light(void **state)
{
    (void)state;
    static float finer[VALUES], picture[VALUES];
    generated_scene s;
    shape_error error;
    shape_budget_choice choice;
    double change;
    shape_march_options options = shape_march_defaults();
    generated_open(&s, 6021);
    must(shape_budget_march(s.volume, &s.view, &s.light, &options, s.error, &choice, &error), &error);
    assert_int_equal(choice.cells, shape_march_defaults().resolution);
    shape_budget_apply(&choice, s.volume, &options);
    draw_generated(&s, s.volume, &options, picture);
    options.step /= 4;
    draw_generated(&s, s.volume, &options, finer);
    must(shape_budget_change(picture, finer, s.view.width, s.view.height, &change, &error), &error);
    print_message("%d steps, changed by %g of %g\n", choice.steps, change, s.error);
    assert_true(change <= s.error);
    shape_budget_free(&choice);
    generated_close(&s);
}

static shape_budget_choice choose(const sample_scene *scene, double allowed)
{
    shape_error error;
    shape_view view = test_view();
    shape_light light = shape_light_defaults();
    shape_march_options options = shape_march_defaults();
    shape_budget_choice choice;
    must(shape_budget_march(scene->volume, &view, &light, &options, allowed, &choice, &error), &error);
    return choice;
}

static void test_less_error_takes_more_and_any_threads_the_same(void **state)
{
    (void)state;
    sample_scene scene = sample_cumulus(12, 4);
    shape_budget_choice loose = choose(&scene, 0.5), tight = choose(&scene, 0.01);
    assert_true(loose.steps < tight.steps);
    assert_true(loose.cells < tight.cells);
    assert_true(loose.octaves <= tight.octaves);
    assert_true(tight.predicted < loose.predicted);
    omp_set_num_threads(1);
    shape_budget_choice again = choose(&scene, 0.01);
    omp_set_num_threads(3);
    assert_int_equal(again.steps, tight.steps);
    assert_int_equal(again.cells, tight.cells);
    assert_true(again.predicted == tight.predicted);
    shape_budget_free(&loose);
    shape_budget_free(&tight);
    shape_budget_free(&again);
    sample_end(&scene);
}

static void test_wrong_options(void **state)
{
    (void)state;
    shape_error error;
    shape_view view = test_view();
    shape_light light = shape_light_defaults();
    shape_march_options options = shape_march_defaults();
    shape_budget_choice choice;
    sample_scene scene = sample_cumulus(2, 4);
    assert_int_equal(shape_budget_march(scene.volume, &view, &light, &options, 0, &choice, &error),
                     SHAPE_ERROR_ARGUMENT);
    assert_int_equal(shape_budget_march(scene.volume, &view, &light, &options, (double)NAN, &choice, &error),
                     SHAPE_ERROR_ARGUMENT);
    options.light = SHAPE_MARCH_SINGLE;
    assert_int_equal(shape_budget_march(scene.volume, &view, &light, &options, 0.1, &choice, &error),
                     SHAPE_ERROR_ARGUMENT);
    shape_budget_free(&choice);
    sample_end(&scene);
}

/* --- voxels --- */

static double voxel_from(const sample_scene *scene, double distance, double allowed, double *predicted)
{
    shape_error error;
    shape_view view = test_view();
    shape_light light = shape_light_defaults();
    double edge = 0;
    bool seen;
    view.width = 8 * WIDTH, view.height = 8 * HEIGHT;
    view.eye = shape_dvec3_make(0, 2, distance);
    must(shape_budget_voxel(scene->volume, &view, &light, allowed, &edge, predicted, &seen, &error), &error);
    assert_true(seen);
    assert_true(*predicted <= allowed);
    return edge;
}

static void test_voxels_follow_the_view(void **state)
{
    (void)state;
    sample_scene scene = sample_cumulus(12, 4);
    double predicted, near = voxel_from(&scene, 20, 0.02, &predicted);
    double far = voxel_from(&scene, 400, 0.02, &predicted), fine = voxel_from(&scene, 20, 0.002, &predicted);
    assert_true(far > near);
    assert_true(fine < near);
    shape_view view = test_view();
    shape_light light = shape_light_defaults();
    shape_error error;
    double edge = -1;
    bool seen = true;
    view.target = shape_dvec3_make(0, 0, 100);
    must(shape_budget_voxel(scene.volume, &view, &light, 0.05, &edge, &predicted, &seen, &error), &error);
    assert_false(seen);
    sample_end(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_what_is_not_seen_costs_nothing),
                                       cmocka_unit_test(test_many_tiny_clouds_stay),
                                       cmocka_unit_test(test_empty_view),
                                       cmocka_unit_test(test_the_picture_is_within_the_error),
                                       cmocka_unit_test(test_the_last_cells_are_for_all_clouds),
                                       cmocka_unit_test(test_steps_of_a_layer_are_told_with_its_own_light),
                                       cmocka_unit_test(test_less_error_takes_more_and_any_threads_the_same),
                                       cmocka_unit_test(test_wrong_options),
                                       cmocka_unit_test(test_voxels_follow_the_view)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
