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

/* Puts what the renderer has drawn, a part of the picture or all of it, into the image. */
static shape_status read_part(shape_gl_renderer *renderer, shape_gl_part part, shape_image *image,
                              shape_error *error)
{
    size_t width = (size_t)part.width, height = (size_t)part.height;
    float *rgba = malloc(width * height * 4 * sizeof *rgba);
    if (!rgba)
        return shape_error_memory(error);
    shape_status status = shape_gl_read(renderer, rgba, error);
    for (size_t y = 0; !status && y < height; y++) {
        /* NOLINTNEXTLINE: the caller has made it, or has left with an error */
        size_t row = (size_t)image->height - (size_t)part.y - height + y;
        size_t to = row * (size_t)image->width + (size_t)part.x;
        for (size_t x = 0; x < width; x++, to++) {
            const float *from = rgba + 4 * (y * width + x);
            memcpy(image->pixels + 3 * to, from, 3 * sizeof *from);
            if (image->alpha)
                image->alpha[to] = from[3] < 0 ? 0 : from[3] > 1 ? 1 : from[3];
        }
    }
    free(rgba);
    return status;
}

static shape_status new_image(int width, int height, bool alpha, shape_image **image, shape_error *error)
{
    *image = shape_image_create(width, height, error);
    if (!*image)
        return error->status;
    shape_status status = alpha ? shape_image_add_alpha(*image, error) : SHAPE_OK;
    if (status)
        shape_image_destroy(*image);
    return status;
}

shape_status view_read_image(shape_gl_renderer *renderer, int width, int height, bool alpha,
                             shape_image **image, shape_error *error)
{
    const shape_gl_part whole = {0, 0, width, height};
    shape_status status = new_image(width, height, alpha, image, error);
    if (status)
        return status;
    status = read_part(renderer, whole, *image, error);
    if (status)
        shape_image_destroy(*image);
    return status;
}

shape_status view_draw_image(shape_gl_renderer *renderer, const shape_view *view, const view_plan *plan,
                             shape_image **image, shape_error *error)
{
    int limit = plan->largest > 0 ? plan->largest : shape_gl_largest();
    int side = limit / SHAPE_GL_PART_STEP * SHAPE_GL_PART_STEP, width = view->width, height = view->height;
    bool parts = width > limit || height > limit;
    int across = parts ? (width + side - 1) / side : 1, down = parts ? (height + side - 1) / side : 1;
    shape_status status = new_image(width, height, plan->alpha, image, error);
    if (status)
        return status;
    for (int i = 0; i < across * down && !status; i++) {
        shape_gl_part part = {i % across * side, i / across * side, side, side};
        part.width = !parts || part.x + side > width ? width - part.x : side;
        part.height = !parts || part.y + side > height ? height - part.y : side;
        shape_gl_set_part(renderer, part);
        for (int k = 0; k < plan->samples && !status; k++) {
            status = shape_gl_draw(renderer, view, k, error);
            shape_gl_finish();
            double done = (double)(i * plan->samples + k + 1) / ((double)across * down * plan->samples);
            if (plan->progress)
                plan->progress("drawing", done);
            if (!status && plan->go_on && !plan->go_on(plan->context, done))
                status = shape_error_set(error, SHAPE_ERROR_LIMIT, "broken off");
        }
        if (!status)
            status = read_part(renderer, part, *image, error);
    }
    shape_gl_set_part(renderer, (shape_gl_part){0, 0, 0, 0});
    if (status)
        shape_image_destroy(*image);
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

shape_status view_encode_drawn(shape_gl_renderer *renderer, const shape_view *view, const view_plan *plan,
                               const char *output, unsigned char **bytes, size_t *size, shape_error *error)
{
    shape_image_format format;
    shape_image *image;
    shape_status status = find_format(output, &format, error);
    if (!status)
        status = view_draw_image(renderer, view, plan, &image, error);
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
    const view_plan plan = {
        .samples = job->samples, .largest = job->largest, .alpha = job->alpha, .progress = cli_progress};
    if (!status)
        status = view_draw_image(renderer, view, &plan, image, error);
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
