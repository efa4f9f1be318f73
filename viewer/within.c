/* A picture to an allowed error: drawn finer and finer, until twice as fine changes it by no more. */
#include <math.h>

#include "shape/budget.h"
#include "view.h"

/* From coarse to fine; each has about twice the last one's light cells and voxels a side. */
static const view_quality ladder[] = {
    {12, 250000, 4}, {24, 2000000, 8}, {48, 12000000, 32}, {96, 48000000, 64}};
enum { STEPS = sizeof ladder / sizeof *ladder };

static shape_status draw(const view_job *job, const view_quality *quality, const shape_view *view,
                         const shape_light *light, shape_gl_renderer **renderer, shape_error *error)
{
    shape_gl_options options = job->options;
    options.light.resolution = quality->light_cells;
    options.fixed_light = true; /* or what is half as fine may be no coarser */
    options.bake_voxels = quality->voxels;
    shape_status status = shape_gl_create(&options, renderer, error);
    if (status)
        return status;
    status = shape_gl_load(*renderer, job->volume, error);
    if (!status)
        status = shape_gl_light(*renderer, light, error);
    for (int i = 0; i < quality->samples && !status; i++) {
        status = shape_gl_draw(*renderer, view, i, error);
        shape_gl_finish();
    }
    if (status) {
        shape_gl_destroy(*renderer);
        *renderer = NULL;
    }
    return status;
}

shape_status view_draw_within(const view_job *job, const shape_view *view, const shape_light *light,
                              double allowed, shape_gl_renderer **renderer, view_quality *chosen,
                              double *change, shape_error *error)
{
    shape_image *last = NULL;
    shape_status status = SHAPE_OK;
    *renderer = NULL;
    *change = INFINITY;
    for (int step = 0; step < STEPS && !status && *change > allowed; step++) {
        shape_image *image = NULL;
        shape_gl_destroy(*renderer);
        *chosen = ladder[step];
        status = draw(job, chosen, view, light, renderer, error);
        if (!status)
            status = view_read_image(*renderer, view->width, view->height, false, &image, error);
        if (!status && last)
            status =
                shape_budget_change(last->pixels, image->pixels, image->width, image->height, change, error);
        shape_image_destroy(last);
        last = image;
    }
    shape_image_destroy(last);
    if (status) {
        shape_gl_destroy(*renderer);
        *renderer = NULL;
    }
    return status;
}
