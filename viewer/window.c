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

#include "shape/combine.h"
#include "window_private.h"

enum { PANEL_WIDTH = 700 }; /* a window narrower than this starts with the panel folded */

static double now_ms(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
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
    s->air = job->light.air;
    memcpy(&s->course, &job->course, sizeof s->course);
    s->time = job->time;
    s->method = (int)job->options.method;
    s->other_method = s->method == SHAPE_GL_EXACT ? SHAPE_GL_DEFAULT : SHAPE_GL_EXACT;
    s->samples = job->samples;
    s->light_grid = job->options.light.resolution;
    s->divider = job->divider;
    s->split = job->other_set != NULL;
    if (s->split)
        s->other_method = s->method;
    view_state_take_set(s, job->set, &job->generator);
    memcpy(&w->base, s, sizeof *s);
    memcpy(&w->asked, s, sizeof *s);
}

void window_say(window_state *w, const char *text)
{
    snprintf(w->said, sizeof w->said, "%s", text);
    w->said_until = glfwGetTime() + 4;
}

static void obey(window_state *w, const view_panel_wish *wish)
{
    if (w->undo || wish->undo || w->redo || wish->redo)
        view_history_keep(w->history, &w->state); /* a change of this very moment can be undone too */
    if (w->undo || wish->undo)
        if (!view_history_undo(w->history, &w->state))
            window_say(w, "nothing to undo");
    if (w->redo || wish->redo)
        if (!view_history_redo(w->history, &w->state))
            window_say(w, "nothing to redo");
    if (w->home || wish->home)
        w->camera = w->start;
    if (wish->open_other)
        window_open_other(w, wish->other);
    if (wish->play)
        w->playing = !w->playing;
    if (w->shoot || wish->shoot)
        window_take_screenshot(w, wish);
    if (w->copy || wish->copy) {
        char command[8192];
        int size[2];
        glfwGetFramebufferSize(w->window, &size[0], &size[1]);
        window_make_command(w, size, false, command, sizeof command);
        glfwSetClipboardString(w->window, command);
        fputs(command, stderr);
        window_say(w, "copied, and written to standard error");
    }
    w->undo = w->redo = w->home = w->shoot = w->copy = false;
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
    window_ask_generator(w);
    static view_request request;
    memcpy(&request.state, &w->state, sizeof request.state);
    request.width = width;
    request.height = height;
    request.number = ++w->asks;
    const view_shown shown = {w->set, w->other_set, w->things};
    view_renderer_ask(w->renderer, &request, &shown);
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
        window_say(w, text);
        w->saved_ms = 0;
    }
    if (strcmp(picture.text, w->picture.text) && !picture.text_is_error)
        window_say(w, picture.text);
    w->picture = picture;
}

static void show_title(window_state *w)
{
    char title[512];
    bool busy = !w->picture.done || (w->watch && view_watch_is_busy(w->watch)) ||
                (w->other_watch && view_watch_is_busy(w->other_watch));
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
    char difference[384];
    window_describe_difference(w, difference, sizeof difference);
    const view_panel_input input = {
        .state = &w->state,
        .base = &w->base,
        .texture = p->texture,
        .title = w->job->title,
        .doing = p->doing,
        .error = w->error[0]         ? w->error
                 : w->other_error[0] ? w->other_error
                 : p->text_is_error  ? p->text
                                     : "",
        .other = w->other_path,
        .difference = difference,
        .map = w->compared && w->difference.width ? w->map : 0,
        .map_size = {w->difference.width, w->difference.height},
        .map_scale = view_reference_scale(width, height),
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
        if (window_fly(w, passed))
            left = 3;
        if (w->playing)
            w->state.time += fmin(passed, 0.25);
        settle_camera(w, false);
        window_hear_news(w);
        settle_camera(w, true); /* a scene may have another eye now */
        look_at_picture(w);
        window_compare(w);
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

static shape_status copy_set(const shape_set *set, shape_set **made, shape_error *error)
{
    shape_set *copy = shape_set_create(error);
    if (!copy)
        return SHAPE_ERROR_MEMORY;
    shape_status status = shape_set_append(copy, set, error);
    if (status)
        shape_set_destroy(copy);
    else
        *made = copy;
    return status;
}

/* The second file of the command line. */
static shape_status start_other(window_state *w, shape_error *error)
{
    const view_job *job = w->job;
    shape_set *copy;
    shape_status status = copy_set(job->other_set, &copy, error);
    if (!status)
        status = window_take_other(w, copy, error);
    snprintf(w->other_path, sizeof w->other_path, "%s", job->other_path);
    if (!status && job->other_watched) {
        view_generator generator = view_generator_of_path(job->other_path, job->seed);
        w->other_watch = view_watch_start(job->other_path, &generator, NULL, wake, error);
        status = w->other_watch ? SHAPE_OK : error->status;
    }
    return status;
}

static shape_status start_threads(window_state *w, GLFWwindow *hidden, shape_error *error)
{
    const view_job *job = w->job;
    shape_set *copy;
    shape_status status = copy_set(job->set, &copy, error);
    if (!status)
        status = window_take_set(w, copy, error);
    if (!status && job->other_set)
        status = start_other(w, error);
    if (status)
        return status;
    const view_render_start start = {job->options, job->morph, make_current, hidden, wake, job->largest};
    w->renderer = view_renderer_start(&start, error);
    if (!w->renderer)
        return error->status;
    /* A morph's pairs are made once, of the file as it was opened; a volume is read once. */
    if (strcmp(job->path, "-") && !job->morph && !job->volume_file) {
        w->watch = view_watch_start(job->path, &job->generator, &job->more, wake, error);
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
    window_listen(w);
    view_panel_start(w->window);
    int width, height;
    glfwGetWindowSize(w->window, &width, &height);
    w->open = width >= PANEL_WIDTH;
    shape_status status = start_threads(w, hidden, error);
    if (!status)
        run(w);
    view_watch_stop(w->watch);
    view_watch_stop(w->other_watch);
    window_stop_comparing(w);
    view_renderer_stop(w->renderer);
    view_history_destroy(w->history);
    view_shared_drop(w->set);
    view_shared_drop(w->other_set);
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
    w->wake = wake;
    w->things = view_things_make(job->opaque);
    job->opaque = NULL; /* it goes with the last who looks at it */
    if (job->scene_read)
        w->scene_was = *job->scene_read;
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
    view_things_drop(w->things);
    free(w);
    glfwTerminate();
    return status;
}
