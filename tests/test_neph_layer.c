/* The LAYR chunk: where it is written and where not, damage of every kind, forgeries. Round trips of random sets with it
 * are in test_neph.c, and a second reader in test_neph_second.c. */
#include "neph_file.h"

#include <math.h>

/* Three clouds: plain, with details, a layer. */
static shape_set *sample_layers(void)
{
    shape_error error;
    shape_set *set = shape_set_create(&error);
    for (int i = 0; i < 3; i++) {
        size_t index;
        must(shape_set_add_cloud(set, "cloud", &index, &error), &error);
        shape_sphere sphere = {0, (float)i, 0, 1};
        must(shape_primitives_add_sphere(shape_set_list(set, index), sphere, &error), &error);
    }
    set->clouds[1].field.detail.smoothness = 0.25f;
    set->clouds[2].field.model = SHAPE_MODEL_LAYER;
    set->clouds[2].field.layer.bounds = SHAPE_BOUNDS_ALTITUDES;
    set->clouds[2].field.layer.planet_radius = 100;
    return set;
}

enum { LAYER_CHUNK = 2 };

static void the_chunk_is_there_only_where_it_is_needed(void **state)
{
    (void)state;
    shape_set *set = sample_layers();
    file f = encode(set);
    assert_memory_equal(entry_of(f, LAYER_CHUNK), "LAYR", 4);
    assert_int_equal(neph_get_u16(f.bytes + NEPH_AT_MINOR), 1);
    assert_int_equal(neph_get_u64(entry_of(f, LAYER_CHUNK) + NEPH_ENTRY_LENGTH), 16 + 2 * 112);
    shape_set *again = decode(f);
    assert_same_set(set, again);
    free(f.bytes);
    shape_set_destroy(again);
    /* A layer's settings in a cloud that is none do not come into the file. */
    set->clouds[1].field.detail.smoothness = 0;
    set->clouds[2].field.model = SHAPE_MODEL_UNIFORM;
    f = encode(set);
    assert_int_equal(neph_get_u16(f.bytes + NEPH_AT_MINOR), 0);
    for (size_t i = 0; i < neph_get_u32(f.bytes + NEPH_AT_CHUNKS); i++)
        assert_memory_not_equal(entry_of(f, i), "LAYR", 4);
    set->clouds[2].field.layer = shape_layer_defaults();
    file g = encode(set);
    assert_int_equal(f.size, g.size);
    assert_memory_equal(f.bytes, g.bytes, f.size);
    free(f.bytes);
    free(g.bytes);
    shape_set_destroy(set);
}

/* Version 1.0 allowed model 3 without saying more. */
static void a_layer_without_a_record_has_the_defaults(void **state)
{
    (void)state;
    shape_set *set = sample_layers();
    set->clouds[1].field.detail.smoothness = 0;
    set->clouds[2].field.model = SHAPE_MODEL_UNIFORM;
    file f = encode(set);
    unsigned char *record = chunk_of(f, 0) + NEPH_CLOUDS_HEAD + 2 * NEPH_CLOUD_RECORD;
    neph_put_u32(record + NEPH_CLOUD_MODEL, SHAPE_MODEL_LAYER);
    reseal(f);
    shape_set *again = decode(f);
    shape_layer defaults = shape_layer_defaults();
    assert_int_equal(again->clouds[2].field.model, SHAPE_MODEL_LAYER);
    assert_memory_equal(&again->clouds[2].field.layer, &defaults, sizeof defaults);
    shape_set_destroy(again);
    shape_set_destroy(set);
    free(f.bytes);
}

static void truncations_and_changed_bytes_are_refused(void **state)
{
    (void)state;
    file f = encode_once(sample_layers());
    for (size_t size = 0; size < f.size; size++) {
        shape_error error;
        shape_set *set = NULL;
        /* a buffer of its own, so that a read beyond it is found */
        unsigned char *cut = malloc(size ? size : 1);
        assert_non_null(cut);
        memcpy(cut, f.bytes, size);
        assert_int_equal(shape_neph_decode(cut, size, &set, &error), SHAPE_ERROR_FORMAT);
        free(cut);
    }
    for (size_t i = 0; i < f.size; i++) {
        shape_error error;
        shape_set *set = NULL;
        f.bytes[i] ^= 0x55;
        assert_int_not_equal(shape_neph_decode(f.bytes, f.size, &set, &error), SHAPE_OK);
        f.bytes[i] ^= 0x55;
    }
    free(f.bytes);
}

/* Well-formed but wrong: the place in the LAYR chunk, a u32 or f32 value, what is said. */
static void forgeries_are_refused(void **state)
{
    (void)state;
    enum { DETAILS = 16, LAYER = 16 + 112 };
    static const struct {
        size_t place;
        bool real;
        double value;
        const char *says;
    } forgeries[] = {
        {0, false, 104, "size"},
        {0, false, 0, "size"},
        {0, false, 70000, "size"},
        {0, false, 4294967288.0, "size"},
        {4, false, 3, "number of records"},
        {4, false, 4294967295.0, "number of records"},
        {DETAILS, false, 5, "not there"},
        {LAYER, false, 1, "not in order"},
        {LAYER, false, 3, "not there"},
        {DETAILS + 16, true, 1.5, "smoothness"},
        {DETAILS + 16, true, NAN, "smoothness"},
        {DETAILS + 20, true, -1, "displace"},
        {DETAILS + 20, true, 1e8, "bounding box"},
        {LAYER + 16, true, 0.5, "smoothness"},
        {LAYER + 28, true, 0.5, "billow"},
        {LAYER + 4, false, 3, "bounds"},
        {LAYER + 4, false, 4294967295.0, "bounds"},
        {LAYER + 4, false, 1, "planet-radius"},
        {LAYER + 8, false, 4, "noise"},
        {LAYER + 12, false, 0, "worley-octaves"},
        {LAYER + 44, true, 2, "blend"},
        {LAYER + 60, true, 0, "stretch"},
        {LAYER + 72, true, 1.01, "coverage"},
        {LAYER + 76, true, 1, "cut"},
        {LAYER + 80, true, 0.9, "ramp"},
        {LAYER + 104, true, INFINITY, "planet-radius"},
    };
    for (size_t i = 0; i < sizeof forgeries / sizeof *forgeries; i++) {
        file f = encode_once(sample_layers());
        unsigned char *at = chunk_of(f, LAYER_CHUNK) + forgeries[i].place;
        if (forgeries[i].real)
            neph_put_f32(at, (float)forgeries[i].value);
        else
            neph_put_u32(at, (uint32_t)forgeries[i].value);
        reseal(f);
        assert_refused(f, forgeries[i].says);
        free(f.bytes);
    }
}

static void the_chunk_must_be_required_and_single(void **state)
{
    (void)state;
    file f = encode_once(sample_layers());
    neph_put_u32(entry_of(f, LAYER_CHUNK) + NEPH_ENTRY_FLAGS, 0);
    reseal(f);
    assert_refused(f, "required");
    free(f.bytes);
    /* The texts' bytes stand in for a second one. */
    f = encode_once(sample_layers());
    memcpy(entry_of(f, LAYER_CHUNK + 1), "LAYR", 4);
    reseal(f);
    assert_refused(f, "second time");
    free(f.bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_chunk_is_there_only_where_it_is_needed),
        cmocka_unit_test(a_layer_without_a_record_has_the_defaults),
        cmocka_unit_test(truncations_and_changed_bytes_are_refused),
        cmocka_unit_test(forgeries_are_refused),
        cmocka_unit_test(the_chunk_must_be_required_and_single),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
