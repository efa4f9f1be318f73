/* Delta tracking (Woodcock et al. 1965) and ratio tracking (Novák et al. 2014) in one voxel grid, block by block
 * (Amanatides and Woo 1987). It is what track.c does for any volume, without what a single grid has no need of: the
 * ray is turned into the grid's frame once, and a look at the density is a look at eight neighbours in one brick. */
#include "light/blocks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "primitive/grid_look.h"
#include "light/track_chance.h"

enum { BRICK = SHAPE_GRID_BRICK, SIDE = SHAPE_GRID_SIDE, SHARES = 255 };

/* --- building --- */

/* Whole bricks, or an eighth of them where a brick may be many free paths deep: closer bounds, and a longer walk. */
static int choose_edge(const block_grid *b)
{
    const double deep = 4;
    double square = 0; /* of the voxels in a metre */
    for (int a = 0; a < 3; a++)
        square += b->to_local[a][0] * b->to_local[a][0];
    return (double)(b->grid->most * b->grid->gain * b->extinction) * BRICK / sqrt(square) > deep ? BRICK / 2
                                                                                                 : BRICK;
}

/* The range of the values at the points low[] to low[] + width of a brick. */
static void value_range(const float *values, const int low[3], int width, float *least, float *most)
{
    *least = INFINITY;
    *most = 0;
    for (int z = low[2]; z <= low[2] + width; z++)
        for (int y = low[1]; y <= low[1] + width; y++)
            for (int x = low[0]; x <= low[0] + width; x++) {
                float value = values[(z * SIDE + y) * SIDE + x];
                *least = value < *least ? value : *least;
                *most = value > *most ? value : *most;
            }
}

/* A little more than what the roundings on the way to the extinction can make of it. */
static const float slack = 1 + 1e-5f;

static void bound_parts(const float *values, const int low[3], int width, float max, block_parts *parts)
{
    for (int i = 0; i < BLOCK_PARTS_ALL; i++) {
        const int at[3] = {low[0] + i % BLOCK_PARTS * width, low[1] + i / BLOCK_PARTS % BLOCK_PARTS * width,
                           low[2] + i / BLOCK_PARTS / BLOCK_PARTS * width};
        float least, most;
        value_range(values, at, width, &least, &most);
        parts->low[i] = (uint8_t)(least / slack / max * SHARES);
        parts->high[i] = (uint8_t)fminf(ceilf(most * slack / max * SHARES), SHARES);
    }
}

/* The blocks of one brick, from corner[] [cells] on. */
static void bound_brick(block_grid *b, size_t brick, const int corner[3], uint32_t *used)
{
    const float *values = b->grid->values + brick * SHAPE_GRID_BRICK_POINTS;
    int per_brick = BRICK / b->edge;
    for (int i = 0; i < per_brick * per_brick * per_brick; i++) {
        const int low[3] = {i % per_brick * b->edge, i / per_brick % per_brick * b->edge,
                            i / per_brick / per_brick * b->edge};
        float least, most;
        value_range(values, low, b->edge, &least, &most);
        if (!(most > 0))
            continue;
        size_t index = 0;
        for (int a = 2; a >= 0; a--)
            index = index * (size_t)b->n[a] + (size_t)((corner[a] + low[a]) / b->edge + 1);
        b->blocks[index].max = most * slack * b->grid->gain * b->extinction;
        b->blocks[index].parts = *used;
        bound_parts(values, low, b->edge / BLOCK_PARTS, most * slack, &b->parts[(*used)++]);
    }
}

static void bound_all(block_grid *b)
{
    const int *n = b->grid->bricks;
    uint32_t used = 0;
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++)
            for (int x = 0; x < n[0]; x++) {
                size_t brick = grid_brick(b->grid, (unsigned)x, (unsigned)y, (unsigned)z);
                const int corner[3] = {x * BRICK, y * BRICK, z * BRICK};
                if (brick)
                    bound_brick(b, brick, corner, &used);
            }
}

/* Empty blocks at the edges are none of the walk's. */
static void find_box(block_grid *b)
{
    for (int a = 0; a < 3; a++) {
        b->low[a] = INFINITY;
        b->high[a] = -INFINITY;
    }
    const block_bound *block = b->blocks;
    for (int z = 0; z < b->n[2]; z++)
        for (int y = 0; y < b->n[1]; y++)
            for (int x = 0; x < b->n[0]; x++, block++) {
                const int at[3] = {x, y, z};
                for (int a = 0; a < 3 && block->max > 0; a++) {
                    b->low[a] = track_min(b->low[a], (at[a] - 1) * b->edge);
                    b->high[a] = track_max(b->high[a], at[a] * b->edge);
                }
            }
    for (int a = 0; a < 3; a++) /* nothing at all: no ray meets it */
        if (!(b->low[a] < b->high[a]))
            b->low[a] = b->high[a] = 0;
}

shape_status block_grid_build(block_grid *b, const shape_volume_cloud *cloud, shape_dvec3 origin,
                              shape_error *error)
{
    memset(b, 0, sizeof *b);
    b->grid = cloud->list->grid;
    b->extinction = cloud->medium.extinction;
    memcpy(b->to_local, cloud->inverse.m, sizeof b->to_local);
    shape_dvec3 offset = shape_frame_point(&cloud->inverse, origin);
    b->to_local[0][3] = offset.x, b->to_local[1][3] = offset.y, b->to_local[2][3] = offset.z;
    b->edge = choose_edge(b);
    size_t count = 1, full = 0, bricks = 1;
    for (int a = 0; a < 3; a++) {
        b->n[a] = b->grid->bricks[a] * (BRICK / b->edge) + 2;
        count *= (size_t)b->n[a];
        bricks *= (size_t)b->grid->bricks[a];
    }
    for (size_t i = 0; i < bricks; i++)
        full += b->grid->table[i] != 0;
    int per_brick = BRICK / b->edge;
    b->blocks = calloc(count, sizeof *b->blocks);
    b->parts = malloc((full * (size_t)(per_brick * per_brick * per_brick) + 1) * sizeof *b->parts);
    if (!b->blocks || !b->parts)
        return shape_error_memory(error);
    bound_all(b);
    find_box(b);
    return SHAPE_OK;
}

void block_grid_free(block_grid *b)
{
    free(b->blocks);
    free(b->parts);
    memset(b, 0, sizeof *b);
}

/* --- walking --- */

/* A ray on its way from block to block. t is in metres, places in voxels. */
typedef struct block_walk {
    double t, end, p[3], d[3], next[3], delta[3];
    const block_bound *at;
    ptrdiff_t step[3];
    int left[3]; /* blocks before the border's end: from very far away, rounding can be many blocks */
} block_walk;

static bool walk_start(block_walk *w, const block_grid *b, const double p[3], const double d[3],
                       double length)
{
    double inverse[3];
    w->t = 0;
    w->end = length;
    for (int a = 0; a < 3; a++) {
        const double *m = b->to_local[a];
        w->p[a] = m[0] * p[0] + m[1] * p[1] + m[2] * p[2] + m[3];
        w->d[a] = m[0] * d[0] + m[1] * d[1] + m[2] * d[2];
        inverse[a] = 1 / w->d[a];
        if (w->d[a] == 0) {
            if (!(w->p[a] >= b->low[a] && w->p[a] <= b->high[a]))
                return false;
            continue;
        }
        double near = (b->low[a] - w->p[a]) * inverse[a], far = (b->high[a] - w->p[a]) * inverse[a];
        w->t = track_max(w->t, track_min(near, far));
        w->end = track_min(w->end, track_max(near, far));
    }
    if (!(w->t < w->end))
        return false;
    ptrdiff_t stride = 1, index = 0;
    double one = 1.0 / b->edge;
    for (int a = 0; a < 3; a++) {
        int last = b->n[a] - 3, at = (int)((w->p[a] + w->d[a] * w->t) * one);
        at = at < 0 ? 0 : at > last ? last : at;
        w->step[a] = w->d[a] < 0 ? -stride : stride;
        w->left[a] = w->d[a] < 0 ? at + 1 : last + 1 - at;
        w->delta[a] = w->d[a] == 0 ? 0 : b->edge * fabs(inverse[a]);
        w->next[a] =
            w->d[a] == 0 ? INFINITY : ((at + (w->d[a] > 0)) * (double)b->edge - w->p[a]) * inverse[a];
        index += stride * (at + 1);
        stride *= b->n[a];
    }
    w->at = b->blocks + index;
    return true;
}

/* Where the present block ends. */
static inline double walk_exit(const block_walk *w)
{
    return track_min(track_min(w->next[0], w->next[1]), track_min(w->next[2], w->end));
}

/* On from there; false at the end. No branch on the axis: it cannot be foreseen. */
static inline bool walk_next(block_walk *w, double exit)
{
    if (!(exit < w->end))
        return false;
    w->t = track_max(w->t, exit);
    int least = 0;
    for (int a = 0; a < 3; a++) {
        bool here = w->next[a] <= exit;
        w->left[a] -= here;
        least = w->left[a] < least ? w->left[a] : least;
        w->next[a] += here ? w->delta[a] : 0;
        w->at += here ? w->step[a] : 0;
    }
    return least >= 0;
}

static inline double extinction_at(const block_grid *b, const block_walk *w)
{
    return (double)(b->extinction * grid_look(b->grid, (float)(w->p[0] + w->d[0] * w->t),
                                              (float)(w->p[1] + w->d[1] * w->t),
                                              (float)(w->p[2] + w->d[2] * w->t)));
}

/* Whether a tentative collision at w->t is one: with the chance of the extinction there over the block's max. What the
 * part alone decides, most of it, needs no look at the values. */
static inline bool is_real(const block_grid *b, const block_walk *w, shape_random *random)
{
    uint64_t share = (uint64_t)shape_random_u32(random) * SHARES; /* in units of 2^-32 */
    unsigned whole = (unsigned)(share >> 32), mask = (unsigned)b->edge - 1, shift = b->edge == BRICK;
    float x = (float)(w->p[0] + w->d[0] * w->t), y = (float)(w->p[1] + w->d[1] * w->t),
          z = (float)(w->p[2] + w->d[2] * w->t);
    const block_parts *parts = &b->parts[w->at->parts];
    unsigned part = (((unsigned)(int)z & mask) >> shift) * BLOCK_PARTS * BLOCK_PARTS +
                    (((unsigned)(int)y & mask) >> shift) * BLOCK_PARTS + (((unsigned)(int)x & mask) >> shift);
    if (whole < parts->low[part])
        return true;
    if (whole >= parts->high[part])
        return false;
    return (double)share * (0x1p-32 / SHARES) * (double)w->at->max <
           (double)(b->extinction * grid_look(b->grid, x, y, z));
}

bool block_collide(const block_grid *b, const double p[3], const double d[3], double length, double depth,
                   shape_random *random, double *t)
{
    block_walk w;
    double exit;
    if (!walk_start(&w, b, p, d, length))
        return false;
    do {
        double max = (double)w.at->max;
        exit = walk_exit(&w);
        while (depth < (exit - w.t) * max) {
            w.t += depth / max;
            if (is_real(b, &w, random)) {
                *t = w.t;
                return true;
            }
            depth = (double)-logf((float)track_unit(random));
        }
        depth -= track_max(exit - w.t, 0) * max;
    } while (walk_next(&w, exit));
    return false;
}

double block_transmittance(const block_grid *b, const double p[3], const double d[3], double length,
                           shape_random *random)
{
    block_walk w;
    double exit, weight = 1, depth = (double)-logf((float)track_unit(random));
    if (!walk_start(&w, b, p, d, length))
        return 1;
    do {
        double max = (double)w.at->max;
        exit = walk_exit(&w);
        while (depth < (exit - w.t) * max) {
            w.t += depth / max;
            weight *= track_max(max - extinction_at(b, &w), 0) / max;
            if (!track_roulette(&weight, random))
                return 0;
            depth = (double)-logf((float)track_unit(random));
        }
        depth -= track_max(exit - w.t, 0) * max;
    } while (walk_next(&w, exit));
    return weight;
}
