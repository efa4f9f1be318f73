/* Volumes to primitives and back: overlap with what the volume was made of, what is conserved, and stubborn cases. The
 * volume is a voxel grid of a uniform cloud, as a .vdb would give it. */
#include "grid_sample.h"

#include "shape/gaussian.h"
#include "shape/volumefit.h"

/* The first cloud of a set as a grid of that many voxels along its longest side. */
static shape_set *voxels_of(const shape_set *set, int voxels)
{
    shape_volume *volume = new_volume(set);
    const shape_volume_cloud *c = &volume->clouds[0];
    shape_vec3 side = shape_vec3_sub(c->box.max, c->box.min);
    sampled_cloud s = {c, (double)fmaxf(side.x, fmaxf(side.y, side.z)) / voxels, {0, 0, 0}};
    int n[3];
    for (int a = 0; a < 3; a++) {
        (&s.at.x)[a] = (double)(&c->box.min.x)[a] - s.edge;
        n[a] = (int)((double)(&side.x)[a] / s.edge) + 3;
    }
    shape_set *made = grid_set(grid_of(of_cloud, &s, n[0], n[1], n[2]), s.edge, s.at);
    made->clouds[0].medium.extinction = 3;
    shape_volume_destroy(volume);
    return made;
}

/* Intersection over union of two uniform clouds, from evenly spread points of a box that holds both. */
static double overlap(const shape_set *a, const shape_set *b)
{
    shape_volume *va = new_volume(a), *vb = new_volume(b);
    shape_dvec3 low, high, low_b, high_b;
    shape_set_bounds(a, &low, &high);
    shape_set_bounds(b, &low_b, &high_b);
    for (int k = 0; k < 3; k++) {
        (&low.x)[k] = fmin((&low.x)[k], (&low_b.x)[k]);
        (&high.x)[k] = fmax((&high.x)[k], (&high_b.x)[k]);
    }
    size_t both = 0, either = 0;
    enum { N = 64 };
    for (int i = 0; i < N * N * N; i++) {
        double at[3] = {(i % N + 0.5) / N, (i / N % N + 0.5) / N, (i / N / N + 0.5) / N};
        shape_dvec3 p;
        for (int k = 0; k < 3; k++)
            (&p.x)[k] = (&low.x)[k] + at[k] * ((&high.x)[k] - (&low.x)[k]);
        bool in_a = shape_volume_extinction(va, p) > 0, in_b = shape_volume_extinction(vb, p) > 0;
        both += in_a && in_b;
        either += in_a || in_b;
    }
    shape_volume_destroy(va);
    shape_volume_destroy(vb);
    return (double)both / (double)either;
}

/* There and back, with as many primitives as there were, or fewer. */
static double round_trip(const shape_set *set, int cells, int rounds, shape_volumefit_report *report)
{
    shape_error error;
    shape_set *voxels = voxels_of(set, 96), *fit = new_set();
    shape_volume *volume = new_volume(voxels);
    shape_volumefit_options options = shape_volumefit_defaults();
    options.primitives = shape_primitives_count(shape_set_list_const(set, 0));
    options.resolution = cells;
    options.rounds = rounds;
    must(shape_volumefit(volume, &options, fit, "fit", NULL, report, &error), &error);
    must(shape_set_check(fit, &error), &error);
    assert_true(report->primitives <= options.primitives);
    assert_int_equal(report->primitives, shape_primitives_count(shape_set_list_const(fit, 0)));
    double found = overlap(set, fit);
    shape_volume_destroy(volume);
    shape_set_destroy(voxels);
    shape_set_destroy(fit);
    return found;
}

static void heap_of_spheres_comes_back(void **state)
{
    (void)state;
    shape_error error;
    shape_volumefit_report report;
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_UNIFORM);
    shape_gaussian options = shape_gaussian_defaults();
    must(shape_gaussian_make(&options, 1, shape_set_list(set, 0), NULL, &error), &error);
    double found = round_trip(set, 52, 80, &report);
    if (!(found >= 0.95))
        fail_msg("overlap %.4f of %zu primitives", found, report.primitives);
    /* The fit's own figure agrees, but for its coarser cells. */
    assert_true(fabs(report.overlap - found) < 0.03);
    shape_set_destroy(set);
}

static void rotated_ellipsoids_come_back(void **state)
{
    (void)state;
    shape_volumefit_report report;
    shape_random random = shape_random_seed(3, 0);
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_UNIFORM);
    for (int i = 0; i < 5; i++)
        add_ellipsoid(set, 0, draw_point(&random, 2), draw_size(&random, 0.6, 2), draw_size(&random, 0.6, 2),
                      draw_size(&random, 0.6, 2), draw_rotation(&random));
    double found = round_trip(set, 44, 100, &report);
    if (!(found >= 0.95))
        fail_msg("overlap %.4f of %zu primitives", found, report.primitives);
    shape_set_destroy(set);
}

/* About 60 puffs that grow from each other, as grammars make them. */
static void tower_of_puffs_comes_back(void **state)
{
    (void)state;
    shape_volumefit_report report;
    shape_random random = shape_random_seed(4, 0);
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_UNIFORM);
    shape_vec3 at[60];
    double radius[60] = {1};
    at[0] = shape_vec3_make(0, 0, 0);
    add_sphere(set, 0, 0, 0, 0, 1);
    for (int i = 1; i < 60; i++) {
        int from = (i - 1) / 2;
        shape_vec3 d = draw_direction(&random);
        d.y = fabsf(d.y);
        radius[i] = 0.87 * radius[from] * (1 - 0.1 * (i & 1));
        at[i] = shape_vec3_add(at[from], shape_vec3_scale(d, (float)(1.1 * radius[from])));
        add_sphere(set, 0, (double)at[i].x, (double)at[i].y, (double)at[i].z, radius[i]);
    }
    double found = round_trip(set, 60, 80, &report);
    if (!(found >= 0.95))
        fail_msg("overlap %.4f of %zu primitives", found, report.primitives);
    shape_set_destroy(set);
}

/* One ball through a sheared, mirrored transform is one ellipsoid; extinction over space is kept to 1 %. */
static void any_affine_transform_is_followed(void **state)
{
    (void)state;
    shape_error error;
    shape_volumefit_report report;
    shape_set *ball = new_set(), *fit = new_set();
    new_cloud(ball, SHAPE_MODEL_UNIFORM);
    add_sphere(ball, 0, 0, 0, 0, 1);
    shape_set *voxels = voxels_of(ball, 40);
    double mass = shape_grid_sum(shape_set_list_const(voxels, 0)->grid) * 3;
    shape_frame more = {{{-200, 40, 0, 1e5}, {0, 100, 30, -2e5}, {20, 0, 150, 3e5}}};
    voxels->clouds[0].frame = shape_frame_multiply(&more, &voxels->clouds[0].frame);
    mass *= fabs(shape_frame_determinant(&voxels->clouds[0].frame));
    shape_volume *volume = new_volume(voxels);
    shape_volumefit_options options = shape_volumefit_defaults();
    options.primitives = 1;
    options.resolution = 48;
    options.rounds = 150;
    must(shape_volumefit(volume, &options, fit, "fit", NULL, &report, &error), &error);
    assert_int_equal(report.primitives, 1);
    assert_true(report.overlap > 0.95);
    const shape_ellipsoid *e = fit->lists[0].ellipsoids;
    double held =
        4.18879 * (double)e->a * (double)e->b * (double)e->c * (double)fit->clouds[0].medium.extinction;
    assert_true(fabs(held - mass) <= 0.01 * mass);
    shape_volume_destroy(volume);
    shape_set_destroy(voxels);
    shape_set_destroy(ball);
    shape_set_destroy(fit);
}

/* The error falls, the number rises, and an error that is asked for is kept or said to be missed. */
static void error_chooses_the_number(void **state)
{
    (void)state;
    shape_error error;
    shape_volumefit_report report;
    shape_set *set = new_set(), *fit = new_set();
    shape_random random = shape_random_seed(5, 0);
    new_cloud(set, SHAPE_MODEL_UNIFORM);
    add_random(set, 0, &random, 8, 0, 2, 0.7, 1.2);
    shape_set *voxels = voxels_of(set, 40);
    shape_volume *volume = new_volume(voxels);
    shape_volumefit_options options = shape_volumefit_defaults();
    options.primitives = 40;
    options.resolution = 40;
    options.rounds = 40;
    options.error = 0.2;
    must(shape_volumefit(volume, &options, fit, "fit", NULL, &report, &error), &error);
    assert_true(report.reached && report.error <= 0.2 && report.primitives < 40);
    options.error = 1e-6;
    options.primitives = 2;
    must(shape_volumefit(volume, &options, fit, "fit", NULL, &report, &error), &error);
    assert_true(!report.reached && report.primitives == 2);
    shape_volume_destroy(volume);
    shape_set_destroy(voxels);
    shape_set_destroy(set);
    shape_set_destroy(fit);
}

static void options_are_checked(void **state)
{
    (void)state;
    shape_error error;
    shape_volumefit_options good = shape_volumefit_defaults(), bad;
    must(shape_volumefit_check(&good, &error), &error);
    bad = good, bad.primitives = 0;
    assert_int_equal(shape_volumefit_check(&bad, &error), SHAPE_ERROR_ARGUMENT);
    bad = good, bad.error = NAN;
    assert_int_equal(shape_volumefit_check(&bad, &error), SHAPE_ERROR_ARGUMENT);
    bad = good, bad.resolution = 15;
    assert_int_equal(shape_volumefit_check(&bad, &error), SHAPE_ERROR_ARGUMENT);
    bad = good, bad.rounds = -1;
    assert_int_equal(shape_volumefit_check(&bad, &error), SHAPE_ERROR_ARGUMENT);
    bad = good, bad.model = SHAPE_MODEL_METABALL;
    assert_int_equal(shape_volumefit_check(&bad, &error), SHAPE_ERROR_ARGUMENT);
    shape_set *empty = new_set();
    shape_volume *volume = new_volume(empty);
    shape_volumefit_report report;
    assert_int_equal(shape_volumefit(volume, &good, empty, "fit", NULL, &report, &error), SHAPE_ERROR_FORMAT);
    shape_volume_destroy(volume);
    shape_set_destroy(empty);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(heap_of_spheres_comes_back), cmocka_unit_test(rotated_ellipsoids_come_back),
        cmocka_unit_test(tower_of_puffs_comes_back),  cmocka_unit_test(any_affine_transform_is_followed),
        cmocka_unit_test(error_chooses_the_number),   cmocka_unit_test(options_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
