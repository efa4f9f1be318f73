/* Between the files of neph-view. */
#ifndef NEPHELE_VIEW_H
#define NEPHELE_VIEW_H

#include "cli_scene.h"
#include "moment.h"
#include "shape/image.h"
#include "shape_gl.h"
#include "source.h"
#include "state.h"

/* What the command line asked for. */
typedef struct view_job {
    const shape_set *set;          /* at rest */
    const shape_set *other_set;    /* of a second file, right of the divider; NULL */
    float divider;                 /* a share of the width */
    const shape_morph *morph;      /* NULL: none */
    shape_opaque *opaque;          /* what is opaque; NULL where nothing is */
    view_more_things more;         /* of what is opaque, that of the command line, for reading it again */
    const shape_scene *scene_read; /* NULL */
    shape_set *moved;              /* as it is at the time that is drawn */
    shape_volume *volume;          /* of moved */
    shape_view view;               /* at time 0 */
    shape_light light;             /* at time 0 */
    view_course course;
    double time; /* of a picture without a window [s] */
    shape_gl_options options;
    const char *path, *title, *morph_path; /* morph_path: NULL where nothing turns into anything */
    const char *other_path;                /* NULL */
    bool other_watched;                    /* it is a file that can be watched */
    view_generator generator;              /* what makes the first file's cloud */
    view_state *state;                     /* what a window begins with, but for the clouds */
    char opening[1024];                    /* options that belong to the file, as they were given */
    char things[4096];                     /* --mesh and --ground, as they were given */
    char chosen[192];                      /* what --error chose; empty */
    bool scene, alpha;
    bool volume_file; /* a .vdb or raw floats: nothing edits it */
    int samples;      /* of a picture without a window, and of a window at rest */
    int largest;      /* side of what is drawn at once; 0: what the GPU can */
    double load_ms;
    uint64_t seed; /* as given */
} view_job;

/* input.c: what the command line opens. */
typedef struct view_opened {
    cli_input input;     /* freed by cli_input_free */
    view_generator used; /* what made it */
    bool scene;
    bool volume; /* a .vdb or raw floats */
} view_opened;

/* Reads a scene, a .neph, a grammar, a mesh or a volume; path "": what the generator makes. Mistakes end the program. */
view_opened view_open(const char *path, const view_generator *generator);
/* A .neph or a grammar alone. The caller destroys the set. */
shape_set *view_open_source(const char *path, const view_generator *generator);

/* window.c: the window. */
typedef struct view_window_calls {
    /* Reads the job's files, on a thread of its own while the window opens. Mistakes end the program, by cli_end. */
    void (*read)(void *context);
    void (*closed)(const view_job *job); /* with what the window showed last */
    void *context;                       /* of read */
} view_window_calls;

/* Opens the window and stays until it is closed; where that is before the files have been read, the program ends. The job
 * has its title and the size of the view; calls->read fills the rest. Errors: SHAPE_ERROR_SYSTEM where there is no display. */
shape_status view_window(view_job *job, const view_window_calls *calls, shape_error *error);

/* picture.c: pictures without a window. */

/* Makes job->moved and job->volume for a time; what was there before is destroyed. */
shape_status view_job_place(view_job *job, double time, shape_error *error);
void view_job_free(view_job *job);
/* What the renderer has drawn, of the view's size, as an image; with alpha where asked for. */
shape_status view_read_image(shape_gl_renderer *renderer, int width, int height, bool alpha,
                             shape_image **image, shape_error *error);
/* How a picture is drawn. */
typedef struct view_plan {
    int samples; /* a pixel */
    int largest; /* side of what is drawn at once [pixels]; 0: what the GPU can */
    bool alpha;
    void (*progress)(const char *what, double done); /* NULL: none */
    bool (*go_on)(void *context, double done);       /* false ends the work: SHAPE_ERROR_LIMIT; NULL: go on */
    void *context;
} view_plan;

/* Draws all samples of a picture, in parts where it is larger than the plan's largest. The caller destroys *image. */
shape_status view_draw_image(shape_gl_renderer *renderer, const shape_view *view, const view_plan *plan,
                             shape_image **image, shape_error *error);
/* The same, encoded in the format that the output's name asks for. */
shape_status view_encode_drawn(shape_gl_renderer *renderer, const shape_view *view, const view_plan *plan,
                               const char *output, unsigned char **bytes, size_t *size, shape_error *error);
/* Encodes what the renderer has drawn, in the format that the output's name asks for. */
shape_status view_encode(shape_gl_renderer *renderer, const shape_view *view, bool alpha, const char *output,
                         unsigned char **bytes, size_t *size, shape_error *error);

/* The same of two files: the job's clouds left of the divider, its other ones, where they are at the job's time, right of
 * it. Draws both; an OpenGL context is current. */
shape_status view_encode_split(const view_job *job, const shape_view *view, const shape_light *light,
                               const char *output, unsigned char **bytes, size_t *size, shape_error *error);

/* within.c: a picture to an allowed error. */
typedef struct view_quality {
    int light_cells; /* along the longest side of a cloud's light grid */
    size_t voxels;   /* of all baked grids, at most */
    int samples;     /* a pixel */
} view_quality;

/* Draws coarse first, then finer, until the last step changed the picture by no more than `allowed` (square root of the
 * relative MSE, shape/imageerror.h), or there is no finer one; *change says by how much it did. What light grids are off
 * by however fine they are is not in it. The caller destroys *renderer, which holds the picture. */
shape_status view_draw_within(const view_job *job, const shape_view *view, const shape_light *light,
                              double allowed, shape_gl_renderer **renderer, view_quality *chosen,
                              double *change, shape_error *error);

/* frames.c: a sequence of pictures. */
typedef struct view_frames {
    int64_t first, last;
    double fps;
    bool overwrite;
    const char *output; /* has one %d, or %0Nd, for the number */
} view_frames;

/* Whether the output's name has one number's place and nothing else that printf would take. */
shape_status view_frames_check(const view_frames *frames, shape_error *error);
/* Draws the frames that are not there yet, each by itself. */
shape_status view_frames_draw(view_job *job, const view_frames *frames, shape_error *error);

/* bench.c: a moving view, measured. */
typedef struct view_bench {
    int frames;
    bool flight;             /* straight on through the target, rather than round it */
    const char *method;      /* its name */
    const char *frames_file; /* a row a frame is written there (CSV); NULL: none */
    double started;          /* when the program began to be loaded, by view_now_ms */
    double libraries_ms,
        context_ms; /* of what comes before the first picture: loading the program and its libraries, starting
                                        OpenGL (while the clouds are placed, lit and baked) */
} view_bench;

double view_now_ms(void);
/* Of all threads together since the program began to be loaded; unlike the clock on the wall, hardly changed by what else
 * runs on the machine. */
double view_processor_ms(void);
/* Draws job->view's frames, each to its end, and prints their times as JSON (docs/benchmarks.md). *view gets the last one's;
 * the renderer holds its picture. */
shape_status view_bench_run(const view_job *job, shape_gl_renderer *renderer, const view_bench *plan,
                            shape_view *view, shape_error *error);

/* camera.c: the orbit and fly camera. Angles in radians; the view it writes is what renderers take. */
typedef struct view_camera {
    shape_dvec3 eye, target;
    double yaw, pitch; /* of the direction in which the eye looks: yaw from +z towards +x, pitch up */
    double size;       /* metres: the half diagonal of what is shown; speeds are shares of it */
} view_camera;

view_camera view_camera_start(const shape_view *view, shape_dvec3 min, shape_dvec3 max);
/* Turns about the target, keeping the distance; pitch stays short of straight up and down. */
void view_camera_orbit(view_camera *camera, double yaw, double pitch);
/* Turns the eye where it stands. */
void view_camera_look(view_camera *camera, double yaw, double pitch);
/* Moves the eye nearer to the target by a factor (0.9: a tenth nearer); close to it the target moves along, so that
 * one comes through. */
void view_camera_dolly(view_camera *camera, double factor);
/* Moves eye and target by metres to the right, up and ahead of the view. */
void view_camera_fly(view_camera *camera, double right, double up, double ahead);
void view_camera_apply(const view_camera *camera, shape_view *view);

#endif
