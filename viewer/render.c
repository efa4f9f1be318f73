/* The drawing thread: a quick picture first (coarse light, coarse density, fewer pixels), the full one when the state
 * rests, sample by sample; new wishes are heard between any two steps. */
#include "render.h"

#include <epoxy/gl.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "render_private.h"

enum { REST_MS = 120, PATIENCE_MS = 150 };

static void drop_shown(view_shown *shown)
{
    view_shared_drop(shown->set);
    view_shared_drop(shown->other);
    view_things_drop(shown->things);
    memset(shown, 0, sizeof *shown);
}

/* --- what a new wish changes --- */

/* Whether what was drawn only has to be shown anew: by another exposure, as a map of heat. */
static bool same_picture(const view_request *was, const view_request *is)
{
    view_request other;
    memcpy(&other, was, sizeof other);
    other.number = is->number;
    other.state.exposure = is->state.exposure;
    other.state.heat = is->state.heat;
    other.state.difference = is->state.difference;
    other.state.boxes = is->state.boxes;
    other.state.outlines = is->state.outlines;
    other.state.samples = is->state.samples;
    other.state.generator = is->state.generator; /* makes another set in time */
    if (is->state.method == SHAPE_GL_DEFAULT && is->state.other_method == SHAPE_GL_DEFAULT)
        other.state.divider = is->state.divider; /* both halves are drawn whole */
    return !memcmp(&other, is, sizeof other);
}

static bool moves_in_time(const view_renderer *r, const view_state *s)
{
    return r->start.morph || shape_motion_is_on(&s->course.motion);
}

/* Takes a wish over; false where nothing can be drawn. */
static bool adopt(view_renderer *r, const view_request *wish, const view_shown *shown)
{
    view_state *was = &r->now.state;
    const view_state *is = &wish->state;
    bool other_time = was->time != is->time && moves_in_time(r, is);
    bool clouds = !r->scene || shown->set != r->shown.set || shown->other != r->shown.other ||
                  shown->things != r->shown.things || other_time || !view_state_same_clouds(was, is);
    bool light = clouds || !view_state_same_light(was, is);
    bool grid = was->light_grid != is->light_grid || was->method != is->method ||
                was->other_method != is->other_method || was->split != is->split;
    bool same = !clouds && r->drawn && r->full.lit && r->sample && same_picture(&r->now, wish);
    drop_shown(&r->shown);
    r->shown = *shown;
    if (is->difference && !was->difference)
        r->kept = 0;
    memcpy(&r->now, wish, sizeof *wish);
    if (same) {
        render_publish(r, &r->full, is->split ? &r->other : NULL, wish->width, wish->height,
                       r->picture.draw_ms);
        return true;
    }
    r->content++;
    r->sample = 0;
    r->changed = render_now_ms();
    r->drawn = false;
    r->stays = false;
    if (light)
        r->quick.lit = r->quick_other.lit = false;
    if (light || grid)
        r->full.lit = r->other.lit = false;
    shape_error error;
    if (!clouds)
        return r->scene != NULL;
    if (render_make_scenes(r, &error)) {
        render_tell(r, error.text, true);
        return r->scene != NULL;
    }
    render_tell(r, "", false);
    return true;
}

/* --- the thread --- */

static void sleep_until(view_renderer *r, double ms)
{
    struct timespec time;
    clock_gettime(CLOCK_REALTIME, &time);
    time.tv_sec += (time_t)(ms / 1e3);
    time.tv_nsec += (long)(fmod(ms, 1e3) * 1e6);
    if (time.tv_nsec >= 1000000000L) {
        time.tv_nsec -= 1000000000L;
        time.tv_sec++;
    }
    pthread_cond_timedwait(&r->asked, &r->mutex, &time);
}

/* Whether there is anything to do but wait for a wish. */
static bool is_idle(const view_renderer *r)
{
    if (!r->scene)
        return true;
    return r->drawn && render_is_full(r) && r->sample >= r->now.state.samples && !render_is_pending(r);
}

/* One step of work, short where it can be. */
static shape_status step(view_renderer *r, shape_error *error)
{
    const view_state *s = &r->now.state;
    bool full = render_is_full(r);
    bool rests = render_now_ms() - r->changed > REST_MS;
    shape_status status = SHAPE_OK;
    if (!r->drawn && (!full || !rests)) {
        if (r->stays)
            return render_edit(r, error);
        bool two = render_two_files(r), fine = r->full.lit && (!two || r->other.lit);
        if (!fine)
            status = render_light_quick(r, error);
        if (status)
            return status;
        return render_moving(r, fine ? &r->full : &r->quick,
                             two ? (fine ? &r->other : &r->quick_other) : NULL, error);
    }
    if (!rests)
        return SHAPE_OK;
    if (!full) {
        render_say(r, "light");
        status = render_light_full(r, error);
        return status || r->full.method != SHAPE_GL_DEFAULT ? status : render_pending(r, error);
    }
    if (render_is_pending(r))
        return render_pending(r, error);
    render_say(r, "drawing");
    return r->sample < s->samples ? render_sample(r, error) : SHAPE_OK;
}

static void tell_lost(view_renderer *r)
{
    pthread_mutex_lock(&r->mutex);
    r->picture.lost = true;
    pthread_mutex_unlock(&r->mutex);
    r->start.wake();
}

/* What has been broken off: for a newer wish, or for good. */
static void tell_broken_off(view_renderer *r)
{
    pthread_mutex_lock(&r->mutex);
    bool for_good = r->broken_off;
    pthread_mutex_unlock(&r->mutex);
    if (for_good)
        render_tell(r, "light and density were broken off (change anything to begin again)", true);
}

static void *render_thread(void *context)
{
    view_renderer *r = context;
    view_request *wish = malloc(sizeof *wish);
    view_shot *wanted = malloc(sizeof *wanted);
    shape_error error;
    bool broken = false;
    r->start.make_current(r->start.context, true);
    for (bool stop = !wish || !wanted; !stop;) {
        bool done = r->scene && r->full.lit && !broken && is_idle(r);
        if (done && r->now.state.difference && r->kept != r->content && render_keep_radiance(r, &error))
            render_tell(r, error.text, true);
        pthread_mutex_lock(&r->mutex);
        bool idle = is_idle(r) || broken;
        if (idle && !r->fresh && !r->shoot && !r->stop) {
            r->picture.done = true;
            r->picture.doing = "";
            r->start.wake();
            while (!r->fresh && !r->shoot && !r->stop)
                pthread_cond_wait(&r->asked, &r->mutex);
        }
        if (!r->fresh && !r->stop && !r->shoot && r->drawn && render_now_ms() - r->changed <= REST_MS)
            sleep_until(r, REST_MS - (render_now_ms() - r->changed) + 1);
        stop = r->stop;
        bool fresh = r->fresh, shoot = r->shoot;
        view_shown shown = {0};
        if (fresh) {
            memcpy(wish, &r->wish, sizeof *wish);
            shown = r->wished;
            memset(&r->wished, 0, sizeof r->wished);
            r->sets[0] = shown.set;
            r->sets[1] = shown.other;
            r->broken_off = false;
            atomic_store(&r->hurry, r->stop);
            atomic_store(&r->newer, false);
            r->picked = render_now_ms();
        }
        if (shoot) {
            memcpy(wanted, &r->wish_shot, sizeof *wanted);
            r->wish_shot.scene = NULL;
        }
        r->fresh = r->shoot = false;
        pthread_mutex_unlock(&r->mutex);
        if (stop) {
            drop_shown(&shown);
            if (shoot)
                free(wanted->scene);
            break;
        }
        if (fresh)
            broken = !adopt(r, wish, &shown);
        if (shoot && r->scene)
            render_take_shot(r, wanted);
        if (shoot)
            free(wanted->scene);
        if (!broken && !is_idle(r) && step(r, &error)) {
            if (error.status == SHAPE_ERROR_STOPPED)
                tell_broken_off(r);
            else
                render_tell(r, error.text, true);
            broken = true; /* until the next wish */
        }
        if (shape_gl_is_lost()) {
            tell_lost(r);
            break;
        }
    }
    free(wish);
    free(wanted);
    view_engine_free(&r->quick);
    view_engine_free(&r->quick_other);
    view_engine_free(&r->full);
    view_engine_free(&r->other);
    glDeleteTextures(RENDER_TARGETS, r->textures);
    glDeleteFramebuffers(RENDER_TARGETS, r->framebuffers);
    r->start.make_current(r->start.context, false);
    return NULL;
}

/* Another set breaks off what has taken long already: else an option that is dragged, of which each moment makes a set, would
 * never show anything. */
static bool hurries(void *context)
{
    view_renderer *r = context;
    return atomic_load(&r->hurry) || (atomic_load(&r->newer) && render_now_ms() - r->picked > PATIENCE_MS);
}

view_renderer *view_renderer_start(const view_render_start *start, shape_error *error)
{
    view_renderer *r = calloc(1, sizeof *r);
    if (!r) {
        shape_error_memory(error);
        return NULL;
    }
    r->start = *start;
    r->start.options.stop = (shape_stop){hurries, r};
    r->picture.doing = "";
    r->picture.shot_done = -1;
    r->quick.quick = r->quick_other.quick = true;
    pthread_mutex_init(&r->mutex, NULL);
    pthread_cond_init(&r->asked, NULL);
    int failed = pthread_create(&r->thread, NULL, render_thread, r);
    if (!failed)
        return r;
    shape_error_set(error, SHAPE_ERROR_SYSTEM, "no thread: %s", strerror(failed));
    free(r);
    return NULL;
}

void view_renderer_stop(view_renderer *r)
{
    if (!r)
        return;
    pthread_mutex_lock(&r->mutex);
    r->stop = true;
    atomic_store(&r->hurry, true);
    pthread_cond_signal(&r->asked);
    pthread_mutex_unlock(&r->mutex);
    pthread_join(r->thread, NULL);
    drop_shown(&r->wished);
    free(r->wish_shot.scene);
    free(r->radiance);
    drop_shown(&r->shown);
    view_shared_drop(r->picture.placed);
    view_scene_drop(r->scene);
    view_scene_drop(r->other_scene);
    pthread_cond_destroy(&r->asked);
    pthread_mutex_destroy(&r->mutex);
    free(r);
}

void view_renderer_ask(view_renderer *r, const view_request *request, const view_shown *shown)
{
    pthread_mutex_lock(&r->mutex);
    drop_shown(&r->wished);
    r->wished.set = view_shared_keep(shown->set);
    r->wished.other = view_shared_keep(shown->other);
    r->wished.things = view_things_keep(shown->things);
    memcpy(&r->wish, request, sizeof *request);
    r->fresh = true;
    r->picture.done = false;
    if (shown->set != r->sets[0] || shown->other != r->sets[1])
        atomic_store(&r->newer, true);
    pthread_cond_signal(&r->asked);
    pthread_mutex_unlock(&r->mutex);
}

void view_renderer_break_off(view_renderer *r)
{
    pthread_mutex_lock(&r->mutex);
    r->broken_off = true;
    atomic_store(&r->hurry, true);
    pthread_mutex_unlock(&r->mutex);
}

void view_renderer_look(view_renderer *r, view_picture *picture)
{
    pthread_mutex_lock(&r->mutex);
    *picture = r->picture;
    view_shared_keep(picture->placed);
    pthread_mutex_unlock(&r->mutex);
}
