/* What clouds leave of the sun for opaque things: the light pass once more, without the things' own shadows, which the
 * map of surface.c has more finely. Transmittances are kept, since their mean between two cells is the mean of what
 * arrives; that of depths is not. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gl_private.h"
#include "shape/record.h"

shape_status gl_shade_make(const gl_order *order, const shape_lightgrid_options *light_options, size_t cloud,
                           gl_lit *lit, shape_error *error)
{
    shape_lightgrid grid;
    shape_lightgrid_options options = *light_options;
    options.opaque = NULL;
    options.scattering = false;
    options.from = NULL;
    shape_status status = shape_lightgrid_build(order->volume, cloud, order->light, &options, &grid, error);
    if (status)
        return status;
    size_t cells = (size_t)grid.size[0] * (size_t)grid.size[1] * (size_t)grid.size[2];
    lit->shade = malloc((cells + 1) * sizeof *lit->shade);
    for (size_t i = 0; i < cells && lit->shade; i++)
        lit->shade[i] = expf(-grid.cells[i * SHAPE_LIGHTGRID_VALUES]);
    shape_lightgrid_free(&grid);
    return lit->shade ? SHAPE_OK : shape_error_memory(error);
}

/* One cloud's shares into the atlas. */
static void pack_cloud(gl_light *light, int i)
{
    const gl_box *box = &light->boxes[i];
    const float *from = light->lit[i]->shade, *cells = light->lit[i]->grid.cells;
    for (int z = 0; z < box->size[2]; z++)
        for (int y = 0; y < box->size[1]; y++) {
            size_t row = (size_t)(box->place[2] + z) * (size_t)light->size[1] + (size_t)(box->place[1] + y);
            float *to = light->shade + row * (size_t)light->size[0] + (size_t)box->place[0];
            for (int x = 0; x < box->size[0]; x++, cells += SHAPE_LIGHTGRID_VALUES)
                to[x] = from ? *from++ : expf(-cells[0]);
        }
}

shape_status gl_shade_pack(gl_light *light, shape_error *error)
{
    size_t cells = (size_t)light->size[0] * (size_t)light->size[1] * (size_t)light->size[2];
    free(light->shade);
    light->shade = calloc(cells + 1, sizeof *light->shade);
    if (!light->shade)
        return shape_error_memory(error);
    for (int i = 0; i < light->count; i++)
        if (light->lit[i])
            pack_cloud(light, i);
    return SHAPE_OK;
}

shape_status gl_shade_set(shape_gl_renderer *r, GLuint program, GLuint clouds, shape_dvec3 eye,
                          shape_error *error)
{
    gl_light *light = r->grids.light;
    gl_set_int(program, "cloud_count", 0);
    if (light && !light->shade) {
        shape_status status = gl_shade_pack(light, error);
        if (status)
            return status;
    }
    int count = light ? light->count : 0, shading = 0;
    size_t floats = GL_RECORD_TEXELS * 4;
    float *rows = malloc(((size_t)count + 1) * floats * sizeof *rows);
    if (!rows)
        return shape_error_memory(error);
    if (count && !light->shade_texture)
        light->shade_texture = gl_volume_texture(light->size, GL_R32F, GL_RED, GL_FLOAT, light->shade);
    for (int i = 0; i < count; i++) {
        if (!light->lit[i])
            continue;
        float *row = rows + (size_t)shading++ * floats;
        memcpy(row, r->scene.records + (size_t)i * floats, floats * sizeof *rows);
        shape_record_set_eye((float(*)[4])row, &r->volume->clouds[i], eye);
    }
    glBindTexture(GL_TEXTURE_2D, clouds);
    if (shading)
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, GL_RECORD_TEXELS, shading, 0, GL_RGBA, GL_FLOAT, rows);
    free(rows);
    gl_bind(program, "clouds", 0, GL_TEXTURE_2D, clouds);
    gl_bind(program, "shade", 6, GL_TEXTURE_3D, shading ? light->shade_texture : 0);
    gl_set_int(program, "cloud_count", shading);
    return SHAPE_OK;
}
