// Private to bridge/openvdb_*.cpp: a file in the making.
#pragma once

#include "shape/vdb.h"

#include <openvdb/openvdb.h>
#include <tbb/enumerable_thread_specific.h>

#include <string>
#include <vector>

using FloatLeaf = openvdb::FloatTree::LeafNodeType;
using VectorLeaf = openvdb::Vec3STree::LeafNodeType;

// Leaves and tiles as threads bring them; finish() makes a tree of them.
struct shape_vdb_grid {
    struct Tile {
        openvdb::Coord first;
        int32_t edge;
        float value;
    };
    struct Pile {
        std::vector<std::unique_ptr<FloatLeaf>> leaves;
        std::vector<std::unique_ptr<VectorLeaf>> vectors;
        std::vector<Tile> tiles;
    };
    std::string name;
    bool level_set = false, half = false;
    float background = 0;
    openvdb::math::Transform::Ptr transform;
    openvdb::MetaMap notes;
    tbb::enumerable_thread_specific<Pile> piles;
    openvdb::GridBase::Ptr grid; // without values until finished
    bool finished = false;

    void finish();
};

struct shape_vdb {
    std::vector<std::unique_ptr<shape_vdb_grid>> grids;
    openvdb::MetaMap notes;
};

// Bytes that grow, as a stream that can also go back; the memory is malloc's and can be taken.
class Bytes : public std::streambuf
{
  public:
    ~Bytes() override { free(data_); }
    unsigned char *take(size_t &size);
    unsigned char *data() { return data_; }
    size_t size() const { return size_; }

  protected:
    std::streamsize xsputn(const char *from, std::streamsize count) override;
    int_type overflow(int_type c) override;
    pos_type seekoff(off_type by, std::ios_base::seekdir from, std::ios_base::openmode) override;
    pos_type seekpos(pos_type to, std::ios_base::openmode) override;

  private:
    unsigned char *data_ = nullptr;
    size_t size_ = 0, room_ = 0, at_ = 0;
};

// Runs what may throw; no exception gets out.
template <class Work> shape_status shape_vdb_guard(shape_error *error, Work work)
{
    try {
        return work();
    } catch (const std::bad_alloc &) {
        return shape_error_memory(error);
    } catch (const std::exception &problem) {
        return shape_error_set(error, SHAPE_ERROR_SYSTEM, "OpenVDB: %s", problem.what());
    } catch (...) {
        return shape_error_set(error, SHAPE_ERROR_SYSTEM, "OpenVDB failed");
    }
}

// openvdb_nano.cpp: the grids as a NanoVDB file.
void shape_vdb_write_nano(const shape_vdb &vdb, std::ostream &out);
