/* Meshes: every format gives the same Suzanne, repair and decimation keep their promises, hostile bytes give errors. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "shape/file.h"
#include "shape/mesh.h"
#include "shape/random.h"

#define MESHES EXAMPLES "/meshes/"

static shape_status decode(const char *path, const void *bytes, size_t size, shape_mesh **mesh,
                           shape_error *error)
{
    shape_mesh_format format = shape_mesh_format_guess(path, bytes, size);
    if (format == SHAPE_MESH_GLTF || format == SHAPE_MESH_GLB)
        return shape_gltf_decode(path, EXAMPLES "/meshes", bytes, size, mesh, error);
    return shape_mesh_decode(format, path, bytes, size, mesh, error);
}

static unsigned char *load(const char *name, size_t *size)
{
    char path[512];
    unsigned char *bytes;
    shape_error error;
    snprintf(path, sizeof path, MESHES "%s", name);
    if (shape_file_read(path, 1 << 24, &bytes, size, &error))
        fail_msg("%s", error.text);
    return bytes;
}

static shape_mesh *open_mesh(const char *name)
{
    size_t size;
    shape_mesh *mesh = NULL;
    shape_error error;
    unsigned char *bytes = load(name, &size);
    if (decode(name, bytes, size, &mesh, &error))
        fail_msg("%s", error.text);
    free(bytes);
    return mesh;
}

static shape_mesh *repaired(const char *name)
{
    shape_mesh *mesh = open_mesh(name);
    shape_error error;
    if (shape_mesh_repair(mesh, &error))
        fail_msg("%s: %s", name, error.text);
    return mesh;
}

static double area(const shape_mesh *mesh)
{
    double sum = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        shape_dvec3 a = mesh->points[mesh->indices[3 * t]], b = mesh->points[mesh->indices[3 * t + 1]],
                    c = mesh->points[mesh->indices[3 * t + 2]];
        sum += shape_dvec3_length(shape_dvec3_cross(shape_dvec3_sub(b, a), shape_dvec3_sub(c, a))) / 2;
    }
    return sum;
}

/* Signed: above 0 where the triangles look outwards. */
static double volume(const shape_mesh *mesh)
{
    double sum = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        shape_dvec3 a = mesh->points[mesh->indices[3 * t]], b = mesh->points[mesh->indices[3 * t + 1]],
                    c = mesh->points[mesh->indices[3 * t + 2]];
        sum += shape_dvec3_dot(a, shape_dvec3_cross(b, c)) / 6;
    }
    return sum;
}

static void turn_up(shape_mesh *mesh)
{
    const shape_frame frame = {{{1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}}};
    shape_mesh_transform(mesh, &frame);
}

/* Files carry 6 digits or a float, so boxes agree to 2e-6. */
static void test_formats_agree(void **state)
{
    (void)state;
    const struct {
        const char *name;
        bool z_up;
    } files[] = {{"suzanne.glb", false}, {"suzanne.gltf", false},    {"suzanne.obj", false},
                 {"suzanne.ply", true},  {"suzanne-text.ply", true}, {"suzanne.stl", true},
                 {"suzanne.off", true}};
    shape_dvec3 min, max, first_min = {0, 0, 0}, first_max = {0, 0, 0};
    double first_area = 0;
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        shape_mesh *mesh = repaired(files[i].name);
        if (files[i].z_up)
            turn_up(mesh);
        assert_int_equal(mesh->counts.triangles, 968);
        assert_true(mesh->triangle_count == 968);
        assert_int_equal(mesh->point_count, 505); /* Suzanne has 507, two of them where another is */
        assert_true(shape_mesh_bounds(mesh, &min, &max));
        if (!i) {
            first_min = min;
            first_max = max;
            first_area = area(mesh);
        }
        assert_true(shape_dvec3_length(shape_dvec3_sub(min, first_min)) < 4e-6);
        assert_true(shape_dvec3_length(shape_dvec3_sub(max, first_max)) < 4e-6);
        assert_true(fabs(area(mesh) - first_area) < 1e-4 * first_area);
        shape_mesh_destroy(mesh);
    }
}

/* The star prism: area of the star times two, and ten sides; whichever way its concave ten-gons are cut. A fan would
 * cover more than the star. */
static void test_ngon(void **state)
{
    (void)state;
    const char *const files[] = {"ngon.obj", "ngon.ply", "ngon.off", "ngon.gltf"};
    double pi = acos(-1), star = 10 * 0.5 * 0.4 * sin(pi / 5);
    double side = sqrt(1 + 0.16 - 0.8 * cos(pi / 5));
    for (int i = 0; i < 4; i++) {
        shape_mesh *mesh = repaired(files[i]);
        assert_int_equal(mesh->triangle_count, 36);
        assert_int_equal(mesh->counts.faces, i == 3 ? 36 : 12);
        assert_true(fabs(area(mesh) - 2 * star - 10 * side * 0.4) < 1e-5);
        assert_true(fabs(volume(mesh) - star * 0.4) < 1e-5);
        shape_mesh_destroy(mesh);
    }
}

/* A mirrored node: the same size, mirrored box, and still the outside outside. */
static void test_mirrored(void **state)
{
    (void)state;
    shape_mesh *plain = repaired("suzanne.glb"), *mirrored = repaired("mirrored.glb");
    shape_dvec3 min, max, other_min, other_max;
    shape_mesh_bounds(plain, &min, &max);
    shape_mesh_bounds(mirrored, &other_min, &other_max);
    assert_true(fabs(other_min.x - (1 - max.x)) < 1e-6 && fabs(other_max.x - (1 - min.x)) < 1e-6);
    assert_true(fabs(area(plain) - area(mirrored)) < 1e-5);
    assert_true(volume(plain) > 0 && fabs(volume(plain) - volume(mirrored)) < 1e-5);
    shape_mesh_destroy(plain);
    shape_mesh_destroy(mirrored);
}

/* Five nodes with one cube of side 1: three of volume 1, the parent of volume 2 and a child of it of volume 2. */
static void test_instances(void **state)
{
    (void)state;
    shape_mesh *mesh = repaired("instances.gltf");
    assert_int_equal(mesh->counts.instances, 5);
    assert_int_equal(mesh->triangle_count, 60);
    assert_true(fabs(volume(mesh) - 7) < 1e-5);
    shape_mesh_destroy(mesh);
}

/* The rest pose stands upright, whatever the animation does: 4 m tall, 0.4 m in radius. */
static void test_skinned(void **state)
{
    (void)state;
    shape_mesh *mesh = repaired("skinned.glb");
    shape_dvec3 min, max;
    shape_mesh_bounds(mesh, &min, &max);
    assert_true(mesh->counts.skinned && mesh->counts.animated);
    assert_true(fabs(min.y) < 1e-5 && fabs(max.y - 4) < 1e-5);
    assert_true(fabs(max.x - 0.4) < 1e-5 && fabs(min.z + 0.4) < 1e-5);
    shape_mesh_destroy(mesh);
}

static shape_mesh *from_text(const char *name, const char *text)
{
    shape_mesh *mesh = NULL;
    shape_error error;
    if (decode(name, text, strlen(text), &mesh, &error))
        fail_msg("%s", error.text);
    return mesh;
}

static void test_repair(void **state)
{
    (void)state;
    shape_mesh *mesh = from_text("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nv 2 0 0\nv 9 9 9\nv 0 0 1\n"
                                          "f 1 2 3\nf 4 2 3\nf 3 2 1\nf 1 2 5\nf 1 1 2\nf -7 -6 -1\n");
    assert_int_equal(shape_mesh_repair(mesh, NULL), SHAPE_OK);
    assert_int_equal(mesh->counts.faces, 6);
    assert_int_equal(mesh->counts.duplicate_points, 1);
    assert_int_equal(mesh->counts.duplicate_faces, 2);
    assert_int_equal(mesh->counts.zero_area, 2);
    assert_int_equal(mesh->triangle_count, 2);
    assert_int_equal(mesh->point_count, 4); /* 9,9,9 and 2,0,0 are nobody's */
    shape_mesh_destroy(mesh);
    shape_error error;
    mesh = from_text("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    assert_int_equal(shape_mesh_repair(mesh, &error), SHAPE_ERROR_FORMAT);
    shape_mesh_destroy(mesh);
}

/* 4 mm wide, 200 km away: the text's twelve digits must not pass through single precision. */
static void test_far_away(void **state)
{
    (void)state;
    shape_mesh *mesh =
        from_text("a.obj", "v 200000.000 0 0\nv 200000.004 0 0\nv 200000.000 0.003 0\nf 1 2 3\n");
    assert_int_equal(shape_mesh_repair(mesh, NULL), SHAPE_OK);
    assert_true(fabs(area(mesh) - 6e-6) < 1e-12); /* 3e-11 m of rounding on sides of 4e-3 m */
    shape_mesh_destroy(mesh);
}

/* Every point that is left was one before; the target is kept to; the shape too. */
static void test_decimate(void **state)
{
    (void)state;
    shape_mesh *mesh = repaired("torus.obj"), *before = repaired("torus.obj");
    assert_int_equal(shape_mesh_decimate(mesh, 370, NULL), SHAPE_OK);
    assert_int_equal(mesh->triangle_count, 370);
    assert_int_equal(mesh->point_count, 185); /* Euler: a torus has half as many points as triangles */
    for (size_t i = 0; i < mesh->point_count; i++) {
        bool found = false;
        for (size_t j = 0; j < before->point_count && !found; j++)
            found = !memcmp(&mesh->points[i], &before->points[j], sizeof mesh->points[i]);
        assert_true(found);
    }
    assert_true(fabs(volume(mesh) / volume(before) - 1) < 0.06);
    shape_mesh_destroy(mesh);
    shape_mesh_destroy(before);
}

/* A flat sheet has no curvature to keep, but its outline: 2 (n - 1)^2 triangles to 8 leave the area as it was. */
static void test_decimate_sheet(void **state)
{
    (void)state;
    enum { N = 12 };
    shape_mesh *mesh = shape_mesh_create(N * N, 2 * (N - 1) * (N - 1), NULL);
    assert_non_null(mesh);
    for (uint32_t y = 0; y < N; y++)
        for (uint32_t x = 0; x < N; x++) {
            mesh->points[mesh->point_count++] = shape_dvec3_make(x, y, 0);
            if (x + 1 == N || y + 1 == N)
                continue;
            uint32_t a = y * N + x, corner[6] = {a, a + 1, a + N + 1, a, a + N + 1, a + N};
            memcpy(&mesh->indices[3 * mesh->triangle_count], corner, sizeof corner);
            mesh->triangle_count += 2;
        }
    assert_int_equal(shape_mesh_decimate(mesh, 8, NULL), SHAPE_OK);
    assert_true(mesh->triangle_count <= 8);
    assert_true(fabs(area(mesh) - (N - 1) * (N - 1)) < 1e-6);
    shape_mesh_destroy(mesh);
}

static void test_non_manifold(void **state)
{
    (void)state;
    shape_mesh *mesh =
        from_text("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 2 5\n");
    assert_int_equal(shape_mesh_repair(mesh, NULL), SHAPE_OK);
    assert_int_equal(shape_mesh_decimate(mesh, 2, NULL), SHAPE_OK);
    assert_true(mesh->counts.non_manifold > 0 && mesh->triangle_count >= 1);
    shape_mesh_destroy(mesh);
}

/* Spheres inside a torus: each within the tube (up to a voxel), together most of it; none in an open hemisphere. */
static void test_fill(void **state)
{
    (void)state;
    shape_mesh *mesh = repaired("torus.obj");
    shape_primitives list = {0};
    size_t made;
    double voxel = 2.7 / 64;
    assert_int_equal(shape_mesh_fill(mesh, 60, 64, &list, &made, NULL), SHAPE_OK);
    assert_true(made > 20 && made <= 60 && made == list.sphere_count);
    for (size_t i = 0; i < made; i++) {
        shape_sphere s = list.spheres[i];
        double from_ring = hypot(hypot((double)s.x, (double)s.z) - 1, (double)s.y);
        assert_true(from_ring + (double)s.radius < 0.35 + voxel);
    }
    free(list.spheres);
    shape_mesh_destroy(mesh);
    shape_primitives none = {0};
    mesh = repaired("open.obj");
    size_t open;
    assert_int_equal(shape_mesh_open_edges(mesh, &open, NULL), SHAPE_OK);
    assert_int_equal(open, 32);
    assert_int_equal(shape_mesh_fill(mesh, 60, 64, &none, &made, NULL), SHAPE_OK);
    assert_int_equal(made, 0);
    shape_mesh_destroy(mesh);
}

/* Cut at many places and with bytes changed: an error with a text, or a mesh whose indices are in range. The zero byte
 * behind the bytes is as shape_file_read leaves it. */
static void hurt(const char *name, const unsigned char *bytes, size_t size)
{
    unsigned char *copy = malloc(size + 1);
    shape_mesh *mesh = NULL;
    shape_error error = {.text = ""};
    assert_non_null(copy);
    memcpy(copy, bytes, size);
    copy[size] = 0;
    if (decode(name, copy, size, &mesh, &error)) {
        assert_true(strlen(error.text) > strlen(name) && !strchr(error.text, '\n'));
    } else {
        assert_true(mesh->triangle_count > 0);
        for (size_t i = 0; i < 3 * mesh->triangle_count; i++)
            assert_true(mesh->indices[i] < mesh->point_count);
        for (size_t i = 0; i < mesh->point_count; i++)
            assert_true(isfinite(mesh->points[i].x + mesh->points[i].y + mesh->points[i].z));
        shape_mesh_destroy(mesh);
    }
    free(copy);
}

static void test_hostile(void **state)
{
    (void)state;
    const char *const files[] = {"ngon.obj",    "ngon.ply",    "ngon.off",    "ngon.gltf",
                                 "suzanne.ply", "suzanne.stl", "skinned.glb", "instances.gltf"};
    shape_random random = shape_random_seed(3, 0);
    for (size_t f = 0; f < sizeof files / sizeof *files; f++) {
        size_t size;
        unsigned char *bytes = load(files[f], &size);
        size_t step = size / 150 + 1;
        for (size_t cut = 0; cut < size; cut += step)
            hurt(files[f], bytes, cut);
        for (int i = 0; i < 300; i++) {
            unsigned char old[4];
            size_t at[4];
            for (int k = 0; k < 4; k++) {
                at[k] = shape_random_u32(&random) % (k < 2 && size > 400 ? 400 : size);
                old[k] = bytes[at[k]];
                bytes[at[k]] = (unsigned char)shape_random_u32(&random);
            }
            hurt(files[f], bytes, size);
            for (int k = 3; k >= 0; k--)
                bytes[at[k]] = old[k];
        }
        free(bytes);
    }
}

/* A binary file that is cut off is never taken for a whole one. */
static void test_cut_off(void **state)
{
    (void)state;
    const char *const files[] = {"suzanne.ply", "suzanne.stl", "torus-text.stl",
                                 "suzanne.off", "suzanne.glb", "ngon.ply"};
    for (size_t f = 0; f < sizeof files / sizeof *files; f++) {
        size_t size;
        unsigned char *bytes = load(files[f], &size);
        for (int i = 1; i < 20; i++) {
            size_t cut = size * (size_t)i / 20;
            unsigned char old = bytes[cut];
            shape_mesh *mesh = NULL;
            shape_error error;
            bytes[cut] = 0;
            assert_int_not_equal(decode(files[f], bytes, cut, &mesh, &error), SHAPE_OK);
            bytes[cut] = old;
        }
        free(bytes);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_formats_agree),  cmocka_unit_test(test_ngon),
        cmocka_unit_test(test_mirrored),       cmocka_unit_test(test_instances),
        cmocka_unit_test(test_skinned),        cmocka_unit_test(test_repair),
        cmocka_unit_test(test_far_away),       cmocka_unit_test(test_decimate),
        cmocka_unit_test(test_decimate_sheet), cmocka_unit_test(test_non_manifold),
        cmocka_unit_test(test_fill),           cmocka_unit_test(test_hostile),
        cmocka_unit_test(test_cut_off)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
