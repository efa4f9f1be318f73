/* Containment pruning (Jiménez 2018 Eq. 17; ellipsoids by the S-lemma) and hollowing (section 3.6.1). */
#include "shape/prune.h"

#include <stdlib.h>
#include <string.h>

#include "primitive/axes.h"
#include "primitive/reach.h"

bool shape_sphere_contains(shape_sphere outer, shape_sphere inner)
{
    double slack = (double)outer.radius - inner.radius;
    double x = (double)outer.x - inner.x, y = (double)outer.y - inner.y, z = (double)outer.z - inner.z;
    return slack >= 0 && x * x + y * y + z * z <= slack * slack;
}

/* The S-lemma's inequality for squared axes s and centre q along them; see prune.h. Concave in t, so halving by the
 * sign of its slope finds the largest value; any t where it holds is proof. */
static bool in_unit_ball(const double s[3], const double q[3])
{
    double low = s[0] > s[1] ? s[0] : s[1];
    low = low > s[2] ? low : s[2];
    double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2];
    if (!(low < 1 && square < 1))
        return false;
    double high = 1;
    for (int step = 0; step < 48; step++) {
        double t = (low + high) / 2, value = 1 - t, slope = -1;
        if (!(t > low && t < high))
            return false;
        for (int k = 0; k < 3; k++) {
            double ratio = q[k] / (t - s[k]);
            value -= t * q[k] * ratio;
            slope += ratio * ratio * s[k];
        }
        if (value >= 0)
            return true;
        if (slope > 0)
            low = t;
        else
            high = t;
    }
    return false;
}

bool shape_ellipsoid_contains(const shape_ellipsoid *outer, const shape_ellipsoid *inner)
{
    static const double margin = 1e-6;
    shape_dvec3 axes[3], columns[3];
    shape_axes_of(outer, axes);
    shape_axes_of(inner, columns);
    shape_dvec3 offset = {(double)inner->x - outer->x, (double)inner->y - outer->y,
                          (double)inner->z - outer->z};
    /* Into the space where the outer one, shrunk, is the unit ball: coordinates along its axes in units of each. */
    for (int k = 0; k < 3; k++)
        axes[k] = shape_dvec3_scale(axes[k], 1 / (shape_dvec3_dot(axes[k], axes[k]) * (1 - margin)));
    shape_dvec3 centre = {shape_dvec3_dot(axes[0], offset), shape_dvec3_dot(axes[1], offset),
                          shape_dvec3_dot(axes[2], offset)};
    if (!(shape_dvec3_dot(centre, centre) < 1))
        return false;
    for (int k = 0; k < 3; k++) {
        shape_dvec3 c = columns[k];
        columns[k] = shape_dvec3_make(shape_dvec3_dot(axes[0], c), shape_dvec3_dot(axes[1], c),
                                      shape_dvec3_dot(axes[2], c));
    }
    shape_axes_diagonalize(columns);
    double s[3], q[3];
    for (int k = 0; k < 3; k++) {
        s[k] = shape_dvec3_dot(columns[k], columns[k]);
        q[k] = s[k] > 0 ? shape_dvec3_dot(columns[k], centre) / sqrt(s[k]) : 0;
    }
    return in_unit_ball(s, q);
}

static bool same_ellipsoid(const shape_ellipsoid *a, const shape_ellipsoid *b)
{
    return a->x == b->x && a->y == b->y && a->z == b->z && a->a == b->a && a->b == b->b && a->c == b->c &&
           a->q.x == b->q.x && a->q.y == b->q.y && a->q.z == b->q.z && a->q.w == b->q.w;
}

/* The primitive in question, and the list it is of. */
typedef struct search {
    const shape_primitives *list;
    size_t number;
    shape_sphere sphere; /* where it is one */
} search;

static shape_sphere sphere_of(const shape_reach_block *block, int k)
{
    shape_sphere sphere = {block->position[0][k], block->position[1][k], block->position[2][k],
                           block->reach[k]};
    return sphere;
}

/* Whether the primitive in the block makes the one in question needless. Of two equal ones it is the later. Spheres are
 * read from the block, since the list's order is another one and memory is slow. */
static bool replaces(const shape_reach_block *block, int k, void *context)
{
    const search *s = context;
    size_t i = s->number, j = (size_t)block->number[k], spheres = s->list->sphere_count;
    if (i == j)
        return false;
    if (i < spheres && j < spheres) {
        shape_sphere outer = sphere_of(block, k);
        return (outer.radius > s->sphere.radius || j < i) && shape_sphere_contains(outer, s->sphere);
    }
    const shape_primitives *list = s->list;
    shape_ellipsoid outer =
        j < spheres ? shape_axes_sphere(&list->spheres[j]) : list->ellipsoids[j - spheres];
    shape_ellipsoid inner =
        i < spheres ? shape_axes_sphere(&list->spheres[i]) : list->ellipsoids[i - spheres];
    if (i >= spheres && j >= spheres && same_ellipsoid(&outer, &inner))
        return j < i;
    return shape_ellipsoid_contains(&outer, &inner);
}

/* The question of what holds the k-th primitive of a block. */
static shape_reach_query query_of(const shape_primitives *list, const shape_reach_block *block, int k)
{
    shape_reach_query query = {
        .inner = block->reach[k], .outer = block->reach[k], .before = block->number[k]};
    for (int axis = 0; axis < 3; axis++)
        query.min[axis] = query.max[axis] = block->position[axis][k];
    if ((size_t)block->number[k] >= list->sphere_count) {
        const shape_ellipsoid *e = &list->ellipsoids[(size_t)block->number[k] - list->sphere_count];
        float smaller = e->a < e->b ? e->a : e->b;
        query.inner = smaller < e->c ? smaller : e->c;
    }
    return query;
}

/* Widens a question so that what answers `other` answers it too. */
static void widen(shape_reach_query *query, const shape_reach_query *other)
{
    for (int axis = 0; axis < 3; axis++) {
        query->min[axis] = other->min[axis] < query->min[axis] ? other->min[axis] : query->min[axis];
        query->max[axis] = other->max[axis] > query->max[axis] ? other->max[axis] : query->max[axis];
    }
    query->inner = other->inner < query->inner ? other->inner : query->inner;
    query->outer = other->outer < query->outer ? other->outer : query->outer;
    query->before = other->before > query->before ? other->before : query->before;
}

/* Marks what is needless in a block. Its primitives are neighbours, so the way through the tree is made once for all,
 * unless they turn out to be far apart. */
static void mark_block(const shape_reach *tree, const shape_primitives *list, size_t b, unsigned char *marked)
{
    enum { ROOM = 32 };
    const shape_reach_block *block = &tree->blocks[b];
    shape_reach_query queries[SHAPE_REACH_WIDTH], all = query_of(list, block, 0);
    size_t near[ROOM], count;
    for (int k = 0; k < SHAPE_REACH_WIDTH && block->reach[k] >= 0; k++) {
        queries[k] = query_of(list, block, k);
        widen(&all, &queries[k]);
    }
    bool gathered = shape_reach_gather(tree, &all, near, ROOM, &count);
    for (int k = 0; k < SHAPE_REACH_WIDTH && block->reach[k] >= 0; k++) {
        search s = {.list = list, .number = (size_t)block->number[k], .sphere = sphere_of(block, k)};
        marked[s.number] = gathered ? shape_reach_find_among(tree, near, count, &queries[k], replaces, &s)
                                    : shape_reach_find(tree, &queries[k], replaces, &s);
    }
}

static size_t keep_unmarked(shape_primitives *list, const unsigned char *marked)
{
    size_t kept = 0, spheres = list->sphere_count, before = shape_primitives_count(list);
    for (size_t i = 0; i < spheres; i++)
        if (!marked[i])
            list->spheres[kept++] = list->spheres[i];
    list->sphere_count = kept;
    kept = 0;
    for (size_t i = 0; i < list->ellipsoid_count; i++)
        if (!marked[spheres + i])
            list->ellipsoids[kept++] = list->ellipsoids[i];
    list->ellipsoid_count = kept;
    return before - shape_primitives_count(list);
}

shape_status shape_primitives_prune(shape_primitives *list, size_t *removed, shape_error *error)
{
    enum { PARALLEL = 2000 };
    if (removed)
        *removed = 0;
    size_t count = shape_primitives_count(list);
    if (count < 2)
        return SHAPE_OK;
    shape_reach tree;
    shape_status status = shape_reach_build(&tree, list, error);
    if (status)
        return status;
    unsigned char *marked = calloc(count, 1);
    if (!marked) {
        shape_reach_free(&tree);
        return shape_error_memory(error);
    }
    /* In the tree's order, so that neighbouring questions walk through the same nodes. */
    if (count < PARALLEL) {
        for (size_t b = 0; b < tree.block_count; b++)
            mark_block(&tree, list, b, marked);
    } else {
#pragma omp parallel for schedule(dynamic, 256)
        for (size_t b = 0; b < tree.block_count; b++)
            mark_block(&tree, list, b, marked);
    }
    size_t gone = keep_unmarked(list, marked);
    if (removed)
        *removed = gone;
    free(marked);
    shape_reach_free(&tree);
    return SHAPE_OK;
}

/* The centre of primitive i, spheres first. */
static shape_dvec3 centre_of(const shape_primitives *list, size_t i)
{
    if (i < list->sphere_count)
        return shape_dvec3_make(list->spheres[i].x, list->spheres[i].y, list->spheres[i].z);
    const shape_ellipsoid *e = &list->ellipsoids[i - list->sphere_count];
    return shape_dvec3_make(e->x, e->y, e->z);
}

shape_core shape_primitives_core(const shape_primitives *list)
{
    shape_core core = {{0, 0, 0}, {0, 0, 0}};
    size_t count = shape_primitives_count(list);
    if (!count)
        return core;
    shape_dvec3 sum = {0, 0, 0}, squares = {0, 0, 0};
    for (size_t i = 0; i < count; i++)
        sum = shape_dvec3_add(sum, centre_of(list, i));
    shape_dvec3 mean = shape_dvec3_scale(sum, 1 / (double)count);
    for (size_t i = 0; i < count; i++) {
        shape_dvec3 d = shape_dvec3_sub(centre_of(list, i), mean);
        squares = shape_dvec3_add(squares, shape_dvec3_make(d.x * d.x, d.y * d.y, d.z * d.z));
    }
    core.centre[0] = mean.x, core.centre[1] = mean.y, core.centre[2] = mean.z;
    core.half[0] = 0.75 * sqrt(squares.x / (double)count);
    core.half[1] = sqrt(squares.y / (double)count) / 3;
    core.half[2] = 0.75 * sqrt(squares.z / (double)count);
    return core;
}

static bool in_core(const shape_core *core, shape_dvec3 p)
{
    return fabs(p.x - core->centre[0]) < core->half[0] && fabs(p.y - core->centre[1]) < core->half[1] &&
           fabs(p.z - core->centre[2]) < core->half[2];
}

size_t shape_primitives_hollow(shape_primitives *list, const shape_core *core)
{
    size_t inside = 0, count = shape_primitives_count(list), kept = 0;
    for (size_t i = 0; i < count; i++)
        inside += in_core(core, centre_of(list, i));
    if (inside == count)
        return 0;
    for (size_t i = 0; i < list->sphere_count; i++)
        if (!in_core(core, centre_of(list, i)))
            list->spheres[kept++] = list->spheres[i];
    list->sphere_count = kept;
    kept = 0;
    for (size_t i = 0; i < list->ellipsoid_count; i++) {
        const shape_ellipsoid *e = &list->ellipsoids[i];
        if (!in_core(core, shape_dvec3_make(e->x, e->y, e->z)))
            list->ellipsoids[kept++] = *e;
    }
    list->ellipsoid_count = kept;
    return inside;
}
