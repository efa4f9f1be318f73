/* Between the files of the window. */
#ifndef NEPHELE_WINDOW_PRIVATE_H
#define NEPHELE_WINDOW_PRIVATE_H

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "panel.h"
#include "reference.h"
#include "render.h"
#include "setting.h"
#include "view.h"
#include "watch.h"

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
    view_watch *watch, *other_watch; /* other: the file of the right half */
    view_shared *set, *other_set, *placed;
    view_things *things;
    shape_scene
        scene_was; /* what the scene's file said last of light and camera; its pointers are not looked at */
    char other_path[VIEW_PATH_MAX]; /* empty: there is none */
    uint64_t set_number, asked_number, asks,
        reload_ask;  /* reload_ask: the first request for a file read again; 0 */
    double saved_ms; /* when that file was saved; 0: it has been shown */
    view_picture picture;
    char error[4096], other_error[4096], said[640], title[512];
    float times[VIEW_TIMES];
    double read_ms, last, said_until;
    bool open, help, playing, undo, redo, home, shoot, copy, ask_anew;
    size_t primitives;
    view_reference *reference; /* NULL until the difference is wanted */
    view_difference difference;
    uint64_t compared;  /* the content of the picture that is compared; 0: none */
    unsigned map;       /* the difference as a texture */
    void (*wake)(void); /* for threads with news */
} window_state;

/* --- window_scene.c: a scene that is read again --- */

/* Takes over what the file says otherwise than it did: light and camera. */
void window_take_scene(window_state *w, const shape_scene *scene);

/* --- window_input.c: keys and the mouse --- */

void window_listen(window_state *w);
/* Held keys move the camera by the time that has passed; returns whether any is held. */
bool window_fly(window_state *w, double seconds);

/* --- window_files.c: the opened files, and what is written --- */

/* Takes the set over. */
shape_status window_take_set(window_state *w, shape_set *set, shape_error *error);
/* Begins to show another file in the right half; "": none. It is read on a thread, and appears when it has been. */
void window_open_other(window_state *w, const char *path);
/* Shows a set in the right half, which it takes over. */
shape_status window_take_other(window_state *w, shape_set *set, shape_error *error);
/* What the watching threads have read. */
void window_hear_news(window_state *w);
/* Asks for another cloud where the generator's settings are not those that were asked for. */
void window_ask_generator(window_state *w);
/* The commands that make what is seen. */
void window_make_command(const window_state *w, const int size[2], bool alpha, char *text, size_t room);
void window_take_screenshot(window_state *w, const view_panel_wish *wish);

/* --- window_difference.c --- */

/* Compares the picture with the reference where that is wanted and the picture is done; begins anew where it changes. */
void window_compare(window_state *w);
/* What is to be said of it, into a text; empty where nothing is. */
void window_describe_difference(const window_state *w, char *text, size_t room);
void window_stop_comparing(window_state *w);

/* --- window.c --- */

/* Shows a line for a moment. */
void window_say(window_state *w, const char *text);

#endif
