/* The .neph file: round trips, damage of every kind, versions. The format is docs/neph-format.md; bytes that were forged
 * with right CRCs, and memory, are in test_neph_hostile.c. */
#include "neph_file.h"

#include <float.h>

#include "shape/file.h"

static void crc_agrees_with_its_definition(void **state)
{
    (void)state;
    assert_int_equal(shape_crc32("123456789", 9), 0xcbf43926u); /* the check value of the CRC catalogue */
    assert_int_equal(shape_crc32("", 0), 0);
    unsigned char bytes[300];
    shape_random random = shape_random_seed(1, 1);
    for (size_t i = 0; i < sizeof bytes; i++)
        bytes[i] = (unsigned char)shape_random_u32(&random);
    for (size_t start = 0; start < 9; start++)
        for (size_t size = 0; size + start <= sizeof bytes; size++) {
            uint32_t crc = 0xffffffffu; /* bit by bit */
            for (size_t i = 0; i < size; i++) {
                crc ^= bytes[start + i];
                for (int bit = 0; bit < 8; bit++)
                    crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
            }
            assert_int_equal(shape_crc32(bytes + start, size), (uint32_t)~crc);
        }
}

/* What a big-endian host would do gives the bytes that this host gives. */
static void floats_are_little_endian(void **state)
{
    (void)state;
    const float values[3] = {1, -0.15625f, 3.4e38f};
    unsigned char fast[12], slow[12];
    float back[3];
    const unsigned char one[4] = {0, 0, 0x80, 0x3f}; /* IEEE 754: sign 0, exponent 127 */
    neph_put_floats(fast, values, 3);
    neph_put_floats_bytewise(slow, values, 3);
    assert_memory_equal(fast, slow, sizeof fast);
    assert_memory_equal(fast, one, 4);
    neph_get_floats_bytewise(back, slow, 3);
    assert_memory_equal(back, values, sizeof back);
    neph_get_floats(back, slow, 3);
    assert_memory_equal(back, values, sizeof back);
}

static void random_sets_come_back(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 300; seed++) {
        shape_set *set = sample_random_set(seed);
        file f = encode(set);
        shape_set *again = decode(f);
        assert_same_set(set, again);
        file g = encode(again);
        assert_int_equal(f.size, g.size);
        assert_memory_equal(f.bytes, g.bytes, f.size);
        unsigned major, minor;
        shape_neph_version(f.bytes, &major, &minor);
        assert_true(major == 1 && minor == (has_layer_record(set) ? 1 : 0));
        shape_set_destroy(set);
        shape_set_destroy(again);
        free(f.bytes);
        free(g.bytes);
    }
}

static void empty_sets_clouds_and_lists_come_back(void **state)
{
    (void)state;
    shape_error error;
    shape_set *set = shape_set_create(&error);
    for (int step = 0; step < 3; step++) {
        /* nothing; then an empty cloud; then a copy of it that leaves a second list unused */
        if (step == 1)
            must(shape_set_add_cloud(set, "", NULL, &error), &error);
        if (step == 2) {
            must(shape_set_add_cloud(set, "", NULL, &error), &error);
            set->clouds[1].list = 0;
        }
        file f = encode(set);
        shape_set *again = decode(f);
        assert_same_set(set, again);
        assert_int_equal(again->list_count, step);
        shape_set_destroy(again);
        free(f.bytes);
    }
    shape_set_destroy(set);
}

static shape_set *largest_texts(void)
{
    shape_error error;
    shape_set *set = shape_set_create(&error);
    must(shape_set_add_cloud(set, "x", NULL, &error), &error);
    memset(set->clouds[0].name, 'n', SHAPE_NAME_MAX);
    set->clouds[0].name[SHAPE_NAME_MAX] = 0;
    memset(set->clouds[0].made_by, 'm', SHAPE_MADE_BY_MAX);
    set->clouds[0].made_by[SHAPE_MADE_BY_MAX] = 0;
    return set;
}

static void one_cloud_costs_768_bytes_at_most(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(3, 3);
    for (int step = 0; step < 20; step++) {
        shape_set *set = largest_texts();
        size_t spheres = (size_t)step, ellipsoids = (size_t)(step * 7 % 4);
        sample_primitives(shape_set_list(set, 0), &random, spheres, ellipsoids);
        file f = encode_once(set);
        assert_true(f.size - 16 * spheres - 48 * ellipsoids <= 768);
        free(f.bytes);
    }
}

static void primitives_lie_aligned_as_in_memory(void **state)
{
    (void)state;
    shape_set *set = sample_two_clouds();
    file f = encode(set);
    for (size_t i = 0; i < neph_get_u32(f.bytes + NEPH_AT_CHUNKS); i++)
        assert_int_equal(neph_get_u64(entry_of(f, i) + NEPH_ENTRY_OFFSET) % 16, 0);
    assert_memory_equal(entry_of(f, 2), "SPHR", 4);
    assert_memory_equal(entry_of(f, 3), "ELLI", 4);
    float floats[12];
    neph_get_floats_bytewise(floats, chunk_of(f, 2), 8);
    assert_memory_equal(floats, set->lists[0].spheres, 32);
    neph_get_floats_bytewise(floats, chunk_of(f, 3), 12);
    assert_memory_equal(floats, set->lists[0].ellipsoids, 48);
    /* paddings are zero in the file, whatever a caller left in them */
    set->lists[0].ellipsoids[0].pad0 = set->lists[0].ellipsoids[0].pad1 = 5;
    file g = encode_once(set);
    assert_memory_equal(f.bytes, g.bytes, f.size);
    free(f.bytes);
    free(g.bytes);
}

static void every_truncation_is_refused(void **state)
{
    (void)state;
    file f = encode_once(sample_two_clouds());
    for (size_t size = 0; size < f.size; size++) {
        /* a copy of that size, so that a sanitizer sees any read behind it */
        file cut = {malloc(size ? size : 1), size};
        assert_non_null(cut.bytes);
        memcpy(cut.bytes, f.bytes, size);
        char text[64];
        snprintf(text, sizeof text, "truncated at byte %zu of ", size);
        assert_refused(cut, size ? text : "empty");
        free(cut.bytes);
    }
    file longer = {calloc(f.size + 16, 1), f.size + 16};
    assert_non_null(longer.bytes);
    memcpy(longer.bytes, f.bytes, f.size);
    assert_refused(longer, "16 bytes too many");
    free(longer.bytes);
    free(f.bytes);
}

static void every_changed_byte_is_refused(void **state)
{
    (void)state;
    file f = encode_once(sample_two_clouds());
    for (size_t at = 0; at < f.size; at++)
        for (unsigned change = 1; change < 256; change++) {
            f.bytes[at] ^= (unsigned char)change;
            shape_set *set = NULL;
            if (shape_neph_decode(f.bytes, f.size, &set, NULL) != SHAPE_ERROR_FORMAT)
                fail_msg("byte %zu changed by %02x is accepted", at, change);
            f.bytes[at] ^= (unsigned char)change;
        }
    free(f.bytes);
}

static void damage_is_told_apart(void **state)
{
    (void)state;
    file f = encode_once(sample_two_clouds());
    file text = {(unsigned char *)"cloud: puff\nand so on", 20};
    assert_refused(text, "not a .neph file");
    /* what a text-mode copy makes of it */
    file mangled = {malloc(f.size), f.size - 1};
    assert_non_null(mangled.bytes);
    memcpy(mangled.bytes, f.bytes, 4);
    memcpy(mangled.bytes + 4, f.bytes + 5, f.size - 5);
    assert_refused(mangled, "as binary");
    free(mangled.bytes);
    chunk_of(f, 3)[1] ^= 1;
    assert_refused(f, "chunk 3 (ELLI");
    free(f.bytes);
}

static void unknown_chunks_are_kept_or_refused(void **state)
{
    (void)state;
    shape_error error;
    shape_set *set = sample_two_clouds();
    file f = encode(set);
    shape_set *again = decode(f);
    assert_int_equal(again->extra_count, 1);
    assert_memory_equal(again->extras[0].type, "note", 4);
    assert_memory_equal(again->extras[0].bytes, "kept", 4);
    shape_set_destroy(again);
    neph_put_u32(entry_of(f, 4) + NEPH_ENTRY_FLAGS, NEPH_FLAG_REQUIRED);
    reseal(f);
    assert_refused(f, "update the program");
    neph_put_u32(entry_of(f, 4) + NEPH_ENTRY_FLAGS, 2);
    reseal(f);
    assert_refused(f, "flags");
    free(f.bytes);
    /* an extra that would pass for something else is not written */
    memcpy(set->extras[0].type, "SPHR", 4);
    assert_int_equal(shape_neph_encode(set, &f.bytes, &f.size, &error), SHAPE_ERROR_ARGUMENT);
    memcpy(set->extras[0].type, "a\nb ", 4);
    assert_int_equal(shape_neph_encode(set, &f.bytes, &f.size, &error), SHAPE_ERROR_ARGUMENT);
    shape_set_destroy(set);
}

/* The same file as a later minor version would write it: records longer by 16 bytes, an extra chunk in between. */
static file make_newer_minor(const shape_set *set)
{
    file old = encode(set);
    size_t more = 16 * set->cloud_count;
    file f = {calloc(old.size + more, 1), old.size + more};
    assert_non_null(f.bytes);
    size_t first = (size_t)neph_get_u64(entry_of(old, 0) + NEPH_ENTRY_OFFSET);
    size_t length = (size_t)neph_get_u64(entry_of(old, 0) + NEPH_ENTRY_LENGTH);
    memcpy(f.bytes, old.bytes, first + NEPH_CLOUDS_HEAD);
    for (size_t i = 0; i < set->cloud_count; i++) {
        unsigned char *to = f.bytes + first + NEPH_CLOUDS_HEAD + i * (NEPH_CLOUD_RECORD + 16);
        memcpy(to, old.bytes + first + NEPH_CLOUDS_HEAD + i * NEPH_CLOUD_RECORD, NEPH_CLOUD_RECORD);
        memset(to + NEPH_CLOUD_RECORD, 0xab, 16);
    }
    assert_int_equal(length % 16, 0);
    memcpy(f.bytes + first + length + more, old.bytes + first + length, old.size - first - length);
    neph_put_u16(f.bytes + NEPH_AT_MINOR, 7);
    neph_put_u64(f.bytes + NEPH_AT_FILE_SIZE, f.size);
    neph_put_u32(f.bytes + first + NEPH_CLOUDS_RECORD_SIZE, NEPH_CLOUD_RECORD + 16);
    neph_put_u64(entry_of(f, 0) + NEPH_ENTRY_LENGTH, length + more);
    for (size_t i = 1; i < neph_get_u32(f.bytes + NEPH_AT_CHUNKS); i++)
        neph_put_u64(entry_of(f, i) + NEPH_ENTRY_OFFSET,
                     neph_get_u64(entry_of(old, i) + NEPH_ENTRY_OFFSET) + more);
    reseal(f);
    free(old.bytes);
    return f;
}

static void newer_versions(void **state)
{
    (void)state;
    shape_set *set = sample_two_clouds();
    file f = make_newer_minor(set);
    shape_set *again = decode(f);
    assert_same_set(set, again);
    unsigned major, minor;
    shape_neph_version(f.bytes, &major, &minor);
    assert_true(major == 1 && minor == 7);
    /* a model that only the newer version knows: refused, and the line says why */
    neph_put_u32(chunk_of(f, 0) + NEPH_CLOUDS_HEAD + NEPH_CLOUD_MODEL, 9);
    reseal(f);
    assert_refused(f, "update the program");
    shape_set_destroy(set);
    shape_set_destroy(again);
    neph_put_u16(f.bytes + NEPH_AT_MAJOR, 2);
    assert_refused(f, "format version 2.7, but only 1.x is known (update the program)");
    free(f.bytes);
}

static void a_larger_box_and_filled_reserves_are_accepted(void **state)
{
    (void)state;
    shape_set *set = sample_two_clouds();
    file f = encode(set), g = encode(set);
    unsigned char *record = chunk_of(f, 0) + NEPH_CLOUDS_HEAD;
    neph_put_f32(record + NEPH_CLOUD_BOX, -1e6f);
    neph_put_u32(record + 204, 77);
    neph_put_u64(f.bytes + 24, 77);
    neph_put_f32(chunk_of(f, 3) + 12, 77);
    reseal(f);
    shape_set *again = decode(f);
    assert_same_set(set, again);
    file h = encode_once(again);
    assert_memory_equal(g.bytes, h.bytes, g.size);
    shape_set_destroy(set);
    free(f.bytes);
    free(g.bytes);
    free(h.bytes);
}

static void sets_that_cannot_be_read_are_not_written(void **state)
{
    (void)state;
    shape_error error;
    file f;
    shape_set *set = sample_two_clouds();
    set->clouds[0].medium.albedo = 2;
    assert_int_equal(shape_neph_encode(set, &f.bytes, &f.size, &error), SHAPE_ERROR_ARGUMENT);
    set->clouds[0].medium.albedo = 1;
    strcpy(set->clouds[0].made_by, "a\nb");
    assert_int_equal(shape_neph_encode(set, &f.bytes, &f.size, &error), SHAPE_ERROR_ARGUMENT);
    memset(set->clouds[0].made_by, 'x', sizeof set->clouds[0].made_by);
    assert_int_equal(shape_neph_encode(set, &f.bytes, &f.size, &error), SHAPE_ERROR_ARGUMENT);
    set->clouds[0].made_by[3] = 0;
    set->lists[0].spheres[0].radius = FLT_MAX; /* the sphere is finite, its box is not */
    set->lists[0].spheres[0].x = FLT_MAX;
    assert_int_equal(shape_neph_encode(set, &f.bytes, &f.size, &error), SHAPE_ERROR_LIMIT);
    assert_non_null(strstr(error.text, "too large"));
    shape_set_destroy(set);
}

static const char frozen_path[] = TEST_DATA "/frozen/v1.0-two-clouds.neph";

/* A file written when the format was fixed: it is still read, to the same content, and still written so. */
static void the_frozen_file_is_read_and_written(void **state)
{
    (void)state;
    shape_error error;
    file f;
    must(shape_file_read(frozen_path, 1 << 20, &f.bytes, &f.size, &error), &error);
    shape_set *set = decode(f), *want = sample_two_clouds();
    assert_same_set(want, set);
    file g = encode(set);
    assert_int_equal(g.size, f.size);
    assert_memory_equal(g.bytes, f.bytes, f.size);
    shape_set_destroy(set);
    shape_set_destroy(want);
    free(f.bytes);
    free(g.bytes);
}

/* Writes the frozen file: only for a new version of the format. */
static int freeze(const char *path)
{
    shape_error error;
    file f = encode_once(sample_two_clouds());
    shape_status status = shape_file_write(path, f.bytes, f.size, &error);
    free(f.bytes);
    return status;
}

int main(int argc, char **argv)
{
    if (argc == 3 && !strcmp(argv[1], "--freeze"))
        return freeze(argv[2]);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(crc_agrees_with_its_definition),
        cmocka_unit_test(floats_are_little_endian),
        cmocka_unit_test(random_sets_come_back),
        cmocka_unit_test(empty_sets_clouds_and_lists_come_back),
        cmocka_unit_test(one_cloud_costs_768_bytes_at_most),
        cmocka_unit_test(primitives_lie_aligned_as_in_memory),
        cmocka_unit_test(every_truncation_is_refused),
        cmocka_unit_test(every_changed_byte_is_refused),
        cmocka_unit_test(damage_is_told_apart),
        cmocka_unit_test(unknown_chunks_are_kept_or_refused),
        cmocka_unit_test(newer_versions),
        cmocka_unit_test(a_larger_box_and_filled_reserves_are_accepted),
        cmocka_unit_test(sets_that_cannot_be_read_are_not_written),
        cmocka_unit_test(the_frozen_file_is_read_and_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
