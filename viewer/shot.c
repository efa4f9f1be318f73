/* Screenshots: drawn by a renderer of their own, so by the fine grids alone, and in parts where they are
 * larger than what the GPU draws at once. */
#include "shot.h"

#include <stdlib.h>
#include <string.h>

#include "lighting.h"
#include "shape/file.h"
#include "shape/scene.h"
#include "view.h"

enum { SIDE = 1024 }; /* of what is drawn at once, so that a large picture can be broken off soon */

static shape_status draw_shot(const view_shot *s, const view_state *state, const shape_volume *volume,
                              shape_gl_renderer *gl, view_plan plan, shape_image **image, shape_error *error)
{
    shape_view view = view_state_view(state, s->width, s->height);
    shape_light light = view_state_light(state);
    shape_status status = shape_gl_load(gl, volume, error);
    if (!status)
        status = shape_gl_light(gl, &light, error);
    if (!status)
        status = view_draw_image(gl, &view, &plan, image, error);
    return status;
}

static shape_status write_shot(const view_shot *s, float exposure, const shape_image *image,
                               shape_error *error)
{
    shape_image_format format;
    shape_status status = shape_image_format_find(s->path, &format, error);
    if (status)
        return status;
    enum { TEXT_MAX = 65535 };
    const shape_image_text texts[] = {{"nephele", s->comment}, {SHAPE_SCENE_PICTURE_KEY, s->scene}};
    shape_image_options options = shape_image_options_defaults();
    options.exposure = exposure;
    options.texts = texts;
    options.text_count = s->scene && strlen(s->scene) <= TEXT_MAX ? 2 : 1;
    unsigned char *bytes;
    size_t size;
    status = shape_image_encode(image, format, &options, &bytes, &size, error);
    if (status)
        return status;
    status = shape_file_write(s->path, bytes, size, error);
    free(bytes);
    return status;
}

shape_status view_shot_take(const view_shot *s, const view_state *state, const shape_volume *volume,
                            const shape_gl_options *usual, shape_progress go_on, void *context,
                            shape_error *error)
{
    shape_gl_renderer *gl;
    shape_gl_options options = *usual;
    options.method = (shape_gl_method)state->method;
    options.light.resolution = state->light_grid;
    options.lighting = view_lighting_gl(&state->lighting);
    options.no_background = s->alpha;
    options.background = false;
    shape_status status = shape_gl_create(&options, &gl, error);
    if (status)
        return status;
    shape_image *image = NULL;
    const view_plan plan = {.samples = state->samples,
                            .largest = s->largest > 0 && s->largest < SIDE ? s->largest : SIDE,
                            .alpha = s->alpha,
                            .go_on = go_on,
                            .context = context};
    status = draw_shot(s, state, volume, gl, plan, &image, error);
    shape_gl_destroy(gl);
    if (status)
        return status;
    status = write_shot(s, state->exposure, image, error);
    shape_image_destroy(image);
    return status;
}
