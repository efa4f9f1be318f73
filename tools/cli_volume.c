/* The options of volumes, and reading one. Programs that use this link shape_openvdb. */
#include "cli_volume.h"

#include "cli_scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "shape/file.h"
#include "shape/grid.h"
#include "shape/neph.h"
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

const cli_option cli_volume_colour_options[] = {
    {"colour-grid", 0, CLI_TEXT, VALUE(colour_grid), 0, 0, "NAME|R,G,B",
     "the albedo is multiplied by this grid of a .vdb, three channels, or by three grids of one [none]",
     GIVEN(colour_grid)},
    {0}};

/* The first bytes and how many there are; none of what can be read once only, a pipe. */
static size_t read_start(const char *path, unsigned char *bytes, size_t room, size_t *whole)
{
    struct stat info;
    size_t size = 0;
    *whole = 0;
    if (stat(path, &info) || !S_ISREG(info.st_mode))
        return 0;
    FILE *file = fopen(path, "rb");
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
    if (cli_has_suffix(path, ".vdb") || cli_has_suffix(path, ".raw"))
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

static shape_grid *decode_raw(const char *shown, const void *bytes, size_t size, shape_frame *frame)
{
    shape_error error;
    shape_grid *grid;
    if (cli_volume_values.grid_given)
        cli_fail("%s: a raw volume has no grids to choose from with --grid", shown);
    if (cli_volume_values.colour_grid_given)
        cli_fail("%s: a raw volume has no grid for --colour-grid (give a .vdb)", shown);
    cli_check(
        shape_volume_raw_decode(shown, bytes, size, (size_t)cli_volume_values.max_memory, &grid, &error),
        &error);
    *frame = raw_frame(grid);
    cli_say("%s: %d x %d x %d voxels of %g m", shown, grid->points[0] - 2, grid->points[1] - 2,
            grid->points[2] - 2, cli_volume_values.voxel_size);
    return grid;
}

static shape_grid *read_vdb(const char *path, const char *shown, shape_frame *frame)
{
    shape_error error;
    shape_vdb_contents contents;
    shape_vdb_read_options options = shape_vdb_read_defaults();
    if (cli_volume_values.voxel_size_given)
        cli_fail("%s: an OpenVDB file has a voxel size of its own (leave --voxel-size out)", shown);
    options.grid = cli_volume_values.grid;
    options.colour = cli_volume_values.colour_grid;
    options.max_bytes = (size_t)cli_volume_values.max_memory;
    options.y_up = cli_volume_values.up == UP_Y;
    options.shown = shown;
    shape_status status = shape_vdb_read(path, &options, &contents, &error);
    if (path != shown)
        unlink(path); /* a copy of ours */
    cli_check(status, &error);
    *frame = contents.frame;
    const char *colour = cli_volume_values.colour_grid;
    cli_say("%s: grid \"%s\"%s%s%s, %d x %d x %d voxels, the densest %g", shown, contents.name,
            contents.level_set ? " (a level set, filled)" : "", colour ? ", coloured by " : "",
            colour ? colour : "", contents.grid->points[0] - 2, contents.grid->points[1] - 2,
            contents.grid->points[2] - 2, (double)contents.grid->most);
    return contents.grid;
}

static shape_set *make_set(const char *shown, shape_grid *grid, const shape_frame *frame)
{
    shape_error error;
    size_t index;
    char name[SHAPE_NAME_MAX + 1];
    cli_bare_name(shown, "volume", name);
    grid->gain = (float)cli_volume_values.density_gain;
    shape_set *set = shape_set_create(&error);
    if (!set)
        cli_fail("%s", error.text);
    cli_check(shape_set_add_grid(set, name, grid, frame, &index, &error), &error);
    cli_medium_apply(&set->clouds[index]);
    cli_check(shape_set_check(set, &error), &error);
    return set;
}

shape_set *cli_read_volume(const char *path)
{
    shape_error error;
    shape_frame frame;
    unsigned char start[16], *bytes;
    size_t whole, size = read_start(path, start, sizeof start, &whole);
    if (shape_vdb_is(start, size) || cli_has_suffix(path, ".vdb"))
        return make_set(path, read_vdb(path, path, &frame), &frame);
    cli_check(shape_file_read(path, (size_t)cli_volume_values.max_memory, &bytes, &size, &error), &error);
    shape_grid *grid = decode_raw(path, bytes, size, &frame);
    free(bytes);
    return make_set(path, grid, &frame);
}

/* OpenVDB wants a file. */
static void write_copy(char *path, const void *bytes, size_t size)
{
    const char *folder = getenv("TMPDIR");
    snprintf(path, 4096, "%s/nephele-XXXXXX", folder && *folder ? folder : "/tmp");
    int file = mkstemp(path);
    FILE *copy = file >= 0 ? fdopen(file, "wb") : NULL;
    if (!copy || fwrite(bytes, 1, size, copy) != size || fclose(copy)) {
        if (file >= 0)
            unlink(path);
        cli_fail("%s: cannot write a copy of the input there", path);
    }
}

bool cli_is_volume_bytes(const void *bytes, size_t size)
{
    return shape_vdb_is(bytes, size) || shape_volume_raw_is(bytes, size);
}

shape_set *cli_read_volume_bytes(const char *shown, const void *bytes, size_t size)
{
    shape_frame frame;
    char path[4096];
    shape_grid *grid;
    if (shape_vdb_is(bytes, size)) {
        write_copy(path, bytes, size);
        grid = read_vdb(path, shown, &frame);
    } else {
        grid = decode_raw(shown, bytes, size, &frame);
    }
    return make_set(shown, grid, &frame);
}

cli_input cli_volume_input_read(const char *path)
{
    shape_error error;
    unsigned char *bytes;
    size_t size;
    cli_input input = {.path = path, .volume = true};
    if (cli_is_volume(path)) {
        input.set = cli_read_volume(path);
    } else {
        cli_check(shape_file_read(path, (size_t)cli_volume_values.max_memory, &bytes, &size, &error), &error);
        if (cli_is_volume_bytes(bytes, size)) {
            input.set = cli_read_volume_bytes(strcmp(path, "-") ? path : "standard input", bytes, size);
            cli_note_input(path, bytes, size);
        } else {
            cli_refuse_volume_options();
            input = cli_input_decode(path, bytes, size);
        }
        free(bytes);
    }
    if (input.volume && cli_save_wanted())
        cli_fail("%s: a scene holds no volume (make primitives of it by neph-vdb first)", path);
    return input;
}

void cli_refuse_volume_options(void)
{
    const char *name = cli_given_of(cli_volume_options);
    name = name ? name : cli_given_of(cli_volume_colour_options);
    name = name ? name : cli_given_of(cli_optics_options);
    if (name)
        cli_wrong("--%s belongs to volumes, .vdb or raw (for a .neph use neph-edit)", name);
}
