/* OpenVDB files: what frozen ones hold (tests/frozen/vdb, written by OpenVDB 10 itself), and that no damage to a file
 * gives more than one line. */
#include <stdio.h>
#include <unistd.h>

#include "grid_sample.h"

#include "shape/file.h"
#include "shape/vdb_read.h"

#define FROZEN TEST_DATA "/frozen/vdb/"

static shape_vdb_contents read_frozen(const char *name, const shape_vdb_read_options *options)
{
    char path[512];
    shape_error error;
    shape_vdb_contents contents;
    snprintf(path, sizeof path, FROZEN "%s", name);
    must(shape_vdb_read(path, options, &contents, &error), &error);
    return contents;
}

/* Voxel (i, j, k) of the files holds (1 + i + 10 j + 100 k) / 1000, counted from voxel -3, 100, -5000; their transform is
 * x = i / 2 + 3, y = i / 10 + j / 4 + k / 5 - 2, z = k + 7. Halves have 11 bits. */
static void check_ramp(const shape_vdb_contents *contents, double tolerance, bool y_up)
{
    assert_string_equal(contents->name, "density");
    for (int k = 0; k < 4; k++)
        for (int j = 0; j < 5; j++)
            for (int i = 0; i < 6; i++) {
                double wanted = (1 + i + 10 * j + 100 * k) / 1000.0;
                int a = i - 3, b = j + 100, c = k - 5000;
                shape_dvec3 file = {0.5 * a + 3, 0.1 * a + 0.25 * b + 0.2 * c - 2, c + 7.0};
                shape_dvec3 world = y_up ? file : shape_dvec3_make(file.x, file.z, -file.y);
                shape_frame back;
                assert_true(shape_frame_invert(&contents->frame, &back));
                shape_dvec3 p = shape_frame_point(&back, world);
                shape_vec3 q = {(float)p.x, (float)p.y, (float)p.z};
                assert_true(fabs((double)shape_grid_sample(contents->grid, q) - wanted) <=
                            tolerance * wanted + 1e-6);
            }
    assert_true(fabs((double)contents->grid->most - 0.346) <= tolerance * 0.346 + 1e-7);
}

static void voxels_and_transforms_are_read(void **state)
{
    (void)state;
    shape_vdb_read_options options = shape_vdb_read_defaults();
    shape_vdb_contents contents = read_frozen("fog.vdb", &options);
    check_ramp(&contents, 0, false);
    shape_grid_release(contents.grid);
    options.y_up = true;
    contents = read_frozen("fog.vdb", &options);
    check_ramp(&contents, 0, true);
    shape_grid_release(contents.grid);
    options.y_up = false;
    contents = read_frozen("half.vdb", &options);
    check_ramp(&contents, 1.0 / 2048, false);
    shape_grid_release(contents.grid);
    contents = read_frozen("double.vdb", &options);
    check_ramp(&contents, 0, false);
    shape_grid_release(contents.grid);
}

/* A tile of 40^3 voxels of a quarter: its sum is exact in floats, and most of its bricks are one. */
static void tiles_are_read(void **state)
{
    (void)state;
    shape_vdb_read_options options = shape_vdb_read_defaults();
    shape_vdb_contents contents = read_frozen("tiles.vdb", &options);
    assert_true(shape_grid_sum(contents.grid) == 16000);
    assert_true(contents.grid->brick_count < 6 * 6 * 6);
    shape_grid_release(contents.grid);
}

/* A level set of a ball of radius 1, an eighth a voxel, at (2, 0, 0) of its file: 0 at the surface, 1 from three voxels
 * inside on. Interpolated between voxels to 0.02; where the ramp begins and ends, to a third of what a voxel makes. */
static void level_sets_become_fog(void **state)
{
    (void)state;
    shape_vdb_read_options options = shape_vdb_read_defaults();
    shape_vdb_contents contents = read_frozen("levelset.vdb", &options);
    shape_set *set = new_set();
    shape_error error;
    assert_true(contents.level_set);
    must(shape_set_add_grid(set, "ball", contents.grid, &contents.frame, NULL, &error), &error);
    set->clouds[0].medium.extinction = 1;
    shape_volume *volume = new_volume(set);
    shape_random random = shape_random_seed(1, 0);
    for (int i = 0; i < 2000; i++) {
        shape_vec3 d = draw_direction(&random);
        double r = shape_random_range(&random, 0, 1.3), wanted = fmin(fmax((1 - r) / 0.375, 0), 1);
        shape_dvec3 p = {2 + r * (double)d.x, r * (double)d.y, r * (double)d.z};
        bool bend = fabs(r - 1) < 0.15 || fabs(r - 0.625) < 0.15;
        assert_true(fabs(shape_volume_extinction(volume, p) - wanted) <= (bend ? 0.11 : 0.02));
    }
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

static void refused(const char *name, const shape_vdb_read_options *options, const char *words)
{
    char path[512];
    shape_error error;
    shape_vdb_contents contents;
    snprintf(path, sizeof path, FROZEN "%s", name);
    assert_int_not_equal(shape_vdb_read(path, options, &contents, &error), SHAPE_OK);
    assert_non_null(strstr(error.text, name));
    if (!strstr(error.text, words))
        fail_msg("\"%s\" does not say \"%s\"", error.text, words);
    assert_null(strchr(error.text, '\n'));
}

static void unfit_files_are_refused(void **state)
{
    (void)state;
    shape_vdb_read_options options = shape_vdb_read_defaults();
    refused("empty.vdb", &options, "empty");
    refused("nogrid.vdb", &options, "no grid");
    refused("nan.vdb", &options, "not finite");
    refused("vector.vdb", &options, "velocity (vec3s)");
    refused("several.vdb", &options, "density, heat (choose one with --grid NAME)");
    refused("absent.vdb", &options, "cannot read");
    options.grid = "heat";
    shape_vdb_contents contents = read_frozen("several.vdb", &options);
    assert_string_equal(contents.name, "heat");
    shape_grid_release(contents.grid);
    options.grid = "pressure";
    refused("several.vdb", &options, "pressure");
    options.grid = NULL;
    options.max_bytes = 1000;
    refused("tiles.vdb", &options, "--max-memory");
}

/* --- damage --- */

typedef struct sample {
    unsigned char *bytes;
    size_t size;
    char path[512];
} sample;

static sample load_sample(const char *name)
{
    char path[512];
    shape_error error;
    sample s;
    snprintf(path, sizeof path, FROZEN "%s", name);
    must(shape_file_read(path, 1 << 24, &s.bytes, &s.size, &error), &error);
    const char *temporary = getenv("TMPDIR");
    int length = snprintf(s.path, sizeof s.path, "%s/nephele-vdb-XXXXXX",
                          temporary && *temporary ? temporary : "/tmp");
    assert_in_range(length, 1, sizeof s.path - 1);
    int file = mkstemp(s.path);
    assert_true(file >= 0);
    close(file);
    return s;
}

/* Writes the first n bytes and reads them as a volume: an error of one line, or a sound grid. */
static shape_status try_bytes(const sample *s, size_t n)
{
    shape_error error = {0};
    shape_vdb_contents contents;
    shape_vdb_read_options options = shape_vdb_read_defaults();
    options.max_bytes = (size_t)64 << 20;
    FILE *file = fopen(s->path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(s->bytes, 1, n, file), n);
    fclose(file);
    shape_status status = shape_vdb_read(s->path, &options, &contents, &error);
    if (status) {
        assert_true(strlen(error.text) > 10 && !strchr(error.text, '\n'));
        return status;
    }
    assert_true(contents.grid->most > 0 && isfinite(contents.grid->most));
    shape_grid_release(contents.grid);
    return SHAPE_OK;
}

static void free_sample(sample *s)
{
    unlink(s->path);
    free(s->bytes);
}

static void truncated_files_are_refused(void **state)
{
    (void)state;
    sample s = load_sample("fog.vdb");
    for (size_t n = 0; n < s.size; n += n < 16 ? 1 : s.size / 40)
        assert_int_not_equal(try_bytes(&s, n), SHAPE_OK);
    assert_int_equal(try_bytes(&s, s.size), SHAPE_OK);
    free_sample(&s);
}

static void other_versions_are_refused(void **state)
{
    (void)state;
    sample s = load_sample("fog.vdb");
    for (int version = 0; version < 256; version += 5) {
        s.bytes[8] = (unsigned char)version;
        if (version < 213 || version > 224)
            assert_int_equal(try_bytes(&s, s.size), SHAPE_ERROR_FORMAT);
    }
    free_sample(&s);
}

static void flipped_bits_do_no_harm(void **state)
{
    (void)state;
    sample s = load_sample("fog.vdb");
    shape_random random = shape_random_seed(9, 0);
    for (int i = 0; i < 50; i++) {
        /* Half of them within the head and the grid's description. */
        size_t room = i % 2 ? s.size : 900, at = (size_t)(shape_random_unit(&random) * (double)room);
        unsigned char bit = (unsigned char)(1u << (shape_random_u32(&random) & 7));
        s.bytes[at] ^= bit;
        try_bytes(&s, s.size);
        s.bytes[at] ^= bit;
    }
    free_sample(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(voxels_and_transforms_are_read), cmocka_unit_test(tiles_are_read),
        cmocka_unit_test(level_sets_become_fog),          cmocka_unit_test(unfit_files_are_refused),
        cmocka_unit_test(truncated_files_are_refused),    cmocka_unit_test(other_versions_are_refused),
        cmocka_unit_test(flipped_bits_do_no_harm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
