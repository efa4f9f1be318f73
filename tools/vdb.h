/* Private to neph-vdb: its options, and the two ways it goes. */
#ifndef NEPHELE_VDB_H
#define NEPHELE_VDB_H

#include "cli.h"
#include "shape/vdb.h"
#include "shape/voxels.h"

typedef enum vdb_format { VDB_FORMAT_VDB, VDB_FORMAT_NVDB, VDB_FORMAT_RAW } vdb_format;

typedef struct vdb_values {
    double voxel_size, error, ramp;
    int64_t resolution, max_memory, light_resolution;
    int up, values, format;
    bool half, each, header, view; /* view: --error is about a picture */
    const char *grids;
    bool voxel_size_given, resolution_given, error_given, ramp_given, format_given, light_resolution_given;
} vdb_values;

extern vdb_values vdb;

/* vdb_out.c: a set to a volume. */
void vdb_write_volume(const cli_common *common, const shape_set *set, vdb_format format);
/* vdb_size.c: the voxels that the options ask for, within --max-memory; ends the program where they do not fit. */
shape_voxel_lattice vdb_choose_lattice(const cli_common *common, const shape_set *set,
                                       const shape_volume *volume, const shape_voxel_request *requests,
                                       size_t request_count, vdb_format format);
/* vdb_raw.c: density as plain floats, and a sidecar that says what they are. */
void vdb_write_raw(const cli_common *common, const shape_set *set, const shape_volume *volume,
                   const shape_voxel_lattice *lattice, const shape_voxel_request *request);

#endif
