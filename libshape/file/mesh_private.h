/* Private: what the mesh readers share. A scanner that knows its line, and a builder that takes points and polygons
 * and checks them. */
#ifndef SHAPE_FILE_MESH_PRIVATE_H
#define SHAPE_FILE_MESH_PRIVATE_H

#include "shape/mesh.h"

/* --- text --- */

typedef struct mesh_text {
    const char *name; /* of the file, for errors */
    const char *at, *end, *line_start;
    size_t line;
} mesh_text;

mesh_text mesh_text_begin(const char *name, const void *bytes, size_t size);
/* "name:line:column: " and the text; returns SHAPE_ERROR_FORMAT. */
shape_status mesh_text_error(const mesh_text *text, shape_error *error, const char *what);
/* Skips blanks within the line; true where something is left on it. A `comment` character (or 0) ends the line. */
bool mesh_text_more(mesh_text *text, char comment);
/* Goes behind the next line end. */
void mesh_text_next_line(mesh_text *text);
/* Skips blanks, comments and line ends; false at the end of the text. */
bool mesh_text_find(mesh_text *text, char comment);
/* The word at hand: everything up to a blank or a line end. */
size_t mesh_text_word(const mesh_text *text);
/* Whether the word at hand is `word`; case counts. Where it is, goes behind it. */
bool mesh_text_take(mesh_text *text, const char *word);
/* A finite number or a whole number, at hand; errors say what stands there instead. */
shape_status mesh_text_number(mesh_text *text, double *value, shape_error *error);
shape_status mesh_text_integer(mesh_text *text, int64_t *value, shape_error *error);

/* --- the mesh being read --- */

typedef struct mesh_builder {
    shape_dvec3 *points;
    uint32_t *corners;      /* of all polygons, one after the other */
    uint32_t *polygon_ends; /* where each ends in corners */
    size_t point_count, corner_count, polygon_count;
    size_t point_capacity, corner_capacity, polygon_capacity;
    size_t skipped;
    uint32_t largest; /* corner index, and where it stood */
    mesh_text largest_at;
} mesh_builder;

void mesh_builder_free(mesh_builder *builder);
/* Errors (without a place): memory, too many, not finite or beyond SHAPE_MESH_MAX_COORDINATE. */
shape_status mesh_builder_point(mesh_builder *builder, shape_dvec3 point, shape_error *error);
/* Adds a corner to the polygon at hand; `where` may be NULL. */
shape_status mesh_builder_corner(mesh_builder *builder, uint32_t point, const mesh_text *where,
                                 shape_error *error);
/* Ends the polygon at hand; with fewer than three corners it is skipped and counted. */
shape_status mesh_builder_polygon(mesh_builder *builder, shape_error *error);
/* Checks the indices, cuts the polygons and gives the mesh. The builder is freed, on errors too. */
shape_status mesh_builder_finish(mesh_builder *builder, const char *name, shape_mesh **mesh,
                                 shape_error *error);

/* Puts "name: " or "name:line:column: " before an error's text. */
shape_status mesh_error_place(shape_error *error, const char *name, const mesh_text *text,
                              shape_status status);

/* --- the formats --- */

shape_status mesh_obj_read(mesh_text text, mesh_builder *builder, shape_error *error);
shape_status mesh_off_read(mesh_text text, mesh_builder *builder, shape_error *error);
shape_status mesh_stl_read(mesh_text text, mesh_builder *builder, shape_error *error);
shape_status mesh_ply_read(mesh_text text, mesh_builder *builder, shape_error *error);

#endif
