/* Picture files of the drawing thread: asked for, drawn between two pictures, broken off. */
#include <stdio.h>
#include <stdlib.h>

#include "render_private.h"

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

void render_take_shot(view_renderer *r, const view_shot *s)
{
    shape_error error;
    char text[512];
    shape_gl_options options = r->start.options;
    options.light.opaque = view_things_get(r->shown.things);
    options.stop = (shape_stop){shot_ends, r};
    render_say(r, "screenshot");
    shape_status status =
        view_shot_take(s, &r->now.state, r->scene->volume, &options, shot_goes_on, r, &error);
    tell_shot(r, -1);
    if (status)
        snprintf(text, sizeof text, "screenshot: %.480s", error.text);
    else
        snprintf(text, sizeof text, "wrote %.480s", s->path);
    render_tell(r, text, status != SHAPE_OK);
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
