/* Small sets for the tests of light: one cloud of given primitives, and its volume. */
#ifndef SCENE_SAMPLE_H
#define SCENE_SAMPLE_H

#include <assert.h>
#include <stdlib.h>

#include "shape/volume.h"

typedef struct sample_scene {
    shape_set *set;
    shape_volume *volume;
} sample_scene;

static inline sample_scene sample_begin(shape_model model, float extinction)
{
    sample_scene scene = {shape_set_create(NULL), NULL};
    if (!scene.set || shape_set_add_cloud(scene.set, "sample", NULL, NULL))
        abort();
    scene.set->clouds[0].field.model = model;
    scene.set->clouds[0].medium.extinction = extinction;
    return scene;
}

static inline void sample_add(sample_scene *scene, float x, float y, float z, float a, float b, float c)
{
    shape_ellipsoid e = {x, y, z, 0, a, b, c, 0, {0, 0, 0, 1}};
    shape_sphere s = {x, y, z, a};
    shape_primitives *list = shape_set_list(scene->set, 0);
    if (a == b && b == c ? shape_primitives_add_sphere(list, s, NULL)
                         : shape_primitives_add_ellipsoid(list, e, NULL))
        abort();
}

static inline void sample_finish(sample_scene *scene)
{
    shape_primitives *list = shape_set_list(scene->set, 0);
    if (shape_cloud_choose_noise_scale(&scene->set->clouds[0], list, NULL) ||
        shape_volume_create(scene->set, &scene->volume, NULL))
        abort();
}

static inline void sample_end(sample_scene *scene)
{
    shape_volume_destroy(scene->volume);
    shape_set_destroy(scene->set);
}

/* A heap of spheres like a small cumulus: `spheroid`, about 9 m wide. */
static inline sample_scene sample_cumulus(int spheres, float extinction)
{
    sample_scene scene = sample_begin(SHAPE_MODEL_SPHEROID, extinction);
    unsigned state = 12345;
    for (int i = 0; i < spheres; i++) {
        float r[4];
        for (int k = 0; k < 4; k++) {
            state = state * 1664525u + 1013904223u;
            r[k] = (float)(state >> 8) / 16777216.0f;
        }
        float size = 0.7f + 1.1f * r[3];
        sample_add(&scene, 6 * r[0] - 3, 2.5f * r[1], 4 * r[2] - 2, size, size, size);
    }
    sample_finish(&scene);
    return scene;
}

#endif
