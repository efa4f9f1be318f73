/* Which clouds may throw a shadow on which: boxes seen from the sun, sorted along one side and swept (sweep and prune,
 * Cohen et al. 1995), so that the time grows with the clouds and the shadows and not with the square of the clouds. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "light/sunsweep.h"

typedef struct seen_box {
    double low[3], high[3]; /* across, across, towards the sun */
    size_t cloud;
} seen_box;

/* Two directions across the sun's. */
static void find_sides(shape_dvec3 sun, shape_dvec3 *a, shape_dvec3 *b)
{
    shape_dvec3 other = fabs(sun.y) < 0.9 ? shape_dvec3_make(0, 1, 0) : shape_dvec3_make(1, 0, 0);
    *a = shape_dvec3_normalize(shape_dvec3_cross(sun, other));
    *b = shape_dvec3_cross(sun, *a);
}

static seen_box see(const shape_volume_cloud *c, size_t cloud, const shape_dvec3 sides[3])
{
    seen_box seen = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, cloud};
    for (int corner = 0; corner < 8 && !shape_box_is_empty(c->box); corner++) {
        shape_dvec3 p = {corner & 1 ? c->box.max.x : c->box.min.x, corner & 2 ? c->box.max.y : c->box.min.y,
                         corner & 4 ? c->box.max.z : c->box.min.z};
        p = shape_frame_point(&c->frame, p);
        for (int side = 0; side < 3; side++) {
            double at = shape_dvec3_dot(p, sides[side]);
            seen.low[side] = fmin(seen.low[side], at);
            seen.high[side] = fmax(seen.high[side], at);
        }
    }
    return seen;
}

static int compare(const void *a, const void *b)
{
    const seen_box *x = a, *y = b;
    if (x->low[0] != y->low[0])
        return x->low[0] < y->low[0] ? -1 : 1;
    return (x->cloud > y->cloud) - (x->cloud < y->cloud);
}

static int compare_numbers(const void *a, const void *b)
{
    size_t x = *(const size_t *)a, y = *(const size_t *)b;
    return (x > y) - (x < y);
}

/* Counts the casters of each cloud in first[cloud + 1], or, where there is a list, writes them to it from next[cloud] on. */
static void walk(const seen_box *boxes, size_t count, size_t *counts, size_t *next, size_t *list)
{
    for (size_t i = 0; i < count; i++)
        for (size_t j = i + 1; j < count && boxes[j].low[0] <= boxes[i].high[0]; j++) {
            const seen_box *a = &boxes[i], *b = &boxes[j];
            if (b->low[1] > a->high[1] || b->high[1] < a->low[1])
                continue;
            if (b->high[2] > a->low[2]) {
                if (list)
                    list[next[a->cloud]++] = b->cloud;
                else
                    counts[a->cloud + 1]++;
            }
            if (a->high[2] > b->low[2]) {
                if (list)
                    list[next[b->cloud]++] = a->cloud;
                else
                    counts[b->cloud + 1]++;
            }
        }
}

shape_status shadow_pairs_find(const shape_volume *volume, shape_dvec3 sun, shadow_pairs *pairs,
                               shape_error *error)
{
    size_t count = volume->cloud_count;
    shape_dvec3 sides[3];
    sides[2] = sun;
    find_sides(sun, &sides[0], &sides[1]);
    memset(pairs, 0, sizeof *pairs);
    seen_box *boxes = malloc((count + 1) * sizeof *boxes);
    size_t *next = malloc((count + 1) * sizeof *next);
    pairs->first = calloc(count + 2, sizeof *pairs->first);
    if (boxes && next && pairs->first) {
        for (size_t i = 0; i < count; i++)
            boxes[i] = see(&volume->clouds[i], i, sides);
        qsort(boxes, count, sizeof *boxes, compare);
        walk(boxes, count, pairs->first, NULL, NULL);
        for (size_t i = 0; i < count; i++)
            pairs->first[i + 1] += pairs->first[i];
        memcpy(next, pairs->first, count * sizeof *next);
        pairs->casters = malloc((pairs->first[count] + 1) * sizeof *pairs->casters);
        if (pairs->casters)
            walk(boxes, count, NULL, next, pairs->casters);
        /* In their own order, so that sums are the same whatever the sun. */
        for (size_t i = 0; pairs->casters && i < count; i++)
            qsort(pairs->casters + pairs->first[i], pairs->first[i + 1] - pairs->first[i],
                  sizeof *pairs->casters, compare_numbers);
    }
    free(boxes);
    free(next);
    if (pairs->casters)
        return SHAPE_OK;
    shadow_pairs_free(pairs);
    return shape_error_memory(error);
}

void shadow_pairs_free(shadow_pairs *pairs)
{
    free(pairs->first);
    free(pairs->casters);
    memset(pairs, 0, sizeof *pairs);
}

/* The ball around a cloud's box, world. */
static double ball(const shape_volume_cloud *c, shape_dvec3 *centre)
{
    double radius2 = 0;
    shape_dvec3 half = {0, 0, 0};
    *centre = half;
    for (int i = 0; i < 3; i++) {
        double low = (&c->box.min.x)[i], high = (&c->box.max.x)[i];
        (&centre->x)[i] = 0.5 * (low + high);
        (&half.x)[i] = 0.5 * (high - low);
    }
    *centre = shape_frame_point(&c->frame, *centre);
    for (int i = 0; i < 3; i++) { /* so far away are the corners at most along each axis */
        double reach = fabs(c->frame.m[i][0] * half.x) + fabs(c->frame.m[i][1] * half.y) +
                       fabs(c->frame.m[i][2] * half.z);
        radius2 += reach * reach;
    }
    return sqrt(radius2);
}

bool shape_sun_may_shade(const shape_volume_cloud *caster, const shape_volume_cloud *on, shape_dvec3 sun)
{
    shape_dvec3 from, to;
    if (shape_box_is_empty(caster->box) || shape_box_is_empty(on->box))
        return false;
    double reach = (ball(caster, &from) + ball(on, &to)) * (1 + 1e-6);
    shape_dvec3 apart = shape_dvec3_sub(from, to);
    double ahead = shape_dvec3_dot(apart, sun), across2 = shape_dvec3_dot(apart, apart) - ahead * ahead;
    return ahead > -reach && across2 <= reach * reach + 1e-9 * ahead * ahead;
}
