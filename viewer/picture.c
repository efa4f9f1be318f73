/* Pictures without a window: the clouds of a moment, and what was drawn as bytes. */
#include <stdlib.h>
#include <string.h>

#include "view.h"

void view_job_free(view_job *job)
{
    shape_volume_destroy(job->volume);
    shape_set_destroy(job->moved);
    job->volume = NULL;
    job->moved = NULL;
}

shape_status view_job_place(view_job *job, double time, shape_error *error)
{
    view_job_free(job);
    shape_status status = view_course_set(&job->course, job->set, job->morph, time, &job->moved, error);
    return status ? status : shape_volume_create(job->moved, &job->volume, error);
}

shape_status view_read_image(shape_gl_renderer *renderer, int width, int height, bool alpha,
                             shape_image **image, shape_error *error)
{
    size_t pixels = (size_t)width * (size_t)height;
    float *rgba = malloc(pixels * 4 * sizeof *rgba);
    if (!rgba)
        return shape_error_memory(error);
    shape_status status = shape_gl_read(renderer, rgba, error);
    shape_image *made = status ? NULL : shape_image_create(width, height, error);
    if (!status && !made)
        status = error->status;
    if (!status && alpha)
        status = shape_image_add_alpha(made, error);
    for (size_t i = 0; !status && i < pixels; i++) {
        memcpy(made->pixels + 3 * i, rgba + 4 * i, 3 * sizeof *rgba);
        if (alpha)
            made->alpha[i] = rgba[4 * i + 3] < 0 ? 0 : rgba[4 * i + 3] > 1 ? 1 : rgba[4 * i + 3];
    }
    free(rgba);
    if (status)
        shape_image_destroy(made);
    else
        *image = made;
    return status;
}

shape_status view_encode(shape_gl_renderer *renderer, const shape_view *view, bool alpha, const char *output,
                         unsigned char **bytes, size_t *size, shape_error *error)
{
    shape_image_format format = SHAPE_IMAGE_PNG;
    shape_image *image;
    shape_status status = SHAPE_OK;
    if (strcmp(output, "-"))
        status = shape_image_format_find(output, &format, error);
    if (!status)
        status = view_read_image(renderer, view->width, view->height, alpha, &image, error);
    if (status)
        return status;
    shape_image_options options = shape_image_options_defaults();
    options.exposure = view->exposure;
    status = shape_image_encode(image, format, &options, bytes, size, error);
    shape_image_destroy(image);
    return status;
}
