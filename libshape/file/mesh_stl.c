/* STL, text and binary (3D Systems 1989). The stored normals are passed over. */
#include "file/mesh_private.h"

#include <string.h>

enum { HEADER = 84, FACET = 50 };

static uint32_t word_at(const char *bytes)
{
    const unsigned char *c = (const unsigned char *)bytes;
    return c[0] | (uint32_t)c[1] << 8 | (uint32_t)c[2] << 16 | (uint32_t)c[3] << 24;
}

static float float_at(const char *bytes)
{
    uint32_t word = word_at(bytes);
    float value;
    memcpy(&value, &word, sizeof value);
    return value;
}

static shape_status add_triangle(mesh_builder *builder, const shape_dvec3 corner[3], shape_error *error)
{
    shape_status status = SHAPE_OK;
    for (int i = 0; i < 3 && !status; i++) {
        status = mesh_builder_point(builder, corner[i], error);
        if (!status)
            status = mesh_builder_corner(builder, (uint32_t)builder->point_count - 1, NULL, error);
    }
    return status ? status : mesh_builder_polygon(builder, error);
}

static shape_status read_binary(const mesh_text *text, mesh_builder *builder, shape_error *error)
{
    size_t size = (size_t)(text->end - text->at);
    if (size < HEADER)
        return shape_error_set(error, SHAPE_ERROR_FORMAT, "%s: %zu bytes are too few for an STL file",
                               text->name, size);
    uint32_t facets = word_at(text->at + 80);
    if ((size - HEADER) / FACET < facets)
        return shape_error_set(
            error, SHAPE_ERROR_FORMAT,
            "%s: the file says %u facets, its %zu bytes hold %zu (it is cut off or not an STL file)",
            text->name, facets, size, (size - HEADER) / FACET);
    for (uint32_t f = 0; f < facets; f++) {
        const char *bytes = text->at + HEADER + (size_t)FACET * f + 12;
        shape_dvec3 corner[3];
        for (int i = 0; i < 3; i++, bytes += 12)
            corner[i] = shape_dvec3_make((double)float_at(bytes), (double)float_at(bytes + 4),
                                         (double)float_at(bytes + 8));
        shape_status status = add_triangle(builder, corner, error);
        if (status)
            return mesh_error_place(error, text->name, NULL, status);
    }
    return SHAPE_OK;
}

static bool take(mesh_text *text, const char *small, const char *large)
{
    mesh_text_find(text, 0);
    return mesh_text_take(text, small) || mesh_text_take(text, large);
}

/* Behind "facet": the normal, the loop of three vertices, "endfacet". */
static shape_status read_facet(mesh_text *text, mesh_builder *builder, shape_error *error)
{
    mesh_text_next_line(text);
    if (!take(text, "outer", "OUTER") || !take(text, "loop", "LOOP"))
        return mesh_text_error(text, error, "\"outer loop\" is missing (is the file cut off?)");
    shape_dvec3 corner[3] = {{0, 0, 0}};
    for (int i = 0; i < 3; i++) {
        if (!take(text, "vertex", "VERTEX"))
            return mesh_text_error(text, error, "\"vertex\" is missing (is the file cut off?)");
        double *value[3] = {&corner[i].x, &corner[i].y, &corner[i].z};
        for (int k = 0; k < 3; k++) {
            mesh_text_more(text, 0);
            shape_status status = mesh_text_number(text, value[k], error);
            if (status)
                return status;
        }
    }
    if (!take(text, "endloop", "ENDLOOP") || !take(text, "endfacet", "ENDFACET"))
        return mesh_text_error(text, error,
                               "\"endloop\" and \"endfacet\" are missing (is the file cut off?)");
    shape_status status = add_triangle(builder, corner, error);
    return status ? mesh_error_place(error, text->name, text, status) : SHAPE_OK;
}

static shape_status read_text(mesh_text *text, mesh_builder *builder, shape_error *error)
{
    while (mesh_text_find(text, 0)) {
        if (mesh_text_take(text, "solid") || mesh_text_take(text, "SOLID")) {
            mesh_text_next_line(text);
            for (;;) {
                if (take(text, "endsolid", "ENDSOLID"))
                    break;
                if (!take(text, "facet", "FACET"))
                    return mesh_text_error(text, error,
                                           "\"facet\" or \"endsolid\" is missing (is the file cut off?)");
                shape_status status = read_facet(text, builder, error);
                if (status)
                    return status;
            }
            mesh_text_next_line(text);
        } else {
            return mesh_text_error(text, error, "\"solid\" is missing (is it an STL file?)");
        }
    }
    return SHAPE_OK;
}

shape_status mesh_stl_read(mesh_text text, mesh_builder *builder, shape_error *error)
{
    /* Binary headers may begin with "solid" too: a length that fits and a zero byte tell. */
    size_t size = (size_t)(text.end - text.at);
    bool fits = size >= HEADER && size == HEADER + (uint64_t)FACET * word_at(text.at + 80);
    bool solid = size >= 5 && (!memcmp(text.at, "solid", 5) || !memcmp(text.at, "SOLID", 5));
    if (solid && !fits && !memchr(text.at, 0, size))
        return read_text(&text, builder, error);
    return read_binary(&text, builder, error);
}
