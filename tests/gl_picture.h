/* For tests that draw: pictures of a set by a method, with renderers that are kept until the end. With albedo 0 and a sky
 * of constant radiance 1 a pixel is the transmittance of its ray. */
#ifndef GL_PICTURE_H
#define GL_PICTURE_H

#include "gl_context.h"

static inline shape_light white_sky(void)
{
    shape_light light = shape_light_defaults();
    light.sky = SHAPE_SKY_CONSTANT;
    for (int i = 0; i < 3; i++)
        light.sky_radiance[i] = 1;
    return light;
}

static inline shape_view view_of(int width, int height, shape_dvec3 eye, shape_dvec3 target, double fov)
{
    shape_view view = shape_view_defaults();
    view.width = width, view.height = height, view.eye = eye, view.target = target, view.fov = fov;
    return view;
}

/* One renderer a method, with the scattered light solved for and without: shaders are compiled once. */
static shape_gl_renderer *renderers[SHAPE_GL_PAPER_NDT + 1][2];

static inline int close_pictures(void **state)
{
    for (int method = 0; method <= SHAPE_GL_PAPER_NDT; method++)
        for (int i = 0; i < 2; i++)
            shape_gl_destroy(renderers[method][i]);
    return close_context(state);
}

static inline shape_gl_renderer *find_renderer(shape_gl_method method, bool scattering)
{
    shape_error error;
    shape_gl_renderer **renderer = &renderers[method][scattering];
    shape_gl_options options = shape_gl_defaults();
    options.method = method;
    options.light.resolution = 10;
    options.light.scattering = scattering;
    if (!*renderer)
        must(shape_gl_create(&options, renderer, &error), &error);
    return *renderer;
}

/* A picture of the mean of some samples; the caller frees it. */
static inline float *render(const shape_set *set, shape_gl_method method, const shape_view *view,
                            const shape_light *light, bool scattering, int samples)
{
    shape_error error;
    shape_gl_renderer *renderer = find_renderer(method, scattering);
    shape_volume *volume = new_volume(set);
    must(shape_gl_load(renderer, volume, &error), &error);
    must(shape_gl_light(renderer, light, &error), &error);
    for (int i = 0; i < samples; i++)
        must(shape_gl_draw(renderer, view, i, &error), &error);
    float *rgba = malloc((size_t)view->width * (size_t)view->height * 4 * sizeof *rgba);
    assert_non_null(rgba);
    must(shape_gl_read(renderer, rgba, &error), &error);
    shape_volume_destroy(volume);
    return rgba;
}

static inline shape_cloud *black_cloud(shape_set *set, float extinction)
{
    shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_UNIFORM);
    cloud->medium.albedo = 0;
    cloud->medium.extinction = extinction;
    return cloud;
}

#endif
