/* Private: distances to matter of a baked grid's blocks. */
#ifndef SHAPE_FIELD_BAKE_DISTANCE_H
#define SHAPE_FIELD_BAKE_DISTANCE_H

#include "shape/bake.h"

/* Fills the second byte of all voxels from the first ones. made: NULL, or a flag a brick: only these have other densities
 * than when this was called last; then only what differs is written, and flagged in differ. */
shape_status bake_distances(shape_baked *baked, const uint8_t *made, uint8_t *differ, shape_error *error);

#endif
