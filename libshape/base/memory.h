/* Private: arrays that grow, with the overflow of their sizes looked after. */
#ifndef SHAPE_BASE_MEMORY_H
#define SHAPE_BASE_MEMORY_H

#include <stddef.h>

#include "shape/status.h"

/* Makes room for `needed` elements of `size` bytes in *array, which has room for *capacity; grows by half so that
 * appending is linear. *array stays valid, and unchanged, when memory runs out. */
shape_status shape_array_reserve(void **array, size_t *capacity, size_t needed, size_t size,
                                 shape_error *error);

#endif
