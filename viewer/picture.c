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

static shape_status encode_image(const shape_image *image, shape_image_format format, float exposure,
                                 unsigned char **bytes, size_t *size, shape_error *error)
{
    shape_image_options options = shape_image_options_defaults();
    options.exposure = exposure;
    return shape_image_encode(image, format, &options, bytes, size, error);
}

static shape_status find_format(const char *output, shape_image_format *format, shape_error *error)
{
    *format = SHAPE_IMAGE_PNG;
    return strcmp(output, "-") ? shape_image_format_find(output, format, error) : SHAPE_OK;
}

shape_status view_encode(shape_gl_renderer *renderer, const shape_view *view, bool alpha, const char *output,
                         unsigned char **bytes, size_t *size, shape_error *error)
{
    shape_image_format format;
    shape_image *image;
    shape_status status = find_format(output, &format, error);
    if (!status)
        status = view_read_image(renderer, view->width, view->height, alpha, &image, error);
    if (status)
        return status;
    status = encode_image(image, format, view->exposure, bytes, size, error);
    shape_image_destroy(image);
    return status;
}

/* What the job's clouds look like, drawn by a renderer of their own. */
static shape_status draw_image(const view_job *job, const shape_view *view, const shape_light *light,
                               shape_image **image, shape_error *error)
{
    shape_gl_renderer *renderer;
    shape_status status = shape_gl_create(&job->options, &renderer, error);
    if (status)
        return status;
    status = shape_gl_load(renderer, job->volume, error);
    if (!status)
        status = shape_gl_light(renderer, light, error);
    for (int i = 0; i < job->samples && !status; i++) {
        status = shape_gl_draw(renderer, view, i, error);
        shape_gl_finish();
        cli_progress("drawing", (double)(i + 1) / job->samples);
    }
    if (!status)
        status = view_read_image(renderer, view->width, view->height, job->alpha, image, error);
    shape_gl_destroy(renderer);
    return status;
}

/* Columns from x on are taken from the other. */
static void join_images(shape_image *image, const shape_image *right, int x)
{
    size_t width = (size_t)image->width, from = (size_t)x;
    for (size_t row = 0; row < (size_t)image->height; row++) {
        size_t start = row * width + from;
        memcpy(image->pixels + 3 * start, right->pixels + 3 * start, 3 * (width - from) * sizeof(float));
        if (image->alpha)
            memcpy(image->alpha + start, right->alpha + start, (width - from) * sizeof(float));
    }
}

shape_status view_encode_split(const view_job *job, const shape_view *view, const shape_light *light,
                               const char *output, unsigned char **bytes, size_t *size, shape_error *error)
{
    shape_image *left = NULL, *right = NULL;
    shape_image_format format;
    view_job other = *job;
    other.set = job->other_set;
    other.moved = NULL;
    other.volume = NULL;
    shape_status status = find_format(output, &format, error);
    if (!status)
        status = view_job_place(&other, job->time, error);
    if (!status)
        status = draw_image(job, view, light, &left, error);
    if (!status)
        status = draw_image(&other, view, light, &right, error);
    if (!status) {
        join_images(left, right, (int)((float)view->width * job->divider));
        status = encode_image(left, format, view->exposure, bytes, size, error);
    }
    view_job_free(&other);
    shape_image_destroy(left);
    shape_image_destroy(right);
    return status;
}
