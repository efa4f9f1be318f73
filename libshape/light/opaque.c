/* Opaque triangles in a tree of boxes, split at the median of the triangles' middles; rays against them by the watertight
 * test of Woop, Benthin and Wald 2013, in double precision. */
#include "shape/opaque.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

enum { LEAF = 4, MAX_TRIANGLES = SHAPE_MESH_MAX_TRIANGLES, STACK = 64 };

typedef struct opaque_triangle {
    double corner[3][3];
    uint32_t mesh;
} opaque_triangle;

/* A leaf holds triangles first .. first + count; else count is 0, one child follows the node and the other is `first`. */
typedef struct opaque_node {
    double min[3], max[3];
    uint32_t first, count;
} opaque_node;

typedef struct opaque_colour {
    float albedo[3];
    bool ground;
} opaque_colour;

struct shape_opaque {
    opaque_triangle *triangles;
    opaque_node *nodes;
    opaque_colour *colours; /* one a mesh */
    size_t count, capacity, node_count, node_capacity, colour_count, colour_capacity;
    double hair; /* how far off a surface a ray begins [m] */
};

shape_opaque *shape_opaque_create(shape_error *error)
{
    shape_opaque *opaque = calloc(1, sizeof *opaque);
    if (!opaque)
        shape_error_memory(error);
    return opaque;
}

void shape_opaque_destroy(shape_opaque *opaque)
{
    if (!opaque)
        return;
    free(opaque->triangles);
    free(opaque->nodes);
    free(opaque->colours);
    free(opaque);
}

static bool has_area(const opaque_triangle *t)
{
    double a[3], b[3];
    for (int i = 0; i < 3; i++) {
        a[i] = t->corner[1][i] - t->corner[0][i];
        b[i] = t->corner[2][i] - t->corner[0][i];
    }
    double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    return x * x + y * y + z * z > 0;
}

static shape_status check_mesh(const shape_opaque *opaque, const shape_mesh *mesh, const float albedo[3],
                               shape_error *error)
{
    for (int c = 0; c < 3; c++)
        if (!(albedo[c] >= 0 && albedo[c] <= 1))
            return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                                   "a mesh's colour of %g (each channel must be from 0 to 1)",
                                   (double)albedo[c]);
    if (mesh->triangle_count > MAX_TRIANGLES - opaque->count)
        return shape_error_set(error, SHAPE_ERROR_LIMIT,
                               "more than %d opaque triangles (decimate the meshes)", (int)MAX_TRIANGLES);
    return SHAPE_OK;
}

shape_status shape_opaque_add(shape_opaque *opaque, const shape_mesh *mesh, const shape_frame *frame,
                              const float albedo[3], shape_error *error)
{
    shape_status status = check_mesh(opaque, mesh, albedo, error);
    if (!status)
        status = shape_array_reserve((void **)&opaque->triangles, &opaque->capacity,
                                     opaque->count + mesh->triangle_count, sizeof *opaque->triangles, error);
    if (!status)
        status = shape_array_reserve((void **)&opaque->colours, &opaque->colour_capacity,
                                     opaque->colour_count + 1, sizeof *opaque->colours, error);
    if (status)
        return status;
    size_t count = opaque->count;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        opaque_triangle *t = &opaque->triangles[count];
        t->mesh = (uint32_t)opaque->colour_count;
        for (int k = 0; k < 3; k++) {
            shape_dvec3 p = mesh->points[mesh->indices[3 * i + (size_t)k]];
            p = frame ? shape_frame_point(frame, p) : p;
            t->corner[k][0] = p.x, t->corner[k][1] = p.y, t->corner[k][2] = p.z;
            if (!isfinite(p.x) || !isfinite(p.y) || !isfinite(p.z))
                return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                                       "a mesh's point is not finite (check its placement)");
        }
        count += has_area(t);
    }
    opaque->count = count;
    opaque_colour *colour = &opaque->colours[opaque->colour_count++];
    memcpy(colour->albedo, albedo, sizeof colour->albedo);
    colour->ground = false;
    opaque->node_count = 0;
    return SHAPE_OK;
}

shape_status shape_opaque_add_ground(shape_opaque *opaque, double height, const float albedo[3],
                                     shape_error *error)
{
    const double far = SHAPE_OPAQUE_GROUND_SIDE / 2;
    shape_dvec3 points[] = {
        {-far, height, -far}, {-far, height, far}, {far, height, far}, {far, height, -far}};
    uint32_t indices[] = {0, 1, 2, 0, 2, 3};
    const shape_mesh mesh = {.points = points, .indices = indices, .point_count = 4, .triangle_count = 2};
    shape_status status = shape_opaque_add(opaque, &mesh, NULL, albedo, error);
    if (!status)
        opaque->colours[opaque->colour_count - 1].ground = true;
    return status;
}

shape_opaque_triangle shape_opaque_get_triangle(const shape_opaque *opaque, size_t index)
{
    const opaque_triangle *t = &opaque->triangles[index];
    const opaque_colour *colour = &opaque->colours[t->mesh];
    shape_opaque_triangle triangle = {.albedo = colour->albedo, .ground = colour->ground};
    for (int k = 0; k < 3; k++)
        triangle.corner[k] = shape_dvec3_make(t->corner[k][0], t->corner[k][1], t->corner[k][2]);
    return triangle;
}

/* --- the tree --- */

static double middle(const opaque_triangle *t, int axis)
{
    return t->corner[0][axis] + t->corner[1][axis] + t->corner[2][axis];
}

/* Puts the triangle that belongs at place k there, none greater before it and none less behind it (Hoare 1961). */
static void select_median(opaque_triangle *t, size_t count, size_t k, int axis)
{
    size_t low = 0, high = count - 1;
    while (low < high) {
        double pivot = middle(&t[low + (high - low) / 2], axis);
        size_t i = low, j = high;
        for (;;) {
            while (middle(&t[i], axis) < pivot)
                i++;
            while (middle(&t[j], axis) > pivot)
                j--;
            if (i >= j)
                break;
            opaque_triangle swap = t[i];
            t[i++] = t[j];
            t[j--] = swap;
        }
        if (k <= j)
            high = j;
        else
            low = j + 1;
    }
}

static void node_box(opaque_node *node, const opaque_triangle *t, size_t count)
{
    for (int a = 0; a < 3; a++) {
        node->min[a] = INFINITY, node->max[a] = -INFINITY;
        for (size_t i = 0; i < count; i++)
            for (int k = 0; k < 3; k++) {
                node->min[a] = fmin(node->min[a], t[i].corner[k][a]);
                node->max[a] = fmax(node->max[a], t[i].corner[k][a]);
            }
    }
}

/* As deep as the logarithm of the number of triangles. */
static shape_status build(shape_opaque *opaque, size_t first, size_t count, shape_error *error)
{
    if (shape_array_reserve((void **)&opaque->nodes, &opaque->node_capacity, opaque->node_count + 1,
                            sizeof *opaque->nodes, error))
        return SHAPE_ERROR_MEMORY;
    size_t index = opaque->node_count++;
    opaque_triangle *t = opaque->triangles + first;
    opaque_node node = {{0}, {0}, (uint32_t)first, (uint32_t)count};
    node_box(&node, t, count);
    opaque->nodes[index] = node;
    if (count <= LEAF)
        return SHAPE_OK;
    int axis = 0;
    for (int a = 1; a < 3; a++)
        if (node.max[a] - node.min[a] > node.max[axis] - node.min[axis])
            axis = a;
    select_median(t, count, count / 2, axis);
    shape_status status = build(opaque, first, count / 2, error);
    opaque->nodes[index].first = (uint32_t)opaque->node_count;
    opaque->nodes[index].count = 0;
    return status ? status : build(opaque, first + count / 2, count - count / 2, error);
}

shape_status shape_opaque_finish(shape_opaque *opaque, shape_error *error)
{
    opaque->node_count = 0;
    if (!opaque->count)
        return SHAPE_OK;
    shape_status status = build(opaque, 0, opaque->count, error);
    if (status) {
        opaque->node_count = 0;
        return status;
    }
    double largest = 0;
    for (int a = 0; a < 3; a++)
        largest = fmax(largest, fmax(fabs(opaque->nodes[0].min[a]), fabs(opaque->nodes[0].max[a])));
    opaque->hair = fmax(largest * 1e-11, 1e-12);
    return SHAPE_OK;
}

size_t shape_opaque_triangle_count(const shape_opaque *opaque)
{
    return opaque ? opaque->count : 0;
}

bool shape_opaque_bounds(const shape_opaque *opaque, shape_dvec3 *min, shape_dvec3 *max)
{
    if (!opaque || !opaque->node_count)
        return false;
    const opaque_node *root = opaque->nodes;
    *min = shape_dvec3_make(root->min[0], root->min[1], root->min[2]);
    *max = shape_dvec3_make(root->max[0], root->max[1], root->max[2]);
    return true;
}

/* --- rays --- */

/* A ray sheared so that it runs along its longest axis, kz. */
typedef struct opaque_ray {
    double origin[3], direction[3], inverse[3], shear[3];
    int kx, ky, kz;
} opaque_ray;

static opaque_ray make_ray(shape_dvec3 origin, shape_dvec3 direction)
{
    opaque_ray ray = {
        {origin.x, origin.y, origin.z}, {direction.x, direction.y, direction.z}, {0}, {0}, 0, 0, 0};
    const double *d = ray.direction;
    ray.kz = fabs(d[0]) > fabs(d[1]) ? (fabs(d[0]) > fabs(d[2]) ? 0 : 2) : (fabs(d[1]) > fabs(d[2]) ? 1 : 2);
    ray.kx = (ray.kz + 1) % 3;
    ray.ky = (ray.kx + 1) % 3;
    for (int a = 0; a < 3; a++)
        ray.inverse[a] = 1 / d[a];
    ray.shear[0] = d[ray.kx] / d[ray.kz];
    ray.shear[1] = d[ray.ky] / d[ray.kz];
    ray.shear[2] = 1 / d[ray.kz];
    return ray;
}

/* The t of the triangle's plane where the ray meets the triangle before `end`, else `end`. */
static double meet_triangle(const opaque_ray *ray, const opaque_triangle *t, double end)
{
    double x[3], y[3], z[3];
    for (int k = 0; k < 3; k++) {
        double away = t->corner[k][ray->kz] - ray->origin[ray->kz];
        x[k] = t->corner[k][ray->kx] - ray->origin[ray->kx] - ray->shear[0] * away;
        y[k] = t->corner[k][ray->ky] - ray->origin[ray->ky] - ray->shear[1] * away;
        z[k] = ray->shear[2] * away;
    }
    double u = x[2] * y[1] - y[2] * x[1], v = x[0] * y[2] - y[0] * x[2], w = x[1] * y[0] - y[1] * x[0];
    double sum = u + v + w;
    if (((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) || sum == 0)
        return end;
    double distance = (u * z[0] + v * z[1] + w * z[2]) / sum;
    return distance > 0 && distance < end ? distance : end;
}

/* Where the ray enters the box, or `end` where it does not before. A hair is allowed for roundings. */
static double meet_box(const opaque_ray *ray, const opaque_node *node, double end)
{
    double near = 0, far = end;
    for (int a = 0; a < 3; a++) {
        if (ray->direction[a] == 0) {
            if (!(ray->origin[a] >= node->min[a] && ray->origin[a] <= node->max[a]))
                return end;
            continue;
        }
        double t0 = (node->min[a] - ray->origin[a]) * ray->inverse[a];
        double t1 = (node->max[a] - ray->origin[a]) * ray->inverse[a];
        near = fmax(near, fmin(t0, t1) * (1 - 1e-14));
        far = fmin(far, fmax(t0, t1) * (1 + 1e-14));
    }
    return near <= far ? near : end;
}

/* The nearest triangle before *end, or any where one is enough. */
static const opaque_triangle *walk(const shape_opaque *opaque, const opaque_ray *ray, double *end, bool any)
{
    const opaque_triangle *found = NULL;
    uint32_t stack[STACK];
    int top = 0;
    if (!opaque || !opaque->node_count || !(meet_box(ray, opaque->nodes, *end) < *end))
        return NULL;
    stack[top++] = 0;
    while (top) {
        uint32_t index = stack[--top];
        const opaque_node *node = &opaque->nodes[index];
        for (uint32_t i = 0; i < node->count; i++) {
            const opaque_triangle *t = &opaque->triangles[node->first + i];
            double distance = meet_triangle(ray, t, *end);
            if (distance < *end) {
                *end = distance;
                found = t;
                if (any)
                    return found;
            }
        }
        if (node->count)
            continue;
        uint32_t one = index + 1, other = node->first;
        double a = meet_box(ray, &opaque->nodes[one], *end), b = meet_box(ray, &opaque->nodes[other], *end);
        if (a > b) { /* the nearer one is taken first */
            uint32_t swap = one;
            one = other;
            other = swap;
            double t = a;
            a = b;
            b = t;
        }
        if (b < *end)
            stack[top++] = other;
        if (a < *end)
            stack[top++] = one;
    }
    return found;
}

bool shape_opaque_find(const shape_opaque *opaque, shape_dvec3 origin, shape_dvec3 direction, double t_max,
                       shape_opaque_hit *hit)
{
    opaque_ray ray = make_ray(origin, direction);
    const opaque_triangle *t = walk(opaque, &ray, &t_max, false);
    if (!t)
        return false;
    shape_dvec3 corner[3];
    for (int k = 0; k < 3; k++)
        corner[k] = shape_dvec3_make(t->corner[k][0], t->corner[k][1], t->corner[k][2]);
    shape_dvec3 normal = shape_dvec3_normalize(
        shape_dvec3_cross(shape_dvec3_sub(corner[1], corner[0]), shape_dvec3_sub(corner[2], corner[0])));
    if (shape_dvec3_dot(normal, direction) > 0)
        normal = shape_dvec3_scale(normal, -1);
    hit->t = t_max;
    hit->normal = normal;
    hit->albedo = opaque->colours[t->mesh].albedo;
    hit->point = shape_dvec3_add(shape_dvec3_add(origin, shape_dvec3_scale(direction, t_max)),
                                 shape_dvec3_scale(normal, opaque->hair + 1e-14 * t_max));
    return true;
}

bool shape_opaque_blocks(const shape_opaque *opaque, shape_dvec3 origin, shape_dvec3 direction, double t_max)
{
    opaque_ray ray = make_ray(origin, direction);
    return walk(opaque, &ray, &t_max, true) != NULL;
}
