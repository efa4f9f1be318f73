/* The option tables of neph-mesh, for the program and for scenes, which run the program. */
#include "cli_mesh.h"

cli_mesh_values cli_mesh_options = {.faces = 370, .scale = 1.1, .thickness = 0.3, .unit = 1, .voxels = 128};

static const cli_option options[] = {
    {"faces", 0, CLI_INTEGER, &cli_mesh_options.faces, 0, 10000000, "N",
     "decimate to that many triangles; 0: keep all [370]", NULL, false},
    {"scale", 0, CLI_NUMBER, &cli_mesh_options.scale, 0.01, 100, "K",
     "size of an ellipsoid to its triangle [1.1]", NULL, false},
    {"no-rotate", 0, CLI_FLAG, &cli_mesh_options.no_rotate, 0, 0, NULL, "leave the ellipsoids along the axes",
     NULL, false},
    {"fit", 0, CLI_FLAG, &cli_mesh_options.fit, 0, 0, NULL,
     "ellipsoids in their triangle's plane, flat where it is", NULL, false},
    {"thickness", 0, CLI_NUMBER, &cli_mesh_options.thickness, 0.001, 10, "K",
     "with --fit: thickness to the mean size in the plane [0.3]", &cli_mesh_options.thickness_given, false},
    {"fill", 0, CLI_INTEGER, &cli_mesh_options.fill, 0, 1000000, "N",
     "fill the inside with up to N spheres [0]", &cli_mesh_options.fill_given, false},
    {"voxels", 0, CLI_INTEGER, &cli_mesh_options.voxels, 8, 1024, "N",
     "with --fill: voxels along the longest side [128]", &cli_mesh_options.voxels_given, false},
    {"measure", 0, CLI_FLAG, &cli_mesh_options.measure, 0, 0, NULL,
     "say what share of the mesh is covered and how far the cloud sticks out", NULL, true},
    {0}};

static const cli_option placing[] = {
    {"up", 0, CLI_CHOICE, &cli_mesh_options.up, 0, 0, "y|z",
     "the file's up axis [y for glTF and OBJ, z for PLY, STL, OFF]", &cli_mesh_options.up_given, false},
    {"unit", 0, CLI_NUMBER, &cli_mesh_options.unit, 1e-9, 1e9, "M", "metres a unit of the file [1]",
     &cli_mesh_options.unit_given, false},
    {"size", 0, CLI_NUMBER, &cli_mesh_options.size, 1e-6, 1e9, "L",
     "scale it so that its longest side is L metres [as it is]", &cli_mesh_options.size_given, false},
    {"center", 0, CLI_FLAG, &cli_mesh_options.center, 0, 0, NULL,
     "put the middle of its box at the frame's origin", NULL, false},
    {0}};

static const cli_group groups[] = {
    {"Shape", options}, {"Axes and units", placing}, {"Medium and frame", cli_medium_options}, {0}};

const cli_generator cli_mesh = {"neph-mesh", "MESH", groups, NULL};
