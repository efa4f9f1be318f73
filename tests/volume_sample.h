/* For tests: sets ready to be looked at, random primitives of awkward shapes, and u^2 in double precision, written
 * without the library's own functions. */
#ifndef VOLUME_SAMPLE_H
#define VOLUME_SAMPLE_H

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "shape/random.h"
#include "shape/volume.h"

static inline void must(shape_status status, const shape_error *error)
{
    if (status)
        fail_msg("%s", error->text);
}

static inline float draw(shape_random *random, double low, double high)
{
    return (float)shape_random_range(random, low, high);
}

static inline shape_vec3 draw_point(shape_random *random, double half)
{
    float x = draw(random, -half, half), y = draw(random, -half, half), z = draw(random, -half, half);
    return shape_vec3_make(x, y, z);
}

static inline shape_vec3 draw_direction(shape_random *random)
{
    double x = shape_random_normal(random), y = shape_random_normal(random), z = shape_random_normal(random);
    shape_dvec3 d = shape_dvec3_normalize(shape_dvec3_make(x, y, z));
    return shape_vec3_make((float)d.x, (float)d.y, (float)d.z);
}

static inline shape_quat draw_rotation(shape_random *random)
{
    shape_quat q;
    q.x = draw(random, -1, 1), q.y = draw(random, -1, 1), q.z = draw(random, -1, 1),
    q.w = draw(random, -1, 1);
    return shape_quat_normalize(q);
}

static inline shape_set *new_set(void)
{
    shape_error error;
    shape_set *set = shape_set_create(&error);
    if (!set)
        fail_msg("%s", error.text);
    return set;
}

/* One more cloud, of that model, with an empty list and noise cells of a metre. */
static inline shape_cloud *new_cloud(shape_set *set, shape_model model)
{
    shape_error error;
    size_t index;
    must(shape_set_add_cloud(set, "cloud", &index, &error), &error);
    set->clouds[index].field.model = model;
    set->clouds[index].field.noise_scale = 1;
    return &set->clouds[index];
}

static inline void add_sphere(shape_set *set, size_t cloud, double x, double y, double z, double radius)
{
    shape_error error;
    shape_sphere s = {(float)x, (float)y, (float)z, (float)radius};
    must(shape_primitives_add_sphere(shape_set_list(set, cloud), s, &error), &error);
}

static inline void add_ellipsoid(shape_set *set, size_t cloud, shape_vec3 at, float a, float b, float c,
                                 shape_quat q)
{
    shape_error error;
    shape_ellipsoid e = {.x = at.x, .y = at.y, .z = at.z, .a = a, .b = b, .c = c, .q = q};
    must(shape_primitives_add_ellipsoid(shape_set_list(set, cloud), e, &error), &error);
}

/* Sizes are drawn evenly in their logarithm. */
static inline float draw_size(shape_random *random, double low, double high)
{
    return (float)(low * pow(high / low, shape_random_unit(random)));
}

static inline void add_random(shape_set *set, size_t cloud, shape_random *random, size_t spheres,
                              size_t ellipsoids, double half, double low, double high)
{
    for (size_t i = 0; i < spheres; i++) {
        shape_vec3 p = draw_point(random, half);
        add_sphere(set, cloud, (double)p.x, (double)p.y, (double)p.z, (double)draw_size(random, low, high));
    }
    for (size_t i = 0; i < ellipsoids; i++) {
        shape_vec3 p = draw_point(random, half);
        float a = draw_size(random, low, high), b = draw_size(random, low, high),
              c = draw_size(random, low, high);
        add_ellipsoid(set, cloud, p, a, b, c, draw_rotation(random));
    }
}

static inline shape_volume *new_volume(const shape_set *set)
{
    shape_error error;
    shape_volume *volume = NULL;
    must(shape_volume_create(set, &volume, &error), &error);
    return volume;
}

/* A point that is likely to be near something: drawn about a primitive's centre. */
static inline shape_vec3 point_near(const shape_primitives *list, shape_random *random)
{
    size_t count = shape_primitives_count(list), i = (size_t)(shape_random_unit(random) * (double)count);
    shape_vec3 d = draw_point(random, 1.3);
    if (i < list->sphere_count) {
        const shape_sphere *s = &list->spheres[i];
        return shape_vec3_make(s->x + d.x * s->radius, s->y + d.y * s->radius, s->z + d.z * s->radius);
    }
    const shape_ellipsoid *e = &list->ellipsoids[i - list->sphere_count];
    d = shape_quat_rotate(e->q, shape_vec3_make(d.x * e->a, d.y * e->b, d.z * e->c));
    return shape_vec3_make(e->x + d.x, e->y + d.y, e->z + d.z);
}

/* --- u^2 in double precision --- */

static inline double exact_sphere_u2(const shape_sphere *s, shape_dvec3 p)
{
    double x = p.x - (double)s->x, y = p.y - (double)s->y, z = p.z - (double)s->z;
    return (x * x + y * y + z * z) / ((double)s->radius * (double)s->radius);
}

/* R^T by the columns of the rotation matrix of a quaternion. */
static inline double exact_ellipsoid_u2(const shape_ellipsoid *e, shape_dvec3 p)
{
    double x = (double)e->q.x, y = (double)e->q.y, z = (double)e->q.z, w = (double)e->q.w;
    double length = x * x + y * y + z * z + w * w, s = 2 / length;
    double dx = p.x - (double)e->x, dy = p.y - (double)e->y, dz = p.z - (double)e->z;
    double u = (1 - s * (y * y + z * z)) * dx + s * (x * y + z * w) * dy + s * (x * z - y * w) * dz;
    double v = s * (x * y - z * w) * dx + (1 - s * (x * x + z * z)) * dy + s * (y * z + x * w) * dz;
    double t = s * (x * z + y * w) * dx + s * (y * z - x * w) * dy + (1 - s * (x * x + y * y)) * dz;
    u /= (double)e->a, v /= (double)e->b, t /= (double)e->c;
    return u * u + v * v + t * t;
}

static inline double exact_u2(const shape_primitives *list, shape_dvec3 p)
{
    double least = INFINITY;
    for (size_t i = 0; i < list->sphere_count; i++)
        least = fmin(least, exact_sphere_u2(&list->spheres[i], p));
    for (size_t i = 0; i < list->ellipsoid_count; i++)
        least = fmin(least, exact_ellipsoid_u2(&list->ellipsoids[i], p));
    return least;
}

static inline shape_dvec3 along(shape_ray ray, double t)
{
    return shape_dvec3_make((double)ray.origin.x + t * (double)ray.direction.x,
                            (double)ray.origin.y + t * (double)ray.direction.y,
                            (double)ray.origin.z + t * (double)ray.direction.z);
}

#endif
