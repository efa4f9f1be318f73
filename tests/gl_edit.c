/* Edits under a renderer that works in the background: only what an edit changes is made and sent again, at once, and in the
 * end the picture is, to the bit, that of a renderer which never saw what was there before. */
#include "gl_picture.h"

#include <stdatomic.h>
#include <time.h>

#include "shape/change.h"

enum { WIDTH = 160, HEIGHT = 90, VALUES = WIDTH * HEIGHT * 4 };

static shape_gl_renderer *watching_renderer(void)
{
    shape_error error;
    shape_gl_renderer *renderer;
    shape_gl_options options = shape_gl_defaults();
    options.light.resolution = 16;
    options.background = true;
    options.bake_voxels = 400000;
    must(shape_gl_create(&options, &renderer, &error), &error);
    return renderer;
}

static void draw_until_done(shape_gl_renderer *renderer, const shape_view *view)
{
    shape_error error;
    int frames = 0;
    do {
        must(shape_gl_draw_moving(renderer, view, &error), &error);
        shape_gl_finish();
        assert_true(frames++ < 100000);
    } while (shape_gl_pending(renderer));
}

static void load(shape_gl_renderer *renderer, const shape_volume *volume, const shape_light *light)
{
    shape_error error;
    must(shape_gl_load(renderer, volume, &error), &error);
    must(shape_gl_light(renderer, light, &error), &error);
}

static void picture_of(shape_gl_renderer *renderer, const shape_view *view, float *rgba)
{
    shape_error error;
    draw_until_done(renderer, view);
    must(shape_gl_draw(renderer, view, 0, &error), &error);
    must(shape_gl_read(renderer, rgba, &error), &error);
}

/* Two clouds, the second in the first one's shadow where the sun stands in the west; `moved` moves one of forty spheres. */
static shape_set *two_clouds(double moved, double radius)
{
    shape_set *set = new_set();
    shape_random random = shape_random_seed(3, 0);
    for (int i = 0; i < 2; i++) {
        shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_SPHEROID);
        cloud->field.noise_scale = 0.5f;
        cloud->frame.m[0][3] = 14 * i - 7;
        for (int corner = 0; corner < 8; corner++)
            add_sphere(set, (size_t)i, corner & 1 ? 2.5 : -2.5, corner & 2 ? 2 : -2, corner & 4 ? 2 : -2,
                       0.6);
        add_random(set, (size_t)i, &random, 31, 0, 2, 0.3, 0.8);
    }
    add_sphere(set, 0, 0.5 + moved, 0.5, 0, radius);
    return set;
}

static void check_edit(const shape_light *light, double moved, double radius, bool shades, float **pictures)
{
    shape_gl_renderer *renderer[2] = {watching_renderer(), watching_renderer()};
    shape_view view = view_of(WIDTH, HEIGHT, shape_dvec3_make(0, 1, 20), shape_dvec3_make(0, 0, 0), 40);
    shape_set *sets[2] = {two_clouds(0, 0.7), two_clouds(moved, radius)};
    shape_volume *volumes[2] = {new_volume(sets[0]), new_volume(sets[1])};
    shape_volume_keep_boxes(volumes[1], volumes[0]);
    shape_error error;
    load(renderer[0], volumes[0], light);
    picture_of(renderer[0], &view, pictures[0]);
    shape_gl_costs before = shape_gl_get_costs(renderer[0]);
    assert_true(shape_gl_stays(renderer[0], volumes[1]));
    load(renderer[0], volumes[1], light);
    must(shape_gl_draw_moving(renderer[0], &view, &error), &error);
    shape_gl_costs first = shape_gl_get_costs(renderer[0]);
    assert_int_equal(first.baked_clouds, before.baked_clouds);
    assert_int_equal(first.rebaked_clouds, 1);
    assert_int_equal(first.relit_clouds, shades ? 2 : 1);
    size_t sent = first.baked_bytes - before.baked_bytes;
    assert_true(sent > 0 && sent * 3 < before.baked_bytes);
    picture_of(renderer[0], &view, pictures[1]);
    shape_gl_costs then = shape_gl_get_costs(renderer[0]);
    assert_int_equal(then.baked_clouds, before.baked_clouds); /* no cloud was baked whole */
    assert_int_equal(then.lit_clouds, before.lit_clouds + (shades ? 2 : 1));
    load(renderer[1], volumes[1], light);
    picture_of(renderer[1], &view, pictures[2]);
    assert_memory_equal(pictures[1], pictures[2], VALUES * sizeof(float));
    assert_memory_not_equal(pictures[0], pictures[1], VALUES * sizeof(float));
    for (int i = 0; i < 2; i++) {
        shape_gl_destroy(renderer[i]);
        shape_volume_destroy(volumes[i]);
        shape_set_destroy(sets[i]);
    }
}

static void an_edit_makes_what_it_changes(void **state)
{
    (void)state;
    float *pictures[3];
    for (int i = 0; i < 3; i++) {
        pictures[i] = malloc(VALUES * sizeof(float));
        assert_non_null(pictures[i]);
    }
    shape_light light = shape_light_defaults();
    light.sun = shape_sun_direction(0, 60);
    check_edit(&light, 0.4, 0.7, false, pictures);
    check_edit(&light, 0, 0.5, false, pictures);
    light.sun = shape_sun_direction(-90, 10);
    check_edit(&light, -0.3, 0.8, true, pictures);
    for (int i = 0; i < 3; i++)
        free(pictures[i]);
}

/* Edits that come while what the last one asked for is still being made, and one that leaves the box: the last one's picture. */
static void edits_in_quick_succession(void **state)
{
    (void)state;
    enum { STEPS = 8 };
    shape_error error;
    float *pictures[2] = {malloc(VALUES * sizeof(float)), malloc(VALUES * sizeof(float))};
    assert_true(pictures[0] && pictures[1]);
    shape_view view = view_of(WIDTH, HEIGHT, shape_dvec3_make(0, 1, 20), shape_dvec3_make(0, 0, 0), 40);
    shape_light light = shape_light_defaults();
    shape_gl_renderer *renderer[2] = {watching_renderer(), watching_renderer()};
    shape_set *set = NULL, *last_set = NULL;
    shape_volume *volume = NULL, *last = NULL;
    for (int step = 0; step < STEPS; step++) {
        last_set = set, last = volume;
        set = two_clouds(step == 5 ? 3 : 0.1 * step, 0.7);
        volume = new_volume(set);
        if (last)
            shape_volume_keep_boxes(volume, last);
        if (step)
            assert_int_equal(shape_gl_stays(renderer[0], volume), step != 2 && step != 5);
        load(renderer[0], volume, &light);
        if (step != 1) /* once it is not even drawn before the next comes */
            must(shape_gl_draw_moving(renderer[0], &view, &error), &error);
        shape_volume_destroy(last);
        shape_set_destroy(last_set);
    }
    picture_of(renderer[0], &view, pictures[0]);
    load(renderer[1], volume, &light);
    picture_of(renderer[1], &view, pictures[1]);
    assert_memory_equal(pictures[0], pictures[1], VALUES * sizeof(float));
    for (int i = 0; i < 2; i++) {
        shape_gl_destroy(renderer[i]);
        free(pictures[i]);
    }
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* --- breaking off --- */

static double now_ms(void)
{
    struct timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

static bool says_stop(void *stop)
{
    return atomic_load((atomic_bool *)stop);
}

/* A crowd whose light and baking take seconds: broken off while a picture waits for it, and drawn when nobody minds
 * any more; what the thread has begun then ends with the renderer. The bound is 20 ms of each of two threads (docs of
 * shape_stop: a few milliseconds) and as much again for the driver. */
static void crowds_are_left_at_once(void **state)
{
    (void)state;
    enum { MOST_MS = 80 };
    shape_error error;
    shape_random random = shape_random_seed(4, 0);
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_SPHEROID)->field.noise_scale = 0.3f;
    add_random(set, 0, &random, 4000, 0, 0.05, 0.9, 1.1);
    shape_volume *volume = new_volume(set);
    shape_light light = shape_light_defaults();
    shape_view view = view_of(WIDTH, HEIGHT, shape_dvec3_make(0, 0, 4), shape_dvec3_make(0, 0, 0), 40);
    atomic_bool stop;
    atomic_init(&stop, true);
    shape_gl_options options = shape_gl_defaults();
    options.light.resolution = 40;
    options.background = true;
    options.stop = (shape_stop){says_stop, &stop};
    shape_gl_renderer *renderer;
    must(shape_gl_create(&options, &renderer, &error), &error);
    load(renderer, volume, &light);
    double start = now_ms();
    assert_int_equal(shape_gl_draw_moving(renderer, &view, &error), SHAPE_ERROR_STOPPED);
    assert_true(now_ms() - start < MOST_MS);
    atomic_store(&stop, false);
    must(shape_gl_draw_moving(renderer, &view, &error), &error);
    assert_true(shape_gl_pending(renderer));
    start = now_ms();
    load(renderer, volume, &light);
    print_message("%.1f ms until the thread had ended and the volume was loaded again\n", now_ms() - start);
    assert_true(now_ms() - start < MOST_MS);
    shape_gl_destroy(renderer);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_edit_makes_what_it_changes),
        cmocka_unit_test(edits_in_quick_succession),
        cmocka_unit_test(crowds_are_left_at_once),
    };
    return cmocka_run_group_tests(tests, open_context, close_context);
}
