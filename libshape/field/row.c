/* Density of a row of points: the primitives as quadratic forms, which are parabolas along a row, and lattice noise as a
 * table of the row's lattice values, so that a point costs one step between two of them (Jiménez 2018 Eq. 1, 2). */
#include "field/row.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "field/clones.h"
#include "field/lattice.h"

static row_form sphere_form(const shape_sphere *s)
{
    float k = 1 / s->radius;
    row_form f = {{s->x, s->y, s->z}, {{k, 0, 0}, {0, k, 0}, {0, 0, k}}};
    return f;
}

static row_form ellipsoid_form(const shape_ellipsoid *e)
{
    double r[3][3];
    const float axes[3] = {e->a, e->b, e->c};
    row_form f = {.c = {e->x, e->y, e->z}};
    shape_quat_matrix(e->q, r);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            f.m[i][j] = (float)(r[j][i] / (double)axes[i]);
    return f;
}

static bool apart(const shape_tree_node *n, shape_vec3 low, shape_vec3 high)
{
    return n->min.x > high.x || n->max.x < low.x || n->min.y > high.y || n->max.y < low.y ||
           n->min.z > high.z || n->max.z < low.z;
}

shape_status row_collect(const shape_volume_cloud *cloud, shape_vec3 low, shape_vec3 high, row_forms *list,
                         shape_error *error)
{
    list->count = 0;
    for (size_t i = 0; i < cloud->tree->count;) {
        const shape_tree_node *node = &cloud->tree->nodes[i];
        if (stop_after(&list->watch, 1))
            return stop_error(error);
        if (apart(node, low, high)) {
            i = (size_t)node->skip;
            continue;
        }
        i++;
        if (node->content == 0)
            continue;
        if (shape_array_reserve((void **)&list->items, &list->capacity, list->count + 1, sizeof *list->items,
                                error))
            return SHAPE_ERROR_MEMORY;
        list->items[list->count++] =
            node->content > 0 ? sphere_form(&cloud->list->spheres[(size_t)node->content - 1])
                              : ellipsoid_form(&cloud->list->ellipsoids[(size_t)-node->content - 1]);
    }
    return SHAPE_OK;
}

/* Along a row u^2 = steep (t - middle)^2 + least; where it is at most support^2. */
static bool meet_row(const row_form *f, float support, const field_row *row, float *steep, float *middle,
                     float *least, int range[2])
{
    const int u = row->axis, v = (u + 1) % 3, w = (u + 2) % 3;
    float pv = row->low[v] - f->c[v], pw = row->low[w] - f->c[w], along = 0, slope = 0, rest[3];
    for (int i = 0; i < 3; i++) {
        rest[i] = f->m[i][v] * pv + f->m[i][w] * pw;
        along += f->m[i][u] * f->m[i][u];
        slope += f->m[i][u] * rest[i];
    }
    float back = -slope / along, nearest = 0;
    for (int i = 0; i < 3; i++) {
        float x = rest[i] + f->m[i][u] * back;
        nearest += x * x;
    }
    float room = support * support - nearest;
    if (!(room >= 0) || !(along > 0))
        return false;
    *steep = along, *middle = back + f->c[u], *least = nearest;
    float half = sqrtf(room / along) / row->step + 1.5f; /* a point more on both sides, for the rounding */
    float centre = (*middle - row->low[u]) / row->step;
    float first = fminf(fmaxf(centre - half, 0), (float)row->count),
          end = fminf(fmaxf(centre + half, 0), (float)row->count);
    range[0] = (int)first, range[1] = (int)ceilf(end);
    return range[0] < range[1];
}

NEPHELE_CLONES
static void lower_row(const field_row *row, float steep, float middle, float least, int first, int end,
                      float *restrict u2)
{
    float low = row->low[row->axis], step = row->step;
#pragma omp simd
    for (int i = first; i < end; i++) {
        float t = low + step * ((float)i + 0.5f) - middle, value = steep * t * t + least;
        u2[i] = value < u2[i] ? value : u2[i];
    }
}

shape_status row_stopped(const row_forms *list, shape_error *error)
{
    return list->watch.stopped ? stop_error(error) : SHAPE_OK;
}

void row_u2(row_forms *list, float support, const field_row *row, float *u2)
{
    for (int i = 0; i < row->count; i++)
        u2[i] = INFINITY;
    for (size_t k = 0; k < list->count; k++) {
        if (stop_after(&list->watch, 1))
            return;
        float steep, middle, least;
        int range[2];
        if (meet_row(&list->items[k], support, row, &steep, &middle, &least, range))
            lower_row(row, steep, middle, least, range[0], range[1], u2);
    }
}

/* --- noise --- */

enum { TABLE = 128 };

/* An octave along a row: the lattice between the four lattice rows that the row runs among, at the places that it passes.
 * Returns the lattice place of entry 0; entries beyond `mask` repeat the first. */
static int fill_table(const shape_noise *noise, const int offset[3], const field_row *row, const float q[3],
                      int first, int last, float table[TABLE], int *mask)
{
    static const int stride[3] = {1, SHAPE_NOISE_ROW, SHAPE_NOISE_ROW * SHAPE_NOISE_SIZE};
    const int u = row->axis, v = (u + 1) % 3, w = (u + 2) % 3;
    int iv = lattice_floor(q[v]), iw = lattice_floor(q[w]), entries = last - first + 2;
    float av = q[v] - (float)iv, aw = q[w] - (float)iw;
    int v0 = (iv + offset[v]) & LATTICE_MASK, v1 = (v0 + 1) & LATTICE_MASK;
    int w0 = (iw + offset[w]) & LATTICE_MASK, w1 = (w0 + 1) & LATTICE_MASK;
    const uint16_t *a = noise->rows + v0 * stride[v] + w0 * stride[w],
                   *b = noise->rows + v1 * stride[v] + w0 * stride[w],
                   *c = noise->rows + v0 * stride[v] + w1 * stride[w],
                   *d = noise->rows + v1 * stride[v] + w1 * stride[w];
    bool whole = entries > SHAPE_NOISE_SIZE;
    int base = whole ? -offset[u] : first;
    *mask = whole ? LATTICE_MASK : TABLE - 1;
    entries = whole ? SHAPE_NOISE_SIZE + 1 : entries;
    for (int i = 0; i < entries; i++) {
        int place = ((base + offset[u] + i) & LATTICE_MASK) * stride[u];
        float low = (float)a[place] + av * (float)(b[place] - a[place]);
        float high = (float)c[place] + av * (float)(d[place] - c[place]);
        table[i] = low + aw * (high - low);
    }
    return base;
}

NEPHELE_CLONES
static void add_octave(const field_row *row, float scale, int base, int mask, float weight,
                       const float *restrict table, float *restrict sum)
{
    float low = row->low[row->axis], step = row->step;
    int count = row->count;
#pragma omp simd
    for (int i = 0; i < count; i++) {
        float x = (low + step * ((float)i + 0.5f)) * scale;
        int whole = (int)x;
        whole -= (float)whole > x;
        int place = (whole - base) & mask;
        float near = table[place];
        sum[i] += weight * (near + (x - (float)whole) * (table[place + 1] - near));
    }
}

/* The fractal sum along a row; false where the numbers are too large for tables. */
static bool row_fbm(const shape_volume_cloud *cloud, const field_row *row, float *sum)
{
    float scale = cloud->inverse_noise_scale, weight = 0.5f / 65535.0f, end[3], most = 0;
    for (int i = 0; i < 3; i++) {
        end[i] = row->low[i] + (i == row->axis ? row->step * (float)row->count : 0);
        most = fmaxf(most, fmaxf(fabsf(row->low[i]), fabsf(end[i])));
    }
    if (!(most * scale * (float)(1 << cloud->field.octaves) < 1e8f))
        return false;
    float rest = cloud->mean_octaves > 0 ? 0.5f * (ldexpf(1, -cloud->field.octaves) -
                                                   ldexpf(1, -cloud->field.octaves - cloud->mean_octaves))
                                         : 0;
    for (int i = 0; i < row->count; i++)
        sum[i] = rest;
    for (int octave = 0; octave < cloud->field.octaves; octave++) {
        float table[TABLE], q[3];
        for (int i = 0; i < 3; i++)
            q[i] = row->low[i] * scale;
        float x0 = (row->low[row->axis] + row->step * 0.5f) * scale,
              x1 = (row->low[row->axis] + row->step * ((float)row->count - 0.5f)) * scale;
        int mask, base = fill_table(cloud->noise, cloud->offsets[octave], row, q, lattice_floor(x0),
                                    lattice_floor(x1), table, &mask);
        add_octave(row, scale, base, mask, weight, table, sum);
        scale *= 2;
        weight *= 0.5f;
    }
    return true;
}

/* e^x for x <= 0, to three units of the last place: 2^n times the series of 2^f, |f| <= 1/2. */
static inline float quick_exp(float x)
{
    float y = x * 1.44269504f;
    int n = (int)(y - 0.5f);
    float f = (y - (float)n) * 0.693147181f, scale;
    n = n > -126 ? n : -126;
    float series =
        1 + f * (1 + f * (0.5f +
                          f * (0.16666667f + f * (0.041666667f + f * (0.0083333333f + f * 0.0013888889f)))));
    uint32_t bits = (uint32_t)(n + 127) << 23;
    memcpy(&scale, &bits, sizeof scale);
    return series * scale;
}

/* density_spheroid from the noise. In two loops: compilers put the exponential behind the condition, and then leave it
 * there, where they find both in one. */
NEPHELE_CLONES
static void cut_spheroid(const float *restrict u2, float limit, float kappa, int count, float *restrict n)
{
    float gamma[ROW_MOST];
#pragma omp simd
    for (int i = 0; i < count; i++) {
        float reach = (1 - kappa) + 2 * kappa * n[i];
        reach = reach > 1e-6f ? reach : 1e-6f;
        gamma[i] = quick_exp(-sqrtf(u2[i] < limit ? u2[i] : limit) / reach);
    }
#pragma omp simd
    for (int i = 0; i < count; i++)
        n[i] = ((u2[i] <= limit) & (n[i] < gamma[i])) ? n[i] : 0;
}

/* The row's points within [first, end). */
static field_row part_of(const field_row *row, int first, int end)
{
    field_row part = *row;
    part.low[row->axis] += row->step * (float)first;
    part.count = end - first;
    return part;
}

/* Primitives that a density's point may look at. */
static size_t point_work(const shape_volume_cloud *cloud, const row_forms *list)
{
    enum { NOISE = 16 };
    bool all = cloud->field.model == SHAPE_MODEL_METABALL;
    return NOISE + (all ? shape_primitives_count(cloud->list) : list->count);
}

void row_density(const shape_volume_cloud *cloud, row_forms *list, const field_row *row, const float *u2,
                 float *density)
{
    const float limit = cloud->support * cloud->support;
    int first = 0, end = row->count;
    if (stop_after(&list->watch, (size_t)row->count))
        return;
    while (first < end && !(u2[first] <= limit))
        density[first++] = 0;
    while (end > first && !(u2[end - 1] <= limit))
        density[--end] = 0;
    if (first == end)
        return;
    field_row part = part_of(row, first, end);
    if (cloud->field.model == SHAPE_MODEL_SPHEROID && !cloud->detailed && !cloud->portable &&
        row_fbm(cloud, &part, density + first)) {
        cut_spheroid(u2 + first, limit, cloud->field.kappa, end - first, density + first);
        return;
    }
    const size_t work = point_work(cloud, list);
    for (int i = first; i < end && !stop_after(&list->watch, work); i++) {
        shape_vec3 p = {row->low[0], row->low[1], row->low[2]};
        (&p.x)[row->axis] += row->step * ((float)i + 0.5f);
        density[i] = shape_cloud_density_at(cloud, p, u2[i]);
    }
}
