/* Reworking a list of primitives: thinning it out, growing smaller spheres on it, cutting it off by a plane. */
#ifndef SHAPE_REFINE_H
#define SHAPE_REFINE_H

#include "shape/set.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Keeps `keep` primitives chosen at random, every choice equally likely, in their order (selection sampling: Fan,
 * Muller and Rezucha 1962); nothing happens where there are no more than that. Returns how many went. */
size_t shape_primitives_thin(shape_primitives *list, size_t keep, uint64_t seed);

typedef struct shape_grow {
    int levels; /* 1 to 8; default 2 */
    int count;  /* spheres tried on each primitive of the level before, 1 to 1000; default 10 */
    double
        ratio[2]; /* radius, as a share of the parent's (an ellipsoid's smallest semi-axis), drawn from this
                             range; 0.01 to 1; default 0.35 to 0.6 */
    size_t max_primitives; /* the list may not pass this; default 1000000 */
} shape_grow;

shape_grow shape_grow_defaults(void);
/* Checks every member's range; the error names the member. */
shape_status shape_grow_check(const shape_grow *options, shape_error *error);

/* Sets smaller spheres on the surface of the primitives, then smaller ones on those, level by level. A sphere whose
 * centre would lie inside a primitive that was there before its level is left out: nobody would see it. *added (may
 * be NULL) gets how many came. Errors: the check's, memory, SHAPE_ERROR_LIMIT; the list may then be half grown. */
shape_status shape_primitives_grow(shape_primitives *list, const shape_grow *options, uint64_t seed,
                                   size_t *added, shape_error *error);

typedef struct shape_clip {
    double normal[3];  /* points to the side that is kept; any length but 0; default 0,1,0 */
    double height;     /* the plane is normal . p = height for the unit normal [m, world], +-1e12 */
    bool lowest;       /* in place of height: through the lowest centre of each cloud, seen along the normal;
                          default true. Such a cut drops nothing and gives a flat base. */
    double noise;      /* a ragged edge: the plane hangs down by up to this [m, world], 0 to 1e6; default 0 */
    double noise_size; /* edge of the noise's cells [m, world], 1e-6 to 1e9; default 1 */
    uint64_t seed;     /* of that noise; default 1 */
} shape_clip;

shape_clip shape_clip_defaults(void);
/* Checks every member's range; the error names the member. */
shape_status shape_clip_check(const shape_clip *options, shape_error *error);

/* Cuts clouds by a plane. A primitive whose centre is below it goes; one that only reaches below is squashed along the
 * normal towards its highest point until it ends at the plane, so it becomes an ellipsoid and the base is flat. With
 * noise the plane's height is taken at each primitive's centre. `selected` as in shape_set_change_lists. *removed and
 * *squashed (may be NULL) count primitives, those of a shared list once. Errors: the check's, memory; the set is then
 * to be destroyed. */
shape_status shape_set_clip(shape_set *set, const bool *selected, const shape_clip *options, size_t *removed,
                            size_t *squashed, shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
