/* The window: GLFW and input. It shows what the drawing thread has made, and never waits for it. */
#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "panel.h"
#include "render.h"
#include "shape/combine.h"
#include "view.h"
#include "watch.h"

enum { PANEL_WIDTH = 700 }; /* a window narrower than this starts with the panel folded */

typedef struct window_state {
    GLFWwindow *window;
    view_job *job;
    view_camera camera, start;
    double mouse_x, mouse_y;
    bool dragging, looking, splitting; /* which drag is under way */
    view_state state, base, asked;
    int asked_size[2];
    view_history *history;
    view_renderer *renderer;
    view_watch *watch;
    view_shared *set, *placed;
    uint64_t set_number, asked_number, asks,
        reload_ask;  /* reload_ask: the first request for a file read again; 0 */
    double saved_ms; /* when that file was saved; 0: it has been shown */
    view_picture picture;
    char error[4096], said[640], title[512];
    float times[VIEW_TIMES];
    double read_ms, last, said_until;
    bool open, help, playing, undo, redo, home, shoot, copy, ask_anew;
    size_t primitives;
} window_state;

static double now_ms(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

static window_state *state_of(GLFWwindow *window)
{
    return glfwGetWindowUserPointer(window);
}

/* --- input --- */

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
    if (key == GLFW_KEY_Z && shift)
        w->redo = true;
    else if (key == GLFW_KEY_Z)
        w->undo = true;
    else if (key == GLFW_KEY_Y)
        w->redo = true;
    else if (key == GLFW_KEY_C)
        w->copy = true;
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
        glfwSetWindowShouldClose(window, GLFW_TRUE);
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
        w->state.outlines = !w->state.outlines;
    else if (key == GLFW_KEY_T)
        w->state.heat = (view_heat)((w->state.heat + 1) % 3);
    else if (key == GLFW_KEY_SPACE)
        w->playing = !w->playing;
    else if (key == GLFW_KEY_F12)
        w->shoot = true;
}

/* Held keys move the camera by the time that has passed; returns whether any is held. */
static bool fly(window_state *w, double seconds)
{
    static const struct {
        int key;
        double right, up, ahead;
    } moves[] = {{GLFW_KEY_W, 0, 0, 1},  {GLFW_KEY_S, 0, 0, -1}, {GLFW_KEY_D, 1, 0, 0},
                 {GLFW_KEY_A, -1, 0, 0}, {GLFW_KEY_E, 0, 1, 0},  {GLFW_KEY_Q, 0, -1, 0}};
    if (view_panel_has_keys())
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

/* --- the state --- */

static void copy_vector(double to[3], shape_dvec3 from)
{
    to[0] = from.x, to[1] = from.y, to[2] = from.z;
}

static bool is_at(const double v[3], shape_dvec3 p)
{
    return v[0] == p.x && v[1] == p.y && v[2] == p.z;
}

/* The camera to the state; or, where the panel has typed another eye or target, back. */
static void settle_camera(window_state *w, bool from_panel)
{
    shape_view view = view_state_view(&w->state, 1, 1);
    if (!from_panel || (is_at(w->state.eye, w->camera.eye) && is_at(w->state.target, w->camera.target))) {
        copy_vector(w->state.eye, w->camera.eye);
        copy_vector(w->state.target, w->camera.target);
        return;
    }
    double size = w->camera.size;
    view.eye = shape_dvec3_make(w->state.eye[0], w->state.eye[1], w->state.eye[2]);
    view.target = shape_dvec3_make(w->state.target[0], w->state.target[1], w->state.target[2]);
    if (shape_dvec3_length(shape_dvec3_sub(view.target, view.eye)) > 0) {
        w->camera = view_camera_start(&view, shape_dvec3_make(0, 0, 0), shape_dvec3_make(0, 0, 0));
        w->camera.size = size;
    }
}

static void begin_state(window_state *w)
{
    const view_job *job = w->job;
    view_state *s = &w->state;
    view_state_clear(s);
    copy_vector(s->eye, job->view.eye);
    copy_vector(s->target, job->view.target);
    s->fov = job->view.fov;
    s->exposure = job->view.exposure;
    memcpy(s->sun, job->sun, sizeof s->sun);
    memcpy(s->sun_irradiance, job->light.sun_irradiance, sizeof s->sun_irradiance);
    s->sky = job->light.sky;
    memcpy(s->sky_radiance, job->light.sky_radiance, sizeof s->sky_radiance);
    memcpy(&s->course, &job->course, sizeof s->course);
    s->time = job->time;
    s->method = (int)job->options.method;
    s->other_method = s->method == SHAPE_GL_EXACT ? SHAPE_GL_DEFAULT : SHAPE_GL_EXACT;
    s->samples = job->samples;
    s->light_grid = job->options.light.resolution;
    s->divider = 0.5f;
    view_state_take_set(s, job->set, &job->generator);
    memcpy(&w->base, s, sizeof *s);
    memcpy(&w->asked, s, sizeof *s);
}

static size_t count_primitives(const shape_set *set)
{
    size_t count = 0;
    for (size_t i = 0; i < set->cloud_count; i++)
        count += shape_primitives_count(shape_set_list_const(set, i));
    return count;
}

static shape_status take_set(window_state *w, shape_set *set, shape_error *error)
{
    view_shared *shared = view_shared_make(set);
    if (!shared)
        return shape_error_memory(error);
    view_shared_drop(w->set);
    w->set = shared;
    w->set_number++;
    w->primitives = count_primitives(set);
    return SHAPE_OK;
}

static void say(window_state *w, const char *text)
{
    snprintf(w->said, sizeof w->said, "%s", text);
    w->said_until = glfwGetTime() + 4;
}

/* What the watching thread has read. */
static void hear_news(window_state *w)
{
    view_news news;
    shape_error error;
    if (!w->watch || !view_watch_take(w->watch, &news))
        return;
    memcpy(w->error, news.text, sizeof w->error);
    if (!news.contents.set)
        return;
    view_state next;
    memcpy(&next, &w->base, sizeof next);
    view_state_take_set(&next, news.contents.set, &news.contents.used);
    view_state_merge(&w->state, &w->base, &next);
    view_history_merge(w->history, &w->base, &next);
    memcpy(w->base.clouds, next.clouds, sizeof next.clouds);
    w->base.cloud_count = next.cloud_count;
    w->read_ms = news.milliseconds;
    w->saved_ms = news.saved;
    w->reload_ask = w->asks + 1;
    if (take_set(w, news.contents.set, &error))
        snprintf(w->error, sizeof w->error, "%s", error.text);
}

static void make_command(const window_state *w, const int size[2], bool alpha, char *text, size_t room)
{
    const view_command command = {.path = w->job->path,
                                  .morph = w->job->morph_path,
                                  .opening = w->job->opening,
                                  .grammar = w->job->grammar,
                                  .alpha = alpha,
                                  .paper_lod = w->job->options.paper_lod,
                                  .volume = w->job->volume_file,
                                  .scene = w->job->scene,
                                  .size = {size[0], size[1]},
                                  .seed = w->job->options.seed};
    view_command_write(&w->state, &w->base, &command, text, room);
}

/* A name that is not taken yet, in the folder that the viewer was started in. */
static void take_screenshot(window_state *w, const view_panel_wish *wish)
{
    char name[SHAPE_NAME_MAX + 1], path[SHAPE_NAME_MAX + 32], command[8192];
    cli_bare_name(w->job->path, "cloud", name);
    for (int i = 1; i < 10000; i++) {
        snprintf(path, sizeof path, "%s-%04d.png", name, i);
        if (access(path, F_OK))
            break;
    }
    int size[2] = {wish->shoot_size[0], wish->shoot_size[1]};
    if (size[0] < 1 || size[1] < 1)
        glfwGetFramebufferSize(w->window, &size[0], &size[1]);
    make_command(w, size, wish->shoot_alpha, command, sizeof command);
    view_renderer_shoot(w->renderer, path, size[0], size[1], wish->shoot_alpha, command);
}

static void obey(window_state *w, const view_panel_wish *wish)
{
    if (w->undo || wish->undo || w->redo || wish->redo)
        view_history_keep(w->history, &w->state); /* a change of this very moment can be undone too */
    if (w->undo || wish->undo)
        if (!view_history_undo(w->history, &w->state))
            say(w, "nothing to undo");
    if (w->redo || wish->redo)
        if (!view_history_redo(w->history, &w->state))
            say(w, "nothing to redo");
    if (w->home || wish->home)
        w->camera = w->start;
    if (wish->play)
        w->playing = !w->playing;
    if (w->shoot || wish->shoot)
        take_screenshot(w, wish);
    if (w->copy || wish->copy) {
        char command[8192];
        int size[2];
        glfwGetFramebufferSize(w->window, &size[0], &size[1]);
        make_command(w, size, false, command, sizeof command);
        glfwSetClipboardString(w->window, command);
        fputs(command, stderr);
        say(w, "copied, and written to standard error");
    }
    w->undo = w->redo = w->home = w->shoot = w->copy = false;
}

/* Asks for another cloud where the grammar's settings are not those that were asked for. */
static void ask_generator(window_state *w)
{
    const view_generator *is = &w->state.generator, *was = &w->asked.generator;
    bool other = is->seed != was->seed || is->own_iterations != was->own_iterations ||
                 is->own_angle != was->own_angle ||
                 (is->own_iterations && is->iterations != was->iterations) ||
                 (is->own_angle && memcmp(is->angle, was->angle, sizeof is->angle));
    if (other && w->watch && w->job->grammar)
        view_watch_ask(w->watch, is);
}

/* Asks for a picture where anything is other than when one was asked for last. */
static void ask_picture(window_state *w)
{
    int width, height;
    glfwGetFramebufferSize(w->window, &width, &height);
    if (width < 1 || height < 1)
        return; /* minimised */
    bool same = w->asked_number == w->set_number && w->asked_size[0] == width && w->asked_size[1] == height &&
                !memcmp(&w->asked, &w->state, sizeof w->state);
    if (same)
        return;
    ask_generator(w);
    static view_request request;
    memcpy(&request.state, &w->state, sizeof request.state);
    request.width = width;
    request.height = height;
    request.number = ++w->asks;
    view_renderer_ask(w->renderer, &request, w->set);
    memcpy(&w->asked, &w->state, sizeof w->state);
    w->asked_size[0] = width;
    w->asked_size[1] = height;
    w->picture.done = false;
    w->asked_number = w->set_number;
}

/* --- a frame --- */

static void look_at_picture(window_state *w)
{
    view_picture picture;
    view_renderer_look(w->renderer, &picture);
    view_shared_drop(w->placed);
    w->placed = picture.placed;
    if (picture.number != w->picture.number) {
        memmove(w->times, w->times + 1, (VIEW_TIMES - 1) * sizeof *w->times);
        w->times[VIEW_TIMES - 1] = (float)picture.draw_ms;
    }
    if (w->saved_ms > 0 && picture.request >= w->reload_ask) {
        char text[128];
        snprintf(text, sizeof text, "read again, shown after %.0f ms", now_ms() - w->saved_ms);
        cli_say("%s: %s", w->job->title, text);
        say(w, text);
        w->saved_ms = 0;
    }
    if (strcmp(picture.text, w->picture.text) && !picture.text_is_error)
        say(w, picture.text);
    w->picture = picture;
}

static void show_title(window_state *w)
{
    char title[512];
    bool busy = !w->picture.done || (w->watch && view_watch_is_busy(w->watch));
    snprintf(title, sizeof title, "%.440s - neph-view%s", w->job->title, busy ? " [working]" : "");
    if (strcmp(title, w->title))
        glfwSetWindowTitle(w->window, title);
    memcpy(w->title, title, sizeof title);
}

static void draw(window_state *w)
{
    int width, height;
    glfwGetFramebufferSize(w->window, &width, &height);
    if (width < 1 || height < 1)
        return;
    if (glfwGetTime() > w->said_until)
        w->said[0] = 0;
    const view_picture *p = &w->picture;
    const view_panel_input input = {
        .state = &w->state,
        .base = &w->base,
        .texture = p->texture,
        .title = w->job->title,
        .doing = p->doing,
        .error = w->error[0]        ? w->error
                 : p->text_is_error ? p->text
                                    : "",
        .said = w->said,
        .samples = p->samples,
        .draw_ms = p->draw_ms,
        .light_ms = p->costs.light_ms,
        .bake_ms = p->costs.bake_ms,
        .volume_ms = p->volume_ms,
        .read_ms = w->read_ms,
        .primitives = w->primitives,
        .all_clouds = view_shared_set(w->set)->cloud_count,
        .times = w->times,
        .grammar = w->job->grammar,
        .watched = w->watch != NULL,
        .open = w->open,
        .help = w->help,
        .playing = w->playing,
        .placed = w->placed ? view_shared_set(w->placed) : NULL,
    };
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, width, height);
    glClearColor(0.3f, 0.4f, 0.55f, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    view_panel_wish wish = view_panel_draw(&input);
    settle_camera(w, true);
    obey(w, &wish);
    glfwSwapBuffers(w->window);
}

static void run(window_state *w)
{
    w->last = glfwGetTime();
    for (int left = 3; !glfwWindowShouldClose(w->window);) {
        /* ImGui wants a second frame and a third after an event; then there is nothing to draw until the next. */
        if (left > 0 || w->playing)
            glfwPollEvents();
        else
            glfwWaitEventsTimeout(0.5);
        left = left > 0 ? left - 1 : 2;
        double time = glfwGetTime(), passed = time - w->last;
        w->last = time;
        if (fly(w, passed))
            left = 3;
        if (w->playing)
            w->state.time += fmin(passed, 0.25);
        hear_news(w);
        look_at_picture(w);
        settle_camera(w, false);
        draw(w);
        settle_camera(w, false);
        ask_picture(w);
        show_title(w);
        if (!view_panel_is_busy() && !w->dragging && !w->looking && !w->splitting && !w->playing)
            view_history_keep(w->history, &w->state);
    }
}

/* --- the beginning and the end --- */

static void make_current(void *context, bool current)
{
    glfwMakeContextCurrent(current ? context : NULL);
}

static void wake(void)
{
    glfwPostEmptyEvent();
}

static shape_status no_window(const char *what, shape_error *error)
{
    const char *why = NULL;
    glfwGetError(&why);
    return shape_error_set(error, SHAPE_ERROR_SYSTEM,
                           "%s: %s (write a picture with --headless -o cloud.png instead)", what,
                           why ? why : "no display");
}

static GLFWwindow *open_window(int width, int height, const char *title, GLFWwindow *share)
{
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_VISIBLE, share ? GLFW_FALSE : GLFW_TRUE);
    return glfwCreateWindow(width, height, title, NULL, share);
}

static void listen(window_state *w)
{
    glfwSetWindowUserPointer(w->window, w);
    glfwSetCursorPosCallback(w->window, on_move);
    glfwSetMouseButtonCallback(w->window, on_button);
    glfwSetScrollCallback(w->window, on_scroll);
    glfwSetKeyCallback(w->window, on_key);
    glfwGetCursorPos(w->window, &w->mouse_x, &w->mouse_y);
}

static shape_status start_threads(window_state *w, GLFWwindow *hidden, shape_error *error)
{
    const view_job *job = w->job;
    shape_set *copy = shape_set_create(error);
    if (!copy)
        return SHAPE_ERROR_MEMORY;
    shape_status status = shape_set_append(copy, job->set, error);
    if (status) {
        shape_set_destroy(copy);
        return status;
    }
    status = take_set(w, copy, error);
    if (status)
        return status;
    const view_render_start start = {job->options, job->morph, make_current, hidden, wake};
    w->renderer = view_renderer_start(&start, error);
    if (!w->renderer)
        return error->status;
    /* A morph's pairs are made once, of the file as it was opened; so is a scene. */
    if (strcmp(job->path, "-") && !job->morph && !job->scene) {
        w->watch = view_watch_start(job->path, &job->generator, wake, error);
        if (!w->watch)
            return error->status;
    }
    w->history = view_history_create(&w->state);
    return w->history ? SHAPE_OK : shape_error_memory(error);
}

static shape_status show(window_state *w, shape_error *error)
{
    GLFWwindow *hidden = open_window(16, 16, "", w->window);
    if (!hidden)
        return no_window("no second OpenGL context", error);
    glfwMakeContextCurrent(w->window);
    glfwSwapInterval(1);
    listen(w);
    view_panel_start(w->window);
    int width, height;
    glfwGetWindowSize(w->window, &width, &height);
    w->open = width >= PANEL_WIDTH;
    shape_status status = start_threads(w, hidden, error);
    if (!status)
        run(w);
    view_watch_stop(w->watch);
    view_renderer_stop(w->renderer);
    view_history_destroy(w->history);
    view_shared_drop(w->set);
    view_shared_drop(w->placed);
    view_panel_stop();
    glfwDestroyWindow(hidden);
    return status;
}

shape_status view_window(view_job *job, shape_error *error)
{
    if (!glfwInit())
        return no_window("no window", error);
    window_state *w = calloc(1, sizeof *w);
    if (!w) {
        glfwTerminate();
        return shape_error_memory(error);
    }
    shape_dvec3 min = {-1, -1, -1}, max = {1, 1, 1};
    shape_set_bounds(job->set, &min, &max);
    w->job = job;
    w->picture.doing = "";
    begin_state(w);
    w->camera = w->start = view_camera_start(&job->view, min, max);
    snprintf(w->title, sizeof w->title, "%.440s - neph-view [working]", job->title);
    w->window = open_window(job->view.width, job->view.height, w->title, NULL);
    shape_status status = w->window ? show(w, error) : no_window("no window with OpenGL 3.3", error);
    if (w->window)
        glfwDestroyWindow(w->window);
    /* A saved scene looks as the window did. */
    job->view = view_state_view(&w->state, job->view.width, job->view.height);
    job->light = view_state_light(&w->state);
    free(w);
    glfwTerminate();
    return status;
}
