/* Nearest neighbours by a k-d tree (Bentley 1975), divided at the median by quickselect (Hoare 1961). */
#include "budget/nearest.h"

#include <stdlib.h>
#include <string.h>

static double along(const budget_nearest *tree, uint32_t number, int axis)
{
    const shape_dvec3 *p = &tree->points[number];
    return axis == 0 ? p->x : axis == 1 ? p->y : p->z;
}

static bool before(const budget_nearest *tree, uint32_t a, uint32_t b, int axis)
{
    double x = along(tree, a, axis), y = along(tree, b, axis);
    return x < y || (x == y && a < b);
}

/* Orders the range so that its element `middle` is the one that sorting would put there. */
static void select_middle(budget_nearest *tree, size_t low, size_t high, size_t middle, int axis)
{
    uint32_t *order = tree->order;
    while (high - low > 1) {
        uint32_t pivot = order[low + (high - low) / 2];
        size_t i = low, j = high - 1;
        for (;;) {
            while (before(tree, order[i], pivot, axis))
                i++;
            while (before(tree, pivot, order[j], axis))
                j--;
            if (i >= j)
                break;
            uint32_t swapped = order[i];
            order[i] = order[j];
            order[j] = swapped;
        }
        /* Numbers differ, so the pivot now stands at i, which is j. */
        if (middle == i)
            return;
        if (middle < i)
            high = i;
        else
            low = i + 1;
    }
}

static void divide(budget_nearest *tree, size_t low, size_t high)
{
    while (high - low > 1) {
        double widest = -1;
        int axis = 0;
        for (int k = 0; k < 3; k++) {
            double least = INFINITY, most = -INFINITY;
            for (size_t i = low; i < high; i++) {
                double x = along(tree, tree->order[i], k);
                least = x < least ? x : least;
                most = x > most ? x : most;
            }
            if (most - least > widest) {
                widest = most - least;
                axis = k;
            }
        }
        size_t middle = low + (high - low) / 2;
        select_middle(tree, low, high, middle, axis);
        tree->axis[middle] = (unsigned char)axis;
        divide(tree, low, middle);
        low = middle + 1;
    }
}

shape_status budget_nearest_build(budget_nearest *tree, const shape_dvec3 *points, const uint32_t *numbers,
                                  size_t count, shape_error *error)
{
    *tree = (budget_nearest){points, malloc((count + 1) * sizeof *tree->order), calloc(count + 1, 1), count};
    if (!tree->order || !tree->axis) {
        budget_nearest_free(tree);
        return shape_error_memory(error);
    }
    memcpy(tree->order, numbers, count * sizeof *numbers);
    divide(tree, 0, count);
    return SHAPE_OK;
}

void budget_nearest_free(budget_nearest *tree)
{
    free(tree->order);
    free(tree->axis);
    memset(tree, 0, sizeof *tree);
}

typedef struct search {
    const budget_nearest *tree;
    shape_dvec3 point;
    uint32_t number;
    size_t wanted, count;
    uint32_t *found;
    double square[16];
} search;

/* Keeps the found ones sorted by distance. */
static void consider(search *s, uint32_t number)
{
    shape_dvec3 d = shape_dvec3_sub(s->tree->points[number], s->point);
    double square = shape_dvec3_dot(d, d);
    if (number == s->number || (s->count == s->wanted && !(square < s->square[s->count - 1])))
        return;
    size_t i = s->count < s->wanted ? s->count++ : s->count - 1;
    for (; i > 0 && square < s->square[i - 1]; i--) {
        s->square[i] = s->square[i - 1];
        s->found[i] = s->found[i - 1];
    }
    s->square[i] = square;
    s->found[i] = number;
}

static void look(search *s, size_t low, size_t high)
{
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        uint32_t number = s->tree->order[middle];
        consider(s, number);
        if (high - low == 1)
            return;
        int axis = s->tree->axis[middle];
        double apart = (axis == 0   ? s->point.x
                        : axis == 1 ? s->point.y
                                    : s->point.z) -
                       along(s->tree, number, axis);
        size_t first_low = low, first_high = middle, then_low = middle + 1, then_high = high;
        if (apart > 0) {
            first_low = middle + 1, first_high = high;
            then_low = low, then_high = middle;
        }
        look(s, first_low, first_high);
        if (s->count == s->wanted && !(apart * apart < s->square[s->count - 1]))
            return;
        low = then_low, high = then_high;
    }
}

size_t budget_nearest_find(const budget_nearest *tree, uint32_t number, size_t wanted, uint32_t *found)
{
    search s = {.tree = tree, .point = tree->points[number], .number = number, .found = found};
    s.wanted = wanted < 16 ? wanted : 16;
    look(&s, 0, tree->count);
    return s.count;
}
