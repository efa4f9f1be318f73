/* The light grids of all clouds: as solved, and as one eye sees them, each in one atlas. */
#include <stdlib.h>
#include <string.h>

#include "gl_private.h"
#include "shape/record.h"

static size_t cell_count(const int size[3])
{
    return (size_t)size[0] * (size_t)size[1] * (size_t)size[2];
}

void gl_light_drop(gl_light *light)
{
    if (!light || --light->uses)
        return;
    for (int i = 0; i < light->count; i++)
        shape_lightgrid_free(&light->grids[i]);
    glDeleteTextures(1, &light->a);
    glDeleteTextures(1, &light->b);
    glDeleteTextures(1, &light->seen);
    glDeleteTextures(1, &light->shade_texture);
    free(light->grids);
    free(light->boxes);
    free(light->cells);
    free(light->shade);
    free(light);
}

static shape_status build(const gl_order *order, size_t cloud, shape_lightgrid *grid, shape_error *error)
{
    if (order->paper)
        return shape_lightgrid_build_2018(order->volume, cloud, order->light, order->light_options.resolution,
                                          0.1f, grid, error);
    return shape_lightgrid_build(order->volume, cloud, order->light, &order->light_options, grid, error);
}

shape_status gl_light_make(const gl_order *order, gl_light **made, shape_error *error)
{
    size_t count = order->volume->cloud_count;
    gl_light *light = calloc(1, sizeof *light);
    if (!light)
        return shape_error_memory(error);
    light->uses = 1;
    light->grids = calloc(count + 1, sizeof *light->grids);
    light->boxes = calloc(count + 1, sizeof *light->boxes);
    shape_status status = light->grids && light->boxes ? SHAPE_OK : shape_error_memory(error);
    for (size_t i = 0; i < count && !status; i++) {
        status = build(order, i, &light->grids[i], error);
        light->count += !status;
        memcpy(light->boxes[i].size, light->grids[i].size, sizeof light->boxes[i].size);
    }
    if (!status)
        status = gl_atlas_pack(light->boxes, (int)count, order->texture_limit, light->size, error);
    if (!status) {
        light->cells = calloc(cell_count(light->size) * 4, sizeof *light->cells);
        status = light->cells ? SHAPE_OK : shape_error_memory(error);
    }
    if (!status && order->light_options.opaque)
        status = gl_shade_make(order, light, error);
    if (status) {
        gl_light_drop(light);
        return status;
    }
    *made = light;
    return SHAPE_OK;
}

/* Values 0..3 (part 0) or 4..7 (part 1) of all grids as one texture. */
static GLuint value_texture(gl_light *light, int part)
{
    memset(light->cells, 0, cell_count(light->size) * 4 * sizeof *light->cells);
    for (int i = 0; i < light->count; i++) {
        const gl_box *box = &light->boxes[i];
        const float *from = light->grids[i].cells + 4 * part;
        for (int z = 0; z < box->size[2]; z++)
            for (int y = 0; y < box->size[1]; y++) {
                float *to =
                    light->cells +
                    (((size_t)(box->place[2] + z) * (size_t)light->size[1] + (size_t)(box->place[1] + y)) *
                         (size_t)light->size[0] +
                     (size_t)box->place[0]) *
                        4;
                for (int x = 0; x < box->size[0]; x++, from += SHAPE_LIGHTGRID_VALUES)
                    memcpy(to + 4 * x, from, 4 * sizeof *to);
            }
    }
    return gl_volume_texture(light->size, GL_RGBA32F, GL_RGBA, GL_FLOAT, light->cells);
}

void gl_light_upload(gl_light *light)
{
    light->a = value_texture(light, 0);
    light->b = value_texture(light, 1);
}

void gl_light_place(const gl_light *light, gl_scene *scene, const shape_volume *volume)
{
    for (int i = 0; i < light->count; i++) {
        float *record = scene->records + (size_t)i * GL_RECORD_TEXELS * 4;
        shape_record_set_light((float(*)[4])record, &volume->clouds[i], &light->grids[i],
                               light->boxes[i].place);
    }
}

void gl_light_compose(gl_light *light, const shape_gl_renderer *renderer, shape_dvec3 eye)
{
    if (!light->seen)
        light->seen = gl_volume_texture(light->size, GL_RGBA32F, GL_RGBA, GL_FLOAT, NULL);
    glBindTexture(GL_TEXTURE_3D, light->seen);
    for (int i = 0; i < renderer->scene.shown_count; i++) {
        int cloud = renderer->scene.shown[i];
        const gl_box *box = &light->boxes[cloud];
        /* The scratch is as large as the atlas, so as any one grid. */
        shape_lightgrid_seen(&light->grids[cloud], &renderer->volume->clouds[cloud], &renderer->light,
                             renderer->sky_upper, renderer->sky_lower, eye, light->cells);
        glTexSubImage3D(GL_TEXTURE_3D, 0, box->place[0], box->place[1], box->place[2], box->size[0],
                        box->size[1], box->size[2], GL_RGBA, GL_FLOAT, light->cells);
    }
}
