/* Shader programs from the built-in sources, or from a folder. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gl_private.h"
#include "shape/file.h"
#include "shader_sources.h"

enum { MAX_DEPTH = 8, MAX_SHADER = 1 << 20 };

/* Appends to a text that grows; false where memory is out. */
static bool append(char **text, size_t *length, const char *more, size_t size)
{
    char *grown = realloc(*text, *length + size + 1);
    if (!grown)
        return false;
    memcpy(grown + *length, more, size);
    *length += size;
    grown[*length] = 0;
    *text = grown;
    return true;
}

static shape_status load(const char *folder, const char *name, char **text, shape_error *error)
{
    size_t length = 0;
    *text = NULL;
    if (folder) {
        char path[4096];
        unsigned char *bytes;
        snprintf(path, sizeof path, "%s/%s", folder, name);
        shape_status status = shape_file_read(path, MAX_SHADER, &bytes, &length, error);
        *text = status ? NULL : (char *)bytes;
        return status;
    }
    for (size_t i = 0; i < shader_source_count; i++)
        if (!strcmp(shader_sources[i].name, name))
            return append(text, &length, shader_sources[i].text, strlen(shader_sources[i].text))
                       ? SHAPE_OK
                       : shape_error_memory(error);
    return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "there is no built-in shader \"%s\"", name);
}

static shape_status expand(const char *folder, const char *name, int depth, char **out, size_t *length,
                           shape_error *error)
{
    if (depth > MAX_DEPTH)
        return shape_error_set(error, SHAPE_ERROR_FORMAT, "shader %s: includes go round in a circle", name);
    char *text;
    shape_status status = load(folder, name, &text, error);
    for (char *line = text; line && *line && !status;) {
        size_t size = strcspn(line, "\n");
        char file[256];
        bool blank = strspn(line, " \t") == size; /* sscanf would read on into the next line */
        if (!blank && sscanf(line, " #include \"%255[^\"\n]\"", file) == 1)
            status = expand(folder, file, depth + 1, out, length, error);
        else if (!append(out, length, line, size) || !append(out, length, "\n", 1))
            status = shape_error_memory(error);
        line += size + (line[size] == '\n');
    }
    free(text);
    return status;
}

static shape_status compile(const char *folder, const char *name, const char *defines, GLenum kind,
                            GLuint *shader, shape_error *error)
{
    /* OpenGL ES wants precisions that desktop GLSL 3.30 accepts and ignores; only the first line differs. */
    static const char head[] = "#version 330 core\nprecision highp float;\nprecision highp int;\n"
                               "#define LIST_BITS 11\n"; /* gl_float_texture's width */
    char *source = NULL, log[400];
    size_t length = 0;
    shape_status status =
        append(&source, &length, head, sizeof head - 1) && append(&source, &length, defines, strlen(defines))
            ? SHAPE_OK
            : shape_error_memory(error);
    if (!status)
        status = expand(folder, name, 0, &source, &length, error);
    if (!status) {
        GLint good = GL_FALSE;
        *shader = glCreateShader(kind);
        glShaderSource(*shader, 1, (const char *const *)&source, NULL);
        glCompileShader(*shader);
        glGetShaderiv(*shader, GL_COMPILE_STATUS, &good);
        if (!good) {
            glGetShaderInfoLog(*shader, sizeof log, NULL, log);
            log[strcspn(log, "\n")] = 0;
            glDeleteShader(*shader);
            status = shape_error_set(error, SHAPE_ERROR_SYSTEM, "shader %s: %s", name, log);
        }
    }
    free(source);
    return status;
}

shape_status gl_program_create(const char *folder, const char *vertex, const char *fragment,
                               const char *defines, GLuint *program, shape_error *error)
{
    GLuint vertex_shader, fragment_shader;
    shape_status status = compile(folder, vertex, defines, GL_VERTEX_SHADER, &vertex_shader, error);
    if (status)
        return status;
    status = compile(folder, fragment, defines, GL_FRAGMENT_SHADER, &fragment_shader, error);
    if (status) {
        glDeleteShader(vertex_shader);
        return status;
    }
    GLint good = GL_FALSE;
    *program = glCreateProgram();
    glAttachShader(*program, vertex_shader);
    glAttachShader(*program, fragment_shader);
    glLinkProgram(*program);
    glDeleteShader(vertex_shader);
    glDeleteShader(fragment_shader);
    glGetProgramiv(*program, GL_LINK_STATUS, &good);
    if (!good) {
        char log[400];
        glGetProgramInfoLog(*program, sizeof log, NULL, log);
        log[strcspn(log, "\n")] = 0;
        glDeleteProgram(*program);
        *program = 0;
        return shape_error_set(error, SHAPE_ERROR_SYSTEM, "shader %s: %s", fragment, log);
    }
    return SHAPE_OK;
}
