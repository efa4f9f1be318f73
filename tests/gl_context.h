/* For tests that draw: OpenGL without a window, opened before the tests of a program and closed after them, and renderers
 * with the usual options. Runs on whatever OpenGL there is; none is a failure. */
#ifndef GL_CONTEXT_H
#define GL_CONTEXT_H

#include "volume_sample.h"

#include "shape_gl.h"

static shape_gl_context *gl_context;

static inline int open_context(void **state)
{
    (void)state;
    shape_error error;
    if (shape_gl_context_create(&gl_context, &error)) {
        print_error("%s\n", error.text);
        return -1;
    }
    return 0;
}

static inline int close_context(void **state)
{
    (void)state;
    shape_gl_context_destroy(gl_context);
    return 0;
}

static inline shape_gl_renderer *new_renderer(shape_gl_method method)
{
    shape_error error;
    shape_gl_options options = shape_gl_defaults();
    shape_gl_renderer *renderer = NULL;
    options.method = method;
    must(shape_gl_create(&options, &renderer, &error), &error);
    return renderer;
}

#endif
