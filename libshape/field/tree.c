/* The bounding-box tree over primitive supports. Splits: surface-area heuristic over 16 bins a axis (Wald, "On fast
 * construction of SAH-based bounding volume hierarchies", 2007). */
#include "shape/tree.h"

#include <stdlib.h>
#include <string.h>

enum { BINS = 16 };

typedef struct leaf {
    shape_box box;
    float content;
} leaf;

static float centre(const leaf *l, int axis)
{
    const float *min = &l->box.min.x, *max = &l->box.max.x;
    return 0.5f * min[axis] + 0.5f * max[axis];
}

static float area(shape_box b)
{
    float x = b.max.x - b.min.x, y = b.max.y - b.min.y, z = b.max.z - b.min.z;
    return x * y + y * z + z * x;
}

typedef struct split {
    float cost, origin, scale;
    int axis, bin;
} split;

static int bin_of(const leaf *l, const split *s)
{
    int bin = (int)((centre(l, s->axis) - s->origin) * s->scale);
    return bin < 0 ? 0 : bin >= BINS ? BINS - 1 : bin;
}

/* The best place to cut along one axis; cost stays as it is where all centres agree. */
static void try_axis(const leaf *leaves, size_t count, int axis, float low, float high, split *best)
{
    if (!(high > low))
        return;
    split s = {0, low, BINS / (high - low), axis, 0};
    shape_box boxes[BINS], from_right[BINS];
    size_t counts[BINS] = {0};
    for (int i = 0; i < BINS; i++)
        boxes[i] = shape_box_empty();
    for (size_t i = 0; i < count; i++) {
        int bin = bin_of(&leaves[i], &s);
        boxes[bin] = shape_box_join(boxes[bin], leaves[i].box);
        counts[bin]++;
    }
    shape_box right = shape_box_empty();
    for (int i = BINS - 1; i > 0; i--) {
        if (counts[i])
            right = shape_box_join(right, boxes[i]);
        from_right[i] = right;
    }
    shape_box left = shape_box_empty();
    size_t on_left = 0;
    for (int i = 1; i < BINS; i++) {
        if (counts[i - 1])
            left = shape_box_join(left, boxes[i - 1]);
        on_left += counts[i - 1];
        if (!on_left || on_left == count)
            continue;
        float cost = (float)on_left * area(left) + (float)(count - on_left) * area(from_right[i]);
        if (cost < best->cost) {
            s.cost = cost;
            s.bin = i;
            *best = s;
        }
    }
}

/* Parts the leaves in two, keeping their order within each part; returns the size of the first. */
static size_t divide(leaf *leaves, leaf *spare, size_t count)
{
    shape_box centres = shape_box_empty();
    for (size_t i = 0; i < count; i++)
        centres = shape_box_add_point(
            centres, shape_vec3_make(centre(&leaves[i], 0), centre(&leaves[i], 1), centre(&leaves[i], 2)));
    split best = {INFINITY, 0, 0, -1, 0};
    for (int axis = 0; axis < 3; axis++)
        try_axis(leaves, count, axis, (&centres.min.x)[axis], (&centres.max.x)[axis], &best);
    if (best.axis < 0)
        return count / 2; /* all centres in one place: any halves will do */
    size_t first = 0, second = 0;
    for (size_t i = 0; i < count; i++) {
        if (bin_of(&leaves[i], &best) < best.bin)
            leaves[first++] = leaves[i];
        else
            spare[second++] = leaves[i];
    }
    memcpy(leaves + first, spare, second * sizeof *leaves);
    return first;
}

typedef struct task {
    size_t begin, count;
} task;

/* Depth first: a node is written when it is popped, the right part waits on the stack. The skip of an inner node is
 * its own number plus the 2 n - 1 nodes of its subtree. */
static shape_status build(leaf *leaves, leaf *spare, size_t count, shape_tree *tree, shape_error *error)
{
    size_t capacity = 128, depth = 0;
    task *stack = malloc(capacity * sizeof *stack);
    if (!stack)
        return shape_error_memory(error);
    stack[depth++] = (task){0, count};
    while (depth) {
        task t = stack[--depth];
        shape_tree_node *node = &tree->nodes[tree->count];
        shape_box box = shape_box_empty();
        for (size_t i = 0; i < t.count; i++) /* NOLINTNEXTLINE: the caller fills all `count` of them */
            box = shape_box_join(box, leaves[t.begin + i].box);
        node->min = box.min, node->max = box.max;
        node->skip = (float)(tree->count + 2 * t.count - 1);
        node->content = t.count == 1 ? leaves[t.begin].content : 0;
        tree->count++;
        if (t.count == 1)
            continue;
        if (depth + 2 > capacity) {
            task *grown = realloc(stack, 2 * capacity * sizeof *stack);
            if (!grown) {
                free(stack);
                return shape_error_memory(error);
            }
            stack = grown;
            capacity *= 2;
        }
        size_t first = divide(leaves + t.begin, spare, t.count);
        stack[depth++] = (task){t.begin + first, t.count - first};
        stack[depth++] = (task){t.begin, first};
    }
    free(stack);
    return SHAPE_OK;
}

shape_status shape_tree_build(const shape_primitives *list, float support, shape_tree *tree,
                              shape_error *error)
{
    size_t count = shape_primitives_count(list);
    memset(tree, 0, sizeof *tree);
    if (!count)
        return SHAPE_OK;
    if (count > SHAPE_TREE_MAX)
        return shape_error_set(error, SHAPE_ERROR_LIMIT,
                               "%zu primitives are more than the %d that can be drawn", count,
                               SHAPE_TREE_MAX);
    leaf *leaves = malloc(count * sizeof *leaves), *spare = malloc(count * sizeof *spare);
    tree->nodes = malloc((2 * count - 1) * sizeof *tree->nodes);
    shape_status status = SHAPE_OK;
    if (!leaves || !spare || !tree->nodes)
        status = shape_error_memory(error);
    for (size_t i = 0; i < list->sphere_count && !status; i++)
        leaves[i] = (leaf){shape_sphere_box(&list->spheres[i], support), (float)(i + 1)};
    for (size_t i = 0; i < list->ellipsoid_count && !status; i++)
        leaves[list->sphere_count + i] =
            (leaf){shape_ellipsoid_box(&list->ellipsoids[i], support), -(float)(i + 1)};
    if (!status)
        status = build(leaves, spare, count, tree, error);
    free(leaves);
    free(spare);
    if (status)
        shape_tree_free(tree);
    return status;
}

void shape_tree_free(shape_tree *tree)
{
    free(tree->nodes);
    memset(tree, 0, sizeof *tree);
}
