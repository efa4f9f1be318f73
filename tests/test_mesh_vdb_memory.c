/* The bridges to tinygltf, OpenMesh and OpenVDB when memory runs out within them: each allocation fails once, in C and in
 * C++; it is reported as such, and no exception gets out. One processor, so that the n-th
 * allocation is always the same. */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE /* sched_setaffinity */
#endif
#include <sched.h>
#include <stdbool.h>

#include "failing_new.h"
#include "gltf_sample.h"

#include "shape/set.h"
#include "shape/vdb.h"

static int use_one_processor(void **state)
{
    (void)state;
    cpu_set_t own, first;
    if (sched_getaffinity(0, sizeof own, &own))
        return -1;
    int i = 0;
    while (!CPU_ISSET(i, &own))
        i++;
    CPU_ZERO(&first);
    CPU_SET(i, &first);
    return sched_setaffinity(0, sizeof first, &first);
}

/* OpenMesh and OpenVDB leave things behind where their own allocations fail; that is not looked at. */
int __lsan_is_turned_off(void);
int __lsan_is_turned_off(void)
{
    return 1;
}

/* Once as it is, since libraries keep what they set up; then with each allocation failing. */
static void fail_each_after_one(work run, long at_least)
{
    shape_error error = {.text = ""};
    if (run(&error))
        fail_msg("%s", error.text);
    for (long n = 0;; n++) {
        allocations_left = n;
        shape_status status = run(&error);
        bool used_up = allocations_left < 0;
        allocations_left = -1;
        if (!used_up) {
            assert_int_equal(status, SHAPE_OK);
            assert_true(n >= at_least);
            return;
        }
        /* Some of the standard library throws an error of another kind, whose text says so. */
        bool said = status == SHAPE_ERROR_SYSTEM && strstr(error.text, "alloc");
        if (status != SHAPE_ERROR_MEMORY && !said)
            fail_msg("allocation %ld failed: status %d, \"%s\"", n, (int)status, error.text);
    }
}

static shape_status read_gltf(shape_error *error)
{
    shape_mesh *mesh;
    shape_status status =
        decode(square, sizeof square, PLAIN("{\"attributes\":{\"POSITION\":0},\"mode\":5}"), &mesh, error);
    if (!status)
        shape_mesh_destroy(mesh);
    return status;
}

/* The last ones are those of our own reader. (Earlier ones are tinygltf's 2.7, of which some end the program: it unwinds
 * through destructors that may not throw.) */
static void test_gltf(void **state)
{
    enum { OURS = 12 };
    (void)state;
    shape_error error = {.text = ""};
    const long plenty = 1000000;
    assert_int_equal(read_gltf(&error), SHAPE_OK);
    allocations_left = plenty;
    assert_int_equal(read_gltf(&error), SHAPE_OK);
    long all = plenty - allocations_left;
    assert_true(all > OURS);
    for (long n = all - OURS; n < all; n++) {
        long before = live;
        allocations_left = n;
        assert_int_equal(read_gltf(&error), SHAPE_ERROR_MEMORY);
        assert_int_equal(live, before);
    }
    allocations_left = -1;
}

/* A disc of eight triangles about its middle. */
static shape_mesh *make_fan(shape_error *error)
{
    enum { SIDES = 8 };
    shape_mesh *mesh = shape_mesh_create(SIDES + 1, SIDES, error);
    if (!mesh)
        return NULL;
    mesh->point_count = SIDES + 1;
    mesh->triangle_count = SIDES;
    mesh->points[0] = shape_dvec3_make(0, 0, 0);
    for (uint32_t i = 0; i < SIDES; i++) {
        mesh->indices[3 * i] = 0;
        mesh->points[i + 1] = shape_dvec3_make(cos(i * 6.2831853 / SIDES), sin(i * 6.2831853 / SIDES), 0);
        mesh->indices[3 * i + 1] = i + 1;
        mesh->indices[3 * i + 2] = (i + 1) % SIDES + 1;
    }
    return mesh;
}

static shape_status decimate(shape_error *error)
{
    shape_mesh *mesh = make_fan(error);
    if (!mesh)
        return SHAPE_ERROR_MEMORY;
    shape_status status = shape_mesh_decimate(mesh, 5, error);
    if (!status)
        assert_true(mesh->triangle_count <= 5);
    shape_mesh_destroy(mesh);
    return status;
}

static void test_openmesh(void **state)
{
    (void)state;
    shape_error error;
    shape_mesh *mesh = make_fan(&error);
    assert_int_equal(shape_mesh_decimate(mesh, 0, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "0 faces"));
    assert_int_equal(shape_mesh_decimate(mesh, mesh->triangle_count, &error), SHAPE_OK);
    assert_int_equal(mesh->triangle_count, 8); /* as many as it has: nothing to do */
    shape_mesh_destroy(mesh);
    fail_each_after_one(decimate, 10);
}

/* --- OpenVDB --- */

static bool as_vectors;

static shape_status fill_grid(shape_vdb *vdb, shape_vdb_grid *grid, shape_error *error)
{
    static float values[3 * 512];
    const int32_t first[3] = {8, -16, 0}, second[3] = {0, 0, 0}, third[3] = {128, 0, 0};
    shape_vdb_summary summary;
    for (int i = 0; i < 3 * 512; i++)
        values[i] = i % 7 ? 0.25f * (float)(i % 5) : 0;
    if (!shape_vdb_put_brick(grid, first, values) || !shape_vdb_put_tile(grid, second, 8, 0.5f) ||
        !shape_vdb_put_tile(grid, third, 128, 0.25f))
        return shape_error_memory(error);
    shape_status status = shape_vdb_note(vdb, grid, "made_by", "a test", error);
    if (!status)
        status = shape_vdb_note(vdb, NULL, "made_by", "a test", error);
    if (!status)
        status = shape_vdb_note_number(vdb, grid, "most", 1, error);
    if (!status)
        status = shape_vdb_note_number(vdb, NULL, "most", 1, error);
    if (!status)
        status = shape_vdb_summarise(grid, &summary, error);
    if (!status)
        assert_int_equal(summary.min[1], -16);
    return status;
}

static shape_status write_vdb(shape_error *error)
{
    shape_vdb_grid *grid;
    unsigned char *bytes;
    size_t size;
    const shape_vdb_options options = {.name = "density", .edge = 0.5, .vector = as_vectors};
    shape_vdb *vdb = shape_vdb_create();
    if (!vdb)
        return shape_error_memory(error);
    shape_status status = shape_vdb_add(vdb, &options, &grid, error);
    if (!status)
        status = fill_grid(vdb, grid, error);
    if (!status)
        status = shape_vdb_encode(vdb, SHAPE_VDB_OPENVDB, &bytes, &size, error);
    if (!status)
        free(bytes);
    /* OpenVDB's tree takes memory to give its own back; without, it ends the program. */
    long left = allocations_left;
    allocations_left = -1;
    shape_vdb_destroy(vdb);
    allocations_left = left;
    return status;
}

static void test_openvdb(void **state)
{
    (void)state;
    fail_each_after_one(write_vdb, 20);
    as_vectors = true;
    fail_each_after_one(write_vdb, 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_gltf), cmocka_unit_test(test_openmesh),
                                       cmocka_unit_test(test_openvdb)};
    return cmocka_run_group_tests(tests, use_one_processor, NULL);
}
