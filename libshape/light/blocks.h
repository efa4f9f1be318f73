/* Private: bounds of one voxel grid's extinction, block by block, and free paths through them in the grid's own frame. */
#ifndef SHAPE_LIGHT_BLOCKS_H
#define SHAPE_LIGHT_BLOCKS_H

#include "shape/grid.h"
#include "shape/random.h"
#include "shape/volume.h"

enum { BLOCK_PARTS = 4, BLOCK_PARTS_ALL = BLOCK_PARTS * BLOCK_PARTS * BLOCK_PARTS };

/* One block; max is 0 where it is empty. */
typedef struct block_bound {
    float max;      /* of the extinction within [1/m] */
    uint32_t parts; /* which of `parts` */
} block_bound;

/* The bounds of each of a block's 4^3 parts, as shares of the block's max in steps of 1/255: 128 bytes, where the
 * values themselves are 2916, so that they stay in the processor's cache. x fastest. */
typedef struct block_parts {
    uint8_t low[BLOCK_PARTS_ALL], high[BLOCK_PARTS_ALL];
} block_parts;

/* Blocks of edge^3 cells, with a border of empty ones all round, where rounding may lead. */
typedef struct block_grid {
    const shape_grid *grid;
    double to_local[3][4];  /* metres from an origin to voxels */
    float extinction;       /* of density 1 [1/m] */
    int edge, n[3];         /* edge: 8 or 4; n counts the border */
    double low[3], high[3]; /* the box of the blocks that hold anything [voxels] */
    block_bound *blocks;    /* x fastest */
    block_parts *parts;     /* of the blocks that hold anything */
} block_grid;

/* Bounds of a cloud of the model grid. origin: where places are counted from [m, world]. Free it by block_grid_free, also
 * after an error. */
shape_status block_grid_build(block_grid *blocks, const shape_volume_cloud *cloud, shape_dvec3 origin,
                              shape_error *error);
void block_grid_free(block_grid *blocks);

/* Delta tracking from p (metres from the origin) along d as far as length: where the first collision is, as t [m]. depth:
 * the optical depth, drawn by the caller, after which the first tentative one comes. False: none. */
bool block_collide(const block_grid *blocks, const double p[3], const double d[3], double length,
                   double depth, shape_random *random, double *t);

/* An unbiased estimate of the transmittance from p along d as far as length. */
double block_transmittance(const block_grid *blocks, const double p[3], const double d[3], double length,
                           shape_random *random);

#endif
