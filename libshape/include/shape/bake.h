/* Density to a grid: what the preview marches instead of the analytic field. */
#ifndef SHAPE_BAKE_H
#define SHAPE_BAKE_H

#include "shape/lightgrid.h"
#include "shape/volume.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { SHAPE_BAKE_BLOCK = 4 }; /* voxels a side of the blocks whose distance to matter is kept */

/* A cloud's density at the centres of voxels, in its own frame. A voxel is two bytes: density times 255 / cloud->most,
 * rounded; and
 * how many blocks of 4^3 voxels away the nearest block with any density is (0: this one), 255 at the most, counted like
 * a king's moves. The outermost voxels are empty. */
typedef struct shape_baked {
    int size[3];     /* voxels along x, y, z: multiples of SHAPE_BAKE_BLOCK */
    shape_box box;   /* cloud's frame; voxel centres lie half a voxel inside */
    float voxel;     /* edge of a voxel [m, cloud's frame] */
    uint8_t *voxels; /* [size z][size y][size x][2] */
} shape_baked;

/* The voxel edge that keeps a cloud's grid within `most` voxels, but not below `wanted` [m, cloud's frame]. */
float shape_bake_voxel(const shape_volume_cloud *cloud, float wanted, size_t most);

/* Bakes a cloud. Only blocks that a support touches are evaluated. Octaves whose cells are smaller than a voxel are
 * replaced by their mean. threads 0: all; the result does not depend on it. The caller frees by shape_baked_free. */
shape_status shape_bake(const shape_volume_cloud *cloud, float voxel, int threads, shape_baked *baked,
                        shape_error *error);
void shape_baked_free(shape_baked *baked);

#ifdef __cplusplus
}
#endif
#endif
