/* Wavefront OBJ: vertices and faces; everything else (materials, normals, curves, groups) is passed over. */
#include "file/mesh_private.h"

#include <string.h>

static shape_status read_vertex(mesh_text *text, mesh_builder *builder, shape_error *error)
{
    double value[3];
    mesh_text start = *text;
    for (int i = 0; i < 3; i++) {
        mesh_text_more(text, '#');
        shape_status status = mesh_text_number(text, &value[i], error);
        if (status)
            return status;
    }
    shape_status status = mesh_builder_point(builder, shape_dvec3_make(value[0], value[1], value[2]), error);
    return status ? mesh_error_place(error, text->name, &start, status) : SHAPE_OK;
}

/* "7", "7/1", "7//3" or "7/1/3"; from 1, or from -1 backwards. */
static shape_status read_corner(mesh_text *text, mesh_builder *builder, shape_error *error)
{
    const char *digit = text->at;
    bool backwards = *digit == '-';
    uint64_t value = 0;
    for (digit += backwards; digit < text->end && *digit >= '0' && *digit <= '9'; digit++)
        if (value <= UINT32_MAX)
            value = 10 * value + (uint64_t)(*digit - '0');
    size_t length = mesh_text_word(text);
    if (!value || digit == text->at + backwards || (digit != text->at + length && *digit != '/'))
        return mesh_text_error(text, error,
                               "a face's corner must be a vertex number, not 0 (as in \"f 1 2 3\")");
    if (backwards && value > builder->point_count)
        return mesh_text_error(text, error, "a face counts back beyond the first vertex");
    uint64_t index = backwards ? builder->point_count - value : value - 1;
    if (index >= UINT32_MAX)
        return mesh_text_error(text, error, "a face names a vertex that does not exist");
    shape_status status = mesh_builder_corner(builder, (uint32_t)index, text, error);
    text->at += length;
    return status ? mesh_error_place(error, text->name, text, status) : SHAPE_OK;
}

static shape_status read_face(mesh_text *text, mesh_builder *builder, shape_error *error)
{
    while (mesh_text_more(text, '#')) {
        shape_status status = read_corner(text, builder, error);
        if (status)
            return status;
    }
    return mesh_builder_polygon(builder, error);
}

shape_status mesh_obj_read(mesh_text text, mesh_builder *builder, shape_error *error)
{
    if (memchr(text.at, 0, (size_t)(text.end - text.at)))
        return mesh_error_place(error, text.name, NULL,
                                shape_error_set(error, SHAPE_ERROR_FORMAT, "not a text, so not an OBJ file"));
    while (mesh_text_find(&text, '#')) {
        shape_status status = SHAPE_OK;
        if (mesh_text_take(&text, "v"))
            status = read_vertex(&text, builder, error);
        else if (mesh_text_take(&text, "f") || mesh_text_take(&text, "fo"))
            status = read_face(&text, builder, error);
        if (status)
            return status;
        while (mesh_text_more(&text, 0)) /* a line that a backslash joins to the next is one statement */
            text.at += mesh_text_word(&text);
        mesh_text_next_line(&text);
    }
    return SHAPE_OK;
}
