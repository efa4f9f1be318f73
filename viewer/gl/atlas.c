/* Boxes packed into one 3-D texture: by falling depth into layers, within a layer into rows, within a row side by side
 * (next-fit by level, Coffman et al. 1980, taken to three dimensions). */
#include <stdlib.h>

#include "gl_private.h"

typedef struct item {
    int number, depth, height;
} item;

/* Deepest first, then highest, then in their own order. */
static int compare(const void *a, const void *b)
{
    const item *x = a, *y = b;
    if (x->depth != y->depth)
        return y->depth - x->depth;
    if (x->height != y->height)
        return y->height - x->height;
    return x->number - y->number;
}

/* A width that makes the texture about as wide as deep: the cube root of what is to be placed. */
static int choose_side(const gl_box *boxes, int count, int axis, int limit)
{
    double volume = 0;
    int side = 1;
    for (int i = 0; i < count; i++) {
        volume += (double)boxes[i].size[0] * boxes[i].size[1] * boxes[i].size[2];
        side = boxes[i].size[axis] > side ? boxes[i].size[axis] : side;
    }
    while (side < limit && (double)side * side * side < 2 * volume)
        side += side / 8 + 1;
    return side < limit ? side : limit;
}

shape_status gl_atlas_pack(gl_box *boxes, int count, int limit, int size[3], shape_error *error)
{
    item *order = malloc(((size_t)count + 1) * sizeof *order);
    if (!order)
        return shape_error_memory(error);
    for (int i = 0; i < count; i++)
        order[i] = (item){i, boxes[i].size[2], boxes[i].size[1]};
    qsort(order, (size_t)count, sizeof *order, compare);
    int width = choose_side(boxes, count, 0, limit), height = choose_side(boxes, count, 1, limit);
    int x = 0, y = 0, z = 0, row = 0, layer = 0;
    size[0] = size[1] = size[2] = 1;
    for (int i = 0; i < count; i++) {
        gl_box *box = &boxes[order[i].number];
        if (x + box->size[0] > width)
            x = 0, y += row, row = 0;
        if (y + box->size[1] > height)
            x = 0, y = 0, row = 0, z += layer, layer = 0;
        box->place[0] = x, box->place[1] = y, box->place[2] = z;
        x += box->size[0];
        row = box->size[1] > row ? box->size[1] : row;
        layer = box->size[2] > layer ? box->size[2] : layer;
        for (int axis = 0; axis < 3; axis++) {
            int end = box->place[axis] + box->size[axis];
            size[axis] = end > size[axis] ? end : size[axis];
        }
    }
    free(order);
    if (size[0] > limit || size[1] > limit || size[2] > limit)
        return shape_error_set(error, SHAPE_ERROR_LIMIT,
                               "the grids of %d clouds do not fit into this GPU's 3-D textures (%d a side)",
                               count, limit);
    return SHAPE_OK;
}
