/* The majorant grid: its bounds hold, and its density is the field's. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "light/majorant.h"
#include "scene_sample.h"
#include "shape/random.h"

static const majorant_cell *cell_at(const majorant_grid *grid, const double p[3])
{
    size_t at[3];
    for (int a = 0; a < 3; a++) {
        at[a] = (size_t)(p[a] * grid->inverse_cell[a]);
        at[a] = at[a] < (size_t)grid->n[a] ? at[a] : (size_t)grid->n[a] - 1;
    }
    return &grid->cells[at[0] + (size_t)grid->n[0] * (at[1] + (size_t)grid->n[1] * at[2])];
}

static double extinction_in(const majorant_grid *grid, const majorant_cell *cell, const double p[3],
                            float floor)
{
    double sum = 0;
    for (uint32_t i = 0; i < cell->count; i++) {
        const majorant_group *group = &grid->groups[cell->first + i];
        sum += (double)(grid->clouds[group->cloud].extinction * majorant_density(grid, group, p, floor));
    }
    return sum;
}

/* At random points: min <= extinction <= max, and the extinction is shape_volume_extinction's. Rounding may put a
 * point on the other side of the threshold once in a long while, so a few in ten thousand are let go. */
static void check_volume(const shape_volume *volume)
{
    majorant_grid grid;
    shape_random random = shape_random_seed(7, 1);
    int bad = 0, filled = 0;
    enum { POINTS = 40000 };
    assert_int_equal(majorant_grid_build(&grid, volume, NULL), SHAPE_OK);
    for (int i = 0; i < POINTS; i++) {
        double p[3];
        for (int a = 0; a < 3; a++)
            p[a] = grid.extent[a] * shape_random_unit(&random);
        const majorant_cell *cell = cell_at(&grid, p);
        shape_dvec3 world = shape_dvec3_add(grid.origin, shape_dvec3_make(p[0], p[1], p[2]));
        double truth = shape_volume_extinction(volume, world);
        double ours = extinction_in(&grid, cell, p, 0);
        bad += !(fabs(ours - truth) <= 1e-4 * (1 + truth));
        assert_true(ours <= (double)cell->max * (1 + 1e-5));
        assert_true(ours >= (double)cell->min * (1 - 1e-5));
        filled += truth > 0;
        if (cell->count == 1) { /* with a floor, the answer is on the right side of it */
            float extinction = grid.clouds[grid.groups[cell->first].cloud].extinction;
            double floor = shape_random_unit(&random);
            bool above = extinction_in(&grid, cell, p, (float)floor) > floor * (double)extinction;
            if (fabs(ours - floor * (double)extinction) > 1e-4)
                assert_true(above == (ours > floor * (double)extinction));
        }
    }
    assert_true(bad <= 4);
    assert_true(filled > POINTS / 20);
    majorant_grid_free(&grid);
}

static void holds_for_spheroids(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++) {
        sample_scene scene = sample_begin(SHAPE_MODEL_SPHEROID, 3);
        scene.set->clouds[0].field.kappa = (float)k / 3;
        sample_add(&scene, 0, 0, 0, 2, 2, 2);
        sample_add(&scene, 1.5f, 0.5f, 0, 1, 2, 1.5f);
        sample_add(&scene, -1, 0.7f, 1, 1.2f, 1.2f, 1.2f);
        sample_finish(&scene);
        check_volume(scene.volume);
        sample_end(&scene);
    }
}

static void holds_for_metaballs_and_uniform(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        sample_scene scene = sample_begin(k ? SHAPE_MODEL_METABALL : SHAPE_MODEL_UNIFORM, 5);
        sample_add(&scene, 0, 0, 0, 2, 2, 2);
        sample_add(&scene, 3, 0, 0, 1, 2, 1.5f);
        sample_finish(&scene);
        check_volume(scene.volume);
        sample_end(&scene);
    }
}

/* Smooth union, displacement and erosion, on each model; and a layer. */
static void holds_with_details_and_for_layers(void **state)
{
    (void)state;
    static const shape_model models[] = {SHAPE_MODEL_UNIFORM, SHAPE_MODEL_SPHEROID, SHAPE_MODEL_METABALL,
                                         SHAPE_MODEL_LAYER};
    for (int k = 0; k < 4; k++) {
        sample_scene scene = sample_begin(models[k], 4);
        shape_detail *detail = &scene.set->clouds[0].field.detail;
        if (models[k] != SHAPE_MODEL_LAYER && models[k] != SHAPE_MODEL_METABALL)
            detail->smoothness = 0.3f;
        if (models[k] != SHAPE_MODEL_LAYER)
            detail->billow = detail->wisp = 0.6f;
        detail->displace = 0.4f;
        sample_add(&scene, 0, 0, 0, 2, 2, 2);
        sample_add(&scene, 2, 0.5f, 0, 1, 2, 1.5f);
        sample_finish(&scene);
        check_volume(scene.volume);
        sample_end(&scene);
    }
}

/* The mean of left-out octaves is part of the density. */
static void holds_with_fewer_octaves(void **state)
{
    (void)state;
    sample_scene scene = sample_begin(SHAPE_MODEL_SPHEROID, 4);
    scene.set->clouds[0].field.octaves = 2;
    sample_add(&scene, 0, 0, 0, 2, 2, 2);
    sample_finish(&scene);
    scene.volume->clouds[0].mean_octaves = 3;
    check_volume(scene.volume);
    sample_end(&scene);
}

/* Three clouds that overlap, one turned and scaled, all far from the origin. */
static void holds_where_clouds_overlap(void **state)
{
    (void)state;
    sample_scene scene = sample_begin(SHAPE_MODEL_SPHEROID, 3);
    shape_frame frame = {{{0.6, -0.8, 0, 100001}, {0.8, 0.6, 0, 2}, {0, 0, 1.5, -50000}}};
    sample_add(&scene, 0, 0, 0, 2, 2, 2);
    sample_add(&scene, 1, 1, 0, 1, 2, 1);
    assert_int_equal(shape_set_add_copy(scene.set, 0, &frame, NULL, NULL), SHAPE_OK);
    assert_int_equal(shape_set_add_copy(scene.set, 0, &frame, NULL, NULL), SHAPE_OK);
    scene.set->clouds[0].frame.m[0][3] = 100000;
    scene.set->clouds[0].frame.m[2][3] = -50000;
    scene.set->clouds[2].field.model = SHAPE_MODEL_UNIFORM;
    for (int i = 0; i < 3; i++)
        assert_int_equal(
            shape_cloud_choose_noise_scale(&scene.set->clouds[i], shape_set_list(scene.set, 0), NULL),
            SHAPE_OK);
    assert_int_equal(shape_volume_create(scene.set, &scene.volume, NULL), SHAPE_OK);
    check_volume(scene.volume);
    sample_end(&scene);
}

static void nothing_makes_an_empty_grid(void **state)
{
    (void)state;
    majorant_grid grid;
    sample_scene scene = sample_begin(SHAPE_MODEL_SPHEROID, 3);
    sample_finish(&scene);
    assert_int_equal(majorant_grid_build(&grid, scene.volume, NULL), SHAPE_OK);
    assert_int_equal(grid.n[0], 0);
    majorant_grid_free(&grid);
    sample_end(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(holds_for_spheroids),
        cmocka_unit_test(holds_for_metaballs_and_uniform),
        cmocka_unit_test(holds_with_details_and_for_layers),
        cmocka_unit_test(holds_with_fewer_octaves),
        cmocka_unit_test(holds_where_clouds_overlap),
        cmocka_unit_test(nothing_makes_an_empty_grid),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
