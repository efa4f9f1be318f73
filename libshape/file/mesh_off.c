/* Object File Format (Geomview): the text form in three dimensions; colours, normals and texture places are passed
 * over. */
#include "file/mesh_private.h"

#include <string.h>

static shape_status read_count(mesh_text *text, const char *what, int64_t *value, shape_error *error)
{
    mesh_text_find(text, '#');
    mesh_text start = *text;
    shape_status status = mesh_text_integer(text, value, error);
    if (!status && (*value < 0 || *value > UINT32_MAX))
        return mesh_text_error(&start, error, what);
    return status;
}

/* "OFF" with any of the prefixes that add columns. */
static shape_status read_header(mesh_text *text, shape_error *error)
{
    mesh_text_find(text, '#');
    size_t length = mesh_text_word(text);
    if (length < 3 || memcmp(text->at + length - 3, "OFF", 3))
        return mesh_text_error(text, error, "the file does not begin with OFF");
    for (size_t i = 0; i + 3 < length; i++)
        if (!strchr("STCN", text->at[i]))
            return mesh_text_error(text, error, "OFF with four or n dimensions (export it in three)");
    text->at += length;
    if (mesh_text_more(text, '#') && mesh_text_word(text) == 6 && !memcmp(text->at, "BINARY", 6))
        return mesh_text_error(text, error, "binary OFF (export it as text)");
    return SHAPE_OK;
}

static shape_status read_vertex(mesh_text *text, mesh_builder *builder, shape_error *error)
{
    double value[3];
    for (int i = 0; i < 3; i++) {
        mesh_text_find(text, '#');
        shape_status status = mesh_text_number(text, &value[i], error);
        if (status)
            return status;
    }
    shape_status status = mesh_builder_point(builder, shape_dvec3_make(value[0], value[1], value[2]), error);
    mesh_text here = *text;
    mesh_text_next_line(text);
    return status ? mesh_error_place(error, text->name, &here, status) : SHAPE_OK;
}

static shape_status read_face(mesh_text *text, mesh_builder *builder, shape_error *error)
{
    int64_t corners, index;
    shape_status status = read_count(text, "a face has an impossible number of corners", &corners, error);
    for (int64_t i = 0; i < corners && !status; i++) {
        status = read_count(text, "a face names an impossible vertex", &index, error);
        if (!status)
            status = mesh_builder_corner(builder, (uint32_t)index, text, error);
    }
    if (!status)
        status = mesh_builder_polygon(builder, error);
    mesh_text_next_line(text);
    return status;
}

shape_status mesh_off_read(mesh_text text, mesh_builder *builder, shape_error *error)
{
    int64_t vertices = 0, faces = 0, edges = 0;
    shape_status status = read_header(&text, error);
    if (!status)
        status = read_count(&text, "an impossible number of vertices", &vertices, error);
    if (!status)
        status = read_count(&text, "an impossible number of faces", &faces, error);
    if (!status)
        status = read_count(&text, "an impossible number of edges", &edges, error);
    mesh_text_next_line(&text);
    for (int64_t i = 0; i < vertices && !status; i++)
        status = read_vertex(&text, builder, error);
    for (int64_t i = 0; i < faces && !status; i++)
        status = read_face(&text, builder, error);
    return status;
}
