/* Triangle meshes: storage, box, placement. */
#include "shape/mesh.h"

#include <stdlib.h>

shape_mesh *shape_mesh_create(size_t points, size_t triangles, shape_error *error)
{
    shape_mesh *mesh = calloc(1, sizeof *mesh);
    if (!mesh || points > SIZE_MAX / sizeof *mesh->points ||
        triangles > SIZE_MAX / sizeof *mesh->indices / 3) {
        free(mesh);
        shape_error_memory(error);
        return NULL;
    }
    mesh->points = malloc((points ? points : 1) * sizeof *mesh->points);
    mesh->indices = malloc((triangles ? triangles : 1) * 3 * sizeof *mesh->indices);
    if (!mesh->points || !mesh->indices) {
        shape_mesh_destroy(mesh);
        shape_error_memory(error);
        return NULL;
    }
    return mesh;
}

void shape_mesh_destroy(shape_mesh *mesh)
{
    if (!mesh)
        return;
    free(mesh->points);
    free(mesh->indices);
    free(mesh);
}

bool shape_mesh_bounds(const shape_mesh *mesh, shape_dvec3 *min, shape_dvec3 *max)
{
    if (!mesh->point_count)
        return false;
    *min = *max = mesh->points[0];
    for (size_t i = 1; i < mesh->point_count; i++) {
        shape_dvec3 p = mesh->points[i];
        *min = shape_dvec3_make(fmin(min->x, p.x), fmin(min->y, p.y), fmin(min->z, p.z));
        *max = shape_dvec3_make(fmax(max->x, p.x), fmax(max->y, p.y), fmax(max->z, p.z));
    }
    return true;
}

void shape_mesh_transform(shape_mesh *mesh, const shape_frame *frame)
{
    for (size_t i = 0; i < mesh->point_count; i++)
        mesh->points[i] = shape_frame_point(frame, mesh->points[i]);
    if (shape_frame_determinant(frame) >= 0)
        return;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        uint32_t *corner = &mesh->indices[3 * t], swapped = corner[1];
        corner[1] = corner[2];
        corner[2] = swapped;
    }
}
