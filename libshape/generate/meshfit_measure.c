/* How well primitives stand for a mesh: what share of its surface they cover, and how far they stick out of it. */
#include "shape/meshfit.h"

#include <float.h>
#include <stdlib.h>

#include "shape/random.h"

enum { SURFACE_POINTS = 32 };

/* Every primitive as an ellipsoid. */
static shape_ellipsoid primitive_at(const shape_primitives *list, size_t i)
{
    if (i < list->ellipsoid_count)
        return list->ellipsoids[i];
    shape_sphere s = list->spheres[i - list->ellipsoid_count];
    shape_ellipsoid e = {s.x, s.y, s.z, 0, s.radius, s.radius, s.radius, 0, shape_quat_identity()};
    return e;
}

static bool is_inside(const shape_ellipsoid *e, shape_vec3 p)
{
    shape_vec3 d = shape_vec3_sub(p, shape_vec3_make(e->x, e->y, e->z));
    float reach = fmaxf(e->a, fmaxf(e->b, e->c));
    if (shape_vec3_dot(d, d) > reach * reach * 1.0001f)
        return false;
    d = shape_quat_rotate(shape_quat_conjugate(e->q), d);
    float x = d.x / e->a, y = d.y / e->b, z = d.z / e->c;
    return x * x + y * y + z * z <= 1;
}

static bool is_covered(const shape_primitives *list, shape_vec3 p)
{
    size_t count = shape_primitives_count(list);
    for (size_t i = 0; i < count; i++) {
        shape_ellipsoid e = primitive_at(list, i);
        if (is_inside(&e, p))
            return true;
    }
    return false;
}

static void corners_of(const shape_mesh *mesh, size_t t, shape_dvec3 corner[3])
{
    for (int i = 0; i < 3; i++)
        corner[i] = mesh->points[mesh->indices[3 * t + (size_t)i]];
}

/* The square of the distance from p to a triangle: to its plane where p stands above it, else to the nearest edge. */
static double distance2(const shape_dvec3 corner[3], shape_dvec3 p)
{
    shape_dvec3 normal =
        shape_dvec3_cross(shape_dvec3_sub(corner[1], corner[0]), shape_dvec3_sub(corner[2], corner[0]));
    double best = DBL_MAX;
    bool above = true;
    for (int i = 0; i < 3; i++) {
        shape_dvec3 edge = shape_dvec3_sub(corner[(i + 1) % 3], corner[i]),
                    to = shape_dvec3_sub(p, corner[i]);
        above = above && shape_dvec3_dot(shape_dvec3_cross(normal, edge), to) >= 0;
        double length2 = shape_dvec3_dot(edge, edge);
        double t = length2 > 0 ? fmin(fmax(shape_dvec3_dot(edge, to) / length2, 0), 1) : 0;
        shape_dvec3 away = shape_dvec3_sub(to, shape_dvec3_scale(edge, t));
        best = fmin(best, shape_dvec3_dot(away, away));
    }
    double square = shape_dvec3_dot(normal, normal);
    if (!above || !(square > 0))
        return best;
    double height = shape_dvec3_dot(normal, shape_dvec3_sub(p, corner[0]));
    return height * height / square;
}

/* A ball around each triangle, so that most are passed over by one comparison. */
typedef struct ball {
    shape_dvec3 centre;
    double radius;
} ball;

static double nearest(const shape_mesh *mesh, const ball *balls, shape_dvec3 p)
{
    double best = DBL_MAX, best2 = DBL_MAX;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        shape_dvec3 d = shape_dvec3_sub(p, balls[t].centre);
        double reach = best + balls[t].radius;
        if (best < DBL_MAX && shape_dvec3_dot(d, d) > reach * reach)
            continue;
        shape_dvec3 corner[3];
        corners_of(mesh, t, corner);
        double square = distance2(corner, p);
        if (square < best2) {
            best2 = square;
            best = sqrt(square);
        }
    }
    return best;
}

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double share_covered(const shape_mesh *mesh, const double *areas, const shape_primitives *list,
                            size_t samples)
{
    shape_random random = shape_random_seed(1, 0);
    double total = areas[mesh->triangle_count - 1];
    size_t covered = 0;
    for (size_t s = 0; s < samples; s++) {
        /* Stratified along the triangles' running area. */
        double at = total * ((double)s + shape_random_unit(&random)) / (double)samples;
        size_t low = 0, high = mesh->triangle_count - 1;
        while (low < high) {
            size_t middle = (low + high) / 2;
            if (areas[middle] > at)
                high = middle;
            else
                low = middle + 1;
        }
        shape_dvec3 corner[3];
        corners_of(mesh, low, corner);
        double r = sqrt(shape_random_unit(&random)), t = shape_random_unit(&random);
        shape_dvec3 p = shape_dvec3_add(
            shape_dvec3_scale(corner[0], 1 - r),
            shape_dvec3_add(shape_dvec3_scale(corner[1], r * (1 - t)), shape_dvec3_scale(corner[2], r * t)));
        covered += is_covered(list, shape_vec3_make((float)p.x, (float)p.y, (float)p.z));
    }
    return (double)covered / (double)samples;
}

/* Points spread evenly over the sphere (a Fibonacci spiral), drawn out to the ellipsoid. */
static shape_dvec3 surface_point(const shape_ellipsoid *e, int i)
{
    double z = 1 - (2 * i + 1.0) / SURFACE_POINTS, r = sqrt(1 - z * z), turn = 2.399963229728653 * i;
    shape_vec3 d = {(float)(r * shape_cos(turn)) * e->a, (float)(r * shape_sin(turn)) * e->b,
                    (float)z * e->c};
    d = shape_quat_rotate(e->q, d);
    return shape_dvec3_make((double)(e->x + d.x), (double)(e->y + d.y), (double)(e->z + d.z));
}

static void prepare(const shape_mesh *mesh, double *areas, ball *balls)
{
    double sum = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        shape_dvec3 c[3];
        corners_of(mesh, t, c);
        sum +=
            shape_dvec3_length(shape_dvec3_cross(shape_dvec3_sub(c[1], c[0]), shape_dvec3_sub(c[2], c[0])));
        areas[t] = sum;
        shape_dvec3 centre = shape_dvec3_scale(shape_dvec3_add(c[0], shape_dvec3_add(c[1], c[2])), 1.0 / 3);
        balls[t].centre = centre;
        balls[t].radius = 0;
        for (int i = 0; i < 3; i++)
            balls[t].radius = fmax(balls[t].radius, shape_dvec3_length(shape_dvec3_sub(c[i], centre)));
    }
}

shape_status shape_meshfit_compare(const shape_mesh *mesh, const shape_primitives *list, size_t samples,
                                   shape_meshfit_measure *measure, shape_error *error)
{
    size_t count = shape_primitives_count(list), points = count * SURFACE_POINTS;
    if (!mesh->triangle_count || !count || !samples)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "there is nothing to compare");
    double *areas = malloc(mesh->triangle_count * sizeof *areas);
    ball *balls = malloc(mesh->triangle_count * sizeof *balls);
    double *away = malloc(points * sizeof *away);
    if (!areas || !balls || !away) {
        free(areas);
        free(balls);
        free(away);
        return shape_error_memory(error);
    }
    prepare(mesh, areas, balls);
    measure->covered = share_covered(mesh, areas, list, samples);
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < points; i++) {
        shape_ellipsoid e = primitive_at(list, i / SURFACE_POINTS);
        away[i] = nearest(mesh, balls, surface_point(&e, (int)(i % SURFACE_POINTS)));
    }
    shape_dvec3 min = {0, 0, 0}, max = {1, 1, 1};
    shape_mesh_bounds(mesh, &min, &max);
    double diagonal = shape_dvec3_length(shape_dvec3_sub(max, min)), sum = 0;
    qsort(away, points, sizeof *away, compare);
    for (size_t i = 0; i < points; i++)
        sum += away[i];
    measure->mean_sticking = sum / (double)points / diagonal;
    measure->p95_sticking = away[(points - 1) * 95 / 100] / diagonal;
    measure->max_sticking = away[points - 1] / diagonal;
    free(areas);
    free(balls);
    free(away);
    return SHAPE_OK;
}
