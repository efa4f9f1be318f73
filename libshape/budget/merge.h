/* Private: the order in which a heap of primitives is merged, from all of them down to one. */
#ifndef SHAPE_BUDGET_MERGE_H
#define SHAPE_BUDGET_MERGE_H

#include "budget/pair.h"

/* Node i < count is primitive i; node count + m is what merge m made of two earlier ones. */
typedef struct budget_node {
    budget_shape shape;
    uint32_t first;    /* the lowest primitive in it: its place in the order */
    uint32_t same;     /* the primitive that it equals, or UINT32_MAX */
    uint32_t consumed; /* the merge that it went into, or UINT32_MAX */
} budget_node;

typedef struct budget_merges {
    budget_node *nodes; /* 2 count - 1 */
    size_t count;
} budget_merges;

/* Merges always the pair that costs least, among neighbours. Errors: memory, limits. */
shape_status budget_merges_make(budget_merges *merges, const shape_primitives *list, shape_model model,
                                shape_error *error);
void budget_merges_free(budget_merges *merges);
/* What there is when `wanted` (1 to count) are left; *cut is empty before, and the caller frees its arrays. */
shape_status budget_merges_cut(const budget_merges *merges, const shape_primitives *list, size_t wanted,
                               shape_primitives *cut, shape_error *error);

#endif
