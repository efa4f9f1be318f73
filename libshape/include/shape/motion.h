/* Clouds in time: wind that carries and shears them, noise that drifts through them, primitives that grow and decay. A
 * moment is made from the cloud at rest and the time alone, never from the moment before, so that any picture of a
 * sequence can be made by itself and is the same every time. */
#ifndef SHAPE_MOTION_H
#define SHAPE_MOTION_H

#include <stdint.h>

#include "shape/set.h"

#ifdef __cplusplus
extern "C" {
#endif

/* All zero: nothing moves. Voxel grids take wind and shear alone. */
typedef struct shape_motion {
    double wind[3]; /* what carries the clouds, their noise included [m/s, world], each within +-1000 */
    double
        shear; /* how much faster the wind blows a metre higher [1/s], along its horizontal direction (+x where it
                       has none), counted from the clouds' base; within +-10. Where primitives live for ever, frames
                       are sheared, and noise with them; else each primitive runs ahead by its age, so that the cloud
                       leans and stays */
    double drift[3]; /* how the noise moves through the clouds that stay [m/s, world], each within +-1000 */
    double
        life; /* each primitive grows, lasts and decays within so many seconds, then begins anew; 0: for ever;
                        else 1e-3 to 1e9 */
    double
        grow; /* seconds from time 0 in which the clouds grow out of their bases; 0 to 1e9, 0: they are there */
    double decay_start,
        decay;     /* from when on the clouds decay, and how long it takes [s]; decay 0: they do not */
    uint64_t seed; /* of who is born and who decays when */
} shape_motion;

shape_status shape_motion_check(const shape_motion *motion, shape_error *error);
/* Whether anything moves. */
bool shape_motion_is_on(const shape_motion *motion);

/* The size of a primitive, as a share of its full size, at an age from 0 to 1 of its life: grows within the first
 * quarter, shrinks in the last, without a jump. */
double shape_motion_size(double age);

/* The set at a time [s, any finite number] as a new set, which the caller destroys. Primitives that have a thousandth of
 * their size or less are left out. Noise that is plain (no details, no layer) repeats after 64 cells, so its drift is
 * taken modulo that and keeps its precision for ever. Errors: the check's, memory, a time that is not finite. */
shape_status shape_motion_apply(const shape_set *set, const shape_motion *motion, double time,
                                shape_set **moved, shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
