/* The window: GLFW, input, a picture that refines itself while the view rests. */
#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <math.h>
#include <stdio.h>

#include "view.h"

typedef struct window_state {
    view_camera camera, start;
    double mouse_x, mouse_y;
    int sample; /* the next one to draw; 0 after every change */
    double exposure;
} window_state;

static const char *const help =
    "neph-view: drag: turn about the cloud   right drag: look round   wheel: nearer, farther\n"
    "           W S A D, E Q: fly ahead, back, left, right, up, down (Shift: faster)\n"
    "           + -: exposure   Home: first view   H: this help   Esc: quit\n";

static window_state *state_of(GLFWwindow *window)
{
    return glfwGetWindowUserPointer(window);
}

static void on_move(GLFWwindow *window, double x, double y)
{
    window_state *state = state_of(window);
    const double speed = 0.006; /* radians a pixel */
    double dx = (x - state->mouse_x) * speed, dy = (y - state->mouse_y) * speed;
    state->mouse_x = x;
    state->mouse_y = y;
    if (glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_LEFT))
        view_camera_orbit(&state->camera, -dx, -dy);
    else if (glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_RIGHT))
        view_camera_look(&state->camera, -dx, -dy);
    else
        return;
    state->sample = 0;
}

static void on_scroll(GLFWwindow *window, double x, double y)
{
    (void)x;
    window_state *state = state_of(window);
    view_camera_dolly(&state->camera, pow(0.9, y));
    state->sample = 0;
}

static void on_resize(GLFWwindow *window, int width, int height)
{
    (void)width;
    (void)height;
    state_of(window)->sample = 0;
}

static void on_key(GLFWwindow *window, int key, int code, int action, int modifiers)
{
    (void)code;
    (void)modifiers;
    window_state *state = state_of(window);
    if (action == GLFW_RELEASE)
        return;
    if (key == GLFW_KEY_ESCAPE)
        glfwSetWindowShouldClose(window, GLFW_TRUE);
    else if (key == GLFW_KEY_HOME)
        state->camera = state->start;
    else if (key == GLFW_KEY_EQUAL || key == GLFW_KEY_KP_ADD)
        state->exposure += 0.25;
    else if (key == GLFW_KEY_MINUS || key == GLFW_KEY_KP_SUBTRACT)
        state->exposure -= 0.25;
    else if (key == GLFW_KEY_H)
        fputs(help, stderr);
    else
        return;
    if (key == GLFW_KEY_HOME)
        state->sample = 0;
}

/* Held keys move the camera by the time that has passed. */
static void fly(GLFWwindow *window, window_state *state, double seconds)
{
    static const struct {
        int key;
        double right, up, ahead;
    } moves[] = {{GLFW_KEY_W, 0, 0, 1},  {GLFW_KEY_S, 0, 0, -1}, {GLFW_KEY_D, 1, 0, 0},
                 {GLFW_KEY_A, -1, 0, 0}, {GLFW_KEY_E, 0, 1, 0},  {GLFW_KEY_Q, 0, -1, 0}};
    bool fast = glfwGetKey(window, GLFW_KEY_LEFT_SHIFT) || glfwGetKey(window, GLFW_KEY_RIGHT_SHIFT);
    double step = state->camera.size * fmin(seconds, 0.25) * (fast ? 2 : 0.5);
    for (size_t i = 0; i < sizeof moves / sizeof *moves; i++)
        if (glfwGetKey(window, moves[i].key)) {
            view_camera_fly(&state->camera, step * moves[i].right, step * moves[i].up, step * moves[i].ahead);
            state->sample = 0;
        }
}

static GLFWwindow *open_window(const view_job *job, window_state *state)
{
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    GLFWwindow *window = glfwCreateWindow(job->view.width, job->view.height, job->title, NULL, NULL);
    if (!window)
        return NULL;
    glfwMakeContextCurrent(window);
    glfwSwapInterval(1);
    glfwSetWindowUserPointer(window, state);
    glfwSetCursorPosCallback(window, on_move);
    glfwSetScrollCallback(window, on_scroll);
    glfwSetKeyCallback(window, on_key);
    glfwSetFramebufferSizeCallback(window, on_resize);
    glfwGetCursorPos(window, &state->mouse_x, &state->mouse_y);
    return window;
}

/* Draws one more sample where the picture is not finished, and shows it. Returns whether there is more to draw. */
static bool draw(GLFWwindow *window, view_job *job, window_state *state, shape_gl_renderer *renderer,
                 shape_status *status, shape_error *error)
{
    int width, height;
    glfwGetFramebufferSize(window, &width, &height);
    if (width < 1 || height < 1)
        return false; /* minimised */
    job->view.width = width;
    job->view.height = height;
    view_camera_apply(&state->camera, &job->view);
    if (state->sample < job->samples)
        *status = shape_gl_draw(renderer, &job->view, state->sample++, error);
    if (!*status) {
        glBindFramebuffer(GL_FRAMEBUFFER, 0);
        shape_gl_show(renderer, (float)state->exposure, width, height);
        glfwSwapBuffers(window);
    }
    return state->sample < job->samples;
}

static shape_status run(GLFWwindow *window, view_job *job, window_state *state, shape_error *error)
{
    shape_gl_renderer *renderer;
    shape_status status = shape_gl_create(&job->options, &renderer, error);
    if (status)
        return status;
    status = shape_gl_load(renderer, job->volume, error);
    if (!status)
        status = shape_gl_light(renderer, &job->light, error);
    double last = glfwGetTime();
    bool more = true;
    while (!status && !glfwWindowShouldClose(window)) {
        if (more)
            glfwPollEvents();
        else
            glfwWaitEventsTimeout(0.05);
        double time = glfwGetTime();
        fly(window, state, time - last);
        last = time;
        more = draw(window, job, state, renderer, &status, error);
    }
    shape_gl_destroy(renderer);
    return status;
}

shape_status view_window(view_job *job, shape_error *error)
{
    if (!glfwInit()) {
        const char *why = NULL;
        glfwGetError(&why);
        return shape_error_set(error, SHAPE_ERROR_SYSTEM,
                               "no window: %s (write a picture with --headless -o cloud.png instead)",
                               why ? why : "no display");
    }
    window_state state = {.exposure = job->view.exposure};
    shape_dvec3 min = {-1, -1, -1}, max = {1, 1, 1};
    shape_set_bounds(job->set, &min, &max);
    state.camera = state.start = view_camera_start(&job->view, min, max);
    GLFWwindow *window = open_window(job, &state);
    shape_status status;
    if (window) {
        status = run(window, job, &state, error);
        job->view.exposure = (float)state.exposure; /* a saved scene looks as the window did */
        glfwDestroyWindow(window);
    } else {
        const char *why = NULL;
        glfwGetError(&why);
        status = shape_error_set(
            error, SHAPE_ERROR_SYSTEM,
            "no window with OpenGL 3.3: %s (write a picture with --headless -o cloud.png instead)",
            why ? why : "unknown reason");
    }
    glfwTerminate();
    return status;
}
