/* Private: arrays that grow, with the overflow of their sizes looked after. */
#ifndef SHAPE_BASE_MEMORY_H
#define SHAPE_BASE_MEMORY_H

#include <stddef.h>

#include "shape/status.h"

/* Does what shape_array_reserve says where there is no room yet. */
shape_status shape_array_grow(void **array, size_t *capacity, size_t needed, size_t size, shape_error *error);

/* Makes room for `needed` elements of `size` bytes in *array, which has room for *capacity; grows by half so that
 * appending is linear. *array stays valid, and unchanged, when memory runs out. */
static inline shape_status shape_array_reserve(void **array, size_t *capacity, size_t needed, size_t size,
                                               shape_error *error)
{
    return needed <= *capacity ? SHAPE_OK : shape_array_grow(array, capacity, needed, size, error);
}

#endif
