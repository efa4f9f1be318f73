/* Voxel grids for the exact view: all of a scene's values, as they are, in one 3-D texture. The preview needs none of it:
 * it bakes grids like other fields. */
#include <stdlib.h>
#include <string.h>

#include "gl_private.h"
#include "shape/grid.h"

static const shape_grid *grid_of(const shape_volume *volume, size_t i)
{
    const shape_volume_cloud *c = &volume->clouds[i];
    return c->field.model == SHAPE_MODEL_GRID ? c->list->grid : NULL;
}

/* A box for each grid; copies of a cloud share one. box_of[i] is that of cloud i. */
static int list_boxes(const shape_volume *volume, gl_box *boxes, int *box_of)
{
    int count = 0;
    for (size_t i = 0; i < volume->cloud_count; i++) {
        const shape_grid *grid = grid_of(volume, i);
        box_of[i] = -1;
        for (size_t j = 0; j < i && grid && box_of[i] < 0; j++)
            if (grid_of(volume, j) == grid)
                box_of[i] = box_of[j];
        if (grid && box_of[i] < 0) {
            memcpy(boxes[count].size, grid->points, sizeof boxes[count].size);
            box_of[i] = count++;
        }
    }
    return count;
}

static GLuint upload(const shape_volume *volume, const gl_box *boxes, const int *box_of, const int size[3],
                     shape_status *status, shape_error *error)
{
    size_t count = (size_t)size[0] * (size_t)size[1] * (size_t)size[2];
    float *atlas = calloc(count, sizeof *atlas);
    GLuint texture = 0;
    if (!atlas) {
        *status = shape_error_memory(error);
        return 0;
    }
    for (size_t i = 0; i < volume->cloud_count; i++)
        if (box_of[i] >= 0)
            shape_grid_copy(grid_of(volume, i), 1 / volume->clouds[i].most, boxes[box_of[i]].place, size,
                            atlas);
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_3D, texture);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexImage3D(GL_TEXTURE_3D, 0, GL_R32F, size[0], size[1], size[2], 0, GL_RED, GL_FLOAT, atlas);
    free(atlas);
    return texture;
}

shape_status gl_volumes_load(gl_scene *scene, const shape_volume *volume, shape_error *error)
{
    const double most_bytes = 1 << 30;
    GLint limit = 256;
    int size[3];
    shape_status status = SHAPE_OK;
    gl_box *boxes = calloc(volume->cloud_count + 1, sizeof *boxes);
    int *box_of = calloc(volume->cloud_count + 1, sizeof *box_of);
    if (!boxes || !box_of)
        status = shape_error_memory(error);
    int count = status ? 0 : list_boxes(volume, boxes, box_of);
    glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &limit);
    if (count)
        status = gl_atlas_pack(boxes, count, limit, size, error);
    if (count && !status && 4.0 * size[0] * size[1] * size[2] > most_bytes)
        status =
            shape_error_set(error, SHAPE_ERROR_LIMIT,
                            "voxel grids of %d x %d x %d in all are too large for the exact view (choose "
                            "--method default)",
                            size[0], size[1], size[2]);
    if (count && !status)
        scene->grid_values = upload(volume, boxes, box_of, size, &status, error);
    for (size_t i = 0; i < volume->cloud_count && count && !status; i++)
        if (box_of[i] >= 0) {
            const gl_box *box = &boxes[box_of[i]];
            gl_scene_put(scene, (int)i, 20, box->place[0], box->place[1], box->place[2], 0);
            gl_scene_put(scene, (int)i, 21, box->size[0], box->size[1], box->size[2], 0);
        }
    free(boxes);
    free(box_of);
    return status;
}
