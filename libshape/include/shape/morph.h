/* One set turning into another: primitives are paired so that neighbours stay neighbours, and move from one end to the
 * other. */
#ifndef SHAPE_MORPH_H
#define SHAPE_MORPH_H

#include "shape/set.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shape_morph shape_morph;

/* Pairs the primitives of cloud i of both sets; clouds of only one of them grow or vanish in their places. The pairing
 * halves both clouds again and again, by the same plane's direction, each at its own median (the matching by a k-d tree
 * that is known from optimal transport), so what lies left in one goes to what lies left in the other. Where one side
 * has fewer primitives, one becomes several at the same place, which changes no density of a union.
 * Both sets must live as long as the morph, which the caller destroys; reading it is thread-safe. Errors: memory; clouds
 * of different models, or layers, whose primitives are bounds. */
shape_status shape_morph_create(const shape_set *from, const shape_set *to, shape_morph **morph,
                                shape_error *error);
void shape_morph_destroy(shape_morph *morph); /* NULL is allowed */

/* The set at a share of the way, 0 (`from`, but for primitives counted twice) to 1 (`to`, but for the seed of the
 * noise, which stays that of `from`), as a new set, which the caller destroys. Positions and sizes go straight, turns the
 * short way (of the 24 descriptions of an ellipsoid, the nearest is taken), field, medium and frame straight, the scale
 * of the noise by equal factors. Errors: a share outside 0 to 1; memory; frames turned so far apart that the way between
 * has no inverse. */
shape_status shape_morph_at(const shape_morph *morph, double share, shape_set **set, shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
