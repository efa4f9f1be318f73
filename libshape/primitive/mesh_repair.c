/* Mesh repair: points at one place become one, triangles without area and repeated triangles go. Two hash tables with
 * open addressing, so that the work is linear. */
#include "shape/mesh.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "shape/random.h"

static const uint32_t none = UINT32_MAX;

/* A table of indices with at least twice the room it needs; *mask is its size less one. */
static uint32_t *make_table(size_t entries, size_t *mask, shape_error *error)
{
    size_t size = 16;
    while (size < 2 * entries)
        size *= 2;
    uint32_t *table = malloc(size * sizeof *table);
    if (!table) {
        shape_error_memory(error);
        return NULL;
    }
    memset(table, 0xff, size * sizeof *table);
    *mask = size - 1;
    return table;
}

static uint64_t bits(double value)
{
    uint64_t result;
    value += 0.0; /* -0 and 0 are one place */
    memcpy(&result, &value, sizeof result);
    return result;
}

static uint64_t hash_point(shape_dvec3 p)
{
    return shape_hash(bits(p.x) ^ shape_hash(bits(p.y) ^ shape_hash(bits(p.z))));
}

static bool same_point(shape_dvec3 a, shape_dvec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

/* Points every index at the first point of its place. Returns how many used points fell together. */
static shape_status merge_points(shape_mesh *mesh, shape_error *error)
{
    size_t mask;
    uint32_t *table = make_table(mesh->point_count, &mask, error);
    uint32_t *first = malloc((mesh->point_count + 1) * sizeof *first);
    if (!table || !first) {
        free(table);
        free(first);
        return shape_error_memory(error);
    }
    for (size_t i = 0; i < mesh->point_count; i++) {
        size_t slot = hash_point(mesh->points[i]) & mask;
        while (table[slot] != none && !same_point(mesh->points[table[slot]], mesh->points[i]))
            slot = (slot + 1) & mask;
        if (table[slot] == none)
            table[slot] = (uint32_t)i;
        else
            mesh->counts.duplicate_points++;
        first[i] = table[slot];
    }
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++)
        mesh->indices[i] = first[mesh->indices[i]];
    free(table);
    free(first);
    return SHAPE_OK;
}

/* No area, within what the rounding of coordinates of this size can hide. */
static bool has_no_area(const shape_mesh *mesh, const uint32_t *corner, double largest)
{
    if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0])
        return true;
    shape_dvec3 a = mesh->points[corner[0]], b = mesh->points[corner[1]], c = mesh->points[corner[2]];
    shape_dvec3 ab = shape_dvec3_sub(b, a), ac = shape_dvec3_sub(c, a), bc = shape_dvec3_sub(c, b);
    double square = fmax(shape_dvec3_dot(ab, ab), fmax(shape_dvec3_dot(ac, ac), shape_dvec3_dot(bc, bc)));
    shape_dvec3 normal = shape_dvec3_cross(ab, ac);
    double tolerance = 1e-12 * square + DBL_EPSILON * largest * sqrt(square);
    return shape_dvec3_dot(normal, normal) <= tolerance * tolerance;
}

static void sort3(const uint32_t *corner, uint32_t key[3])
{
    uint32_t a = corner[0], b = corner[1], c = corner[2];
    uint32_t low = a < b ? a : b, high = a < b ? b : a;
    key[0] = c < low ? c : low;
    key[2] = c > high ? c : high;
    key[1] = c < low ? low : c > high ? high : c;
}

/* Whether the triangle before `kept` at *slot has the same three corners; where not, the slot takes `kept`. */
static bool is_repeated(const shape_mesh *mesh, uint32_t *table, size_t mask, const uint32_t *corner,
                        uint32_t kept)
{
    uint32_t key[3], other[3];
    sort3(corner, key);
    size_t slot = shape_hash(((uint64_t)key[0] << 32 | key[1]) ^ shape_hash(key[2])) & mask;
    for (; table[slot] != none; slot = (slot + 1) & mask) {
        sort3(&mesh->indices[3 * (size_t)table[slot]], other);
        if (!memcmp(key, other, sizeof key))
            return true;
    }
    table[slot] = kept;
    return false;
}

static shape_status drop_triangles(shape_mesh *mesh, shape_error *error)
{
    size_t mask, kept = 0;
    shape_dvec3 min = {0, 0, 0}, max = min;
    shape_mesh_bounds(mesh, &min, &max);
    double largest = fmax(fmax(fmax(-min.x, max.x), fmax(-min.y, max.y)), fmax(-min.z, max.z));
    uint32_t *table = make_table(mesh->triangle_count, &mask, error);
    if (!table)
        return SHAPE_ERROR_MEMORY;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        uint32_t *corner = &mesh->indices[3 * t];
        if (has_no_area(mesh, corner, largest)) {
            mesh->counts.zero_area++;
        } else if (is_repeated(mesh, table, mask, corner, (uint32_t)kept)) {
            mesh->counts.duplicate_faces++;
        } else {
            memmove(&mesh->indices[3 * kept], corner, 3 * sizeof *corner);
            kept++;
        }
    }
    free(table);
    mesh->triangle_count = kept;
    return SHAPE_OK;
}

static shape_status drop_points(shape_mesh *mesh, shape_error *error)
{
    uint32_t *place = malloc((mesh->point_count + 1) * sizeof *place);
    if (!place)
        return shape_error_memory(error);
    memset(place, 0xff, mesh->point_count * sizeof *place);
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++)
        place[mesh->indices[i]] = 0;
    uint32_t kept = 0;
    for (size_t i = 0; i < mesh->point_count; i++)
        if (place[i] != none) {
            mesh->points[kept] = mesh->points[i];
            place[i] = kept++;
        }
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++)
        mesh->indices[i] = place[mesh->indices[i]];
    mesh->point_count = kept;
    free(place);
    return SHAPE_OK;
}

shape_status shape_mesh_repair(shape_mesh *mesh, shape_error *error)
{
    shape_status status = merge_points(mesh, error);
    if (!status)
        status = drop_triangles(mesh, error);
    if (!status)
        status = drop_points(mesh, error);
    if (!status && !mesh->triangle_count)
        status = shape_error_set(error, SHAPE_ERROR_FORMAT,
                                 "no triangle of the mesh has an area (is its scale zero along an axis?)");
    return status;
}

shape_status shape_mesh_open_edges(const shape_mesh *mesh, size_t *count, shape_error *error)
{
    size_t edges = 3 * mesh->triangle_count, mask;
    uint32_t *table = make_table(edges, &mask, error);
    unsigned char *uses = calloc(edges + 1, 1);
    if (!table || !uses) {
        free(table);
        free(uses);
        return shape_error_memory(error);
    }
    *count = 0;
    for (size_t e = 0; e < edges; e++) {
        uint32_t a = mesh->indices[e], b = mesh->indices[e % 3 == 2 ? e - 2 : e + 1];
        size_t slot = shape_hash((uint64_t)(a < b ? a : b) << 32 | (a < b ? b : a)) & mask;
        for (; table[slot] != none; slot = (slot + 1) & mask) {
            size_t f = table[slot];
            uint32_t c = mesh->indices[f], d = mesh->indices[f % 3 == 2 ? f - 2 : f + 1];
            if ((a == c && b == d) || (a == d && b == c))
                break;
        }
        if (table[slot] == none)
            table[slot] = (uint32_t)e;
        unsigned char *use = &uses[table[slot]];
        *use += *use < 2;
    }
    for (size_t e = 0; e < edges; e++)
        *count += uses[e] == 1;
    free(table);
    free(uses);
    return SHAPE_OK;
}
