/* Sets as voxels and as volumes: closed forms of a sphere, equality with the field at voxel centres, the ramp, signed
 * distance and the rest. */
#include "neph_sample.h"

#include <math.h>

#include "shape/lightvoxels.h"
#include "shape/vdb.h"
#include "shape/voxels.h"

static const double pi = 3.14159265358979323846;

/* A set with a cloud of one model, placed askew. */
static shape_set *make_set(shape_model model, size_t spheres, size_t ellipsoids)
{
    shape_error error;
    size_t index;
    shape_set *set = shape_set_create(&error);
    shape_random random = shape_random_seed(7, 0);
    must(shape_set_add_cloud(set, "one", &index, &error), &error);
    shape_cloud *cloud = &set->clouds[0];
    cloud->field.model = model;
    sample_primitives(&set->lists[0], &random, spheres, ellipsoids);
    const shape_frame askew = {{{0.8, -0.6, 0, 3}, {0.6, 0.8, 0, -40}, {0, 0, 1, 1000}}};
    cloud->frame = askew;
    must(shape_cloud_choose_noise_scale(cloud, &set->lists[0], &error), &error);
    return set;
}

static shape_set *make_ball(float radius, double x, double y, double z)
{
    shape_error error;
    size_t index;
    shape_set *set = shape_set_create(&error);
    must(shape_set_add_cloud(set, "ball", &index, &error), &error);
    set->clouds[0].field.model = SHAPE_MODEL_UNIFORM;
    set->clouds[0].frame.m[0][3] = x, set->clouds[0].frame.m[1][3] = y, set->clouds[0].frame.m[2][3] = z;
    shape_sphere s = {0, 0, 0, radius};
    must(shape_primitives_add_sphere(&set->lists[0], s, &error), &error);
    return set;
}

typedef struct filled {
    shape_volume *volume;
    shape_voxel_lattice lattice;
    shape_vdb *file;
    shape_vdb_grid *grid;
    shape_vdb_summary summary;
} filled;

static filled fill(const shape_set *set, int resolution, bool z_up, shape_voxel_request request)
{
    shape_error error;
    filled f;
    double min[3], max[3], longest = 0;
    must(shape_volume_create(set, &f.volume, &error), &error);
    bool any = false;
    must(shape_voxels_bounds(f.volume, request.cloud, z_up, min, max, &any, &error), &error);
    assert_true(any);
    for (int k = 0; k < 3; k++)
        longest = fmax(longest, max[k] - min[k]);
    must(shape_voxels_lay_out(min, max, longest / resolution, z_up, &f.lattice, &error), &error);
    f.file = shape_vdb_create();
    assert_non_null(f.file);
    shape_vdb_options options = {.name = "density",
                                 .edge = f.lattice.edge,
                                 .origin = {f.lattice.origin[0], f.lattice.origin[1], f.lattice.origin[2]},
                                 .vector = request.quantity == SHAPE_VOXEL_SAMPLE,
                                 .level_set = request.quantity == SHAPE_VOXEL_SDF,
                                 .background = (float)(request.band * f.lattice.edge)};
    must(shape_vdb_add(f.file, &options, &f.grid, &error), &error);
    shape_voxel_sink sink = {f.grid, shape_vdb_put_brick, shape_vdb_put_tile};
    must(shape_voxels_fill(f.volume, &f.lattice, &request, &sink, &error), &error);
    must(shape_vdb_summarise(f.grid, &f.summary, &error), &error);
    return f;
}

static void drop(filled *f)
{
    shape_vdb_destroy(f->file);
    shape_volume_destroy(f->volume);
}

/* The volume of the voxels is the ball's within what its surface can change: a shell of a voxel's diagonal on either
 * side would be 3 sqrt(3) L / r; roundings average out, so a fiftieth of it is asked. */
static void test_ball(void **state)
{
    (void)state;
    const float radius = 3;
    const double at[3] = {10, -20, 5000};
    shape_set *set = make_ball(radius, at[0], at[1], at[2]);
    filled f = fill(set, 100, true, shape_voxel_request_defaults());
    double edge = f.lattice.edge;
    assert_float_equal(edge, 2 * 3 / 100.0, 1e-12);
    double volume = (double)f.summary.active * edge * edge * edge, exact = 4.0 / 3 * pi * 27;
    assert_true(fabs(volume / exact - 1) < 3 * sqrt(3) * edge / 3 / 50);
    /* Bounds: the active voxels span 100 along each axis, and the middle is the ball's, x, -z, y. */
    const double centre[3] = {at[0], -at[2], at[1]};
    for (int k = 0; k < 3; k++) {
        assert_int_equal(f.summary.max[k] - f.summary.min[k] + 1, 100);
        double middle = f.lattice.origin[k] + 0.5 * edge * (f.summary.min[k] + f.summary.max[k]);
        assert_true(fabs(middle - centre[k]) < 1e-9);
    }
    /* The inside is tiles: fewer leaves than the box has. */
    assert_true(f.summary.leaves > 0 && f.summary.leaves < 13 * 13 * 13 * 6 / 10);
    drop(&f);
    shape_set_destroy(set);
}

/* Every voxel of the lattice, and a rim around it, holds the field's density at its centre, bit for bit. */
static void check_equal(const shape_set *set, bool z_up)
{
    filled f = fill(set, 40, z_up, shape_voxel_request_defaults());
    size_t some = 0;
    int32_t i[3];
    for (i[0] = -2; i[0] < f.lattice.size[0] + 2; i[0]++)
        for (i[1] = -2; i[1] < f.lattice.size[1] + 2; i[1]++)
            for (i[2] = -2; i[2] < f.lattice.size[2] + 2; i[2]++) {
                shape_dvec3 world = shape_voxel_point(&f.lattice, i);
                shape_dvec3 p = shape_frame_point(&f.volume->clouds[0].inverse, world);
                float density = shape_cloud_density(&f.volume->clouds[0],
                                                    shape_vec3_make((float)p.x, (float)p.y, (float)p.z));
                float value = shape_vdb_value(f.grid, i);
                if (value != density)
                    fail_msg("voxel %d %d %d: %.9g, not %.9g", i[0], i[1], i[2], (double)value,
                             (double)density);
                some += density > 0;
            }
    assert_true(some > 100);
    assert_int_equal(some, f.summary.active);
    drop(&f);
}

static void test_equals_field(void **state)
{
    (void)state;
    const shape_model models[] = {SHAPE_MODEL_UNIFORM, SHAPE_MODEL_SPHEROID, SHAPE_MODEL_METABALL,
                                  SHAPE_MODEL_LAYER};
    for (size_t i = 0; i < sizeof models / sizeof *models; i++) {
        shape_set *set = make_set(models[i], 6, 6);
        if (models[i] == SHAPE_MODEL_LAYER) {
            set->clouds[0].field.layer = shape_layer_defaults();
            set->clouds[0].field.layer.bounds = SHAPE_BOUNDS_BOX;
        }
        check_equal(set, i % 2);
        shape_set_destroy(set);
    }
    shape_set *set = make_set(SHAPE_MODEL_SPHEROID, 6, 3);
    set->clouds[0].field.detail.displace = 0.5f;
    set->clouds[0].field.detail.smoothness = 0.2f;
    set->clouds[0].field.detail.billow = 0.5f;
    check_equal(set, true);
    shape_set_destroy(set);
}

/* A stretched frame makes ellipsoids of spheres; the bounds hold them exactly. */
static void test_stretched(void **state)
{
    (void)state;
    shape_set *set = make_ball(1, 0, 0, 0);
    const shape_frame frame = {{{2, 0, 0, 0}, {0, 0.5, 0, 0}, {0.5, 0, -1, 0}}};
    set->clouds[0].frame = frame;
    check_equal(set, true);
    shape_error error;
    shape_volume *volume;
    double min[3], max[3];
    must(shape_volume_create(set, &volume, &error), &error);
    bool any = false;
    must(shape_voxels_bounds(volume, -1, false, min, max, &any, &error), &error);
    assert_true(any);
    const double half[3] = {2, 0.5, sqrt(1.25)};
    for (int k = 0; k < 3; k++) {
        assert_true(fabs(max[k] - half[k]) < 1e-6);
        assert_true(fabs(min[k] + half[k]) < 1e-6);
    }
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* The ramp is min(depth / V, 1) of the deepest sphere, depths in voxels (single precision: 1e-5). */
static void test_ramp(void **state)
{
    (void)state;
    shape_set *set = make_set(SHAPE_MODEL_UNIFORM, 20, 0);
    shape_voxel_request request = shape_voxel_request_defaults();
    request.ramp = 3;
    filled f = fill(set, 50, true, request);
    const shape_primitives *list = &set->lists[0];
    int32_t i[3];
    for (i[0] = -1; i[0] <= f.lattice.size[0]; i[0]++)
        for (i[1] = -1; i[1] <= f.lattice.size[1]; i[1]++)
            for (i[2] = -1; i[2] <= f.lattice.size[2]; i[2]++) {
                shape_dvec3 p =
                    shape_frame_point(&f.volume->clouds[0].inverse, shape_voxel_point(&f.lattice, i));
                double depth = 0;
                for (size_t s = 0; s < list->sphere_count; s++) {
                    const shape_sphere *ball = &list->spheres[s];
                    double x = p.x - (double)ball->x, y = p.y - (double)ball->y, z = p.z - (double)ball->z;
                    depth = fmax(depth, (double)ball->radius - sqrt(x * x + y * y + z * z));
                }
                double expected = fmin(1, depth / f.lattice.edge / 3);
                assert_true(fabs((double)shape_vdb_value(f.grid, i) - expected) < 1e-5);
            }
    drop(&f);
    set->clouds[0].field.model = SHAPE_MODEL_SPHEROID;
    shape_error error;
    shape_volume *volume;
    shape_voxel_lattice lattice = {.edge = 1, .size = {8, 8, 8}};
    shape_voxel_sink sink = {0};
    must(shape_volume_create(set, &volume, &error), &error);
    assert_int_equal(shape_voxels_fill(volume, &lattice, &request, &sink, &error), SHAPE_ERROR_ARGUMENT);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* |p - c| - r within the band, and its ends beyond; of a ball given as an ellipsoid too, where first order is exact. */
static void test_distance(void **state)
{
    (void)state;
    for (int as_ellipsoid = 0; as_ellipsoid < 2; as_ellipsoid++) {
        shape_error error;
        shape_set *set = make_ball(2, 1, 2, 3);
        if (as_ellipsoid) {
            shape_ellipsoid e = {.a = 2, .b = 2, .c = 2, .q = {0, 0, 0, 1}};
            set->lists[0].sphere_count = 0;
            must(shape_primitives_add_ellipsoid(&set->lists[0], e, &error), &error);
        }
        shape_voxel_request request = shape_voxel_request_defaults();
        request.quantity = SHAPE_VOXEL_SDF;
        filled f = fill(set, 40, false, request);
        double band = 3 * f.lattice.edge;
        int32_t i[3];
        for (i[0] = -6; i[0] < 46; i[0]++)
            for (i[1] = -6; i[1] < 46; i[1]++)
                for (i[2] = -6; i[2] < 46; i[2]++) {
                    shape_dvec3 p = shape_voxel_point(&f.lattice, i);
                    double d =
                        sqrt((p.x - 1) * (p.x - 1) + (p.y - 2) * (p.y - 2) + (p.z - 3) * (p.z - 3)) - 2;
                    d = fmax(-band, fmin(band, d));
                    assert_true(fabs((double)shape_vdb_value(f.grid, i) - d) < 1e-5);
                }
        drop(&f);
        shape_set_destroy(set);
    }
}

/* profile is 1 - u; the densities of two clouds in one grid add to the volume's extinction over the greatest. */
static void test_several(void **state)
{
    (void)state;
    shape_error error;
    size_t index;
    shape_set *set = make_ball(2, 0, 0, 0);
    shape_frame beside = shape_frame_identity();
    beside.m[0][3] = 1.5;
    must(shape_set_add_copy(set, 0, &beside, &index, &error), &error);
    set->clouds[0].medium.extinction = 4;
    set->clouds[1].medium.extinction = 1;
    filled f = fill(set, 35, false, shape_voxel_request_defaults());
    shape_voxel_request request = shape_voxel_request_defaults();
    request.quantity = SHAPE_VOXEL_PROFILE;
    filled profile = fill(set, 35, false, request);
    request.quantity = SHAPE_VOXEL_DENSITY_SCALE;
    filled scale = fill(set, 35, false, request);
    int32_t i[3];
    for (i[0] = 0; i[0] < f.lattice.size[0]; i[0]++)
        for (i[1] = 0; i[1] < f.lattice.size[1]; i[1]++)
            for (i[2] = 0; i[2] < f.lattice.size[2]; i[2]++) {
                shape_dvec3 p = shape_voxel_point(&f.lattice, i);
                double extinction = shape_volume_extinction(f.volume, p);
                assert_true(fabs(4 * (double)shape_vdb_value(f.grid, i) - extinction) < 1e-6);
                double a = sqrt(p.x * p.x + p.y * p.y + p.z * p.z) / 2;
                double b = sqrt((p.x - 1.5) * (p.x - 1.5) + p.y * p.y + p.z * p.z) / 2;
                double u = fmin(a, b);
                assert_true(fabs((double)shape_vdb_value(profile.grid, i) - fmax(0, 1 - u)) < 1e-5);
                if (u < 0.999 && fabs(a - b) > 1e-4)
                    assert_true(fabs((double)shape_vdb_value(scale.grid, i) - (a < b ? 1 : 0.25)) < 1e-6);
            }
    drop(&f);
    drop(&profile);
    drop(&scale);
    shape_set_destroy(set);
}

/* The result does not depend on the number of threads, and counting never says less than filling gives. */
static void test_threads_and_count(void **state)
{
    (void)state;
    shape_error error;
    shape_set *set = make_set(SHAPE_MODEL_SPHEROID, 20, 10);
    shape_voxel_request request = shape_voxel_request_defaults();
    unsigned char *bytes[2];
    size_t size[2], bricks;
    for (int i = 0; i < 2; i++) {
        request.threads = i ? 3 : 1;
        filled f = fill(set, 40, true, request);
        must(shape_vdb_encode(f.file, SHAPE_VDB_OPENVDB, &bytes[i], &size[i], &error), &error);
        must(shape_voxels_count(f.volume, &f.lattice, &request, SIZE_MAX, &bricks, &error), &error);
        assert_true(bricks >= f.summary.leaves);
        drop(&f);
    }
    assert_int_equal(size[0], size[1]);
    assert_memory_equal(bytes[0], bytes[1], size[0]);
    free(bytes[0]);
    free(bytes[1]);
    shape_set_destroy(set);
}

/* With so little extinction that nothing scatters, the mean radiance is the sun's irradiance over 4 pi. */
static void test_light(void **state)
{
    (void)state;
    shape_error error;
    shape_set *set = make_ball(2, 0, 0, 0);
    set->clouds[0].medium.extinction = 1e-6f;
    shape_light light = shape_light_defaults();
    light.sky = SHAPE_SKY_NONE;
    light.sun_irradiance[0] = 3;
    shape_volume *volume;
    shape_lightvoxels voxels;
    float value[3];
    must(shape_volume_create(set, &volume, &error), &error);
    must(shape_lightvoxels_build(volume, &light, 8, 1, &voxels, &error), &error);
    shape_lightvoxels_sample(&voxels, 0, shape_vec3_make(0.3f, -0.5f, 0.7f), value);
    assert_true(fabs((double)value[0] - 3 / (4 * pi)) < 1e-4);
    assert_true(fabs((double)value[1] - 0.25) < 1e-4);
    shape_lightvoxels_free(&voxels);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* Finer voxels hold a density better, and a lattice no coarser than a uniform ball holds it badly. */
static void test_error(void **state)
{
    (void)state;
    shape_error error;
    shape_set *set = make_set(SHAPE_MODEL_SPHEROID, 10, 0);
    shape_volume *volume;
    shape_voxel_request request = shape_voxel_request_defaults();
    double coarse, fine;
    must(shape_volume_create(set, &volume, &error), &error);
    must(shape_voxels_error(volume, &request, 2, 1000, 1, &coarse, &error), &error);
    must(shape_voxels_error(volume, &request, 0.02, 1000, 1, &fine, &error), &error);
    assert_true(fine < coarse / 3);
    assert_true(fine > 0);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

static void test_nothing(void **state)
{
    (void)state;
    shape_error error;
    unsigned char *bytes;
    size_t size;
    shape_vdb *file = shape_vdb_create();
    shape_vdb_grid *grid;
    assert_int_equal(shape_vdb_encode(file, SHAPE_VDB_OPENVDB, &bytes, &size, &error), SHAPE_ERROR_ARGUMENT);
    shape_vdb_options options = {.name = "density", .edge = 1};
    must(shape_vdb_add(file, &options, &grid, &error), &error);
    assert_int_equal(shape_vdb_encode(file, SHAPE_VDB_NANOVDB, &bytes, &size, &error), SHAPE_ERROR_ARGUMENT);
    shape_vdb_destroy(file);
    options.edge = 0;
    file = shape_vdb_create();
    assert_int_equal(shape_vdb_add(file, &options, &grid, &error), SHAPE_ERROR_ARGUMENT);
    /* A grid of one tile gets a leaf: Blender draws nothing without. */
    options.edge = 1;
    must(shape_vdb_add(file, &options, &grid, &error), &error);
    const int32_t first[3] = {0, 0, 0};
    assert_true(shape_vdb_put_tile(grid, first, 16, 1));
    shape_vdb_summary summary;
    must(shape_vdb_summarise(grid, &summary, &error), &error);
    assert_int_equal(summary.leaves, 1);
    assert_int_equal(summary.active, 16 * 16 * 16);
    shape_vdb_destroy(file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ball),
        cmocka_unit_test(test_equals_field),
        cmocka_unit_test(test_stretched),
        cmocka_unit_test(test_ramp),
        cmocka_unit_test(test_distance),
        cmocka_unit_test(test_several),
        cmocka_unit_test(test_threads_and_count),
        cmocka_unit_test(test_light),
        cmocka_unit_test(test_error),
        cmocka_unit_test(test_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
