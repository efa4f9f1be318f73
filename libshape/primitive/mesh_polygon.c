/* Polygons to triangles by clipping ears (Meisters 1975), in the plane of the polygon's mean normal (Newell's sum). */
#include "shape/mesh.h"

enum { LARGEST = 4096 };

typedef struct ring {
    const double (*flat)[2];
    const uint32_t *next, *previous;
} ring;

static double turn(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* Two directions across the mean normal, so that the polygon runs counter-clockwise in them. */
static bool choose_plane(const shape_dvec3 *points, const uint32_t *corners, size_t count,
                         shape_dvec3 *across, shape_dvec3 *up)
{
    shape_dvec3 normal = {0, 0, 0}, origin = points[corners[0]];
    for (size_t i = 1; i + 1 < count; i++)
        normal = shape_dvec3_add(normal, shape_dvec3_cross(shape_dvec3_sub(points[corners[i]], origin),
                                                           shape_dvec3_sub(points[corners[i + 1]], origin)));
    normal = shape_dvec3_normalize(normal);
    if (!(shape_dvec3_dot(normal, normal) > 0.5))
        return false;
    shape_dvec3 helper = fabs(normal.x) < 0.6 ? shape_dvec3_make(1, 0, 0) : shape_dvec3_make(0, 1, 0);
    *across = shape_dvec3_normalize(shape_dvec3_cross(helper, normal));
    *up = shape_dvec3_cross(normal, *across);
    return true;
}

/* Whether cutting corner i off takes no other corner of the ring with it. */
static bool is_ear(const ring *r, uint32_t i, size_t left)
{
    const double *a = r->flat[r->previous[i]], *b = r->flat[i], *c = r->flat[r->next[i]];
    if (turn(a, b, c) <= 0)
        return false;
    uint32_t j = r->next[r->next[i]];
    for (size_t k = 3; k < left; k++, j = r->next[j]) {
        const double *p = r->flat[j];
        /* A polygon with a hole comes back to the same place along its bridge; that is no obstacle. */
        if ((p[0] == a[0] && p[1] == a[1]) || (p[0] == c[0] && p[1] == c[1]))
            continue;
        if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0)
            return false;
    }
    return true;
}

static void cut_fan(const uint32_t *corners, size_t count, uint32_t *triangles)
{
    for (size_t i = 0; i + 2 < count; i++) {
        triangles[3 * i] = corners[0];
        triangles[3 * i + 1] = corners[i + 1];
        triangles[3 * i + 2] = corners[i + 2];
    }
}

static bool cut_ears(const double (*flat)[2], const uint32_t *corners, size_t count, uint32_t *triangles,
                     uint32_t *next, uint32_t *previous)
{
    for (uint32_t i = 0; i < count; i++) {
        next[i] = i + 1 == count ? 0 : i + 1;
        previous[i] = i ? i - 1 : (uint32_t)count - 1;
    }
    ring r = {flat, next, previous};
    uint32_t at = 1; /* a convex quad is cut from its first corner, as Blender does */
    size_t left = count, tried = 0;
    while (left > 3) {
        if (!is_ear(&r, at, left)) {
            if (++tried > left)
                return false;
            at = next[at];
            continue;
        }
        *triangles++ = corners[previous[at]];
        *triangles++ = corners[at];
        *triangles++ = corners[next[at]];
        next[previous[at]] = next[at];
        previous[next[at]] = previous[at];
        /* Going on two further makes rounder triangles than a fan about one corner. */
        at = next[next[at]];
        left--;
        tried = 0;
    }
    *triangles++ = corners[previous[at]];
    *triangles++ = corners[at];
    *triangles++ = corners[next[at]];
    return true;
}

void shape_polygon_cut(const shape_dvec3 *points, const uint32_t *corners, size_t count, uint32_t *triangles,
                       double *scratch)
{
    shape_dvec3 across, up;
    if (count <= 3 || count > LARGEST || !choose_plane(points, corners, count, &across, &up)) {
        cut_fan(corners, count, triangles);
        return;
    }
    double(*flat)[2] = (double(*)[2])scratch;
    uint32_t *next = (void *)(scratch + 2 * count), *previous = next + count;
    for (size_t i = 0; i < count; i++) {
        shape_dvec3 p = shape_dvec3_sub(points[corners[i]], points[corners[0]]);
        flat[i][0] = shape_dvec3_dot(p, across);
        flat[i][1] = shape_dvec3_dot(p, up);
    }
    if (!cut_ears((const double(*)[2])flat, corners, count, triangles, next, previous))
        cut_fan(corners, count, triangles);
}
