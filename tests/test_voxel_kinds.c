/* What voxels can hold besides density: metaballs' distance and profile, the blend of details, samples of three channels; sinks
 * without memory, requests out of range; and a fit of spheroids to voxels, which takes these back into primitives. */
#include "volume_sample.h"

#include "shape/volumefit.h"
#include "shape/voxels.h"

enum { SIDE = 64 }; /* voxels kept along each axis, from -8 on */

/* A sink that keeps all voxels, and fails after so many calls where asked to. */
typedef struct kept {
    float *values[3];
    bool filled[SIDE / 8][SIDE / 8][SIDE / 8];
    int channels, bricks, tiles;
    int bricks_left, tiles_left; /* before one fails; below 0: none does */
} kept;

static void keep(kept *k, const int32_t first[3], int edge, const float *values, float one)
{
    for (int c = 0; c < k->channels; c++)
        for (int x = 0; x < edge; x++)
            for (int y = 0; y < edge; y++)
                for (int z = 0; z < edge; z++) {
                    int at[3] = {first[0] + x + 8, first[1] + y + 8, first[2] + z + 8};
                    assert_true(at[0] >= 0 && at[1] >= 0 && at[2] >= 0 && at[0] < SIDE && at[1] < SIDE &&
                                at[2] < SIDE);
                    k->filled[at[0] / 8][at[1] / 8][at[2] / 8] = true;
                    k->values[c][(at[0] * SIDE + at[1]) * SIDE + at[2]] =
                        values ? values[c * SHAPE_VOXEL_BRICK + (x * 8 + y) * 8 + z] : one;
                }
}

static bool keep_brick(void *context, const int32_t first[3], const float *values)
{
    kept *k = context;
    keep(k, first, SHAPE_VOXEL_EDGE, values, 0);
    k->bricks++;
    return k->bricks_left < 0 || k->bricks_left-- > 0;
}

static bool keep_tile(void *context, const int32_t first[3], int32_t edge, float value)
{
    kept *k = context;
    keep(k, first, edge, NULL, value);
    k->tiles++;
    return k->tiles_left < 0 || k->tiles_left-- > 0;
}

static kept new_kept(int channels)
{
    kept k = {.channels = channels, .bricks_left = -1, .tiles_left = -1};
    for (int c = 0; c < channels; c++) {
        k.values[c] = calloc(SIDE * SIDE * SIDE, sizeof(float));
        assert_non_null(k.values[c]);
    }
    return k;
}

static void free_kept(kept *k)
{
    for (int c = 0; c < 3; c++)
        free(k->values[c]);
}

static shape_voxel_lattice lattice_of(const shape_volume *volume, int cells)
{
    shape_error error;
    double min[3], max[3], longest = 0;
    bool any;
    shape_voxel_lattice lattice;
    must(shape_voxels_bounds(volume, -1, false, min, max, &any, &error), &error);
    assert_true(any);
    for (int k = 0; k < 3; k++)
        longest = fmax(longest, max[k] - min[k]);
    must(shape_voxels_lay_out(min, max, longest / cells, false, &lattice, &error), &error);
    return lattice;
}

static shape_status fill(const shape_volume *volume, const shape_voxel_lattice *lattice,
                         const shape_voxel_request *request, kept *k, shape_error *error)
{
    shape_voxel_request one = *request;
    const shape_voxel_sink sink = {k, keep_brick, keep_tile};
    one.threads = 1; /* the sink counts */
    return shape_voxels_fill(volume, lattice, &one, &sink, error);
}

static kept fill_good(const shape_volume *volume, const shape_voxel_lattice *lattice,
                      shape_voxel_quantity quantity)
{
    shape_error error;
    shape_voxel_request request = shape_voxel_request_defaults();
    kept k = new_kept(1);
    request.quantity = quantity;
    must(fill(volume, lattice, &request, &k, &error), &error);
    return k;
}

static float at(const kept *k, const int32_t i[3])
{
    return k->values[0][((i[0] + 8) * SIDE + i[1] + 8) * SIDE + i[2] + 8];
}

/* Of one metaball the field is a power of the distance: its bound is a sphere of radius R, from which first order tells the
 * distance, d - R; and the profile falls from 1 in the middle to 0 there, in proportion. Tolerances: a gradient by differences
 * of a thousandth of the ball. */
static void metaballs_have_a_distance(void **state)
{
    (void)state;
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_METABALL);
    add_sphere(set, 0, 0, 0, 0, 2);
    shape_volume *volume = new_volume(set);
    shape_voxel_lattice lattice = lattice_of(volume, 40);
    kept distance = fill_good(volume, &lattice, SHAPE_VOXEL_SDF),
         profile = fill_good(volume, &lattice, SHAPE_VOXEL_PROFILE);
    double band = 3 * lattice.edge, radius = 0;
    size_t seen = 0, inside = 0;
    int32_t i[3];
    for (int pass = 0; pass < 2; pass++)
        for (i[0] = 0; i[0] < 40; i[0]++)
            for (i[1] = 0; i[1] < 40; i[1]++)
                for (i[2] = 0; i[2] < 40; i[2]++) {
                    double d = shape_dvec3_length(shape_voxel_point(&lattice, i)),
                           s = (double)at(&distance, i);
                    if (!distance.filled[(i[0] + 8) / 8][(i[1] + 8) / 8][(i[2] + 8) / 8] ||
                        fabs(s) > 0.99 * band)
                        continue;
                    if (!pass) {
                        radius += d - s;
                        seen++;
                        continue;
                    }
                    double mean = radius / (double)seen;
                    assert_true(fabs(d - s - mean) < 5e-3 * mean);
                    if (s < 0) {
                        assert_true(fabs((double)at(&profile, i) - (1 - d / mean)) < 1e-2);
                        inside++;
                    }
                }
    assert_true(seen > 1000 && inside > 300);
    free_kept(&distance);
    free_kept(&profile);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* By height alone without details; with billows alone or wisps alone, what there is of them. */
static void details_are_told_apart(void **state)
{
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        shape_set *set = new_set();
        shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_SPHEROID);
        cloud->field.detail.billow = kind & 1 ? 0.5f : 0;
        cloud->field.detail.wisp = kind & 2 ? 0.5f : 0;
        add_sphere(set, 0, 0, 0, 0, 2);
        shape_volume *volume = new_volume(set);
        shape_voxel_lattice lattice = lattice_of(volume, 40);
        kept k = fill_good(volume, &lattice, SHAPE_VOXEL_DETAIL_TYPE);
        int32_t i[3] = {20, 0, 20};
        for (i[1] = 4; i[1] < 36; i[1]++) {
            /* The blend goes from a tenth to three tenths of the height, from -2 to 2. */
            double y = shape_voxel_point(&lattice, i).y, h = fmin(fmax(((y + 2) / 4 - 0.1) * 5, 0), 1);
            double height = h * h * (3 - 2 * h);
            double wanted = kind == 1 ? (height > 0) : kind == 2 ? 0 : height;
            assert_true(fabs((double)at(&k, i) - wanted) < 1e-5 || (kind == 1 && height < 1e-6));
        }
        free_kept(&k);
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
}

/* A colour that is none below a height: bricks there are left out. */
static void sample_above(const void *context, size_t cloud, shape_vec3 p, float value[3])
{
    assert_int_equal(cloud, 0);
    const int channel = *(const int *)context;
    for (int c = 0; c < 3; c++)
        value[c] = c == channel && p.y > 0 ? 0.5f + p.y : 0;
}

static void samples_have_three_channels(void **state)
{
    (void)state;
    shape_error error;
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_UNIFORM);
    add_sphere(set, 0, 0, 0, 0, 2);
    shape_volume *volume = new_volume(set);
    shape_voxel_lattice lattice = lattice_of(volume, 40);
    for (int channel = 0; channel < 4; channel++) { /* 3: none at all */
        shape_voxel_request request = shape_voxel_request_defaults();
        kept k = new_kept(3);
        request.quantity = SHAPE_VOXEL_SAMPLE;
        request.sample = sample_above;
        request.sample_context = &channel;
        must(fill(volume, &lattice, &request, &k, &error), &error);
        assert_int_equal(k.tiles, 0);
        assert_int_equal(k.bricks > 0, channel < 3);
        int32_t i[3] = {20, 30, 20};
        for (int c = 0; c < 3; c++) {
            float found = k.values[c][((i[0] + 8) * SIDE + i[1] + 8) * SIDE + i[2] + 8];
            float wanted = c == channel ? 0.5f + (float)shape_voxel_point(&lattice, i).y : 0;
            assert_true(fabsf(found - wanted) < 1e-4f);
        }
        for (int x = 0; x < SIDE / 8; x++)
            for (int z = 0; z < SIDE / 8; z++)
                assert_false(k.filled[x][1][z]); /* voxels 0 to 7 of 40: below the middle */
        free_kept(&k);
    }
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* --- what fails --- */

static void sinks_may_run_out(void **state)
{
    (void)state;
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_UNIFORM);
    add_sphere(set, 0, 0, 0, 0, 2);
    shape_volume *volume = new_volume(set);
    shape_voxel_lattice lattice = lattice_of(volume, 40);
    shape_voxel_request request = shape_voxel_request_defaults();
    for (int kind = 0; kind < 2; kind++) {
        shape_error error = {.text = ""};
        kept k = new_kept(1);
        assert_int_equal(fill(volume, &lattice, &request, &k, &error), SHAPE_OK);
        int whole = k.bricks + k.tiles;
        k.bricks = k.tiles = 0;
        *(kind ? &k.tiles_left : &k.bricks_left) = 1;
        assert_int_equal(fill(volume, &lattice, &request, &k, &error), SHAPE_ERROR_MEMORY);
        assert_true((kind ? k.tiles : k.bricks) >= 2 && k.bricks + k.tiles < whole); /* it ends soon after */
        free_kept(&k);
    }
    /* Counting stops above what was asked for. */
    shape_error error;
    size_t all, some;
    request.threads = 1;
    must(shape_voxels_count(volume, &lattice, &request, SIZE_MAX, &all, &error), &error);
    must(shape_voxels_count(volume, &lattice, &request, 10, &some, &error), &error);
    assert_true(all > 20 && some > 10 && some < all);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

static void requests_have_ranges(void **state)
{
    (void)state;
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_UNIFORM);
    new_cloud(set, SHAPE_MODEL_SPHEROID);
    add_sphere(set, 0, 0, 0, 0, 2);
    add_sphere(set, 1, 1, 0, 0, 1);
    set->clouds[0].medium.extinction = 0; /* nothing to see: its weight is not divided by 0 */
    shape_volume *volume = new_volume(set);
    shape_voxel_lattice lattice = lattice_of(volume, 30);
    const struct {
        double ramp, band;
        int cloud;
        const char *words; /* NULL: taken */
    } cases[] = {{0, 3, -1, NULL},
                 {1e6, 3, 0, NULL},
                 {-1e-9, 3, 0, "a ramp of"},
                 {1.001e6, 3, 0, "a ramp of"},
                 {NAN, 3, 0, "a ramp of"},
                 {0, 1e6, 0, NULL},
                 {0, 0, 0, "a band of"},
                 {0, 1.001e6, 0, "a band of"},
                 {0, NAN, 0, "a band of"},
                 {1, 3, -1, "a ramp is for uniform"},
                 {1, 3, 1, "a ramp is for uniform"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        shape_error error = {.text = ""};
        shape_voxel_request request = shape_voxel_request_defaults();
        kept k = new_kept(1);
        request.ramp = cases[i].ramp;
        request.band = cases[i].band;
        request.cloud = cases[i].cloud;
        shape_status status = fill(volume, &lattice, &request, &k, &error);
        assert_int_equal(status, cases[i].words ? SHAPE_ERROR_ARGUMENT : SHAPE_OK);
        if (cases[i].words)
            assert_non_null(strstr(error.text, cases[i].words));
        for (int v = 0; v < SIDE * SIDE * SIDE; v++)
            assert_true(isfinite(k.values[0][v]));
        free_kept(&k);
    }
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* --- a fit of spheroids --- */

static bool stop_at_half(void *context, double done)
{
    ++*(int *)context;
    return done < 0.5;
}

/* Spheroids' noise eats their edges, so that they are grown; the fit still stands for the ball: its integral of extinction is
 * kept to what eight samples a cell tell of it (5 %). Broken off half way it gives a cloud, too. */
static void spheroids_are_fitted(void **state)
{
    (void)state;
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_UNIFORM);
    set->clouds[0].medium.extinction = 2;
    add_sphere(set, 0, 3, 0, 0, 2);
    add_sphere(set, 0, 5, 1, 0, 1);
    shape_volume *volume = new_volume(set);
    for (int kind = 0; kind < 3; kind++) {
        shape_error error;
        shape_volumefit_report report;
        shape_volumefit_options options = shape_volumefit_defaults();
        int calls = 0;
        shape_set *fitted = new_set();
        options.primitives = 10;
        options.resolution = 16;
        options.rounds = 8;
        options.model = kind == 2 ? SHAPE_MODEL_UNIFORM : SHAPE_MODEL_SPHEROID;
        options.error = kind == 1 ? 0 : 0.9; /* soon met */
        options.progress = kind == 1 ? stop_at_half : NULL;
        options.progress_context = &calls;
        must(shape_volumefit(volume, &options, fitted, "fit", NULL, &report, &error), &error);
        must(shape_set_check(fitted, &error), &error);
        assert_int_equal(fitted->clouds[0].field.model, options.model);
        assert_in_range(report.primitives, 1, options.primitives);
        assert_int_equal(report.primitives, shape_primitives_count(shape_set_list(fitted, 0)));
        assert_true(report.reached && report.overlap > 0.3 && report.overlap <= 1);
        assert_true(kind != 1 || (calls > 3 && calls < 8));
        assert_true(kind == 1 || report.error <= 0.9);
        shape_set_destroy(fitted);
    }
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(metaballs_have_a_distance),   cmocka_unit_test(details_are_told_apart),
        cmocka_unit_test(samples_have_three_channels), cmocka_unit_test(sinks_may_run_out),
        cmocka_unit_test(requests_have_ranges),        cmocka_unit_test(spheroids_are_fitted)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
