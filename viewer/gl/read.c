/* What has been drawn: as radiance, tone-mapped, as a map of the work that it took. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gl_private.h"

/* Adds up the steps and fetches of what was drawn into a target; buffer has room for it. */
static void add_work(const gl_target *target, int width, int height, float *buffer, double *steps,
                     double *fetches)
{
    glBindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
    glReadBuffer(GL_COLOR_ATTACHMENT1);
    glReadPixels(0, 0, width, height, GL_RGBA, GL_FLOAT, buffer);
    glReadBuffer(GL_COLOR_ATTACHMENT0);
    for (size_t i = 0; i < (size_t)width * (size_t)height; i++) {
        *steps += (double)buffer[4 * i];
        *fetches += (double)buffer[4 * i + 1];
    }
}

shape_status shape_gl_read(shape_gl_renderer *renderer, float *rgba, shape_error *error)
{
    size_t width = (size_t)renderer->width, height = (size_t)renderer->height;
    float *rows = malloc(width * height * 4 * sizeof *rows);
    if (!rows)
        return shape_error_memory(error);
    double steps = 0, fetches = 0;
    add_work(&renderer->mean, renderer->width, renderer->height, rows, &steps, &fetches);
    if (renderer->preview.moving)
        add_work(&renderer->preview.coarse, (renderer->width + 1) / 2, (renderer->height + 1) / 2, rows,
                 &steps, &fetches);
    renderer->costs.steps_per_pixel = steps / (double)(width * height);
    renderer->costs.fetches_per_pixel = fetches / (double)(width * height);
    glBindFramebuffer(GL_FRAMEBUFFER, renderer->mean.framebuffer);
    glReadPixels(0, 0, renderer->width, renderer->height, GL_RGBA, GL_FLOAT, rows);
    for (size_t y = 0; y < height; y++)
        memcpy(rgba + y * width * 4, rows + (height - 1 - y) * width * 4, width * 4 * sizeof *rows);
    free(rows);
    return SHAPE_OK;
}

void shape_gl_show(shape_gl_renderer *renderer, float exposure_stops, int width, int height)
{
    if (!renderer->tonemap && gl_program_create(renderer->options.shader_folder, "view/fullscreen.vert",
                                                "view/tonemap.frag", "", &renderer->tonemap, NULL))
        return;
    glViewport(0, 0, width, height);
    glUseProgram(renderer->tonemap);
    gl_bind(renderer->tonemap, "accumulated", 0, GL_TEXTURE_2D, renderer->mean.textures[0]);
    gl_set_float(renderer->tonemap, "exposure", exp2f(exposure_stops));
    glBindVertexArray(renderer->empty_array);
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

void shape_gl_show_heat(shape_gl_renderer *renderer, shape_gl_heat kind, float full, int width, int height)
{
    if (!renderer->heat && gl_program_create(renderer->options.shader_folder, "view/fullscreen.vert",
                                             "view/heat.frag", "", &renderer->heat, NULL))
        return;
    glViewport(0, 0, width, height);
    glUseProgram(renderer->heat);
    gl_bind(renderer->heat, "work", 0, GL_TEXTURE_2D, renderer->mean.textures[1]);
    gl_set_float(renderer->heat, "full", full);
    gl_bind(renderer->heat, "accumulated", 1, GL_TEXTURE_2D, renderer->mean.textures[0]);
    gl_set_int(renderer->heat, "kind", (int)kind);
    gl_draw_triangle(renderer);
}

shape_gl_costs shape_gl_get_costs(const shape_gl_renderer *renderer)
{
    return renderer->costs;
}
