/* The options of volumes, and reading one. Programs that use this link shape_openvdb. */
#include "cli_volume.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "shape/file.h"
#include "shape/grid.h"
#include "shape/vdb_read.h"

enum { UP_Y, UP_Z };

cli_volume cli_volume_values = {.density_gain = 1, .voxel_size = 1, .max_memory = 4294967296.0, .up = UP_Z};

#define GIVEN(name) &cli_volume_values.name##_given, false
#define VALUE(name) &cli_volume_values.name

const cli_option cli_volume_options[] = {
    {"density-gain", 0, CLI_NUMBER, VALUE(density_gain), 0, 1e9, "X",
     "density is the voxel's value times this [1]", GIVEN(density_gain)},
    {"grid", 0, CLI_TEXT, VALUE(grid), 0, 0, "NAME", "which grid of a .vdb [the only scalar one]",
     GIVEN(grid)},
    {"up", 0, CLI_CHOICE, VALUE(up), 0, 0, "y|z", "which axis of the volume is up [z]", GIVEN(up)},
    {"voxel-size", 0, CLI_NUMBER, VALUE(voxel_size), 1e-9, 1e9, "L",
     "edge of a raw volume's voxels, metres; a .vdb tells its own [1]", GIVEN(voxel_size)},
    {"max-memory", 0, CLI_NUMBER, VALUE(max_memory), 1048576, 1e15, "BYTES",
     "memory that the volume may take, bytes [4294967296]", GIVEN(max_memory)},
    {0}};

static bool has_suffix(const char *path, const char *suffix)
{
    size_t length = strlen(path), end = strlen(suffix);
    return length > end && !strcasecmp(path + length - end, suffix);
}

/* The first bytes and how many there are. */
static size_t read_start(const char *path, unsigned char *bytes, size_t room, size_t *whole)
{
    FILE *file = fopen(path, "rb");
    size_t size = 0;
    *whole = 0;
    if (!file)
        return 0;
    size = fread(bytes, 1, room, file);
    long end = fseek(file, 0, SEEK_END) ? -1 : ftell(file);
    *whole = end > 0 ? (size_t)end : 0;
    fclose(file);
    return size;
}

bool cli_is_volume(const char *path)
{
    unsigned char bytes[16];
    size_t whole;
    if (!strcmp(path, "-"))
        return false;
    if (has_suffix(path, ".vdb") || has_suffix(path, ".raw"))
        return true;
    size_t size = read_start(path, bytes, sizeof bytes, &whole);
    return shape_vdb_is(bytes, size) || (size == sizeof bytes && shape_volume_raw_is(bytes, whole));
}

/* Voxels of a raw volume to metres: it stands with its middle at the origin. */
static shape_frame raw_frame(const shape_grid *grid)
{
    const double size = cli_volume_values.voxel_size;
    bool z_up = cli_volume_values.up == UP_Z;
    shape_frame file = {{{size, 0, 0, 0}, {0, size, 0, 0}, {0, 0, size, 0}}}, frame = file;
    for (int a = 0; a < 3; a++)
        file.m[a][3] = -0.5 * size * (grid->points[a] - 1);
    for (int j = 0; j < 4; j++) {
        frame.m[0][j] = file.m[0][j];
        frame.m[1][j] = z_up ? file.m[2][j] : file.m[1][j];
        frame.m[2][j] = z_up ? -file.m[1][j] : file.m[2][j];
    }
    return frame;
}

static shape_grid *read_raw(const char *path, shape_frame *frame)
{
    shape_error error;
    unsigned char *bytes;
    size_t size, most = (size_t)cli_volume_values.max_memory;
    shape_grid *grid;
    if (cli_volume_values.grid_given)
        cli_fail("%s: a raw volume has no grids to choose from with --grid", path);
    cli_check(shape_file_read(path, most, &bytes, &size, &error), &error);
    cli_check(shape_volume_raw_decode(path, bytes, size, most, &grid, &error), &error);
    free(bytes);
    *frame = raw_frame(grid);
    cli_say("%s: %d x %d x %d voxels of %g m", path, grid->points[0] - 2, grid->points[1] - 2,
            grid->points[2] - 2, cli_volume_values.voxel_size);
    return grid;
}

static shape_grid *read_vdb(const char *path, shape_frame *frame)
{
    shape_error error;
    shape_vdb_contents contents;
    shape_vdb_read_options options = shape_vdb_read_defaults();
    if (cli_volume_values.voxel_size_given)
        cli_fail("%s: an OpenVDB file has a voxel size of its own (leave --voxel-size out)", path);
    options.grid = cli_volume_values.grid;
    options.max_bytes = (size_t)cli_volume_values.max_memory;
    options.y_up = cli_volume_values.up == UP_Y;
    cli_check(shape_vdb_read(path, &options, &contents, &error), &error);
    *frame = contents.frame;
    cli_say("%s: grid \"%s\"%s, %d x %d x %d voxels, the densest %g", path, contents.name,
            contents.level_set ? " (a level set, filled)" : "", contents.grid->points[0] - 2,
            contents.grid->points[1] - 2, contents.grid->points[2] - 2, (double)contents.grid->most);
    return contents.grid;
}

shape_set *cli_read_volume(const char *path)
{
    shape_error error;
    shape_frame frame;
    unsigned char bytes[16];
    size_t whole, size = read_start(path, bytes, sizeof bytes, &whole), index;
    bool vdb = shape_vdb_is(bytes, size) || (has_suffix(path, ".vdb"));
    shape_grid *grid = vdb ? read_vdb(path, &frame) : read_raw(path, &frame);
    char name[SHAPE_NAME_MAX + 1];
    cli_bare_name(path, "volume", name);
    grid->gain = (float)cli_volume_values.density_gain;
    shape_set *set = shape_set_create(&error);
    if (!set)
        cli_fail("%s", error.text);
    cli_check(shape_set_add_grid(set, name, grid, &frame, &index, &error), &error);
    cli_medium_apply(&set->clouds[index]);
    cli_check(shape_set_check(set, &error), &error);
    return set;
}

void cli_refuse_volume_options(void)
{
    const cli_option *tables[] = {cli_volume_options, cli_optics_options};
    for (int i = 0; i < 2; i++)
        for (const cli_option *option = tables[i]; option->name; option++)
            if (*option->given)
                cli_wrong("--%s belongs to volumes, .vdb or raw (for a .neph use neph-edit)", option->name);
}
