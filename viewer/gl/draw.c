/* What passes draw with: a triangle over the whole target, and its blending with what is there. */
#include "gl_private.h"

void gl_draw_triangle(const shape_gl_renderer *renderer)
{
    glBindVertexArray(renderer->empty_array);
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

void gl_begin_mix(float share)
{
    glEnable(GL_BLEND);
    glBlendFunc(GL_CONSTANT_ALPHA, GL_ONE_MINUS_CONSTANT_ALPHA);
    glBlendColor(0, 0, 0, share);
}

void gl_begin_mean(int sample)
{
    if (sample > 0)
        gl_begin_mix(1.0f / (float)(sample + 1));
}
