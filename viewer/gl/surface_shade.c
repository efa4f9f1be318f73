/* What clouds leave of the sun for opaque things: the light pass once more, without the things' own shadows, which the
 * map of surface.c has more finely. Transmittances are kept, since their mean between two cells is the mean of what
 * arrives; that of depths is not. */
#include <math.h>
#include <stdlib.h>

#include "gl_private.h"

shape_status gl_shade_make(const gl_order *order, gl_light *light, shape_error *error)
{
    size_t cells = (size_t)light->size[0] * (size_t)light->size[1] * (size_t)light->size[2];
    shape_lightgrid_options options = order->light_options;
    options.opaque = NULL;
    options.scattering = false;
    light->shade = calloc(cells + 1, sizeof *light->shade);
    if (!light->shade)
        return shape_error_memory(error);
    for (int i = 0; i < light->count; i++) {
        shape_lightgrid grid;
        const gl_box *box = &light->boxes[i];
        shape_status status =
            shape_lightgrid_build(order->volume, (size_t)i, order->light, &options, &grid, error);
        if (status)
            return status;
        const float *from = grid.cells;
        for (int z = 0; z < box->size[2]; z++)
            for (int y = 0; y < box->size[1]; y++) {
                size_t row =
                    (size_t)(box->place[2] + z) * (size_t)light->size[1] + (size_t)(box->place[1] + y);
                float *to = light->shade + row * (size_t)light->size[0] + (size_t)box->place[0];
                for (int x = 0; x < box->size[0]; x++, from += SHAPE_LIGHTGRID_VALUES)
                    to[x] = expf(-from[0]);
            }
        shape_lightgrid_free(&grid);
    }
    return SHAPE_OK;
}
