/* Where the cells of a cloud's light grid lie; the light grid and the sweep along the sun both ask. */
#include "light/lightgrid_layout.h"

#include <math.h>

void lightgrid_lay_out(const shape_volume_cloud *cloud, int resolution, shape_lightgrid *grid)
{
    shape_box box = cloud->box;
    if (shape_box_is_empty(box))
        box = (shape_box){{0, 0, 0}, {1, 1, 1}};
    const int fewest = resolution / 4;
    float *min = &box.min.x, *max = &box.max.x, longest = 0, reach = 1e-30f;
    for (int axis = 0; axis < 3; axis++) {
        longest = fmaxf(longest, max[axis] - min[axis]);
        reach = fmaxf(reach, fmaxf(fabsf(min[axis]), fabsf(max[axis])));
    }
    /* Far from its frame's origin a cloud is no thicker than a float's step; a cell must be. */
    float cell = fmaxf(longest / (float)(resolution > 3 ? resolution - 2 : 1), reach * 1e-6f);
    for (int axis = 0; axis < 3; axis++) {
        int inner = (int)ceilf((max[axis] - min[axis]) / cell * 0.9999f);
        float edge = cell;
        if (cloud->field.model == SHAPE_MODEL_LAYER && inner < fewest) {
            /* A layer is far wider than it is thick, and its light changes over its thickness. */
            inner = fewest;
            edge = fmaxf((max[axis] - min[axis]) / (float)fewest, reach * 1e-6f);
        }
        grid->size[axis] = (inner < 1 ? 1 : inner) + 2;
        float middle = 0.5f * min[axis] + 0.5f * max[axis], half = 0.5f * edge * (float)grid->size[axis];
        min[axis] = middle - half;
        max[axis] = middle + half;
    }
    grid->box = box;
}

shape_vec3 lightgrid_point(const shape_lightgrid *grid, int x, int y, int z, float fx, float fy, float fz)
{
    shape_vec3 size = shape_vec3_sub(grid->box.max, grid->box.min);
    return shape_vec3_make(grid->box.min.x + size.x * ((float)x + fx) / (float)grid->size[0],
                           grid->box.min.y + size.y * ((float)y + fy) / (float)grid->size[1],
                           grid->box.min.z + size.z * ((float)z + fz) / (float)grid->size[2]);
}
