/* An OpenGL 3.3 core context without a window: EGL on the surfaceless platform, else on the default display. */
#include "shape_gl.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <stdlib.h>

struct shape_gl_context {
    EGLDisplay display;
    EGLContext context;
};

static EGLDisplay open_display(void)
{
    EGLint major, minor;
    if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
        EGLDisplay display =
            eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
        if (display != EGL_NO_DISPLAY && eglInitialize(display, &major, &minor))
            return display;
    }
    EGLDisplay display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
    if (display != EGL_NO_DISPLAY && eglInitialize(display, &major, &minor))
        return display;
    return EGL_NO_DISPLAY;
}

shape_status shape_gl_context_create(shape_gl_context **context, shape_error *error)
{
    EGLDisplay display = open_display();
    if (display == EGL_NO_DISPLAY)
        return shape_error_set(
            error, SHAPE_ERROR_SYSTEM,
            "no EGL display (install Mesa: libegl1 libegl-mesa0 libgl1-mesa-dri on Debian)");
    static const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                        3,
                                        EGL_CONTEXT_MINOR_VERSION,
                                        3,
                                        EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                        EGL_NONE};
    EGLContext made = EGL_NO_CONTEXT;
    if (eglBindAPI(EGL_OPENGL_API))
        made = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    shape_gl_context *result = made == EGL_NO_CONTEXT ? NULL : malloc(sizeof *result);
    if (!result || !eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, made)) {
        free(result);
        eglTerminate(display);
        return shape_error_set(
            error, SHAPE_ERROR_SYSTEM,
            "no OpenGL 3.3 core context without a window (install Mesa: libgl1-mesa-dri on Debian)");
    }
    *result = (shape_gl_context){display, made};
    *context = result;
    return SHAPE_OK;
}

void shape_gl_context_destroy(shape_gl_context *context)
{
    if (!context)
        return;
    eglMakeCurrent(context->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(context->display, context->context);
    eglTerminate(context->display);
    free(context);
}

bool shape_gl_is_lost(void)
{
    if (epoxy_gl_version() >= 45 || epoxy_has_gl_extension("GL_KHR_robustness"))
        return glGetGraphicsResetStatus() != GL_NO_ERROR;
    return epoxy_has_gl_extension("GL_ARB_robustness") && glGetGraphicsResetStatusARB() != GL_NO_ERROR;
}
