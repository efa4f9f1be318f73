/* For tests of glTF: files of one buffer, written here, of which every triangle is known. For one source file of a
 * program. */
#ifndef GLTF_SAMPLE_H
#define GLTF_SAMPLE_H

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

/* A unit square in x, y: 0,0  1,0  0,1  1,1 (the order of a strip). */
static const float square[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};

static void base64(const unsigned char *bytes, size_t size, char *text)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        uint32_t word = (uint32_t)bytes[i] << 16;
        word |= i + 1 < size ? (uint32_t)bytes[i + 1] << 8 : 0;
        word |= i + 2 < size ? bytes[i + 2] : 0;
        for (int k = 0; k < 4; k++)
            *text++ = i + (size_t)k > size ? '=' : digits[word >> (18 - 6 * k) & 63];
    }
    *text = 0;
}

/* A file of one buffer and the JSON that follows it: bufferViews, accessors, meshes, nodes. */
static shape_status decode(const void *bytes, size_t size, const char *rest, shape_mesh **mesh,
                           shape_error *error)
{
    static char coded[2048], text[16384];
    assert_true(size < 1500);
    base64(bytes, size, coded);
    int length = snprintf(text, sizeof text,
                          "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":%zu,\"uri\":"
                          "\"data:application/octet-stream;base64,%s\"}],%s}",
                          size, coded, rest);
    assert_true(length > 0 && (size_t)length < sizeof text);
    return shape_gltf_decode("test.gltf", "", text, (size_t)length, mesh, error);
}

static inline shape_mesh *good(const void *bytes, size_t size, const char *rest)
{
    shape_mesh *mesh = NULL;
    shape_error error;
    if (decode(bytes, size, rest, &mesh, &error))
        fail_msg("%s", error.text);
    return mesh;
}

static inline void bad(const void *bytes, size_t size, const char *rest, const char *expected)
{
    shape_mesh *mesh = NULL;
    shape_error error = {.text = ""};
    assert_int_equal(decode(bytes, size, rest, &mesh, &error), SHAPE_ERROR_FORMAT);
    if (!strstr(error.text, expected))
        fail_msg("expected \"%s\" in: %s", expected, error.text);
}

/* Twice the sum of the triangles' area vectors along z: 2 for the square seen from +z. */
static inline double area_z(const shape_mesh *mesh)
{
    double sum = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        shape_dvec3 a = mesh->points[mesh->indices[3 * t]], b = mesh->points[mesh->indices[3 * t + 1]],
                    c = mesh->points[mesh->indices[3 * t + 2]];
        sum += shape_dvec3_cross(shape_dvec3_sub(b, a), shape_dvec3_sub(c, a)).z;
    }
    return sum;
}

static inline void check(const void *bytes, size_t size, const char *rest, size_t triangles,
                         double twice_area)
{
    shape_mesh *mesh = good(bytes, size, rest);
    assert_int_equal(mesh->triangle_count, triangles);
    if (fabs(area_z(mesh) - twice_area) > 1e-6)
        fail_msg("area %g, expected %g", area_z(mesh), twice_area);
    shape_mesh_destroy(mesh);
}

#define ONE_NODE "\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}],\"scene\":0"
#define SQUARE_VIEW "{\"buffer\":0,\"byteOffset\":0,\"byteLength\":48}"
#define SQUARE_ACCESSOR "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}"
#define PLAIN(primitive)                                                                                     \
    "\"bufferViews\":[" SQUARE_VIEW "],\"accessors\":[" SQUARE_ACCESSOR                                      \
    "],\"meshes\":[{\"primitives\":[" primitive "]}]," ONE_NODE

#define STRIP "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"mode\":5}]}]," ONE_NODE

#define NODES(nodes)                                                                                         \
    "\"bufferViews\":[" SQUARE_VIEW "],\"accessors\":[" SQUARE_ACCESSOR "],\"meshes\":[{\"primitives\":[{"   \
    "\"attributes\":{\"POSITION\":0},\"mode\":5}]}]," nodes

#endif
