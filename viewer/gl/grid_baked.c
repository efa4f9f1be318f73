/* The baked densities of all clouds in one atlas, with voxels as fine as a view needs. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gl_private.h"
#include "shape/bake.h"

/* Copies a box of cells of `bytes` bytes each into an atlas. */
static void copy_box(const gl_box *box, const void *cells, size_t bytes, const int size[3], void *atlas)
{
    size_t row = (size_t)box->size[0] * bytes;
    for (int z = 0; z < box->size[2]; z++)
        for (int y = 0; y < box->size[1]; y++) {
            size_t from = ((size_t)z * (size_t)box->size[1] + (size_t)y) * row;
            size_t to = (((size_t)(box->place[2] + z) * (size_t)size[1] + (size_t)(box->place[1] + y)) *
                             (size_t)size[0] +
                         (size_t)box->place[0]) *
                        bytes;
            memcpy((char *)atlas + to, (const char *)cells + from, row);
        }
}

void gl_baked_drop(gl_baked *baked)
{
    if (!baked || --baked->uses)
        return;
    glDeleteTextures(1, &baked->texture);
    free(baked->clouds);
    free(baked->boxes);
    free(baked->atlas);
    free(baked);
}

/* How fine a cloud's voxels must be [m, cloud's frame]: about a pixel where it is nearest, no finer than its noise. */
static float wanted_voxel(const shape_volume_cloud *c, const shape_view *view)
{
    shape_dvec3 eye = shape_frame_point(&c->inverse, view->eye);
    double away = 0;
    for (int axis = 0; axis < 3; axis++) {
        double e = (&eye.x)[axis], low = (&c->box.min.x)[axis], high = (&c->box.max.x)[axis];
        double beyond = e < low ? low - e : e > high ? e - high : 0;
        away += beyond * beyond;
    }
    double pixel = 2 * tan(view->fov * 3.14159265358979 / 360) / view->height;
    double finest = 1 / (double)c->inverse_noise_scale / (1 << (c->field.octaves > 4 ? 4 : c->field.octaves));
    /* Distance and voxel are both in the cloud's frame. In steps of the square root of 2, so that a view that moves a
     * little keeps its voxels. */
    double wanted = fmax(1.25 * pixel * sqrt(away), finest);
    return (float)fmax(exp2(floor(2 * log2(wanted)) / 2), finest);
}

shape_status gl_baked_make(const gl_order *order, gl_baked **made, shape_error *error)
{
    size_t count = order->volume->cloud_count;
    gl_baked *baked = calloc(1, sizeof *baked);
    shape_baked *one = calloc(count + 1, sizeof *one);
    if (!baked || !one) {
        free(baked);
        free(one);
        return shape_error_memory(error);
    }
    baked->uses = 1;
    baked->count = (int)count;
    baked->clouds = calloc(count + 1, sizeof *baked->clouds);
    baked->boxes = calloc(count + 1, sizeof *baked->boxes);
    shape_status status = baked->clouds && baked->boxes ? SHAPE_OK : shape_error_memory(error);
    for (size_t i = 0; i < count && !status; i++) {
        const shape_volume_cloud *c = &order->volume->clouds[i];
        float wanted = wanted_voxel(c, &order->view);
        float voxel = shape_bake_voxel(c, wanted, order->bake_voxels / count);
        status = shape_bake(c, voxel, order->threads, &one[i], error);
        memcpy(baked->boxes[i].size, one[i].size, sizeof one[i].size);
        baked->clouds[i] =
            (gl_baked_cloud){one[i].box.min, one[i].voxel, wanted, one[i].voxel > wanted * 1.001f};
    }
    if (!status)
        status = gl_atlas_pack(baked->boxes, (int)count, order->texture_limit, baked->size, error);
    if (!status) {
        const int *size = baked->size;
        baked->atlas = calloc((size_t)size[0] * (size_t)size[1] * (size_t)size[2], 2);
        status = baked->atlas ? SHAPE_OK : shape_error_memory(error);
    }
    for (size_t i = 0; i < count && !status; i++)
        copy_box(&baked->boxes[i], one[i].voxels, 2, baked->size, baked->atlas);
    for (size_t i = 0; i < count; i++)
        shape_baked_free(&one[i]);
    free(one);
    if (status) {
        gl_baked_drop(baked);
        return status;
    }
    *made = baked;
    return SHAPE_OK;
}

void gl_baked_upload(gl_baked *baked)
{
    baked->texture = gl_volume_texture(baked->size, GL_RG8, GL_RG, GL_UNSIGNED_BYTE, baked->atlas);
    free(baked->atlas);
    baked->atlas = NULL;
}

void gl_baked_place(const gl_baked *baked, gl_scene *scene)
{
    for (int i = 0; i < baked->count; i++) {
        const int *place = baked->boxes[i].place;
        const gl_baked_cloud *c = &baked->clouds[i];
        gl_scene_put(scene, i, 18, place[0], place[1], place[2], 1 / (double)c->voxel);
        gl_scene_put(scene, i, 19, c->low.x, c->low.y, c->low.z, 0);
    }
}

gl_fit gl_baked_fit(const gl_baked *baked, const shape_volume *volume, const shape_view *view)
{
    gl_fit fit = GL_FITS;
    for (int i = 0; i < baked->count; i++) {
        const gl_baked_cloud *c = &baked->clouds[i];
        float wanted = wanted_voxel(&volume->clouds[i], view);
        if (wanted < 0.99f * c->wanted && !c->at_limit)
            return GL_TOO_COARSE;
        if (wanted > 1.01f * c->wanted)
            fit = wanted > 3.9f * c->wanted ? GL_FAR_TOO_FINE : fit == GL_FITS ? GL_TOO_FINE : fit;
    }
    return fit;
}
