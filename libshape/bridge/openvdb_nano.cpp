// Grids as a NanoVDB file (Museth 2021; nanovdb/util/IO.h), by NanoVDB's own converter.
#include "openvdb_private.hpp"

#define NANOVDB_USE_OPENVDB
#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>

#include <ostream>

void shape_vdb_write_nano(const shape_vdb &vdb, std::ostream &out)
{
    for (auto &own : vdb.grids) {
        auto scalar = openvdb::gridPtrCast<openvdb::FloatGrid>(own->grid);
        nanovdb::GridHandle<> handle;
        if (scalar && own->half)
            handle = nanovdb::openToNanoVDB<nanovdb::HostBuffer, openvdb::FloatTree, nanovdb::Fp16>(*scalar);
        else
            handle = nanovdb::openToNanoVDB(own->grid);
        nanovdb::io::writeGrid(out, handle, nanovdb::io::Codec::NONE);
    }
}
