/* Rendering when memory runs out: the tracer, the march with each kind of light, the methods of 2018, light grids, baked
 * grids, voxels, opaque things, denoising, simplifying, morphing and fitting. Each allocation fails once; it is reported as
 * such, and nothing is left behind. One thread, so that the n-th allocation is always the same. */
#include "failing_memory.h"

#include <omp.h>

#include "shape/bake.h"
#include "shape/combine.h"
#include "shape/denoise.h"
#include "shape/gaussian.h"
#include "shape/imageerror.h"
#include "shape/lightvoxels.h"
#include "shape/march.h"
#include "shape/mesh.h"
#include "shape/morph.h"
#include "shape/opaque.h"
#include "shape/paper.h"
#include "shape/simplify.h"
#include "shape/volumefit.h"
#include "shape/voxels.h"

enum { WIDTH = 6, HEIGHT = 4, VALUES = 3 * WIDTH * HEIGHT };

static shape_set *set;
static shape_volume *volume;
static shape_view view;
static shape_light light;
static float radiance[VALUES], variance[VALUES], result[VALUES];

static int make_scene(void **state)
{
    (void)state;
    shape_error error;
    shape_gaussian gaussian = shape_gaussian_defaults();
    shape_dvec3 min, max;
    gaussian.count = 6;
    omp_set_num_threads(1);
    set = shape_set_create(&error);
    light = shape_light_defaults();
    view = shape_view_defaults();
    view.width = WIDTH;
    view.height = HEIGHT;
    if (!set || shape_set_add_cloud(set, "a", NULL, &error) ||
        shape_gaussian_make(&gaussian, 1, shape_set_list(set, 0), NULL, &error) ||
        shape_cloud_choose_noise_scale(&set->clouds[0], shape_set_list(set, 0), &error) ||
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

/* --- paths --- */

static shape_status add_triangle(shape_opaque *opaque, shape_error *error)
{
    const float albedo[3] = {0.5f, 0.5f, 0.5f};
    shape_mesh *mesh = shape_mesh_create(3, 1, error);
    if (!mesh)
        return SHAPE_ERROR_MEMORY;
    mesh->points[0] = shape_dvec3_make(-9, -1, -9);
    mesh->points[1] = shape_dvec3_make(9, -1, -9);
    mesh->points[2] = shape_dvec3_make(0, -1, 9);
    for (uint32_t i = 0; i < 3; i++)
        mesh->indices[i] = i;
    shape_status status = shape_opaque_add(opaque, mesh, NULL, albedo, error);
    shape_mesh_destroy(mesh);
    return status ? status : shape_opaque_finish(opaque, error);
}

static shape_status trace_with(const shape_opaque *opaque, shape_error *error)
{
    shape_tracer *tracer;
    shape_pathtrace_result outcome;
    shape_pathtrace_options options = shape_pathtrace_defaults();
    options.samples = 1;
    options.opaque = opaque;
    shape_status status = shape_tracer_create(volume, &tracer, error);
    if (status)
        return status;
    status = shape_pathtrace_render(tracer, &view, &light, &options, radiance, variance, &outcome, error);
    shape_tracer_destroy(tracer);
    return status ? status : shape_denoise(radiance, variance, WIDTH, HEIGHT, result, error);
}

static shape_status trace(shape_error *error)
{
    shape_opaque *opaque = shape_opaque_create(error);
    shape_status status = opaque ? add_triangle(opaque, error) : SHAPE_ERROR_MEMORY;
    if (!status)
        status = trace_with(opaque, error);
    shape_opaque_destroy(opaque);
    return status;
}

static void paths(void **state)
{
    (void)state;
    fail_each(trace, 10, 0);
}

/* --- marching --- */

static shape_march_light march_light;
static shape_march_shadow march_shadow;
static shape_march_jitter march_jitter;

static shape_status march(shape_error *error)
{
    shape_marcher *marcher;
    shape_march_options options = shape_march_defaults();
    options.light = march_light;
    options.shadow = march_shadow;
    options.jitter = march_jitter;
    options.resolution = 4;
    options.step = 1;
    shape_status status = shape_marcher_create(volume, &light, view.eye, &options, &marcher, error);
    if (status)
        return status;
    status = shape_march_render(marcher, &view, radiance, NULL, error);
    shape_marcher_destroy(marcher);
    return status;
}

static void marches(void **state)
{
    (void)state;
    march_shadow = SHAPE_SHADOW_MARCH;
    static const shape_march_light lights[] = {SHAPE_MARCH_TWO_PASS, SHAPE_MARCH_OCTAVES, SHAPE_MARCH_GRID};
    for (size_t l = 0; l < sizeof lights / sizeof *lights; l++) {
        march_light = lights[l];
        fail_each(march, 3, 0);
    }
    march_light = SHAPE_MARCH_SINGLE;
    march_shadow = SHAPE_SHADOW_GRID;
    march_jitter = SHAPE_JITTER_BLUE; /* whose tile takes long to make */
    fail_each(march, 3, 0);
}

static shape_status follow_paper(shape_error *error)
{
    shape_paper_options options = shape_paper_defaults();
    options.resolution = 3;
    return shape_paper_render(volume, &view, &light, &options, radiance, NULL, NULL, error);
}

static void methods_of_2018(void **state)
{
    (void)state;
    fail_each(follow_paper, 3, 0);
}

/* --- grids --- */

static shape_status make_lights(shape_error *error)
{
    shape_lightvoxels lights;
    shape_status status = shape_lightvoxels_build(volume, &light, 6, 1, &lights, error);
    if (!status)
        shape_lightvoxels_free(&lights);
    return status;
}

static shape_status bake(shape_error *error)
{
    shape_baked baked;
    shape_status status = shape_bake(&volume->clouds[0], 1, 1, &baked, error);
    if (!status)
        shape_baked_free(&baked);
    return status;
}

/* As after an edit: one primitive of six has changed. */
static shape_status make_again(shape_error *error)
{
    shape_baked baked;
    shape_change change = {0};
    shape_sunsweep *sweep = NULL, *again = NULL;
    shape_lightgrid grid = {0}, other = {0};
    const int cells = 8;
    shape_sunsweep_options swept = {.threads = 1, .keep = true};
    shape_lightgrid_options options = shape_lightgrid_defaults();
    options.resolution = 6;
    options.threads = 1;
    shape_volume_cloud before = volume->clouds[0];
    shape_primitives list = *before.shape_list;
    list.sphere_count--;
    before.shape_list = &list;
    uint8_t *bricks = NULL;
    shape_status status = shape_change_find(&before, &volume->clouds[0], &change, error);
    if (!status)
        status = shape_bake(&volume->clouds[0], 1, 1, &baked, error);
    if (!status) {
        status = shape_bake_again(&volume->clouds[0], &change, 1, (shape_stop){0}, &baked, &bricks, error);
        shape_baked_free(&baked);
    }
    free(bricks);
    if (!status)
        status = shape_sunsweep_create_with(volume, &light, &cells, &swept, &sweep, error);
    swept.from = sweep;
    swept.changes = &change;
    options.sweep = sweep;
    if (!status)
        status = shape_lightgrid_build(volume, 0, &light, &options, &grid, error);
    if (!status)
        status = shape_sunsweep_create_with(volume, &light, &cells, &swept, &again, error);
    options.sweep = again;
    options.from = &grid;
    options.change = &change;
    if (!status)
        status = shape_lightgrid_build(volume, 0, &light, &options, &other, error);
    shape_lightgrid_free(&grid);
    if (!status)
        shape_lightgrid_free(&other);
    shape_sunsweep_destroy(sweep);
    shape_sunsweep_destroy(again);
    shape_change_free(&change);
    return status;
}

static bool take_brick(void *context, const int32_t first[3], const float *values)
{
    (void)first;
    (void)values;
    ++*(size_t *)context;
    return true;
}

static bool take_tile(void *context, const int32_t first[3], int32_t edge, float value)
{
    (void)edge;
    (void)value;
    return take_brick(context, first, NULL);
}

static shape_status fill_voxels(shape_error *error)
{
    double min[3], max[3], rmse;
    bool any;
    size_t taken = 0, bricks;
    shape_voxel_lattice lattice;
    shape_voxel_request request = shape_voxel_request_defaults();
    shape_voxel_sink sink = {&taken, take_brick, take_tile};
    request.threads = 1;
    shape_status status = shape_voxels_bounds(volume, -1, true, min, max, &any, error);
    if (!status)
        status = shape_voxels_lay_out(min, max, 0.5, true, &lattice, error);
    if (!status)
        status = shape_voxels_count(volume, &lattice, &request, SIZE_MAX, &bricks, error);
    if (!status)
        status = shape_voxels_fill(volume, &lattice, &request, &sink, error);
    request.quantity = SHAPE_VOXEL_SDF;
    if (!status)
        status = shape_voxels_fill(volume, &lattice, &request, &sink, error);
    if (!status)
        status = shape_voxels_error(volume, &request, 0.5, 50, 1, &rmse, error);
    return status;
}

static void grids(void **state)
{
    (void)state;
    fail_each(make_lights, 3, 0);
    fail_each(bake, 1, 0);
    fail_each(make_again, 10, 0);
    fail_each(fill_voxels, 3, 0);
}

/* --- clouds from clouds --- */

static shape_status simplify(shape_error *error)
{
    shape_simplify_options options = shape_simplify_defaults();
    options.error = 0.2;
    options.most = 5;
    shape_set *copy = shape_set_create(error);
    shape_status status = copy ? shape_set_append(copy, set, error) : SHAPE_ERROR_MEMORY;
    if (!status)
        status = shape_primitives_simplify(shape_set_list(copy, 0), &copy->clouds[0], &options, NULL, error);
    shape_set_destroy(copy);
    return status;
}

static shape_status morph(shape_error *error)
{
    shape_morph *made;
    shape_set *between;
    shape_status status = shape_morph_create(set, set, &made, error);
    if (status)
        return status;
    status = shape_morph_at(made, 0.5, &between, error);
    if (!status)
        shape_set_destroy(between);
    shape_morph_destroy(made);
    return status;
}

static shape_status fit(shape_error *error)
{
    shape_volumefit_options options = shape_volumefit_defaults();
    shape_volumefit_report report;
    options.primitives = 4;
    options.resolution = 16;
    options.rounds = 2;
    shape_set *fitted = shape_set_create(error);
    shape_status status =
        fitted ? shape_volumefit(volume, &options, fitted, "fit", NULL, &report, error) : SHAPE_ERROR_MEMORY;
    shape_set_destroy(fitted);
    return status;
}

static void clouds_from_clouds(void **state)
{
    (void)state;
    fail_each(simplify, 10, 0);
    fail_each(morph, 5, 0);
    fail_each(fit, 5, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(paths), cmocka_unit_test(marches),
                                       cmocka_unit_test(methods_of_2018), cmocka_unit_test(grids),
                                       cmocka_unit_test(clouds_from_clouds)};
    return cmocka_run_group_tests(tests, make_scene, drop_scene);
}
