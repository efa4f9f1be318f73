/* The difference from the reference, in the window: when it is begun and given up, and its map as a texture. */
#include <epoxy/gl.h>
#include <stdio.h>
#include <stdlib.h>

#include "window_private.h"

static void ask(window_state *w, float *radiance)
{
    const view_picture *p = &w->picture;
    shape_view view = view_state_view(&w->asked, w->asked_size[0], w->asked_size[1]);
    const view_reference_job job = {.placed = w->placed,
                                    .things = w->things,
                                    .view = view_reference_view(&view),
                                    .light = view_state_light(&w->asked),
                                    .seed = w->job->seed,
                                    .number = p->content,
                                    .radiance = radiance};
    view_reference_ask(w->reference, &job);
    w->compared = p->content;
}

/* Gives up what is not wanted any more, begins what is. */
static void decide(window_state *w)
{
    const view_picture *p = &w->picture;
    bool wanted = w->state.difference;
    if (w->compared && (!wanted || p->content != w->compared)) {
        view_reference_cancel(w->reference);
        w->compared = 0;
    }
    if (!wanted || w->compared || !p->done || p->request != w->asks || !w->placed)
        return;
    shape_error error;
    if (!w->reference)
        w->reference = view_reference_start(w->wake, &error);
    if (!w->reference) {
        w->state.difference = false;
        window_say(w, error.text);
        return;
    }
    float *radiance = view_renderer_take_radiance(w->renderer, p->content);
    if (radiance)
        ask(w, radiance);
}

static void upload(window_state *w, const unsigned char *rgba)
{
    const view_difference *d = &w->difference;
    if (!w->map)
        glGenTextures(1, &w->map);
    glBindTexture(GL_TEXTURE_2D, w->map);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, d->width, d->height, 0, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
}

void window_compare(window_state *w)
{
    static unsigned char rgba[VIEW_REFERENCE_PIXELS * 4]; /* one window, one thread */
    decide(w);
    if (w->reference && view_reference_look(w->reference, &w->difference, rgba) && w->difference.width)
        upload(w, rgba);
}

void window_describe_difference(const window_state *w, char *text, size_t room)
{
    const view_difference *d = &w->difference;
    text[0] = 0;
    if (!w->state.difference)
        return;
    if (d->text[0])
        snprintf(text, room, "reference: %s", d->text);
    else if (!w->compared)
        snprintf(text, room, "reference: waits for the picture");
    else if (!d->width)
        snprintf(text, room, "reference: first paths");
    else
        snprintf(text, room,
                 "reference: %d of %d paths a pixel, noise %.1f %%; the picture is off by %.1f %%", d->paths,
                 VIEW_REFERENCE_PATHS, 100 * d->noise, 100 * d->off);
}

void window_stop_comparing(window_state *w)
{
    view_reference_stop(w->reference);
    w->reference = NULL;
    w->compared = 0;
    w->difference.width = 0;
    if (w->map) /* else there may be no context */
        glDeleteTextures(1, &w->map);
    w->map = 0;
}
