/* A second reader of .neph files, written from docs/neph-format.md alone: it shares no code with libshape/file, knows
 * nothing but the offsets of the page, and finds in the bytes what the library put there. */
#include "neph_sample.h"

#include <float.h>
#include <math.h>

typedef struct bytes {
    const unsigned char *at;
    uint64_t size;
} bytes;

/* A number of `width` bytes, least significant first; the file must hold it. */
static uint64_t number(bytes file, uint64_t offset, unsigned width)
{
    assert_true(offset <= file.size && width <= file.size - offset);
    uint64_t value = 0;
    for (unsigned i = width; i > 0; i--)
        value = value * 256 + file.at[offset + i - 1];
    return value;
}

/* IEEE 754 by its definition, without a look at this machine's floats. */
static double real(bytes file, uint64_t offset, unsigned width)
{
    uint64_t bits = number(file, offset, width);
    int fraction_bits = width == 4 ? 23 : 52, bias = width == 4 ? 127 : 1023;
    uint64_t fraction = bits & ((UINT64_C(1) << fraction_bits) - 1);
    int exponent = (int)(bits >> fraction_bits & (width == 4 ? 255 : 2047));
    int sign = bits >> (8 * width - 1) ? -1 : 1;
    assert_true(exponent < (width == 4 ? 255 : 2047)); /* finite */
    double mantissa = (double)fraction;
    if (exponent)
        mantissa += ldexp(1, fraction_bits);
    else
        exponent = 1;
    return sign * ldexp(mantissa, exponent - bias - fraction_bits);
}

static uint32_t crc_bit_by_bit(bytes file, uint64_t offset, uint64_t length)
{
    uint32_t crc = 0xffffffffu;
    assert_true(offset <= file.size && length <= file.size - offset);
    for (uint64_t i = 0; i < length; i++)
        for (int bit = 0; bit < 8; bit++) {
            uint32_t low = (crc ^ (uint32_t)file.at[offset + i] >> bit) & 1;
            crc = crc >> 1 ^ (low ? 0xedb88320u : 0);
        }
    return crc ^ 0xffffffffu;
}

static uint64_t align(uint64_t offset)
{
    return offset % 16 ? offset + 16 - offset % 16 : offset;
}

static void expect_padding(bytes file, uint64_t from)
{
    for (; from % 16; from++)
        assert_int_equal(number(file, from, 1), 0);
}

/* Header, table, places and CRCs; returns the number of chunks. */
static uint64_t read_frame(bytes file)
{
    const unsigned char magic[8] = {0x89, 0x4e, 0x50, 0x48, 0x0d, 0x0a, 0x1a, 0x0a};
    assert_true(file.size >= 32);
    assert_memory_equal(file.at, magic, 8);
    assert_int_equal(number(file, 8, 2), 1);
    assert_true(number(file, 10, 2) <= 1);
    uint64_t chunks = number(file, 12, 4);
    assert_true(chunks >= 2);
    assert_true(number(file, 16, 8) == file.size);
    assert_true(number(file, 24, 8) == 0);
    assert_int_equal(number(file, 32 + 32 * chunks, 4), crc_bit_by_bit(file, 0, 32 + 32 * chunks));
    expect_padding(file, 36 + 32 * chunks);
    uint64_t next = align(36 + 32 * chunks);
    for (uint64_t i = 0; i < chunks; i++) {
        uint64_t row = 32 + 32 * i, offset = number(file, row + 16, 8), length = number(file, row + 24, 8);
        assert_true(offset == next);
        assert_int_equal(number(file, row + 12, 4), crc_bit_by_bit(file, offset, length));
        expect_padding(file, offset + length);
        next = align(offset + length);
    }
    assert_true(next == file.size);
    return chunks;
}

static void expect_text(bytes file, uint64_t text_row, uint64_t reference, const char *text)
{
    uint64_t start = number(file, text_row + 16, 8), room = number(file, text_row + 24, 8);
    uint64_t offset = number(file, reference, 4), length = number(file, reference + 4, 4);
    assert_true(offset + length <= room);
    assert_true(length == strlen(text));
    if (length)
        assert_memory_equal(file.at + start + offset, text, length);
}

static void expect_real(bytes file, uint64_t offset, float value)
{
    assert_true(real(file, offset, 4) == value);
}

static void expect_settings(bytes file, uint64_t record, const shape_cloud *cloud)
{
    const shape_field *field = &cloud->field;
    const shape_medium *medium = &cloud->medium;
    for (unsigned i = 0; i < 12; i++)
        assert_true(real(file, record + 8 * i, 8) == cloud->frame.m[i / 4][i % 4]);
    assert_true(number(file, record + 96, 8) == cloud->seed);
    assert_true(number(file, record + 104, 8) == field->seed);
    assert_int_equal(number(file, record + 136, 4), cloud->list);
    assert_int_equal(number(file, record + 156, 4), field->model);
    assert_int_equal(number(file, record + 160, 4), field->octaves);
    assert_int_equal(number(file, record + 164, 4), medium->phase);
    const float reals[9] = {field->kappa,       field->noise_scale, field->edge,
                            medium->extinction, medium->albedo,     medium->g,
                            medium->g2,         medium->lobe_mix,   medium->droplet};
    for (unsigned i = 0; i < 9; i++)
        expect_real(file, record + 168 + 4 * i, reals[i]);
    assert_int_equal(number(file, record + 204, 4), 0);
}

/* By how much a primitive (of a layer: its bounds) is grown. */
static double support_factor(const shape_field *field, size_t count)
{
    if (field->model == SHAPE_MODEL_METABALL)
        return sqrt((double)count);
    return field->model == SHAPE_MODEL_LAYER ? 1 : 1 + (double)field->detail.smoothness;
}

static double dip(double radius, double a, double b, double c)
{
    double h = fmax(radius - b, 0), w = fmax(a, c);
    return h - sqrt(fmax(h * h - w * w, 0));
}

static double support_margin(const shape_field *field, const shape_primitives *list)
{
    double most = 0, radius = (double)field->layer.planet_radius;
    for (size_t i = 0; i < list->sphere_count; i++)
        most = fmax(most, dip(radius, (double)list->spheres[i].radius, (double)list->spheres[i].radius, 0));
    for (size_t i = 0; i < list->ellipsoid_count; i++) {
        const shape_ellipsoid *e = &list->ellipsoids[i];
        most = fmax(most, dip(radius, (double)e->a, (double)e->b, (double)e->c));
    }
    return (double)field->detail.displace + (field->model == SHAPE_MODEL_LAYER && radius > 0 ? most : 0);
}

/* From the unit sphere to the bounds of a layer: the cube, or the cylinder along y. */
static void stretch_to_bounds(const shape_field *field, double *x, double *y, double *z)
{
    double r = sqrt(*x * *x + *z * *z), by = 1;
    if (field->model == SHAPE_MODEL_LAYER && field->layer.bounds == SHAPE_BOUNDS_BOX)
        by = fmax(fabs(*x), fmax(fabs(*y), fabs(*z)));
    if (field->model == SHAPE_MODEL_LAYER && field->layer.bounds == SHAPE_BOUNDS_ALTITUDES)
        by = fmax(fabs(*y), r);
    *x /= by, *y /= by, *z /= by;
}

/* The stored box holds points on every primitive's support, taken by the page's own formula. */
static void expect_box(bytes file, uint64_t record, const shape_cloud *cloud, const shape_primitives *list)
{
    double box[6], reach = 0;
    for (unsigned i = 0; i < 6; i++) {
        box[i] = real(file, record + 112 + 4 * i, 4);
        reach = fmax(reach, fabs(box[i]));
    }
    size_t count = list->sphere_count + list->ellipsoid_count;
    if (!count) {
        assert_true(box[0] == FLT_MAX && box[2] == FLT_MAX && box[3] == -FLT_MAX && box[5] == -FLT_MAX);
        return;
    }
    double grow = support_factor(&cloud->field, count), margin = support_margin(&cloud->field, list);
    if (cloud->field.model == SHAPE_MODEL_GRID)
        return;
    for (size_t i = 0; i < list->sphere_count; i++) {
        const shape_sphere *s = &list->spheres[i];
        const double centre[3] = {s->x, s->y, s->z};
        for (int axis = 0; axis < 3; axis++) {
            double half = grow * (double)s->radius + margin;
            assert_true(centre[axis] - half >= box[axis] - 1e-4 * reach);
            assert_true(centre[axis] + half <= box[axis + 3] + 1e-4 * reach);
        }
    }
    for (size_t i = 0; i < list->ellipsoid_count; i++) {
        const shape_ellipsoid *e = &list->ellipsoids[i];
        for (int step = 0; step < 64; step++) {
            double u = cos(step * 2.4) * sqrt(1 - pow(step / 31.5 - 1, 2)), w = step / 31.5 - 1;
            double v = sin(step * 2.4) * sqrt(1 - pow(step / 31.5 - 1, 2));
            stretch_to_bounds(&cloud->field, &u, &v, &w);
            shape_vec3 local = {(float)(grow * e->a * u), (float)(grow * e->b * v), (float)(grow * e->c * w)};
            shape_vec3 p = shape_quat_rotate(e->q, local);
            const double at[3] = {(double)(e->x + p.x), (double)(e->y + p.y), (double)(e->z + p.z)};
            for (int axis = 0; axis < 3; axis++)
                assert_true(at[axis] - margin >= box[axis] - 1e-4 * reach &&
                            at[axis] + margin <= box[axis + 3] + 1e-4 * reach);
        }
    }
}

static void expect_spheres(bytes file, uint64_t row, const shape_primitives *list)
{
    uint64_t offset = number(file, row + 16, 8);
    assert_true(number(file, row + 24, 8) == 16 * (uint64_t)list->sphere_count);
    for (size_t i = 0; i < list->sphere_count; i++, offset += 16) {
        expect_real(file, offset, list->spheres[i].x);
        expect_real(file, offset + 4, list->spheres[i].y);
        expect_real(file, offset + 8, list->spheres[i].z);
        expect_real(file, offset + 12, list->spheres[i].radius);
    }
}

static void expect_ellipsoids(bytes file, uint64_t row, const shape_primitives *list)
{
    uint64_t offset = number(file, row + 16, 8);
    assert_true(number(file, row + 24, 8) == 48 * (uint64_t)list->ellipsoid_count);
    for (size_t i = 0; i < list->ellipsoid_count; i++, offset += 48) {
        const shape_ellipsoid *e = &list->ellipsoids[i];
        const float reals[12] = {e->x, e->y, e->z, 0, e->a, e->b, e->c, 0, e->q.x, e->q.y, e->q.z, e->q.w};
        for (unsigned k = 0; k < 12; k++)
            expect_real(file, offset + 4 * k, reals[k]);
    }
}

static void expect_layer(bytes file, uint64_t record, const shape_field *field)
{
    const shape_detail *d = &field->detail;
    const shape_layer zeros = {0}, *l = field->model == SHAPE_MODEL_LAYER ? &field->layer : &zeros;
    const float reals[23] = {d->smoothness, d->displace,     d->displace_scale,   d->billow,
                             d->wisp,       d->detail_depth, d->detail_scale,     l->blend,
                             l->gain,       l->worley_gain,  l->worley_frequency, l->stretch[0],
                             l->stretch[1], l->stretch[2],   l->coverage,         l->cut,
                             l->ramp[0],    l->ramp[1],      l->falloff,          l->fade_bottom,
                             l->fade_top,   l->fade_side,    l->planet_radius};
    assert_int_equal(number(file, record + 4, 4), l->bounds);
    assert_int_equal(number(file, record + 8, 4), l->noise);
    assert_int_equal(number(file, record + 12, 4), l->worley_octaves);
    for (unsigned i = 0; i < 23; i++)
        expect_real(file, record + 16 + 4 * i, reals[i]);
    assert_int_equal(number(file, record + 108, 4), 0);
}

static void expect_layers(bytes file, uint64_t row, const shape_set *set)
{
    uint64_t offset = number(file, row + 16, 8), record = offset + 16, count = 0;
    assert_int_equal(number(file, row + 4, 4), 1);
    assert_int_equal(number(file, row + 8, 4), 0);
    assert_int_equal(number(file, offset, 4), 112);
    for (size_t i = 0; i < set->cloud_count; i++) {
        if (!needs_layer_record(&set->clouds[i].field))
            continue;
        assert_int_equal(number(file, record, 4), i);
        expect_layer(file, record, &set->clouds[i].field);
        record += 112;
        count++;
    }
    assert_true(number(file, offset + 4, 4) == count && number(file, row + 24, 8) == 16 + 112 * count);
}

static bool row_is(bytes file, uint64_t row, const char *type)
{
    return !memcmp(file.at + row, type, 4);
}

/* The chunks behind CLUD and TEXT, against the set's lists and extras. */
static void expect_chunks(bytes file, uint64_t chunks, const shape_set *set)
{
    size_t spheres = 0, ellipsoids = 0, extras = 0, last = 0, layers = 0;
    for (uint64_t row = 32 + 64; row < 32 + 32 * chunks; row += 32) {
        uint64_t parameter = number(file, row + 8, 4);
        if (row_is(file, row, "LAYR")) {
            expect_layers(file, row, set);
            layers++;
            continue;
        }
        if (row_is(file, row, "SPHR") || row_is(file, row, "ELLI")) {
            assert_int_equal(number(file, row + 4, 4), 1);
            assert_true(parameter >= last && parameter < set->list_count);
            last = (size_t)parameter;
            if (row_is(file, row, "SPHR")) {
                expect_spheres(file, row, &set->lists[parameter]);
                spheres += set->lists[parameter].sphere_count;
            } else {
                expect_ellipsoids(file, row, &set->lists[parameter]);
                ellipsoids += set->lists[parameter].ellipsoid_count;
            }
            continue;
        }
        assert_true(extras < set->extra_count);
        const shape_extra *extra = &set->extras[extras++];
        assert_true(row_is(file, row, extra->type));
        assert_int_equal(number(file, row + 4, 4), 0);
        assert_true(parameter == extra->list && number(file, row + 24, 8) == extra->size);
        if (extra->size)
            assert_memory_equal(file.at + number(file, row + 16, 8), extra->bytes, extra->size);
    }
    assert_true(extras == set->extra_count && layers == has_layer_record(set));
    assert_int_equal(number(file, 10, 2), layers);
    for (size_t i = 0; i < set->list_count; i++) {
        spheres -= set->lists[i].sphere_count;
        ellipsoids -= set->lists[i].ellipsoid_count;
    }
    assert_true(spheres == 0 && ellipsoids == 0); /* every list was met, once */
}

static void expect_set(bytes file, const shape_set *set)
{
    uint64_t chunks = read_frame(file);
    assert_true(row_is(file, 32, "CLUD") && row_is(file, 64, "TEXT"));
    assert_true(number(file, 32 + 4, 4) == 1 && number(file, 64 + 4, 4) == 1);
    uint64_t clouds = number(file, 32 + 16, 8), record_size = number(file, clouds, 4);
    assert_int_equal(record_size, 208);
    assert_int_equal(number(file, clouds + 4, 4), set->cloud_count);
    assert_int_equal(number(file, clouds + 8, 4), set->list_count);
    assert_true(number(file, 32 + 24, 8) == 16 + record_size * set->cloud_count);
    for (size_t i = 0; i < set->cloud_count; i++) {
        uint64_t record = clouds + 16 + record_size * i;
        const shape_cloud *cloud = &set->clouds[i];
        expect_settings(file, record, cloud);
        expect_text(file, 64, record + 140, cloud->name);
        expect_text(file, 64, record + 148, cloud->made_by);
        expect_box(file, record, cloud, &set->lists[cloud->list]);
    }
    expect_chunks(file, chunks, set);
}

static void check(shape_set *set)
{
    shape_error error;
    unsigned char *encoded;
    size_t size;
    must(shape_neph_encode(set, &encoded, &size, &error), &error);
    bytes file = {encoded, size};
    expect_set(file, set);
    free(encoded);
    shape_set_destroy(set);
}

static void the_second_reader_finds_what_was_written(void **state)
{
    (void)state;
    check(sample_two_clouds());
    for (uint64_t seed = 1000; seed < 1300; seed++)
        check(sample_random_set(seed));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_second_reader_finds_what_was_written)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
