/* The picture beside the reference: passes of a few paths a pixel, each seeded by its number, whose mean becomes finer
 * until somebody wants another. */
#include "reference.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "shape/pathtrace.h"

enum { PATHS_A_PASS = 4, NICE = 15 };
static const double pi = 3.14159265358979323846;

struct view_reference {
    pthread_t thread;
    pthread_mutex_t mutex;
    pthread_cond_t asked;
    void (*wake)(void);
    atomic_bool cancel; /* what is under way is not wanted any more */
    /* Under the mutex. */
    bool stop, fresh;
    view_reference_job next;
    view_difference known;
    unsigned char map[VIEW_REFERENCE_PIXELS * 4];
};

/* --- sizes --- */

int view_reference_scale(int width, int height)
{
    int by = 1;
    while ((long)(width / by) * (long)(height / by) > VIEW_REFERENCE_PIXELS && by < width && by < height)
        by++;
    return by;
}

shape_view view_reference_view(const shape_view *view)
{
    shape_view small = *view;
    int by = view_reference_scale(view->width, view->height);
    small.width = view->width / by;
    small.height = view->height / by;
    double half = tan(view->fov * pi / 360) * small.height * by / view->height;
    small.fov = atan(fmin(half, 1e6)) * 360 / pi;
    return small;
}

float *view_reference_reduce(const float *rgba, int width, int height)
{
    int by = view_reference_scale(width, height);
    int across = width / by, down = height / by;
    int left = (width - across * by) / 2, top = (height - down * by) / 2;
    float *small = malloc((size_t)across * (size_t)down * 3 * sizeof *small), *to = small;
    for (int y = 0; small && y < down; y++)
        for (int x = 0; x < across; x++, to += 3) {
            double sum[3] = {0};
            for (int j = 0; j < by; j++)
                for (int i = 0; i < by; i++) {
                    size_t row = (size_t)(top + y * by + j) * (size_t)width;
                    const float *from = rgba + 4 * (row + (size_t)(left + x * by + i));
                    for (int c = 0; c < 3; c++)
                        sum[c] += (double)from[c];
                }
            for (int c = 0; c < 3; c++)
                to[c] = (float)(sum[c] / ((double)by * by));
        }
    return small;
}

/* --- one comparison --- */

/* Sums over all passes. */
typedef struct comparison {
    const view_reference_job *job;
    size_t count;              /* pixels */
    double *sum, *variance;    /* of each channel: of radiance times paths; of the sum */
    float *radiance, *scatter; /* of a pass: means, and the variances of these */
    int paths;
} comparison;

static shape_status open_comparison(comparison *c, const view_reference_job *job, shape_error *error)
{
    memset(c, 0, sizeof *c);
    c->job = job;
    c->count = (size_t)job->view.width * (size_t)job->view.height;
    c->sum = calloc(3 * c->count, sizeof *c->sum);
    c->variance = calloc(3 * c->count, sizeof *c->variance);
    c->radiance = malloc(3 * c->count * sizeof *c->radiance);
    c->scatter = malloc(3 * c->count * sizeof *c->scatter);
    return c->sum && c->variance && c->radiance && c->scatter ? SHAPE_OK : shape_error_memory(error);
}

static void close_comparison(comparison *c)
{
    free(c->sum);
    free(c->variance);
    free(c->radiance);
    free(c->scatter);
}

static void add_pass(comparison *c, int paths)
{
    for (size_t i = 0; i < 3 * c->count; i++) {
        c->sum[i] += paths * (double)c->radiance[i];
        c->variance[i] += (double)paths * paths * (double)c->scatter[i];
    }
    c->paths += paths;
}

/* The relMSE of shape/imageerror.h, but relative to the picture, which has no noise: by a noisy reference it would be too
 * large at first. What the noise adds to the difference is taken off. */
static void measure(const comparison *c, view_difference *d)
{
    double off = 0, noise = 0, paths = c->paths;
    for (size_t i = 0; i < 3 * c->count; i++) {
        double right = c->sum[i] / paths, shown = (double)c->job->radiance[i];
        double weight = 1 / (shown * shown + 0.01);
        off += (shown - right) * (shown - right) * weight;
        noise += c->variance[i] / (paths * paths) * weight;
    }
    off /= 3 * (double)c->count, noise /= 3 * (double)c->count;
    d->off = sqrt(fmax(off - noise, 0));
    d->noise = sqrt(noise);
    d->paths = c->paths;
}

static double luminance(double r, double g, double b)
{
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

static unsigned char byte_of(double v)
{
    return (unsigned char)(255 * fmin(fmax(v, 0), 1) + 0.5);
}

static void paint(const comparison *c, unsigned char *map)
{
    const double full = 0.3;
    for (size_t i = 0; i < c->count; i++, map += 4) {
        const double *s = c->sum + 3 * i;
        const float *p = c->job->radiance + 3 * i;
        double right = luminance(s[0], s[1], s[2]) / c->paths;
        double shown = luminance((double)p[0], (double)p[1], (double)p[2]);
        double v[3], apart = shown - right;
        for (int k = 0; k < 3; k++)
            v[k] = sqrt(c->variance[3 * i + (size_t)k]);
        double noise = luminance(v[0], v[1], v[2]) / c->paths; /* channels of a path rise and fall together */
        double heat = copysign(fmax(fabs(apart) - noise, 0), apart) / (shown + 0.02) / full;
        map[0] = byte_of(2 * heat);
        map[1] = byte_of(2 * fabs(heat) - 1);
        map[2] = byte_of(-2 * heat);
        map[3] = 255;
    }
}

static void publish(view_reference *r, const comparison *c, const char *text)
{
    pthread_mutex_lock(&r->mutex);
    if (atomic_load(&r->cancel)) {
        pthread_mutex_unlock(&r->mutex);
        return;
    }
    view_difference *d = &r->known;
    d->number = c->job->number;
    d->version++;
    snprintf(d->text, sizeof d->text, "%s", text);
    if (!text[0]) {
        d->width = c->job->view.width;
        d->height = c->job->view.height;
        measure(c, d);
        paint(c, r->map);
    }
    pthread_mutex_unlock(&r->mutex);
    r->wake();
}

static bool goes_on(void *context, double done)
{
    (void)done;
    view_reference *r = context;
    return !atomic_load(&r->cancel);
}

static shape_status trace(view_reference *r, comparison *c, const shape_tracer *tracer, shape_error *error)
{
    shape_pathtrace_options options = shape_pathtrace_defaults();
    options.samples = PATHS_A_PASS;
    options.opaque = view_things_get(c->job->things);
    options.progress = goes_on;
    options.progress_context = r;
    for (uint64_t pass = 0; c->paths < VIEW_REFERENCE_PATHS; pass++) {
        shape_pathtrace_result result;
        options.seed = c->job->seed + pass;
        shape_status status = shape_pathtrace_render(tracer, &c->job->view, &c->job->light, &options,
                                                     c->radiance, c->scatter, &result, error);
        if (status || result.cancelled || atomic_load(&r->cancel))
            return status;
        add_pass(c, PATHS_A_PASS);
        publish(r, c, "");
    }
    return SHAPE_OK;
}

static void compare(view_reference *r, const view_reference_job *job)
{
    comparison c;
    shape_error error;
    shape_volume *volume = NULL;
    shape_tracer *tracer = NULL;
    shape_status status = open_comparison(&c, job, &error);
    if (!status)
        status = shape_volume_create(view_shared_set(job->placed), &volume, &error);
    if (!status)
        status = shape_tracer_create(volume, &tracer, &error);
    if (!status)
        status = trace(r, &c, tracer, &error);
    if (status)
        publish(r, &c, error.text);
    shape_tracer_destroy(tracer);
    shape_volume_destroy(volume);
    close_comparison(&c);
}

/* --- the thread --- */

static void free_job(view_reference_job *job)
{
    view_shared_drop(job->placed);
    view_things_drop(job->things);
    free(job->radiance);
    memset(job, 0, sizeof *job);
}

static void *reference_thread(void *context)
{
    view_reference *r = context;
    /* Of this thread and those that it makes (Linux); where it fails, it is only less polite. */
    (void)setpriority(PRIO_PROCESS, 0, NICE);
    pthread_mutex_lock(&r->mutex);
    while (!r->stop) {
        if (!r->fresh) {
            pthread_cond_wait(&r->asked, &r->mutex);
            continue;
        }
        view_reference_job job = r->next;
        memset(&r->next, 0, sizeof r->next);
        r->fresh = false;
        atomic_store(&r->cancel, false);
        pthread_mutex_unlock(&r->mutex);
        compare(r, &job);
        free_job(&job);
        pthread_mutex_lock(&r->mutex);
    }
    pthread_mutex_unlock(&r->mutex);
    return NULL;
}

view_reference *view_reference_start(void (*wake)(void), shape_error *error)
{
    view_reference *r = calloc(1, sizeof *r);
    if (!r) {
        shape_error_memory(error);
        return NULL;
    }
    r->wake = wake;
    pthread_mutex_init(&r->mutex, NULL);
    pthread_cond_init(&r->asked, NULL);
    int failed = pthread_create(&r->thread, NULL, reference_thread, r);
    if (!failed)
        return r;
    shape_error_set(error, SHAPE_ERROR_SYSTEM, "no thread: %s", strerror(failed));
    free(r);
    return NULL;
}

/* The mutex is held. */
static void give_up(view_reference *r)
{
    free_job(&r->next);
    r->fresh = false;
    atomic_store(&r->cancel, true);
    r->known.width = r->known.height = 0;
    r->known.text[0] = 0;
    r->known.version++;
}

void view_reference_stop(view_reference *r)
{
    if (!r)
        return;
    pthread_mutex_lock(&r->mutex);
    give_up(r);
    r->stop = true;
    pthread_cond_signal(&r->asked);
    pthread_mutex_unlock(&r->mutex);
    pthread_join(r->thread, NULL);
    pthread_cond_destroy(&r->asked);
    pthread_mutex_destroy(&r->mutex);
    free(r);
}

void view_reference_ask(view_reference *r, const view_reference_job *job)
{
    pthread_mutex_lock(&r->mutex);
    give_up(r);
    r->next = *job;
    view_shared_keep(r->next.placed);
    view_things_keep(r->next.things);
    r->fresh = true;
    pthread_cond_signal(&r->asked);
    pthread_mutex_unlock(&r->mutex);
}

void view_reference_cancel(view_reference *r)
{
    pthread_mutex_lock(&r->mutex);
    give_up(r);
    pthread_mutex_unlock(&r->mutex);
}

bool view_reference_look(view_reference *r, view_difference *difference, unsigned char *rgba)
{
    pthread_mutex_lock(&r->mutex);
    bool other = difference->version != r->known.version;
    *difference = r->known;
    if (other)
        memcpy(rgba, r->map, (size_t)r->known.width * (size_t)r->known.height * 4);
    pthread_mutex_unlock(&r->mutex);
    return other;
}
