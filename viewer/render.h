/* render.c: the thread that draws. It has an OpenGL context of its own, which shares textures with the window's, so that
 * the window answers at once whatever a picture takes. */
#ifndef NEPHELE_VIEW_RENDER_H
#define NEPHELE_VIEW_RENDER_H

#include "shape_gl.h"
#include "state.h"
#include "things.h"

/* A set that several threads look at; it goes with the last of them. */
typedef struct view_shared view_shared;
/* Takes the set over. NULL where memory is out (the set is destroyed). */
view_shared *view_shared_make(shape_set *set);
view_shared *view_shared_keep(view_shared *shared); /* NULL is allowed */
void view_shared_drop(view_shared *shared);         /* NULL is allowed */
const shape_set *view_shared_set(const view_shared *shared);

typedef struct view_renderer view_renderer;

/* What is to be seen. */
typedef struct view_request {
    view_state state;
    int width, height; /* pixels of the window */
    uint64_t number;   /* the caller's */
} view_request;

/* What there is to show. */
typedef struct view_picture {
    unsigned texture; /* tone-mapped; 0: nothing yet */
    int width, height;
    int samples;          /* drawn so far, of the state's */
    bool done;            /* nothing is left to do */
    bool lost;            /* the context is gone, and the renderer with it: it is to be stopped */
    const char *doing;    /* what the thread is at: static text */
    double shot_done;     /* share of a picture file that is done; below 0: none is being made */
    shape_gl_costs costs; /* of the picture's renderer */
    double draw_ms, volume_ms;
    uint64_t number;  /* grows with each picture */
    uint64_t request; /* the number of the request that it shows */
    uint64_t content; /* grows where what is to be drawn is another, and not only how it is shown */
    char text[512];   /* what went wrong, or what was written; empty */
    bool text_is_error;
    view_shared *placed; /* the set as it is seen; the caller drops it. NULL: nothing yet */
} view_picture;

typedef struct view_render_start {
    shape_gl_options options; /* method and light's resolution come from the state */
    const shape_morph *morph; /* lives longer than the renderer; NULL */
    void (*make_current)(void *context, bool current);
    void *context;
    void (*wake)(void); /* called from the thread when there is something new */
    int largest;        /* side of what is drawn at once, of screenshots; 0: what the GPU can */
} view_render_start;

view_renderer *view_renderer_start(const view_render_start *start, shape_error *error);
void view_renderer_stop(view_renderer *renderer); /* NULL is allowed */
/* What is shown. */
typedef struct view_shown {
    view_shared *set, *other; /* other: the file of the right half, or NULL for the same in both */
    view_things *things;      /* what is opaque in both; NULL */
} view_shown;

/* Asks for a picture; the newest wish counts. What is shown is kept. */
void view_renderer_ask(view_renderer *renderer, const view_request *request, const view_shown *shown);
/* Asks for a picture file besides: width x height, of all samples. `comment` and `scene` (NULL: none; taken over, by free)
 * are kept in the file. */
void view_renderer_shoot(view_renderer *renderer, const char *path, int width, int height, bool alpha,
                         const char *comment, char *scene);
/* Breaks off the picture file that is being made, if one is. */
void view_renderer_cancel(view_renderer *renderer);
/* Breaks off the light and density that the present wish waits for; the next wish begins them again. (A set that is not the
 * one of the wish before, and the end, break them off by themselves.) */
void view_renderer_break_off(view_renderer *renderer);
/* Where the state asks for the difference and the picture of that content is done: its radiance in the smaller size of
 * reference.h, which the caller frees. NULL else. Once a content. */
float *view_renderer_take_radiance(view_renderer *renderer, uint64_t content);
/* What there is to show now. */
void view_renderer_look(view_renderer *renderer, view_picture *picture);

#endif
