/* Private: a tree over primitives' centres that also knows how far the primitives below a node reach, for questions of
 * the kind "which primitives contain this?". What is found does not depend on the tree's shape. */
#ifndef SHAPE_PRIMITIVE_REACH_H
#define SHAPE_PRIMITIVE_REACH_H

#include "shape/set.h"

enum { SHAPE_REACH_WIDTH = 8 }; /* what a block and a node hold: as many as are looked at in one go */

/* Neighbouring primitives: centre, radius of the smallest ball about the centre that holds the primitive, and number
 * (spheres first, then ellipsoids). Unused places have the reach -1. */
typedef struct shape_reach_block {
    float position[3][SHAPE_REACH_WIDTH];
    float reach[SHAPE_REACH_WIDTH];
    int32_t number[SHAPE_REACH_WIDTH];
} shape_reach_block;

/* Of each child the box of the centres below it, their largest reach, and the lowest number among those that have it.
 * Unused places have the reach -1. */
typedef struct shape_reach_node {
    float min[3][SHAPE_REACH_WIDTH], max[3][SHAPE_REACH_WIDTH];
    float reach[SHAPE_REACH_WIDTH];
    int32_t first[SHAPE_REACH_WIDTH];
} shape_reach_node;

enum { SHAPE_REACH_LEVELS = 12 };

/* Node n of a level holds the children 8 n to 8 n + 7 of the level below; those of level 1 are blocks. */
typedef struct shape_reach {
    shape_reach_block *blocks;
    shape_reach_node *nodes;
    size_t count; /* primitives */
    size_t block_count;
    size_t start[SHAPE_REACH_LEVELS + 1]; /* where a level's nodes begin; start[1] = 0 */
    int top;                              /* the level with one node; 0 where there is nothing */
} shape_reach;

/* Builds the tree of a list; the caller frees it. Errors: memory, 2^31 primitives and more. */
shape_status shape_reach_build(shape_reach *tree, const shape_primitives *list, shape_error *error);
void shape_reach_free(shape_reach *tree);

/* Something whose centre lies in the box min..max, which holds a ball of radius `inner` about it, lies in what is looked
 * for. That reaches at least as far as `outer`; one that reaches just so far must have a number below `before`. */
typedef struct shape_reach_query {
    float min[3], max[3];
    float inner, outer;
    int32_t before;
} shape_reach_query;

/* Looks at the k-th primitive of a block; true ends the search. */
typedef bool shape_reach_visit(const shape_reach_block *block, int k, void *context);

/* For a query with min = max: offers all primitives that meet it, and a few that do not quite (by parts in a million;
 * or by the number), until visit returns true; returns whether it did. Safe from several threads at a time. */
bool shape_reach_find(const shape_reach *tree, const shape_reach_query *query, shape_reach_visit *visit,
                      void *context);

/* For many similar queries: the nodes of level 1 that a query over all of them may find something in. False where there
 * are more than `room`. Then each of the queries is put to these nodes alone, to the same effect. */
bool shape_reach_gather(const shape_reach *tree, const shape_reach_query *query, size_t *nodes, size_t room,
                        size_t *count);
bool shape_reach_find_among(const shape_reach *tree, const size_t *nodes, size_t count,
                            const shape_reach_query *query, shape_reach_visit *visit, void *context);

#endif
