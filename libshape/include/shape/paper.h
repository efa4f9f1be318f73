/* The methods of 2018 on the CPU, for comparison only: Jiménez 2018 Algorithm 1 as printed, and the same with Algorithm
 * 2's sweep in the view. The mirror of shaders/view/paper.frag; docs/light.md says where they fail. */
#ifndef SHAPE_PAPER_H
#define SHAPE_PAPER_H

#include "shape/pathtrace.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shape_paper_options {
    bool
        sweep; /* Algorithm 2's sweep: each part of the ray once, by the sphere that it happens to be in; seams */
    bool lod;                /* the printed distance formula for the step, rather than 0.1 m */
    int resolution;          /* cells of the light grid along each side, 2 to 256; default 40 */
    int samples;             /* rays a pixel, 1 to 4096; default 1 */
    shape_progress progress; /* default none */
    void *progress_context;
} shape_paper_options;

shape_paper_options shape_paper_defaults(void);
shape_status shape_paper_check(const shape_paper_options *options, shape_error *error);

/* Renders: width * height RGB triples from the upper left, the same for any number of threads. Every cloud is taken as
 * a heap of pseudo-spheroids, but `uniform` ones; details and layers are not in the method. steps (may be NULL) gets
 * the mean number of steps a ray; cancelled may be NULL. Errors: the checks of view, light and options; memory. */
shape_status shape_paper_render(const shape_volume *volume, const shape_view *view, const shape_light *light,
                                const shape_paper_options *options, float *radiance, double *steps,
                                bool *cancelled, shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
