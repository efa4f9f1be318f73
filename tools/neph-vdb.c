/* neph-vdb: clouds to OpenVDB, NanoVDB or raw volumes, and volumes to clouds of few primitives. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "cli_picture.h"
#include "cli_vdb_fit.h"
#include "cli_volume.h"
#include "shape/file.h"
#include "shape/volumefit.h"
#include "vdb.h"

enum { MAX_SET_FILE = 0x40000000 };

vdb_values vdb = {.resolution = 256, .max_memory = 4294967296, .light_resolution = 48};

static const cli_option size_options[] = {
    {"voxel-size", 0, CLI_NUMBER, &vdb.voxel_size, 1e-9, 1e9, "L",
     "edge of a voxel, metres; of a raw volume read too", &vdb.voxel_size_given, false},
    {"resolution", 0, CLI_INTEGER, &vdb.resolution, 1, SHAPE_VOXEL_MOST, "N",
     "voxels along the longest side of the bounds [256]", &vdb.resolution_given, false},
    {"error", 0, CLI_NUMBER, &vdb.error, 1e-4, 1, "E",
     "choose the voxels, or of a volume's fit the primitives, so that density is off by no more (root mean "
     "square)",
     &vdb.error_given, false},
    {"max-memory", 0, CLI_INTEGER, &vdb.max_memory, 1048576, 1e15, "BYTES",
     "refuse what would need more, before any work [4294967296]", NULL, true},
    {0}};

static const cli_option value_options[] = {
    {"ramp", 0, CLI_NUMBER, &vdb.ramp, 0.01, 1e6, "V",
     "uniform clouds: 0 at the surface to 1 so many voxels inside [none]", &vdb.ramp_given, false},
    {"values", 0, CLI_CHOICE, &vdb.values, 0, 0, "density|extinction",
     "the field's density, or that times extinction, 1/m [density]", NULL, false},
    {"grids", 0, CLI_TEXT, &vdb.grids, 0, 0, "A,B,...",
     "more grids: light, sdf, profile, detail_type, density_scale [none]", NULL, false},
    {"each", 0, CLI_FLAG, &vdb.each, 0, 0, NULL, "one grid a cloud, density_NAME [one grid for all, density]",
     NULL, false},
    {"light-resolution", 0, CLI_INTEGER, &vdb.light_resolution, 2, 256, "N",
     "cells of the light grid's longest side [48]", &vdb.light_resolution_given, false},
    {"sun", 0, CLI_PAIR, cli_picture_values.sun, 0, 0, "AZIMUTH,HEIGHT",
     "of the light: where the sun stands, degrees; azimuth from +z towards +x [60,40]",
     &cli_picture_values.sun_given, false},
    {"sun-irradiance", 0, CLI_VECTOR, cli_picture_values.sun_irradiance, 0, 1e9, "R,G,B",
     "of the light: on a plane that faces the sun [pi,pi,pi]", &cli_picture_values.sun_irradiance_given,
     false},
    {"sky", 0, CLI_TEXT, &cli_picture_values.sky, 0, 0, "none|R,G,B|clear",
     "of the light: black, one radiance, or a clear day's [clear]", &cli_picture_values.sky_given, false},
    {0}};

static const cli_option file_options[] = {
    {"format", 0, CLI_CHOICE, &vdb.format, 0, 0, "vdb|nvdb|raw",
     "what is written [by the output's suffix; to standard output: vdb]", &vdb.format_given, true},
    {"half", 0, CLI_FLAG, &vdb.half, 0, 0, NULL, "16 bits a value [32]", NULL, false},
    {"up", 0, CLI_CHOICE, &vdb.up, 0, 0, "z|y", "which axis points up: z for Blender, y for engines [z]",
     NULL, false},
    {"header", 0, CLI_FLAG, &vdb.header, 0, 0, NULL,
     "raw: begin by the three sizes, 32 bits each [the sidecar alone has them]", NULL, false},
    {0}};

static const cli_option fit_options[] = {
    {"primitives", 0, CLI_INTEGER, &cli_vdb_fit_values.primitives, 1, SHAPE_VOLUMEFIT_MAX_PRIMITIVES, "N",
     "at most so many [64; with --error 1000]", &cli_vdb_fit_values.primitives_given, false},
    {"model", 0, CLI_CHOICE, &cli_vdb_fit_values.model, 0, 0, "uniform|spheroid",
     "of the cloud made: plain, or with noise at its edge [uniform]", NULL, false},
    {"cells", 0, CLI_INTEGER, &cli_vdb_fit_values.cells, 16, 512, "N",
     "cells along the longest side that the fit looks at [80]", NULL, false},
    {"grid", 0, CLI_TEXT, &cli_volume_values.grid, 0, 0, "NAME", "which grid of a .vdb [the only scalar one]",
     &cli_volume_values.grid_given, false},
    {"density-gain", 0, CLI_NUMBER, &cli_volume_values.density_gain, 0, 1e9, "X",
     "density is the voxel's value times this [1]", &cli_volume_values.density_gain_given, false},
    {0}};

static const cli_group groups[] = {{"Voxels", size_options},
                                   {"Values of a volume written", value_options},
                                   {"File", file_options},
                                   {"A volume to primitives", fit_options},
                                   {"Medium and place of its cloud", cli_optics_options},
                                   {"Scene", cli_outside_options},
                                   {0}};

static const cli_program program = {
    .name = "neph-vdb",
    .arguments = "IN",
    .about = "Writes clouds (a .neph or a scene) as a volume: OpenVDB (.vdb), NanoVDB (.nvdb) or plain "
             "numbers (.raw\n"
             "with a sidecar .json). The grid is a fog volume named density, in metres. And the other way: "
             "of a volume\n"
             "(.vdb or .raw) makes a cloud of few spheres and ellipsoids.",
    .examples = "  neph-vdb cumulus.neph -o cumulus.vdb                           for Blender\n"
                "  neph-vdb cumulus.neph --up y --resolution 512 --half -o cumulus.nvdb\n"
                "  neph-vdb cumulus.neph --error 0.1 --grids sdf,profile,light -o cumulus.vdb\n"
                "  neph-vdb smoke.vdb -o smoke.neph --primitives 100\n",
    .min_arguments = 1,
    .max_arguments = 1,
    .groups = groups};

static vdb_format choose_format(const cli_common *common)
{
    if (vdb.format_given)
        return (vdb_format)vdb.format;
    if (!strcmp(common->output, "-"))
        return VDB_FORMAT_VDB;
    if (cli_has_suffix(common->output, ".vdb"))
        return VDB_FORMAT_VDB;
    if (cli_has_suffix(common->output, ".nvdb"))
        return VDB_FORMAT_NVDB;
    if (cli_has_suffix(common->output, ".raw"))
        return VDB_FORMAT_RAW;
    cli_wrong("-o %s: the suffix is none of .vdb, .nvdb, .raw (or name a --format)", common->output);
    return VDB_FORMAT_VDB;
}

static void check_command(vdb_format format, const cli_common *common)
{
    if (vdb.voxel_size_given + vdb.resolution_given + vdb.error_given > 1)
        cli_wrong("--voxel-size, --resolution and --error all choose the voxels (give one of them)");
    if (vdb.ramp_given && vdb.error_given)
        cli_wrong("--ramp --error: a ramp is not the field that --error measures (give one of them)");
    if (format != VDB_FORMAT_RAW && vdb.header)
        cli_wrong("--header: has no meaning but for raw");
    if (format == VDB_FORMAT_RAW && (vdb.grids || vdb.each))
        cli_wrong("--grids --each: a raw file holds one grid (write a .vdb or .nvdb)");
    if (format == VDB_FORMAT_RAW && !vdb.header && !strcmp(common->output, "-"))
        cli_wrong("raw to standard output has no sidecar to say its size (give --header, or a file with -o)");
}

/* Clouds to a volume. */
static void write_volume(const cli_common *common, const shape_set *set)
{
    vdb_format format = choose_format(common);
    check_command(format, common);
    const char *name = cli_given_of(fit_options);
    name = name ? name : cli_given_of(cli_optics_options);
    if (name)
        cli_wrong("--%s belongs to volumes that are read (%s holds clouds)", name, common->arguments[0]);
    vdb_write_volume(common, set, format);
}

/* A volume to a cloud. bytes: NULL for a file, which is read by its path. */
static void fit_volume(const cli_common *common, const unsigned char *bytes, size_t size)
{
    const char *output = common->output, *name = cli_given_of(value_options);
    static const char *const others[] = {"resolution", "format", "half", "header"};
    for (size_t i = 0; i < sizeof others / sizeof *others && !name; i++)
        name = cli_given(others[i]) ? others[i] : NULL;
    if (name)
        cli_wrong("--%s belongs to volumes that are written (%s is one to be read)", name,
                  common->arguments[0]);
    if (cli_has_suffix(output, ".vdb") || cli_has_suffix(output, ".nvdb") || cli_has_suffix(output, ".raw"))
        cli_wrong("-o %s: of a volume a .neph is made (name one)", output);
    cli_volume_values.up = vdb.up == 0; /* the tables name the axes in another order */
    cli_volume_values.max_memory = (double)vdb.max_memory;
    if (vdb.voxel_size_given)
        cli_volume_values.voxel_size = vdb.voxel_size;
    cli_volume_values.voxel_size_given = vdb.voxel_size_given;
    cli_vdb_fit_values.error = vdb.error;
    cli_vdb_fit_values.error_given = vdb.error_given;
    cli_vdb_fit(common, common->arguments[0], bytes, size);
}

int main(int argc, char **argv)
{
    cli_common common;
    shape_error error;
    unsigned char *bytes;
    size_t size;
    cli_parse(&program, argc, argv, &common);
    const char *path = common.arguments[0];
    if (cli_has_suffix(path, ".nvdb"))
        cli_fail("%s: NanoVDB is written, not read (give the .vdb, or convert it by nanovdb_convert)", path);
    if (strcmp(path, "-") && cli_is_volume(path)) {
        fit_volume(&common, NULL, 0);
        return cli_finish(&common);
    }
    cli_check(shape_file_read(path, MAX_SET_FILE, &bytes, &size, &error), &error);
    if (cli_is_volume_bytes(bytes, size)) {
        fit_volume(&common, bytes, size);
    } else {
        cli_input input = cli_input_decode(path, bytes, size);
        cli_note_meshes(input.scene, "left out, since a volume holds clouds only");
        write_volume(&common, input.set);
        cli_input_free(&input);
    }
    free(bytes);
    return cli_finish(&common);
}
