/* Keys and the mouse of the window. */
#include <math.h>
#include <stdio.h>

#include "window_private.h"

static window_state *state_of(GLFWwindow *window)
{
    return glfwGetWindowUserPointer(window);
}

static void on_move(GLFWwindow *window, double x, double y)
{
    window_state *w = state_of(window);
    const double speed = 0.006; /* radians a pixel */
    double dx = (x - w->mouse_x) * speed, dy = (y - w->mouse_y) * speed;
    int width, height;
    w->mouse_x = x;
    w->mouse_y = y;
    glfwGetWindowSize(window, &width, &height);
    if (w->splitting && width > 0)
        w->state.divider = (float)fmin(fmax(x / width, 0), 1);
    else if (w->dragging)
        view_camera_orbit(&w->camera, -dx, -dy);
    else if (w->looking)
        view_camera_look(&w->camera, -dx, -dy);
}

static void on_button(GLFWwindow *window, int button, int action, int modifiers)
{
    (void)modifiers;
    window_state *w = state_of(window);
    int width, height;
    glfwGetWindowSize(window, &width, &height);
    bool press = action == GLFW_PRESS && !view_panel_covers(w->mouse_x, w->mouse_y);
    bool near = w->state.split && fabs(w->mouse_x - width * (double)w->state.divider) < 8;
    if (button == GLFW_MOUSE_BUTTON_LEFT) {
        w->splitting = press && near;
        w->dragging = press && !near;
    } else if (button == GLFW_MOUSE_BUTTON_RIGHT) {
        w->looking = press;
    }
}

static void on_scroll(GLFWwindow *window, double x, double y)
{
    (void)x;
    window_state *w = state_of(window);
    if (!view_panel_covers(w->mouse_x, w->mouse_y))
        view_camera_dolly(&w->camera, pow(0.9, y));
}

static void on_control_key(window_state *w, int key, bool shift)
{
    if ((key == GLFW_KEY_Z && shift) || key == GLFW_KEY_Y)
        w->redo = true;
    else if (key == GLFW_KEY_Z)
        w->undo = true;
    else if (key == GLFW_KEY_C)
        w->copy = true;
    else if (key == GLFW_KEY_S)
        w->save = true;
}

static void on_key(GLFWwindow *window, int key, int code, int action, int modifiers)
{
    (void)code;
    window_state *w = state_of(window);
    if (action == GLFW_RELEASE || view_panel_has_keys())
        return;
    if (modifiers & GLFW_MOD_CONTROL) {
        on_control_key(w, key, modifiers & GLFW_MOD_SHIFT);
        return;
    }
    if (key == GLFW_KEY_EQUAL || key == GLFW_KEY_KP_ADD)
        w->state.exposure += 0.25f;
    else if (key == GLFW_KEY_MINUS || key == GLFW_KEY_KP_SUBTRACT)
        w->state.exposure -= 0.25f;
    if (action == GLFW_REPEAT)
        return;
    if (key == GLFW_KEY_ESCAPE)
        w->escape = true;
    else if (key == GLFW_KEY_HOME)
        w->home = true;
    else if (key == GLFW_KEY_TAB)
        w->open = !w->open;
    else if (key == GLFW_KEY_H || key == GLFW_KEY_F1)
        w->help = !w->help;
    else if (key == GLFW_KEY_X)
        w->state.split = !w->state.split;
    else if (key == GLFW_KEY_B)
        w->state.boxes = !w->state.boxes;
    else if (key == GLFW_KEY_P)
        w->state.outlines = (w->state.outlines + 1) % VIEW_OUTLINES;
    else if (key == GLFW_KEY_T)
        w->state.heat = (w->state.heat + 1) % VIEW_HEATS;
    else if (key == GLFW_KEY_R)
        w->state.difference = !w->state.difference;
    else if (key == GLFW_KEY_SPACE)
        w->playing = !w->playing;
    else if (key == GLFW_KEY_F12)
        w->shoot = true;
}

bool window_fly(window_state *w, double seconds)
{
    static const struct {
        int key;
        double right, up, ahead;
    } moves[] = {{GLFW_KEY_W, 0, 0, 1},  {GLFW_KEY_S, 0, 0, -1}, {GLFW_KEY_D, 1, 0, 0},
                 {GLFW_KEY_A, -1, 0, 0}, {GLFW_KEY_E, 0, 1, 0},  {GLFW_KEY_Q, 0, -1, 0}};
    if (view_panel_has_keys() || glfwGetKey(w->window, GLFW_KEY_LEFT_CONTROL) ||
        glfwGetKey(w->window, GLFW_KEY_RIGHT_CONTROL))
        return false;
    bool fast = glfwGetKey(w->window, GLFW_KEY_LEFT_SHIFT) || glfwGetKey(w->window, GLFW_KEY_RIGHT_SHIFT);
    double step = w->camera.size * fmin(seconds, 0.25) * (fast ? 2 : 0.5);
    bool any = false;
    for (size_t i = 0; i < sizeof moves / sizeof *moves; i++)
        if (glfwGetKey(w->window, moves[i].key)) {
            view_camera_fly(&w->camera, step * moves[i].right, step * moves[i].up, step * moves[i].ahead);
            any = true;
        }
    return any;
}

static void on_drop(GLFWwindow *window, int count, const char **paths)
{
    window_state *w = state_of(window);
    if (count > 0)
        snprintf(w->dropped, sizeof w->dropped, "%s", paths[0]);
}

void window_listen(window_state *w)
{
    glfwSetWindowUserPointer(w->window, w);
    glfwSetCursorPosCallback(w->window, on_move);
    glfwSetMouseButtonCallback(w->window, on_button);
    glfwSetScrollCallback(w->window, on_scroll);
    glfwSetKeyCallback(w->window, on_key);
    glfwSetDropCallback(w->window, on_drop);
    glfwGetCursorPos(w->window, &w->mouse_x, &w->mouse_y);
}
