/* The viewer's panel and scenes: each thing that the panel can set is in the scene that it saves, and comes back from it; and
 * the copied commands of each generator make the bytes that the window shows. Needs no OpenGL. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "../viewer/setting.h"
#include "../viewer/state_scene.h"
#include "shape/neph.h"

/* Two clouds of a sphere. */
static shape_set *two_clouds(void)
{
    shape_error error;
    shape_set *set = shape_set_create(&error);
    assert_non_null(set);
    for (size_t i = 0; i < 2; i++) {
        const shape_sphere sphere = {0, 0, 0, 1};
        size_t index;
        assert_int_equal(shape_set_add_cloud(set, i ? "second" : "first", &index, &error), SHAPE_OK);
        assert_int_equal(shape_primitives_add_sphere(shape_set_list(set, index), sphere, &error), SHAPE_OK);
        set->clouds[index].field.noise_scale = 0.4f;
    }
    return set;
}

/* As a window begins that opens these clouds. */
static view_state *opened(const shape_set *set)
{
    view_state *state = malloc(sizeof *state);
    assert_non_null(state);
    const view_generator none = view_generator_none(1);
    view_state_reset(state);
    state->eye[2] = 10;
    view_state_take_set(state, set, &none);
    return state;
}

/* A value within the knob's range that is neither its present one nor a round number. */
static double another(const view_knob *knob, double now)
{
    double value = knob->min + (knob->max - knob->min) * 0.37;
    if (knob->kind == VIEW_KNOB_INT)
        value = (double)(int)value;
    return value == now ? knob->min + (knob->max - knob->min) * 0.5 : value;
}

/* Saved, written, read, loaded. */
static view_state *through_a_scene(const view_state *state, const shape_set *set)
{
    shape_error error = {SHAPE_OK, ""};
    shape_scene *scene = shape_scene_create(&error), *read = NULL;
    shape_scene_cloud *entry;
    char *text = NULL;
    size_t size = 0;
    assert_int_equal(shape_scene_add_cloud(scene, &entry, &error), SHAPE_OK);
    assert_int_equal(shape_scene_set_text(&entry->file, "two.neph", &error), SHAPE_OK);
    if (view_state_save(state, set, scene, &error) || shape_scene_encode(scene, &text, &size, &error) ||
        shape_scene_decode(text, size, "s.json", &read, &error))
        fail_msg("%s", error.text);
    free(text);
    shape_scene_destroy(scene);
    view_state *loaded = opened(set);
    view_state_load_light(loaded, read);
    if (view_state_load_view(loaded, read, NULL, &error))
        fail_msg("%s", error.text);
    view_state_load_edits(loaded, read);
    shape_scene_destroy(read);
    return loaded;
}

static void check_same(const view_state *a, const view_state *b, const char *what)
{
    const unsigned char *x = (const void *)a, *y = (const void *)b;
    for (size_t i = 0; i < sizeof *a; i++)
        if (x[i] != y[i])
            fail_msg("%s: the state differs at byte %zu of %zu", what, i, sizeof *a);
}

/* Each knob alone, so that none can hide behind another; of the second cloud, those that clouds have. */
static void every_knob_comes_back(void **state)
{
    (void)state;
    shape_set *set = two_clouds();
    for (size_t i = 0; i < view_knob_count; i++) {
        view_state *s = opened(set);
        const view_knob *knob = &view_knobs[i];
        int cloud = knob->of == VIEW_OF_STATE ? 0 : 1;
        s->course.day_runs = !strcmp(knob->group, "Day");
        if (!strcmp(knob->group,
                    "Air")) /* without air the panel does not show how it thins, nor a scene say it */
            s->air.visibility = 500;
        double value = another(knob, view_knob_get(knob, s, cloud));
        view_knob_set(knob, s, cloud, value);
        view_state *back = through_a_scene(s, set);
        assert_true(view_knob_get(knob, back, cloud) == view_knob_get(knob, s, cloud));
        check_same(s, back, knob->name);
        free(back);
        free(s);
    }
    shape_set_destroy(set);
}

/* What is no knob, and all knobs at once. */
static void everything_comes_back(void **state)
{
    (void)state;
    shape_set *set = two_clouds();
    view_state *s = opened(set);
    for (size_t i = 0; i < view_knob_count; i++)
        for (int cloud = 0; cloud < 2; cloud++)
            view_knob_set(&view_knobs[i], s, cloud,
                          another(&view_knobs[i], view_knob_get(&view_knobs[i], s, cloud)));
    s->course.day_runs = true;
    s->clouds[0].visible = false;
    s->clouds[1].medium.phase = SHAPE_PHASE_TWO_LOBE;
    for (int i = 0; i < 3; i++) {
        s->sun_irradiance[i] = 0.1f + (float)i / 3;
        s->sky_radiance[i] = 0.7f / (float)(i + 1);
        s->course.motion.wind[i] = 0.1 * i - 0.7;
        s->course.motion.drift[i] = 1.0 / (i + 3);
        s->lighting.ambient[i] = 0.1 * (i + 1);
        s->lighting.emission[i] = 2.0 / (i + 3);
        s->eye[i] = 1.0 / 3 + i;
        s->target[i] = 1e3 / 7 + i;
    }
    s->sky = SHAPE_SKY_CONSTANT;
    s->lighting.law = 2;
    s->method = 1;
    s->other_method = 3;
    s->split = s->boxes = s->difference = true;
    s->divider = 0.3f;
    s->heat = VIEW_HEAT_DEPTH;
    s->outlines = VIEW_OUTLINE_SHADED;
    s->course.motion.decay_start = 2.5;
    s->course.motion.decay = 3;
    s->course.morph_seconds = 7;
    view_state *back = through_a_scene(s, set);
    check_same(s, back, "everything");
    /* And a plain state says nothing of itself. */
    shape_error error;
    view_state *plain = opened(set);
    shape_scene *scene = shape_scene_create(&error);
    assert_int_equal(view_state_save(plain, set, scene, &error), SHAPE_OK);
    assert_int_equal(scene->view.count, 0);
    assert_int_equal(scene->edit_count, 0);
    /* Edits that are gone again leave the scene. */
    assert_int_equal(view_state_save(s, set, scene, &error), SHAPE_OK);
    assert_int_equal(scene->edit_count, 2);
    assert_int_equal(view_state_save(plain, set, scene, &error), SHAPE_OK);
    assert_int_equal(scene->edit_count, 0);
    shape_scene_destroy(scene);
    free(plain);
    free(back);
    free(s);
    shape_set_destroy(set);
}

/* Undo takes back each of them, too, but for the camera; and redo does it again. */
static void every_knob_is_undone(void **state)
{
    (void)state;
    shape_set *set = two_clouds();
    for (size_t i = 0; i < view_knob_count; i++) {
        view_state *s = opened(set), *before = opened(set), *after = malloc(sizeof *after);
        view_history *history = view_history_create(s);
        assert_non_null(history);
        view_knob_set(&view_knobs[i], s, 0, another(&view_knobs[i], view_knob_get(&view_knobs[i], s, 0)));
        memcpy(after, s, sizeof *s);
        view_history_keep(history, s);
        assert_true(view_history_undo(history, s));
        check_same(s, before, view_knobs[i].name);
        assert_true(view_history_redo(history, s));
        check_same(s, after, view_knobs[i].name);
        view_history_destroy(history);
        free(after);
        free(before);
        free(s);
    }
    shape_set_destroy(set);
}

static void mistakes_are_told(void **state)
{
    (void)state;
    static const struct {
        const char *view, *said;
    } all[] = {{"{\"metod\": \"exact\"}", "view: there is no key \"metod\""},
               {"{\"method\": \"exakt\"}", "view.method \"exakt\": expected default|exact|paper|paper-ndt"},
               {"{\"samples\": 1.5}", "view.samples \"1.5\": expected a number from 1 to 65536"},
               {"{\"light-grid\": 1}", "expected a number from 2 to 256"},
               {"{\"split\": 1}", "view.split \"1\": expected true"},
               {"{\"wind\": [1, 2]}", "view.wind \"1,2\": expected three numbers"},
               {"{\"light\": \"harris\"}", "view.light \"harris\": expected grid|single|powder"},
               {"{\"emission\": [1, 2, -1]}", "three numbers, each from 0 to 1e+09"},
               {"{\"decay\": \"5..3\"}", "view.decay \"5..3\": expected a range"}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        char text[256];
        shape_error error = {SHAPE_OK, ""};
        shape_scene *scene;
        snprintf(text, sizeof text, "{\"scene\": 1, \"clouds\": [], \"view\": %s}", all[i].view);
        assert_int_equal(shape_scene_decode(text, strlen(text), "s.json", &scene, &error), SHAPE_OK);
        assert_int_equal(view_state_check_view(scene, &error), SHAPE_ERROR_FORMAT);
        if (!strstr(error.text, all[i].said))
            fail_msg("\"%s\" does not say \"%s\"", error.text, all[i].said);
        shape_scene_destroy(scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_knob_comes_back),
        cmocka_unit_test(everything_comes_back),
        cmocka_unit_test(every_knob_is_undone),
        cmocka_unit_test(mistakes_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
