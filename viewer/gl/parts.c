/* The exact view's samples, drawn in parts: no part of a pixel takes long. */
#include "gl_private.h"

static void use_copy(const shape_gl_renderer *renderer, const gl_target *from, bool looking)
{
    glUseProgram(renderer->copy);
    gl_bind(renderer->copy, "part_radiance", 12, GL_TEXTURE_2D, from->textures[0]);
    gl_bind(renderer->copy, "part_work", 13, GL_TEXTURE_2D, from->textures[1]);
    gl_set_int(renderer->copy, "looking", looking);
}

/* Whether a sample has pixels that are not finished: counted by the GPU, so that no picture has to be read. */
static bool unfinished(const shape_gl_renderer *renderer, const gl_target *part, const gl_target *other)
{
    GLuint any = 0;
    glBindFramebuffer(GL_FRAMEBUFFER, other->framebuffer);
    use_copy(renderer, part, true);
    glBeginQuery(GL_ANY_SAMPLES_PASSED, renderer->query);
    gl_draw_triangle(renderer);
    glEndQuery(GL_ANY_SAMPLES_PASSED);
    glGetQueryObjectuiv(renderer->query, GL_QUERY_RESULT, &any);
    return any;
}

shape_status gl_draw_in_parts(shape_gl_renderer *renderer, const gl_frame *frame, shape_error *error)
{
    enum { MOST_PARTS = 100000 };
    gl_target *part = &renderer->parts[0], *other = &renderer->parts[1];
    bool more = false;
    int parts = 0;
    do {
        if (++parts > MOST_PARTS)
            return shape_error_set(error, SHAPE_ERROR_LIMIT,
                                   "the exact view takes too long here (choose --method default)");
        GLuint program;
        shape_status status = gl_use_view(renderer, frame, !more && frame->tiles->listed, &program, error);
        if (status)
            return status;
        glBindFramebuffer(GL_FRAMEBUFFER, part->framebuffer);
        gl_set_int(program, "resume", more);
        gl_bind(program, "part_radiance", 12, GL_TEXTURE_2D, more ? other->textures[0] : 0);
        gl_bind(program, "part_work", 13, GL_TEXTURE_2D, more ? other->textures[1] : 0);
        gl_draw_triangle(renderer);
        more = unfinished(renderer, part, other);
        gl_target *swap = part;
        part = other;
        other = swap;
    } while (more);
    glBindFramebuffer(GL_FRAMEBUFFER, renderer->mean.framebuffer);
    use_copy(renderer, other, false);
    gl_begin_mean(frame->sample);
    gl_draw_triangle(renderer);
    glDisable(GL_BLEND);
    return SHAPE_OK;
}
