/* A scanner over a mesh file's text that can tell line and column. */
#include "file/mesh_private.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

mesh_text mesh_text_begin(const char *name, const void *bytes, size_t size)
{
    const char *start = bytes;
    mesh_text text = {.name = name, .at = start, .end = start + size, .line_start = start, .line = 1};
    return text;
}

shape_status mesh_text_error(const mesh_text *text, shape_error *error, const char *what)
{
    return shape_error_set(error, SHAPE_ERROR_FORMAT, "%s:%zu:%td: %s", text->name, text->line,
                           text->at - text->line_start + 1, what);
}

shape_status mesh_error_place(shape_error *error, const char *name, const mesh_text *text,
                              shape_status status)
{
    char what[sizeof error->text];
    if (!error || status == SHAPE_ERROR_MEMORY)
        return status;
    memcpy(what, error->text, sizeof what);
    if (text)
        return shape_error_set(error, status, "%s:%zu:%td: %s", name, text->line,
                               text->at - text->line_start + 1, what);
    return shape_error_set(error, status, "%s: %s", name, what);
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
}

bool mesh_text_more(mesh_text *text, char comment)
{
    while (text->at < text->end) {
        if (is_blank(*text->at)) {
            text->at++;
        } else if (*text->at == '\\' && text->at + 1 < text->end &&
                   (text->at[1] == '\n' || text->at[1] == '\r')) {
            mesh_text_next_line(text); /* a backslash joins lines, in OBJ */
        } else {
            return *text->at != '\n' && !(comment && *text->at == comment);
        }
    }
    return false;
}

void mesh_text_next_line(mesh_text *text)
{
    const char *end = memchr(text->at, '\n', (size_t)(text->end - text->at));
    text->at = end ? end + 1 : text->end;
    if (end) {
        text->line_start = text->at;
        text->line++;
    }
}

bool mesh_text_find(mesh_text *text, char comment)
{
    while (text->at < text->end && !mesh_text_more(text, comment))
        mesh_text_next_line(text);
    return text->at < text->end;
}

size_t mesh_text_word(const mesh_text *text)
{
    const char *c = text->at;
    while (c < text->end && !is_blank(*c) && *c != '\n')
        c++;
    return (size_t)(c - text->at);
}

bool mesh_text_take(mesh_text *text, const char *word)
{
    size_t length = strlen(word);
    if (mesh_text_word(text) != length || memcmp(text->at, word, length))
        return false;
    text->at += length;
    return true;
}

static shape_status wrong_word(const mesh_text *text, const char *expected, shape_error *error)
{
    char shown[24] = "", what[96];
    size_t length = mesh_text_word(text);
    for (size_t i = 0; i < length && i + 1 < sizeof shown; i++)
        shown[i] = text->at[i] > ' ' && text->at[i] < 127 ? text->at[i] : '?';
    if (length)
        snprintf(what, sizeof what, "\"%s\" stands where %s is expected", shown, expected);
    else
        snprintf(what, sizeof what, "%s is missing (is the file cut off?)", expected);
    return mesh_text_error(text, error, what);
}

shape_status mesh_text_number(mesh_text *text, double *value, shape_error *error)
{
    char *end;
    size_t length = mesh_text_word(text);
    for (size_t i = 0; i < length; i++)
        if (!memchr("0123456789+-.eE", text->at[i], 15))
            return wrong_word(text, "a finite number", error);
    *value = length ? strtod(text->at, &end) : 0;
    if (!length || end != text->at + length || !isfinite(*value))
        return wrong_word(text, "a finite number", error);
    text->at += length;
    return SHAPE_OK;
}

shape_status mesh_text_integer(mesh_text *text, int64_t *value, shape_error *error)
{
    char *end = NULL;
    size_t length = mesh_text_word(text);
    errno = 0;
    if (length && (text->at[0] == '-' || (text->at[0] >= '0' && text->at[0] <= '9')))
        *value = strtoll(text->at, &end, 10);
    if (!end || end != text->at + length || errno)
        return wrong_word(text, "a whole number", error);
    text->at += length;
    return SHAPE_OK;
}
