/* The module that openvdb_late.c loads: OpenVDB's reader behind the one name that it exports. */
#include "shape/vdb_read.h"

shape_status nephele_vdb_read(const char *path, const shape_vdb_read_options *options,
                              shape_vdb_contents *contents, shape_error *error);

shape_status nephele_vdb_read(const char *path, const shape_vdb_read_options *options,
                              shape_vdb_contents *contents, shape_error *error)
{
    return shape_vdb_read(path, options, contents, error);
}
