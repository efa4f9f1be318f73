/* Meshes word by word: each mistake that an OBJ, PLY, STL or OFF file can hold is refused with its place, and the nearest file
 * without it is read; what a file is, is told from its name or its first bytes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "shape/mesh.h"
#include "shape/meshfit.h"

static void refuse_bytes(shape_mesh_format format, const void *bytes, size_t size, const char *words)
{
    shape_mesh *mesh = NULL;
    shape_error error = {.text = ""};
    assert_int_equal(shape_mesh_decode(format, "a", bytes, size, &mesh, &error), SHAPE_ERROR_FORMAT);
    assert_null(mesh);
    if (!strstr(error.text, words))
        fail_msg("\"%s\" does not say \"%s\"", error.text, words);
}

static void refuse(shape_mesh_format format, const char *text, const char *words)
{
    refuse_bytes(format, text, strlen(text), words);
}

static void read_bytes(shape_mesh_format format, const void *bytes, size_t size, size_t triangles)
{
    shape_mesh *mesh;
    shape_error error = {.text = ""};
    if (shape_mesh_decode(format, "a", bytes, size, &mesh, &error))
        fail_msg("%s", error.text);
    assert_int_equal(mesh->triangle_count, triangles);
    shape_mesh_destroy(mesh);
}

static void read_good(shape_mesh_format format, const char *text, size_t triangles)
{
    read_bytes(format, text, strlen(text), triangles);
}

#define CORNERS "0 0 0\n1 0 0\n0 1 0\n"

static void test_off(void **state)
{
    (void)state;
    read_good(SHAPE_MESH_OFF, "OFF\n3 1 0\n" CORNERS "3 0 1 2\n", 1);
    read_good(SHAPE_MESH_OFF, "# a\nSTCNOFF # b\n3 1 0 # c\n# d\n" CORNERS "3 0 1 2 0.5 0.5\n", 1);
    refuse(SHAPE_MESH_OFF, "OF", "does not begin with OFF");
    refuse(SHAPE_MESH_OFF, "OFX\n", "does not begin with OFF");
    refuse(SHAPE_MESH_OFF, "4OFF\n", "four or n dimensions");
    refuse(SHAPE_MESH_OFF, "nOFF\n", "four or n dimensions");
    refuse(SHAPE_MESH_OFF, "OFF BINARY\n", "binary OFF");
    refuse(SHAPE_MESH_OFF, "OFF BINARX\n", "a:1:5");
    refuse(SHAPE_MESH_OFF, "OFF -1 0 0\n", "an impossible number of vertices");
    refuse(SHAPE_MESH_OFF, "OFF 4294967296 0 0\n", "an impossible number of vertices");
    refuse(SHAPE_MESH_OFF, "OFF 3 -1 0\n", "an impossible number of faces");
    refuse(SHAPE_MESH_OFF, "OFF 3 1 -1\n", "an impossible number of edges");
    refuse(SHAPE_MESH_OFF, "OFF\n3 1 0\n" CORNERS "-3 0 1 2\n", "an impossible number of corners");
    refuse(SHAPE_MESH_OFF, "OFF\n3 1 0\n" CORNERS "3 0 1 -2\n", "an impossible vertex");
    refuse(SHAPE_MESH_OFF, "OFF\n3 1 0\n" CORNERS "3 0 1 3\n", "");
    refuse(SHAPE_MESH_OFF, "OFF\n3 1 0\n0 0 0\n1 0\n", "a:");
}

#define FACET(outer, loop, vertex, endloop, endfacet)                                                        \
    "facet normal 0 0 1\n" outer " " loop "\n" vertex " 0 0 0\n" vertex " 1 0 0\n" vertex " 0 1 0\n" endloop \
    "\n" endfacet "\n"
#define GOOD_FACET FACET("outer", "loop", "vertex", "endloop", "endfacet")

static void test_stl(void **state)
{
    (void)state;
    unsigned char binary[84 + 50 + 1] = "solid, but binary";
    const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    read_good(SHAPE_MESH_STL, "solid a\n" GOOD_FACET "endsolid a\n", 1);
    read_good(SHAPE_MESH_STL,
              "solid a\n" GOOD_FACET "endsolid a\nsolid b\n" GOOD_FACET GOOD_FACET "endsolid b", 3);
    read_good(SHAPE_MESH_STL,
              "SOLID a\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\nVERTEX 0 1 0\nENDLOOP\n"
              "ENDFACET\nENDSOLID a\n",
              1);
    refuse(SHAPE_MESH_STL, "solid a\n" FACET("inner", "loop", "vertex", "endloop", "endfacet"),
           "\"outer loop\"");
    refuse(SHAPE_MESH_STL, "solid a\n" FACET("outer", "pool", "vertex", "endloop", "endfacet"),
           "\"outer loop\"");
    refuse(SHAPE_MESH_STL, "solid a\n" FACET("outer", "loop", "vortex", "endloop", "endfacet"), "\"vertex\"");
    refuse(SHAPE_MESH_STL, "solid a\n" FACET("outer", "loop", "vertex", "endpool", "endfacet"),
           "\"endloop\"");
    refuse(SHAPE_MESH_STL, "solid a\n" FACET("outer", "loop", "vertex", "endloop", "endface"), "\"endloop\"");
    refuse(SHAPE_MESH_STL, "solid a\n" GOOD_FACET "endsolid a\nliquid b\n", "\"solid\" is missing");
    refuse(SHAPE_MESH_STL, "solid a\n" GOOD_FACET "ensolid a\n", "\"facet\" or \"endsolid\"");
    refuse(SHAPE_MESH_STL, "solid a\nfacet\nouter loop\nvertex 0 0 x", "a:4:12");
    refuse(SHAPE_MESH_STL, "soli", "too few for an STL");
    memset(binary + 20, 0, sizeof binary - 20);
    binary[80] = 1;
    memcpy(binary + 96, corners, sizeof corners);
    read_bytes(SHAPE_MESH_STL, binary, 134, 1);
    read_bytes(SHAPE_MESH_STL, binary, 135, 1); /* a byte too many: its zeros still tell */
    refuse_bytes(SHAPE_MESH_STL, binary, 133, "says 1 facets");
    memset(binary, ' ', 80);
    read_bytes(SHAPE_MESH_STL, binary, 134, 1);
    binary[96 + 3] = 0x7f, binary[96 + 2] = 0x80; /* an infinity */
    refuse_bytes(SHAPE_MESH_STL, binary, 134, "not a finite number");
}

#define PLY_HEAD "ply\nformat ascii 1.0\n"
#define VERTICES "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
#define FACES "element face 1\nproperty list uchar int vertex_indices\n"

static void test_ply(void **state)
{
    (void)state;
    read_good(SHAPE_MESH_PLY,
              PLY_HEAD "comment a\nobj_info b\n" VERTICES FACES "end_header\n" CORNERS "3 0 1 2\n", 1);
    read_good(SHAPE_MESH_PLY,
              PLY_HEAD VERTICES
              "element face 1\nproperty list uchar int other\nproperty list uchar int vertex_index\n"
              "element empty 5\nend_header\n" CORNERS "2 7 7 3 0 1 2\n",
              1);
    refuse(SHAPE_MESH_PLY, "pyl\n", "does not begin with \"ply\"");
    refuse(SHAPE_MESH_PLY, PLY_HEAD VERTICES, "end_header is missing");
    refuse(SHAPE_MESH_PLY, PLY_HEAD "words\nend_header\n", "an unknown word in the header");
    refuse(SHAPE_MESH_PLY, "ply\n" VERTICES FACES "end_header\n", "names no format");
    refuse(SHAPE_MESH_PLY, PLY_HEAD FACES "end_header\n", "needs one element \"vertex\"");
    refuse(SHAPE_MESH_PLY, PLY_HEAD VERTICES FACES FACES "end_header\n", "at most one \"face\"");
    refuse(SHAPE_MESH_PLY, PLY_HEAD VERTICES VERTICES "end_header\n", "needs one element \"vertex\"");
    refuse(SHAPE_MESH_PLY, PLY_HEAD VERTICES "property float x\nend_header\n", "x, y and z, once each");
    refuse(SHAPE_MESH_PLY, PLY_HEAD VERTICES "element face 1\nproperty int vertex_indices\nend_header\n",
           "one list property vertex_indices");
    refuse(SHAPE_MESH_PLY,
           PLY_HEAD VERTICES "element face 1\nproperty list uchar float vertex_indices\nend_header\n",
           "must be whole numbers");
    refuse(SHAPE_MESH_PLY, PLY_HEAD VERTICES FACES "end_header\n" CORNERS "-3 0 1 2\n", "impossible length");
    refuse(SHAPE_MESH_PLY,
           PLY_HEAD VERTICES "element face 1\nproperty list float int vertex_indices\nend_header\n" CORNERS
                             "2.5 0 1 2\n",
           "");
    refuse(SHAPE_MESH_PLY, PLY_HEAD VERTICES FACES "end_header\n" CORNERS "3 0 1 -2\n", "names vertex -2");
    refuse(SHAPE_MESH_PLY, PLY_HEAD VERTICES FACES "end_header\n" CORNERS "3 0 1 9\n", "");
    /* Without faces it is no mesh. */
    refuse(SHAPE_MESH_PLY, PLY_HEAD VERTICES "element face 0\nend_header\n" CORNERS, "");
}

static void test_obj(void **state)
{
    (void)state;
#define OBJ_CORNERS "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
    read_good(SHAPE_MESH_OBJ, OBJ_CORNERS "f 1 2 3\n", 1);
    read_good(SHAPE_MESH_OBJ, OBJ_CORNERS "fo 1/1 2//3 -1/1/1 # a comment\n", 1);
    read_good(SHAPE_MESH_OBJ, OBJ_CORNERS "f 1 \\\n2 \\\r\n3\n", 1);
    refuse(SHAPE_MESH_OBJ, OBJ_CORNERS "f 1 2 \\3\n", "a face's corner must be a vertex number");
    refuse(SHAPE_MESH_OBJ, OBJ_CORNERS "f 1 2 3\\", "a face's corner must be a vertex number");
    refuse(SHAPE_MESH_OBJ, OBJ_CORNERS "f 1 2 0\n", "a face's corner must be a vertex number");
    refuse(SHAPE_MESH_OBJ, OBJ_CORNERS "f 1 2 -\n", "a face's corner must be a vertex number");
    refuse(SHAPE_MESH_OBJ, OBJ_CORNERS "f 1 2 3x\n", "a face's corner must be a vertex number");
    refuse(SHAPE_MESH_OBJ, OBJ_CORNERS "f 1 2 /3\n", "a face's corner must be a vertex number");
    refuse(SHAPE_MESH_OBJ, OBJ_CORNERS "f 1 2 -4\n", "counts back beyond the first");
    refuse(SHAPE_MESH_OBJ, OBJ_CORNERS "f 1 2 99999999999999999999\n", "does not exist");
    refuse(SHAPE_MESH_OBJ, OBJ_CORNERS "f 1 2 4\n", "");
    refuse(SHAPE_MESH_OBJ, "v 0 0 1e999\n", "a:1:7");
    refuse(SHAPE_MESH_OBJ, "v 0 nan 0\n", "a:1:");
    refuse(SHAPE_MESH_OBJ, "v 0 0 0x\n", "a:1:7");
    refuse_bytes(SHAPE_MESH_OBJ, "v 0 0\0 0\n", 9, "not a text");
}

static void expect_guess(const char *name, const char *bytes, size_t size, shape_mesh_format wanted)
{
    shape_mesh_format found = shape_mesh_format_guess(name, bytes, size);
    if (found != wanted)
        fail_msg("%s, %.10s: %s, not %s", name, bytes, shape_mesh_format_name(found),
                 shape_mesh_format_name(wanted));
}

static void test_guesses(void **state)
{
    (void)state;
    static const struct {
        const char *bytes;
        shape_mesh_format format;
    } cases[] = {
        {"", SHAPE_MESH_UNKNOWN},     {"glTF", SHAPE_MESH_GLB},        {"glT", SHAPE_MESH_UNKNOWN},
        {"ply\n", SHAPE_MESH_PLY},    {"ply\r\n", SHAPE_MESH_PLY},     {"ply ", SHAPE_MESH_UNKNOWN},
        {"solid x", SHAPE_MESH_STL},  {"# a\n\n", SHAPE_MESH_UNKNOWN}, {"\n {\n", SHAPE_MESH_GLTF},
        {"OFF 1", SHAPE_MESH_OFF},    {"# b\nNOFF", SHAPE_MESH_OFF},   {"STCNOFF", SHAPE_MESH_UNKNOWN},
        {"FF", SHAPE_MESH_UNKNOWN},   {"OFX", SHAPE_MESH_UNKNOWN},     {"v 1", SHAPE_MESH_OBJ},
        {"mtllib a", SHAPE_MESH_OBJ}, {"f 1", SHAPE_MESH_OBJ},         {"x 1", SHAPE_MESH_UNKNOWN}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        expect_guess("a", cases[i].bytes, strlen(cases[i].bytes), cases[i].format);
        expect_guess("a.unknown", cases[i].bytes, strlen(cases[i].bytes), cases[i].format);
        expect_guess("a.PLY", cases[i].bytes, strlen(cases[i].bytes), SHAPE_MESH_PLY);
    }
    char binary[135] = "";
    binary[80] = 1;
    expect_guess("a", binary, 134, SHAPE_MESH_STL);
    expect_guess("a", binary, 135, SHAPE_MESH_UNKNOWN);
    expect_guess("a", binary, 83, SHAPE_MESH_UNKNOWN);
    shape_mesh *mesh = NULL;
    shape_error error;
    const shape_mesh_format others[] = {SHAPE_MESH_UNKNOWN, SHAPE_MESH_GLTF};
    for (int i = 0; i < 2; i++) {
        assert_int_equal(shape_mesh_decode(others[i], "a", "v", 1, &mesh, &error), SHAPE_ERROR_ARGUMENT);
        assert_non_null(strstr(error.text, "not an OBJ, PLY, STL or OFF file"));
    }
    for (int f = SHAPE_MESH_OBJ; f <= SHAPE_MESH_OFF; f++)
        refuse_bytes((shape_mesh_format)f, "", 0, "the file is empty");
}

/* --- meshes in memory --- */

static void test_placement(void **state)
{
    (void)state;
    shape_error error;
    shape_dvec3 min, max;
    assert_null(shape_mesh_create(SIZE_MAX / 8, 1, &error));
    assert_null(shape_mesh_create(1, SIZE_MAX / 8, &error));
    shape_mesh *mesh = shape_mesh_create(3, 1, &error);
    assert_non_null(mesh);
    assert_false(shape_mesh_bounds(mesh, &min, &max)); /* without points there are none */
    for (uint32_t i = 0; i < 3; i++) {
        mesh->points[i] = shape_dvec3_make(i == 1, i == 2, 0);
        mesh->indices[i] = i;
    }
    mesh->point_count = 3;
    mesh->triangle_count = 1;
    /* Mirrored in x, a triangle is turned round, so that it still looks to +z. */
    shape_frame mirror = shape_frame_identity();
    mirror.m[0][0] = -1;
    shape_mesh_transform(mesh, &mirror);
    const shape_dvec3 *p = mesh->points;
    const uint32_t *c = mesh->indices;
    shape_dvec3 normal =
        shape_dvec3_cross(shape_dvec3_sub(p[c[1]], p[c[0]]), shape_dvec3_sub(p[c[2]], p[c[0]]));
    assert_true(normal.z == 1);
    assert_true(shape_mesh_bounds(mesh, &min, &max));
    assert_true(min.x == -1 && max.x == 0 && max.y == 1);
    shape_mesh_destroy(mesh);
    shape_mesh_destroy(NULL);
}

/* A fit to triangles that give no ellipsoid, and comparisons of nothing. */
static void test_fits_of_nothing(void **state)
{
    (void)state;
    shape_error error;
    shape_meshfit fit = shape_meshfit_defaults();
    shape_meshfit_measure measure;
    shape_primitives list = {0};
    shape_mesh *mesh = shape_mesh_create(3, 2, &error);
    assert_non_null(mesh);
    mesh->point_count = 3;
    mesh->triangle_count = 1;
    for (uint32_t i = 0; i < 3; i++) {
        mesh->points[i] = shape_dvec3_make(5, 5, 5); /* one point three times */
        mesh->indices[i] = i;
    }
    assert_int_equal(shape_meshfit_add(mesh, &fit, &list, &error), SHAPE_ERROR_LIMIT);
    assert_int_equal(shape_primitives_count(&list), 0);
    const double sizes[] = {1e-60, 1e60, INFINITY};
    for (int i = 0; i < 3; i++) { /* beyond single precision */
        mesh->points[1] = shape_dvec3_make(5 + sizes[i], 5, 5);
        mesh->points[2] = shape_dvec3_make(5, 5 + sizes[i], 5);
        assert_int_equal(shape_meshfit_add(mesh, &fit, &list, &error), SHAPE_ERROR_LIMIT);
    }
    fit.scale = 0;
    assert_int_equal(shape_meshfit_add(mesh, &fit, &list, &error), SHAPE_ERROR_ARGUMENT);
    mesh->points[1] = shape_dvec3_make(6, 5, 5);
    mesh->points[2] = shape_dvec3_make(5, 6, 5);
    assert_int_not_equal(shape_meshfit_compare(mesh, &list, 10, &measure, &error),
                         SHAPE_OK); /* no primitives */
    fit.scale = 1.1;
    assert_int_equal(shape_meshfit_add(mesh, &fit, &list, &error), SHAPE_OK);
    assert_int_not_equal(shape_meshfit_compare(mesh, &list, 0, &measure, &error), SHAPE_OK);
    assert_int_equal(shape_meshfit_compare(mesh, &list, 10, &measure, &error), SHAPE_OK);
    assert_true(measure.covered > 0 && measure.covered <= 1);
    mesh->triangle_count = 0;
    assert_int_not_equal(shape_meshfit_compare(mesh, &list, 10, &measure, &error), SHAPE_OK);
    free(list.ellipsoids);
    shape_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_off),
                                       cmocka_unit_test(test_stl),
                                       cmocka_unit_test(test_ply),
                                       cmocka_unit_test(test_obj),
                                       cmocka_unit_test(test_guesses),
                                       cmocka_unit_test(test_placement),
                                       cmocka_unit_test(test_fits_of_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
