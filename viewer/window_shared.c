/* What the window's files share, so that none of them calls window.c: an empty picture, and a line for a moment. */
#include <epoxy/gl.h>
#include <stdio.h>

#include "window_private.h"

void window_clear(int width, int height)
{
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, width, height);
    glClearColor(0.3f, 0.4f, 0.55f, 1);
    glClear(GL_COLOR_BUFFER_BIT);
}

void window_say(window_state *w, const char *text)
{
    snprintf(w->said, sizeof w->said, "%s", text);
    w->said_until = glfwGetTime() + 4;
}
