/* The module that late_openvdb.cpp loads: OpenVDB's functions behind the two names that it exports. */
#include "shape/mesh.h"
#include "shape/vdb_read.h"

shape_status nephele_vdb_read(const char *path, const shape_vdb_read_options *options,
                              shape_vdb_contents *contents, shape_error *error);
shape_status nephele_mesh_fill(const shape_mesh *mesh, size_t count, int resolution, shape_primitives *list,
                               size_t *made, shape_error *error);

shape_status nephele_vdb_read(const char *path, const shape_vdb_read_options *options,
                              shape_vdb_contents *contents, shape_error *error)
{
    return shape_vdb_read(path, options, contents, error);
}

shape_status nephele_mesh_fill(const shape_mesh *mesh, size_t count, int resolution, shape_primitives *list,
                               size_t *made, shape_error *error)
{
    return shape_mesh_fill(mesh, count, resolution, list, made, error);
}
