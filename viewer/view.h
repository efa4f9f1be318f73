/* Between the files of neph-view. */
#ifndef NEPHELE_VIEW_H
#define NEPHELE_VIEW_H

#include "shape_gl.h"

/* What the command line asked for. */
typedef struct view_job {
    const shape_set *set;
    shape_volume *volume;
    shape_view view;
    shape_light light;
    shape_gl_options options;
    const char *title;
    const char *output; /* a picture's path, or "-" */
    int samples;        /* of a picture without a window, and of a window at rest */
    double load_ms;
} view_job;

/* window.c: opens the window and stays until it is closed. Errors: SHAPE_ERROR_SYSTEM where there is no display. */
shape_status view_window(view_job *job, shape_error *error);

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
