/* Fewer primitives for nearly the same cloud: dropping those inside others (Jiménez 2018 Eq. 17), and hollowing out
 * the core. */
#ifndef SHAPE_PRUNE_H
#define SHAPE_PRUNE_H

#include "shape/set.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Whether the ball `inner` lies within the ball `outer`, touching allowed: R - r >= distance of the centres (Eq. 17),
 * evaluated in double precision. */
bool shape_sphere_contains(shape_sphere outer, shape_sphere inner);

/* Whether `inner` lies within `outer` shrunk by one part in a million. Exact but for that margin, which keeps rounding
 * from ever giving true for one that sticks out. By the S-lemma (Yakubovich 1971): the ellipsoid c + B v, |v| <= 1, is
 * in the unit ball if and only if some t >= |B|^2 has 1 - t - t * sum c_k^2 / (t - s_k) >= 0, s_k being the
 * eigenvalues of B B^T and c_k the centre along its eigenvectors. */
bool shape_ellipsoid_contains(const shape_ellipsoid *outer, const shape_ellipsoid *inner);

/* Drops every primitive that lies within another one; of equal ones the first stays. Spheres in spheres go by
 * shape_sphere_contains, every other pair by shape_ellipsoid_contains. The union of the primitives does not change,
 * so `uniform` density does not; that of `spheroid` and `metaball` does near the primitives dropped. What remains
 * keeps its order. Near linear in the number of primitives, by a tree; all cores, the same result for any number.
 * *removed (may be NULL) gets how many went. Errors: memory, or 2^31 primitives and more; the list is then untouched. */
shape_status shape_primitives_prune(shape_primitives *list, size_t *removed, shape_error *error);

/* A box about a centre [m, cloud's frame]. */
typedef struct shape_core {
    double centre[3], half[3];
} shape_core;

/* The core of any list: about the mean of its centres, with 3/4, 1/3, 3/4 of their standard deviations along x, y, z
 * as half sides - the box of Jiménez 2018 section 3.6.1 with measured moments. Zeros for an empty list. */
shape_core shape_primitives_core(const shape_primitives *list);

/* Drops the primitives whose centre lies inside the core (not on its walls), and returns how many. Where all would
 * go, none does. */
size_t shape_primitives_hollow(shape_primitives *list, const shape_core *core);

#ifdef __cplusplus
}
#endif
#endif
