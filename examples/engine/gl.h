/* What an engine has already: shaders and textures from memory, a window, a screenshot. */
#ifndef ENGINE_GL_H
#define ENGINE_GL_H

#include <epoxy/gl.h>
#include <GLFW/glfw3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <shape/file.h>

#ifndef WIDTH
#define WIDTH 640
#define HEIGHT 360
#endif

static shape_error error;

static void check(shape_status status)
{
    if (!status)
        return;
    fprintf(stderr, "engine: %s\n", error.text);
    exit(1);
}

static void attach(GLuint program, GLenum kind, const char *path)
{
    unsigned char *text;
    size_t length;
    GLint good;
    check(shape_file_read(path, 1 << 20, &text, &length, &error));
    GLuint shader = glCreateShader(kind);
    glShaderSource(shader, 2, (const GLchar *[]){"#version 330 core\n", (const GLchar *)text}, NULL);
    glCompileShader(shader);
    glGetShaderInfoLog(shader, sizeof error.text, NULL, error.text);
    glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
    check(good ? SHAPE_OK : SHAPE_ERROR_SYSTEM);
    glAttachShader(program, shader);
    free(text);
}

/* Two arrays of RGBA float texels, one behind the other, in rows of 2048. */
static GLuint float_texture(const void *a, size_t a_count, const void *b, size_t b_count)
{
    size_t rows = (a_count + b_count) / 2048 + 1;
    float *all = calloc(rows * 2048, 4 * sizeof *all);
    check(all ? SHAPE_OK : shape_error_memory(&error));
    if (a_count)
        memcpy(all, a, a_count * 4 * sizeof *all);
    if (b_count)
        memcpy(all + 4 * a_count, b, b_count * 4 * sizeof *all);
    GLuint texture;
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, 2048, (GLsizei)rows, 0, GL_RGBA, GL_FLOAT, all);
    free(all);
    return texture;
}

static GLuint volume_texture(const int size[3], GLint internal, GLenum format, GLenum type, GLint filter,
                             const void *data)
{
    GLuint texture;
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_3D, texture);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, filter);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, filter);
    glTexImage3D(GL_TEXTURE_3D, 0, internal, size[0], size[1], size[2], 0, format, type, data);
    return texture;
}

static void write_picture(const char *path)
{
    static unsigned char file[32 + 3 * WIDTH * HEIGHT], rows[3 * WIDTH * HEIGHT];
    int head = sprintf((char *)file, "P6 %d %d 255\n", WIDTH, HEIGHT);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, WIDTH, HEIGHT, GL_RGB, GL_UNSIGNED_BYTE, rows);
    for (int y = 0; y < HEIGHT; y++)
        memcpy(file + head + 3 * WIDTH * y, rows + 3 * WIDTH * (HEIGHT - 1 - y), 3 * WIDTH);
    check(shape_file_write(path, file, (size_t)head + sizeof rows, &error));
}

static GLFWwindow *open_window(bool hidden)
{
    glfwInit();
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_RESIZABLE, GLFW_FALSE);
    glfwWindowHint(GLFW_COCOA_RETINA_FRAMEBUFFER, GLFW_FALSE);
    glfwWindowHint(GLFW_VISIBLE, !hidden);
    GLFWwindow *window = glfwCreateWindow(WIDTH, HEIGHT, "engine", NULL, NULL);
    if (!window)
        check(shape_error_set(&error, SHAPE_ERROR_SYSTEM, "no window with OpenGL 3.3 (is there a display?)"));
    glfwMakeContextCurrent(window);
    return window;
}

#endif
