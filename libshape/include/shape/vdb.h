/* The bridge to OpenVDB and NanoVDB, writing: sparse grids built brick by brick, and files of them in memory. */
#ifndef SHAPE_VDB_H
#define SHAPE_VDB_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "shape/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A file in the making: grids in the order in which they were added. */
typedef struct shape_vdb shape_vdb;
typedef struct shape_vdb_grid shape_vdb_grid;

/* A grid to be. The world point of voxel i, j, k (its centre) is origin + edge (i, j, k). */
typedef struct shape_vdb_options {
    const char *name; /* Blender draws a fog volume only where it is called "density" */
    double edge;      /* of a voxel [m] */
    double origin[3]; /* [m] */
    bool vector;      /* three channels a voxel (Vec3f, of no class), else one (float) */
    bool
        level_set; /* class level set: `background` outside, -background inside; else fog volume, 0 outside */
    float background; /* of a level set: the band's half width [m], above 0 */
    bool half; /* 16 bits a value in the file (NanoVDB: its Fp16, blocks of 8^3 with a range of their own) */
} shape_vdb_options;

/* The caller destroys it. NULL where memory is out. */
shape_vdb *shape_vdb_create(void);
void shape_vdb_destroy(
    shape_vdb *vdb); /* NULL is allowed; sets std::terminate while it runs, as shape_gltf_decode */

/* *grid lives as long as the file. */
shape_status shape_vdb_add(shape_vdb *vdb, const shape_vdb_options *options, shape_vdb_grid **grid,
                           shape_error *error);

/* Sinks of shape/voxels.h with a shape_vdb_grid as context; by several threads at a time. False: out of memory. */
bool shape_vdb_put_brick(void *grid, const int32_t first[3], const float *values);
bool shape_vdb_put_tile(void *grid, const int32_t first[3], int32_t edge, float value);

/* What is known of a grid, or (NULL) of the file, under a name. NanoVDB files have no place for it. */
shape_status shape_vdb_note(shape_vdb *vdb, shape_vdb_grid *grid, const char *name, const char *text,
                            shape_error *error);
shape_status shape_vdb_note_number(shape_vdb *vdb, shape_vdb_grid *grid, const char *name, float value,
                                   shape_error *error);

/* What the bricks put so far hold. Call it, or encode, when nothing more is put. */
typedef struct shape_vdb_summary {
    uint64_t active; /* voxels */
    size_t leaves, bytes;
    int32_t min[3], max[3]; /* of the active voxels */
} shape_vdb_summary;
shape_status shape_vdb_summarise(shape_vdb_grid *grid, shape_vdb_summary *summary, shape_error *error);

/* The value of a voxel (the first channel); for tests. */
float shape_vdb_value(shape_vdb_grid *grid, const int32_t index[3]);

typedef enum shape_vdb_format { SHAPE_VDB_OPENVDB = 0, SHAPE_VDB_NANOVDB } shape_vdb_format;

/* The whole file, in memory that the caller frees by free(). The same grids give the same bytes. A grid in which nothing
 * is active is SHAPE_ERROR_ARGUMENT; one of tiles alone gets a leaf, since Blender draws nothing without. */
shape_status shape_vdb_encode(shape_vdb *vdb, shape_vdb_format format, unsigned char **bytes, size_t *size,
                              shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
