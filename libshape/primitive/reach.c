/* A tree over primitives in the order of a Hilbert curve (Hilbert 1891; computed as in Skilling, "Programming the
 * Hilbert curve", 2004), eight to a node, so that a node's children are tested in one vectorised go. Tests are made in
 * single precision with a margin above its rounding; whoever asks makes the exact test. */
#include "primitive/reach.h"

#include <stdlib.h>
#include <string.h>

enum { WIDTH = SHAPE_REACH_WIDTH, SMALL = 64, LARGE = 20000, BITS = 10, CELLS = 1 << BITS, CHUNK = 128 };

/* A primitive before it goes into its block. */
typedef struct item {
    float position[3], reach;
    int32_t number;
} item;

static void load_items(item *items, const shape_primitives *list)
{
    for (size_t i = 0; i < list->sphere_count; i++) {
        const shape_sphere *s = &list->spheres[i];
        item one = {{s->x, s->y, s->z}, s->radius, (int32_t)i};
        items[i] = one;
    }
    for (size_t i = 0; i < list->ellipsoid_count; i++) {
        const shape_ellipsoid *e = &list->ellipsoids[i];
        float reach = e->a > e->b ? e->a : e->b;
        size_t number = list->sphere_count + i;
        item one = {{e->x, e->y, e->z}, reach > e->c ? reach : e->c, (int32_t)number};
        items[number] = one;
    }
}

static void box_of(const item *items, size_t count, float min[3], float max[3])
{
    for (int k = 0; k < 3; k++)
        min[k] = max[k] = items->position[k];
    for (size_t i = 1; i < count; i++)
        for (int k = 0; k < 3; k++) {
            float p = items[i].position[k];
            min[k] = p < min[k] ? p : min[k];
            max[k] = p > max[k] ? p : max[k];
        }
}

static int widest_axis(const float min[3], const float max[3])
{
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (max[k] - min[k] > max[axis] - min[axis])
            axis = k;
    return axis;
}

/* Bit k of a 10-bit number goes to bit 3 k. */
static inline uint32_t spread(uint32_t x)
{
    x = (x | x << 16) & 0x030000ffu;
    x = (x | x << 8) & 0x0300f00fu;
    x = (x | x << 4) & 0x030c30c3u;
    return (x | x << 2) & 0x09249249u;
}

/* All ones where the bit is set. Written so that it is one comparison of vectors. */
static inline uint32_t mask_of(uint32_t x, uint32_t bit)
{
    return (x & bit) == bit ? 0xffffffffu : 0;
}

/* The places of a chunk of cells on the Hilbert curve through CELLS^3 cells (Skilling 2004). The cells are spoilt. */
static void find_places(uint32_t *restrict x, uint32_t *restrict y, uint32_t *restrict z,
                        uint32_t *restrict place)
{
    for (uint32_t bit = CELLS / 2; bit > 1; bit >>= 1) {
        uint32_t low = bit - 1;
#pragma omp simd
        for (int i = 0; i < CHUNK; i++) {
            /* For each axis: where the bit is set, the lower bits of x turn round, else they change places with those
             * of the axis. */
            uint32_t a = x[i] ^ (low & mask_of(x[i], bit));
            uint32_t set = mask_of(y[i], bit), swap = (a ^ y[i]) & low & ~set;
            a ^= swap | (low & set);
            y[i] ^= swap;
            set = mask_of(z[i], bit);
            swap = (a ^ z[i]) & low & ~set;
            x[i] = a ^ (swap | (low & set));
            z[i] ^= swap;
        }
    }
#pragma omp simd
    for (int i = 0; i < CHUNK; i++) {
        y[i] ^= x[i];
        z[i] ^= y[i];
        place[i] = 0;
    }
    for (uint32_t bit = CELLS / 2; bit > 1; bit >>= 1) {
#pragma omp simd
        for (int i = 0; i < CHUNK; i++)
            place[i] ^= (bit - 1) & mask_of(z[i], bit);
    }
#pragma omp simd
    for (int i = 0; i < CHUNK; i++)
        place[i] = spread(x[i] ^ place[i]) << 2 | spread(y[i] ^ place[i]) << 1 | spread(z[i] ^ place[i]);
}

/* A place on the curve above an index. */
typedef uint64_t record;

static uint32_t place_of(record r)
{
    return (uint32_t)(r >> 32);
}

static void make_records(record *records, const item *items, size_t count)
{
    float min[3], max[3];
    box_of(items, count, min, max);
    int axis = widest_axis(min, max);
    double extent = (double)max[axis] - min[axis], scale = extent > 0 ? (CELLS - 1) / extent : 0;
#pragma omp parallel for schedule(static) if (count > LARGE)
    for (size_t begin = 0; begin < count; begin += CHUNK) {
        uint32_t cell[3][CHUNK], place[CHUNK];
        size_t size = count - begin < CHUNK ? count - begin : CHUNK;
        memset(cell, 0, sizeof cell);
        for (size_t i = 0; i < size; i++)
            for (int k = 0; k < 3; k++)
                cell[k][i] = (uint32_t)(((double)items[begin + i].position[k] - min[k]) * scale);
        find_places(cell[0], cell[1], cell[2], place);
        for (size_t i = 0; i < size; i++)
            records[begin + i] = (record)place[i] << 32 | (uint32_t)(begin + i);
    }
}

/* Sorts by the place, keeping the order of equal ones: ten bits a pass. Returns which of the arrays has the result. */
static record *sort_records(record *records, record *spare, size_t count)
{
    for (int shift = 32; shift < 32 + 3 * BITS; shift += BITS) {
        size_t starts[CELLS] = {0}, sum = 0;
        for (size_t i = 0; i < count; i++)
            starts[records[i] >> shift & (CELLS - 1)]++;
        for (size_t k = 0; k < CELLS; k++) {
            size_t size = starts[k];
            starts[k] = sum;
            sum += size;
        }
        for (size_t i = 0; i < count; i++)
            spare[starts[records[i] >> shift & (CELLS - 1)]++] = records[i];
        record *sorted = spare;
        spare = records;
        records = sorted;
    }
    return records;
}

static float middle_of(float a, float b, float c)
{
    float low = a < b ? a : b, high = a < b ? b : a;
    return c < low ? low : c > high ? high : c;
}

/* Orders the items so that those before items[middle] are not above it on the axis, and those behind not below
 * (Hoare's selection, 1961). */
static void split(item *items, size_t count, size_t middle, int axis)
{
    size_t begin = 0, end = count; /* items[middle] belongs in here */
    while (end - begin > 1) {
        size_t step = (end - begin) / 4;
        float pivot = middle_of(items[begin + step].position[axis], items[begin + 2 * step].position[axis],
                                items[end - 1 - step].position[axis]);
        size_t low = begin, high = end - 1;
        for (;;) {
            while (items[low].position[axis] < pivot)
                low++;
            while (items[high].position[axis] > pivot)
                high--;
            if (low >= high)
                break;
            item old = items[low];
            items[low++] = items[high];
            items[high--] = old;
        }
        /* Up to `high` nothing is above the pivot, from `low` on nothing below; where they met, they stand on an item
         * that equals it. */
        if (low == high && middle == low)
            return;
        if (middle < low)
            end = low;
        else
            begin = low == high ? low + 1 : low;
    }
}

/* Where the curve's cells are too coarse, a crowd far from a lone primitive say: halves about the median. */
static void order_crowd(item *items, size_t count)
{
    float min[3], max[3];
    box_of(items, count, min, max);
    int axis = widest_axis(min, max);
    if (count <= WIDTH || !(max[axis] > min[axis]))
        return;
    size_t half = count / 2;
    split(items, count, half, axis);
    order_crowd(items, half);
    order_crowd(items + half, count - half);
}

/* Puts the items into an order in which neighbours are near one another. */
static shape_status order_items(item **items, size_t count, shape_error *error)
{
    record *records = malloc(2 * count * sizeof *records);
    item *ordered = malloc(count * sizeof *ordered);
    if (!records || !ordered) {
        free(records);
        free(ordered);
        return shape_error_memory(error);
    }
    make_records(records, *items, count);
    const record *sorted = sort_records(records, records + count, count);
#pragma omp parallel for schedule(static) if (count > LARGE)
    for (size_t i = 0; i < count; i++)
        ordered[i] = (*items)[(uint32_t)sorted[i]];
    for (size_t begin = 0, end; begin < count; begin = end) {
        for (end = begin + 1; end < count && place_of(sorted[end]) == place_of(sorted[begin]); end++)
            ;
        if (end - begin > 4 * WIDTH)
            order_crowd(ordered + begin, end - begin);
    }
    free(records);
    free(*items);
    *items = ordered;
    return SHAPE_OK;
}

static void fill_blocks(shape_reach *tree, const item *items)
{
#pragma omp parallel for schedule(static) if (tree->count > LARGE)
    for (size_t b = 0; b < tree->block_count; b++) {
        shape_reach_block *block = &tree->blocks[b];
        for (size_t k = 0; k < WIDTH; k++) {
            size_t i = b * WIDTH + k;
            const item *from = &items[i < tree->count ? i : tree->count - 1];
            for (int axis = 0; axis < 3; axis++)
                block->position[axis][k] = from->position[axis]; /* NOLINT: all items are filled */
            block->reach[k] = i < tree->count ? from->reach : -1;
            block->number[k] = from->number;
        }
    }
}

/* What a node says of one child. */
typedef struct bound {
    float min[3], max[3], reach;
    int32_t first;
} bound;

static void join(bound *sum, const float min[3], const float max[3], float reach, int32_t first)
{
    for (int axis = 0; axis < 3; axis++) {
        sum->min[axis] = min[axis] < sum->min[axis] ? min[axis] : sum->min[axis];
        sum->max[axis] = max[axis] > sum->max[axis] ? max[axis] : sum->max[axis];
    }
    if (reach > sum->reach || (reach == sum->reach && first < sum->first)) {
        sum->reach = reach;
        sum->first = first;
    }
}

static bound bound_block(const shape_reach_block *block)
{
    bound sum = {{block->position[0][0], block->position[1][0], block->position[2][0]},
                 {block->position[0][0], block->position[1][0], block->position[2][0]},
                 block->reach[0],
                 block->number[0]};
    for (int k = 1; k < WIDTH; k++) {
        const float p[3] = {block->position[0][k], block->position[1][k], block->position[2][k]};
        join(&sum, p, p, block->reach[k], block->number[k]);
    }
    return sum;
}

static bound bound_node(const shape_reach_node *node)
{
    bound sum = {{node->min[0][0], node->min[1][0], node->min[2][0]},
                 {node->max[0][0], node->max[1][0], node->max[2][0]},
                 node->reach[0],
                 node->first[0]};
    for (int k = 1; k < WIDTH && node->reach[k] >= 0; k++) {
        const float min[3] = {node->min[0][k], node->min[1][k], node->min[2][k]};
        const float max[3] = {node->max[0][k], node->max[1][k], node->max[2][k]};
        join(&sum, min, max, node->reach[k], node->first[k]);
    }
    return sum;
}

static void fill_node(shape_reach *tree, int level, size_t n, size_t children)
{
    shape_reach_node *node = &tree->nodes[tree->start[level] + n];
    for (size_t k = 0; k < WIDTH; k++) {
        size_t child = n * WIDTH + k;
        bound b = {.reach = -1};
        if (child < children)
            b = level == 1 ? bound_block(&tree->blocks[child])
                           : bound_node(&tree->nodes[tree->start[level - 1] + child]);
        for (int axis = 0; axis < 3; axis++) {
            node->min[axis][k] = b.min[axis];
            node->max[axis][k] = b.max[axis];
        }
        node->reach[k] = b.reach;
        node->first[k] = b.first;
    }
}

static void fill_nodes(shape_reach *tree)
{
    size_t children = tree->block_count;
    for (int level = 1; level <= tree->top; level++) {
        size_t nodes = (children + WIDTH - 1) / WIDTH;
        if (nodes > LARGE / WIDTH) {
#pragma omp parallel for schedule(static)
            for (size_t n = 0; n < nodes; n++)
                fill_node(tree, level, n, children);
        } else {
            for (size_t n = 0; n < nodes; n++)
                fill_node(tree, level, n, children);
        }
        children = nodes;
    }
}

/* Counts levels and nodes, and takes the memory. */
static shape_status allocate(shape_reach *tree, shape_error *error)
{
    tree->block_count = (tree->count + WIDTH - 1) / WIDTH;
    size_t nodes = tree->block_count, total = 0;
    do {
        nodes = (nodes + WIDTH - 1) / WIDTH;
        tree->start[++tree->top] = total;
        total += nodes;
    } while (nodes > 1);
    tree->blocks = malloc(tree->block_count * sizeof *tree->blocks);
    tree->nodes = malloc(total * sizeof *tree->nodes);
    return tree->blocks && tree->nodes ? SHAPE_OK : shape_error_memory(error);
}

shape_status shape_reach_build(shape_reach *tree, const shape_primitives *list, shape_error *error)
{
    memset(tree, 0, sizeof *tree);
    tree->count = shape_primitives_count(list);
    if (tree->count > INT32_MAX)
        return shape_error_set(error, SHAPE_ERROR_LIMIT, "more than 2^31 primitives in one cloud (split it)");
    if (!tree->count)
        return SHAPE_OK;
    item few[SMALL], *items = few;
    shape_status status = allocate(tree, error);
    if (!status && tree->count > SMALL) {
        items = malloc(tree->count * sizeof *items);
        if (!items)
            status = shape_error_memory(error);
    }
    if (!status) {
        load_items(items, list);
        if (items != few)
            status = order_items(&items, tree->count, error);
    }
    if (!status) {
        fill_blocks(tree, items);
        fill_nodes(tree);
    }
    if (items != few)
        free(items);
    if (status)
        shape_reach_free(tree);
    return status;
}

void shape_reach_free(shape_reach *tree)
{
    free(tree->blocks);
    free(tree->nodes);
    memset(tree, 0, sizeof *tree);
}

/* The squared length up to which something that reaches further by `slack` may still hold the query: with room for six
 * roundings of single precision, and for what is lost below its smallest number. */
static inline float limit(float slack)
{
    return slack * slack * 1.000001f + 1e-37f;
}

static const int bit_of[WIDTH] = {1, 2, 4, 8, 16, 32, 64, 128};

/* Which children of a node may hold what is looked for: a bit each. */
static int test_node(const shape_reach_node *node, const shape_reach_query *query)
{
    int mask = 0;
#pragma omp simd reduction(| : mask)
    for (int k = 0; k < WIDTH; k++) {
        float square = 0;
        for (int axis = 0; axis < 3; axis++) {
            float below = node->min[axis][k] - query->max[axis];
            float above = query->min[axis] - node->max[axis][k];
            float d = below > above ? below : above;
            d = d > 0 ? d : 0;
            square += d * d;
        }
        int pass = (square <= limit(node->reach[k] - query->inner)) & (node->reach[k] >= query->outer) &
                   ((node->reach[k] > query->outer) | (node->first[k] < query->before));
        mask |= -pass & bit_of[k];
    }
    return mask;
}

/* Which of a block's primitives meet the query: a bit each. */
static int test_block(const shape_reach_block *block, const shape_reach_query *query)
{
    int mask = 0;
#pragma omp simd reduction(| : mask)
    for (int k = 0; k < WIDTH; k++) {
        float x = block->position[0][k] - query->min[0];
        float y = block->position[1][k] - query->min[1];
        float z = block->position[2][k] - query->min[2];
        int pass = (x * x + y * y + z * z <= limit(block->reach[k] - query->inner)) &
                   (block->reach[k] >= query->outer);
        mask |= -pass & bit_of[k];
    }
    return mask;
}

static int lowest(int mask)
{
    return __builtin_ctz((unsigned)mask);
}
static int highest(int mask)
{
    return 31 - __builtin_clz((unsigned)mask);
}

/* What is still to be looked at: nodes and, at level 0, blocks. */
typedef struct stack {
    struct {
        size_t index;
        int level;
    } entries[SHAPE_REACH_LEVELS * WIDTH];
    int count;
} stack;

static void push(stack *waiting, size_t index, int level)
{
    waiting->entries[waiting->count].index = index;
    waiting->entries[waiting->count++].level = level;
}

/* The next block (level 0) or lowest node (level 1) that may hold what is looked for; false where there is none. */
static bool next_at(const shape_reach *tree, const shape_reach_query *query, int wanted, stack *waiting,
                    size_t *found)
{
    while (waiting->count) {
        size_t index = waiting->entries[--waiting->count].index;
        int level = waiting->entries[waiting->count].level;
        if (level == wanted) {
            *found = index;
            return true;
        }
        int mask = test_node(&tree->nodes[tree->start[level] + index], query);
        for (; mask; mask &= ~bit_of[highest(mask)])
            push(waiting, index * WIDTH + (size_t)highest(mask), level - 1);
    }
    return false;
}

static bool search_block(const shape_reach_block *block, const shape_reach_query *query,
                         shape_reach_visit *visit, void *context)
{
    for (int mask = test_block(block, query); mask; mask &= mask - 1)
        if (visit(block, lowest(mask), context))
            return true;
    return false;
}

bool shape_reach_find(const shape_reach *tree, const shape_reach_query *query, shape_reach_visit *visit,
                      void *context)
{
    stack waiting;
    size_t block;
    waiting.count = 0;
    if (!tree->count)
        return false;
    push(&waiting, 0, tree->top);
    while (next_at(tree, query, 0, &waiting, &block))
        if (search_block(&tree->blocks[block], query, visit, context))
            return true;
    return false;
}

bool shape_reach_gather(const shape_reach *tree, const shape_reach_query *query, size_t *nodes, size_t room,
                        size_t *count)
{
    stack waiting;
    size_t node;
    waiting.count = 0;
    *count = 0;
    if (!tree->count)
        return true;
    push(&waiting, 0, tree->top);
    while (next_at(tree, query, 1, &waiting, &node)) {
        if (*count == room)
            return false;
        nodes[(*count)++] = node;
    }
    return true;
}

bool shape_reach_find_among(const shape_reach *tree, const size_t *nodes, size_t count,
                            const shape_reach_query *query, shape_reach_visit *visit, void *context)
{
    for (size_t i = 0; i < count; i++) /* level 1 starts at 0 */
        for (int mask = test_node(&tree->nodes[nodes[i]], query); mask; mask &= mask - 1)
            if (search_block(&tree->blocks[nodes[i] * WIDTH + (size_t)lowest(mask)], query, visit, context))
                return true;
    return false;
}
