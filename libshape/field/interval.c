/* Rays against boxes and supports, and the joined intervals that are marched once (no duplicate tracing, Jiménez 2018
 * section 3.3, taken on the union so that density does not depend on the view). Mirrored by shaders/field/interval.glsl. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/stop.h"
#include "field/grid_ray.h"
#include "shape/volume.h"

shape_ray shape_volume_ray(const shape_volume_cloud *cloud, shape_dvec3 origin, shape_dvec3 direction)
{
    shape_dvec3 o = shape_frame_point(&cloud->inverse, origin);
    shape_dvec3 d = shape_frame_direction(&cloud->inverse, direction);
    shape_ray ray = {{(float)o.x, (float)o.y, (float)o.z}, {(float)d.x, (float)d.y, (float)d.z}};
    return ray;
}

/* One pair of slabs; a ray that runs along them is in or out, whatever 0/0 would have said. */
static bool clip(float min, float max, float origin, float direction, float *t0, float *t1)
{
    if (direction == 0)
        return origin >= min && origin <= max;
    float inverse = 1 / direction;
    float near = (min - origin) * inverse, far = (max - origin) * inverse;
    if (inverse < 0) {
        float swap = near;
        near = far;
        far = swap;
    }
    *t0 = near > *t0 ? near : *t0;
    *t1 = far < *t1 ? far : *t1;
    return *t0 <= *t1;
}

bool shape_box_intersect(shape_box box, shape_ray ray, float *t0, float *t1)
{
    float a = *t0, b = *t1;
    if (!clip(box.min.x, box.max.x, ray.origin.x, ray.direction.x, &a, &b) ||
        !clip(box.min.y, box.max.y, ray.origin.y, ray.direction.y, &a, &b) ||
        !clip(box.min.z, box.max.z, ray.origin.z, ray.direction.z, &a, &b))
        return false;
    *t0 = a, *t1 = b;
    return true;
}

/* A ray against the ball |v + t d| <= radius. */
static bool intersect_ball(shape_vec3 v, shape_vec3 d, float radius, shape_candidate *hit)
{
    float a = shape_vec3_dot(d, d);
    if (!(a > 0))
        return false;
    float middle = -shape_vec3_dot(v, d) / a;
    shape_vec3 closest = shape_vec3_add(v, shape_vec3_scale(d, middle));
    float room = radius * radius - shape_vec3_dot(closest, closest);
    if (!(room > 0))
        return false;
    float half = sqrtf(room / a);
    hit->t_in = middle - half;
    hit->t_out = middle + half;
    hit->a = a;
    return hit->t_in < hit->t_out;
}

bool shape_sphere_intersect(const shape_sphere *s, float support, shape_ray ray, shape_candidate *hit)
{
    shape_vec3 v = {ray.origin.x - s->x, ray.origin.y - s->y, ray.origin.z - s->z};
    if (!intersect_ball(v, ray.direction, s->radius * support, hit))
        return false;
    hit->a /= s->radius * s->radius;
    return true;
}

bool shape_ellipsoid_intersect(const shape_ellipsoid *e, float support, shape_ray ray, shape_candidate *hit)
{
    shape_quat back = shape_quat_conjugate(e->q);
    shape_vec3 v = {ray.origin.x - e->x, ray.origin.y - e->y, ray.origin.z - e->z}, d;
    v = shape_quat_rotate(back, v);
    d = shape_quat_rotate(back, ray.direction);
    v = shape_vec3_make(v.x / e->a, v.y / e->b, v.z / e->c);
    d = shape_vec3_make(d.x / e->a, d.y / e->b, d.z / e->c);
    return intersect_ball(v, d, support, hit);
}

static int compare_entries(const void *a, const void *b)
{
    float x = ((const shape_candidate *)a)->t_in, y = ((const shape_candidate *)b)->t_in;
    return (x > y) - (x < y);
}

/* Insertion for the few that a ray usually meets, the library's sort for crowds. */
static void sort_candidates(shape_candidates *found)
{
    if (found->count > 32) {
        qsort(found->items, found->count, sizeof *found->items, compare_entries);
        return;
    }
    for (size_t i = 1; i < found->count; i++) {
        shape_candidate item = found->items[i];
        size_t j = i;
        for (; j > 0 && found->items[j - 1].t_in > item.t_in; j--)
            found->items[j] = found->items[j - 1];
        found->items[j] = item;
    }
}

/* Whether to break off, after so much more work. */
static bool stops(shape_candidates *found, size_t work)
{
    if (!found->stop.asked || (found->work += work) < STOP_INTERVAL)
        return false;
    found->work = 0;
    return found->stop.asked(found->stop.context);
}

shape_status shape_cloud_candidates(const shape_volume_cloud *cloud, shape_ray ray, float t_min, float t_max,
                                    shape_candidates *found, shape_error *error)
{
    const shape_tree *tree = cloud->tree;
    found->count = 0;
    if (cloud->field.model == SHAPE_MODEL_GRID)
        return grid_candidates(cloud->list->grid, ray, t_min, t_max, found, error);
    for (size_t i = 0; i < tree->count;) {
        const shape_tree_node *node = &tree->nodes[i];
        float t0 = t_min, t1 = t_max;
        shape_box box = {node->min, node->max};
        if (stops(found, 1))
            return stop_error(error);
        if (!shape_box_intersect(box, ray, &t0, &t1)) {
            i = (size_t)node->skip;
            continue;
        }
        i++;
        if (node->content == 0)
            continue;
        shape_candidate hit;
        bool meets = node->content > 0
                         ? shape_sphere_intersect(&cloud->list->spheres[(size_t)node->content - 1],
                                                  cloud->support, ray, &hit)
                         : shape_ellipsoid_intersect(&cloud->list->ellipsoids[(size_t)-node->content - 1],
                                                     cloud->support, ray, &hit);
        if (!meets || hit.t_out <= t_min || hit.t_in >= t_max)
            continue;
        if (shape_array_reserve((void **)&found->items, &found->capacity, found->count + 1,
                                sizeof *found->items, error))
            return SHAPE_ERROR_MEMORY;
        found->items[found->count++] = hit;
    }
    sort_candidates(found);
    return SHAPE_OK;
}

void shape_candidates_free(shape_candidates *found)
{
    free(found->items);
    memset(found, 0, sizeof *found);
}

bool shape_candidates_join(const shape_candidates *found, float t_min, float t_max, size_t *first,
                           size_t *next, float *t0, float *t1)
{
    size_t i = *next;
    if (i >= found->count)
        return false;
    *first = i;
    float end = found->items[i].t_out;
    *t0 = found->items[i].t_in > t_min ? found->items[i].t_in : t_min;
    for (i++; i < found->count && found->items[i].t_in <= end; i++)
        end = found->items[i].t_out > end ? found->items[i].t_out : end;
    *next = i;
    *t1 = end < t_max ? end : t_max;
    return true;
}

float shape_candidates_u2(const shape_candidates *found, size_t first, size_t end, float support2, float t)
{
    float least = INFINITY;
    for (size_t i = first; i < end && found->items[i].t_in <= t; i++) {
        const shape_candidate *c = &found->items[i];
        if (t <= c->t_out) {
            float u2 = support2 + c->a * (t - c->t_in) * (t - c->t_out);
            least = u2 < least ? u2 : least;
        }
    }
    return least < 0 ? 0 : least;
}

/* Adds a cloud's optical depth; false where it was broken off. */
static bool add_depth(const shape_volume_cloud *cloud, shape_ray ray, shape_candidates *found, float t_min,
                      float t_max, float step, double *depth)
{
    double sum = 0;
    size_t first, next = 0;
    float t0, t1, support2 = cloud->support * cloud->support;
    if (cloud->field.model == SHAPE_MODEL_GRID && step * shape_vec3_length(ray.direction) <= 1) {
        *depth += shape_grid_integral(cloud->list->grid, ray.origin, ray.direction, t_min, t_max) *
                  (double)cloud->medium.extinction;
        return true;
    }
    while (shape_candidates_join(found, t_min, t_max, &first, &next, &t0, &t1)) {
        int steps = (int)ceilf(fminf((t1 - t0) / step, 1e6f));
        steps = steps < 1 ? 1 : steps;
        float width = (t1 - t0) / (float)steps, density = 0;
        for (int i = 0; i < steps; i++) {
            float t = t0 + width * ((float)i + 0.5f);
            if (stops(found, next - first))
                return false;
            float u2 = shape_candidates_u2(found, first, next, support2, t);
            density += shape_cloud_density_at(
                cloud, shape_vec3_add(ray.origin, shape_vec3_scale(ray.direction, t)), u2);
        }
        sum += (double)density * (double)width;
    }
    *depth += sum * (double)cloud->medium.extinction;
    return true;
}

shape_status shape_volume_optical_depth(const shape_volume *volume, shape_dvec3 origin, shape_dvec3 direction,
                                        float t_min, float t_max, float step, shape_candidates *scratch,
                                        double *depth, shape_error *error)
{
    *depth = 0;
    for (size_t i = 0; i < volume->cloud_count; i++) {
        const shape_volume_cloud *cloud = &volume->clouds[i];
        shape_ray ray = shape_volume_ray(cloud, origin, direction);
        float t0 = t_min, t1 = t_max;
        if (!shape_box_intersect(cloud->box, ray, &t0, &t1))
            continue;
        shape_status status = shape_cloud_candidates(cloud, ray, t0, t1, scratch, error);
        if (status)
            return status;
        if (!add_depth(cloud, ray, scratch, t0, t1, step, depth))
            return stop_error(error);
    }
    return SHAPE_OK;
}
