/* What clouds leave of the sun for opaque things: the light pass once more, without the things' own shadows, which the
 * map of surface.c has more finely. Transmittances are kept, since their mean between two cells is the mean of what
 * arrives; that of depths is not. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gl_private.h"

shape_status gl_shade_make(const gl_order *order, const shape_lightgrid_options *light_options, size_t cloud,
                           gl_lit *lit, shape_error *error)
{
    shape_lightgrid grid;
    shape_lightgrid_options options = *light_options;
    options.opaque = NULL;
    options.scattering = false;
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

shape_status gl_shade_pack(gl_light *light, shape_error *error)
{
    size_t cells = (size_t)light->size[0] * (size_t)light->size[1] * (size_t)light->size[2];
    free(light->shade);
    light->shade = calloc(cells + 1, sizeof *light->shade);
    if (!light->shade)
        return shape_error_memory(error);
    for (int i = 0; i < light->count; i++) {
        const gl_box *box = &light->boxes[i];
        const float *from = light->lit[i] ? light->lit[i]->shade : NULL;
        for (int z = 0; z < box->size[2] && from; z++)
            for (int y = 0; y < box->size[1]; y++, from += box->size[0]) {
                size_t row =
                    (size_t)(box->place[2] + z) * (size_t)light->size[1] + (size_t)(box->place[1] + y);
                memcpy(light->shade + row * (size_t)light->size[0] + (size_t)box->place[0], from,
                       (size_t)box->size[0] * sizeof *from);
            }
    }
    return SHAPE_OK;
}
