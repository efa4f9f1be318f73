/* neph-chart's pictures by OpenGL: one renderer a setting, kept warm from one measurement to the next. */
#include <stdlib.h>
#include <string.h>

#include "chart.h"
#include "shape_gl.h"

struct chart_gl {
    shape_gl_context *context;
    shape_gl_renderer **renderers;
    size_t count;
};

shape_status chart_gl_open(chart_gl **gl, shape_error *error)
{
    chart_gl *made = calloc(1, sizeof *made);
    if (!made)
        return shape_error_set(error, SHAPE_ERROR_MEMORY, "not enough memory");
    made->renderers = calloc(chart_setting_count, sizeof *made->renderers);
    made->count = chart_setting_count;
    shape_status status = made->renderers ? shape_gl_context_create(&made->context, error)
                                          : shape_error_set(error, SHAPE_ERROR_MEMORY, "not enough memory");
    if (status) {
        free(made->renderers);
        free(made);
        return status;
    }
    *gl = made;
    return SHAPE_OK;
}

void chart_gl_forget(chart_gl *gl)
{
    for (size_t i = 0; gl && i < gl->count; i++) {
        shape_gl_destroy(gl->renderers[i]);
        gl->renderers[i] = NULL;
    }
}

void chart_gl_close(chart_gl *gl)
{
    if (!gl)
        return;
    chart_gl_forget(gl);
    shape_gl_context_destroy(gl->context);
    free(gl->renderers);
    free(gl);
}

static shape_status make_renderer(const chart_setting *setting, shape_gl_renderer **renderer,
                                  shape_error *error)
{
    static const shape_gl_method methods[] = {SHAPE_GL_DEFAULT, SHAPE_GL_EXACT, SHAPE_GL_PAPER,
                                              SHAPE_GL_PAPER_NDT};
    static const shape_gl_law laws[] = {[SHAPE_MARCH_SINGLE] = SHAPE_GL_LAW_SINGLE,
                                        [SHAPE_MARCH_POWDER] = SHAPE_GL_LAW_POWDER,
                                        [SHAPE_MARCH_OCTAVES] = SHAPE_GL_LAW_OCTAVES,
                                        [SHAPE_MARCH_GRID] = SHAPE_GL_LAW_GRID};
    shape_gl_options options = shape_gl_defaults();
    options.lighting.law = laws[setting->light];
    options.method = methods[setting->method - CHART_GL];
    options.light.resolution = setting->cells;
    options.bake_voxels = (size_t)setting->voxels * 1000;
    return shape_gl_create(&options, renderer, error);
}

/* All samples of a picture, to their end. */
static shape_status draw(shape_gl_renderer *renderer, const chart_setting *setting, const shape_view *view,
                         shape_error *error)
{
    shape_status status = SHAPE_OK;
    for (int i = 0; i < setting->samples && !status; i++)
        status = setting->moving ? shape_gl_draw_moving(renderer, view, error)
                                 : shape_gl_draw(renderer, view, i, error);
    shape_gl_finish();
    return status;
}

static shape_status read_picture(shape_gl_renderer *renderer, const shape_view *view, float *radiance,
                                 shape_error *error)
{
    size_t pixels = (size_t)view->width * (size_t)view->height;
    float *rgba = malloc(pixels * 4 * sizeof *rgba);
    if (!rgba)
        return shape_error_set(error, SHAPE_ERROR_MEMORY, "not enough memory");
    shape_status status = shape_gl_read(renderer, rgba, error);
    for (size_t i = 0; i < pixels && !status; i++)
        memcpy(radiance + 3 * i, rgba + 4 * i, 3 * sizeof *rgba);
    free(rgba);
    return status;
}

shape_status chart_gl_draw(chart_gl *gl, size_t number, const chart_setting *setting,
                           const shape_volume *volume, const shape_view *view, const shape_light *light,
                           double times[CHART_KINDS], float *radiance, shape_error *error)
{
    shape_gl_renderer **renderer = &gl->renderers[number];
    shape_status status = *renderer ? SHAPE_OK : make_renderer(setting, renderer, error);
    double start = chart_seconds();
    if (!status)
        status = shape_gl_load(*renderer, volume, error);
    if (!status)
        status = shape_gl_light(*renderer, light, error);
    if (!status)
        status = draw(*renderer, setting, view, error);
    double middle = chart_seconds();
    if (!status)
        status = draw(*renderer, setting, view, error);
    times[CHART_PICTURE] = 1e3 * (middle - start);
    times[CHART_FRAME] = 1e3 * (chart_seconds() - middle);
    if (!status && radiance)
        status = read_picture(*renderer, view, radiance, error);
    return status;
}
