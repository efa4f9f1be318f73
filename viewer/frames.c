/* A sequence of pictures: each frame from its number alone, so that any machine may draw any of them, in any order, and
 * a range that broke off goes on where files are missing. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "shape/file.h"
#include "view.h"

enum { MAX_PATH = 4096, MAX_PICTURE = 0x40000000 };

shape_status view_frames_check(const view_frames *frames, shape_error *error)
{
    const char *place = strchr(frames->output, '%'), *end = place ? place + 1 : NULL;
    if (end && *end == '0')
        while (*end >= '0' && *end <= '9')
            end++;
    if (!place || *end != 'd' || end - place > 4 || strchr(end, '%') ||
        strlen(frames->output) > MAX_PATH - 32)
        return shape_error_set(
            error, SHAPE_ERROR_ARGUMENT,
            "-o \"%.200s\": --frames needs one place for the number (write frame.%%04d.png)", frames->output);
    shape_image_format format;
    return shape_image_format_find(frames->output, &format, error);
}

/* The name of a frame's file: the number with as many digits as the place asks for. */
static void frame_path(const view_frames *frames, int64_t number, char path[MAX_PATH])
{
    const char *place = strchr(frames->output, '%');
    int digits = (int)strtol(place + 1, NULL, 10); /* "04d" is 4, "d" is 0 */
    snprintf(path, MAX_PATH, "%.*s%0*lld%s", (int)(place - frames->output), frames->output, digits,
             (long long)number, strchr(place, 'd') + 1);
}

/* Whether a frame is there and whole, of this size. */
static bool is_there(const char *path, const shape_view *view)
{
    unsigned char *bytes;
    size_t size;
    shape_image *image;
    shape_error error;
    if (shape_file_read(path, MAX_PICTURE, &bytes, &size, &error))
        return false;
    bool whole = !shape_image_decode(bytes, size, &image, &error);
    free(bytes);
    if (!whole)
        return false;
    whole = image->width == view->width && image->height == view->height;
    shape_image_destroy(image);
    return whole;
}

static shape_status draw_frame(view_job *job, shape_gl_renderer *renderer, double time, const char *path,
                               shape_error *error)
{
    shape_view view = job->view;
    shape_light light = job->light;
    view_course_view(&job->course, time, &view);
    view_course_light(&job->course, time, &light);
    shape_status status = view_job_place(job, time, error);
    if (!status)
        status = shape_gl_load(renderer, job->volume, error);
    if (!status)
        status = shape_gl_light(renderer, &light, error);
    const view_plan plan = {.samples = job->samples, .largest = job->largest, .alpha = job->alpha};
    unsigned char *bytes;
    size_t size;
    if (!status)
        status = view_encode_drawn(renderer, &view, &plan, path, &bytes, &size, error);
    if (status)
        return status;
    status = shape_file_write(path, bytes, size, error);
    free(bytes);
    return status;
}

shape_status view_frames_draw(view_job *job, const view_frames *frames, shape_error *error)
{
    char path[MAX_PATH];
    int64_t drawn = 0, there = 0;
    shape_gl_context *context;
    shape_status status = shape_gl_context_create(&context, error);
    if (status)
        return status;
    for (int64_t i = frames->first; i <= frames->last && !status; i++) {
        frame_path(frames, i, path);
        if (!frames->overwrite && is_there(path, &job->view)) {
            there++;
            continue;
        }
        /* A renderer of its own: nothing of the frame before can show in this one. */
        shape_gl_renderer *renderer;
        status = shape_gl_create(&job->options, &renderer, error);
        if (status)
            break;
        status = draw_frame(job, renderer, (double)i / frames->fps, path, error);
        shape_gl_destroy(renderer);
        drawn++;
        cli_progress("drawing", (double)(i - frames->first + 1) / (double)(frames->last - frames->first + 1));
    }
    cli_progress("drawing", 1);
    shape_gl_context_destroy(context);
    if (!status)
        cli_say("%lld frames drawn, %lld were there", (long long)drawn, (long long)there);
    return status;
}
