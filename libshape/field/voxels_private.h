/* Private to field/voxels*.c: primitives as the lattice sees them, and the fields of one brick. */
#ifndef SHAPE_FIELD_VOXELS_PRIVATE_H
#define SHAPE_FIELD_VOXELS_PRIVATE_H

#include "shape/voxels.h"

enum { VOXEL_EDGE = SHAPE_VOXEL_EDGE, VOXEL_BRICK = SHAPE_VOXEL_BRICK, VOXEL_CHANNELS = 3 };

/* A primitive's support in voxel units: u = |m (v - c)| is 1 on it. A ball (radius > 0) is one there too. */
typedef struct voxel_form {
    double c[3];
    float m[3][3];
    float h[3];      /* half of its box */
    float radius;    /* of a ball, else 0 */
    float thin, fat; /* its least and greatest semi-axis */
    float slack;     /* how far the cloud's single precision may move it */
    uint32_t cloud;
    int32_t content; /* i + 1: sphere i of the cloud's supports; -(i + 1): ellipsoid i */
} voxel_form;

typedef struct voxel_forms {
    voxel_form *items; /* cloud by cloud */
    size_t count;
} voxel_forms;

/* The supports of the clouds that a request asks for; the caller frees items. */
shape_status voxel_forms_make(const shape_volume *volume, int cloud, const shape_voxel_lattice *lattice,
                              voxel_forms *forms, shape_error *error);

/* What filling a brick needs, and one thread's room for it. */
typedef struct voxel_job {
    const shape_volume *volume;
    const shape_voxel_lattice *lattice;
    const shape_voxel_request *request;
    const voxel_form *forms;
    float *weights; /* a cloud's extinction over the greatest */
} voxel_job;

typedef struct voxel_room {
    float values[VOXEL_CHANNELS * VOXEL_BRICK];
    float depth[VOXEL_BRICK], u2[VOXEL_BRICK], best[VOXEL_BRICK];
    float x[VOXEL_BRICK], y[VOXEL_BRICK], z[VOXEL_BRICK];
} voxel_room;

/* The request's quantity in the brick from `first` on, into room->values; `list` names the forms that touch it, in
 * order. */
void voxel_brick_fill(const voxel_job *job, const int32_t first[3], const int32_t *list, size_t count,
                      voxel_room *room);
/* The deepest of the balls and other forms over each voxel [voxels], at least `least`: 1 - u times the distance that u
 * stands for. */
void voxel_brick_depth(const voxel_form *forms, const int32_t first[3], const int32_t *list, size_t count,
                       float least, float depth[VOXEL_BRICK]);

#endif
