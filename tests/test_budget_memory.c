/* What --error chooses by (shape/budget.h), when memory runs out, when what is asked for cannot be, and where there is little
 * to choose from: no cloud in sight, one without noise, layers. One thread, so that the n-th allocation is always the
 * same. */
#include "failing_memory.h"

#include <math.h>
#include <omp.h>

#include "shape/budget.h"
#include "shape/layer.h"

enum { WIDTH = 4, HEIGHT = 3 };

static shape_set *set;
static shape_volume *volume;
static shape_view view;
static shape_light light;

/* Two clouds: a heap of three spheres, and one without any. */
static int make_scene(void **state)
{
    (void)state;
    shape_error error;
    shape_dvec3 min, max;
    omp_set_num_threads(1);
    set = shape_set_create(&error);
    light = shape_light_defaults();
    view = shape_view_defaults();
    view.width = WIDTH;
    view.height = HEIGHT;
    if (!set || shape_set_add_cloud(set, "a", NULL, &error) ||
        shape_set_add_cloud(set, "empty", NULL, &error))
        return 1;
    for (int i = 0; i < 3; i++) {
        shape_sphere sphere = {(float)i, 0.5f * (float)(i % 2), 0, 1};
        if (shape_primitives_add_sphere(shape_set_list(set, 0), sphere, &error))
            return 1;
    }
    set->clouds[0].field.octaves = 2;
    if (shape_cloud_choose_noise_scale(&set->clouds[0], shape_set_list(set, 0), &error) ||
        shape_volume_create(set, &volume, &error) || !shape_set_bounds(set, &min, &max))
        return 1;
    shape_view_frame(&view, &light, min, max);
    return 0;
}

static int drop_scene(void **state)
{
    (void)state;
    shape_volume_destroy(volume);
    shape_set_destroy(set);
    return 0;
}

static double allowed = 0.3;

static shape_status choose(shape_error *error)
{
    shape_march_options options = shape_march_defaults();
    shape_budget_choice choice;
    shape_status status = shape_budget_march(volume, &view, &light, &options, allowed, &choice, error);
    if (!status) {
        assert_int_equal(choice.seen, 1);
        assert_int_equal(choice.sights[1], SHAPE_BUDGET_EMPTY);
        assert_true(choice.steps >= 1 && choice.step > 0 && choice.predicted >= 0);
    }
    shape_budget_free(&choice);
    return status;
}

static shape_status choose_voxel(shape_error *error)
{
    double edge = 0, predicted = -1;
    bool seen = false;
    shape_status status = shape_budget_voxel(volume, &view, &light, allowed, &edge, &predicted, &seen, error);
    if (!status)
        assert_true(seen && edge > 0 && predicted >= 0);
    return status;
}

static void memory_runs_out(void **state)
{
    (void)state;
    fail_each(choose, 20, 0);
    fail_each(choose_voxel, 8, 0);
}

/* --- what cannot be --- */

static void refused_with(const shape_view *v, const shape_light *l, const shape_march_options *options,
                         double error_allowed, const char *words)
{
    shape_error error = {.text = ""};
    shape_budget_choice choice;
    assert_int_equal(shape_budget_march(volume, v, l, options, error_allowed, &choice, &error),
                     SHAPE_ERROR_ARGUMENT);
    if (!strstr(error.text, words))
        fail_msg("\"%s\" does not say \"%s\"", error.text, words);
    shape_budget_free(&choice);
    double edge = -7, predicted = -7;
    bool seen = true;
    if (options->light != SHAPE_MARCH_GRID || options->stepping != SHAPE_STEP_FIXED || options->samples < 1)
        return; /* of which voxels know nothing */
    error.text[0] = 0;
    assert_int_equal(shape_budget_voxel(volume, v, l, error_allowed, &edge, &predicted, &seen, &error),
                     SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, words));
    assert_true(!seen && edge == -7 && predicted == -7);
}

static void wrong_arguments_are_refused(void **state)
{
    (void)state;
    const shape_march_options good = shape_march_defaults();
    shape_march_options options = good;
    shape_view flat = view;
    shape_light dark = light;
    flat.height = 0;
    dark.sun_irradiance[0] = -1;
    refused_with(&flat, &light, &good, 0.1, "view size");
    refused_with(&view, &dark, &good, 0.1, "sun_irradiance");
    refused_with(&view, &light, &good, 0.9e-4, "an error of");
    refused_with(&view, &light, &good, 1.001, "an error of");
    refused_with(&view, &light, &good, NAN, "an error of");
    options.samples = 0;
    refused_with(&view, &light, &options, 0.1, "samples");
    options = good;
    options.light = SHAPE_MARCH_SINGLE;
    refused_with(&view, &light, &options, 0.1, "goes with the light grid");
    options = good;
    options.stepping = SHAPE_STEP_GEOMETRIC;
    refused_with(&view, &light, &options, 0.1, "goes with the light grid");
}

/* --- little to choose from --- */

static void nothing_in_sight(void **state)
{
    (void)state;
    shape_error error;
    shape_view away = view;
    shape_march_options options = shape_march_defaults();
    shape_budget_choice choice;
    away.target = shape_dvec3_sub(shape_dvec3_scale(view.eye, 2), view.target);
    assert_int_equal(shape_budget_march(volume, &away, &light, &options, 0.1, &choice, &error), SHAPE_OK);
    assert_int_equal(choice.seen, 0);
    assert_int_equal(choice.sights[0], SHAPE_BUDGET_OUTSIDE);
    assert_int_equal(choice.steps, 1);
    assert_true(choice.step == 1);
    shape_budget_free(&choice);
    double edge = -7, predicted = -7;
    bool seen = true;
    assert_int_equal(shape_budget_voxel(volume, &away, &light, 0.1, &edge, &predicted, &seen, &error),
                     SHAPE_OK);
    assert_true(!seen && edge == -7 && predicted == -7);
}

/* The smaller the error that is allowed, the more steps and the smaller voxels; the largest takes all. */
static void less_error_takes_more(void **state)
{
    (void)state;
    shape_error error;
    shape_march_options options = shape_march_defaults();
    const double errors[] = {1, 0.05, 1e-4};
    int steps = 0;
    double voxel = INFINITY;
    for (int i = 0; i < 3; i++) {
        shape_budget_choice choice;
        double edge, predicted;
        bool seen;
        assert_int_equal(shape_budget_march(volume, &view, &light, &options, errors[i], &choice, &error),
                         SHAPE_OK);
        assert_true(choice.steps >= steps);
        assert_true(choice.cells >= 4 && choice.cells <= 48);
        steps = choice.steps;
        shape_budget_free(&choice);
        if (i == 2)
            continue; /* voxels for it are many */
        assert_int_equal(
            shape_budget_voxel(volume, &view, &light, errors[i], &edge, &predicted, &seen, &error), SHAPE_OK);
        assert_true(seen && edge <= voxel && predicted <= errors[i]);
        voxel = edge;
    }
}

/* No octaves are left out where there is no noise; a layer's noise is its density, and it gets a finer first light. */
static void models_differ(void **state)
{
    (void)state;
    shape_error error;
    shape_march_options options = shape_march_defaults();
    for (int m = 0; m < 2; m++) {
        shape_set *other = shape_set_create(&error);
        shape_volume *made;
        shape_budget_choice choice;
        shape_view looking = view;
        shape_dvec3 min, max;
        assert_int_equal(shape_set_add_cloud(other, "a", NULL, &error), SHAPE_OK);
        if (m == 0) {
            const shape_sphere ball = {0, 0, 0, 1};
            other->clouds[0].field.model = SHAPE_MODEL_UNIFORM;
            assert_int_equal(shape_primitives_add_sphere(shape_set_list(other, 0), ball, &error), SHAPE_OK);
        } else {
            shape_layer_options layer = shape_layer_options_defaults();
            layer.octaves = 2;
            assert_int_equal(shape_layer_make(&layer, &other->clouds[0], shape_set_list(other, 0), &error),
                             SHAPE_OK);
        }
        int own = other->clouds[0].field.octaves;
        assert_int_equal(shape_volume_create(other, &made, &error), SHAPE_OK);
        assert_true(shape_set_bounds(other, &min, &max));
        shape_view_frame(&looking, &light, min, max);
        assert_int_equal(shape_budget_march(made, &looking, &light, &options, 0.3, &choice, &error),
                         SHAPE_OK);
        assert_int_equal(choice.octaves_of, own);
        if (m == 0)
            assert_int_equal(choice.octaves, own);
        else
            assert_in_range(choice.octaves, 1, own);
        shape_budget_apply(&choice, made, &options);
        assert_true(options.step == choice.step && options.resolution == choice.cells);
        assert_int_equal(made->clouds[0].field.octaves, choice.cloud_octaves[0]);
        shape_budget_free(&choice);
        options = shape_march_defaults();
        shape_volume_destroy(made);
        shape_set_destroy(other);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(memory_runs_out), cmocka_unit_test(wrong_arguments_are_refused),
        cmocka_unit_test(nothing_in_sight), cmocka_unit_test(less_error_takes_more),
        cmocka_unit_test(models_differ)};
    return cmocka_run_group_tests(tests, make_scene, drop_scene);
}
