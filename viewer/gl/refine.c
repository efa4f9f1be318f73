/* Light and baked density made while pictures go on: something coarse at once, then on a thread of its own as fine as the
 * view needs, and again when the view has changed so much that it needs others. Only clouds in sight, and of these only
 * those that need it. */
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "gl_private.h"

enum {
    SLICE = 4 << 20, /* bytes of voxels that are sent to the GPU with a picture */
    NICE = 5         /* of the thread: pictures go first */
};

struct gl_refinement {
    pthread_t thread;
    gl_order order;
    shape_light light; /* a copy: the renderer's may change */
    gl_grids from;     /* what is taken over; held until the end */
    bool old_light;    /* the sun has moved since: what it makes of light is of no use */
    gl_light *earlier; /* the same; NULL: none */
    atomic_bool done, stop;
    gl_grids made;
    double ms[2]; /* that its light and density took */
    shape_status status;
    shape_error error;
};

static void *work(void *data)
{
    gl_refinement *job = data;
    (void)setpriority(PRIO_PROCESS, 0, NICE); /* of this thread, and of those that OpenMP makes for it */
    job->status = gl_order_make(&job->order, &job->made, job->ms, &job->error);
    atomic_store(&job->done, true);
    return NULL;
}

static bool is_stopped(void *job)
{
    return atomic_load(&((gl_refinement *)job)->stop);
}

/* Waits for the thread and throws away what it still has. */
static void end_job(shape_gl_renderer *r)
{
    gl_refinement *job = r->refinement;
    if (!job)
        return;
    pthread_join(job->thread, NULL);
    gl_grids_drop(&job->made);
    gl_grids_drop(&job->from);
    gl_light_drop(job->earlier);
    free(job);
    r->refinement = NULL;
}

void gl_refine_stop(shape_gl_renderer *r)
{
    if (r->refinement)
        atomic_store(&r->refinement->stop, true);
    end_job(r);
    gl_grids_drop(&r->coming);
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
    job->order.stop = (shape_stop){is_stopped, job};
    if (r->earlier) {
        job->earlier = r->earlier; /* it has done what it was kept for */
        r->earlier = NULL;
    }
    job->order.dense_from = job->earlier;
    if (pthread_create(&job->thread, NULL, work, job)) {
        gl_grids_drop(&job->from);
        gl_light_drop(job->earlier);
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
    r->costs.baked_clouds += (size_t)baked->made;
    gl_baked_drop(r->grids.baked);
    r->grids.baked = baked;
}

/* Sends a slice of a set to the GPU: finds places for it, among those that are shown. *all: nothing is left. */
static shape_status send(shape_gl_renderer *r, gl_baked *baked, size_t most, int texture_limit, bool *all,
                         shape_error *error)
{
    const gl_baked *const sets[] = {r->grids.baked, r->last_grids.baked, r->coming.baked, baked};
    gl_pool_keep(&r->pool, sets, 4);
    shape_status status = gl_pool_place(&r->pool, baked, texture_limit, error);
    if (!status)
        *all = gl_pool_send(&r->pool, baked, most, &r->costs.baked_bytes);
    baked->texture = r->pool.texture;
    return status;
}

/* The grids that were shown so far stay, to be faded out. */
static void keep_last(shape_gl_renderer *r)
{
    gl_grids_drop(&r->last_grids);
    r->last_grids = hold(&r->grids);
    r->fade_left = GL_FADE_FRAMES;
}

/* Of what comes, and of what is there already for clouds that have come into sight meanwhile. */
static shape_status join(gl_grids *coming, const gl_grids *there, int texture_limit, shape_error *error)
{
    gl_light *light = NULL;
    gl_baked *baked = NULL;
    shape_status status = SHAPE_OK;
    if (coming->light && there->light)
        status = gl_light_join(coming->light, there->light, texture_limit, &light, error);
    if (coming->baked && there->baked && !status)
        status = gl_baked_join(coming->baked, there->baked, &baked, error);
    if (light) {
        gl_light_drop(coming->light);
        coming->light = light;
    }
    if (baked) {
        baked->texture = coming->baked->texture;
        gl_baked_drop(coming->baked);
        coming->baked = baked;
    }
    return status;
}

/* Brings what a thread has made into use: first its voxels are sent, slice by slice, then it is faded in, unless something
 * else still is. */
static shape_status bring(shape_gl_renderer *r, int texture_limit, shape_error *error)
{
    gl_grids *coming = &r->coming;
    bool all = true;
    shape_status status =
        coming->baked ? send(r, coming->baked, SLICE, texture_limit, &all, error) : SHAPE_OK;
    if (status || !all || r->fade_left > 0 || r->early)
        return status;
    status = join(coming, &r->grids, texture_limit, error);
    if (status)
        return status;
    keep_last(r);
    if (coming->light) {
        take_light(r, coming->light);
        r->costs.light_ms = r->coming_ms[0];
    }
    if (coming->baked) {
        take_baked(r, coming->baked);
        r->costs.bake_ms = r->coming_ms[1];
    }
    coming->light = NULL;
    coming->baked = NULL;
    r->refined = true;
    return SHAPE_OK;
}

/* What the thread has made, if it is done. */
static shape_status collect(shape_gl_renderer *r, shape_error *error)
{
    gl_refinement *job = r->refinement;
    if (!job || !atomic_load(&job->done))
        return SHAPE_OK;
    shape_status status = job->status;
    if (status) {
        *error = job->error;
    } else {
        if (!job->old_light) {
            r->coming.light = job->made.light;
            job->made.light = NULL;
        }
        r->coming.baked = job->made.baked;
        job->made.baked = NULL;
        memcpy(r->coming_ms, job->ms, sizeof r->coming_ms);
    }
    end_job(r);
    return status;
}

static shape_status make_now(shape_gl_renderer *r, const gl_order *order, shape_error *error)
{
    gl_grids made = {0};
    double ms[2] = {r->costs.light_ms, r->costs.bake_ms};
    shape_status status = SHAPE_OK;
    if (!order->first || !gl_first_use(r, order, &made, ms))
        status = gl_order_make(order, &made, ms, error);
    if (status) {
        gl_grids_drop(&made);
        return status;
    }
    r->costs.light_ms = ms[0];
    r->costs.bake_ms = ms[1];
    if (made.light)
        take_light(r, made.light);
    if (made.baked) {
        bool all;
        if (!r->options.background) /* places do not depend on what was there before */
            gl_pool_free(&r->pool);
        take_baked(r, made.baked);
        r->unsent = r->early && !r->early_drawn; /* the very first picture needs none */
        if (!r->unsent)
            status = send(r, made.baked, SIZE_MAX, order->texture_limit, &all, error);
    }
    return status;
}

shape_status gl_refine_send(shape_gl_renderer *r, shape_error *error)
{
    GLint largest = 256;
    bool all;
    glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &largest);
    const bool unsent = r->unsent;
    r->unsent = false;
    if (!unsent || !r->grids.baked)
        return SHAPE_OK;
    return send(r, r->grids.baked, SIZE_MAX, largest, &all, error);
}

static gl_order whole_order(const shape_gl_renderer *r, const shape_view *view)
{
    GLint largest = 256;
    glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &largest);
    shape_lightgrid_options light_options = r->options.light;
    light_options.scattering = light_options.scattering && gl_law(r) == SHAPE_GL_LAW_GRID;
    return (gl_order){.volume = r->volume,
                      .light = &r->light,
                      .paper = r->options.method == SHAPE_GL_PAPER || r->options.method == SHAPE_GL_PAPER_NDT,
                      .light_options = light_options,
                      .light_pixels = r->options.fixed_light ? gl_largest_side(r->volume, view) : 0,
                      .all_clouds = r->options.light.opaque || gl_has_air(r),
                      .view = *view,
                      .bake_voxels = r->options.bake_voxels,
                      .stop = r->options.stop,
                      .texture_limit = largest};
}

/* What fades out gets what has just come into sight, too: a sight of it is better than none. */
static shape_status extend_last(shape_gl_renderer *r, int texture_limit, shape_error *error)
{
    shape_status status = SHAPE_OK;
    if (r->fade_left > 0)
        status = join(&r->last_grids, &r->grids, texture_limit, error);
    if (!status && r->fade_left > 0 && r->last_grids.baked)
        r->last_grids.baked->texture = r->pool.texture;
    return status;
}

/* Something coarse, now, of what is wholly missing. */
static shape_status make_first(shape_gl_renderer *r, const gl_order *order, shape_error *error)
{
    gl_order first = *order;
    gl_order_first(&first);
    if (!order->light_from)
        r->fade_left = 0; /* all light is new, as the sun is */
    shape_status status = make_now(r, &first, error);
    return status ? status : extend_last(r, order->texture_limit, error);
}

/* The sun has moved: the densities of the light's cells stay true, for the light that is to come. */
static void keep_densities(shape_gl_renderer *r)
{
    if (!r->grids.light || r->earlier)
        return;
    r->earlier = r->grids.light;
    r->earlier->uses++;
}

static shape_status prepare_in_background(shape_gl_renderer *r, gl_order *order, shape_error *error)
{
    shape_status status = collect(r, error);
    if (!status && r->update.pending)
        status = gl_update_do(r, order, error);
    if (status)
        return status;
    if (r->light_changed) {
        keep_densities(r);
        if (r->refinement)
            r->refinement->old_light = true;
        gl_light_drop(r->coming.light);
        r->coming.light = NULL;
    }
    if (!status && (r->coming.light || r->coming.baked))
        status = bring(r, order->texture_limit, error);
    if (status)
        return status;
    order->lenient = true;
    order->light_from = r->light_changed ? NULL : r->grids.light;
    order->dense_from = r->grids.light;
    order->baked_from = r->grids.baked;
    gl_fit light = order->light_from ? gl_light_fit(r->grids.light, order, 1) : GL_MISSING;
    gl_fit baked = r->grids.baked ? gl_baked_fit(r->grids.baked, order, 1) : GL_MISSING;
    order->want_light = light == GL_MISSING;
    order->want_baked = baked == GL_MISSING;
    if (order->want_light || order->want_baked)
        status = make_first(r, order, error);
    if (status)
        return status;
    r->light_changed = false;
    if (r->refinement || r->coming.light || r->coming.baked)
        return SHAPE_OK;
    /* What is about to come into sight is made before it does. */
    order->want_light =
        light >= GL_FAR_TOO_FINE || gl_light_fit(r->grids.light, order, GL_MARGIN) == GL_MISSING;
    order->want_baked =
        baked >= GL_FAR_TOO_FINE || gl_baked_fit(r->grids.baked, order, GL_MARGIN) == GL_MISSING;
    if (order->want_light || order->want_baked)
        start(r, order);
    return SHAPE_OK;
}

/* All that the view needs, now; what comes of it does not depend on the views before. */
static shape_status prepare_now(shape_gl_renderer *r, gl_order *order, shape_error *error)
{
    order->light_from = r->light_changed ? NULL : r->grids.light;
    order->baked_from = r->grids.baked;
    order->want_light = !order->light_from || gl_light_fit(r->grids.light, order, 1) != GL_FITS;
    order->want_baked = r->options.method == SHAPE_GL_DEFAULT &&
                        (!order->baked_from || gl_baked_fit(r->grids.baked, order, 1) != GL_FITS);
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
