/* PLY: the same tetrahedron in every type of number, as text and in both byte orders, is the same mesh to the last bit
 * (its coordinates are small whole numbers, which all types hold); what a header may not say is refused, and why. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "shape/mesh.h"

enum { ROOM = 8192 };

static const int points[4][3] = {{0, 0, 0}, {3, 0, 0}, {0, 4, 0}, {0, 0, 5}};
static const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

typedef enum byte_order { TEXT, LITTLE, BIG } byte_order;

typedef struct file {
    char bytes[ROOM];
    size_t size;
    byte_order order;
} file;

static void add_bytes(file *f, uint64_t word, int size)
{
    for (int i = 0; i < size; i++)
        f->bytes[f->size++] = (char)(word >> 8 * (f->order == BIG ? size - 1 - i : i));
}

static void add_number(file *f, const char *type, int value)
{
    float single = (float)value;
    double twice = value;
    uint32_t low;
    uint64_t word = (uint64_t)(int64_t)value;
    if (f->order == TEXT) {
        f->size += (size_t)sprintf(f->bytes + f->size, "%d ", value);
    } else if (strstr(type, "float32")) {
        memcpy(&low, &single, sizeof low);
        add_bytes(f, low, 4);
    } else if (strstr(type, "float64")) {
        memcpy(&word, &twice, sizeof word);
        add_bytes(f, word, 8);
    } else {
        add_bytes(f, word, strchr(type, '8') ? 1 : strstr(type, "16") ? 2 : 4);
    }
}

static void make(file *f, byte_order order, const char *coordinate, const char *corner)
{
    static const char *const formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    f->order = order;
    f->size =
        (size_t)sprintf(f->bytes,
                        "ply\nformat %s 1.0\ncomment nothing\nelement vertex 4\nproperty %s x\nproperty "
                        "%s y\nproperty %s z\nelement face 4\nproperty list uint8 %s vertex_indices\n"
                        "end_header\n",
                        formats[order], coordinate, coordinate, coordinate, corner);
    for (int i = 0; i < 4; i++)
        for (int axis = 0; axis < 3; axis++)
            add_number(f, coordinate, points[i][axis]);
    for (int i = 0; i < 4; i++) {
        add_number(f, "uint8", 3);
        for (int k = 0; k < 3; k++)
            add_number(f, corner, faces[i][k]);
    }
    f->bytes[f->size] = 0;
}

static void expect_tetrahedron(const file *f)
{
    shape_mesh *mesh = NULL;
    shape_error error = {SHAPE_OK, ""};
    if (shape_mesh_decode(SHAPE_MESH_PLY, "t", f->bytes, f->size, &mesh, &error))
        fail_msg("%s", error.text);
    assert_true(mesh->point_count == 4 && mesh->triangle_count == 4);
    for (int i = 0; i < 4; i++) {
        assert_true(mesh->points[i].x == points[i][0] && mesh->points[i].y == points[i][1] &&
                    mesh->points[i].z == points[i][2]);
        for (int k = 0; k < 3; k++)
            assert_int_equal(mesh->indices[3 * i + k], faces[i][k]);
    }
    shape_mesh_destroy(mesh);
}

static void every_type_in_every_order_is_the_same_mesh(void **state)
{
    (void)state;
    static const char *const types[] = {"int8",  "uint8",  "int16",   "uint16",
                                        "int32", "uint32", "float32", "float64"};
    static file f;
    for (int order = TEXT; order <= BIG; order++)
        for (size_t a = 0; a < 8; a++)
            for (size_t b = 0; b < 6; b++) {
                make(&f, (byte_order)order, types[a], types[b]);
                expect_tetrahedron(&f);
            }
}

static void refuse(const char *text, size_t size, const char *part)
{
    shape_mesh *mesh = NULL;
    shape_error error = {SHAPE_OK, ""};
    assert_int_equal(shape_mesh_decode(SHAPE_MESH_PLY, "t", text, size, &mesh, &error), SHAPE_ERROR_FORMAT);
    assert_null(mesh);
    if (strncmp(error.text, "t:", 2) || !strstr(error.text, part))
        fail_msg("\"%s\" does not say \"%s\"", error.text, part);
}

static void headers_are_refused_with_a_reason(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"ply\nelement vertex 3\nend_header\n", "names no format"},
        {"ply\nformat utf8 1.0\nend_header\n", "must be ascii"},
        {"ply\nformat ascii 2.0\nend_header\n", "only PLY version 1.0"},
        {"ply\nformat ascii 1.0\nelement vertex -3\nend_header\n", "impossible number"},
        {"ply\nformat ascii 1.0\nelement vertex 99999999999\nend_header\n", "impossible number"},
        {"ply\nformat ascii 1.0\nproperty float x\nend_header\n", "before the first element"},
        {"ply\nformat ascii 1.0\nelement face 1\nproperty list float int a\n",
         "must have a type of whole numbers"},
        {"ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\n", "unknown type"},
        {"ply\nformat ascii 1.0\nelement face 1\nproperty list uchar float vertex_indices\n",
         "whole numbers"},
        {"ply\nformat ascii 1.0\nnonsense\n", "unknown word"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        refuse(cases[i][0], strlen(cases[i][0]), cases[i][1]);
    static char many[ROOM];
    size_t size = (size_t)sprintf(many, "ply\nformat ascii 1.0\n");
    for (int i = 0; i < 33; i++)
        size += (size_t)sprintf(many + size, "element e%d 0\n", i);
    refuse(many, size, "more than 32 elements");
    size = (size_t)sprintf(many, "ply\nformat ascii 1.0\nelement vertex 1\n");
    for (int i = 0; i < 65; i++)
        size += (size_t)sprintf(many + size, "property float p%d\n", i);
    refuse(many, size, "more than 64 properties");
}

/* A corner of -1, in the last face of a binary file, and a file without its last byte. */
static void faces_are_refused_with_a_reason(void **state)
{
    (void)state;
    static file f;
    make(&f, LITTLE, "float32", "int32");
    refuse(f.bytes, f.size - 1, "cut off");
    memset(f.bytes + f.size - 4, 0xff, 4);
    refuse(f.bytes, f.size, "vertex -1");
    make(&f, BIG, "float64", "int16");
    f.bytes[f.size - 2] = 1; /* 256 + 3 */
    refuse(f.bytes, f.size, "vertex 259 of 4");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_type_in_every_order_is_the_same_mesh),
        cmocka_unit_test(headers_are_refused_with_a_reason),
        cmocka_unit_test(faces_are_refused_with_a_reason),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
