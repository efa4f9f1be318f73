/* Volumes as inputs of neph-render and neph-view: .vdb and raw floats become a set with one cloud of the model grid. */
#ifndef NEPHELE_CLI_VOLUME_H
#define NEPHELE_CLI_VOLUME_H

#include "cli_scene.h"

typedef struct cli_volume {
    double density_gain, voxel_size, max_memory;
    const char *grid, *colour_grid;
    int up;
    bool density_gain_given, voxel_size_given, max_memory_given, grid_given, up_given, colour_grid_given;
} cli_volume;

extern cli_volume cli_volume_values;
/* The rows that fill cli_volume_values, and the medium's of cli_medium_values; groups "Volumes (.vdb, raw)", "Medium of
 * volumes". */
extern const cli_option cli_volume_options[];
/* --colour-grid, for programs that show it. */
extern const cli_option cli_volume_colour_options[];

/* Whether a file is a volume: by its suffix (.vdb, .raw), else by what it begins with. Not for "-". */
bool cli_is_volume(const char *path);
bool cli_is_volume_bytes(const void *bytes, size_t size);
/* Reads one by the options; exits 1 with one line where it cannot. The caller destroys the set. */
shape_set *cli_read_volume(const char *path);
/* The same from memory; shown is what errors call it. */
shape_set *cli_read_volume_bytes(const char *shown, const void *bytes, size_t size);
/* A .neph, a scene or a volume, from a file or "-". Options of volumes with another input: exit 2. */
cli_input cli_volume_input_read(const char *path);
/* For other inputs: exit 2 where an option was given that belongs to volumes. */
void cli_refuse_volume_options(void);

#endif
