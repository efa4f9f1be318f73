/* A set's fields at the centres of a world-aligned lattice of voxels, brick by brick: what volumes for other programs are
 * made of. Only bricks that a primitive's support touches are visited, and only those with something in them are given
 * out, so memory grows with what is filled. */
#ifndef SHAPE_VOXELS_H
#define SHAPE_VOXELS_H

#include "shape/volume.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    SHAPE_VOXEL_EDGE = 8, /* voxels along a brick, which is a leaf of OpenVDB */
    SHAPE_VOXEL_BRICK = 512,
    SHAPE_VOXEL_MOST = 1 << 29 /* voxels along one side of a lattice */
};

/* Where voxels lie. Output axes are the world's (y up), or, with z_up, x, -z, y of the world: right-handed too, z up,
 * as in Blender. Voxel i, j, k has its centre at origin + edge (i, j, k) in output axes. Every model's bounds
 * lie within the voxels 0 .. size - 1, each taken with its whole edge. */
typedef struct shape_voxel_lattice {
    double edge; /* of a voxel [m] */
    double origin[3];
    int32_t size[3];
    bool z_up;
} shape_voxel_lattice;

/* What is asked for at a voxel's centre. Where several clouds overlap, densities add; of the last three the cloud counts
 * whose core is nearest. */
typedef enum shape_voxel_quantity {
    SHAPE_VOXEL_DENSITY =
        0,               /* the field's density, weighed by the cloud's extinction over the set's greatest */
    SHAPE_VOXEL_SDF,     /* distance to the nearest bound [m], negative inside, within `band` voxels; by first
                                order where a bound is not a sphere (Taubin 1991) */
    SHAPE_VOXEL_PROFILE, /* 0 at the bound to 1 at the core: 1 - u of the nearest primitive */
    SHAPE_VOXEL_DETAIL_TYPE,   /* 0 wisps to 1 billows: the cloud's own blend of the two by height */
    SHAPE_VOXEL_DENSITY_SCALE, /* the cloud's extinction over the set's greatest */
    SHAPE_VOXEL_SAMPLE /* what `sample` gives, three channels, weighed by density where clouds overlap */
} shape_voxel_quantity;

typedef struct shape_voxel_request {
    shape_voxel_quantity quantity;
    int cloud;    /* this one only, or -1: all */
    double scale; /* of the density; default 1 */
    double ramp;  /* uniform clouds' density: 0 at the surface to 1 so many voxels inside; 0: none */
    double band;  /* voxels each side, of the signed distance; default 3 */
    int threads;  /* 0: all; the result does not depend on it */
    /* SHAPE_VOXEL_SAMPLE: the value in a cloud at a point of its frame; called by several threads at a time. */
    void (*sample)(const void *context, size_t cloud, shape_vec3 p, float value[3]);
    const void *sample_context;
} shape_voxel_request;

shape_voxel_request shape_voxel_request_defaults(void);

/* Where bricks go. Both are called by several threads at a time, in no order, each place once; false: out of memory.
 * brick: values[channel][8 x][8 y][8 z] of the voxels from `first` on, not all 0. tile: a cube of voxels of one
 * value; its edge is a power of two, at least 8, and `first` a multiple of it. For the distance, a tile is wholly inside
 * and has the value -band. */
typedef struct shape_voxel_sink {
    void *context;
    bool (*brick)(void *context, const int32_t first[3], const float *values);
    bool (*tile)(void *context, const int32_t first[3], int32_t edge, float value);
} shape_voxel_sink;

/* The box around the supports of one cloud or (-1) all, in output axes [m]; *any: whether there is something. */
shape_status shape_voxels_bounds(const shape_volume *volume, int cloud, bool z_up, double min[3],
                                 double max[3], bool *any, shape_error *error);

/* A lattice over such a box with voxels of that edge. Errors: SHAPE_ERROR_ARGUMENT for an edge not above 0,
 * SHAPE_ERROR_LIMIT above SHAPE_VOXEL_MOST voxels a side. */
shape_status shape_voxels_lay_out(const double min[3], const double max[3], double edge, bool z_up,
                                  shape_voxel_lattice *lattice, shape_error *error);

/* The world point (y up) of a voxel's centre. The density there is what a brick holds, bit for bit. */
shape_dvec3 shape_voxel_point(const shape_voxel_lattice *lattice, const int32_t index[3]);

/* How many bricks (not tiles) filling will give at the most; stops counting above `most`. */
shape_status shape_voxels_count(const shape_volume *volume, const shape_voxel_lattice *lattice,
                                const shape_voxel_request *request, size_t most, size_t *bricks,
                                shape_error *error);

/* Visits the voxels and hands them to the sink. Errors: memory; SHAPE_ERROR_ARGUMENT for a ramp on a cloud that is not
 * uniform, or has details. */
shape_status shape_voxels_fill(const shape_volume *volume, const shape_voxel_lattice *lattice,
                               const shape_voxel_request *request, const shape_voxel_sink *sink,
                               shape_error *error);

/* How well voxels of that edge hold the density: the root mean square, over `samples` seeded random points of the
 * supports, of trilinear interpolation between voxel centres less the density itself. Of the request only the
 * cloud counts. Errors: SHAPE_ERROR_ARGUMENT for samples below 1, memory. */
shape_status shape_voxels_error(const shape_volume *volume, const shape_voxel_request *request, double edge,
                                int samples, uint64_t seed, double *rmse, shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
