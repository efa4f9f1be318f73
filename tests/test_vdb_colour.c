/* Colours from the grids of an OpenVDB file: what our own writer puts there comes back, at the voxels of the density, from a
 * grid of the same voxels, of others, and from three grids of numbers; and what does not fit is refused. */
#include <stdio.h>
#include <unistd.h>

#include "grid_sample.h"

#include "shape/file.h"
#include "shape/vdb.h"
#include "shape/vdb_read.h"

enum { EDGE = 8, VOXELS = EDGE * EDGE * EDGE };

static char path[] = "/tmp/test_vdb_colour.XXXXXX";

/* What a voxel of a brick holds; channel is 0 in grids of numbers. */
typedef double (*formula)(int channel, int x, int y, int z);

/* One brick of voxels from `first` on. */
static void add_grid(shape_vdb *file, const char *name, double edge, double origin, bool vector,
                     formula value)
{
    shape_error error;
    shape_vdb_grid *grid;
    const int32_t first[3] = {0, 0, 0};
    float values[3 * VOXELS];
    shape_vdb_options options = {
        .name = name, .edge = edge, .origin = {origin, origin, origin}, .vector = vector};
    for (int c = 0; c < 3; c++)
        for (int x = 0; x < EDGE; x++)
            for (int y = 0; y < EDGE; y++)
                for (int z = 0; z < EDGE; z++)
                    values[c * VOXELS + (x * EDGE + y) * EDGE + z] = (float)value(c, x, y, z);
    must(shape_vdb_add(file, &options, &grid, &error), &error);
    assert_true(shape_vdb_put_brick(grid, first, values));
}

static void save(shape_vdb *file)
{
    shape_error error;
    unsigned char *bytes;
    size_t size;
    must(shape_vdb_encode(file, SHAPE_VDB_OPENVDB, &bytes, &size, &error), &error);
    must(shape_file_write(path, bytes, size, &error), &error);
    free(bytes);
    shape_vdb_destroy(file);
}

static shape_status read_colour(const char *colour, shape_vdb_contents *contents, shape_error *error)
{
    shape_vdb_read_options options = shape_vdb_read_defaults();
    options.colour = colour;
    /* Beside three colours of numbers the density is the only one left. */
    options.grid = colour && !strchr(colour, ',') ? "density" : NULL;
    options.y_up = true;
    return shape_vdb_read(path, &options, contents, error);
}

static shape_grid *read_good(const char *colour)
{
    shape_error error;
    shape_vdb_contents contents;
    must(read_colour(colour, &contents, &error), &error);
    assert_true(contents.grid->coloured);
    assert_string_equal(contents.name, "density");
    return contents.grid;
}

/* Density and colours stand where x is below 5. */
static double fog(int channel, int x, int y, int z)
{
    (void)channel, (void)y, (void)z;
    return x < 5 ? 0.5 : 0;
}
static double ramp(int channel, int x, int y, int z)
{
    return x < 5 ? (channel + 1) * 0.01 * (1 + x) + 0.1 * y + z : 0;
}
static double red_ramp(int channel, int x, int y, int z)
{
    (void)channel;
    return ramp(0, x, y, z);
}
static double green_ramp(int channel, int x, int y, int z)
{
    (void)channel;
    return ramp(1, x, y, z);
}
static double nothing_but_one(int channel, int x, int y, int z)
{
    (void)channel;
    return x == 7 && y == 7 && z == 7; /* a voxel without density */
}
static double orange(int channel, int x, int y, int z)
{
    (void)y, (void)z;
    return x < 5 ? channel == 0 ? 0.75 : channel == 1 ? 0.5 : 0 : 0;
}
/* A line along the world's axes, so trilinear is exact: half as fine as the density. */
static double coarse(int channel, int x, int y, int z)
{
    return 1 + 0.125 * channel + 2.0 * x + 4.0 * y + 8.0 * z;
}
static double broken(int channel, int x, int y, int z)
{
    return channel == 1 && x == 2 && y == 3 && z == 4 ? (double)NAN : 1;
}

static void make_file(void)
{
    shape_vdb *file = shape_vdb_create();
    assert_non_null(file);
    add_grid(file, "density", 0.5, 3, false, fog);
    add_grid(file, "Cd", 0.5, 3, true, ramp);
    add_grid(file, "orange", 0.5, 3, true, orange);
    add_grid(file, "coarse", 1, 3, true, coarse);
    add_grid(file, "broken", 0.5, 3, true, broken);
    add_grid(file, "r", 0.5, 3, false, red_ramp);
    add_grid(file, "g", 0.5, 3, false, green_ramp);
    add_grid(file, "b", 0.5, 3, false, nothing_but_one);
    save(file);
}

/* Point p of the grid that is read is voxel p - 1: one of nothing stands around the active ones. */
static void assert_colour(const shape_grid *grid, double x, double y, double z, double r, double g, double b)
{
    float rgb[3];
    shape_grid_colour(grid, shape_vec3_make((float)x + 1, (float)y + 1, (float)z + 1), rgb);
    if (!(fabs((double)rgb[0] - r) < 1e-5 && fabs((double)rgb[1] - g) < 1e-5 &&
          fabs((double)rgb[2] - b) < 1e-5))
        fail_msg("at %g, %g, %g: %g, %g, %g, not %g, %g, %g", x, y, z, (double)rgb[0], (double)rgb[1],
                 (double)rgb[2], r, g, b);
}

static void colours_come_back_at_their_voxels(void **state)
{
    (void)state;
    shape_grid *grid = read_good("Cd");
    for (int x = 0; x < 5; x++)
        for (int y = 0; y < EDGE; y++)
            for (int z = 0; z < EDGE; z++)
                assert_colour(grid, x, y, z, ramp(0, x, y, z), ramp(1, x, y, z), ramp(2, x, y, z));
    shape_grid_release(grid);
}

/* Where the density falls to 0 between the last voxel and the next, the colour does not fall with it. */
static void rims_keep_their_colour(void **state)
{
    (void)state;
    shape_grid *grid = read_good("orange");
    assert_null(grid->colour[2]); /* nothing but 0 */
    assert_colour(grid, 4.5, 3, 3, 0.75, 0.5, 0);
    assert_colour(grid, 4.99, 3.3, 3.7, 0.75, 0.5, 0);
    assert_colour(grid, -0.9, -0.9, 7.9, 0.75, 0.5, 0);
    shape_grid_release(grid);
}

static void another_transform_is_looked_up(void **state)
{
    (void)state;
    shape_grid *grid = read_good("coarse");
    for (int x = 0; x < 5; x++)
        for (int y = 0; y < EDGE; y++)
            for (int z = 0; z < EDGE; z++) {
                double line = 1 + x + 2 * y + 4 * z;
                assert_colour(grid, x, y, z, line, line + 0.125, line + 0.25);
            }
    shape_grid_release(grid);
}

/* The third grid has no active voxel near, so its background counts: 0. */
static void three_grids_make_a_colour(void **state)
{
    (void)state;
    shape_grid *grid = read_good("g,r,b");
    assert_colour(grid, 2, 3, 4, ramp(1, 2, 3, 4), ramp(0, 2, 3, 4), 0);
    assert_colour(grid, 0, 7, 1, ramp(1, 0, 7, 1), ramp(0, 0, 7, 1), 0);
    shape_grid_release(grid);
}

static void what_does_not_fit_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *colour, *said;
    } all[] = {{"absent", "no grid of vectors called \"absent\""},
               {"", "no grid of vectors called \"\""},
               {"density", "no grid of vectors called \"density\""},
               {"r,g", "2 colour grids"},
               {"r,g,Cd", "no grid of numbers called \"Cd\""},
               {"r,g,", "no grid of numbers called \"\""},
               {"r,g,b,b", "4 colour grids"},
               {"broken", "not finite"},
               {NULL, "choose one with --grid"}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        shape_error error;
        shape_vdb_contents contents;
        assert_int_equal(read_colour(all[i].colour, &contents, &error), SHAPE_ERROR_FORMAT);
        if (!strstr(error.text, all[i].said))
            fail_msg("\"%s\" does not say \"%s\"", error.text, all[i].said);
        assert_null(contents.grid);
    }
}

static int begin(void **state)
{
    (void)state;
    int file = mkstemp(path);
    if (file < 0)
        return 1;
    close(file);
    make_file();
    return 0;
}

static int end(void **state)
{
    (void)state;
    return unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(colours_come_back_at_their_voxels), cmocka_unit_test(rims_keep_their_colour),
        cmocka_unit_test(another_transform_is_looked_up),    cmocka_unit_test(three_grids_make_a_colour),
        cmocka_unit_test(what_does_not_fit_is_refused),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
