/* The options of neph-mesh. They stand apart from what uses them, since that loads mesh and volume libraries, which take
 * long to start and which no other program should wait for. */
#ifndef NEPHELE_CLI_MESH_H
#define NEPHELE_CLI_MESH_H

#include "cli_generator.h"

typedef struct cli_mesh_values {
    int64_t faces, fill, voxels;
    double scale, thickness, size, unit;
    bool no_rotate, fit, center, measure;
    bool up_given, size_given, unit_given, thickness_given, voxels_given, fill_given;
    int up;
} cli_mesh_values;

extern cli_mesh_values cli_mesh_options;

/* Makes the cloud (cli_mesh.c, in neph-mesh alone). */
shape_set *cli_mesh_make(const char *path, uint64_t seed);

#endif
