/* reference.c: how far the picture is from the reference, which is traced meanwhile on threads that give way to all
 * others, in a smaller size, finer and finer. Needs no OpenGL. */
#ifndef NEPHELE_VIEW_REFERENCE_H
#define NEPHELE_VIEW_REFERENCE_H

#include "render.h"
#include "shape/opaque.h"

enum { VIEW_REFERENCE_PIXELS = 16384, VIEW_REFERENCE_PATHS = 4096 }; /* at most; the second a pixel */

typedef struct view_reference view_reference;

/* What is to be compared. */
typedef struct view_reference_job {
    view_shared *placed; /* kept */
    view_things *things; /* kept; NULL */
    shape_view view;     /* of the smaller size, from view_reference_view */
    shape_light light;
    uint64_t seed, number; /* number: the caller's */
    float *
        radiance; /* of the picture, view.width * view.height RGB triples from the upper left; taken over, by free */
} view_reference_job;

/* What is known so far. */
typedef struct view_difference {
    uint64_t number;   /* of the job */
    uint64_t version;  /* grows with each pass */
    int width, height; /* 0: nothing yet */
    int paths;         /* a pixel */
    double off; /* square root of the picture's relMSE to the reference, without the reference's own noise */
    double noise;   /* the same of the reference's noise */
    char text[256]; /* what went wrong; empty */
} view_difference;

/* How many pixels each way of a picture become one, so that no more than VIEW_REFERENCE_PIXELS are left. */
int view_reference_scale(int width, int height);
/* The view of the smaller picture: the middle of the large one, whole pixels. */
shape_view view_reference_view(const shape_view *view);
/* The means of scale x scale pixels of rgba, as shape_gl_read gives it, for that view. The caller frees it; NULL where
 * memory is out. */
float *view_reference_reduce(const float *rgba, int width, int height);

/* wake is called from the thread when there is more to show. NULL and *error: threads or memory are out. */
view_reference *view_reference_start(void (*wake)(void), shape_error *error);
void view_reference_stop(view_reference *reference); /* NULL is allowed */
/* Begins another comparison; what was under way ends soon. */
void view_reference_ask(view_reference *reference, const view_reference_job *job);
void view_reference_cancel(view_reference *reference);
/* Copies what is known. rgba, of VIEW_REFERENCE_PIXELS * 4 bytes, gets the map from the upper left where its version is
 * another than difference->version: black where the picture is as bright as the reference, red to yellow where it is
 * brighter by more than a standard error, blue to cyan where darker, full at 30 % of the picture and 0.02. Returns whether
 * it did. */
bool view_reference_look(view_reference *reference, view_difference *difference, unsigned char *rgba);

#endif
