/* Polygon File Format (Turk 1994): text and binary of either byte order; elements "vertex" with x, y, z and "face"
 * with vertex_indices are read, all others passed over. */
#include "file/mesh_private.h"

#include <stdio.h>
#include <string.h>

enum { MAX_ELEMENTS = 32, MAX_PROPERTIES = 64 };

typedef enum ply_type {
    PLY_NONE,
    PLY_I8,
    PLY_U8,
    PLY_I16,
    PLY_U16,
    PLY_I32,
    PLY_U32,
    PLY_F32,
    PLY_F64
} ply_type;

typedef enum ply_use { PLY_SKIP, PLY_X, PLY_Y, PLY_Z, PLY_CORNERS } ply_use;

typedef struct ply_property {
    ply_type type, count_type; /* count_type: of a list's length, else PLY_NONE */
    ply_use use;
} ply_property;

typedef struct ply_element {
    int64_t count;
    bool is_vertex, is_face;
    int property_count;
    ply_property properties[MAX_PROPERTIES];
} ply_element;

typedef struct ply_header {
    bool binary, swapped; /* swapped: big-endian */
    int element_count;
    ply_element elements[MAX_ELEMENTS];
} ply_header;

static ply_type take_type(mesh_text *text)
{
    static const char *const names[][2] = {{"", ""},           {"char", "int8"},     {"uchar", "uint8"},
                                           {"short", "int16"}, {"ushort", "uint16"}, {"int", "int32"},
                                           {"uint", "uint32"}, {"float", "float32"}, {"double", "float64"}};
    mesh_text_more(text, 0);
    for (int type = PLY_I8; type <= PLY_F64; type++)
        if (mesh_text_take(text, names[type][0]) || mesh_text_take(text, names[type][1]))
            return (ply_type)type;
    return PLY_NONE;
}

static shape_status read_format(mesh_text *text, ply_header *header, shape_error *error)
{
    mesh_text_more(text, 0);
    if (mesh_text_take(text, "binary_little_endian"))
        header->binary = true;
    else if (mesh_text_take(text, "binary_big_endian"))
        header->binary = header->swapped = true;
    else if (!mesh_text_take(text, "ascii"))
        return mesh_text_error(text, error,
                               "the format must be ascii, binary_little_endian or binary_big_endian");
    mesh_text_more(text, 0);
    return mesh_text_take(text, "1.0") ? SHAPE_OK
                                       : mesh_text_error(text, error, "only PLY version 1.0 is known");
}

static shape_status read_element(mesh_text *text, ply_header *header, shape_error *error)
{
    if (header->element_count == MAX_ELEMENTS)
        return mesh_text_error(text, error, "more than 32 elements");
    ply_element *element = &header->elements[header->element_count++];
    mesh_text_more(text, 0);
    element->is_vertex = mesh_text_take(text, "vertex");
    element->is_face = !element->is_vertex && mesh_text_take(text, "face");
    if (!element->is_vertex && !element->is_face)
        text->at += mesh_text_word(text);
    mesh_text_more(text, 0);
    shape_status status = mesh_text_integer(text, &element->count, error);
    if (!status && (element->count < 0 || element->count > UINT32_MAX))
        return mesh_text_error(text, error, "an impossible number of elements");
    return status;
}

static shape_status read_property(mesh_text *text, ply_header *header, shape_error *error)
{
    if (!header->element_count)
        return mesh_text_error(text, error, "a property stands before the first element");
    ply_element *element = &header->elements[header->element_count - 1];
    if (element->property_count == MAX_PROPERTIES)
        return mesh_text_error(text, error, "more than 64 properties in an element");
    ply_property *property = &element->properties[element->property_count++];
    mesh_text_more(text, 0);
    bool list = mesh_text_take(text, "list");
    if (list) {
        property->count_type = take_type(text);
        if (property->count_type == PLY_NONE || property->count_type >= PLY_F32)
            return mesh_text_error(text, error, "a list's length must have a type of whole numbers");
    }
    property->type = take_type(text);
    if (property->type == PLY_NONE)
        return mesh_text_error(text, error, "the property has an unknown type");
    mesh_text_more(text, 0);
    if (element->is_vertex && !list)
        property->use = mesh_text_take(text, "x")   ? PLY_X
                        : mesh_text_take(text, "y") ? PLY_Y
                        : mesh_text_take(text, "z") ? PLY_Z
                                                    : PLY_SKIP;
    if (element->is_face && list &&
        (mesh_text_take(text, "vertex_indices") || mesh_text_take(text, "vertex_index")))
        property->use = PLY_CORNERS;
    if (property->use == PLY_CORNERS && property->type >= PLY_F32)
        return mesh_text_error(text, error, "vertex_indices must be whole numbers");
    return SHAPE_OK;
}

static bool has_use(const ply_element *element, ply_use use)
{
    int count = 0;
    for (int i = 0; i < element->property_count; i++)
        count += element->properties[i].use == use;
    return count == 1;
}

static shape_status check_header(const mesh_text *text, const ply_header *header, shape_error *error)
{
    int vertices = 0, faces = 0;
    for (int i = 0; i < header->element_count; i++) {
        const ply_element *element = &header->elements[i];
        vertices += element->is_vertex;
        faces += element->is_face;
        if (element->is_vertex &&
            !(has_use(element, PLY_X) && has_use(element, PLY_Y) && has_use(element, PLY_Z)))
            return mesh_text_error(text, error, "the vertices need the properties x, y and z, once each");
        if (element->is_face && element->count && !has_use(element, PLY_CORNERS))
            return mesh_text_error(text, error, "the faces need one list property vertex_indices");
    }
    if (vertices != 1 || faces > 1)
        return mesh_text_error(text, error,
                               "the header needs one element \"vertex\" and at most one \"face\"");
    return SHAPE_OK;
}

static shape_status read_header(mesh_text *text, ply_header *header, shape_error *error)
{
    bool has_format = false;
    if (!mesh_text_take(text, "ply"))
        return mesh_text_error(text, error, "the file does not begin with \"ply\"");
    for (;;) {
        mesh_text_next_line(text);
        if (!mesh_text_find(text, 0))
            return mesh_text_error(text, error, "end_header is missing (is the file cut off?)");
        shape_status status = SHAPE_OK;
        if (mesh_text_take(text, "end_header"))
            break;
        if (mesh_text_take(text, "format")) {
            status = read_format(text, header, error);
            has_format = true;
        } else if (mesh_text_take(text, "element")) {
            status = read_element(text, header, error);
        } else if (mesh_text_take(text, "property")) {
            status = read_property(text, header, error);
        } else if (!mesh_text_take(text, "comment") && !mesh_text_take(text, "obj_info")) {
            status = mesh_text_error(text, error, "an unknown word in the header");
        }
        if (status)
            return status;
    }
    if (!has_format)
        return mesh_text_error(text, error, "the header names no format");
    shape_status status = check_header(text, header, error);
    mesh_text_next_line(text);
    return status;
}

static shape_status read_binary_value(mesh_text *text, ply_type type, bool swapped, double *value,
                                      shape_error *error)
{
    static const unsigned char sizes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
    size_t size = sizes[type];
    if ((size_t)(text->end - text->at) < size)
        return shape_error_set(error, SHAPE_ERROR_FORMAT, "%s: the file ends within its data (it is cut off)",
                               text->name);
    uint64_t word = 0;
    for (size_t i = 0; i < size; i++)
        word |= (uint64_t)(unsigned char)text->at[i] << 8 * (swapped ? size - 1 - i : i);
    text->at += size;
    float single;
    uint32_t low = (uint32_t)word;
    switch (type) {
    case PLY_I8:
        *value = (int8_t)word;
        break;
    case PLY_I16:
        *value = (int16_t)word;
        break;
    case PLY_I32:
        *value = (int32_t)word;
        break;
    case PLY_F32:
        memcpy(&single, &low, sizeof single);
        *value = (double)single;
        break;
    case PLY_F64:
        memcpy(value, &word, sizeof *value);
        break;
    default:
        *value = (double)word;
    }
    return SHAPE_OK;
}

static shape_status read_value(mesh_text *text, const ply_header *header, ply_type type, double *value,
                               shape_error *error)
{
    if (header->binary)
        return read_binary_value(text, type, header->swapped, value, error);
    mesh_text_find(text, 0);
    return mesh_text_number(text, value, error);
}

static shape_status place(const mesh_text *text, const ply_header *header, shape_status status,
                          shape_error *error)
{
    return status ? mesh_error_place(error, text->name, header->binary ? NULL : text, status) : SHAPE_OK;
}

static shape_status read_list(mesh_text *text, const ply_header *header, const ply_property *property,
                              mesh_builder *builder, shape_error *error)
{
    double length = 0, value = 0;
    shape_status status = read_value(text, header, property->count_type, &length, error);
    if (!status && !(length >= 0 && length <= UINT32_MAX && length == floor(length)))
        return place(text, header,
                     shape_error_set(error, SHAPE_ERROR_FORMAT, "a list has an impossible length"), error);
    for (double i = 0; i < length && !status; i++) {
        status = read_value(text, header, property->type, &value, error);
        if (status || property->use != PLY_CORNERS)
            continue;
        if (!(value >= 0 && value < UINT32_MAX && value == floor(value)))
            status = shape_error_set(error, SHAPE_ERROR_FORMAT, "a face names vertex %g (they count from 0)",
                                     value);
        else
            status = mesh_builder_corner(builder, (uint32_t)value, header->binary ? NULL : text, error);
        place(text, header, status, error);
    }
    if (!status && property->use == PLY_CORNERS)
        status = mesh_builder_polygon(builder, error);
    return status;
}

static shape_status read_row(mesh_text *text, const ply_header *header, const ply_element *element,
                             mesh_builder *builder, shape_error *error)
{
    double point[3] = {0, 0, 0}, value;
    for (int i = 0; i < element->property_count; i++) {
        const ply_property *property = &element->properties[i];
        shape_status status;
        if (property->count_type != PLY_NONE) {
            status = read_list(text, header, property, builder, error);
        } else {
            status = read_value(text, header, property->type, &value, error);
            if (!status && property->use != PLY_SKIP)
                point[property->use - PLY_X] = value;
        }
        if (status)
            return status;
    }
    if (!element->is_vertex)
        return SHAPE_OK;
    return place(text, header,
                 mesh_builder_point(builder, shape_dvec3_make(point[0], point[1], point[2]), error), error);
}

shape_status mesh_ply_read(mesh_text text, mesh_builder *builder, shape_error *error)
{
    ply_header header = {0};
    shape_status status = read_header(&text, &header, error);
    for (int e = 0; e < header.element_count && !status; e++) {
        const ply_element *element = &header.elements[e];
        /* Without properties a row takes no bytes, so its count is not bounded by the file's size. */
        for (int64_t i = 0; i < element->count && element->property_count && !status; i++)
            status = read_row(&text, &header, element, builder, error);
    }
    return status;
}
