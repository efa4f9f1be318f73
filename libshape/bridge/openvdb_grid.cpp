// A grid of an OpenVDB file as bricks: choosing it, level sets to fog, the transform.
#include "bridge/openvdb_grid.hpp"

#include "bridge/openvdb_colour.hpp"

#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetUtil.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <string>

namespace
{

std::string list_names(const openvdb::GridPtrVec &grids, bool scalar)
{
    std::string names;
    for (const openvdb::GridBase::Ptr &grid : grids)
        if (!scalar || vdb_has_channel(*grid))
            names += (names.empty() ? "" : ", ") + grid->getName() +
                     (scalar ? "" : " (" + grid->valueType() + ")");
    return names.size() > 300 ? names.substr(0, 300) + " ..." : names;
}

// The grid that is asked for, or the only scalar one that holds no colour; null with *error set where there is none.
openvdb::GridBase::Ptr choose(const openvdb::GridPtrVec &grids, const char *wanted,
                              const std::vector<std::string> &colours, shape_error *error)
{
    openvdb::GridBase::Ptr chosen;
    size_t scalar = 0;
    for (const openvdb::GridBase::Ptr &grid : grids) {
        bool colour = std::find(colours.begin(), colours.end(), grid->getName()) != colours.end();
        if (!vdb_has_channel(*grid) || (wanted ? grid->getName() != wanted : colour))
            continue;
        scalar++;
        if (!chosen)
            chosen = grid;
    }
    if (grids.empty())
        shape_error_set(error, SHAPE_ERROR_FORMAT, "holds no grid at all (damaged, or of another version)");
    else if (!chosen && wanted)
        shape_error_set(error, SHAPE_ERROR_FORMAT, "has no scalar grid called \"%s\" (it has %s)", wanted,
                        list_names(grids, false).c_str());
    else if (!chosen)
        shape_error_set(error, SHAPE_ERROR_FORMAT, "has no scalar grid (it has %s)",
                        list_names(grids, false).c_str());
    else if (!wanted && scalar > 1) {
        shape_error_set(error, SHAPE_ERROR_FORMAT, "has %zu scalar grids: %s (choose one with --grid NAME)",
                        scalar, list_names(grids, true).c_str());
        chosen.reset();
    }
    return chosen;
}

// Whether the file has the grids of the colour, of types that hold one.
bool check_colour(const openvdb::GridPtrVec &grids, const std::vector<std::string> &names, shape_error *error)
{
    if (names.size() > 1 && names.size() != 3)
        return shape_error_set(error, SHAPE_ERROR_FORMAT,
                               "%zu colour grids (name one of vectors, or three of numbers)", names.size()),
               false;
    for (const std::string &name : names) {
        auto found = std::find_if(grids.begin(), grids.end(),
                                  [&](const auto &grid) { return grid->getName() == name; });
        if (found == grids.end() ||
            !(names.size() == 1 ? vdb_has_colours(**found) : vdb_has_channel(**found)))
            return shape_error_set(error, SHAPE_ERROR_FORMAT,
                                   "has no grid of %s called \"%.64s\" for the colour (it has %s)",
                                   names.size() == 1 ? "vectors" : "numbers", name.c_str(),
                                   list_names(grids, false).c_str()),
                   false;
    }
    return true;
}

openvdb::FloatGrid::Ptr to_float(const openvdb::GridBase::Ptr &grid)
{
    if (grid->isType<openvdb::FloatGrid>())
        return openvdb::gridPtrCast<openvdb::FloatGrid>(grid);
    openvdb::DoubleGrid::Ptr wide = openvdb::gridPtrCast<openvdb::DoubleGrid>(grid);
    openvdb::FloatGrid::Ptr made =
        openvdb::FloatGrid::create(openvdb::FloatTree::Ptr(new openvdb::FloatTree(wide->tree())));
    made->setTransform(wide->transformPtr());
    made->setGridClass(wide->getGridClass());
    return made;
}

// Our voxels, counted from `origin`, to metres; false where the transform is not affine and invertible.
bool find_frame(const openvdb::math::Transform &transform, const openvdb::Coord &origin, bool y_up,
                shape_frame &frame)
{
    if (!transform.isLinear())
        return false;
    openvdb::math::Mat4d m = transform.baseMap()->getAffineMap()->getMat4(); // of row vectors
    double rows[3][4];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            rows[i][j] = m(j, i);
        rows[i][3] = m(3, i) + m(0, i) * origin.x() + m(1, i) * origin.y() + m(2, i) * origin.z();
    }
    for (int j = 0; j < 4; j++) {
        frame.m[0][j] = rows[0][j];
        frame.m[1][j] = y_up ? rows[1][j] : rows[2][j];
        frame.m[2][j] = y_up ? rows[2][j] : -rows[1][j];
    }
    shape_frame inverse;
    for (int i = 0; i < 12; i++)
        if (!std::isfinite(frame.m[i / 4][i % 4]))
            return false;
    return shape_frame_invert(&frame, &inverse);
}

struct Source {
    openvdb::FloatGrid::ConstAccessor values;
    openvdb::Coord origin;
};

using Leaf = openvdb::FloatTree::LeafNodeType;

// The points of a brick that lie in one leaf or tile: from low to high, both among them.
struct Part {
    openvdb::Coord low, high;
};

// Active values of a leaf; a word of its mask is one x, with eight bits for each y.
void copy_leaf(const Leaf &leaf, const Part &part, const openvdb::Coord &first, float *values)
{
    const float *from = leaf.buffer().data();
    for (int x = part.low.x(); x <= part.high.x(); x++) {
        uint64_t active = leaf.valueMask().getWord<uint64_t>(openvdb::Index(x & 7));
        for (int y = part.low.y(); y <= part.high.y(); y++) {
            unsigned row = unsigned(active >> ((y & 7) * 8)) & 0xff;
            const float *at = from + ((x & 7) << 6 | (y & 7) << 3);
            float *to = values + (y - first.y()) * SHAPE_GRID_SIDE + (x - first.x());
            for (int z = part.low.z(); row && z <= part.high.z(); z++)
                if (row >> (z & 7) & 1)
                    to[(z - first.z()) * SHAPE_GRID_SIDE * SHAPE_GRID_SIDE] = at[z & 7];
        }
    }
}

void fill_part(const Part &part, const openvdb::Coord &first, float value, float *values)
{
    for (int z = part.low.z(); z <= part.high.z(); z++)
        for (int y = part.low.y(); y <= part.high.y(); y++)
            for (int x = part.low.x(); x <= part.high.x(); x++)
                values[((z - first.z()) * SHAPE_GRID_SIDE + (y - first.y())) * SHAPE_GRID_SIDE +
                       (x - first.x())] = value;
}

// What one leaf or tile has of a brick. values may be null. False where that is nothing.
bool take_part(Source &source, const Part &part, const openvdb::Coord &first, float *values)
{
    float value = 0;
    const Leaf *leaf = source.values.probeConstLeaf(part.low);
    if (leaf) {
        if (leaf->isEmpty())
            return false;
        if (values)
            copy_leaf(*leaf, part, first, values);
        return true;
    }
    if (!source.values.probeValue(part.low, value))
        return false;
    if (values)
        fill_part(part, first, value, values);
    return true;
}

// Leaf by leaf: a brick has points of at most two along each axis.
bool fill_brick(void *context, const int low[3], float *values)
{
    Source &source = *static_cast<Source *>(context);
    openvdb::Coord first = source.origin.offsetBy(low[0], low[1], low[2]),
                   last = first.offsetBy(SHAPE_GRID_BRICK), middle = last & ~7;
    bool any = false;
    if (values)
        std::fill_n(values, int(SHAPE_GRID_BRICK_POINTS), 0.0f);
    for (int corner = 0; corner < 8; corner++) {
        Part part = {first, last};
        for (int a = 0; a < 3; a++) {
            if (corner >> a & 1)
                part.low[a] = middle[a];
            else
                part.high[a] = middle[a] - 1;
        }
        any = take_part(source, part, first, values) || any;
    }
    return any;
}

shape_status convert(const openvdb::FloatGrid &grid, const shape_vdb_read_options &options,
                     shape_vdb_contents &contents, openvdb::Coord &origin, shape_error *error)
{
    openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
    if (box.empty())
        return shape_error_set(error, SHAPE_ERROR_FORMAT, "the grid \"%s\" is empty: no active voxel",
                               contents.name);
    const int far = 1 << 29; // sums and differences of coordinates stay in range
    for (int a = 0; a < 3; a++)
        if (box.min()[a] < -far || box.max()[a] > far ||
            box.max()[a] - box.min()[a] + 3 > SHAPE_GRID_MAX_SIDE)
            return shape_error_set(error, SHAPE_ERROR_LIMIT,
                                   "the grid \"%s\" reaches from voxel %d to %d, more than the %d that fit",
                                   contents.name, box.min()[a], box.max()[a], SHAPE_GRID_MAX_SIDE - 2);
    origin = box.min().offsetBy(-1);
    Source source{grid.getConstAccessor(), origin};
    if (!find_frame(grid.transform(), source.origin, options.y_up, contents.frame))
        return shape_error_set(error, SHAPE_ERROR_FORMAT,
                               "the transform of the grid \"%s\" is not affine, or has no inverse",
                               contents.name);
    shape_grid_source bricks = {{0, 0, 0}, fill_brick, &source};
    for (int a = 0; a < 3; a++)
        bricks.points[a] = box.max()[a] - box.min()[a] + 3; // one of 0 on each side
    return shape_grid_create(&bricks, options.max_bytes, &contents.grid, error);
}

void copy_name(const std::string &from, char to[SHAPE_NAME_MAX + 1])
{
    size_t length = 0;
    for (char c : from)
        if (length < SHAPE_NAME_MAX && static_cast<unsigned char>(c) >= 0x20 &&
            static_cast<unsigned char>(c) < 0x7f)
            to[length++] = c;
    to[length] = 0;
}

} // namespace

shape_status vdb_load(const char *path, const shape_vdb_read_options &options, shape_vdb_contents &contents,
                      shape_error *error)
{
    openvdb::initialize();
    openvdb::io::File file(path);
    file.open(false); // no delayed loading: what is wrong shows here
    openvdb::GridPtrVecPtr grids = file.readAllGridMetadata();
    std::vector<std::string> colours = vdb_colour_names(options);
    if (!grids->empty() && !check_colour(*grids, colours, error))
        return SHAPE_ERROR_FORMAT;
    openvdb::GridBase::Ptr chosen = choose(*grids, options.grid, colours, error);
    if (!chosen)
        return SHAPE_ERROR_FORMAT;
    copy_name(chosen->getName(), contents.name);
    openvdb::FloatGrid::Ptr grid = to_float(file.readGrid(chosen->getName()));
    std::vector<openvdb::GridBase::Ptr> colour;
    colour.reserve(colours.size());
    for (const std::string &name : colours)
        colour.push_back(file.readGrid(name));
    file.close();
    contents.level_set = grid->getGridClass() == openvdb::GRID_LEVEL_SET;
    if (contents.level_set)
        openvdb::tools::sdfToFogVolume(*grid);
    openvdb::Coord origin;
    shape_status status = convert(*grid, options, contents, origin, error);
    size_t taken = status ? 0 : shape_grid_bytes(contents.grid);
    if (status || colour.empty())
        return status;
    return vdb_add_colour(colour, grid->transform(), origin,
                          taken < options.max_bytes ? options.max_bytes - taken : 0, contents.grid, error);
}
