/* Between the render*.c files only: the drawing thread's state. */
#ifndef NEPHELE_RENDER_PRIVATE_H
#define NEPHELE_RENDER_PRIVATE_H

#include <epoxy/gl.h>
#include <pthread.h>
#include <stdatomic.h>

#include "engine.h"
#include "render.h"
#include "shot.h"

enum { RENDER_TARGETS = 3 };

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
    GLuint textures[RENDER_TARGETS], framebuffers[RENDER_TARGETS];
    int sizes[RENDER_TARGETS][2], next_target;
    double volume_ms;
};

/* --- render_tell.c: what the thread and the window tell each other --- */

double render_now_ms(void);
/* What the thread is doing; "" where nothing. */
void render_say(view_renderer *r, const char *doing);
/* A line for the window; "" wipes it. */
void render_tell(view_renderer *r, const char *text, bool is_error);
bool render_has_wish(view_renderer *r);
/* Keeps the radiance of a picture that is done, for view_renderer_take_radiance. */
shape_status render_keep_radiance(view_renderer *r, shape_error *error);

/* --- render_draw.c: pictures of the wish that was taken --- */

/* Makes the wish's volumes. */
shape_status render_make_scenes(view_renderer *r, shape_error *error);
/* Whether two files are shown, so that the right half is drawn while the view moves, too. */
bool render_two_files(const view_renderer *r);
/* Whether the engines that a picture at rest needs are ready. */
bool render_is_full(const view_renderer *r);
/* Whether finer grids are still to come or to be faded in. */
bool render_is_pending(const view_renderer *r);
shape_status render_light_full(view_renderer *r, shape_error *error);
shape_status render_light_quick(view_renderer *r, shape_error *error);
/* A picture for the moment; right: of another file, or NULL. */
shape_status render_moving(view_renderer *r, view_engine *e, view_engine *right, shape_error *error);
/* After an edit that leaves most of what there is: the full engine is as quick as the other, and nothing turns coarse. */
shape_status render_edit(view_renderer *r, shape_error *error);
/* While finer grids are made: a look at what has come of them, as a picture for the moment. */
shape_status render_pending(view_renderer *r, shape_error *error);
/* One more sample of a picture at rest. */
shape_status render_sample(view_renderer *r, shape_error *error);
/* Tone-maps what the engines have drawn and hands it to the window. right: NULL, or for the right part of a split. */
void render_publish(view_renderer *r, const view_engine *left, const view_engine *right, int width,
                    int height, double ms);

/* --- render_shot.c: picture files --- */

void render_take_shot(view_renderer *r, const view_shot *s);

#endif
