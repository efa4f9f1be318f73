/* Private: a list without its duplicates. */
#ifndef SHAPE_BUDGET_DISTINCT_H
#define SHAPE_BUDGET_DISTINCT_H

#include "shape/set.h"

/* Copies each primitive that equals no earlier one, in order. *copy is empty before; the caller frees its arrays. */
shape_status budget_distinct_copy(const shape_primitives *list, shape_primitives *copy, shape_error *error);

#endif
