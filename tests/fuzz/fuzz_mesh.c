/* Any bytes as a mesh: OBJ, PLY, STL, OFF in the core, glTF and GLB through tinygltf. The first byte says which, as the
 * suffix of a file's name would. What is read must hold together: corners that are points, finite coordinates; and the
 * repair must keep that. A .gltf finds no other files. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "shape/mesh.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void must(int truth)
{
    if (!truth)
        abort();
}

static void check(const shape_mesh *mesh)
{
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++)
        must(mesh->indices[i] < mesh->point_count);
    for (size_t i = 0; i < mesh->point_count; i++) {
        shape_dvec3 p = mesh->points[i];
        must(fabs(p.x) <= SHAPE_MESH_MAX_COORDINATE && fabs(p.y) <= SHAPE_MESH_MAX_COORDINATE &&
             fabs(p.z) <= SHAPE_MESH_MAX_COORDINATE);
    }
}

static shape_status decode(shape_mesh_format format, const void *bytes, size_t size, shape_mesh **mesh,
                           shape_error *error)
{
    if (format == SHAPE_MESH_GLTF || format == SHAPE_MESH_GLB)
        return shape_gltf_decode("fuzz", "/nowhere", bytes, size, mesh, error);
    return shape_mesh_decode(format, "fuzz", bytes, size, mesh, error);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    shape_error error = {0};
    shape_mesh *mesh = NULL;
    if (!size)
        return 0;
    shape_mesh_format format = (shape_mesh_format)(SHAPE_MESH_OBJ + data[0] % 6);
    uint8_t *text = malloc(size); /* a zero stands behind, as shape_file_read leaves it */
    must(text != NULL);
    memcpy(text, data + 1, size - 1);
    text[size - 1] = 0;
    (void)shape_mesh_format_guess("fuzz", text, size - 1);
    if (decode(format, text, size - 1, &mesh, &error)) {
        must(error.text[0] && !strchr(error.text, '\n'));
    } else {
        check(mesh);
        if (!shape_mesh_repair(mesh, &error)) {
            size_t open;
            check(mesh);
            must(!shape_mesh_open_edges(mesh, &open, &error));
        }
        shape_mesh_destroy(mesh);
    }
    free(text);
    return 0;
}
