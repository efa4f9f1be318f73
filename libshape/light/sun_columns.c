/* Optical depths out of one cloud's columns along the sun: at points, and in the cells of a light grid. */
#include "light/sun_columns.h"

#include <math.h>

#include "field/clones.h"
#include "field/row.h"
#include "light/lightgrid_layout.h"

/* What points have in common that lie in a row along the columns' rows: between which rows of which layers. */
typedef struct row_place {
    float layer; /* from the sun */
    const float *row
        [2]; /* the nearer row of the layer before and of that after; NULL: above the first, where nothing is */
    float y, z; /* how far towards the others */
} row_place;

/* False where there is nothing. */
static bool find_row(const sun_columns *columns, shape_vec3 p, row_place *place)
{
    const sun_layout *c = &columns->at;
    float layer = ((&p.x)[c->axis[2]] - c->low[2]) / c->cell[2] - 0.5f;
    layer = c->upward ? (float)(c->size[2] - 1) - layer : layer;
    if (!(layer > -1))
        return false;
    float row =
        ((&p.x)[c->axis[1]] - c->low[1]) / c->cell[1] - 0.5f - c->shear[1] * layer - (float)c->first[1];
    if (!(row >= 0 && row < (float)(c->count[1] - 1)))
        return false;
    float deep = layer < (float)(c->size[2] - 1) ? layer : (float)(c->size[2] - 1);
    int j = (int)row, k = (int)(deep + 1) - 1; /* -1: above the first layer */
    place->layer = layer;
    place->y = row - (float)j;
    place->z = deep - (float)k;
    for (int half = 0; half < 2; half++) {
        int number = k + half < c->size[2] ? k + half : c->size[2] - 1;
        size_t start = ((size_t)number * (size_t)c->count[1] + (size_t)j) * (size_t)c->count[0];
        place->row[half] = number < 0 ? NULL : columns->depth + start;
    }
    return true;
}

/* The depth at a place x along such a row [m]. */
static inline float row_depth(const sun_layout *c, const row_place *place, float x)
{
    float at = (x - c->low[0]) / c->cell[0] - 0.5f - c->shear[0] * place->layer - (float)c->first[0];
    float value[2] = {0, 0};
    if (!(at >= 0 && at < (float)(c->count[0] - 1)))
        return 0;
    int i = (int)at;
    float part = at - (float)i;
    for (int half = 0; half < 2; half++) {
        if (!place->row[half])
            continue;
        const float *near = place->row[half] + i, *far = near + c->count[0];
        float a = near[0] + part * (near[1] - near[0]), b = far[0] + part * (far[1] - far[0]);
        value[half] = a + place->y * (b - a);
    }
    return value[0] + place->z * (value[1] - value[0]);
}

float sun_columns_depth(const sun_columns *c, shape_vec3 p)
{
    row_place place;
    return find_row(c, p, &place) ? row_depth(&c->at, &place, (&p.x)[c->at.axis[0]]) : 0;
}

void sun_columns_add_row(const sun_columns *c, const shape_lightgrid *grid, int row)
{
    float *cells = grid->cells + (size_t)row * (size_t)grid->size[0] * SHAPE_LIGHTGRID_VALUES;
    shape_vec3 p = lightgrid_point(grid, 0, row % grid->size[1], row / grid->size[1], 0.5f, 0.5f, 0.5f);
    const float low = grid->box.min.x, width = grid->box.max.x - low;
    row_place place;
    bool along = c->at.axis[0] == 0;
    if (along && !find_row(c, p, &place))
        return;
    for (int i = 0; i < grid->size[0]; i++) {
        p.x = low + width * ((float)i + 0.5f) / (float)grid->size[0];
        cells[i * SHAPE_LIGHTGRID_VALUES] += along ? row_depth(&c->at, &place, p.x) : sun_columns_depth(c, p);
    }
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
