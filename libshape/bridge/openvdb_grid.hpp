// Private: one scalar grid of a file, read by OpenVDB in this process.
#ifndef SHAPE_BRIDGE_OPENVDB_GRID_HPP
#define SHAPE_BRIDGE_OPENVDB_GRID_HPP

#include "shape/vdb_read.h"

// May do anything on a damaged file: it is called in a process of its own.
shape_status vdb_load(const char *path, const shape_vdb_read_options &options, shape_vdb_contents &contents,
                      shape_error *error);

#endif
