// Private: the colour of a volume, from other grids of its file.
#ifndef SHAPE_BRIDGE_OPENVDB_COLOUR_HPP
#define SHAPE_BRIDGE_OPENVDB_COLOUR_HPP

#include "shape/vdb_read.h"

#include <openvdb/openvdb.h>

#include <string>
#include <vector>

// The one or three names of options.colour; none where it is NULL.
std::vector<std::string> vdb_colour_names(const shape_vdb_read_options &options);
// Whether a colour may come from the grid, or from three like it.
bool vdb_has_colours(const openvdb::GridBase &grid);
bool vdb_has_channel(const openvdb::GridBase &grid);

// Gives density the colour of one grid of vectors or three of numbers, looked at where density has its voxels: point 0 of
// it is the voxel `origin` of that transform. max_bytes: for the colour alone.
shape_status vdb_add_colour(const std::vector<openvdb::GridBase::Ptr> &grids,
                            const openvdb::math::Transform &transform, const openvdb::Coord &origin,
                            size_t max_bytes, shape_grid *density, shape_error *error);

#endif
