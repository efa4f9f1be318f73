/* The baked densities of the clouds in sight in one atlas, each with voxels as fine as a view needs. A cloud's stays until
 * a view needs another. */
#include <math.h>
#include <omp.h>
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

static void drop_dense(gl_dense *dense)
{
    if (!dense || atomic_fetch_sub(&dense->uses, 1) > 1)
        return;
    shape_baked_free(&dense->baked);
    free(dense);
}

static gl_dense *share(gl_dense *dense)
{
    if (dense)
        atomic_fetch_add(&dense->uses, 1);
    return dense;
}

void gl_baked_drop(gl_baked *baked)
{
    if (!baked || --baked->uses)
        return;
    glDeleteTextures(1, &baked->texture);
    for (int i = 0; i < baked->count; i++)
        drop_dense(baked->dense[i]);
    free(baked->dense);
    free(baked->boxes);
    free(baked->atlas);
    free(baked);
}

double gl_pixel_size(const shape_volume_cloud *c, const shape_view *view)
{
    shape_dvec3 eye = shape_frame_point(&c->inverse, view->eye);
    double away = 0;
    for (int axis = 0; axis < 3; axis++) {
        double e = (&eye.x)[axis], low = (&c->box.min.x)[axis], high = (&c->box.max.x)[axis];
        double beyond = e < low ? low - e : e > high ? e - high : 0;
        away += beyond * beyond;
    }
    return 2 * tan(view->fov * 3.14159265358979 / 360) / view->height * sqrt(away);
}

/* How fine a cloud's voxels must be [m, cloud's frame]: about a pixel where it is nearest, no finer than its noise. */
static float wanted_voxel(const shape_volume_cloud *c, const shape_view *view)
{
    double finest = 1 / (double)c->inverse_noise_scale / (1 << (c->field.octaves > 4 ? 4 : c->field.octaves));
    /* Distance and voxel are both in the cloud's frame. In steps of the square root of 2, so that a view that moves a
     * little keeps its voxels. */
    double wanted = fmax(1.25 * gl_pixel_size(c, view), finest);
    return (float)fmax(exp2(floor(2 * log2(wanted)) / 2), finest);
}

gl_fit gl_fit_sizes(double has, double wants)
{
    return has < 0.99 * wants   ? GL_TOO_COARSE
           : has > 3.9 * wants  ? GL_FAR_TOO_FINE
           : has > 1.01 * wants ? GL_TOO_FINE
                                : GL_FITS;
}

static gl_fit fit_of(const gl_dense *dense, float wanted)
{
    gl_fit fit = gl_fit_sizes(1 / (double)dense->wanted, 1 / (double)wanted);
    return fit == GL_TOO_COARSE && dense->at_limit ? GL_FITS : fit;
}

static double voxel_count(const shape_volume_cloud *c, double voxel)
{
    double count = 1;
    for (int axis = 0; axis < 3; axis++)
        count *= ((double)(&c->box.max.x)[axis] - (double)(&c->box.min.x)[axis]) / voxel + 8;
    return count;
}

/* What the clouds near the view want [m], 0 for the others. Returns how many do. */
static int find_wanted(const gl_order *order, float *wanted)
{
    shape_camera camera = shape_view_camera(&order->view);
    int count = 0;
    for (size_t i = 0; i < order->volume->cloud_count; i++) {
        const shape_volume_cloud *c = &order->volume->clouds[i];
        bool near = c->tree->count && gl_in_sight(c, &camera, GL_MARGIN);
        wanted[i] = near ? wanted_voxel(c, &order->view) : 0;
        count += near;
    }
    return count;
}

/* Voxels for each of them: what it wants where all fit into the limit, else what is left when those that want less have
 * theirs, shared evenly. */
static size_t share_of_each(const gl_order *order, const float *wanted, int clouds)
{
    double all = (double)order->bake_voxels, each = all / (clouds > 0 ? clouds : 1);
    for (int round = 0; round < 4; round++) {
        double taken = 0;
        int modest = 0;
        for (size_t i = 0; i < order->volume->cloud_count; i++) {
            double count = wanted[i] > 0 ? voxel_count(&order->volume->clouds[i], (double)wanted[i]) : 0;
            if (count > 0 && count <= each) {
                taken += count;
                modest++;
            }
        }
        if (modest < clouds)
            each = fmax(each, (all - taken) / (clouds - modest));
    }
    return (size_t)each;
}

/* Takes over what does; of the rest voxels[i] gets how fine it is baked, 0: not at all. Returns how many are baked. */
static int choose(const gl_order *order, const float *wanted, size_t each, gl_baked *baked, float *voxels)
{
    const gl_baked *old = order->baked_from;
    int chosen = 0;
    size_t kept = 0;
    for (size_t i = 0; i < order->volume->cloud_count; i++) {
        gl_dense *last = old ? old->dense[i] : NULL;
        float voxel = wanted[i] > 0 ? shape_bake_voxel(&order->volume->clouds[i], wanted[i], each) : 0;
        bool good = last && wanted[i] > 0 &&
                    (order->missing_only || (last->baked.voxel == voxel && last->wanted < INFINITY) ||
                     (order->lenient && fit_of(last, wanted[i]) <= GL_TOO_FINE));
        if (last && !(wanted[i] > 0) && order->lenient) {
            const int *n = last->baked.size;
            kept += (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
            good = kept <= order->bake_voxels / 2;
        }
        if (good)
            baked->dense[i] = share(last);
        else
            voxels[i] = voxel;
        chosen += voxels[i] > 0;
    }
    return chosen;
}

static shape_status bake(const gl_order *order, size_t cloud, float wanted, float voxel, int threads,
                         gl_dense **made, shape_error *error)
{
    const shape_volume_cloud *c = &order->volume->clouds[cloud];
    gl_dense *dense = calloc(1, sizeof *dense);
    if (!dense)
        return shape_error_memory(error);
    shape_status status = shape_bake(c, voxel, threads, &dense->baked, error);
    if (status) {
        free(dense);
        return status;
    }
    atomic_init(&dense->uses, 1);
    bool coarser = voxel > wanted * 1.001f;
    dense->at_limit = coarser && !order->first;
    dense->wanted = coarser && order->first ? INFINITY : wanted;
    *made = dense;
    return SHAPE_OK;
}

/* Each cloud on one thread. */
static shape_status bake_many(const gl_order *order, const float *wanted, const float *voxels, int threads,
                              gl_baked *baked, shape_error *error)
{
    shape_status status = SHAPE_OK;
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (int i = 0; i < baked->count; i++) {
        shape_error own = {0};
        if (!(voxels[i] > 0) || !bake(order, (size_t)i, wanted[i], voxels[i], 1, &baked->dense[i], &own))
            continue;
#pragma omp critical
        {
            status = own.status;
            if (error)
                *error = own;
        }
    }
    return status;
}

static shape_status bake_all(const gl_order *order, gl_baked *baked, float *wanted, float *voxels,
                             shape_error *error)
{
    size_t each = share_of_each(order, wanted, find_wanted(order, wanted));
    int chosen = choose(order, wanted, each, baked, voxels);
    int threads = order->threads > 0 ? order->threads : omp_get_max_threads();
    shape_status status = SHAPE_OK;
    baked->made = chosen;
    if (chosen >= 2 * threads)
        return bake_many(order, wanted, voxels, threads, baked, error);
    for (int i = 0; i < baked->count && !status; i++)
        if (voxels[i] > 0)
            status = bake(order, (size_t)i, wanted[i], voxels[i], threads, &baked->dense[i], error);
    return status;
}

/* All grids into one atlas, to be uploaded. */
static shape_status pack(gl_baked *baked, int texture_limit, shape_error *error)
{
    int *size = baked->size;
    for (int i = 0; i < baked->count; i++)
        memset(baked->boxes[i].size, 0, sizeof baked->boxes[i].size);
    for (int i = 0; i < baked->count; i++)
        if (baked->dense[i])
            memcpy(baked->boxes[i].size, baked->dense[i]->baked.size, sizeof baked->boxes[i].size);
    shape_status status = gl_atlas_pack(baked->boxes, baked->count, texture_limit, size, error);
    if (status)
        return status;
    free(baked->atlas);
    baked->atlas = calloc((size_t)size[0] * (size_t)size[1] * (size_t)size[2], 2);
    if (!baked->atlas)
        return shape_error_memory(error);
    for (int i = 0; i < baked->count; i++)
        if (baked->dense[i])
            copy_box(&baked->boxes[i], baked->dense[i]->baked.voxels, 2, size, baked->atlas);
    return SHAPE_OK;
}

shape_status gl_baked_make(const gl_order *order, gl_baked **made, shape_error *error)
{
    size_t count = order->volume->cloud_count;
    gl_baked *baked = calloc(1, sizeof *baked);
    float *wanted = calloc(2 * count + 1, sizeof *wanted);
    if (!baked || !wanted) {
        free(baked);
        free(wanted);
        return shape_error_memory(error);
    }
    baked->uses = 1;
    baked->dense = calloc(count + 1, sizeof(gl_dense *));
    baked->boxes = calloc(count + 1, sizeof *baked->boxes);
    shape_status status = baked->dense && baked->boxes ? SHAPE_OK : shape_error_memory(error);
    if (!status) {
        baked->count = (int)count;
        status = bake_all(order, baked, wanted, wanted + count, error);
    }
    if (!status)
        status = pack(baked, order->texture_limit, error);
    free(wanted);
    if (status) {
        gl_baked_drop(baked);
        return status;
    }
    *made = baked;
    return SHAPE_OK;
}

shape_status gl_baked_add(gl_baked *baked, const gl_baked *from, int texture_limit, shape_error *error)
{
    bool added = false;
    for (int i = 0; i < baked->count; i++)
        if (!baked->dense[i] && from->dense[i]) {
            baked->dense[i] = share(from->dense[i]);
            added = true;
        }
    return added ? pack(baked, texture_limit, error) : SHAPE_OK;
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
        if (!baked->dense[i])
            continue;
        const shape_baked *b = &baked->dense[i]->baked;
        gl_scene_put(scene, i, 18, place[0], place[1], place[2], 1 / (double)b->voxel);
        gl_scene_put(scene, i, 19, b->box.min.x, b->box.min.y, b->box.min.z, 0);
    }
}

gl_fit gl_baked_fit(const gl_baked *baked, const gl_order *order)
{
    gl_fit fit = GL_FITS;
    shape_camera camera = shape_view_camera(&order->view);
    for (int i = 0; i < baked->count; i++) {
        const shape_volume_cloud *c = &order->volume->clouds[i];
        if (!c->tree->count || !gl_in_sight(c, &camera, 1))
            continue;
        gl_fit own = baked->dense[i] ? fit_of(baked->dense[i], wanted_voxel(c, &order->view)) : GL_MISSING;
        fit = own > fit ? own : fit;
    }
    return fit;
}
