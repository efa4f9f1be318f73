/* Scenes as the generators make them, by their number: heaps, metaballs, layers, ellipsoids, one or several, seen from near
 * and far. For error_scenes.c and test_budget.c. */
#ifndef GENERATED_SCENE_H
#define GENERATED_SCENE_H

#include "shape/random.h"
#include "shape/view.h"
#include "shape/volume.h"

typedef struct generated_scene {
    long number;
    const char *kind;
    shape_random random;
    shape_set *set;
    shape_volume *volume;
    shape_light light;
    shape_view view; /* 96x54 */
    double error;    /* allowed, 0.02 to 0.2 */
} generated_scene;

/* Ends the program where something fails. */
void generated_open(generated_scene *s, long number);
void generated_close(generated_scene *s);

#endif
