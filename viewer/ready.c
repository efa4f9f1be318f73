/* Clouds and first grids on a thread of their own. */
#include "ready.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

struct view_ready {
    pthread_t thread;
    view_job *job;
    shape_view view;
    shape_light light;
    shape_gl_first *first;
    shape_status status;
    shape_error error;
};

static void *work(void *context)
{
    view_ready *r = context;
    double start = view_now_ms();
    r->status = view_job_place(r->job, r->job->time, &r->error);
    r->job->load_ms += view_now_ms() - start;
    if (!r->status)
        r->status =
            shape_gl_first_make(&r->job->options, r->job->volume, &r->light, &r->view, &r->first, &r->error);
    return NULL;
}

shape_status view_ready_start(view_job *job, const shape_view *view, const shape_light *light,
                              view_ready **made, shape_error *error)
{
    view_ready *r = calloc(1, sizeof *r);
    if (!r)
        return shape_error_memory(error);
    r->job = job;
    r->view = *view;
    r->light = *light;
    int failed = pthread_create(&r->thread, NULL, work, r);
    if (failed) {
        free(r);
        return shape_error_set(error, SHAPE_ERROR_SYSTEM, "no thread: %s", strerror(failed));
    }
    *made = r;
    return SHAPE_OK;
}

shape_status view_ready_end(view_ready *r, shape_gl_first **first, shape_error *error)
{
    pthread_join(r->thread, NULL);
    shape_status status = r->status;
    if (status)
        *error = r->error;
    *first = r->first;
    free(r);
    return status;
}
