/* panel.cpp, panel_overlay.cpp: what lies over the picture: the panel, the help, messages, wires. All of Dear ImGui is behind
 * this header.
 * overlay.c: the wires. */
#ifndef NEPHELE_VIEW_PANEL_H
#define NEPHELE_VIEW_PANEL_H

#include "state.h"

#ifdef __cplusplus
extern "C" {
#endif

struct GLFWwindow;

/* What a picture's time goes to: making its clouds, their light, their baked density, drawing. */
typedef enum view_pass {
    VIEW_PASS_SET,
    VIEW_PASS_LIGHT,
    VIEW_PASS_BAKE,
    VIEW_PASS_DRAW,
    VIEW_PASSES
} view_pass;
enum { VIEW_TIMES = 120 };

/* What a frame shows. */
typedef struct view_panel_input {
    view_state *state;                        /* changed by the panel */
    const view_state *base;                   /* what a value is put back to */
    unsigned texture;                         /* the picture; 0: none yet */
    const char *title, *doing, *error, *said; /* texts, empty where there is nothing to say */
    const char *difference;                   /* what is said of the difference from the reference */
    unsigned map;                             /* of the difference; 0: none */
    int map_size[2], map_scale;               /* its pixels; those of the picture that one of them covers */
    const char *other;                        /* the file of the right half; empty: the same */
    int samples;                              /* drawn so far */
    double draw_ms, light_ms, bake_ms, volume_ms, read_ms;
    double steps, fetches; /* a pixel, of the picture */
    size_t primitives, all_clouds;
    const float (*times)[VIEW_TIMES]; /* VIEW_PASSES of them, of the last pictures [ms], the oldest first */
    const char *work;                 /* what is under way for longer than a moment; NULL: nothing */
    const char *chosen;               /* what --error chose; empty where it was not given */
    double work_done;                 /* its share that is done; below 0: not known */
    bool work_ends;                   /* it can be broken off */
    double longest_ms;                /* the longest frame of the window so far */
    bool watched, open, help, playing;
    const shape_set *placed; /* for the wires; NULL */
} view_panel_input;

/* What was wished in a frame. */
typedef struct view_panel_wish {
    bool undo, redo, home, copy, play;
    bool shoot, shoot_alpha, shoot_exr;
    bool save, open_file, cancel; /* a scene to file, or a file to show; what is under way to break off */
    char file[VIEW_PATH_MAX];     /* empty: a name of its own */
    int shoot_size[2];
    bool open_other;
    char other[VIEW_PATH_MAX]; /* what to show in the right half; empty: the same file */
} view_panel_wish;

/* After the window's own callbacks have been set: ImGui calls them on. */
void view_panel_start(struct GLFWwindow *window);
void view_panel_stop(void);
/* Draws the picture and all that lies over it into the current framebuffer. */
view_panel_wish view_panel_draw(const view_panel_input *input);
/* Whether a point [window coordinates] is the panel's, by what was drawn last; and whether a text field has the keys. */
bool view_panel_covers(double x, double y);
bool view_panel_has_keys(void);
/* Whether a slider is held, so that the state is not worth keeping yet. */
bool view_panel_is_busy(void);

/* --- overlay.c --- */

/* Wires on the screen, in window coordinates, x right, y down. */
typedef struct view_wires {
    float (*lines)[4]; /* x0, y0, x1, y1; freed by view_wires_free */
    size_t count, capacity;
} view_wires;

/* Boxes of the clouds, or three circles of each primitive (at most 3,000 of them), as the state's eye sees them. Lines
 * are added; what is behind the eye is left out. Stops where memory is out. */
void view_wires_boxes(view_wires *wires, const view_state *state, const shape_set *set, float width,
                      float height);
void view_wires_primitives(view_wires *wires, const view_state *state, const shape_set *set, float width,
                           float height);
void view_wires_free(view_wires *wires);

/* --- overlay_shaded.c --- */

typedef struct view_corner {
    float at[2];     /* window coordinates */
    unsigned colour; /* red in the lowest byte, then green, blue, opacity */
} view_corner;

/* Ellipsoids on the screen, far ones first, of view_solid_corners() corners each. */
typedef struct view_solids {
    view_corner *corners;
    size_t count; /* ellipsoids */
} view_solids;

/* The first 3,000 primitives as the state's eye sees them under its sun, those that lie before the eye. Empty where memory
 * is out; freed by view_solids_free. */
void view_solids_make(view_solids *solids, const view_state *state, const shape_set *set, float width,
                      float height);
void view_solids_free(view_solids *solids);
int view_solid_corners(void);
enum { VIEW_SOLID_TRIANGLES = 128 };
/* The triangles of each, by the numbers of its corners; returns how many there are, at most VIEW_SOLID_TRIANGLES. */
int view_solid_triangles(int (*triangles)[3]);

#ifdef __cplusplus
}
#endif
#endif
