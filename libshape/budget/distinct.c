/* Duplicates, found by sorting. Many in one place would make every search among neighbours slow. */
#include "budget/distinct.h"

#include <stdlib.h>
#include <string.h>

typedef struct entry {
    float key[10];
    size_t number;
} entry;

static int compare(const void *a, const void *b)
{
    const entry *x = a, *y = b;
    for (int k = 0; k < 10; k++)
        if (x->key[k] < y->key[k] || x->key[k] > y->key[k])
            return x->key[k] < y->key[k] ? -1 : 1;
    return x->number < y->number ? -1 : x->number > y->number;
}

static bool same(const entry *x, const entry *y)
{
    return !memcmp(x->key, y->key, sizeof x->key);
}

shape_status budget_distinct_copy(const shape_primitives *list, shape_primitives *copy, shape_error *error)
{
    size_t spheres = list->sphere_count, count = shape_primitives_count(list);
    entry *entries = malloc((count + 1) * sizeof *entries);
    unsigned char *gone = calloc(count + 1, 1);
    shape_status status = entries && gone ? shape_primitives_reserve(copy, spheres, count - spheres, error)
                                          : shape_error_memory(error);
    for (size_t i = 0; i < count && !status; i++) {
        entry e = {{0}, i};
        if (i < spheres) {
            const shape_sphere *s = &list->spheres[i];
            e.key[0] = s->x, e.key[1] = s->y, e.key[2] = s->z, e.key[3] = s->radius;
        } else {
            const shape_ellipsoid *s = &list->ellipsoids[i - spheres];
            const float key[10] = {s->x, s->y, s->z, s->a, s->b, s->c, s->q.x, s->q.y, s->q.z, s->q.w};
            memcpy(e.key, key, sizeof key);
        }
        entries[i] = e;
    }
    if (!status && count)
        qsort(entries, count, sizeof *entries, compare);
    for (size_t i = 1; i < count && !status; i++)
        gone[entries[i].number] = same(&entries[i], &entries[i - 1]);
    for (size_t i = 0; i < count && !status; i++)
        if (!gone[i] && i < spheres)
            copy->spheres[copy->sphere_count++] = list->spheres[i];
        else if (!gone[i])
            copy->ellipsoids[copy->ellipsoid_count++] = list->ellipsoids[i - spheres];
    free(entries);
    free(gone);
    return status;
}
