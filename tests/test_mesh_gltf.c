/* glTF written here, small enough to know every triangle: layouts of accessors, index sizes, strips and fans, sparse
 * and quantised accessors, transforms, and files that say more than they hold. */
#include "gltf_sample.h"

static void test_strip_and_fan(void **state)
{
    (void)state;
    check(square, sizeof square, PLAIN("{\"attributes\":{\"POSITION\":0},\"mode\":5}"), 2, 2);
    /* A fan about 0,0 through 1,0  0,1  1,1: one triangle up, one down. */
    check(square, sizeof square, PLAIN("{\"attributes\":{\"POSITION\":0},\"mode\":6}"), 2, 0);
    /* A list of four is one triangle and a corner too many. */
    check(square, sizeof square, PLAIN("{\"attributes\":{\"POSITION\":0}}"), 1, 1);
    /* Points beside a strip are passed over. */
    shape_mesh *mesh = good(square, sizeof square,
                            PLAIN("{\"attributes\":{\"POSITION\":0},\"mode\":5},"
                                  "{\"attributes\":{\"POSITION\":0},\"mode\":0}"));
    assert_int_equal(mesh->triangle_count, 2);
    assert_int_equal(mesh->counts.skipped, 1);
    shape_mesh_destroy(mesh);
    bad(square, sizeof square, PLAIN("{\"attributes\":{\"POSITION\":0},\"mode\":0}"), "no triangles");
}

static void test_indices(void **state)
{
    (void)state;
    for (int bits = 8; bits <= 32; bits *= 2) {
        unsigned char bytes[48 + 24] = {0};
        const unsigned index[6] = {0, 1, 3, 0, 3, 2};
        char rest[1024];
        memcpy(bytes, square, 48);
        for (int i = 0; i < 6; i++)
            bytes[48 + i * bits / 8] = (unsigned char)index[i];
        for (int wrong = 0; wrong < 2; wrong++) {
            if (wrong)
                bytes[48] = 4;
            snprintf(rest, sizeof rest,
                     "\"bufferViews\":[" SQUARE_VIEW ",{\"buffer\":0,\"byteOffset\":48,\"byteLength\":%d}],"
                     "\"accessors\":[" SQUARE_ACCESSOR ",{\"bufferView\":1,\"componentType\":%d,\"count\":6,"
                     "\"type\":\"SCALAR\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},"
                     "\"indices\":1}]}]," ONE_NODE,
                     6 * bits / 8,
                     bits == 8    ? 5121
                     : bits == 16 ? 5123
                                  : 5125);
            if (wrong)
                bad(bytes, sizeof bytes, rest, "names vertex 4 of 4");
            else
                check(bytes, sizeof bytes, rest, 2, 2);
        }
    }
}

/* Positions with normals between them: 24 bytes apart, starting at byte 12. */
static void test_interleaved(void **state)
{
    (void)state;
    float bytes[24];
    for (int i = 0; i < 24; i++)
        bytes[i] = i % 6 < 3 ? 99 : square[i / 6 * 3 + i % 3];
    check(bytes, sizeof bytes,
          "\"bufferViews\":[{\"buffer\":0,\"byteLength\":96,\"byteStride\":24}],\"accessors\":[{"
          "\"bufferView\":0,"
          "\"byteOffset\":12,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}]," STRIP,
          2, 2);
    bad(bytes, sizeof bytes,
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":96,\"byteStride\":24}],\"accessors\":[{\"bufferView\":"
        "0,"
        "\"byteOffset\":16,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}]," STRIP,
        "need 84 bytes");
}

/* Corner 3 moved to 2,2: strip 0,0 1,0 0,1 and 1,0 2,2 0,1, twice the areas 1 and 3. */
static void test_sparse(void **state)
{
    (void)state;
    unsigned char bytes[48 + 4 + 12] = {0};
    const float moved[3] = {2, 2, 0};
    memcpy(bytes, square, 48);
    bytes[48] = 3;
    memcpy(bytes + 52, moved, 12);
#define SPARSE(base, place)                                                                                  \
    "\"bufferViews\":[" SQUARE_VIEW ",{\"buffer\":0,\"byteOffset\":48,\"byteLength\":4},{\"buffer\":0,"      \
    "\"byteOffset\":52,\"byteLength\":12}],\"accessors\":[{" base "\"componentType\":5126,\"count\":4,"      \
    "\"type\":\"VEC3\",\"sparse\":{\"count\":" place                                                         \
    ",\"indices\":{\"bufferView\":1,\"componentType\":5121},"                                                \
    "\"values\":{\"bufferView\":2}}}]," STRIP
    check(bytes, sizeof bytes, SPARSE("\"bufferView\":0,", "1"), 2, 4);
    check(bytes, sizeof bytes, SPARSE("", "1"), 2, 0); /* all others at 0,0,0 */
    bad(bytes, sizeof bytes, SPARSE("\"bufferView\":0,", "2"), "need 24 bytes");
    bytes[48] = 4;
    bad(bytes, sizeof bytes, SPARSE("\"bufferView\":0,", "1"), "beyond its end");
}

/* KHR_mesh_quantization: 16-bit signed, normalised: 32767 is 1, -32768 is -1. */
static void test_quantised(void **state)
{
    (void)state;
    const int16_t bytes[16] = {-32768, -32768, 0, 0, 32767, -32768, 0, 0,
                               -32768, 32767,  0, 0, 32767, 32767,  0, 0};
    check(
        bytes, sizeof bytes,
        "\"extensionsRequired\":[\"KHR_mesh_quantization\"],\"bufferViews\":[{\"buffer\":0,\"byteLength\":32,"
        "\"byteStride\":8}],\"accessors\":[{\"bufferView\":0,\"componentType\":5122,\"normalized\":true,"
        "\"count\":4,"
        "\"type\":\"VEC3\"}]," STRIP,
        2, 8);
}

static void test_transforms(void **state)
{
    (void)state;
    /* A parent that scales by 2 and 3, a child moved by a matrix, a mirrored one: each looks to +z all the same. */
    shape_mesh *mesh = good(square, sizeof square,
                            NODES("\"nodes\":[{\"scale\":[2,3,1],\"children\":[1,2]},{\"mesh\":0,\"matrix\":"
                                  "[1,0,0,0,0,1,0,0,0,0,1,0,5,0,0,1]},{\"mesh\":0,\"scale\":[-1,1,-1]}],"
                                  "\"scenes\":[{\"nodes\":[0]}],\"scene\":0"));
    shape_dvec3 min, max;
    assert_true(shape_mesh_bounds(mesh, &min, &max));
    assert_int_equal(mesh->counts.instances, 2);
    assert_true(min.x == -2 && max.x == 12 && min.y == 0 && max.y == 3);
    /* The first is 2 x 3 seen from +z; two mirrored axes turn the other over, to -z. */
    assert_true(fabs(area_z(mesh) - 0) < 1e-9);
    shape_mesh_destroy(mesh);
    /* One mirrored axis: a determinant below 0 turns the triangles, so it still looks to +z. */
    check(square, sizeof square,
          NODES("\"nodes\":[{\"mesh\":0,\"scale\":[-1,1,1]}],\"scenes\":[{\"nodes\":[0]}]"), 2, 2);
    /* Half a turn about y: over to -z. */
    check(square, sizeof square,
          NODES("\"nodes\":[{\"mesh\":0,\"rotation\":[0,1,0,0]}],\"scenes\":[{\"nodes\":[0]}]"), 2, -2);
    /* Nodes that no scene names are not shown; without scenes all are. */
    check(square, sizeof square, NODES("\"nodes\":[{\"mesh\":0},{\"mesh\":0}],\"scenes\":[{\"nodes\":[1]}]"),
          2, 2);
    check(square, sizeof square, NODES("\"nodes\":[{\"mesh\":0},{\"mesh\":0}]"), 4, 4);
}

static void test_bad_nodes(void **state)
{
    (void)state;
    bad(square, sizeof square,
        NODES("\"nodes\":[{\"mesh\":0,\"children\":[0]}],\"scenes\":[{\"nodes\":[0]}]"), "circle");
    bad(square, sizeof square,
        NODES("\"nodes\":[{\"children\":[1,1]},{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]"), "two parents");
    bad(square, sizeof square, NODES("\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[7]}]"), "node 7");
    bad(square, sizeof square, NODES("\"nodes\":[{\"mesh\":3}],\"scenes\":[{\"nodes\":[0]}]"), "mesh 3");
    bad(square, sizeof square, NODES("\"nodes\":[{\"mesh\":0,\"skin\":0}],\"scenes\":[{\"nodes\":[0]}]"),
        "skin 0");
    bad(square, sizeof square,
        NODES("\"nodes\":[{\"mesh\":0,\"scale\":[1e300,1,1]}],\"scenes\":[{\"nodes\":[0]}]"), "1e12");
}

static void test_bad_accessors(void **state)
{
    (void)state;
    const struct {
        const char *view, *accessor, *expected;
    } cases[] = {
        {SQUARE_VIEW, "{\"bufferView\":0,\"componentType\":5126,\"count\":5,\"type\":\"VEC3\"}",
         "need 60 bytes"},
        {SQUARE_VIEW, "{\"bufferView\":0,\"componentType\":5126,\"count\":4000000000000,\"type\":\"VEC3\"}",
         "more than"},
        {SQUARE_VIEW,
         "{\"bufferView\":0,\"byteOffset\":1000,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}",
         "from byte 1000"},
        {SQUARE_VIEW, "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"}",
         "2 components"},
        {SQUARE_VIEW, "{\"bufferView\":9,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}",
         "bufferView 9"},
        {SQUARE_VIEW, "{\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}", "without compression"},
        {"{\"buffer\":0,\"byteOffset\":0,\"byteLength\":480}",
         "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}", "beyond its buffer"},
        {"{\"buffer\":0,\"byteOffset\":40,\"byteLength\":48}",
         "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}", "beyond its buffer"},
        {"{\"buffer\":2,\"byteLength\":48}", SQUARE_ACCESSOR, "buffer 2"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char rest[1024];
        snprintf(rest, sizeof rest, "\"bufferViews\":[%s],\"accessors\":[%s]," STRIP, cases[i].view,
                 cases[i].accessor);
        bad(square, sizeof square, rest, cases[i].expected);
    }
    float nan[12];
    memcpy(nan, square, sizeof nan);
    nan[4] = NAN;
    bad(nan, sizeof nan, PLAIN("{\"attributes\":{\"POSITION\":0},\"mode\":5}"), "not a finite number");
}

/* Lengths of a GLB's header and of its JSON that do not go together; found by fuzz_mesh: a whole that is shorter than
 * the header made what is left wrap round, and was read beyond the end. */
static void test_glb_lengths(void **state)
{
    (void)state;
    static const uint32_t lengths[][2] = {{0, 4},  {19, 4},   {19, 1u << 30}, {20, 4},
                                          {24, 5}, {24, ~0u}, {25, 4}};
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        const uint32_t words[] = {0x46546c67, 2, lengths[i][0], lengths[i][1], 0x4E4F534A, 0x20207d7b};
        shape_mesh *mesh = NULL;
        shape_error error = {0};
        unsigned char *bytes = malloc(sizeof words); /* so that the sanitizer knows its end */
        assert_non_null(bytes);
        memcpy(bytes, words, sizeof words);
        assert_int_equal(shape_gltf_decode("a.glb", "", bytes, sizeof words, &mesh, &error),
                         SHAPE_ERROR_FORMAT);
        assert_non_null(strstr(error.text, "a.glb"));
        free(bytes);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_strip_and_fan), cmocka_unit_test(test_indices),
        cmocka_unit_test(test_interleaved),   cmocka_unit_test(test_sparse),
        cmocka_unit_test(test_quantised),     cmocka_unit_test(test_transforms),
        cmocka_unit_test(test_bad_nodes),     cmocka_unit_test(test_bad_accessors),
        cmocka_unit_test(test_glb_lengths)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
