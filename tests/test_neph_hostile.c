/* The .neph reader against strangers: numbers forged with right CRCs, random changes, memory that fails or runs out, work
 * that multiplies. */
#include "neph_file.h"

#include <float.h>
#include <malloc.h>
#include <math.h>
#include <time.h>

/* The build links this program with --wrap, so that every allocation passes here: counted, and failed on demand. */
void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
void __real_free(void *block);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t size);
void __wrap_free(void *block);

static long fail_after = -1; /* how many allocations still succeed; -1: all */
static long allocations;
static size_t live, peak;

static bool refuse_allocation(void)
{
    allocations++;
    return fail_after >= 0 && fail_after-- == 0;
}

static void *count(void *block)
{
    live += block ? malloc_usable_size(block) : 0;
    peak = live > peak ? live : peak;
    return block;
}

void *__wrap_malloc(size_t size)
{
    return refuse_allocation() ? NULL : count(__real_malloc(size));
}

void *__wrap_calloc(size_t number, size_t size)
{
    return refuse_allocation() ? NULL : count(__real_calloc(number, size));
}

void *__wrap_realloc(void *old, size_t size)
{
    if (refuse_allocation())
        return NULL;
    size_t before = old ? malloc_usable_size(old) : 0;
    void *block = count(__real_realloc(old, size)); /* both are there for a moment, at the worst */
    live -= block ? before : 0;
    return block;
}

void __wrap_free(void *block)
{
    live -= block ? malloc_usable_size(block) : 0;
    __real_free(block);
}

/* One number of a good file replaced, with all CRCs right: what a clever stranger sends. */
typedef struct forgery {
    enum { HEADER, ENTRY, HEAD, RECORD, TEXT, SPHERE, ELLIPSOID } place;
    size_t at; /* from there; ENTRY: of chunk 2, the spheres, plus multiples of 32 */
    int bits;  /* 16, 32, 64: an integer; -32, -64: a floating-point number */
    double value;
    const char *says;
} forgery;

static const forgery forgeries[] = {
    {HEADER, NEPH_AT_CHUNKS, 32, 4294967295.0, "number of chunks"},
    {HEADER, NEPH_AT_CHUNKS, 32, 0, "number of chunks"},
    {HEADER, NEPH_AT_FILE_SIZE, 64, 0x1p60, "truncated"},
    {HEADER, NEPH_AT_MAJOR, 16, 0, "version 0.0"},
    {ENTRY, NEPH_ENTRY_LENGTH, 64, 0x1p60, "chunk 2 (SPHR"},
    {ENTRY, NEPH_ENTRY_LENGTH, 64, 0x1.fffffffffffffp63, "chunk 2 (SPHR"},
    {ENTRY, NEPH_ENTRY_LENGTH, 64, 33, "not where it must be|not zero|whole primitives"},
    {ENTRY, NEPH_ENTRY_LENGTH, 64, 16, "chunk 3 (ELLI"},
    {ENTRY, NEPH_ENTRY_OFFSET, 64, 0x1p60, "chunk 2 (SPHR"},
    {ENTRY, NEPH_ENTRY_OFFSET, 64, 0, "chunk 2 (SPHR"},
    {ENTRY, NEPH_ENTRY_PARAMETER, 32, 1, "out of order"},
    {ENTRY, NEPH_ENTRY_PARAMETER, 32, 4294967295.0, "out of order"},
    {ENTRY, NEPH_ENTRY_FLAGS, 32, 0, "lacks the flag"},
    {ENTRY, NEPH_ENTRY_TYPE, 32, 0x54584554, "out of order"},                  /* TEXT twice */
    {ENTRY, NEPH_ENTRY_TYPE, 32, 0x494c4c45, "out of order|whole primitives"}, /* ELLI twice */
    {ENTRY, NEPH_ENTRY_TYPE, 32, 0x0a1b5b31, "four letters"},
    {ENTRY, NEPH_ENTRY_SIZE + NEPH_ENTRY_PARAMETER, 32, 1, "declares lists"},
    {HEAD, NEPH_CLOUDS_COUNT, 32, 4294967295.0, "number of clouds"},
    {HEAD, NEPH_CLOUDS_COUNT, 32, 1, "number of clouds"},
    {HEAD, NEPH_CLOUDS_LISTS, 32, 4294967295.0, "declares lists"},
    {HEAD, NEPH_CLOUDS_LISTS, 32, 0, "declares lists"},
    {HEAD, NEPH_CLOUDS_RECORD_SIZE, 32, 0, "records of a size"},
    {HEAD, NEPH_CLOUDS_RECORD_SIZE, 32, 200, "records of a size"},
    {HEAD, NEPH_CLOUDS_RECORD_SIZE, 32, 4294967288.0, "records of a size"},
    {RECORD, NEPH_CLOUD_LIST, 32, 1, "a list that is not there"},
    {RECORD, NEPH_CLOUD_NAME, 32, 4294967295.0, "its name"},
    {RECORD, NEPH_CLOUD_NAME + 4, 32, 0, "its name"},
    {RECORD, NEPH_CLOUD_NAME + 4, 32, 64, "its name"},
    {RECORD, NEPH_CLOUD_MADE_BY, 32, 4294967295.0, "its made_by"},
    {RECORD, NEPH_CLOUD_MADE_BY + 4, 32, 256, "its made_by"},
    {RECORD, NEPH_CLOUD_MODEL, 32, 5, "model"},
    {RECORD, NEPH_CLOUD_MODEL, 32, 4294967295.0, "model"},
    {RECORD, NEPH_CLOUD_OCTAVES, 32, 0, "octaves"},
    {RECORD, NEPH_CLOUD_OCTAVES, 32, 17, "octaves"},
    {RECORD, NEPH_CLOUD_PHASE, 32, 5, "phase"},
    {RECORD, NEPH_CLOUD_KAPPA, -32, NAN, "kappa"},
    {RECORD, NEPH_CLOUD_NOISE_SCALE, -32, -1, "noise-scale"},
    {RECORD, NEPH_CLOUD_EDGE, -32, INFINITY, "edge"},
    {RECORD, NEPH_CLOUD_EXTINCTION, -32, -1, "extinction"},
    {RECORD, NEPH_CLOUD_ALBEDO, -32, 1.01, "albedo"},
    {RECORD, NEPH_CLOUD_G, -32, 1, "g is"},
    {RECORD, NEPH_CLOUD_G2, -32, -1, "g2 is"},
    {RECORD, NEPH_CLOUD_LOBE_MIX, -32, 2, "lobe-mix"},
    {RECORD, NEPH_CLOUD_DROPLET, -32, 4, "droplet"},
    {RECORD, NEPH_CLOUD_FRAME, -64, NAN, "frame"},
    {RECORD, NEPH_CLOUD_FRAME, -64, 0, "frame"},
    {RECORD, NEPH_CLOUD_FRAME, -64, 1e308, "frame|too large"},
    {RECORD, NEPH_CLOUD_FRAME + 24, -64, INFINITY, "frame"},
    {RECORD, NEPH_CLOUD_BOX, -32, 0, "bounding box"},
    {RECORD, NEPH_CLOUD_BOX, -32, -INFINITY, "bounding box"},
    {RECORD, NEPH_CLOUD_BOX + 12, -32, NAN, "bounding box"},
    {TEXT, 2, 16, 0x5b1b, "its name"},  /* a terminal's escape sequence */
    {TEXT, 2, 16, 0x0066, "its name"},  /* a zero byte */
    {TEXT, 2, 16, 0x85c2, "its name"},  /* a C1 control character */
    {TEXT, 2, 16, 0x80c0, "its name"},  /* an overlong form */
    {TEXT, 2, 16, 0x66ff, "its name"},  /* no UTF-8 */
    {TEXT, 11, 16, 0xe222, "its name"}, /* a character that is cut off */
    {SPHERE, 12, -32, 0, "radius"},
    {SPHERE, 12, -32, -1, "radius"},
    {SPHERE, 0, -32, NAN, "sphere"},
    {SPHERE, 28, -32, FLT_MAX, "bounding box|too large"},
    {ELLIPSOID, 20, -32, 0, "semi-axes"},
    {ELLIPSOID, 8, -32, INFINITY, "ellipsoid"},
    {ELLIPSOID, 36, -32, 0, "quaternion"},
};

static unsigned char *place_of(file f, const forgery *g)
{
    switch (g->place) {
    case HEADER:
        return f.bytes + g->at;
    case ENTRY:
        return entry_of(f, 2) + g->at;
    case HEAD:
        return chunk_of(f, 0) + g->at;
    case RECORD:
        return chunk_of(f, 0) + NEPH_CLOUDS_HEAD + g->at;
    case TEXT:
        return chunk_of(f, 1) + g->at;
    case SPHERE:
        return chunk_of(f, 2) + g->at;
    case ELLIPSOID:
        break;
    }
    return chunk_of(f, 3) + g->at;
}

static void put_number(unsigned char *to, int bits, double value)
{
    if (bits == 16)
        neph_put_u16(to, (uint16_t)value);
    else if (bits == 32)
        neph_put_u32(to, (uint32_t)value);
    else if (bits == 64)
        neph_put_u64(to, (uint64_t)value);
    else if (bits == -32)
        neph_put_f32(to, (float)value);
    else
        neph_put_f64(to, value);
}

static void forgeries_are_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof forgeries / sizeof *forgeries; i++) {
        const forgery *g = &forgeries[i];
        file f = encode_once(sample_two_clouds());
        put_number(place_of(f, g), g->bits, g->value);
        reseal(f);
        long before = allocations;
        size_t live_before = live;
        assert_refused(f, g->says);
        assert_int_equal(live, live_before);
        /* whatever a count or an offset says, nothing is taken before it is checked */
        if (g->place <= HEAD)
            assert_int_equal(allocations, before);
        free(f.bytes);
    }
}

static void names_must_differ(void **state)
{
    (void)state;
    file f = encode_once(sample_two_clouds());
    unsigned char *first = chunk_of(f, 0) + NEPH_CLOUDS_HEAD;
    memcpy(first + NEPH_CLOUD_RECORD + NEPH_CLOUD_NAME, first + NEPH_CLOUD_NAME, 8);
    reseal(f);
    assert_refused(f, "two clouds are called");
    free(f.bytes);
}

/* Random changes with CRCs made right: refused, or a set that goes round. Sanitizers see to the rest. */
static void random_forgeries_do_no_harm(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(11, 11);
    int accepted = 0;
    for (int step = 0; step < 20000; step++) {
        file f = encode_once(step % 2 ? sample_two_clouds() : sample_random_set((uint64_t)step));
        for (unsigned k = 0; k <= shape_random_u32(&random) % 3; k++)
            f.bytes[shape_random_u32(&random) % f.size] = (unsigned char)shape_random_u32(&random);
        reseal(f);
        shape_set *set = NULL;
        if (!shape_neph_decode(f.bytes, f.size, &set, NULL)) {
            file g = encode(set);
            shape_set *again = decode(g);
            assert_same_set(set, again);
            shape_set_destroy(set);
            shape_set_destroy(again);
            free(g.bytes);
            accepted++;
        }
        free(f.bytes);
    }
    assert_in_range(accepted, 1000, 19999); /* both ways are walked */
}

static void failing_memory_is_an_error(void **state)
{
    (void)state;
    shape_set *set = sample_two_clouds();
    file f = encode(set);
    size_t before = live;
    int failures = 0;
    for (long after = 0;; after++) {
        file g = {NULL, 0};
        shape_error error;
        fail_after = after;
        shape_status status = shape_neph_encode(set, &g.bytes, &g.size, &error);
        bool done = fail_after >= 0;
        fail_after = -1;
        free(g.bytes);
        assert_int_equal(live, before);
        if (done) {
            assert_int_equal(status, SHAPE_OK);
            break;
        }
        assert_int_equal(status, SHAPE_ERROR_MEMORY);
        failures++;
    }
    for (long after = 0;; after++) {
        shape_set *again = NULL;
        shape_error error;
        fail_after = after;
        shape_status status = shape_neph_decode(f.bytes, f.size, &again, &error);
        bool done = fail_after >= 0;
        fail_after = -1;
        shape_set_destroy(again);
        assert_int_equal(live, before);
        if (done) {
            assert_int_equal(status, SHAPE_OK);
            break;
        }
        assert_int_equal(status, SHAPE_ERROR_MEMORY);
        failures++;
    }
    assert_true(failures >= 8);
    shape_set_destroy(set);
    free(f.bytes);
}

/* Files of one kind of thing only, the dearest in memory for their bytes. */
static shape_set *many(int kind, size_t number)
{
    shape_error error;
    shape_set *set = shape_set_create(&error);
    shape_random random = shape_random_seed(5, 5);
    if (kind == 3)
        must(shape_set_add_cloud(set, "c", NULL, &error), &error);
    if (kind == 3)
        sample_primitives(shape_set_list(set, 0), &random, number, number);
    for (size_t i = 0; i < number && kind < 3; i++) {
        if (kind == 0) { /* clouds of one list */
            must(shape_set_add_cloud(set, "c", NULL, &error), &error);
            snprintf(set->clouds[i].name, sizeof set->clouds[i].name, "%zu", i);
            set->clouds[i].list = 0;
        } else if (kind == 1) { /* extras of nothing */
            must(shape_set_add_extra(set, "note", 0, "", 0, &error), &error);
        } else { /* empty lists; their clouds are taken away */
            must(shape_set_add_cloud(set, "c", NULL, &error), &error);
            set->cloud_count = 0;
        }
    }
    if (kind == 0)
        set->list_count = 1;
    return set;
}

static void memory_stays_below_four_times_the_file(void **state)
{
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        file f = encode_once(many(kind, 5000));
        size_t before = live;
        peak = live;
        shape_set *set = decode(f);
        if (peak - before > 4 * f.size + 65536)
            fail_msg("kind %d: %zu bytes of memory for a file of %zu", kind, peak - before, f.size);
        shape_set_destroy(set);
        free(f.bytes);
    }
}

/* A large list named by many clouds: work that grows with their product would take minutes. */
static void many_clouds_of_a_large_list_take_no_time(void **state)
{
    (void)state;
    shape_set *set = many(0, 5000);
    shape_random random = shape_random_seed(6, 6);
    sample_primitives(&set->lists[0], &random, 200000, 0);
    clock_t start = clock();
    file f = encode(set);
    shape_set *again = decode(f);
    assert_true((double)(clock() - start) / CLOCKS_PER_SEC <
                2); /* 1e9 boxes take longer anywhere; this takes 0.1 s */
    assert_same_set(set, again);
    shape_set_destroy(set);
    shape_set_destroy(again);
    free(f.bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forgeries_are_refused),
        cmocka_unit_test(names_must_differ),
        cmocka_unit_test(random_forgeries_do_no_harm),
        cmocka_unit_test(failing_memory_is_an_error),
        cmocka_unit_test(memory_stays_below_four_times_the_file),
        cmocka_unit_test(many_clouds_of_a_large_list_take_no_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
