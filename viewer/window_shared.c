/* What the window's files share, so that none of them calls window.c: an empty picture, a line for a moment,
 * the name of what is written. */
#include <epoxy/gl.h>
#include <stdio.h>
#include <unistd.h>

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

void window_free_name(const window_state *w, const char *suffix, char *path, size_t room)
{
    char name[SHAPE_NAME_MAX + 1];
    cli_bare_name(w->job->path[0] ? w->job->path : w->job->title, "cloud", name);
    for (int i = 1; i < 10000; i++) {
        snprintf(path, room, "%s-%04d.%s", name, i, suffix);
        if (access(path, F_OK))
            break;
    }
}
