/* A bounding-box tree over the supports of a primitive list, in depth-first order with skip links, so that it is
 * walked without a stack, on the CPU and from a float texture alike. */
#ifndef SHAPE_TREE_H
#define SHAPE_TREE_H

#include "shape/set.h"

#ifdef __cplusplus
extern "C" {
#endif

/* 32 bytes, two texels. A walk starts at node 0: where the box is hit go on with the next node, else with node
 * `skip`; it ends at node `count`. content is 0 in an inner node, i + 1 in the leaf of sphere i, -(i + 1) in the leaf
 * of ellipsoid i. Both are whole numbers kept as floats (exact to 2^24), as a texture wants them. */
typedef struct shape_tree_node {
    shape_vec3 min;
    float skip;
    shape_vec3 max;
    float content;
} shape_tree_node;

typedef struct shape_tree {
    shape_tree_node *nodes;
    size_t count; /* 2 n - 1 for n primitives; 0 for none */
} shape_tree;

enum { SHAPE_TREE_MAX = 8000000 }; /* primitives: 2 n - 1 must stay exact in a float */

/* Builds the tree by binned surface-area splits (Wald 2007), each primitive grown by `support` about its centre.
 * The same list gives the same tree. The caller frees by shape_tree_free. */
shape_status shape_tree_build(const shape_primitives *list, float support, shape_tree *tree,
                              shape_error *error);
void shape_tree_free(shape_tree *tree);

#ifdef __cplusplus
}
#endif
#endif
