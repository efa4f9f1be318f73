/* Greedy merging of primitives (as Garland and Heckbert 1997 do with a mesh's edges): a queue of pairs of neighbours by
 * cost. The cost is the volume where the pair's place changes, each point weighed by the change of mean density against
 * the cloud as it was; what other primitives cover changes nothing. So primitives inside the heap cost nothing. */
#include "budget/merge.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "budget/nearest.h"
#include "shape/tree.h"
#include "shape/volume.h"

enum { NEAREST = 6, PARTNERS = 20 };

typedef struct candidate {
    double cost;
    uint32_t a, b; /* a < b */
} candidate;

typedef struct work {
    const shape_primitives *list;
    shape_model model;
    shape_tree tree;
    budget_merges *merges;
    budget_ball ball;
    budget_samples *samples; /* by slot */
    uint32_t *slot;          /* of a node */
    uint32_t *root;          /* union-find: a node's successor, itself while it lives */
    uint32_t (*partners)[PARTNERS];
    unsigned char *partner_count; /* by slot, as partners */
    candidate *heap;
    size_t heap_count, heap_capacity;
    size_t made, alive; /* nodes in all, nodes that live */
} work;

/* --- the cloud as it was --- */

/* The least u2 at a point, and whose it is. */
static double original_u2(const work *w, shape_dvec3 point, uint32_t *owner)
{
    shape_vec3 p = {(float)point.x, (float)point.y, (float)point.z};
    double least = INFINITY;
    *owner = UINT32_MAX;
    for (size_t i = 0; i < w->tree.count;) {
        const shape_tree_node *n = &w->tree.nodes[i];
        if (!(p.x >= n->min.x && p.x <= n->max.x && p.y >= n->min.y && p.y <= n->max.y && p.z >= n->min.z &&
              p.z <= n->max.z)) {
            i = (size_t)n->skip;
            continue;
        }
        i++;
        if (n->content == 0)
            continue;
        size_t number =
            n->content > 0 ? (size_t)n->content - 1 : w->list->sphere_count + (size_t)-n->content - 1;
        double u2 = budget_shape_u2(&w->merges->nodes[number].shape, point);
        if (u2 < least || (u2 <= least && number < *owner)) {
            least = u2;
            *owner = (uint32_t)number;
        }
        if (budget_profile(w->model, least) >= 1)
            break; /* full: who else covers the point does not matter, and the same one is found from everywhere */
    }
    if (!(least <= 1))
        *owner = UINT32_MAX;
    return least;
}

static void take_samples(const work *w, uint32_t node)
{
    budget_samples *samples = &w->samples[w->slot[node]];
    const budget_shape *shape = &w->merges->nodes[node].shape;
    for (int i = 0; i < BUDGET_SAMPLES; i++) {
        double u2 = original_u2(w, budget_shape_point(shape, w->ball.points[i]), &samples->owner[i]);
        samples->profile[i] = (float)budget_profile(w->model, u2);
    }
}

static uint32_t root_of(work *w, uint32_t node)
{
    while (w->root[node] != node) {
        w->root[node] = w->root[w->root[node]];
        node = w->root[node];
    }
    return node;
}

/* --- what a pair costs --- */

/* The change at the sample points of one of the pair; those inside `other` are left to it, where it is not NULL. */
static double cost_within(work *w, uint32_t node, const budget_shape *other, const budget_shape *shape,
                          uint32_t a, uint32_t b)
{
    const budget_samples *samples = &w->samples[w->slot[node]];
    const budget_shape *own = &w->merges->nodes[node].shape;
    double sum = 0;
    for (int i = 0; i < BUDGET_SAMPLES; i++) {
        shape_dvec3 p = budget_shape_point(own, w->ball.points[i]);
        if (other && budget_shape_u2(other, p) <= 1)
            continue;
        double was = (double)samples->profile[i], is = budget_profile(w->model, budget_shape_u2(shape, p));
        uint32_t owner = samples->owner[i] == UINT32_MAX ? UINT32_MAX : root_of(w, samples->owner[i]);
        bool theirs = owner == a || owner == b;
        if (is > was)
            sum += is - was;
        else if (theirs)
            sum += was - is;
    }
    return sum * own->volume / BUDGET_SAMPLES;
}

/* What the joined shape fills that neither of the pair did. */
static double cost_beyond(const work *w, const budget_shape *joined, const budget_shape *a,
                          const budget_shape *b)
{
    double sum = 0;
    for (int i = 0; i < BUDGET_SAMPLES; i++) {
        shape_dvec3 p = budget_shape_point(joined, w->ball.points[i]);
        if (budget_shape_u2(a, p) <= 1 || budget_shape_u2(b, p) <= 1)
            continue;
        uint32_t owner;
        double was = budget_profile(w->model, original_u2(w, p, &owner));
        double is = budget_profile(w->model, budget_shape_u2(joined, p));
        sum += is > was ? is - was : 0;
    }
    return sum * joined->volume / BUDGET_SAMPLES;
}

/* The best shape for a pair, and its cost. */
static double cost_of(work *w, uint32_t a, uint32_t b, budget_shape *best, budget_choice *choice)
{
    const budget_shape *shape_a = &w->merges->nodes[a].shape, *shape_b = &w->merges->nodes[b].shape;
    double cost, least;
    *choice = BUDGET_JOINED;
    if (w->model == SHAPE_MODEL_METABALL) {
        *best = budget_ball_join(shape_a, shape_b, &cost);
        return cost;
    }
    /* Either one alone: what is lost of the other. */
    least = cost_within(w, b, shape_a, shape_a, a, b);
    *choice = BUDGET_FIRST;
    *best = *shape_a;
    cost = cost_within(w, a, shape_b, shape_b, a, b);
    if (cost < least) {
        least = cost;
        *choice = BUDGET_SECOND;
        *best = *shape_b;
    }
    if (!(least > 0))
        return 0;
    budget_shape joined = budget_shape_join(shape_a, shape_b, &w->ball);
    cost = cost_within(w, a, NULL, &joined, a, b);
    if (cost < least)
        cost += cost_within(w, b, shape_a, &joined, a, b);
    if (cost < least)
        cost += cost_beyond(w, &joined, shape_a, shape_b);
    if (cost < least) {
        least = cost;
        *choice = BUDGET_JOINED;
        *best = joined;
    }
    return least;
}

/* --- the queue --- */

static bool cheaper(const candidate *x, const candidate *y)
{
    if (x->cost < y->cost || x->cost > y->cost)
        return x->cost < y->cost;
    return x->a < y->a || (x->a == y->a && x->b < y->b);
}

static shape_status push(work *w, candidate c, shape_error *error)
{
    shape_status status =
        shape_array_reserve((void **)&w->heap, &w->heap_capacity, w->heap_count + 1, sizeof *w->heap, error);
    if (status)
        return status;
    size_t i = w->heap_count++;
    for (; i > 0 && cheaper(&c, &w->heap[(i - 1) / 2]); i = (i - 1) / 2)
        w->heap[i] = w->heap[(i - 1) / 2];
    w->heap[i] = c;
    return SHAPE_OK;
}

static candidate pop(work *w)
{
    candidate top = w->heap[0], last = w->heap[--w->heap_count];
    size_t i = 0, child;
    while ((child = 2 * i + 1) < w->heap_count) {
        if (child + 1 < w->heap_count && cheaper(&w->heap[child + 1], &w->heap[child]))
            child++;
        if (!cheaper(&w->heap[child], &last))
            break;
        w->heap[i] = w->heap[child];
        i = child;
    }
    w->heap[i] = last;
    return top;
}

static shape_status push_pair(work *w, uint32_t a, uint32_t b, shape_error *error)
{
    budget_shape shape;
    budget_choice choice;
    candidate c = {0, a < b ? a : b, a < b ? b : a};
    c.cost = cost_of(w, c.a, c.b, &shape, &choice);
    return push(w, c, error);
}

/* --- neighbours --- */

static void add_partner(work *w, uint32_t node, uint32_t partner)
{
    uint32_t slot = w->slot[node];
    if (partner == UINT32_MAX)
        return;
    partner = root_of(w, partner);
    if (partner == node || w->partner_count[slot] == PARTNERS)
        return;
    for (int i = 0; i < w->partner_count[slot]; i++)
        if (w->partners[slot][i] == partner)
            return;
    w->partners[slot][w->partner_count[slot]++] = partner;
}

/* Whoever covers a node's sample points is its neighbour. */
static void add_owners(work *w, uint32_t node)
{
    for (int i = 0; i < BUDGET_SAMPLES && w->model != SHAPE_MODEL_METABALL; i++)
        add_partner(w, node, w->samples[w->slot[node]].owner[i]);
}

static shape_status push_partners(work *w, uint32_t node, bool later_only, shape_error *error)
{
    uint32_t slot = w->slot[node];
    shape_status status = SHAPE_OK;
    for (int i = 0; i < w->partner_count[slot] && !status; i++)
        if (!later_only || w->partners[slot][i] > node)
            status = push_pair(w, node, w->partners[slot][i], error);
    return status;
}

/* Finds all neighbours anew, and fills the queue. */
static shape_status find_neighbours(work *w, shape_error *error)
{
    size_t alive = 0;
    uint32_t *numbers = malloc(w->made * sizeof *numbers);
    shape_dvec3 *points = malloc(w->made * sizeof *points);
    budget_nearest tree = {0};
    shape_status status = numbers && points ? SHAPE_OK : shape_error_memory(error);
    for (size_t i = 0; i < w->made && !status; i++) {
        points[i] = w->merges->nodes[i].shape.centre;
        if (w->root[i] == i)
            numbers[alive++] = (uint32_t)i;
    }
    if (!status)
        status = budget_nearest_build(&tree, points, numbers, alive, error);
    for (size_t i = 0; i < alive && !status; i++) {
        uint32_t found[NEAREST];
        size_t count = budget_nearest_find(&tree, numbers[i], NEAREST, found);
        w->partner_count[w->slot[numbers[i]]] = 0;
        for (size_t k = 0; k < count; k++)
            add_partner(w, numbers[i], found[k]);
        add_owners(w, numbers[i]);
    }
    /* A pair that only the later of the two knows is told to the earlier, where it has room. */
    for (size_t i = 0; i < alive && !status; i++) {
        uint32_t slot = w->slot[numbers[i]];
        for (int k = 0; k < w->partner_count[slot]; k++)
            add_partner(w, w->partners[slot][k], numbers[i]);
    }
    w->heap_count = 0;
    for (size_t i = 0; i < alive && !status; i++)
        status = push_partners(w, numbers[i], true, error);
    budget_nearest_free(&tree);
    free(numbers);
    free(points);
    return status;
}

/* --- merging --- */

static shape_status merge(work *w, uint32_t a, uint32_t b, shape_error *error)
{
    budget_node *nodes = w->merges->nodes;
    uint32_t made = (uint32_t)w->made++, number = made - (uint32_t)w->merges->count;
    budget_node *node = &nodes[made];
    budget_choice choice;
    cost_of(w, a, b, &node->shape, &choice);
    node->same = choice == BUDGET_JOINED ? UINT32_MAX : nodes[choice == BUDGET_FIRST ? a : b].same;
    node->first = node->same != UINT32_MAX          ? node->same
                  : nodes[a].first < nodes[b].first ? nodes[a].first
                                                    : nodes[b].first;
    node->consumed = UINT32_MAX;
    nodes[a].consumed = nodes[b].consumed = number;
    uint32_t old[2 * PARTNERS], slot_a = w->slot[a], slot_b = w->slot[b];
    int count = 0;
    for (int i = 0; i < w->partner_count[slot_a]; i++)
        old[count++] = w->partners[slot_a][i];
    for (int i = 0; i < w->partner_count[slot_b]; i++)
        old[count++] = w->partners[slot_b][i];
    w->root[a] = w->root[b] = w->root[made] = made;
    w->slot[made] = slot_a;
    w->partner_count[slot_a] = 0;
    w->alive--;
    if (w->model != SHAPE_MODEL_METABALL)
        take_samples(w, made);
    for (int i = 0; i < count; i++)
        add_partner(w, made, old[i]);
    add_owners(w, made);
    /* So that they stay its neighbours when they are merged in turn. */
    for (int i = 0; i < w->partner_count[slot_a]; i++)
        add_partner(w, w->partners[slot_a][i], made);
    return push_partners(w, made, false, error);
}

static shape_status merge_all(work *w, shape_error *error)
{
    shape_status status = SHAPE_OK;
    while (w->alive > 1 && !status) {
        size_t half = w->alive / 2;
        status = find_neighbours(w, error);
        while (w->alive > half && w->heap_count && !status) {
            candidate c = pop(w);
            if (w->root[c.a] == c.a && w->root[c.b] == c.b)
                status = merge(w, c.a, c.b, error);
        }
    }
    return status;
}

static shape_status prepare(work *w, shape_error *error)
{
    size_t count = w->merges->count, all = 2 * count;
    w->merges->nodes = malloc(all * sizeof *w->merges->nodes);
    w->samples = malloc(count * sizeof *w->samples);
    w->slot = malloc(all * sizeof *w->slot);
    w->root = malloc(all * sizeof *w->root);
    w->partners = malloc(count * sizeof *w->partners);
    w->partner_count = calloc(count, 1);
    if (!w->merges->nodes || !w->samples || !w->slot || !w->root || !w->partners || !w->partner_count)
        return shape_error_memory(error);
    for (size_t i = 0; i < count; i++) {
        w->merges->nodes[i] =
            (budget_node){budget_shape_of(w->list, i), (uint32_t)i, (uint32_t)i, UINT32_MAX};
        w->slot[i] = w->root[i] = (uint32_t)i;
    }
    w->made = w->alive = count;
    w->ball = budget_ball_make();
    shape_status status = shape_tree_build(w->list, 1, &w->tree, error);
    if (status || w->model == SHAPE_MODEL_METABALL)
        return status;
#pragma omp parallel for schedule(dynamic, 256)
    for (size_t i = 0; i < count; i++)
        take_samples(w, (uint32_t)i);
    return SHAPE_OK;
}

shape_status budget_merges_make(budget_merges *merges, const shape_primitives *list, shape_model model,
                                shape_error *error)
{
    *merges = (budget_merges){NULL, shape_primitives_count(list)};
    if (!merges->count)
        return SHAPE_OK;
    work w = {.list = list, .model = model, .merges = merges};
    shape_status status = prepare(&w, error);
    if (!status)
        status = merge_all(&w, error);
    shape_tree_free(&w.tree);
    free(w.samples);
    free(w.slot);
    free(w.root);
    free(w.partners);
    free(w.partner_count);
    free(w.heap);
    if (status)
        budget_merges_free(merges);
    return status;
}

void budget_merges_free(budget_merges *merges)
{
    free(merges->nodes);
    memset(merges, 0, sizeof *merges);
}

/* --- what is left --- */

static float as_size(double x)
{
    return x < (double)FLT_MIN ? FLT_MIN : x > (double)FLT_MAX ? FLT_MAX : (float)x;
}

/* A sphere where the axes agree to float precision, else an ellipsoid, turned right-handed. */
static shape_status add_shape(const budget_shape *shape, shape_primitives *cut, shape_error *error)
{
    double size[3];
    shape_dvec3 axis[3];
    for (int k = 0; k < 3; k++) {
        size[k] = shape_dvec3_length(shape->axes[k]);
        axis[k] = shape_dvec3_scale(shape->axes[k], 1 / size[k]);
    }
    float x = (float)shape->centre.x, y = (float)shape->centre.y, z = (float)shape->centre.z;
    if (fabs(size[0] - size[1]) <= 1e-6 * size[0] && fabs(size[0] - size[2]) <= 1e-6 * size[0])
        return shape_primitives_add_sphere(cut, (shape_sphere){x, y, z, as_size(size[0])}, error);
    if (shape_dvec3_dot(axis[2], shape_dvec3_cross(axis[0], axis[1])) < 0)
        axis[2] = shape_dvec3_scale(axis[2], -1);
    shape_ellipsoid e = {.x = x, .y = y, .z = z};
    e.a = as_size(size[0]), e.b = as_size(size[1]), e.c = as_size(size[2]);
    e.q = shape_quat_from_columns(axis[0], axis[1], axis[2]);
    return shape_primitives_add_ellipsoid(cut, e, error);
}

shape_status budget_merges_cut(const budget_merges *merges, const shape_primitives *list, size_t wanted,
                               shape_primitives *cut, shape_error *error)
{
    size_t count = merges->count, done = count - wanted;
    uint32_t *place = malloc((count + 1) * sizeof *place);
    if (!place)
        return shape_error_memory(error);
    for (size_t i = 0; i < count; i++)
        place[i] = UINT32_MAX;
    for (size_t i = 0; i < count + done; i++)
        if (merges->nodes[i].consumed >= done)
            place[merges->nodes[i].first] = (uint32_t)i;
    shape_status status = shape_primitives_reserve(cut, wanted, wanted, error);
    for (size_t i = 0; i < count && !status; i++) {
        if (place[i] == UINT32_MAX)
            continue;
        const budget_node *node = &merges->nodes[place[i]];
        if (node->same == UINT32_MAX)
            status = add_shape(&node->shape, cut, error);
        else if (node->same < list->sphere_count)
            cut->spheres[cut->sphere_count++] = list->spheres[node->same];
        else
            cut->ellipsoids[cut->ellipsoid_count++] = list->ellipsoids[node->same - list->sphere_count];
    }
    free(place);
    return status;
}
