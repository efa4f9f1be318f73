/* Optical depths out of one cloud's columns along the sun: at points, and in the cells of a light grid. */
#include "light/sun_columns.h"

#include <math.h>

#include "field/clones.h"
#include "field/row.h"

float sun_columns_depth(const sun_columns *c, shape_vec3 p)
{
    float layer = ((&p.x)[c->at.axis[2]] - c->at.low[2]) / c->at.cell[2] - 0.5f, at[3];
    layer = c->at.upward ? (float)(c->at.size[2] - 1) - layer : layer;
    if (!(layer > -1))
        return 0;
    for (int side = 0; side < 2; side++) {
        at[side] = ((&p.x)[c->at.axis[side]] - c->at.low[side]) / c->at.cell[side] - 0.5f -
                   c->at.shear[side] * layer - (float)c->at.first[side];
        if (!(at[side] >= 0 && at[side] < (float)(c->at.count[side] - 1)))
            return 0;
    }
    at[2] = layer < (float)(c->at.size[2] - 1) ? layer : (float)(c->at.size[2] - 1);
    int i = (int)at[0], j = (int)at[1],
        k = (int)(at[2] + 1) - 1; /* -1: above the first layer, where nothing is */
    float x = at[0] - (float)i, y = at[1] - (float)j, z = at[2] - (float)k, value[2] = {0, 0};
    for (int half = 0; half < 2; half++) {
        int number = k + half < c->at.size[2] ? k + half : c->at.size[2] - 1;
        if (number < 0)
            continue;
        const float *near = c->depth +
                            ((size_t)number * (size_t)c->at.count[1] + (size_t)j) * (size_t)c->at.count[0] +
                            (size_t)i,
                    *far = near + c->at.count[0];
        float a = near[0] + x * (near[1] - near[0]), b = far[0] + x * (far[1] - far[0]);
        value[half] = a + y * (b - a);
    }
    return value[0] + z * (value[1] - value[0]);
}

/* Cells of the grid that was swept lie on the layers, and a layer's columns lie a fixed part of a cell beside them. */
NEPHELE_CLONES
static void fill_layer_row(const float *restrict near, const float *restrict far, float x, float y, int count,
                           float *restrict out)
{
#pragma omp simd
    for (int i = 0; i < count; i++) {
        float a = near[i] + x * (near[i + 1] - near[i]), b = far[i] + x * (far[i + 1] - far[i]);
        out[i] = a + y * (b - a);
    }
}

bool sun_columns_same_grid(const sun_columns *c, const shape_lightgrid *grid)
{
    for (int i = 0; i < 3; i++)
        if (c->at.size[i] != grid->size[c->at.axis[i]])
            return false;
    return true;
}

void sun_columns_fill_layer(const sun_columns *c, int layer, shape_lightgrid *grid)
{
    float row[ROW_MOST], part[2];
    int from[2], at[3];
    for (int side = 0; side < 2; side++) {
        float place = -c->at.shear[side] * (float)layer - (float)c->at.first[side];
        from[side] = (int)place;
        part[side] = place - (float)from[side];
    }
    at[c->at.axis[2]] = c->at.upward ? c->at.size[2] - 1 - layer : layer;
    for (int j = 0; j < c->at.size[1]; j++) {
        const float *near =
            c->depth +
            ((size_t)layer * (size_t)c->at.count[1] + (size_t)(from[1] + j)) * (size_t)c->at.count[0] +
            (size_t)from[0];
        fill_layer_row(near, near + c->at.count[0], part[0], part[1], c->at.size[0], row);
        at[c->at.axis[1]] = j;
        at[c->at.axis[0]] = 0;
        size_t cell =
            ((size_t)at[2] * (size_t)grid->size[1] + (size_t)at[1]) * (size_t)grid->size[0] + (size_t)at[0];
        size_t stride = c->at.axis[0] == 0 ? 1 : (size_t)grid->size[0];
        for (int i = 0; i < c->at.size[0]; i++)
            grid->cells[(cell + (size_t)i * stride) * SHAPE_LIGHTGRID_VALUES] = row[i];
    }
}
