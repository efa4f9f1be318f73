/* Vectors, quaternions, boxes and frames. y is up, right-handed; lengths are metres. Plain IEEE operations only, so
 * results that reach a file are the same everywhere. */
#ifndef SHAPE_VECTOR_H
#define SHAPE_VECTOR_H

#include <math.h>
#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shape_vec3 {
    float x, y, z;
} shape_vec3;

typedef struct shape_dvec3 {
    double x, y, z;
} shape_dvec3;

/* A rotation; unit length. w is the real part. */
typedef struct shape_quat {
    float x, y, z, w;
} shape_quat;

/* An axis-aligned box; empty where a min is above its max. */
typedef struct shape_box {
    shape_vec3 min, max;
} shape_box;

/* An affine placement, row by row: world_i = m[i][0] x + m[i][1] y + m[i][2] z + m[i][3]. Invertible. */
typedef struct shape_frame {
    double m[3][4];
} shape_frame;

static inline shape_vec3 shape_vec3_make(float x, float y, float z)
{
    shape_vec3 v = {x, y, z};
    return v;
}
static inline shape_vec3 shape_vec3_add(shape_vec3 a, shape_vec3 b)
{
    return shape_vec3_make(a.x + b.x, a.y + b.y, a.z + b.z);
}
static inline shape_vec3 shape_vec3_sub(shape_vec3 a, shape_vec3 b)
{
    return shape_vec3_make(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline shape_vec3 shape_vec3_scale(shape_vec3 a, float s)
{
    return shape_vec3_make(a.x * s, a.y * s, a.z * s);
}
static inline float shape_vec3_dot(shape_vec3 a, shape_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline shape_vec3 shape_vec3_cross(shape_vec3 a, shape_vec3 b)
{
    return shape_vec3_make(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline float shape_vec3_length(shape_vec3 a)
{
    return sqrtf(shape_vec3_dot(a, a));
}

static inline shape_dvec3 shape_dvec3_make(double x, double y, double z)
{
    shape_dvec3 v = {x, y, z};
    return v;
}
static inline shape_dvec3 shape_dvec3_add(shape_dvec3 a, shape_dvec3 b)
{
    return shape_dvec3_make(a.x + b.x, a.y + b.y, a.z + b.z);
}
static inline shape_dvec3 shape_dvec3_sub(shape_dvec3 a, shape_dvec3 b)
{
    return shape_dvec3_make(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline shape_dvec3 shape_dvec3_scale(shape_dvec3 a, double s)
{
    return shape_dvec3_make(a.x * s, a.y * s, a.z * s);
}
static inline double shape_dvec3_dot(shape_dvec3 a, shape_dvec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline shape_dvec3 shape_dvec3_cross(shape_dvec3 a, shape_dvec3 b)
{
    return shape_dvec3_make(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline double shape_dvec3_length(shape_dvec3 a)
{
    return sqrt(shape_dvec3_dot(a, a));
}
/* a / |a|; the zero vector stays zero. */
shape_dvec3 shape_dvec3_normalize(shape_dvec3 a);

shape_quat shape_quat_identity(void);
/* q / |q|; the zero quaternion becomes the identity. */
shape_quat shape_quat_normalize(shape_quat q);
/* The rotation that applies b, then a. */
shape_quat shape_quat_multiply(shape_quat a, shape_quat b);
/* v turned by the unit quaternion q; the conjugate turns back. */
shape_vec3 shape_quat_rotate(shape_quat q, shape_vec3 v);
shape_quat shape_quat_conjugate(shape_quat q);
/* The rotation by a right-handed orthonormal basis: columns are where x, y and z go. */
shape_quat shape_quat_from_columns(shape_dvec3 x, shape_dvec3 y, shape_dvec3 z);
/* The rotation matrix of a unit quaternion, row by row. */
void shape_quat_matrix(shape_quat q, double matrix[3][3]);

shape_box shape_box_empty(void);
bool shape_box_is_empty(shape_box box);
shape_box shape_box_join(shape_box a, shape_box b);
shape_box shape_box_add_point(shape_box box, shape_vec3 p);

shape_frame shape_frame_identity(void);
shape_dvec3 shape_frame_point(const shape_frame *frame, shape_dvec3 p);     /* with the translation */
shape_dvec3 shape_frame_direction(const shape_frame *frame, shape_dvec3 d); /* without it; not normalised */
/* outer after inner. */
shape_frame shape_frame_multiply(const shape_frame *outer, const shape_frame *inner);
double shape_frame_determinant(const shape_frame *frame);
/* The inverse placement; false, with *inverse untouched, where the determinant is zero or not finite. */
bool shape_frame_invert(const shape_frame *frame, shape_frame *inverse);
/* The world-space box around a placed box (its eight corners), in double precision. */
void shape_frame_box(const shape_frame *frame, shape_box box, shape_dvec3 *min, shape_dvec3 *max);

#ifdef __cplusplus
}
#endif
#endif
