/* Light and baked density made while pictures go on: coarse first, then on a thread of its own as fine as the view needs,
 * and again when the view has changed so much that it needs others. */
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "gl_private.h"

enum {
    FIRST_LIGHT = 12,      /* cells along the longest side, to begin with */
    FIRST_VOXELS = 150000, /* of all clouds together */
};

struct gl_refinement {
    pthread_t thread;
    gl_order order;
    shape_light light; /* a copy: the renderer's may change */
    atomic_bool done;
    gl_light *new_light;
    gl_baked *new_baked;
    double light_ms, bake_ms;
    shape_status status;
    shape_error error;
};

static double now_ms(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

static shape_status make(const gl_order *order, gl_light **light, double *light_ms, gl_baked **baked,
                         double *bake_ms, shape_error *error)
{
    double start = now_ms();
    shape_status status = order->want_light ? gl_light_make(order, light, error) : SHAPE_OK;
    double middle = now_ms();
    if (!status && order->want_baked)
        status = gl_baked_make(order, baked, error);
    if (order->want_light)
        *light_ms = middle - start;
    if (order->want_baked)
        *bake_ms = now_ms() - middle;
    return status;
}

static void *work(void *data)
{
    gl_refinement *job = data;
    job->status =
        make(&job->order, &job->new_light, &job->light_ms, &job->new_baked, &job->bake_ms, &job->error);
    atomic_store(&job->done, true);
    return NULL;
}

void gl_refine_stop(shape_gl_renderer *r)
{
    gl_refinement *job = r->refinement;
    if (!job)
        return;
    pthread_join(job->thread, NULL);
    gl_light_drop(job->new_light);
    gl_baked_drop(job->new_baked);
    free(job);
    r->refinement = NULL;
}

static void start(shape_gl_renderer *r, const gl_order *order)
{
    gl_refinement *job = calloc(1, sizeof *job);
    if (!job)
        return; /* what is there already does */
    job->order = *order;
    job->light = r->light;
    job->order.light = &job->light;
    if (pthread_create(&job->thread, NULL, work, job))
        free(job);
    else
        r->refinement = job;
}

static void take_light(shape_gl_renderer *r, gl_light *light)
{
    if (r->options.method == SHAPE_GL_PAPER || r->options.method == SHAPE_GL_PAPER_NDT)
        gl_light_upload(light);
    gl_light_drop(r->grids.light);
    r->grids.light = light;
}

static void take_baked(shape_gl_renderer *r, gl_baked *baked)
{
    gl_baked_upload(baked);
    gl_baked_drop(r->grids.baked);
    r->grids.baked = baked;
}

/* The grids that were shown so far stay, to be faded out. */
static void keep_last(shape_gl_renderer *r)
{
    gl_grids_drop(&r->last_grids);
    r->last_grids = r->grids;
    if (r->grids.light)
        r->grids.light->uses++;
    if (r->grids.baked)
        r->grids.baked->uses++;
    r->fade_left = GL_FADE_FRAMES;
}

/* Takes over what the thread has made. */
static shape_status collect(shape_gl_renderer *r, shape_error *error)
{
    gl_refinement *job = r->refinement;
    if (!job || !atomic_load(&job->done))
        return SHAPE_OK;
    shape_status status = job->status;
    if (status) {
        *error = job->error;
    } else {
        keep_last(r);
        if (job->new_light)
            take_light(r, job->new_light);
        if (job->new_baked)
            take_baked(r, job->new_baked);
        r->costs.light_ms = job->order.want_light ? job->light_ms : r->costs.light_ms;
        r->costs.bake_ms = job->order.want_baked ? job->bake_ms : r->costs.bake_ms;
        r->refined = true;
        job->new_light = NULL;
        job->new_baked = NULL;
    }
    gl_refine_stop(r);
    return status;
}

static shape_status make_now(shape_gl_renderer *r, const gl_order *order, shape_error *error)
{
    gl_light *light = NULL;
    gl_baked *baked = NULL;
    shape_status status = make(order, &light, &r->costs.light_ms, &baked, &r->costs.bake_ms, error);
    if (status) {
        gl_light_drop(light);
        gl_baked_drop(baked);
        return status;
    }
    if (light)
        take_light(r, light);
    if (baked)
        take_baked(r, baked);
    return SHAPE_OK;
}

static gl_order whole_order(const shape_gl_renderer *r, const shape_view *view)
{
    GLint largest = 256;
    glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &largest);
    return (gl_order){.volume = r->volume,
                      .light = &r->light,
                      .paper = r->options.method == SHAPE_GL_PAPER || r->options.method == SHAPE_GL_PAPER_NDT,
                      .light_options = r->options.light,
                      .view = *view,
                      .bake_voxels = r->options.bake_voxels,
                      .texture_limit = largest};
}

static shape_status prepare_in_background(shape_gl_renderer *r, gl_order *order, gl_fit fit,
                                          shape_error *error)
{
    shape_status status = collect(r, error);
    if (status)
        return status;
    order->want_light = r->light_changed;
    order->want_baked = !r->grids.baked;
    if (order->want_light || order->want_baked) {
        gl_refine_stop(r); /* what it makes is of no use any more */
        gl_order first = *order;
        first.light_options.resolution =
            order->light_options.resolution < FIRST_LIGHT ? order->light_options.resolution : FIRST_LIGHT;
        first.bake_voxels = order->bake_voxels < FIRST_VOXELS ? order->bake_voxels : FIRST_VOXELS;
        status = make_now(r, &first, error);
        r->light_changed = false;
        r->fade_left = 0;
    } else if (!r->refinement && (fit == GL_TOO_COARSE || fit == GL_FAR_TOO_FINE)) {
        order->want_baked = true;
    }
    if (!status && !r->refinement && (order->want_light || order->want_baked))
        start(r, order);
    return status;
}

shape_status gl_refine(shape_gl_renderer *r, const shape_view *view, shape_error *error)
{
    bool preview = r->options.method == SHAPE_GL_DEFAULT;
    gl_order order = whole_order(r, view);
    gl_fit fit = r->grids.baked ? gl_baked_fit(r->grids.baked, r->volume, view) : GL_TOO_COARSE;
    shape_status status = SHAPE_OK;
    if (preview && r->options.background) {
        status = prepare_in_background(r, &order, fit, error);
    } else {
        order.want_light = r->light_changed;
        order.want_baked = preview && fit != GL_FITS;
        if (order.want_light || order.want_baked)
            status = make_now(r, &order, error);
        r->light_changed = r->light_changed && status;
    }
    return status;
}
