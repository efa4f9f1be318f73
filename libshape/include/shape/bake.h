/* Density to a grid: what the preview marches instead of the analytic field. */
#ifndef SHAPE_BAKE_H
#define SHAPE_BAKE_H

#include "shape/change.h"
#include "shape/lightgrid.h"
#include "shape/volume.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    SHAPE_BAKE_BLOCK = 4, /* voxels a side of the blocks whose distance to matter is kept */
    SHAPE_BAKE_BRICK = 8  /* of the bricks that are made at once; sizes of grids are multiples of it */
};

/* A cloud's density at the centres of voxels, in its own frame. A voxel is two bytes: density times 255 / cloud->most,
 * rounded; and
 * how many blocks of 4^3 voxels away the nearest block with any density is (0: this one), 255 at the most, counted like
 * a king's moves. The outermost voxels are empty. */
typedef struct shape_baked {
    int size[3];     /* voxels along x, y, z: multiples of SHAPE_BAKE_BRICK */
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
/* The same, but it can be broken off. */
shape_status shape_bake_with(const shape_volume_cloud *cloud, float voxel, int threads, shape_stop stop,
                             shape_baked *baked, shape_error *error);
void shape_baked_free(shape_baked *baked);

/* Bakes again what an edit has changed of a cloud: `baked` is its grid from before, cloud is it now, change what differs
 * (shape_change_find). The voxels become those that shape_bake would give, to the bit; only bricks that the change touches
 * are evaluated, and distances to matter where that has come or gone. Where all has changed or the cloud's box is another
 * one, all is baked, with the same voxel. *bricks (may be NULL) gets a flag a brick, x fastest: 0 where all its bytes
 * are as they were; the caller frees it. After an error the grid is freed. */
shape_status shape_bake_again(const shape_volume_cloud *cloud, const shape_change *change, int threads,
                              shape_stop stop, shape_baked *baked, uint8_t **bricks, shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
