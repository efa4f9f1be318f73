/* Vectors, quaternions, boxes, frames. */
#include "shape/vector.h"

#include <float.h>

/* (&v.x)[axis] is used throughout: the members lie side by side. */
_Static_assert(sizeof(shape_vec3) == 3 * sizeof(float), "shape_vec3 has gaps");
_Static_assert(sizeof(shape_dvec3) == 3 * sizeof(double), "shape_dvec3 has gaps");

shape_dvec3 shape_dvec3_normalize(shape_dvec3 a)
{
    double length = shape_dvec3_length(a);
    return length > 0 ? shape_dvec3_scale(a, 1 / length) : a;
}

shape_quat shape_quat_identity(void)
{
    shape_quat q = {0, 0, 0, 1};
    return q;
}

shape_quat shape_quat_normalize(shape_quat q)
{
    double x = q.x, y = q.y, z = q.z, w = q.w;
    double length = sqrt(x * x + y * y + z * z + w * w);
    if (!(length > 0))
        return shape_quat_identity();
    shape_quat unit = {(float)(x / length), (float)(y / length), (float)(z / length), (float)(w / length)};
    return unit;
}

shape_quat shape_quat_multiply(shape_quat a, shape_quat b)
{
    shape_quat q = {
        a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
        a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
    return q;
}

shape_vec3 shape_quat_rotate(shape_quat q, shape_vec3 v)
{
    shape_vec3 u = {q.x, q.y, q.z};
    shape_vec3 t = shape_vec3_scale(shape_vec3_cross(u, v), 2);
    return shape_vec3_add(shape_vec3_add(v, shape_vec3_scale(t, q.w)), shape_vec3_cross(u, t));
}

shape_quat shape_quat_conjugate(shape_quat q)
{
    shape_quat c = {-q.x, -q.y, -q.z, q.w};
    return c;
}

shape_quat shape_quat_from_columns(shape_dvec3 x, shape_dvec3 y, shape_dvec3 z)
{
    /* Shepperd 1978: divide by the largest of the four components. */
    double trace = x.x + y.y + z.z, s;
    double q[4];
    if (trace > 0) {
        s = sqrt(trace + 1) * 2;
        q[0] = (y.z - z.y) / s, q[1] = (z.x - x.z) / s, q[2] = (x.y - y.x) / s, q[3] = s / 4;
    } else if (x.x > y.y && x.x > z.z) {
        s = sqrt(1 + x.x - y.y - z.z) * 2;
        q[0] = s / 4, q[1] = (y.x + x.y) / s, q[2] = (z.x + x.z) / s, q[3] = (y.z - z.y) / s;
    } else if (y.y > z.z) {
        s = sqrt(1 + y.y - x.x - z.z) * 2;
        q[0] = (y.x + x.y) / s, q[1] = s / 4, q[2] = (z.y + y.z) / s, q[3] = (z.x - x.z) / s;
    } else {
        s = sqrt(1 + z.z - x.x - y.y) * 2;
        q[0] = (z.x + x.z) / s, q[1] = (z.y + y.z) / s, q[2] = s / 4, q[3] = (x.y - y.x) / s;
    }
    shape_quat result = {(float)q[0], (float)q[1], (float)q[2], (float)q[3]};
    return shape_quat_normalize(result);
}

void shape_quat_matrix(shape_quat q, double matrix[3][3])
{
    double x = q.x, y = q.y, z = q.z, w = q.w;
    matrix[0][0] = 1 - 2 * (y * y + z * z), matrix[0][1] = 2 * (x * y - z * w),
    matrix[0][2] = 2 * (x * z + y * w);
    matrix[1][0] = 2 * (x * y + z * w), matrix[1][1] = 1 - 2 * (x * x + z * z),
    matrix[1][2] = 2 * (y * z - x * w);
    matrix[2][0] = 2 * (x * z - y * w), matrix[2][1] = 2 * (y * z + x * w),
    matrix[2][2] = 1 - 2 * (x * x + y * y);
}

shape_box shape_box_empty(void)
{
    shape_box box = {{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}};
    return box;
}

bool shape_box_is_empty(shape_box box)
{
    return box.min.x > box.max.x || box.min.y > box.max.y || box.min.z > box.max.z;
}

shape_box shape_box_join(shape_box a, shape_box b)
{
    /* Least with least, greatest with greatest: an empty box adds nothing. */
    shape_box box = {{a.min.x < b.min.x ? a.min.x : b.min.x, a.min.y < b.min.y ? a.min.y : b.min.y,
                      a.min.z < b.min.z ? a.min.z : b.min.z},
                     {a.max.x > b.max.x ? a.max.x : b.max.x, a.max.y > b.max.y ? a.max.y : b.max.y,
                      a.max.z > b.max.z ? a.max.z : b.max.z}};
    return box;
}

shape_box shape_box_add_point(shape_box box, shape_vec3 p)
{
    box.min.x = p.x < box.min.x ? p.x : box.min.x;
    box.min.y = p.y < box.min.y ? p.y : box.min.y;
    box.min.z = p.z < box.min.z ? p.z : box.min.z;
    box.max.x = p.x > box.max.x ? p.x : box.max.x;
    box.max.y = p.y > box.max.y ? p.y : box.max.y;
    box.max.z = p.z > box.max.z ? p.z : box.max.z;
    return box;
}

shape_frame shape_frame_identity(void)
{
    shape_frame frame = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    return frame;
}

shape_dvec3 shape_frame_direction(const shape_frame *frame, shape_dvec3 d)
{
    double result[3];
    for (int i = 0; i < 3; i++)
        result[i] = frame->m[i][0] * d.x + frame->m[i][1] * d.y + frame->m[i][2] * d.z;
    return shape_dvec3_make(result[0], result[1], result[2]);
}

shape_dvec3 shape_frame_point(const shape_frame *frame, shape_dvec3 p)
{
    return shape_dvec3_add(shape_frame_direction(frame, p),
                           shape_dvec3_make(frame->m[0][3], frame->m[1][3], frame->m[2][3]));
}

shape_frame shape_frame_multiply(const shape_frame *outer, const shape_frame *inner)
{
    shape_frame result;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++) {
            result.m[i][j] = j == 3 ? outer->m[i][3] : 0;
            for (int k = 0; k < 3; k++)
                result.m[i][j] += outer->m[i][k] * inner->m[k][j];
        }
    return result;
}

double shape_frame_determinant(const shape_frame *frame)
{
    const double(*m)[4] = frame->m;
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

bool shape_frame_invert(const shape_frame *frame, shape_frame *inverse)
{
    const double(*m)[4] = frame->m;
    double determinant = shape_frame_determinant(frame);
    if (determinant == 0 || !isfinite(determinant) || !isfinite(1 / determinant))
        return false;
    shape_frame result;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
            result.m[i][j] = (m[a][c] * m[b][d] - m[a][d] * m[b][c]) / determinant;
        }
    }
    for (int i = 0; i < 3; i++)
        result.m[i][3] = -(result.m[i][0] * m[0][3] + result.m[i][1] * m[1][3] + result.m[i][2] * m[2][3]);
    *inverse = result;
    return true;
}

void shape_frame_box(const shape_frame *frame, shape_box box, shape_dvec3 *min, shape_dvec3 *max)
{
    *min = shape_dvec3_make(DBL_MAX, DBL_MAX, DBL_MAX);
    *max = shape_dvec3_make(-DBL_MAX, -DBL_MAX, -DBL_MAX);
    for (int corner = 0; corner < 8; corner++) {
        shape_dvec3 p = {corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                         corner & 4 ? box.max.z : box.min.z};
        p = shape_frame_point(frame, p);
        *min = shape_dvec3_make(p.x < min->x ? p.x : min->x, p.y < min->y ? p.y : min->y,
                                p.z < min->z ? p.z : min->z);
        *max = shape_dvec3_make(p.x > max->x ? p.x : max->x, p.y > max->y ? p.y : max->y,
                                p.z > max->z ? p.z : max->z);
    }
}
