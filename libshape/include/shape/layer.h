/* Making layers: a bounded noise volume as a cloud of one primitive (docs/fields.md). */
#ifndef SHAPE_LAYER_H
#define SHAPE_LAYER_H

#include "shape/set.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum shape_layer_preset {
    SHAPE_LAYER_STRATUS,       /* an even sheet, 200 m thick */
    SHAPE_LAYER_STRATOCUMULUS, /* rolls and patches, 400 m thick */
    SHAPE_LAYER_FOG            /* dense at the ground, thinning out upwards, 30 m */
} shape_layer_preset;

typedef struct shape_layer_options {
    shape_layer layer; /* planet_radius is set by shape_layer_make */
    double extent[3];  /* full size along x, y, z [m], 1e-3 to 1e8; default 20, 6, 20 */
    double base;       /* height of its lowest point over the frame's origin [m], +-1e8; default 0 */
    double
        planet_radius; /* from the planet's centre, straight below the origin, to the origin [m], 0 to 1e8; above 0 only
                             with altitudes, whose heights then count from the sphere; default 0: flat */
    double noise_scale; /* metres a cell, 0 to 1e9; default 0: as shape_cloud_choose_noise_scale */
    int octaves;        /* 1 to 16; default 5 */
    double extinction;  /* [1/m], 0 to 1e9; default 2 */
} shape_layer_options;

/* A box of Perlin-Worley noise. */
shape_layer_options shape_layer_options_defaults(void);
/* The defaults changed to a kind of cloud that people know. */
shape_layer_options shape_layer_options_preset(shape_layer_preset preset);
/* Checks every member's range; the error names the member. */
shape_status shape_layer_options_check(const shape_layer_options *options, shape_error *error);

/* Makes the cloud a layer: its model, layer, octaves, noise scale (chosen by the size where it is 0) and extinction, and
 * one sphere or ellipsoid more in its list. Errors: the check's, memory. */
shape_status shape_layer_make(const shape_layer_options *options, shape_cloud *cloud, shape_primitives *list,
                              shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
