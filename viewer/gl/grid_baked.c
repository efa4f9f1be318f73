/* The baked densities of the clouds in sight, each with voxels as fine as a view needs. A cloud's stays until a view needs
 * another. */
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "gl_private.h"
#include "shape/bake.h"

void gl_dense_drop(gl_dense *dense)
{
    if (!dense || atomic_fetch_sub(&dense->uses, 1) > 1)
        return;
    shape_baked_free(&dense->baked);
    free(dense);
}

gl_dense *gl_dense_share(gl_dense *dense)
{
    if (dense)
        atomic_fetch_add(&dense->uses, 1);
    return dense;
}

void gl_baked_drop(gl_baked *baked)
{
    if (!baked || --baked->uses)
        return;
    for (int i = 0; i < baked->count; i++)
        gl_dense_drop(baked->dense[i]);
    free(baked->dense);
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
 * theirs, shared evenly. But never so few that next to none lie in the cloud (shape_bake_voxel counts 16 along each axis for
 * the border), and a first picture is seen by a dozen along each. */
static size_t share_of_each(const gl_order *order, const float *wanted, int clouds)
{
    enum { LEAST = 20 * 20 * 20, LEAST_FIRST = 28 * 28 * 28 };
    const size_t least = order->first ? LEAST_FIRST : LEAST;
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
    return each > (double)least ? (size_t)each : least;
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
            baked->dense[i] = gl_dense_share(last);
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
    shape_status status = shape_bake_with(c, voxel, threads, order->stop, &dense->baked, error);
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

static shape_status create(int count, gl_baked **made, shape_error *error)
{
    gl_baked *baked = calloc(1, sizeof *baked);
    if (baked)
        baked->dense = calloc((size_t)count + 1, sizeof(gl_dense *));
    if (!baked || !baked->dense) {
        free(baked);
        return shape_error_memory(error);
    }
    baked->uses = 1;
    baked->count = count;
    *made = baked;
    return SHAPE_OK;
}

shape_status gl_baked_make(const gl_order *order, gl_baked **made, shape_error *error)
{
    const size_t count = order->volume->cloud_count;
    gl_baked *baked = NULL;
    float *wanted = calloc(2 * count + 1, sizeof *wanted);
    shape_status status = wanted ? create((int)count, &baked, error) : shape_error_memory(error);
    if (!status)
        status = bake_all(order, baked, wanted, wanted + count, error);
    free(wanted);
    if (status) {
        gl_baked_drop(baked);
        return status;
    }
    *made = baked;
    return SHAPE_OK;
}

shape_status gl_baked_join(const gl_baked *first, const gl_baked *second, gl_baked **made, shape_error *error)
{
    shape_status status = create(first->count, made, error);
    for (int i = 0; i < first->count && !status; i++)
        (*made)->dense[i] = gl_dense_share(first->dense[i] ? first->dense[i] : second->dense[i]);
    if (!status)
        (*made)->made = first->made;
    return status;
}

void gl_baked_place(const gl_baked *baked, gl_scene *scene)
{
    for (int i = 0; i < baked->count; i++) {
        if (!baked->dense[i])
            continue;
        const int *place = baked->dense[i]->place;
        const shape_baked *b = &baked->dense[i]->baked;
        gl_scene_put(scene, i, 18, place[0], place[1], place[2], 1 / (double)b->voxel);
        gl_scene_put(scene, i, 19, b->box.min.x, b->box.min.y, b->box.min.z, 0);
    }
}

gl_fit gl_baked_fit(const gl_baked *baked, const gl_order *order, double wider)
{
    gl_fit fit = GL_FITS;
    shape_camera camera = shape_view_camera(&order->view);
    for (int i = 0; i < baked->count; i++) {
        const shape_volume_cloud *c = &order->volume->clouds[i];
        if (!c->tree->count || !gl_in_sight(c, &camera, wider))
            continue;
        gl_fit own = baked->dense[i] ? fit_of(baked->dense[i], wanted_voxel(c, &order->view)) : GL_MISSING;
        fit = own > fit ? own : fit;
    }
    return fit;
}
