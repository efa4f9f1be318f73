/* The drawing thread: a quick picture first (coarse light, coarse density, fewer pixels), the full one when the state
 * rests, sample by sample; new wishes are heard between any two steps. */
#include "render.h"

#include <epoxy/gl.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "engine.h"
#include "reference.h"
#include "shot.h"

enum { TARGETS = 3, REST_MS = 120, BUDGET_MS = 50, PATIENCE_MS = 150 };

struct view_renderer {
    view_render_start start;
    pthread_t thread;
    pthread_mutex_t mutex;
    pthread_cond_t asked;
    /* Under the mutex. */
    bool stop, fresh, shoot, cancelled; /* cancelled: the picture file */
    bool broken_off;                    /* light and density that a picture waits for */
    const view_shared *sets[2];         /* of the wish that is being drawn, only to be compared */
    atomic_bool hurry;                  /* what is being made is not wanted any more */
    atomic_bool newer;                  /* another set waits */
    double picked;                      /* when the present wish was taken [ms] */
    view_request wish;
    view_shown wished;
    view_shot wish_shot;
    view_picture picture;
    float *radiance; /* of the picture that is done, see view_renderer_take_radiance; NULL */
    uint64_t radiance_of;
    /* The thread's own. */
    view_request now;
    view_shown shown;
    view_scene *scene, *other_scene;
    view_engine quick, full, other; /* other: the right half */
    view_engine quick_other;        /* of another file */
    int sample;                     /* the next to draw */
    double changed;
    uint64_t content;
    uint64_t kept; /* the content whose radiance was kept last */
    bool drawn;    /* this wish has been shown in some way */
    bool stays;    /* an edit, of which the full engine makes only what has changed */
    GLuint textures[TARGETS], framebuffers[TARGETS];
    int sizes[TARGETS][2], next_target;
    double volume_ms;
};

static double now_ms(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

static void say(view_renderer *r, const char *doing)
{
    pthread_mutex_lock(&r->mutex);
    r->picture.doing = doing;
    r->picture.done = !doing[0];
    pthread_mutex_unlock(&r->mutex);
    r->start.wake();
}

static void tell(view_renderer *r, const char *text, bool is_error)
{
    pthread_mutex_lock(&r->mutex);
    snprintf(r->picture.text, sizeof r->picture.text, "%s", text);
    r->picture.text_is_error = is_error;
    pthread_mutex_unlock(&r->mutex);
    r->start.wake();
}

/* Makes the next target that is not shown, of a size, and binds it. */
static void bind_target(view_renderer *r, int width, int height)
{
    int i = r->next_target;
    if (!r->textures[i]) {
        glGenTextures(1, &r->textures[i]);
        glGenFramebuffers(1, &r->framebuffers[i]);
    }
    if (r->sizes[i][0] != width || r->sizes[i][1] != height) {
        glBindTexture(GL_TEXTURE_2D, r->textures[i]);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, NULL);
        glBindFramebuffer(GL_FRAMEBUFFER, r->framebuffers[i]);
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, r->textures[i], 0);
        r->sizes[i][0] = width;
        r->sizes[i][1] = height;
    }
    glBindFramebuffer(GL_FRAMEBUFFER, r->framebuffers[i]);
}

/* Tone-maps what the engines have drawn and hands it to the window. right: NULL, or for the right part of a split. */
static void publish(view_renderer *r, const view_engine *left, const view_engine *right, int width,
                    int height, double ms)
{
    bind_target(r, width, height);
    view_engine_show(left, &r->now.state, width, height);
    if (right) {
        int x = (int)((float)width * r->now.state.divider);
        glEnable(GL_SCISSOR_TEST);
        glScissor(x, 0, width - x, height);
        view_engine_show(right, &r->now.state, width, height);
        glDisable(GL_SCISSOR_TEST);
    }
    glFinish(); /* the other context must find it whole */
    pthread_mutex_lock(&r->mutex);
    view_picture *p = &r->picture;
    p->texture = r->textures[r->next_target];
    p->width = width;
    p->height = height;
    p->samples = r->sample;
    p->costs = shape_gl_get_costs(left->gl);
    p->draw_ms = ms;
    p->volume_ms = r->volume_ms;
    p->number++;
    p->request = r->now.number;
    p->content = r->content;
    if (p->placed != r->scene->placed) {
        view_shared_drop(p->placed);
        p->placed = view_shared_keep(r->scene->placed);
    }
    pthread_mutex_unlock(&r->mutex);
    r->next_target = (r->next_target + 1) % TARGETS;
    r->start.wake();
}

static void drop_shown(view_shown *shown)
{
    view_shared_drop(shown->set);
    view_shared_drop(shown->other);
    view_things_drop(shown->things);
    memset(shown, 0, sizeof *shown);
}

/* The scene of the right half: another file, or the same. */
static view_scene *right_scene(const view_renderer *r)
{
    return r->other_scene ? r->other_scene : r->scene;
}

/* Whether two files are shown, so that the right half is drawn while the view moves, too. */
static bool two_files(const view_renderer *r)
{
    return r->now.state.split && r->other_scene;
}

static shape_status light_full(view_renderer *r, shape_error *error)
{
    const view_state *s = &r->now.state;
    shape_status status =
        view_engine_light(&r->full, &r->start.options, s, s->method, r->scene, r->shown.things, error);
    if (!status && s->split)
        status = view_engine_light(&r->other, &r->start.options, s, s->other_method, right_scene(r),
                                   r->shown.things, error);
    return status;
}

static shape_status light_quick(view_renderer *r, shape_error *error)
{
    const view_state *s = &r->now.state;
    shape_status status = view_engine_light(&r->quick, &r->start.options, s, SHAPE_GL_DEFAULT, r->scene,
                                            r->shown.things, error);
    if (!status && two_files(r))
        status = view_engine_light(&r->quick_other, &r->start.options, s, SHAPE_GL_DEFAULT, r->other_scene,
                                   r->shown.things, error);
    return status;
}

/* How many pixels each way are drawn as one while the view moves, so that a picture takes no longer than the budget. */
static int coarseness(const view_renderer *r, const view_engine *e, const view_engine *other)
{
    double pixels = (double)r->now.width * (double)r->now.height;
    double pixel_ms = e->pixel_ms + (other ? other->pixel_ms : 0);
    int by = (int)ceil(sqrt(pixels * pixel_ms / BUDGET_MS)), most = e->method == SHAPE_GL_DEFAULT ? 3 : 6;
    return by < 1 ? 1 : by > most ? most : by;
}

static shape_status draw_engine(view_renderer *r, view_engine *e, int width, int height, int sample,
                                shape_error *error)
{
    return view_engine_draw(e, &r->now.state, width, height, sample, error);
}

static bool has_wish(view_renderer *r)
{
    pthread_mutex_lock(&r->mutex);
    bool has = r->fresh || r->stop;
    pthread_mutex_unlock(&r->mutex);
    return has;
}

/* A sample of one side of the picture, from x0 to x1. The slow methods draw it band by band and give up for a new wish,
 * which begins another picture. */
static shape_status draw_side(view_renderer *r, view_engine *e, int x0, int x1, shape_error *error)
{
    enum { BANDS = 12 };
    int height = r->now.height, width = r->now.width;
    if (e->method == SHAPE_GL_DEFAULT)
        return draw_engine(r, e, width, height, r->sample, error);
    double start = now_ms();
    shape_status status = SHAPE_OK;
    glEnable(GL_SCISSOR_TEST);
    for (int band = 0; band < BANDS && !status && !has_wish(r); band++) {
        int low = height * band / BANDS, high = height * (band + 1) / BANDS;
        glScissor(x0, low, x1 - x0, high - low);
        status = draw_engine(r, e, width, height, r->sample, error);
    }
    glDisable(GL_SCISSOR_TEST);
    e->pixel_ms = (now_ms() - start) / fmax((double)(x1 - x0) * height, 1);
    return status;
}

/* A picture for the moment; right: of another file, or NULL. */
static shape_status draw_moving(view_renderer *r, view_engine *e, view_engine *right, shape_error *error)
{
    int by = coarseness(r, e, right), width = (r->now.width + by - 1) / by,
        height = (r->now.height + by - 1) / by;
    double start = now_ms();
    shape_status status = draw_engine(r, e, width, height, -1, error);
    double ms = now_ms() - start;
    if (!status && right)
        status = draw_engine(r, right, width, height, -1, error);
    r->sample = 0;
    if (!status)
        publish(r, e, right, width, height, ms);
    r->drawn = true;
    return status;
}

/* After an edit that leaves most of what there is: the full engine is as quick as the other, and nothing turns coarse. */
static shape_status draw_edit(view_renderer *r, shape_error *error)
{
    double pixel_ms = r->full.pixel_ms;
    r->stays = false;
    shape_status status = light_full(r, error);
    if (!status)
        status = draw_moving(r, &r->full, NULL, error);
    r->full.pixel_ms = pixel_ms; /* this picture waited for the edit, and tells nothing */
    return status;
}

/* Whether the engines that a picture at rest needs are ready. */
static bool is_full(const view_renderer *r)
{
    return r->full.lit && (!r->now.state.split || r->other.lit);
}

/* Whether finer grids are still to come or to be faded in. */
static bool is_pending(const view_renderer *r)
{
    return shape_gl_pending(r->full.gl) || (r->now.state.split && shape_gl_pending(r->other.gl));
}

/* While finer grids are made: a look at what has come of them, as a picture for the moment. */
static shape_status draw_pending(view_renderer *r, shape_error *error)
{
    const struct timespec pause = {0, 20000000};
    bool split = r->now.state.split;
    double start = now_ms();
    nanosleep(&pause, NULL);
    shape_status status = draw_engine(r, &r->full, r->now.width, r->now.height, -1, error);
    double ms = now_ms() - start - 20;
    split = split && r->other.method == SHAPE_GL_DEFAULT; /* the slow ones wait for their turn */
    if (!status && split)
        status = draw_engine(r, &r->other, r->now.width, r->now.height, -1, error);
    if (!status)
        publish(r, &r->full, split ? &r->other : NULL, r->now.width, r->now.height, ms);
    r->sample = 0;
    r->drawn = true;
    return status;
}

static shape_status draw_sample(view_renderer *r, shape_error *error)
{
    bool split = r->now.state.split;
    double start = now_ms();
    int width = r->now.width, line = split ? (int)((float)width * r->now.state.divider) : width;
    shape_status status = draw_side(r, &r->full, 0, line, error);
    double ms = now_ms() - start;
    if (!status && split)
        status = draw_side(r, &r->other, line, width, error);
    if (!status && has_wish(r))
        return SHAPE_OK; /* perhaps not all of it has been drawn */
    r->sample++;
    r->drawn = true;
    if (shape_gl_refined(r->full.gl) || (split && shape_gl_refined(r->other.gl)))
        r->sample = 0; /* the mean would be of two pictures */
    if (!status)
        publish(r, &r->full, split ? &r->other : NULL, r->now.width, r->now.height, ms);
    return status;
}

static shape_status make_scenes(view_renderer *r, shape_error *error)
{
    double start = now_ms();
    view_scene *next = NULL, *other = NULL;
    shape_status status =
        view_scene_make(&r->now.state, r->shown.set, true, r->start.morph, r->scene, &next, error);
    if (!status && r->shown.other)
        status = view_scene_make(&r->now.state, r->shown.other, false, NULL, r->other_scene, &other, error);
    if (status) {
        view_scene_drop(next);
        return status;
    }
    view_scene_drop(r->scene);
    view_scene_drop(r->other_scene);
    r->scene = next;
    r->other_scene = other;
    r->stays = r->full.gl && r->full.scene && !r->now.state.split &&
               r->full.method == (int)r->now.state.method && shape_gl_stays(r->full.gl, next->volume);
    r->volume_ms = now_ms() - start;
    return SHAPE_OK;
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
        publish(r, &r->full, is->split ? &r->other : NULL, wish->width, wish->height, r->picture.draw_ms);
        return true;
    }
    r->content++;
    r->sample = 0;
    r->changed = now_ms();
    r->drawn = false;
    r->stays = false;
    if (light)
        r->quick.lit = r->quick_other.lit = false;
    if (light || grid)
        r->full.lit = r->other.lit = false;
    shape_error error;
    if (!clouds)
        return r->scene != NULL;
    if (make_scenes(r, &error)) {
        tell(r, error.text, true);
        return r->scene != NULL;
    }
    tell(r, "", false);
    return true;
}

static void tell_shot(view_renderer *r, double done)
{
    pthread_mutex_lock(&r->mutex);
    r->picture.shot_done = r->cancelled ? -1 : done; /* nobody waits for one that is broken off */
    pthread_mutex_unlock(&r->mutex);
    r->start.wake();
}

/* After each part and sample of a picture file. */
static bool shot_goes_on(void *context, double done)
{
    view_renderer *r = context;
    tell_shot(r, done);
    pthread_mutex_lock(&r->mutex);
    bool on = !r->cancelled && !r->stop;
    pthread_mutex_unlock(&r->mutex);
    return on;
}

static bool shot_ends(void *context)
{
    view_renderer *r = context;
    pthread_mutex_lock(&r->mutex);
    bool ends = r->cancelled || r->stop;
    pthread_mutex_unlock(&r->mutex);
    return ends;
}

static void take_shot(view_renderer *r, const view_shot *s)
{
    shape_error error;
    char text[512];
    shape_gl_options options = r->start.options;
    options.light.opaque = view_things_get(r->shown.things);
    options.stop = (shape_stop){shot_ends, r};
    say(r, "screenshot");
    shape_status status =
        view_shot_take(s, &r->now.state, r->scene->volume, &options, shot_goes_on, r, &error);
    tell_shot(r, -1);
    if (status)
        snprintf(text, sizeof text, "screenshot: %.480s", error.text);
    else
        snprintf(text, sizeof text, "wrote %.480s", s->path);
    tell(r, text, status != SHAPE_OK);
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
    return r->drawn && is_full(r) && r->sample >= r->now.state.samples && !is_pending(r);
}

/* One step of work, short where it can be. */
static shape_status step(view_renderer *r, shape_error *error)
{
    const view_state *s = &r->now.state;
    bool full = is_full(r);
    bool rests = now_ms() - r->changed > REST_MS;
    shape_status status = SHAPE_OK;
    if (!r->drawn && (!full || !rests)) {
        if (r->stays)
            return draw_edit(r, error);
        bool two = two_files(r), fine = r->full.lit && (!two || r->other.lit);
        if (!fine)
            status = light_quick(r, error);
        if (status)
            return status;
        return draw_moving(r, fine ? &r->full : &r->quick, two ? (fine ? &r->other : &r->quick_other) : NULL,
                           error);
    }
    if (!rests)
        return SHAPE_OK;
    if (!full) {
        say(r, "light");
        status = light_full(r, error);
        return status || r->full.method != SHAPE_GL_DEFAULT ? status : draw_pending(r, error);
    }
    if (is_pending(r))
        return draw_pending(r, error);
    say(r, "drawing");
    return r->sample < s->samples ? draw_sample(r, error) : SHAPE_OK;
}

/* Keeps the radiance of a picture that is done. */
static shape_status keep_radiance(view_renderer *r, shape_error *error)
{
    int width = r->now.width, height = r->now.height;
    float *rgba = malloc((size_t)width * (size_t)height * 4 * sizeof *rgba);
    r->kept = r->content; /* one try */
    if (!rgba)
        return shape_error_memory(error);
    shape_status status = shape_gl_read(r->full.gl, rgba, error);
    float *small = status ? NULL : view_reference_reduce(rgba, width, height);
    free(rgba);
    if (!small)
        return status ? status : shape_error_memory(error);
    pthread_mutex_lock(&r->mutex);
    free(r->radiance);
    r->radiance = small;
    r->radiance_of = r->content;
    pthread_mutex_unlock(&r->mutex);
    r->start.wake();
    return SHAPE_OK;
}

float *view_renderer_take_radiance(view_renderer *r, uint64_t content)
{
    float *taken = NULL;
    pthread_mutex_lock(&r->mutex);
    if (r->radiance && r->radiance_of == content) {
        taken = r->radiance;
        r->radiance = NULL;
    }
    pthread_mutex_unlock(&r->mutex);
    return taken;
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
        tell(r, "light and density were broken off (change anything to begin again)", true);
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
        if (done && r->now.state.difference && r->kept != r->content && keep_radiance(r, &error))
            tell(r, error.text, true);
        pthread_mutex_lock(&r->mutex);
        bool idle = is_idle(r) || broken;
        if (idle && !r->fresh && !r->shoot && !r->stop) {
            r->picture.done = true;
            r->picture.doing = "";
            r->start.wake();
            while (!r->fresh && !r->shoot && !r->stop)
                pthread_cond_wait(&r->asked, &r->mutex);
        }
        if (!r->fresh && !r->stop && !r->shoot && r->drawn && now_ms() - r->changed <= REST_MS)
            sleep_until(r, REST_MS - (now_ms() - r->changed) + 1);
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
            r->picked = now_ms();
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
            take_shot(r, wanted);
        if (shoot)
            free(wanted->scene);
        if (!broken && !is_idle(r) && step(r, &error)) {
            if (error.status == SHAPE_ERROR_STOPPED)
                tell_broken_off(r);
            else
                tell(r, error.text, true);
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
    glDeleteTextures(TARGETS, r->textures);
    glDeleteFramebuffers(TARGETS, r->framebuffers);
    r->start.make_current(r->start.context, false);
    return NULL;
}

/* Another set breaks off what has taken long already: else an option that is dragged, of which each moment makes a set, would
 * never show anything. */
static bool hurries(void *context)
{
    view_renderer *r = context;
    return atomic_load(&r->hurry) || (atomic_load(&r->newer) && now_ms() - r->picked > PATIENCE_MS);
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

void view_renderer_cancel(view_renderer *r)
{
    pthread_mutex_lock(&r->mutex);
    r->cancelled = true;
    r->shoot = false; /* it may not have begun */
    r->picture.shot_done = -1;
    pthread_mutex_unlock(&r->mutex);
}

void view_renderer_shoot(view_renderer *r, const char *path, int width, int height, bool alpha,
                         const char *comment, char *scene)
{
    pthread_mutex_lock(&r->mutex);
    free(r->wish_shot.scene);
    r->wish_shot.scene = scene;
    r->cancelled = false;
    r->picture.shot_done = 0;
    snprintf(r->wish_shot.path, sizeof r->wish_shot.path, "%s", path);
    snprintf(r->wish_shot.comment, sizeof r->wish_shot.comment, "%s", comment);
    r->wish_shot.width = width;
    r->wish_shot.height = height;
    r->wish_shot.alpha = alpha;
    r->wish_shot.largest = r->start.largest;
    r->shoot = true;
    r->picture.done = false;
    pthread_cond_signal(&r->asked);
    pthread_mutex_unlock(&r->mutex);
}

void view_renderer_look(view_renderer *r, view_picture *picture)
{
    pthread_mutex_lock(&r->mutex);
    *picture = r->picture;
    view_shared_keep(picture->placed);
    pthread_mutex_unlock(&r->mutex);
}
