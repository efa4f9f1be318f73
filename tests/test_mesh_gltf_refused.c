/* glTF that must be refused, each with its reason: files named outside the folder, extensions, accessors, indices and skins
 * that do not hold what they say; and beside each the nearest one that is read. */
#include "gltf_sample.h"

#include <sys/stat.h>
#include <unistd.h>

static void refuse(const void *bytes, size_t size, const char *folder, const char *expected)
{
    shape_mesh *mesh = NULL;
    shape_error error = {.text = ""};
    assert_int_equal(shape_gltf_decode("a.gltf", folder, bytes, size, &mesh, &error), SHAPE_ERROR_FORMAT);
    assert_null(mesh);
    assert_null(strchr(error.text, '\n'));
    if (!strstr(error.text, expected))
        fail_msg("expected \"%s\" in: %s", expected, error.text);
}

static void refuse_text(const char *text, const char *expected)
{
    refuse(text, strlen(text), "", expected);
}

/* --- the container --- */

static void wrap(const char *json, size_t json_size, const char *tail, size_t tail_size, uint32_t version,
                 unsigned char *glb, size_t *size)
{
    const uint32_t whole = (uint32_t)(20 + json_size + tail_size);
    const uint32_t words[] = {0x46546c67, version, whole, (uint32_t)json_size, 0x4E4F534A};
    memcpy(glb, words, 20);
    memcpy(glb + 20, json, json_size);
    memcpy(glb + 20 + json_size, tail, tail_size);
    *size = whole;
}

static void test_containers(void **state)
{
    (void)state;
    unsigned char glb[256];
    size_t size;
    static const char none[] = "{\"asset\":{\"version\":\"2.0\"}} ";
    refuse("", 0, "", "the file is empty");
    refuse("glTF\2\0\0", 8, "", "too short for a GLB");
    refuse("{}", (size_t)5 << 30, "", "larger than 4 GiB"); /* said before a byte is looked at */
    wrap(none, sizeof none - 1, "", 0, 1, glb, &size);
    refuse(glb, size, "", "glTF version 1 (export it as 2.0)");
    wrap(none, sizeof none - 1, "", 0, 2, glb, &size);
    refuse(glb, size, "", "no triangles");
    wrap(none, sizeof none - 1, "\4\0\0\0BIN\0", 8, 2, glb, &size);
    refuse(glb, size, "", "binary chunk that reaches beyond its end");
}

static void test_text(void **state)
{
    (void)state;
    char deep[512] = "", *end = deep;
    for (int i = 0; i < 201; i++)
        *end++ = i % 2 ? '{' : '[';
    refuse_text(deep, "deeper than 200 levels");
    /* Brackets within text count for nothing, nor does a quote behind a backslash end it. */
    memset(deep, '[', 300);
    memcpy(deep, "{\"\\\"", 4);
    refuse_text(deep, "not a glTF file that can be read");
    refuse_text("]]", "not a glTF file that can be read");
    refuse_text("{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":4}],\"bufferViews\":[{"
                "\"extensions\":{\"EXT_meshopt_compression\":{}}}]}",
                "compressed by EXT_meshopt_compression");
}

static void test_extensions(void **state)
{
    (void)state;
    const struct {
        const char *name, *expected; /* NULL: known */
    } cases[] = {{"KHR_texture_transform", NULL},
                 {"KHR_materials_unlit", NULL},
                 {"EXT_other", "needs the extension EXT_other, which is not known"},
                 {"EXT_compression_of_old", "(export it without compression)"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char rest[1024];
        snprintf(rest, sizeof rest, "\"extensionsRequired\":[\"%s\"],%s", cases[i].name,
                 PLAIN("{\"attributes\":{\"POSITION\":0},\"mode\":5}"));
        if (cases[i].expected)
            bad(square, sizeof square, rest, cases[i].expected);
        else
            check(square, sizeof square, rest, 2, 2);
    }
}

/* --- files named --- */

static char folder[64];

static void write_bytes(const char *name, const void *bytes, size_t size)
{
    char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

/* A square whose buffer stands in the file of this name. */
static void name_file(const char *name, char *text, size_t room)
{
    int length = snprintf(
        text, room, "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":48,\"uri\":\"%s\"}],%s}",
        name, PLAIN("{\"attributes\":{\"POSITION\":0},\"mode\":5}"));
    assert_true(length > 0 && (size_t)length < room);
}

static void read_named(const char *name, const char *from)
{
    char text[1024];
    shape_mesh *mesh;
    shape_error error;
    name_file(name, text, sizeof text);
    if (shape_gltf_decode("a.gltf", from, text, strlen(text), &mesh, &error))
        fail_msg("%s from \"%s\": %s", name, from, error.text);
    assert_int_equal(mesh->triangle_count, 2);
    shape_mesh_destroy(mesh);
}

static void refuse_named(const char *name, const char *expected)
{
    char text[1024];
    name_file(name, text, sizeof text);
    refuse(text, strlen(text), folder, expected);
}

static void test_named_files(void **state)
{
    (void)state;
    char path[128], before[512], from_root[160];
    strcpy(folder, "/tmp/gltf_refused.XXXXXX");
    assert_non_null(mkdtemp(folder));
    write_bytes("s.bin", square, sizeof square);
    snprintf(path, sizeof path, "%s/in", folder);
    assert_int_equal(mkdir(path, 0700), 0);
    snprintf(path, sizeof path, "%s/link.bin", folder);
    assert_int_equal(symlink("/etc/passwd", path), 0);

    read_named("s.bin", folder);
    snprintf(from_root, sizeof from_root, "%s/s.bin", folder + 1);
    read_named(from_root, "/"); /* in the root's folder everything lies within */
    assert_non_null(getcwd(before, sizeof before));
    assert_int_equal(chdir(folder), 0);
    read_named("s.bin", ""); /* the current folder */
    assert_int_equal(chdir(before), 0);

    static const char *const outside[] = {
        "in/../../x.bin", "..",       "/etc/passwd",     "\\\\\\\\host\\\\x",
        "C:x.bin",        "a..\\\\x", "http://host/x.b", "in/data:\\u0001/../x"};
    for (size_t i = 0; i < sizeof outside / sizeof *outside; i++)
        refuse_named(outside[i], "outside its own folder (put the file beside it)");
    refuse_named("none.bin", "which is not there (export as GLB, or copy it along)");
    refuse_named("link.bin", "a link to outside its own folder (copy the file)");
    refuse_named("in", "names a file that cannot be read");
    refuse_named("s.PNG", "not a glTF file that can be read"); /* pictures are not read */

    unlink(path);
    snprintf(path, sizeof path, "%s/s.bin", folder);
    unlink(path);
    snprintf(path, sizeof path, "%s/in", folder);
    rmdir(path);
    assert_int_equal(rmdir(folder), 0); /* nothing else was left there */
}

/* --- nodes --- */

static void test_nodes(void **state)
{
    (void)state;
    /* Without scenes, what is no node's child stands first; a child that there is not is a mistake. */
    check(square, sizeof square, NODES("\"nodes\":[{\"children\":[1]},{\"mesh\":0}]"), 2, 2);
    bad(square, sizeof square, NODES("\"nodes\":[{\"children\":[1,7]},{\"mesh\":0}]"), "node 7");
    bad(square, sizeof square, NODES("\"nodes\":[{\"children\":[-1]},{\"mesh\":0}]"), "node -1");
    bad(square, sizeof square, NODES("\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}],\"scene\":3"),
        "scene 3");
    bad(square, sizeof square, NODES("\"nodes\":[{\"mesh\":0,\"rotation\":[0,0,0,0]}]"), "rotation is zero");
    bad(square, sizeof square,
        NODES("\"nodes\":[{\"mesh\":0,\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,1e999,0,0,1]}]"),
        "not a glTF file that can be read"); /* a number that JSON's reader refuses */
    bad(square, sizeof square,
        NODES("\"nodes\":[{\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{}}}}]"),
        "EXT_mesh_gpu_instancing");
}

static void test_primitives(void **state)
{
    (void)state;
    shape_mesh *mesh = good(square, sizeof square,
                            PLAIN("{\"attributes\":{\"POSITION\":0},\"mode\":5},"
                                  "{\"attributes\":{\"NORMAL\":0},\"mode\":5}," /* nothing to show */
                                  "{\"attributes\":{\"POSITION\":0},\"mode\":9}"));
    assert_int_equal(mesh->triangle_count, 2);
    assert_int_equal(mesh->counts.skipped, 2);
    shape_mesh_destroy(mesh);
    /* Draco beside plain data is passed over; without such data there is nothing to read. */
#define DRACO                                                                                                \
    "{\"attributes\":{\"POSITION\":0},\"mode\":5,\"extensions\":{\"KHR_draco_mesh_compression\":{"           \
    "\"bufferView\":0,\"attributes\":{\"POSITION\":0}}}}"
    check(square, sizeof square, PLAIN(DRACO), 2, 2);
    bad(square, sizeof square,
        "\"bufferViews\":[" SQUARE_VIEW
        "],\"accessors\":[{\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}],"
        "\"meshes\":[{\"primitives\":[" DRACO "]}]," ONE_NODE,
        "compressed by KHR_draco_mesh_compression");
    for (int i = 0; i < 3; i++) {
        float wrong[12];
        memcpy(wrong, square, sizeof wrong);
        wrong[i] = INFINITY;
        bad(wrong, sizeof wrong, PLAIN("{\"attributes\":{\"POSITION\":0},\"mode\":5}"),
            "not a finite number");
    }
}

/* --- accessors --- */

static void refuse_accessor(const char *view, const char *accessor, const char *expected)
{
    char rest[1024];
    snprintf(rest, sizeof rest, "\"bufferViews\":[%s],\"accessors\":[%s]," STRIP, view, accessor);
    bad(square, sizeof square, rest, expected);
}

static void test_accessors(void **state)
{
    (void)state;
    refuse_accessor("{\"buffer\":0,\"byteLength\":48,\"extensions\":{\"EXT_meshopt_compression\":{}}}",
                    SQUARE_ACCESSOR, "compressed by EXT_meshopt_compression");
    refuse_accessor("{\"buffer\":0,\"byteOffset\":49,\"byteLength\":1}", SQUARE_ACCESSOR,
                    "beyond its buffer");
    refuse_accessor("{\"buffer\":0,\"byteLength\":48,\"byteStride\":8}", SQUARE_ACCESSOR,
                    "lie closer together than they are long");
    refuse_accessor(SQUARE_VIEW, "{\"bufferView\":0,\"componentType\":5126,\"count\":0,\"type\":\"VEC3\"}",
                    "no triangles");
    refuse_accessor(SQUARE_VIEW, "{\"bufferView\":0,\"componentType\":5130,\"count\":1,\"type\":\"VEC3\"}",
                    "unknown component type 5130");
#define SPARSE_OF(count, indices_type, offset)                                                               \
    "{\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"sparse\":{\"count\":" count                     \
    ",\"indices\":{\"bufferView\":0,\"componentType\":" indices_type ",\"byteOffset\":" offset               \
    "},\"values\":{\"bufferView\":0}}}"
    refuse_accessor(SQUARE_VIEW, SPARSE_OF("5", "5121", "0"), "more elements than it has in all");
    refuse_accessor(SQUARE_VIEW, SPARSE_OF("-1", "5121", "0"), "more elements than it has in all");
    refuse_accessor(SQUARE_VIEW, SPARSE_OF("1", "5126", "0"), "whose indices are not whole numbers");
    refuse_accessor(SQUARE_VIEW, SPARSE_OF("1", "5121", "-1"), "negative byteOffset");
    refuse_accessor(SQUARE_VIEW, SPARSE_OF("1", "5121", "48"), "need 1 bytes from byte 48");
    refuse_accessor(SQUARE_VIEW, SPARSE_OF("1", "5123", "48"), "need 2 bytes from byte 48");
}

/* The square in whole numbers of each kind, 0 and `one`: components, normalised or not. */
static void test_components(void **state)
{
    (void)state;
    const struct {
        int type, width;
        uint32_t one;
        const char *normalized;
        double side;
    } kinds[] = {
        {5120, 1, 127, "true", 1},    {5120, 1, 3, "false", 3},         {5121, 1, 255, "true", 1},
        {5121, 1, 200, "false", 200}, {5122, 2, 32767, "true", 1},      {5122, 2, 300, "false", 300},
        {5123, 2, 65535, "true", 1},  {5123, 2, 60000, "false", 60000}, {5125, 4, 100000, "false", 100000}};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        unsigned char bytes[48] = {0};
        char rest[1024];
        for (int i = 0; i < 12; i++)
            for (int b = 0; b < kinds[k].width && square[i] > 0; b++)
                bytes[i * kinds[k].width + b] = (unsigned char)(kinds[k].one >> 8 * b);
        snprintf(rest, sizeof rest,
                 "\"bufferViews\":[" SQUARE_VIEW "],\"accessors\":[{\"bufferView\":0,\"componentType\":%d,"
                 "\"normalized\":%s,\"count\":4,\"type\":\"VEC3\"}]," STRIP,
                 kinds[k].type, kinds[k].normalized);
        check(bytes, sizeof bytes, rest, 2, 2 * kinds[k].side * kinds[k].side);
    }
}

/* Indices as this accessor, of a view of this stride. */
static void refuse_indices(const char *stride, const char *accessor, const char *expected)
{
    unsigned char bytes[48 + 24] = {0};
    char rest[1024];
    memcpy(bytes, square, 48);
    snprintf(rest, sizeof rest,
             "\"bufferViews\":[" SQUARE_VIEW ",{\"buffer\":0,\"byteOffset\":48,\"byteLength\":24%s}],"
             "\"accessors\":[" SQUARE_ACCESSOR ",{%s}],\"meshes\":[{\"primitives\":[{\"attributes\":{"
             "\"POSITION\":0},\"indices\":1}]}]," ONE_NODE,
             stride, accessor);
    bad(bytes, sizeof bytes, rest, expected);
}

static void test_indices(void **state)
{
    (void)state;
#define COUNT3 ",\"count\":3,\"type\":\"SCALAR\""
    refuse_indices("", "\"bufferView\":1,\"componentType\":5121,\"count\":3,\"type\":\"VEC2\"",
                   "not whole numbers of 8, 16 or 32 bits");
    refuse_indices("", "\"bufferView\":1,\"componentType\":5126" COUNT3,
                   "not whole numbers of 8, 16 or 32 bits");
    refuse_indices("", "\"componentType\":5125" COUNT3, "invalid bufferView");
    refuse_indices("",
                   "\"bufferView\":1,\"componentType\":5125" COUNT3
                   ",\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":1,\"componentType\":5121},"
                   "\"values\":{\"bufferView\":1}}",
                   "indices are a sparse accessor");
    refuse_indices(",\"byteStride\":2", "\"bufferView\":1,\"componentType\":5125" COUNT3, "byteStride");
    /* 12 bytes apart there is room for two of them. */
    refuse_indices(",\"byteStride\":12", "\"bufferView\":1,\"componentType\":5125" COUNT3, "need 28 bytes");
}

/* --- skins --- */

/* The square, its joints (bytes, four a corner), its weights (floats, four a corner) and two bind matrices. */
typedef struct skinned {
    float points[12];
    unsigned char joints[16];
    float weights[16];
    float binds[32];
} skinned;

static skinned make_skinned(void)
{
    skinned made = {.weights = {0}};
    memcpy(made.points, square, sizeof square);
    for (int i = 0; i < 4; i++)
        made.weights[4 * i] = 1;
    for (int i = 0; i < 32; i++)
        made.binds[i] = i % 16 % 5 == 0;
    return made;
}

/* attributes, skin and count of weights; node 1 is the joint, moved by 5 and made twice as large. */
static void write_skin(const char *attributes, const char *skin, int weights, char *rest, size_t room)
{
    int length = snprintf(
        rest, room,
        "\"bufferViews\":[" SQUARE_VIEW ",{\"buffer\":0,\"byteOffset\":48,\"byteLength\":16},"
        "{\"buffer\":0,\"byteOffset\":64,\"byteLength\":64},{\"buffer\":0,\"byteOffset\":128,\"byteLength\":"
        "128}],"
        "\"accessors\":[" SQUARE_ACCESSOR
        ",{\"bufferView\":1,\"componentType\":5121,\"count\":4,\"type\":\"VEC4\"},"
        "{\"bufferView\":2,\"componentType\":5126,\"count\":%d,\"type\":\"VEC4\"},"
        "{\"bufferView\":3,\"componentType\":5126,\"count\":1,\"type\":\"MAT4\"}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0%s},\"mode\":5}]}],\"skins\":[%s],"
        "\"nodes\":[{\"mesh\":0,\"skin\":0},{\"translation\":[5,0,0],\"scale\":[2,2,2]}],"
        "\"scenes\":[{\"nodes\":[0,1]}]",
        weights, attributes, skin);
    assert_true(length > 0 && (size_t)length < room);
}

#define SKIN_OF ",\"JOINTS_0\":1,\"WEIGHTS_0\":2"

static void refuse_skin(const skinned *bytes, const char *attributes, const char *skin, int weights,
                        const char *expected)
{
    char rest[2048];
    write_skin(attributes, skin, weights, rest, sizeof rest);
    bad(bytes, sizeof *bytes, rest, expected);
}

static void test_skins(void **state)
{
    (void)state;
    skinned bytes = make_skinned();
    char rest[2048];
    static const char bound[] = "{\"joints\":[1],\"inverseBindMatrices\":3}", plain[] = "{\"joints\":[1]}";
    write_skin(SKIN_OF, bound, 4, rest, sizeof rest);
    check(&bytes, sizeof bytes, rest, 2, 8); /* twice as large each way */
    write_skin(SKIN_OF, plain, 4, rest, sizeof rest);
    check(&bytes, sizeof bytes, rest, 2, 8); /* bind matrices left out are the identity */

    refuse_skin(&bytes, "", plain, 4, "without joints and weights");
    refuse_skin(&bytes, ",\"JOINTS_0\":1", plain, 4, "without joints and weights");
    refuse_skin(&bytes, ",\"JOINTS_0\":1,\"WEIGHTS_0\":2", plain, 3, "fewer joints or weights than vertices");
    refuse_skin(&bytes, SKIN_OF, "{\"joints\":[1,0],\"inverseBindMatrices\":3}", 4,
                "fewer inverse bind matrices than joints");
    refuse_skin(&bytes, SKIN_OF, "{\"joints\":[9]}", 4, "node 9");
    bytes.binds[12] = INFINITY;
    refuse_skin(&bytes, SKIN_OF, bound, 4, "transform that is not finite");
    bytes = make_skinned();
    bytes.joints[4] = 1;
    refuse_skin(&bytes, SKIN_OF, plain, 4, "names a joint that its skin does not have");
    bytes.weights[4] = 0; /* a corner without weights stays where it is, whatever joint it names */
    write_skin(SKIN_OF, plain, 4, rest, sizeof rest);
    shape_mesh *mesh = good(&bytes, sizeof bytes, rest);
    assert_true(fabs(mesh->points[0].x - 5) < 1e-9 && fabs(mesh->points[1].x - 1) < 1e-9);
    shape_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_containers), cmocka_unit_test(test_text),
                                       cmocka_unit_test(test_extensions), cmocka_unit_test(test_named_files),
                                       cmocka_unit_test(test_nodes),      cmocka_unit_test(test_primitives),
                                       cmocka_unit_test(test_accessors),  cmocka_unit_test(test_components),
                                       cmocka_unit_test(test_indices),    cmocka_unit_test(test_skins)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
