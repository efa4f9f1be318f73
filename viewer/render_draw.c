/* What the drawing thread draws: a picture for the moment while the view moves, then samples of the whole one. */
#include <epoxy/gl.h>
#include <math.h>
#include <time.h>

#include "render_private.h"

enum { BUDGET_MS = 50 };

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

void render_publish(view_renderer *r, const view_engine *left, const view_engine *right, int width,
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
    r->next_target = (r->next_target + 1) % RENDER_TARGETS;
    r->start.wake();
}

/* The scene of the right half: another file, or the same. */
static view_scene *right_scene(const view_renderer *r)
{
    return r->other_scene ? r->other_scene : r->scene;
}

bool render_two_files(const view_renderer *r)
{
    return r->now.state.split && r->other_scene;
}

shape_status render_light_full(view_renderer *r, shape_error *error)
{
    const view_state *s = &r->now.state;
    shape_status status =
        view_engine_light(&r->full, &r->start.options, s, s->method, r->scene, r->shown.things, error);
    if (!status && s->split)
        status = view_engine_light(&r->other, &r->start.options, s, s->other_method, right_scene(r),
                                   r->shown.things, error);
    return status;
}

shape_status render_light_quick(view_renderer *r, shape_error *error)
{
    const view_state *s = &r->now.state;
    shape_status status = view_engine_light(&r->quick, &r->start.options, s, SHAPE_GL_DEFAULT, r->scene,
                                            r->shown.things, error);
    if (!status && render_two_files(r))
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

/* A sample of one side of the picture, from x0 to x1. The slow methods draw it band by band and give up for a new wish,
 * which begins another picture. */
static shape_status draw_side(view_renderer *r, view_engine *e, int x0, int x1, shape_error *error)
{
    enum { BANDS = 12 };
    int height = r->now.height, width = r->now.width;
    if (e->method == SHAPE_GL_DEFAULT)
        return draw_engine(r, e, width, height, r->sample, error);
    double start = render_now_ms();
    shape_status status = SHAPE_OK;
    glEnable(GL_SCISSOR_TEST);
    for (int band = 0; band < BANDS && !status && !render_has_wish(r); band++) {
        int low = height * band / BANDS, high = height * (band + 1) / BANDS;
        glScissor(x0, low, x1 - x0, high - low);
        status = draw_engine(r, e, width, height, r->sample, error);
    }
    glDisable(GL_SCISSOR_TEST);
    e->pixel_ms = (render_now_ms() - start) / fmax((double)(x1 - x0) * height, 1);
    return status;
}

shape_status render_moving(view_renderer *r, view_engine *e, view_engine *right, shape_error *error)
{
    int by = coarseness(r, e, right), width = (r->now.width + by - 1) / by,
        height = (r->now.height + by - 1) / by;
    double start = render_now_ms();
    shape_status status = draw_engine(r, e, width, height, -1, error);
    double ms = render_now_ms() - start;
    if (!status && right)
        status = draw_engine(r, right, width, height, -1, error);
    r->sample = 0;
    if (!status)
        render_publish(r, e, right, width, height, ms);
    r->drawn = true;
    return status;
}

shape_status render_edit(view_renderer *r, shape_error *error)
{
    double pixel_ms = r->full.pixel_ms;
    r->stays = false;
    shape_status status = render_light_full(r, error);
    if (!status)
        status = render_moving(r, &r->full, NULL, error);
    r->full.pixel_ms = pixel_ms; /* this picture waited for the edit, and tells nothing */
    return status;
}

bool render_is_full(const view_renderer *r)
{
    return r->full.lit && (!r->now.state.split || r->other.lit);
}

bool render_is_pending(const view_renderer *r)
{
    return shape_gl_pending(r->full.gl) || (r->now.state.split && shape_gl_pending(r->other.gl));
}

shape_status render_pending(view_renderer *r, shape_error *error)
{
    const struct timespec pause = {0, 20000000};
    bool split = r->now.state.split;
    double start = render_now_ms();
    nanosleep(&pause, NULL);
    shape_status status = draw_engine(r, &r->full, r->now.width, r->now.height, -1, error);
    double ms = render_now_ms() - start - 20;
    split = split && r->other.method == SHAPE_GL_DEFAULT; /* the slow ones wait for their turn */
    if (!status && split)
        status = draw_engine(r, &r->other, r->now.width, r->now.height, -1, error);
    if (!status)
        render_publish(r, &r->full, split ? &r->other : NULL, r->now.width, r->now.height, ms);
    r->sample = 0;
    r->drawn = true;
    return status;
}

shape_status render_sample(view_renderer *r, shape_error *error)
{
    bool split = r->now.state.split;
    double start = render_now_ms();
    int width = r->now.width, line = split ? (int)((float)width * r->now.state.divider) : width;
    shape_status status = draw_side(r, &r->full, 0, line, error);
    double ms = render_now_ms() - start;
    if (!status && split)
        status = draw_side(r, &r->other, line, width, error);
    if (!status && render_has_wish(r))
        return SHAPE_OK; /* perhaps not all of it has been drawn */
    r->sample++;
    r->drawn = true;
    if (shape_gl_refined(r->full.gl) || (split && shape_gl_refined(r->other.gl)))
        r->sample = 0; /* the mean would be of two pictures */
    if (!status)
        render_publish(r, &r->full, split ? &r->other : NULL, r->now.width, r->now.height, ms);
    return status;
}

shape_status render_make_scenes(view_renderer *r, shape_error *error)
{
    double start = render_now_ms();
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
    r->volume_ms = render_now_ms() - start;
    return SHAPE_OK;
}
