/* Mesh files to meshes: which format it is, and the builder that every reader fills. OpenMesh's own readers are not
 * used: they keep coordinates in single precision, and open the material files that an OBJ names. */
#include "file/mesh_private.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/memory.h"

void mesh_builder_free(mesh_builder *builder)
{
    free(builder->points);
    free(builder->corners);
    free(builder->polygon_ends);
    memset(builder, 0, sizeof *builder);
}

shape_status mesh_builder_point(mesh_builder *builder, shape_dvec3 point, shape_error *error)
{
    double largest = fmax(fmax(fabs(point.x), fabs(point.y)), fabs(point.z));
    if (!isfinite(point.x) || !isfinite(point.y) || !isfinite(point.z))
        return shape_error_set(error, SHAPE_ERROR_FORMAT,
                               "a vertex has a coordinate that is not a finite number (repair the mesh)");
    if (largest > SHAPE_MESH_MAX_COORDINATE)
        return shape_error_set(error, SHAPE_ERROR_FORMAT,
                               "a vertex has a coordinate of %g (at most %g is possible)", largest,
                               SHAPE_MESH_MAX_COORDINATE);
    if (builder->point_count >= SHAPE_MESH_MAX_POINTS)
        return shape_error_set(error, SHAPE_ERROR_LIMIT, "more than %d vertices (decimate the mesh before)",
                               SHAPE_MESH_MAX_POINTS);
    if (shape_array_reserve((void **)&builder->points, &builder->point_capacity, builder->point_count + 1,
                            sizeof point, error))
        return SHAPE_ERROR_MEMORY;
    builder->points[builder->point_count++] = point;
    return SHAPE_OK;
}

shape_status mesh_builder_corner(mesh_builder *builder, uint32_t point, const mesh_text *where,
                                 shape_error *error)
{
    if (builder->corner_count >= 3 * (size_t)SHAPE_MESH_MAX_TRIANGLES)
        return shape_error_set(error, SHAPE_ERROR_LIMIT, "more than %d triangles (decimate the mesh before)",
                               SHAPE_MESH_MAX_TRIANGLES);
    if (shape_array_reserve((void **)&builder->corners, &builder->corner_capacity, builder->corner_count + 1,
                            sizeof point, error))
        return SHAPE_ERROR_MEMORY;
    builder->corners[builder->corner_count++] = point;
    if (point > builder->largest) {
        builder->largest = point;
        if (where)
            builder->largest_at = *where;
    }
    return SHAPE_OK;
}

shape_status mesh_builder_polygon(mesh_builder *builder, shape_error *error)
{
    size_t start = builder->polygon_count ? builder->polygon_ends[builder->polygon_count - 1] : 0;
    if (builder->corner_count < start + 3) {
        builder->corner_count = start;
        builder->skipped++;
        return SHAPE_OK;
    }
    if (shape_array_reserve((void **)&builder->polygon_ends, &builder->polygon_capacity,
                            builder->polygon_count + 1, sizeof *builder->polygon_ends, error))
        return SHAPE_ERROR_MEMORY;
    builder->polygon_ends[builder->polygon_count++] = (uint32_t)builder->corner_count;
    return SHAPE_OK;
}

static shape_status check_builder(const mesh_builder *builder, shape_error *error)
{
    if (!builder->point_count)
        return shape_error_set(error, SHAPE_ERROR_FORMAT, "no vertices (is it a mesh?)");
    if (!builder->polygon_count)
        return shape_error_set(error, SHAPE_ERROR_FORMAT,
                               "no faces (export the object as a mesh, with its faces)");
    if (builder->largest >= builder->point_count)
        return shape_error_set(error, SHAPE_ERROR_FORMAT, "a face names vertex %u of %zu (counted from 0)",
                               builder->largest, builder->point_count);
    return SHAPE_OK;
}

static shape_status cut_polygons(const mesh_builder *builder, shape_mesh *mesh, shape_error *error)
{
    size_t start = 0, largest = 0;
    for (size_t i = 0; i < builder->polygon_count; start = builder->polygon_ends[i++])
        if (builder->polygon_ends[i] - start > largest)
            largest = builder->polygon_ends[i] - start;
    double *scratch = malloc((3 * largest + 1) * sizeof *scratch);
    if (!scratch)
        return shape_error_memory(error);
    uint32_t *to = mesh->indices;
    start = 0;
    for (size_t i = 0; i < builder->polygon_count; start = builder->polygon_ends[i++]) {
        size_t count = builder->polygon_ends[i] - start;
        shape_polygon_cut(builder->points, &builder->corners[start], count, to, scratch);
        to += 3 * (count - 2);
    }
    free(scratch);
    return SHAPE_OK;
}

shape_status mesh_builder_finish(mesh_builder *builder, const char *name, shape_mesh **mesh,
                                 shape_error *error)
{
    shape_status status = check_builder(builder, error);
    if (status) {
        bool placed = builder->largest_at.at && builder->point_count && builder->polygon_count;
        mesh_error_place(error, name, placed ? &builder->largest_at : NULL, status);
        mesh_builder_free(builder);
        return status;
    }
    size_t triangles = builder->corner_count - 2 * builder->polygon_count;
    shape_mesh *made = shape_mesh_create(0, triangles, error);
    status = made ? cut_polygons(builder, made, error) : SHAPE_ERROR_MEMORY;
    if (status) {
        shape_mesh_destroy(made);
    } else {
        free(made->points);
        made->points = builder->points;
        builder->points = NULL;
        made->point_count = builder->point_count;
        made->triangle_count = triangles;
        made->counts.faces = builder->polygon_count;
        made->counts.triangles = triangles;
        made->counts.skipped = builder->skipped;
        *mesh = made;
    }
    mesh_builder_free(builder);
    return status;
}

static const char *const format_names[] = {"unknown", "OBJ", "PLY", "STL", "OFF", "glTF", "GLB"};

const char *shape_mesh_format_name(shape_mesh_format format)
{
    return format_names[format];
}

static bool begins(const unsigned char *bytes, size_t size, const char *text)
{
    return size >= strlen(text) && !memcmp(bytes, text, strlen(text));
}

static uint32_t little_endian(const unsigned char *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

shape_mesh_format shape_mesh_format_guess(const char *name, const void *bytes, size_t size)
{
    static const char *const suffixes[] = {"", ".obj", ".ply", ".stl", ".off", ".gltf", ".glb"};
    const char *dot = strrchr(name, '.');
    for (int f = SHAPE_MESH_OBJ; dot && f <= SHAPE_MESH_GLB; f++)
        if (!strcasecmp(dot, suffixes[f]))
            return (shape_mesh_format)f;
    const unsigned char *c = bytes;
    if (begins(c, size, "glTF"))
        return SHAPE_MESH_GLB;
    if (begins(c, size, "ply\n") || begins(c, size, "ply\r"))
        return SHAPE_MESH_PLY;
    if (size >= 84 && size == 84 + 50 * (uint64_t)little_endian(c + 80))
        return SHAPE_MESH_STL;
    if (begins(c, size, "solid"))
        return SHAPE_MESH_STL;
    mesh_text text = mesh_text_begin(name, bytes, size);
    if (!mesh_text_find(&text, '#'))
        return SHAPE_MESH_UNKNOWN;
    size_t word = mesh_text_word(&text);
    if (*text.at == '{')
        return SHAPE_MESH_GLTF;
    if (word >= 3 && word <= 6 && !memcmp(text.at + word - 3, "OFF", 3))
        return SHAPE_MESH_OFF;
    static const char *const obj_words[] = {"v", "vn", "vt", "o", "g", "s", "mtllib", "usemtl", "f"};
    for (size_t i = 0; i < sizeof obj_words / sizeof *obj_words; i++)
        if (mesh_text_take(&text, obj_words[i]))
            return SHAPE_MESH_OBJ;
    return SHAPE_MESH_UNKNOWN;
}

shape_status shape_mesh_decode(shape_mesh_format format, const char *name, const void *bytes, size_t size,
                               shape_mesh **mesh, shape_error *error)
{
    static shape_status (*const readers[])(mesh_text, mesh_builder *,
                                           shape_error *) = {[SHAPE_MESH_OBJ] = mesh_obj_read,
                                                             [SHAPE_MESH_PLY] = mesh_ply_read,
                                                             [SHAPE_MESH_STL] = mesh_stl_read,
                                                             [SHAPE_MESH_OFF] = mesh_off_read};
    if (format < SHAPE_MESH_OBJ || format > SHAPE_MESH_OFF)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "%s: not an OBJ, PLY, STL or OFF file", name);
    if (!size)
        return shape_error_set(error, SHAPE_ERROR_FORMAT, "%s: the file is empty", name);
    mesh_builder builder = {0};
    shape_status status = readers[format](mesh_text_begin(name, bytes, size), &builder, error);
    if (status) {
        mesh_builder_free(&builder);
        return status;
    }
    return mesh_builder_finish(&builder, name, mesh, error);
}
