/* Preloaded into neph-view (LD_PRELOAD) by the tests of its window: an OpenGL that loses its context, or that cannot draw
 * into float textures, where a file of that name lies in the current folder. libepoxy keeps its functions in variables. */
#include <epoxy/gl.h>
#include <stdio.h>
#include <unistd.h>

static PFNGLCHECKFRAMEBUFFERSTATUSPROC check_framebuffer;

/* Once for each file that is put there. */
static GLenum lose_context(void)
{
    return unlink("lose-context") ? GL_NO_ERROR : GL_GUILTY_CONTEXT_RESET;
}

/* libepoxy's variable finds the driver's function at its first call, and then holds that. */
static GLenum refuse_floats(GLenum target)
{
    if (!access("no-floats", F_OK))
        return GL_FRAMEBUFFER_UNSUPPORTED;
    epoxy_glCheckFramebufferStatus = check_framebuffer;
    GLenum status = glCheckFramebufferStatus(target);
    check_framebuffer = epoxy_glCheckFramebufferStatus;
    epoxy_glCheckFramebufferStatus = refuse_floats;
    return status;
}

__attribute__((constructor)) static void begin(void)
{
    check_framebuffer = epoxy_glCheckFramebufferStatus;
    epoxy_glGetGraphicsResetStatus = lose_context;
    epoxy_glCheckFramebufferStatus = refuse_floats;
}
