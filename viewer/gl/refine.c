/* Light and baked density made while pictures go on: something coarse at once, then on a thread of its own as fine as the
 * view needs, and again when the view has changed so much that it needs others. Only clouds in sight, and of these only
 * those that need it. */
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "gl_private.h"

enum {
    FIRST_LIGHT = 40, /* cells along the longest side, to begin with: the sun's own light */
    FIRST_SCATTERING =
        12, /* the same of the scattered light, which takes much longer: cells of a single cloud, */
    FEW_SCATTERING = 3,    /* of one among very many */
    ALL_SCATTERING = 4000, /* of all clouds together */
    FIRST_VOXELS = 150000, /* of all clouds together */
};

struct gl_refinement {
    pthread_t thread;
    gl_order order;
    shape_light light; /* a copy: the renderer's may change */
    gl_grids from;     /* what is taken over; held until the end */
    bool old_light;    /* the sun has moved since: what it makes of light is of no use */
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
    gl_grids_drop(&job->from);
    free(job);
    r->refinement = NULL;
}

/* One more user of grids. */
static gl_grids hold(const gl_grids *grids)
{
    if (grids->light)
        grids->light->uses++;
    if (grids->baked)
        grids->baked->uses++;
    return *grids;
}

static void start(shape_gl_renderer *r, const gl_order *order)
{
    gl_refinement *job = calloc(1, sizeof *job);
    if (!job)
        return; /* what is there already does */
    job->order = *order;
    job->light = r->light;
    job->order.light = &job->light;
    job->from = hold(&r->grids);
    job->order.light_from = job->from.light;
    job->order.baked_from = job->from.baked;
    if (pthread_create(&job->thread, NULL, work, job)) {
        gl_grids_drop(&job->from);
        free(job);
    } else {
        r->refinement = job;
    }
}

static void take_light(shape_gl_renderer *r, gl_light *light)
{
    if (r->options.method == SHAPE_GL_PAPER || r->options.method == SHAPE_GL_PAPER_NDT)
        gl_light_upload(light);
    r->costs.lit_clouds += (size_t)light->made;
    gl_light_drop(r->grids.light);
    r->grids.light = light;
}

static void take_baked(shape_gl_renderer *r, gl_baked *baked)
{
    gl_baked_upload(baked);
    r->costs.baked_clouds += (size_t)baked->made;
    gl_baked_drop(r->grids.baked);
    r->grids.baked = baked;
}

/* The grids that were shown so far stay, to be faded out. */
static void keep_last(shape_gl_renderer *r)
{
    gl_grids_drop(&r->last_grids);
    r->last_grids = hold(&r->grids);
    r->fade_left = GL_FADE_FRAMES;
}

/* Takes over what the thread has made, with what has come into sight meanwhile. */
static shape_status take(shape_gl_renderer *r, gl_refinement *job, int texture_limit, shape_error *error)
{
    shape_status status = SHAPE_OK;
    if (job->new_light && job->old_light) {
        gl_light_drop(job->new_light);
        job->new_light = NULL;
    }
    if (!job->new_light && !job->new_baked)
        return SHAPE_OK;
    if (job->new_light && r->grids.light)
        status = gl_light_add(job->new_light, r->grids.light, texture_limit, error);
    if (job->new_baked && r->grids.baked && !status)
        status = gl_baked_add(job->new_baked, r->grids.baked, texture_limit, error);
    if (status)
        return status;
    keep_last(r);
    if (job->new_light) {
        take_light(r, job->new_light);
        r->costs.light_ms = job->light_ms;
    }
    if (job->new_baked) {
        take_baked(r, job->new_baked);
        r->costs.bake_ms = job->bake_ms;
    }
    r->refined = true;
    job->new_light = NULL;
    job->new_baked = NULL;
    return SHAPE_OK;
}

static shape_status collect(shape_gl_renderer *r, int texture_limit, shape_error *error)
{
    gl_refinement *job = r->refinement;
    if (!job || !atomic_load(&job->done))
        return SHAPE_OK;
    shape_status status = job->status;
    if (status)
        *error = job->error;
    else
        status = take(r, job, texture_limit, error);
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
                      .all_clouds = r->options.light.opaque || gl_has_air(r),
                      .view = *view,
                      .bake_voxels = r->options.bake_voxels,
                      .texture_limit = largest};
}

/* Cells along the longest side of each cloud's first scattered light: the fewer the more clouds are to be lit. */
static int first_scattering(const shape_gl_renderer *r, const gl_order *order)
{
    int clouds = 0, cells = FIRST_SCATTERING;
    shape_camera camera = shape_view_camera(&order->view);
    for (size_t i = 0; i < r->volume->cloud_count; i++)
        clouds += !(order->light_from && order->light_from->lit[i]) &&
                  gl_in_sight(&r->volume->clouds[i], &camera, GL_MARGIN);
    while (cells > FEW_SCATTERING && clouds * cells * cells * cells > ALL_SCATTERING)
        cells--;
    return cells;
}

/* Something coarse, now, of what is wholly missing. */
static shape_status make_first(shape_gl_renderer *r, const gl_order *order, shape_error *error)
{
    gl_order first = *order;
    first.first = first.missing_only = true;
    if (first.light_options.resolution > FIRST_LIGHT)
        first.light_options.resolution = FIRST_LIGHT;
    first.scattering_cells = first_scattering(r, order);
    if (first.bake_voxels > FIRST_VOXELS)
        first.bake_voxels = FIRST_VOXELS;
    r->fade_left = 0;
    return make_now(r, &first, error);
}

static shape_status prepare_in_background(shape_gl_renderer *r, gl_order *order, shape_error *error)
{
    shape_status status = collect(r, order->texture_limit, error);
    if (status)
        return status;
    if (r->light_changed && r->refinement)
        r->refinement->old_light = true;
    order->lenient = true;
    order->light_from = r->light_changed ? NULL : r->grids.light;
    order->baked_from = r->grids.baked;
    gl_fit light = order->light_from ? gl_light_fit(r->grids.light, order) : GL_MISSING;
    gl_fit baked = r->grids.baked ? gl_baked_fit(r->grids.baked, order) : GL_MISSING;
    order->want_light = light == GL_MISSING;
    order->want_baked = baked == GL_MISSING;
    if (order->want_light || order->want_baked)
        status = make_first(r, order, error);
    if (status)
        return status;
    r->light_changed = false;
    order->want_light = light >= GL_FAR_TOO_FINE;
    order->want_baked = baked >= GL_FAR_TOO_FINE;
    if (!r->refinement && (order->want_light || order->want_baked))
        start(r, order);
    return SHAPE_OK;
}

/* All that the view needs, now; what comes of it does not depend on the views before. */
static shape_status prepare_now(shape_gl_renderer *r, gl_order *order, shape_error *error)
{
    order->light_from = r->light_changed ? NULL : r->grids.light;
    order->baked_from = r->grids.baked;
    order->want_light = !order->light_from || gl_light_fit(r->grids.light, order) != GL_FITS;
    order->want_baked = r->options.method == SHAPE_GL_DEFAULT &&
                        (!order->baked_from || gl_baked_fit(r->grids.baked, order) != GL_FITS);
    shape_status status = order->want_light || order->want_baked ? make_now(r, order, error) : SHAPE_OK;
    r->light_changed = r->light_changed && status;
    return status;
}

shape_status gl_refine(shape_gl_renderer *r, const shape_view *view, shape_error *error)
{
    gl_order order = whole_order(r, view);
    if (r->options.method == SHAPE_GL_DEFAULT && r->options.background)
        return prepare_in_background(r, &order, error);
    return prepare_now(r, &order, error);
}
