/* Reading when memory runs out: each allocation of decoding a .neph, a raw volume and a mesh, and of making them ready to
 * be looked at, fails once; it is reported as such, and nothing is left behind. */
#include "failing_memory.h"

#include "shape/gaussian.h"
#include "shape/grid.h"
#include "shape/layer.h"
#include "shape/mesh.h"
#include "shape/neph.h"
#include "shape/volume.h"

static unsigned char *neph;
static size_t neph_size;

static shape_status make_neph(shape_error *error)
{
    shape_gaussian gaussian = shape_gaussian_defaults();
    shape_layer_options layer = shape_layer_options_defaults();
    shape_set *set = shape_set_create(error);
    shape_status status = set ? shape_set_add_cloud(set, "a", NULL, error) : SHAPE_ERROR_MEMORY;
    if (!status)
        status = shape_gaussian_make(&gaussian, 1, shape_set_list(set, 0), NULL, error);
    if (!status)
        status = shape_set_add_cloud(set, "b", NULL, error);
    if (!status)
        status = shape_layer_make(&layer, &set->clouds[1], shape_set_list(set, 1), error);
    if (!status)
        status = shape_neph_encode(set, &neph, &neph_size, error);
    shape_set_destroy(set);
    return status;
}

static shape_status make_and_drop(shape_error *error)
{
    shape_status status = make_neph(error);
    if (!status)
        free(neph);
    return status;
}

static shape_status read_and_look(shape_error *error)
{
    shape_set *set;
    shape_volume *volume;
    shape_status status = shape_neph_decode(neph, neph_size, &set, error);
    if (status)
        return status;
    status = shape_volume_create(set, &volume, error);
    if (!status)
        shape_volume_destroy(volume);
    shape_set_destroy(set);
    return status;
}

static void neph_files(void **state)
{
    (void)state;
    shape_error error;
    fail_each(make_and_drop, 5, 0); /* the set, two clouds, a list, primitives, the bytes */
    assert_int_equal(make_neph(&error), SHAPE_OK);
    fail_each(read_and_look, 5, 0);
    free(neph);
}

static shape_status read_raw(shape_error *error)
{
    unsigned char bytes[12 + 4 * 60] = {3, 0, 0, 0, 4, 0, 0, 0, 5, 0, 0, 0};
    for (int i = 0; i < 60; i++)
        bytes[12 + 4 * i + 3] = 0x3f; /* 0.5 */
    shape_grid *grid;
    size_t index;
    const shape_frame frame = shape_frame_identity();
    shape_set *set = shape_set_create(error);
    shape_status status = set ? SHAPE_OK : SHAPE_ERROR_MEMORY;
    if (!status)
        status = shape_volume_raw_decode("a.raw", bytes, sizeof bytes, 1 << 20, &grid, error);
    if (!status)
        status = shape_set_add_grid(set, "a", grid, &frame, &index, error);
    shape_volume *volume;
    if (!status)
        status = shape_volume_create(set, &volume, error);
    if (!status)
        shape_volume_destroy(volume);
    shape_set_destroy(set);
    return status;
}

static void raw_volumes(void **state)
{
    (void)state;
    fail_each(read_raw, 6, 1);
}

static const char *mesh_text;
static shape_mesh_format mesh_format;

static shape_status read_mesh(shape_error *error)
{
    shape_mesh *mesh;
    size_t open;
    shape_status status = shape_mesh_decode(mesh_format, "a", mesh_text, strlen(mesh_text), &mesh, error);
    if (status)
        return status;
    status = shape_mesh_repair(mesh, error);
    if (!status)
        status = shape_mesh_open_edges(mesh, &open, error);
    shape_mesh_destroy(mesh);
    return status;
}

static void meshes(void **state)
{
    (void)state;
    static const char *const texts[] = {
        [SHAPE_MESH_OBJ] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nf 1 2 3 4\nf 1 2 5\n",
        [SHAPE_MESH_PLY] = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                           "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                           "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        [SHAPE_MESH_STL] =
            "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
            "endloop\nendfacet\nendsolid a\n",
        [SHAPE_MESH_OFF] = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"};
    for (int f = SHAPE_MESH_OBJ; f <= SHAPE_MESH_OFF; f++) {
        mesh_format = (shape_mesh_format)f;
        mesh_text = texts[f];
        fail_each(read_mesh, 5, 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(neph_files), cmocka_unit_test(raw_volumes),
                                       cmocka_unit_test(meshes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
