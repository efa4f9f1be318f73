// The colour of a volume: one grid of three channels (Houdini's and Blender's "Cd", "color"), or three grids of one, looked
// at where the density has its voxels.
//
// Voxels that hold no colour (inactive ones) count as if they were not there: trilinear between those that do, else the
// mean of the nearest, so that the rim of a cloud, where density falls to 0 within a voxel, does not turn black with it. Far
// from all colour the background counts, which is black in most files.
#include "bridge/openvdb_colour.hpp"

#include <cmath>
#include <memory>

namespace
{

using openvdb::Coord;
using openvdb::Vec3d;

// A channel of some grid, whatever its type.
class Channel
{
  public:
    virtual ~Channel() = default;
    virtual bool look(const Coord &at, double &value) const = 0; // whether the voxel is active
    virtual double background() const = 0;
};

double pick(float value, int)
{
    return double(value);
}
double pick(double value, int)
{
    return value;
}
template <class V> double pick(const openvdb::math::Vec3<V> &value, int channel)
{
    return double(value[channel]);
}

template <class Grid> class ChannelOf : public Channel
{
  public:
    ChannelOf(const openvdb::GridBase::Ptr &grid, int channel)
        : grid_(openvdb::gridPtrCast<Grid>(grid)), values_(grid_->getConstAccessor()), channel_(channel)
    {
    }
    bool look(const Coord &at, double &value) const override
    {
        typename Grid::ValueType found;
        bool active = values_.probeValue(at, found);
        value = pick(found, channel_);
        return active;
    }
    double background() const override { return pick(grid_->background(), channel_); }

  private:
    typename Grid::Ptr grid_;
    typename Grid::ConstAccessor values_;
    int channel_;
};

std::unique_ptr<Channel> make_channel(const openvdb::GridBase::Ptr &grid, int channel)
{
    if (grid->isType<openvdb::Vec3SGrid>())
        return std::make_unique<ChannelOf<openvdb::Vec3SGrid>>(grid, channel);
    if (grid->isType<openvdb::Vec3DGrid>())
        return std::make_unique<ChannelOf<openvdb::Vec3DGrid>>(grid, channel);
    if (grid->isType<openvdb::DoubleGrid>())
        return std::make_unique<ChannelOf<openvdb::DoubleGrid>>(grid, 0);
    return std::make_unique<ChannelOf<openvdb::FloatGrid>>(grid, 0);
}

struct Source {
    const shape_grid *density;
    const openvdb::math::Transform *from, *to; // of the density and of the colour
    bool same;
    Coord origin;
    std::unique_ptr<Channel> channel;
    bool any = false, finite = true;
};

// The mean of the active voxels next to one; the background where there are none.
double around(const Channel &channel, const Coord &at)
{
    double sum = 0, value;
    int count = 0;
    for (int k = 0; k < 27; k++)
        if (channel.look(at.offsetBy(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1), value)) {
            sum += value;
            count++;
        }
    return count ? sum / count : channel.background();
}

// At a place between voxels.
double between(const Channel &channel, const Vec3d &p)
{
    const double far = 1 << 29;
    for (int a = 0; a < 3; a++)
        if (!(std::fabs(p[a]) < far))
            return channel.background();
    Coord low = Coord::floor(p);
    double sum = 0, weights = 0, value;
    for (int corner = 0; corner < 8; corner++) {
        double weight = 1;
        for (int a = 0; a < 3; a++) {
            double share = p[a] - low[a];
            weight *= corner >> a & 1 ? share : 1 - share;
        }
        if (weight > 0 && channel.look(low.offsetBy(corner & 1, corner >> 1 & 1, corner >> 2), value)) {
            sum += weight * value;
            weights += weight;
        }
    }
    return weights > 0 ? sum / weights : around(channel, Coord::round(p));
}

float look(const Source &source, const Coord &at)
{
    double value;
    if (!source.same)
        value = between(*source.channel, source.to->worldToIndex(source.from->indexToWorld(at)));
    else if (!source.channel->look(at, value))
        value = around(*source.channel, at);
    return float(value);
}

// Only where there is density.
bool fill_brick(void *context, const int low[3], float *values)
{
    Source &source = *static_cast<Source *>(context);
    const shape_grid &g = *source.density;
    size_t brick =
        (size_t(low[2] / SHAPE_GRID_BRICK) * size_t(g.bricks[1]) + size_t(low[1] / SHAPE_GRID_BRICK)) *
            size_t(g.bricks[0]) +
        size_t(low[0] / SHAPE_GRID_BRICK);
    if (!g.table[brick])
        return false;
    for (int z = 0; z < SHAPE_GRID_SIDE && values; z++)
        for (int y = 0; y < SHAPE_GRID_SIDE; y++)
            for (int x = 0; x < SHAPE_GRID_SIDE; x++) {
                bool beyond =
                    low[0] + x >= g.points[0] || low[1] + y >= g.points[1] || low[2] + z >= g.points[2];
                float value =
                    beyond ? 0 : look(source, source.origin.offsetBy(low[0] + x, low[1] + y, low[2] + z));
                source.any = source.any || value > 0;
                source.finite = source.finite && std::isfinite(value);
                *values++ = value;
            }
    return true;
}

} // namespace

std::vector<std::string> vdb_colour_names(const shape_vdb_read_options &options)
{
    std::vector<std::string> names;
    if (!options.colour)
        return names;
    std::string all = options.colour;
    size_t from = 0, comma;
    for (; (comma = all.find(',', from)) != std::string::npos; from = comma + 1)
        names.push_back(all.substr(from, comma - from));
    names.push_back(all.substr(from));
    return names;
}

bool vdb_has_colours(const openvdb::GridBase &grid)
{
    return grid.isType<openvdb::Vec3SGrid>() || grid.isType<openvdb::Vec3DGrid>();
}

bool vdb_has_channel(const openvdb::GridBase &grid)
{
    return grid.isType<openvdb::FloatGrid>() || grid.isType<openvdb::DoubleGrid>();
}

shape_status vdb_add_colour(const std::vector<openvdb::GridBase::Ptr> &grids,
                            const openvdb::math::Transform &transform, const Coord &origin, size_t max_bytes,
                            shape_grid *density, shape_error *error)
{
    density->coloured = true;
    for (int c = 0; c < 3; c++) {
        const openvdb::GridBase::Ptr &grid = grids[grids.size() == 3 ? size_t(c) : 0];
        const openvdb::math::Transform &own = grid->transform();
        Source source{density, &transform, &own, own == transform, origin, make_channel(grid, c)};
        shape_grid_source bricks = {
            {density->points[0], density->points[1], density->points[2]}, fill_brick, &source};
        shape_error own_error;
        shape_status status = shape_grid_create(&bricks, max_bytes, &density->colour[c], &own_error);
        if (status == SHAPE_ERROR_FORMAT && source.finite && !source.any) {
            density->colour[c] = nullptr; // a channel of nothing but 0 is none
            continue;
        }
        if (status)
            return shape_error_set(error, status, "the colour \"%.64s\": %s", grid->getName().c_str(),
                                   own_error.text);
        size_t taken = shape_grid_bytes(density->colour[c]);
        max_bytes = taken < max_bytes ? max_bytes - taken : 0;
    }
    return SHAPE_OK;
}
