/* The grids of all clouds: light as solved, light as one eye sees it, and baked density, each in one atlas. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gl_private.h"
#include "shape/bake.h"
#include "shape/record.h"

static GLuint make_texture(const int size[3], GLint internal, GLenum format, GLenum kind, const void *data)
{
    static const GLenum edges[] = {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R};
    GLuint texture;
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_3D, texture);
    for (int i = 0; i < 3; i++)
        glTexParameteri(GL_TEXTURE_3D, edges[i], GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage3D(GL_TEXTURE_3D, 0, internal, size[0], size[1], size[2], 0, format, kind, data);
    return texture;
}

static int texture_limit(void)
{
    GLint largest = 256;
    glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &largest);
    return largest;
}

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

static size_t cell_count(const int size[3])
{
    return (size_t)size[0] * (size_t)size[1] * (size_t)size[2];
}

static void free_light(gl_grids *grids)
{
    for (int i = 0; i < grids->count; i++)
        shape_lightgrid_free(&grids->light[i]);
    free(grids->light);
    free(grids->light_boxes);
    free(grids->seen);
    glDeleteTextures(1, &grids->light_a);
    glDeleteTextures(1, &grids->light_b);
    glDeleteTextures(1, &grids->light_seen);
    grids->light = NULL;
    grids->light_boxes = NULL;
    grids->seen = NULL;
    grids->light_a = grids->light_b = grids->light_seen = 0;
    grids->count = 0;
}

/* Values 0..3 (part 0) or 4..7 (part 1) of all grids as one texture. */
static GLuint value_texture(const gl_grids *grids, int part, shape_error *error)
{
    float *atlas = calloc(cell_count(grids->light_size) * 4, sizeof *atlas);
    GLuint texture = 0;
    if (!atlas) {
        shape_error_memory(error);
        return 0;
    }
    for (int i = 0; i < grids->count; i++) {
        const gl_box *box = &grids->light_boxes[i];
        const shape_lightgrid *grid = &grids->light[i];
        size_t cell = 0;
        for (int z = 0; z < box->size[2]; z++)
            for (int y = 0; y < box->size[1]; y++) {
                float *to = atlas + (((size_t)(box->place[2] + z) * (size_t)grids->light_size[1] +
                                      (size_t)(box->place[1] + y)) *
                                         (size_t)grids->light_size[0] +
                                     (size_t)box->place[0]) *
                                        4;
                for (int x = 0; x < box->size[0]; x++, cell++)
                    memcpy(to + 4 * x, grid->cells + cell * SHAPE_LIGHTGRID_VALUES + 4 * part,
                           4 * sizeof *to);
            }
    }
    texture = make_texture(grids->light_size, GL_RGBA32F, GL_RGBA, GL_FLOAT, atlas);
    free(atlas);
    return texture;
}

shape_status gl_grids_set_light(gl_grids *grids, gl_scene *scene, const shape_volume *volume,
                                shape_lightgrid *light, bool values, shape_error *error)
{
    free_light(grids);
    grids->light = light;
    grids->count = scene->cloud_count;
    grids->light_boxes = calloc((size_t)grids->count + 1, sizeof *grids->light_boxes);
    if (!grids->light_boxes)
        return shape_error_memory(error);
    for (int i = 0; i < grids->count; i++)
        memcpy(grids->light_boxes[i].size, light[i].size, sizeof light[i].size);
    shape_status status =
        gl_atlas_pack(grids->light_boxes, grids->count, texture_limit(), grids->light_size, error);
    if (status)
        return status;
    for (int i = 0; i < grids->count; i++) {
        float *record = scene->records + (size_t)i * GL_RECORD_TEXELS * 4;
        shape_record_set_light((float(*)[4])record, &volume->clouds[i], &light[i],
                               grids->light_boxes[i].place);
    }
    if (values) {
        grids->light_a = value_texture(grids, 0, error);
        grids->light_b = value_texture(grids, 1, error);
        return grids->light_a && grids->light_b ? SHAPE_OK : SHAPE_ERROR_MEMORY;
    }
    grids->seen = calloc(cell_count(grids->light_size) * 4, sizeof *grids->seen);
    return grids->seen ? SHAPE_OK : shape_error_memory(error);
}

void gl_grids_compose(gl_grids *grids, const gl_scene *scene, const shape_volume *volume,
                      const shape_light *light, const float sky_upper[3], const float sky_lower[3],
                      shape_dvec3 eye)
{
    if (!grids->light_seen)
        grids->light_seen = make_texture(grids->light_size, GL_RGBA32F, GL_RGBA, GL_FLOAT, NULL);
    glBindTexture(GL_TEXTURE_3D, grids->light_seen);
    for (int i = 0; i < scene->shown_count; i++) {
        int cloud = scene->shown[i];
        const gl_box *box = &grids->light_boxes[cloud];
        /* The scratch is as large as the atlas, so as any one grid. */
        shape_lightgrid_seen(&grids->light[cloud], &volume->clouds[cloud], light, sky_upper, sky_lower, eye,
                             grids->seen);
        glTexSubImage3D(GL_TEXTURE_3D, 0, box->place[0], box->place[1], box->place[2], box->size[0],
                        box->size[1], box->size[2], GL_RGBA, GL_FLOAT, grids->seen);
    }
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
    /* Distance and voxel are both in the cloud's frame. */
    return (float)fmax(1.25 * pixel * sqrt(away), finest);
}

shape_status gl_grids_bake(gl_grids *grids, gl_scene *scene, const shape_volume *volume,
                           const shape_view *view, size_t budget, shape_error *error)
{
    int count = scene->cloud_count, size[3];
    shape_baked *baked = calloc((size_t)count + 1, sizeof *baked);
    gl_box *boxes = calloc((size_t)count + 1, sizeof *boxes);
    shape_status status = baked && boxes ? SHAPE_OK : shape_error_memory(error);
    for (int i = 0; i < count && !status; i++) {
        const shape_volume_cloud *c = &volume->clouds[i];
        float voxel = shape_bake_voxel(c, wanted_voxel(c, view), budget / (size_t)count);
        status = shape_bake(c, voxel, 0, &baked[i], error);
        memcpy(boxes[i].size, baked[i].size, sizeof boxes[i].size);
    }
    if (!status)
        status = gl_atlas_pack(boxes, count, texture_limit(), size, error);
    uint8_t *atlas = status ? NULL : calloc(cell_count(size), 2);
    if (!status && !atlas)
        status = shape_error_memory(error);
    for (int i = 0; i < count && !status; i++) {
        copy_box(&boxes[i], baked[i].voxels, 2, size, atlas);
        gl_scene_put(scene, i, 18, boxes[i].place[0], boxes[i].place[1], boxes[i].place[2],
                     1 / (double)baked[i].voxel);
        gl_scene_put(scene, i, 19, baked[i].box.min.x, baked[i].box.min.y, baked[i].box.min.z, 0);
    }
    if (!status) {
        glDeleteTextures(1, &grids->baked);
        grids->baked = make_texture(size, GL_RG8, GL_RG, GL_UNSIGNED_BYTE, atlas);
    }
    for (int i = 0; baked && i < count; i++)
        shape_baked_free(&baked[i]);
    free(baked);
    free(boxes);
    free(atlas);
    return status;
}

void gl_grids_free(gl_grids *grids)
{
    free_light(grids);
    glDeleteTextures(1, &grids->baked);
    memset(grids, 0, sizeof *grids);
}
