/* Principal axes by one-sided Jacobi rotations (Hestenes 1958; Golub and Van Loan, Matrix Computations, 8.6.3). */
#include "primitive/axes.h"

/* Turns columns p and q in their plane until they are perpendicular; false where they were. */
static bool turn(shape_dvec3 *p, shape_dvec3 *q)
{
    double pp = shape_dvec3_dot(*p, *p), qq = shape_dvec3_dot(*q, *q), pq = shape_dvec3_dot(*p, *q);
    if (!(fabs(pq) > 1e-15 * sqrt(pp * qq)))
        return false;
    double zeta = (qq - pp) / (2 * pq);
    double t = (zeta < 0 ? -1 : 1) / (fabs(zeta) + sqrt(1 + zeta * zeta));
    double c = 1 / sqrt(1 + t * t), s = c * t;
    shape_dvec3 old = *p;
    *p = shape_dvec3_sub(shape_dvec3_scale(old, c), shape_dvec3_scale(*q, s));
    *q = shape_dvec3_add(shape_dvec3_scale(old, s), shape_dvec3_scale(*q, c));
    return true;
}

void shape_axes_diagonalize(shape_dvec3 m[3])
{
    enum {
        MAX_SWEEPS = 30
    }; /* five or six do; the bound only stops a column of NaN or a rounding that flickers */
    for (int sweep = 0; sweep < MAX_SWEEPS; sweep++) {
        bool turned = turn(&m[0], &m[1]);
        turned = turn(&m[0], &m[2]) || turned;
        turned = turn(&m[1], &m[2]) || turned;
        if (!turned)
            return;
    }
}

void shape_axes_of(const shape_ellipsoid *e, shape_dvec3 m[3])
{
    double x = e->q.x, y = e->q.y, z = e->q.z, w = e->q.w;
    double s = 2 / (x * x + y * y + z * z + w * w);
    m[0] = shape_dvec3_make(1 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w));
    m[1] = shape_dvec3_make(s * (x * y - z * w), 1 - s * (x * x + z * z), s * (y * z + x * w));
    m[2] = shape_dvec3_make(s * (x * z + y * w), s * (y * z - x * w), 1 - s * (x * x + y * y));
    m[0] = shape_dvec3_scale(m[0], e->a);
    m[1] = shape_dvec3_scale(m[1], e->b);
    m[2] = shape_dvec3_scale(m[2], e->c);
}

shape_ellipsoid shape_axes_sphere(const shape_sphere *s)
{
    shape_ellipsoid e = {
        .x = s->x, .y = s->y, .z = s->z, .a = s->radius, .b = s->radius, .c = s->radius, .q = {0, 0, 0, 1}};
    return e;
}
