/* Textures: float ones to draw into, and volumes. */
#include <string.h>

#include "gl_private.h"

void gl_target_free(gl_target *target)
{
    glDeleteTextures(2, target->textures);
    glDeleteRenderbuffers(1, &target->depth);
    glDeleteFramebuffers(1, &target->framebuffer);
    memset(target, 0, sizeof *target);
}

shape_status gl_target_make(gl_target *target, int width, int height, bool depth, shape_error *error)
{
    static const GLenum buffers[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    gl_target_free(target);
    glGenFramebuffers(1, &target->framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
    glGenTextures(2, target->textures);
    for (int i = 0; i < 2; i++) {
        glBindTexture(GL_TEXTURE_2D, target->textures[i]);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, width, height, 0, GL_RGBA, GL_FLOAT, NULL);
        glFramebufferTexture2D(GL_FRAMEBUFFER, buffers[i], GL_TEXTURE_2D, target->textures[i], 0);
    }
    if (depth) {
        glGenRenderbuffers(1, &target->depth);
        glBindRenderbuffer(GL_RENDERBUFFER, target->depth);
        glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
        glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, target->depth);
    }
    glDrawBuffers(2, buffers);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return shape_error_set(
            error, SHAPE_ERROR_SYSTEM,
            "this GPU cannot draw into 32-bit float textures (neph-render needs no GPU; or "
            "LIBGL_ALWAYS_SOFTWARE=1 lets Mesa draw without it)");
    return SHAPE_OK;
}

void gl_settle(void)
{
    glFinish();
}

GLuint gl_volume_texture(const int size[3], GLint internal, GLenum format, GLenum kind, const void *data)
{
    static const GLenum edges[] = {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R};
    GLuint texture;
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_3D, texture);
    for (int i = 0; i < 3; i++)
        glTexParameteri(GL_TEXTURE_3D, edges[i], GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage3D(GL_TEXTURE_3D, 0, internal, size[0], size[1], size[2], 0, format, kind, data);
    return texture;
}
