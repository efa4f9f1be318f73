/* Metaball cumuli: a few balls of random radius at normally distributed places, whose field joins them into one body
 * (Jiménez 2018 section 3.6.3, Fig. 13; Blinn 1982). The field itself is SHAPE_MODEL_METABALL. */
#ifndef SHAPE_METABALL_H
#define SHAPE_METABALL_H

#include "shape/set.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shape_metaball {
    size_t count; /* balls, 1 to 100000; default 6, as in Fig. 13 */
    double
        sigma[3]; /* of their centres [m], 0 to 1e6; default 3.6, 1.5, 2.8; cut at two sigma, y from 0 up */
    double min_radius; /* radii are uniform between these two [m]; 1e-6 to max_radius; default 1.25 */
    double max_radius; /* 1e-6 to 1e6; default 2.5 */
} shape_metaball;

shape_metaball shape_metaball_defaults(void);
/* Checks every member's range; the error names the member. */
shape_status shape_metaball_check(const shape_metaball *options, shape_error *error);

/* Appends the balls to an empty list. The same options and seed give the same balls everywhere. The cloud's model is
 * the caller's to set. Errors: the check's, or memory. */
shape_status shape_metaball_make(const shape_metaball *options, uint64_t seed, shape_primitives *list,
                                 shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
