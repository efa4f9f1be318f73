/* What the drawing thread and the window tell each other: lines, wishes, the radiance of a picture that is done. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "reference.h"
#include "render_private.h"

double render_now_ms(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

void render_say(view_renderer *r, const char *doing)
{
    pthread_mutex_lock(&r->mutex);
    r->picture.doing = doing;
    r->picture.done = !doing[0];
    pthread_mutex_unlock(&r->mutex);
    r->start.wake();
}

void render_tell(view_renderer *r, const char *text, bool is_error)
{
    pthread_mutex_lock(&r->mutex);
    snprintf(r->picture.text, sizeof r->picture.text, "%s", text);
    r->picture.text_is_error = is_error;
    pthread_mutex_unlock(&r->mutex);
    r->start.wake();
}

bool render_has_wish(view_renderer *r)
{
    pthread_mutex_lock(&r->mutex);
    bool has = r->fresh || r->stop;
    pthread_mutex_unlock(&r->mutex);
    return has;
}

/* Keeps the radiance of a picture that is done. */
shape_status render_keep_radiance(view_renderer *r, shape_error *error)
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
