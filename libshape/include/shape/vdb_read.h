/* OpenVDB files as voxel grids [target shape_openvdb]. */
#ifndef SHAPE_VDB_READ_H
#define SHAPE_VDB_READ_H

#include "shape/grid.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shape_vdb_read_options {
    const char *grid;  /* which grid, by its name; NULL: the only scalar one */
    size_t max_bytes;  /* that reading may take; default 4 GiB */
    bool y_up;         /* the file's y is up; default false: its z becomes our y */
    const char *shown; /* what errors call the file; NULL: its path */
    const char *
        colour; /* the scattering's colour: one grid of vectors (vec3s, vec3d), or three of numbers with commas
                           between their names; NULL: none. Those three do not count as the density */
} shape_vdb_read_options;

typedef struct shape_vdb_contents {
    shape_grid *grid;              /* with its colour; the caller releases it, or gives it to a set */
    shape_frame frame;             /* voxels of *grid to metres */
    char name[SHAPE_NAME_MAX + 1]; /* of the grid in the file */
    bool level_set;                /* it was one, and its inside became density */
    size_t file_bytes;
} shape_vdb_contents;

shape_vdb_read_options shape_vdb_read_defaults(void);

/* Reads one scalar grid (float, double, or stored as half) with an affine transform from an untrusted file. A level set
 * becomes a fog volume: 0 at its surface to 1 inside its band. Inactive voxels count as 0, and so do negative ones. A colour
 * may have a transform of its own; it is looked at where the density has its voxels, and where none is active by its
 * neighbours, and then by its background.
 * OpenVDB does not stand up to damaged files, so it runs in a process of its own, whose memory is limited, and whose time:
 * 10 s of processor time, 1 s a MiB of the file and 1 s for every 64 MiB of max_bytes. Errors, each
 * with the file's name: SHAPE_ERROR_IO, SHAPE_ERROR_FORMAT (no OpenVDB file, a version or a compression that is not known,
 * no or several scalar grids, nothing in it, NaN, damaged), SHAPE_ERROR_LIMIT. Not to be called from two threads at once. */
shape_status shape_vdb_read(const char *path, const shape_vdb_read_options *options,
                            shape_vdb_contents *contents, shape_error *error);

/* Whether the bytes begin as those of an OpenVDB file. */
bool shape_vdb_is(const void *bytes, size_t size);

#ifdef __cplusplus
}
#endif
#endif
