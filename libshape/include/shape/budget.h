/* No more than a picture needs: which clouds of a set can be seen, and the settings of the march, or the voxels of a volume,
 * that keep a picture's error within what is allowed (docs/error.md). */
#ifndef SHAPE_BUDGET_H
#define SHAPE_BUDGET_H

#include "shape/march.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How far a picture is from another: the square root of the relMSE (shape/imageerror.h) between width * height RGB triples.
 * This is the E of every --error. Errors: those of shape_imageerror_measure. */
shape_status shape_budget_change(const float *picture, const float *reference, int width, int height,
                                 double *change, shape_error *error);

/* What of a cloud a view can show. */
typedef enum shape_budget_sight {
    SHAPE_BUDGET_SEEN,
    SHAPE_BUDGET_EMPTY,   /* no primitives */
    SHAPE_BUDGET_OUTSIDE, /* no pixel's ray meets its box */
    SHAPE_BUDGET_BEHIND,  /* every ray that does has met something opaque before */
    SHAPE_BUDGET_TINY     /* smaller than a pixel, and with the others of its kind too little to be missed */
} shape_budget_sight;

/* Finds for each cloud what the view can show of it, in sights (one a cloud). Rays go through the pixels' middles, as they
 * do with one sample a pixel, and for more samples half a pixel further round. error: as below; clouds below a pixel go as
 * long as all of them, were they white or black before the sky, use up no more than a tenth of its square. opaque may be
 * NULL. */
void shape_budget_sights(const shape_volume *volume, const shape_view *view, const shape_light *light,
                         const shape_opaque *opaque, double error, shape_budget_sight *sights);

/* What was chosen for a view. */
typedef struct shape_budget_choice {
    double step;   /* between samples [m] */
    int steps;     /* the same as steps along the longest side of what is seen */
    int cells;     /* of light grids, along a cloud's longest side, at most */
    double pixels; /* octaves whose cells are smaller than so many pixels were left out; 0: none were */
    int octaves, octaves_of; /* the most that any seen cloud kept, and the most that any has */
    size_t seen, clouds;
    double predicted; /* the error expected; above what was allowed where nothing finer is on offer */
    /* One a cloud; shape_budget_free frees them. */
    shape_budget_sight *sights;
    int *resolutions;      /* for shape_march_options */
    int *cloud_octaves;    /* of its noise, evaluated; the others as their mean */
    shape_march_work work; /* done to find this */
} shape_budget_choice;

/* Chooses steps, light cells and octaves so that the marched picture is within `allowed` (1e-4 to 1) of the same march with all
 * octaves, ever more steps and light grids of 48 cells, the default, at the least cost. What such a grid itself misses of the
 * reference is not in it. It looks at a few hundred of the picture's rays: with ever
 * more steps, until they no longer change, and with small light grids, whose changes tell how large one will do. options give
 * rule and whatever else is not chosen; their light must be SHAPE_MARCH_GRID and their steps fixed. The result is the same
 * for any number of threads. The caller frees *choice by shape_budget_free, also after an error. Errors: the checks of view,
 * light and options, memory, SHAPE_ERROR_ARGUMENT for another light or stepping. */
shape_status shape_budget_march(const shape_volume *volume, const shape_view *view, const shape_light *light,
                                const shape_march_options *options, double allowed,
                                shape_budget_choice *choice, shape_error *error);
void shape_budget_free(shape_budget_choice *choice);

/* Puts a choice into effect: octaves into the volume (once), the rest into options, which then point into *choice. */
void shape_budget_apply(const shape_budget_choice *choice, shape_volume *volume,
                        shape_march_options *options);

/* The largest voxel [m] of a fog volume whose picture, marched, is within `allowed` of that of the density itself, and the
 * error predicted for it. Voxels are tried from the view's footprint on: eight pixels at the nearest cloud, then ever half
 * as large. *seen: whether the view shows any cloud; if not, nothing else is set. Errors as above. */
shape_status shape_budget_voxel(const shape_volume *volume, const shape_view *view, const shape_light *light,
                                double allowed, double *edge, double *predicted, bool *seen,
                                shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
