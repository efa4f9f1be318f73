/* Scenes drawn by chance from the whole parameter space; what each depends on is its number alone. For sweep.c and
 * sweep_gl.c. */
#ifndef RANDOM_SCENE_H
#define RANDOM_SCENE_H

#include "shape/grid.h"
#include "shape/opaque.h"
#include "shape/random.h"
#include "shape/view.h"
#include "shape/volume.h"

enum {
    SCENE_WIDTH = 8,
    SCENE_HEIGHT = 6,
    SCENE_PIXELS = SCENE_WIDTH * SCENE_HEIGHT
}; /* of a picture, at most */

typedef struct scene {
    long number;
    shape_random random;
    shape_set *set;
    shape_grid *grid; /* NULL but for a cloud of voxels */
    shape_volume *volume;
    shape_dvec3 low, high;
    double size; /* longest side of the box around all; 1 where there is nothing */
    shape_opaque *opaque;
    shape_light light;
    shape_view view;
} scene;

/* Clouds and things of scene `number`; scene_draw_light and _view set the rest, anew for each picture. */
void scene_open(scene *s, long number);
void scene_close(scene *s);
void scene_draw_light(scene *s);
void scene_draw_view(scene *s);
shape_dvec3 scene_point(scene *s); /* in the box */

/* Ends the program where something failed that must not. */
void scene_sure(const scene *s, shape_status status, const shape_error *error);

/* Numbers: evenly; evenly in the logarithm; 0 to count - 1; 0 to 1, the ends as often as all between. */
double scene_range(scene *s, double low, double high);
double scene_spread(scene *s, double low, double high);
int scene_choose(scene *s, int count);
double scene_share(scene *s);

/* The first value that is no radiance (NaN, infinite, negative), or -1. */
int scene_find_bad(const float *radiance, int count);
/* A sky of 1 on all sides, and no sun. */
shape_light scene_white_sky(void);

/* The two numbers of the command line, COUNT [FIRST]; false, and a message, where they are none. */
bool scene_numbers(const char *program, int argc, char **argv, long *count, long *first);

#endif
