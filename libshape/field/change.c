/* Where a cloud's density may differ after an edit (shape/change.h). */
#include "shape/change.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "field/detail.h"
#include "shape/random.h"

/* --- what every point's density depends on --- */

static bool same_box(shape_box a, shape_box b)
{
    return a.min.x == b.min.x && a.min.y == b.min.y && a.min.z == b.min.z && a.max.x == b.max.x &&
           a.max.y == b.max.y && a.max.z == b.max.z;
}

/* By members, since there are gaps between some of them. */
static bool same_field(const shape_field *a, const shape_field *b)
{
    return a->model == b->model && a->kappa == b->kappa && a->octaves == b->octaves &&
           a->noise_scale == b->noise_scale && a->edge == b->edge && a->seed == b->seed &&
           !memcmp(&a->detail, &b->detail, sizeof a->detail) &&
           (a->model != SHAPE_MODEL_LAYER || !memcmp(&a->layer, &b->layer, sizeof a->layer));
}

static bool same_kind(const shape_volume_cloud *a, const shape_volume_cloud *b)
{
    return same_field(&a->field, &b->field) && same_box(a->box, b->box) && a->support == b->support &&
           a->margin == b->margin && a->most == b->most && a->portable == b->portable &&
           a->mean_octaves == b->mean_octaves && a->detailed == b->detailed && a->base == b->base &&
           a->inverse_height == b->inverse_height && a->shape_list->grid == b->shape_list->grid;
}

/* Whether a primitive's density is its own affair, within its support. */
static bool is_local(const shape_volume_cloud *cloud)
{
    return cloud->field.model == SHAPE_MODEL_UNIFORM || cloud->field.model == SHAPE_MODEL_SPHEROID;
}

/* --- primitives that only one of two lists has --- */

/* An array of things of one size: the part of it that is not the same in both lists. */
typedef struct span {
    const unsigned char *items;
    size_t count;
} span;

static const unsigned char *item(const span *s, size_t size, size_t i)
{
    return s->items + i * size;
}

/* Leaves out what both begin with, and what both end with. */
static void trim(span *a, span *b, size_t size)
{
    size_t both = a->count < b->count ? a->count : b->count, first = 0, last = 0;
    while (first < both && !memcmp(item(a, size, first), item(b, size, first), size))
        first++;
    while (last < both - first &&
           !memcmp(item(a, size, a->count - 1 - last), item(b, size, b->count - 1 - last), size))
        last++;
    if (first) /* an empty list has no items to point to */
        a->items += first * size, b->items += first * size;
    a->count -= first + last, b->count -= first + last;
}

static uint64_t digest(const unsigned char *bytes, size_t size)
{
    uint64_t hash = 0;
    for (size_t i = 0; i < size; i += sizeof(uint64_t)) {
        uint64_t word;
        memcpy(&word, bytes + i, sizeof word);
        hash = shape_hash(hash ^ word);
    }
    return hash;
}

/* An open table of the items of one list; each place that is in use names one: its number plus 1. */
typedef struct table {
    uint32_t *places;
    bool *taken;        /* a flag an item: it has its like in the other list */
    size_t mask, steps; /* steps: how many more places may be looked at; many alike make long ways */
} table;

/* The next place, while steps are left. */
static bool walk(table *t, size_t *place)
{
    *place = (*place + 1) & t->mask;
    return t->steps && --t->steps;
}

static shape_status table_make(const span *s, size_t size, size_t others, table *t, shape_error *error)
{
    enum { STEPS = 16 };
    size_t room = 16;
    while (room < 2 * s->count)
        room *= 2;
    t->mask = room - 1;
    t->steps = STEPS * (s->count + others + 64);
    t->places = calloc(room, sizeof *t->places);
    t->taken = calloc(s->count + 1, sizeof *t->taken);
    if (!t->places || !t->taken)
        return shape_error_memory(error);
    for (size_t i = 0; i < s->count; i++) {
        size_t place = (size_t)digest(item(s, size, i), size) & t->mask;
        while (t->places[place] && walk(t, &place))
            ;
        if (!t->steps)
            break;
        t->places[place] = (uint32_t)i + 1;
    }
    return SHAPE_OK;
}

static void table_free(table *t)
{
    free(t->places);
    free(t->taken);
}

/* Takes an item's like out of the table; false where there is none (left). */
static bool table_take(table *t, const span *s, size_t size, const unsigned char *bytes)
{
    size_t place = (size_t)digest(bytes, size) & t->mask;
    for (; t->places[place]; walk(t, &place)) {
        size_t i = t->places[place] - 1;
        if (!t->steps)
            break;
        if (!t->taken[i] && !memcmp(item(s, size, i), bytes, size)) {
            t->taken[i] = true;
            return true;
        }
    }
    return false;
}

/* --- boxes --- */

typedef struct comparison {
    const shape_volume_cloud *cloud; /* either: what counts is the same in both */
    shape_change *change;
    size_t capacity;
    shape_error *error;
} comparison;

/* The points that may ask for a primitive: its support (grown by the margin: field/volume.c), and what a smooth union or a
 * displaced point may reach; and a little more, for what is rounded on the way. */
static shape_box reach_of(const shape_volume_cloud *c, const unsigned char *bytes, bool sphere)
{
    float wide = c->detailed ? fmaxf(detail_reach(&c->field, c->support), c->support) : c->support;
    shape_sphere s;
    shape_ellipsoid e;
    shape_box box;
    if (sphere) {
        memcpy(&s, bytes, sizeof s);
        box = shape_sphere_box(&s, wide);
        s = shape_sphere_grow(&s, c->support, c->margin);
        box = shape_box_join(box, shape_sphere_box(&s, 1));
    } else {
        memcpy(&e, bytes, sizeof e);
        box = shape_ellipsoid_box(&e, wide);
        e = shape_ellipsoid_grow(&e, c->support, c->margin);
        box = shape_box_join(box, shape_ellipsoid_box(&e, 1));
    }
    for (int axis = 0; axis < 3; axis++) {
        float *min = &(&box.min.x)[axis], *max = &(&box.max.x)[axis];
        float more = c->margin + 1e-5f * (fabsf(*min) + fabsf(*max));
        *min -= more, *max += more;
    }
    return box;
}

/* False where there are too many, or where memory is out. */
static bool add(comparison *c, const unsigned char *bytes, bool sphere)
{
    shape_change *change = c->change;
    if (change->count == SHAPE_CHANGE_BOXES) {
        change->all = true;
        return false;
    }
    if (shape_array_reserve((void **)&change->boxes, &c->capacity, change->count + 1, sizeof *change->boxes,
                            c->error))
        return false;
    change->boxes[change->count++] = reach_of(c->cloud, bytes, sphere);
    return true;
}

static shape_status compare(comparison *both, span a, span b, bool sphere)
{
    const size_t size = sphere ? sizeof(shape_sphere) : sizeof(shape_ellipsoid);
    table t = {0};
    trim(&a, &b, size);
    if (!a.count && !b.count)
        return SHAPE_OK;
    shape_error own = {0};
    comparison c = *both;
    c.error = &own;
    table_make(&a, size, b.count, &t, &own);
    for (size_t i = 0; i < b.count && !own.status && t.steps; i++)
        if (!table_take(&t, &a, size, item(&b, size, i)) && !add(&c, item(&b, size, i), sphere))
            break;
    for (size_t i = 0; i < a.count && !own.status && !c.change->all; i++)
        if (!t.taken[i] && !add(&c, item(&a, size, i), sphere))
            break;
    if (!own.status && !t.steps)
        c.change->all = true; /* too many alike to tell which is which */
    table_free(&t);
    both->capacity = c.capacity;
    if (own.status && both->error)
        *both->error = own;
    return own.status;
}

/* Whether two lists are the same, primitive by primitive and in their order. */
static bool same_lists(const shape_primitives *a, const shape_primitives *b)
{
    return a->sphere_count == b->sphere_count && a->ellipsoid_count == b->ellipsoid_count &&
           (!a->sphere_count || !memcmp(a->spheres, b->spheres, a->sphere_count * sizeof *a->spheres)) &&
           (!a->ellipsoid_count ||
            !memcmp(a->ellipsoids, b->ellipsoids, a->ellipsoid_count * sizeof *a->ellipsoids));
}

shape_status shape_change_find(const shape_volume_cloud *before, const shape_volume_cloud *after,
                               shape_change *change, shape_error *error)
{
    const shape_primitives *a = before->shape_list, *b = after->shape_list;
    memset(change, 0, sizeof *change);
    if (!same_kind(before, after)) {
        change->all = true;
        return SHAPE_OK;
    }
    if (!is_local(after)) {
        change->all = !same_lists(a, b);
        return SHAPE_OK;
    }
    comparison c = {after, change, 0, error};
    shape_status status = compare(&c, (span){(const unsigned char *)a->spheres, a->sphere_count},
                                  (span){(const unsigned char *)b->spheres, b->sphere_count}, true);
    if (!status && !change->all)
        status = compare(&c, (span){(const unsigned char *)a->ellipsoids, a->ellipsoid_count},
                         (span){(const unsigned char *)b->ellipsoids, b->ellipsoid_count}, false);
    return status;
}

void shape_change_free(shape_change *change)
{
    free(change->boxes);
    memset(change, 0, sizeof *change);
}

bool shape_change_is_any(const shape_change *change)
{
    return change->all || change->count;
}

bool shape_change_touches(const shape_change *change, shape_box box)
{
    for (size_t i = 0; i < change->count && !change->all; i++) {
        const shape_box *b = &change->boxes[i];
        if (b->min.x <= box.max.x && b->max.x >= box.min.x && b->min.y <= box.max.y &&
            b->max.y >= box.min.y && b->min.z <= box.max.z && b->max.z >= box.min.z)
            return true;
    }
    return change->all;
}

/* --- boxes that stay --- */

static double room_of(shape_box b)
{
    return ((double)b.max.x - (double)b.min.x) * ((double)b.max.y - (double)b.min.y) *
           ((double)b.max.z - (double)b.min.z);
}

static bool holds(shape_box outer, shape_box inner)
{
    return outer.min.x <= inner.min.x && outer.min.y <= inner.min.y && outer.min.z <= inner.min.z &&
           outer.max.x >= inner.max.x && outer.max.y >= inner.max.y && outer.max.z >= inner.max.z;
}

void shape_volume_keep_boxes(shape_volume *volume, const shape_volume *before)
{
    for (size_t i = 0; i < volume->cloud_count && i < before->cloud_count; i++) {
        shape_box *box = &volume->clouds[i].box, old = before->clouds[i].box;
        if (!shape_box_is_empty(*box) && holds(old, *box) && room_of(old) <= 1.5 * room_of(*box))
            *box = old;
    }
}
