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
#include "window_pulse.h"

typedef struct window_state {
    GLFWwindow *window, *hidden; /* hidden: has the drawing thread's context */
    view_job *job;
    const view_window_calls *calls;
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
    const shape_scene *scene; /* as its file said it last; NULL: there is none */
    shape_scene *own_scene;   /* that, where it was read by the window */
    view_watch *opening;      /* a file that is to take the place of the first; NULL: none */
    char opening_path[VIEW_PATH_MAX], own_path[VIEW_PATH_MAX], dropped[VIEW_PATH_MAX];
    char other_path[VIEW_PATH_MAX]; /* empty: there is none */
    uint64_t set_number, asked_number, asks,
        reload_ask;    /* reload_ask: the first request for a file read again; 0 */
    double saved_work; /* what threads had worked by then [ms] */
    double saved_ms;   /* when that file was saved; 0: it has been shown */
    view_picture picture;
    char error[4096], other_error[4096], said[640], title[512];
    float times[VIEW_PASSES][VIEW_TIMES];
    double read_ms, last, said_until;
    bool open, help, playing, undo, redo, home, shoot, copy, save, escape;
    window_pulse pulse;
    double asked_at; /* when a picture was asked for last [s] */
    bool panel_started;
    size_t primitives;
    view_reference *reference; /* NULL until the difference is wanted */
    view_difference difference;
    uint64_t compared;  /* the content of the picture that is compared; 0: none */
    unsigned map;       /* the difference as a texture */
    void (*wake)(void); /* for threads with news */
} window_state;

/* --- window_begin.c: the first files --- */

/* Has them read by w->calls, and shows the window with a bar where that takes long. Returns the exit code where they have
 * mistakes, which have been said, or 0. Ends the program where the window is closed before they have been read. */
int window_read_files(window_state *w);

/* --- window_scene.c: a scene that is read again --- */

/* Takes over what the file says otherwise than it did: light, camera and view. Takes the scene over. */
void window_take_scene(window_state *w, shape_scene *scene);
/* Writes a scene file of what is seen, into the folder that the viewer was started in; path "": by a name that is free. */
void window_save_scene(window_state *w, const char *path);
/* The scene of what is seen, for a file at target; the caller frees it. NULL, and *error, where a scene cannot hold it. */
char *window_scene_text(window_state *w, const char *target, const int size[2], size_t *length,
                        shape_error *error);

/* --- window_open.c: another file in the place of the first --- */

/* Begins to read a file; what is shown stays until it has been read. */
void window_open_file(window_state *w, const char *path);
/* Shows it when it has been read. */
void window_hear_opening(window_state *w);

/* --- window_work.c: work that takes long --- */

/* What is under way, for longer than a moment, and how far it is (below 0: not known); NULL: nothing. */
const char *window_work(window_state *w, double *done);
/* Whether that can be broken off. */
bool window_work_ends(window_state *w);
/* Breaks it off; false where there is nothing to break off. */
bool window_break_off(window_state *w);

/* --- window_input.c: keys and the mouse --- */

void window_listen(window_state *w);
/* Held keys move the camera by the time that has passed; returns whether any is held. */
bool window_fly(window_state *w, double seconds);

/* --- window_sets.c: the clouds that are shown --- */

/* Takes the set over. */
shape_status window_take_set(window_state *w, shape_set *set, shape_error *error);
/* Begins to show another file in the right half; "": none. It is read on a thread, and appears when it has been. */
void window_open_other(window_state *w, const char *path);
/* Shows a set in the right half, which it takes over. */
shape_status window_take_other(window_state *w, shape_set *set, shape_error *error);

/* --- window_files.c: the opened files, and what is written --- */

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

/* --- window_shared.c --- */

/* Clears what is shown, of so many pixels. */
void window_clear(int width, int height);
/* Shows a line for a moment. */
void window_say(window_state *w, const char *text);
/* A name that is not taken yet, "name-0001.suffix", in the folder that the viewer was started in. */
void window_free_name(const window_state *w, const char *suffix, char *path, size_t room);

#endif
