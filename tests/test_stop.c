/* Breaking off: light and baking of crowds, tens of thousands of primitives over one point, ask whether to go on within 20 ms
 * of a thread's work, end within as much when they are told to, and leave nothing behind. */
#include "volume_sample.h"

#include <omp.h>
#include <time.h>

#include "shape/bake.h"
#include "shape/lightgrid.h"
#include "shape/sunsweep.h"

#ifdef __SANITIZE_ADDRESS__
enum { MOST_MS = 100 }; /* a sanitizer's work is several times as long */
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
enum { MOST_MS = 100 };
#else
enum { MOST_MS = 20 };
#endif
#else
enum { MOST_MS = 20 };
#endif

/* Of this thread: other programs do not count. */
static double work_ms(void)
{
    struct timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

typedef struct listener {
    double begun, asked, longest; /* [ms]; longest: between two questions */
    double patience;              /* when it says stop */
    int questions;
} listener;

static bool enough(void *context)
{
    listener *l = context;
    double now = work_ms();
    l->longest = fmax(l->longest, now - l->asked);
    l->asked = now;
    l->questions++;
    return now - l->begun > l->patience;
}

/* From here on. */
static void begin(listener *l)
{
    l->begun = l->asked = work_ms();
}

typedef shape_status (*piece)(const shape_volume *volume, shape_stop stop, shape_error *error);

static float voxel_of(const shape_volume_cloud *cloud)
{
    return shape_bake_voxel(cloud, 0.02f, 2000000);
}

static shape_status bake(const shape_volume *volume, shape_stop stop, shape_error *error)
{
    shape_baked baked;
    shape_status status =
        shape_bake_with(&volume->clouds[0], voxel_of(&volume->clouds[0]), 1, stop, &baked, error);
    if (!status)
        shape_baked_free(&baked);
    return status;
}

/* With a change that touches all, over a grid that is empty. */
static shape_status bake_again(const shape_volume *volume, shape_stop stop, shape_error *error)
{
    const shape_volume_cloud *cloud = &volume->clouds[0];
    shape_volume_cloud empty = *cloud;
    shape_primitives none = {0};
    shape_tree no_tree = {0};
    shape_box box = cloud->box;
    const shape_change change = {.boxes = &box, .count = 1};
    shape_baked baked;
    empty.list = empty.shape_list = &none;
    empty.tree = empty.detail_tree = &no_tree;
    must(shape_bake(&empty, voxel_of(cloud), 1, &baked, error), error);
    begin(stop.context);
    shape_status status = shape_bake_again(cloud, &change, 1, stop, &baked, NULL, error);
    assert_null(status ? baked.voxels : NULL);
    shape_baked_free(&baked);
    return status;
}

static shape_status sweep(const shape_volume *volume, shape_stop stop, shape_error *error)
{
    shape_light light = shape_light_defaults();
    shape_sunsweep *swept;
    const int cells = 80;
    const shape_sunsweep_options options = {.threads = 1, .keep = true, .stop = stop};
    shape_status status = shape_sunsweep_create_with(volume, &light, &cells, &options, &swept, error);
    if (!status)
        shape_sunsweep_destroy(swept);
    return status;
}

static shape_status light_by(const shape_volume *volume, const shape_sunsweep *swept, shape_stop stop,
                             shape_error *error)
{
    shape_light light = shape_light_defaults();
    shape_lightgrid grid;
    shape_lightgrid_options options = shape_lightgrid_defaults();
    options.threads = 1;
    options.sweep = swept;
    options.stop = stop;
    shape_status status = shape_lightgrid_build(volume, 0, &light, &options, &grid, error);
    if (!status)
        shape_lightgrid_free(&grid);
    return status;
}

static shape_status march(const shape_volume *volume, shape_stop stop, shape_error *error)
{
    return light_by(volume, NULL, stop, error);
}

/* A sweep that nobody minds: the densities of the cells, and the scattered light. */
static shape_sunsweep *ready;

static shape_status scatter(const shape_volume *volume, shape_stop stop, shape_error *error)
{
    return light_by(volume, ready, stop, error);
}

static shape_status light_of_2018(const shape_volume *volume, shape_stop stop, shape_error *error)
{
    shape_light light = shape_light_defaults();
    shape_lightgrid grid;
    shape_status status = shape_lightgrid_build_2018_with(volume, 0, &light, 40, 0.1f, stop, &grid, error);
    if (!status)
        shape_lightgrid_free(&grid);
    return status;
}

static void check(const shape_volume *volume, piece work, double patience)
{
    shape_error error;
    listener l = {.patience = patience};
    begin(&l);
    assert_int_equal(work(volume, (shape_stop){enough, &l}, &error), SHAPE_ERROR_STOPPED);
    double after = work_ms() - l.asked;
    print_message("asked %d times, at most %.1f ms apart, ended %.1f ms after\n", l.questions, l.longest,
                  after);
    assert_true(l.longest < MOST_MS && after < MOST_MS);
}

/* Balls and ellipsoids of nearly one size about one point. */
static shape_volume *crowd_of(shape_set *set, shape_model model, bool details, size_t spheres,
                              size_t ellipsoids)
{
    shape_random random = shape_random_seed(1, 0);
    shape_cloud *cloud = new_cloud(set, model);
    cloud->field.noise_scale = 0.4f;
    cloud->field.detail.smoothness = details ? 0.2f : 0;
    add_random(set, 0, &random, spheres, ellipsoids, 0.05, 0.9, 1.1);
    return new_volume(set);
}

static void crowds_can_be_broken_off(void **state)
{
    (void)state;
    enum { MODELS = 3 };
    static const shape_model models[MODELS] = {SHAPE_MODEL_SPHEROID, SHAPE_MODEL_SPHEROID,
                                               SHAPE_MODEL_METABALL};
    static const piece pieces[] = {bake, bake_again, sweep, scatter};
    for (int m = 0; m < MODELS; m++) {
        shape_set *set = new_set();
        shape_volume *volume = crowd_of(set, models[m], m == 1, 40000, 40000);
        const int cells = 2;
        shape_error error;
        shape_light light = shape_light_defaults();
        must(shape_sunsweep_create(volume, &light, &cells, 1, &ready, &error), &error);
        for (size_t i = 0; i < sizeof pieces / sizeof *pieces; i++) {
            check(volume, pieces[i], -1);
            check(volume, pieces[i], 60);
        }
        shape_sunsweep_destroy(ready);
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
}

/* The march sorts all that a ray meets, which is not broken off: a fifth of the crowd. */
static void marches_can_be_broken_off(void **state)
{
    (void)state;
    shape_set *set = new_set();
    shape_volume *volume = crowd_of(set, SHAPE_MODEL_SPHEROID, false, 15000, 0);
    check(volume, march, 60);
    check(volume, light_of_2018, 60);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* A grid of few primitives and many cells: the solution of the scattered light itself. */
static void solutions_can_be_broken_off(void **state)
{
    (void)state;
    shape_error error;
    shape_light light = shape_light_defaults();
    shape_set *set = new_set();
    shape_volume *volume = crowd_of(set, SHAPE_MODEL_SPHEROID, false, 3, 0);
    const int cells = 48;
    must(shape_sunsweep_create(volume, &light, &cells, 1, &ready, &error), &error);
    check(volume, scatter, 10);
    check(volume, scatter, 50);
    shape_sunsweep_destroy(ready);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

int main(void)
{
    omp_set_num_threads(1); /* a thread's own work is what is measured */
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(crowds_can_be_broken_off),
        cmocka_unit_test(marches_can_be_broken_off),
        cmocka_unit_test(solutions_can_be_broken_off),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
