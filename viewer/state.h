/* state.c: all that can be set in the window, as one plain struct: the panel changes it, the renderer draws it, undo keeps
 * copies of it, and a scene or a command line can be written from it. */
#ifndef NEPHELE_VIEW_STATE_H
#define NEPHELE_VIEW_STATE_H

#include "moment.h"
#include "shape/set.h"
#include "source.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { VIEW_CLOUDS_MAX = 64 }; /* clouds that can be changed; further ones are shown as they are */

/* What can be changed of one cloud. */
typedef struct view_cloud {
    char name[SHAPE_NAME_MAX + 1];
    shape_field field;
    shape_medium medium;
    double move[3], turn[3],
        scale;        /* metres; degrees about x, then y, then z; a factor. About the frame's origin */
    double origin[3]; /* of the file's frame [m] */
    bool visible;
} view_cloud;

typedef enum view_heat {
    VIEW_HEAT_NONE,
    VIEW_HEAT_STEPS,
    VIEW_HEAT_FETCHES,
    VIEW_HEAT_CANDIDATES,
    VIEW_HEAT_DEPTH,
    VIEW_HEATS
} view_heat;
#define VIEW_HEAT_WORDS "none|steps|fetches|candidates|depth"

/* How primitives are shown over the picture. */
typedef enum view_outline {
    VIEW_OUTLINE_NONE,
    VIEW_OUTLINE_WIRES,
    VIEW_OUTLINE_SHADED,
    VIEW_OUTLINES
} view_outline;
#define VIEW_OUTLINE_WORDS "none|wires|shaded"

/* By what the clouds are lit (shape_gl.h: shape_gl_lighting). No gaps, since states are compared as bytes. */
typedef struct view_lighting {
    int law; /* shape_gl_law */
    int octaves;
    double powder, ambient[3], emission[3];
} view_lighting;
#define VIEW_LAW_WORDS "grid|single|powder|powder-angle|beer-max|octaves"

typedef struct view_state {
    double eye[3], target[3]; /* metres; the camera is no part of undo */
    double fov;               /* degrees, vertical */
    float exposure;           /* stops */
    double sun[2];            /* azimuth and height, degrees; unless the day runs */
    float sun_irradiance[3];  /* before the air's share where the day runs */
    shape_sky_kind sky;
    float sky_radiance[3];
    shape_air air;
    view_lighting lighting;
    view_course course;
    double time;              /* seconds */
    int method, other_method; /* shape_gl_method; the second for the right half of a split picture */
    int samples, light_grid;
    bool split, boxes;
    float divider;   /* of the split picture, a share of the width */
    int heat;        /* view_heat */
    int outlines;    /* view_outline: the primitives */
    bool difference; /* from the reference, as a map */
    view_generator generator;
    int cloud_count; /* of clouds */
    view_cloud clouds[VIEW_CLOUDS_MAX];
} view_state;

/* Zeroes what lies between the members too, so that states can be compared as bytes; copy them by memcpy. */
void view_state_clear(view_state *state);
/* Takes the clouds of a set as they are, and a grammar's settings. */
void view_state_take_set(view_state *state, const shape_set *set, const view_generator *used);
/* The same for a set that takes the place of another whose state is `base`: what was changed since then stays. */
void view_state_merge(view_state *state, const view_state *base, const view_state *next);

shape_view view_state_view(const view_state *state, int width, int height);
/* At the state's time. */
shape_light view_state_light(const view_state *state);
/* The set as the state changes it, at the state's time. The caller destroys it. */
shape_status view_state_set(const view_state *state, const shape_set *set, const shape_morph *morph,
                            shape_set **made, shape_error *error);

/* Whether two states show the same clouds (but for the time), and light them alike: by the same sun, sky and law. */
bool view_state_same_clouds(const view_state *a, const view_state *b);
bool view_state_same_light(const view_state *a, const view_state *b);

/* --- knobs: the numbers that the panel shows as sliders, and the options that stand for them --- */

typedef enum view_knob_kind { VIEW_KNOB_FLOAT, VIEW_KNOB_DOUBLE, VIEW_KNOB_INT } view_knob_kind;
typedef enum view_knob_of { VIEW_OF_STATE, VIEW_OF_FIELD, VIEW_OF_MEDIUM, VIEW_OF_CLOUD } view_knob_of;

typedef struct view_knob {
    const char *group, *name, *unit, *option; /* option: of the command line, or NULL */
    view_knob_of of;
    size_t offset;
    view_knob_kind kind;
    double min, max; /* a typed value may be no other either */
    bool logarithmic;
    const char *help;
} view_knob;

extern const view_knob view_knobs[];
extern const size_t view_knob_count;

/* The number that a knob turns, in a state; cloud: which one, for those of clouds. */
void *view_knob_value(const view_knob *knob, view_state *state, int cloud);
double view_knob_get(const view_knob *knob, const view_state *state, int cloud);
void view_knob_set(const view_knob *knob, view_state *state, int cloud, double value);

/* --- undo --- */

typedef struct view_history view_history;
/* Both start with the state given. NULL where memory is out. */
view_history *view_history_create(const view_state *state);
void view_history_destroy(view_history *history);
/* Keeps a state if it differs from the last one in more than the camera. */
void view_history_keep(view_history *history, const view_state *state);
/* Goes back or on by one; false at an end. The camera stays. */
bool view_history_undo(view_history *history, view_state *state);
bool view_history_redo(view_history *history, view_state *state);
/* Merges all states that are kept; see view_state_merge. */
void view_history_merge(view_history *history, const view_state *base, const view_state *next);

/* --- command.c: the commands that make what is seen --- */

typedef struct view_command {
    const char *path;    /* the opened file; "" where a generator takes none */
    const char *morph;   /* the one that it turns into, or NULL */
    const char *opening; /* options to open it with, or "" */
    const char *things;  /* --mesh and --ground, or "" */
    bool alpha, paper_lod;
    bool volume; /* the file is one that neph-edit does not take */
    bool scene;  /* the file has light of its own */
    int size[2];
    uint64_t seed; /* of the rays' starts */
} view_command;

/* Writes "neph-lsys ..." or "neph-edit ...", then "neph-view ...", a command a line, with the options that differ from
 * the start. Cut at `room` bytes. */
void view_command_write(const view_state *state, const view_state *base, const view_command *command,
                        char *text, size_t room);

#ifdef __cplusplus
}
#endif
#endif
