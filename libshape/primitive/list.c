/* A list of spheres and ellipsoids: growing it, the boxes round its members, what it checks of each. */
#include <math.h>

#include "base/memory.h"
#include "primitive/list.h"

static bool finite3(float x, float y, float z)
{
    return isfinite(x) && isfinite(y) && isfinite(z);
}

static bool positive(float x)
{
    return x > 0 && isfinite(x);
}

shape_status list_check_sphere(const shape_sphere *s, shape_error *error)
{
    if (!finite3(s->x, s->y, s->z) || !positive(s->radius))
        return shape_error_set(
            error, SHAPE_ERROR_ARGUMENT,
            "a sphere has centre %g,%g,%g and radius %g (they must be finite, the radius above 0)",
            (double)s->x, (double)s->y, (double)s->z, (double)s->radius);
    return SHAPE_OK;
}

shape_status list_check_ellipsoid(const shape_ellipsoid *e, shape_error *error)
{
    if (!finite3(e->x, e->y, e->z) || !positive(e->a) || !positive(e->b) || !positive(e->c) ||
        !finite3(e->q.x, e->q.y, e->q.z) || !isfinite(e->q.w))
        return shape_error_set(
            error, SHAPE_ERROR_ARGUMENT,
            "an ellipsoid has centre %g,%g,%g and semi-axes %g,%g,%g (they must be finite, the axes above 0)",
            (double)e->x, (double)e->y, (double)e->z, (double)e->a, (double)e->b, (double)e->c);
    return SHAPE_OK;
}

shape_status shape_primitives_reserve(shape_primitives *list, size_t spheres, size_t ellipsoids,
                                      shape_error *error)
{
    if (shape_array_reserve((void **)&list->spheres, &list->sphere_capacity, spheres, sizeof *list->spheres,
                            error))
        return SHAPE_ERROR_MEMORY;
    return shape_array_reserve((void **)&list->ellipsoids, &list->ellipsoid_capacity, ellipsoids,
                               sizeof *list->ellipsoids, error);
}

shape_status shape_primitives_add_sphere(shape_primitives *list, shape_sphere sphere, shape_error *error)
{
    shape_status status = list_check_sphere(&sphere, error);
    if (!status)
        status = shape_primitives_reserve(list, list->sphere_count + 1, 0, error);
    if (!status)
        list->spheres[list->sphere_count++] = sphere;
    return status;
}

shape_status shape_primitives_add_ellipsoid(shape_primitives *list, shape_ellipsoid ellipsoid,
                                            shape_error *error)
{
    shape_status status = list_check_ellipsoid(&ellipsoid, error);
    if (!status)
        status = shape_primitives_reserve(list, 0, list->ellipsoid_count + 1, error);
    if (status)
        return status;
    ellipsoid.q = shape_quat_normalize(ellipsoid.q);
    ellipsoid.pad0 = ellipsoid.pad1 = 0;
    list->ellipsoids[list->ellipsoid_count++] = ellipsoid;
    return SHAPE_OK;
}

size_t shape_primitives_count(const shape_primitives *list)
{
    return list->sphere_count + list->ellipsoid_count;
}

shape_box shape_sphere_box(const shape_sphere *s, float grow)
{
    float r = s->radius * grow;
    shape_box box = {{s->x - r, s->y - r, s->z - r}, {s->x + r, s->y + r, s->z + r}};
    return box;
}

shape_box shape_ellipsoid_box(const shape_ellipsoid *e, float grow)
{
    /* The support function of a linear image of the ball: half extents are the norms of the rows of R diag(a). */
    double m[3][3], half[3];
    shape_quat_matrix(e->q, m);
    for (int i = 0; i < 3; i++)
        half[i] = grow * sqrt(m[i][0] * m[i][0] * e->a * e->a + m[i][1] * m[i][1] * e->b * e->b +
                              m[i][2] * m[i][2] * e->c * e->c);
    shape_box box = {{(float)(e->x - half[0]), (float)(e->y - half[1]), (float)(e->z - half[2])},
                     {(float)(e->x + half[0]), (float)(e->y + half[1]), (float)(e->z + half[2])}};
    return box;
}

shape_sphere shape_sphere_grow(const shape_sphere *sphere, float support, float margin)
{
    shape_sphere grown = *sphere;
    grown.radius = sphere->radius * support + margin;
    return grown;
}

shape_ellipsoid shape_ellipsoid_grow(const shape_ellipsoid *ellipsoid, float support, float margin)
{
    /* With s = sqrt(trace A^2 / trace M^2): (1 + 1/s) A^2 + (1 + s) M^2 holds the sum of both. */
    shape_ellipsoid grown = *ellipsoid;
    float a = ellipsoid->a * support, b = ellipsoid->b * support, c = ellipsoid->c * support;
    if (margin > 0) {
        float s = sqrtf((a * a + b * b + c * c) / (3 * margin * margin));
        float keep = 1 + 1 / s, add = (1 + s) * margin * margin;
        a = sqrtf(keep * a * a + add);
        b = sqrtf(keep * b * b + add);
        c = sqrtf(keep * c * c + add);
    }
    grown.a = a, grown.b = b, grown.c = c;
    return grown;
}
