// The bridge to OpenVDB, writing: grids are assembled from leaves that other threads have filled, and written as a file in
// memory (Museth 2013; openvdb/io/Archive.h).
#include "openvdb_private.hpp"
#include "orderly_end.hpp"

#include <openvdb/io/Archive.h>
#include <openvdb/tools/Count.h>

#include <cmath>
#include <cstring>
#include <ostream>

unsigned char *Bytes::take(size_t &size)
{
    unsigned char *taken = data_;
    size = size_;
    data_ = nullptr;
    size_ = room_ = at_ = 0;
    return taken;
}

std::streamsize Bytes::xsputn(const char *from, std::streamsize count)
{
    size_t end = at_ + size_t(count);
    if (end > room_) {
        size_t room = std::max(end, room_ + room_ / 2 + 4096);
        void *grown = realloc(data_, room);
        if (!grown)
            throw std::bad_alloc();
        data_ = static_cast<unsigned char *>(grown);
        room_ = room;
    }
    if (at_ > size_) // what was skipped
        std::memset(data_ + size_, 0, at_ - size_);
    std::memcpy(data_ + at_, from, size_t(count));
    at_ = end;
    size_ = std::max(size_, at_);
    return count;
}

Bytes::int_type Bytes::overflow(int_type c)
{
    char one = traits_type::to_char_type(c);
    xsputn(&one, 1);
    return c;
}

Bytes::pos_type Bytes::seekoff(off_type by, std::ios_base::seekdir from, std::ios_base::openmode)
{
    off_type base = from == std::ios_base::beg   ? 0
                    : from == std::ios_base::cur ? off_type(at_)
                                                 : off_type(size_);
    if (base + by < 0)
        return pos_type(off_type(-1));
    at_ = size_t(base + by);
    return pos_type(off_type(at_));
}

Bytes::pos_type Bytes::seekpos(pos_type to, std::ios_base::openmode mode)
{
    return seekoff(off_type(to), std::ios_base::beg, mode);
}

namespace
{

// Tile by tile of the tree's own sizes: 8 or, where it holds them whole, 128 voxels.
template <class Tree> void add_tile(Tree &tree, const shape_vdb_grid::Tile &tile, bool active)
{
    using Value = typename Tree::ValueType;
    int level = tile.edge >= 128 ? 2 : 1, step = level == 2 ? 128 : 8;
    const Value value(tile.value);
    openvdb::Coord end = tile.first.offsetBy(tile.edge);
    for (int x = tile.first.x(); x < end.x(); x += step)
        for (int y = tile.first.y(); y < end.y(); y += step)
            for (int z = tile.first.z(); z < end.z(); z += step)
                tree.addTile(openvdb::Index(level), openvdb::Coord(x, y, z), value, active);
}

// Blender draws nothing of a grid without a leaf.
void give_leaf(openvdb::FloatTree &tree)
{
    if (tree.leafCount() || tree.empty())
        return;
    auto value = tree.cbeginValueOn();
    if (value)
        tree.touchLeaf(value.getCoord());
}

template <class Tree, class Leaves> void add_leaves(Tree &tree, Leaves &leaves)
{
    for (auto &leaf : leaves)
        tree.addLeaf(leaf.release());
    leaves.clear();
}

std::string hex(uint64_t a, uint64_t b)
{
    char text[40];
    snprintf(text, sizeof text, "%08x-%04x-%04x-%04x-%012llx", unsigned(a >> 32), unsigned(a >> 16 & 0xffff),
             unsigned((a & 0x0fff) | 0x8000), unsigned((b >> 48 & 0x3fff) | 0x8000),
             static_cast<unsigned long long>(b & 0xffffffffffffull));
    return text;
}

// OpenVDB draws the file's tag at random; ours follows from the content (as a UUID of version 8), so that equal grids give
// equal bytes, and other grids another tag.
void tag(unsigned char *bytes, size_t size)
{
    constexpr size_t at = 8 + 3 * 4 + 1,
                     length = 36; // behind magic number, three versions, the flag of offsets
    if (size < at + length)
        return;
    std::memset(bytes + at, '0', length);
    uint64_t a = 0xcbf29ce484222325ull, b = size;
    for (size_t i = 0; i < size; i += 8) {
        uint64_t word = 0;
        std::memcpy(&word, bytes + i, std::min<size_t>(8, size - i));
        a = (a ^ word) * 0x9e3779b97f4a7c15ull;
        a ^= a >> 29;
        b = (b + (word ^ a)) * 0xbf58476d1ce4e5b9ull;
        b ^= b >> 32;
    }
    std::string text = hex(a, b);
    std::memcpy(bytes + at, text.data(), length);
}

// An archive that writes to any stream that can seek, as openvdb::io::File does to a file.
class Archive : public openvdb::io::Archive
{
  public:
    void put(std::ostream &out, const openvdb::GridCPtrVec &grids, const openvdb::MetaMap &notes) const
    {
        write(out, grids, true, notes);
    }
};

void write_openvdb(const shape_vdb &vdb, std::ostream &out)
{
    openvdb::GridCPtrVec grids;
    for (auto &grid : vdb.grids)
        grids.push_back(grid->grid);
    Archive().put(out, grids, vdb.notes);
}

void must_hold(const shape_vdb &vdb)
{
    if (vdb.grids.empty())
        throw std::invalid_argument("there is no grid");
    for (auto &grid : vdb.grids)
        if (!grid->grid->activeVoxelCount())
            throw std::invalid_argument("nothing is in the grid \"" + grid->name + "\"");
}

} // namespace

void shape_vdb_grid::finish()
{
    if (finished)
        return;
    finished = true;
    auto scalar = openvdb::gridPtrCast<openvdb::FloatGrid>(grid);
    auto vector = openvdb::gridPtrCast<openvdb::Vec3SGrid>(grid);
    for (Pile &pile : piles) {
        for (const Tile &tile : pile.tiles)
            if (scalar)
                add_tile(scalar->tree(), tile, !level_set);
        pile.tiles.clear();
        if (scalar)
            add_leaves(scalar->tree(), pile.leaves);
        else
            add_leaves(vector->tree(), pile.vectors);
    }
    if (scalar)
        give_leaf(scalar->tree());
}

extern "C" {

shape_vdb *shape_vdb_create(void)
{
    shape_vdb *made = nullptr;
    shape_vdb_guard(nullptr, [&] {
        openvdb::initialize();
        made = new shape_vdb;
        return SHAPE_OK;
    });
    return made;
}

void shape_vdb_destroy(shape_vdb *vdb)
{
    const OrderlyEnd guard(
        "for OpenVDB (make the volume smaller)"); // its trees ask for some to be taken apart
    delete vdb;
}

shape_status shape_vdb_add(shape_vdb *vdb, const shape_vdb_options *options, shape_vdb_grid **grid,
                           shape_error *error)
{
    if (!options->name || !options->name[0] || !(options->edge > 0) || !std::isfinite(options->edge) ||
        (options->level_set && !(options->background > 0)))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "a grid needs a name, a voxel above 0 and, as a level set, a band above 0");
    return shape_vdb_guard(error, [&] {
        auto made = std::make_unique<shape_vdb_grid>();
        made->name = options->name;
        made->level_set = options->level_set;
        made->half = options->half;
        made->background = options->level_set ? options->background : 0;
        made->transform = openvdb::math::Transform::createLinearTransform(options->edge);
        made->transform->postTranslate(
            openvdb::Vec3d(options->origin[0], options->origin[1], options->origin[2]));
        if (options->vector)
            made->grid = openvdb::Vec3SGrid::create();
        else
            made->grid = openvdb::FloatGrid::create(made->background);
        made->grid->setName(made->name);
        made->grid->setTransform(made->transform);
        made->grid->setSaveFloatAsHalf(made->half);
        // NanoVDB knows no fog volume of vectors.
        made->grid->setGridClass(options->vector      ? openvdb::GRID_UNKNOWN
                                 : options->level_set ? openvdb::GRID_LEVEL_SET
                                                      : openvdb::GRID_FOG_VOLUME);
        *grid = made.get();
        vdb->grids.push_back(std::move(made));
        return SHAPE_OK;
    });
}

bool shape_vdb_put_brick(void *context, const int32_t first[3], const float *values)
{
    auto *grid = static_cast<shape_vdb_grid *>(context);
    return shape_vdb_guard(nullptr, [&] {
               auto &pile = grid->piles.local();
               const openvdb::Coord at(first[0], first[1], first[2]);
               if (grid->grid->isType<openvdb::Vec3SGrid>()) {
                   auto leaf = std::make_unique<VectorLeaf>(at);
                   for (openvdb::Index i = 0; i < 512; i++)
                       if (values[i] != 0 || values[512 + i] != 0 || values[1024 + i] != 0)
                           leaf->setValueOn(i, openvdb::Vec3s(values[i], values[512 + i], values[1024 + i]));
                   pile.vectors.push_back(std::move(leaf));
                   return SHAPE_OK;
               }
               auto leaf = std::make_unique<FloatLeaf>(openvdb::PartialCreate(), at);
               leaf->allocate();
               std::memcpy(leaf->buffer().data(), values, 512 * sizeof *values);
               auto &mask = leaf->getValueMask();
               const float off = grid->level_set ? grid->background : 0;
               for (openvdb::Index word = 0; word < 8; word++) {
                   uint64_t bits = 0;
                   for (int bit = 0; bit < 64; bit++) {
                       float value = values[64 * word + openvdb::Index(bit)];
                       bits |= uint64_t(grid->level_set ? std::fabs(value) < off : value != off) << bit;
                   }
                   mask.template getWord<uint64_t>(word) = bits;
               }
               pile.leaves.push_back(std::move(leaf));
               return SHAPE_OK;
           }) == SHAPE_OK;
}

bool shape_vdb_put_tile(void *context, const int32_t first[3], int32_t edge, float value)
{
    auto *grid = static_cast<shape_vdb_grid *>(context);
    return shape_vdb_guard(nullptr, [&] {
               grid->piles.local().tiles.push_back(
                   {openvdb::Coord(first[0], first[1], first[2]), edge, value});
               return SHAPE_OK;
           }) == SHAPE_OK;
}

shape_status shape_vdb_note(shape_vdb *vdb, shape_vdb_grid *grid, const char *name, const char *text,
                            shape_error *error)
{
    return shape_vdb_guard(error, [&] {
        openvdb::MetaMap &notes = grid ? *grid->grid : vdb->notes;
        notes.insertMeta(name, openvdb::StringMetadata(text));
        return SHAPE_OK;
    });
}

shape_status shape_vdb_note_number(shape_vdb *vdb, shape_vdb_grid *grid, const char *name, float value,
                                   shape_error *error)
{
    return shape_vdb_guard(error, [&] {
        openvdb::MetaMap &notes = grid ? *grid->grid : vdb->notes;
        notes.insertMeta(name, openvdb::FloatMetadata(value));
        return SHAPE_OK;
    });
}

shape_status shape_vdb_summarise(shape_vdb_grid *grid, shape_vdb_summary *summary, shape_error *error)
{
    return shape_vdb_guard(error, [&] {
        grid->finish();
        *summary = {};
        summary->active = grid->grid->activeVoxelCount();
        summary->leaves = grid->grid->baseTree().leafCount();
        summary->bytes = grid->grid->memUsage();
        openvdb::CoordBBox box = grid->grid->evalActiveVoxelBoundingBox();
        for (int k = 0; k < 3 && !box.empty(); k++) {
            summary->min[k] = box.min()[k];
            summary->max[k] = box.max()[k];
        }
        return SHAPE_OK;
    });
}

float shape_vdb_value(shape_vdb_grid *grid, const int32_t index[3])
{
    grid->finish();
    const openvdb::Coord at(index[0], index[1], index[2]);
    if (auto scalar = openvdb::gridPtrCast<openvdb::FloatGrid>(grid->grid))
        return scalar->tree().getValue(at);
    return openvdb::gridPtrCast<openvdb::Vec3SGrid>(grid->grid)->tree().getValue(at)[0];
}

shape_status shape_vdb_encode(shape_vdb *vdb, shape_vdb_format format, unsigned char **bytes, size_t *size,
                              shape_error *error)
{
    return shape_vdb_guard(error, [&] {
        for (auto &grid : vdb->grids)
            grid->finish();
        try {
            must_hold(*vdb);
        } catch (const std::invalid_argument &problem) {
            return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                                   "%s (take smaller voxels, or a cloud with something in it)",
                                   problem.what());
        }
        Bytes buffer;
        std::ostream out(&buffer);
        out.exceptions(std::ios::badbit | std::ios::failbit);
        if (format == SHAPE_VDB_NANOVDB) {
            shape_vdb_write_nano(*vdb, out);
        } else {
            write_openvdb(*vdb, out);
            tag(buffer.data(), buffer.size());
        }
        *bytes = buffer.take(*size);
        return SHAPE_OK;
    });
}

} // extern "C"
