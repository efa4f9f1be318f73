/* Growing arrays. */
#include "base/memory.h"

#include <stdint.h>
#include <stdlib.h>

shape_status shape_array_grow(void **array, size_t *capacity, size_t needed, size_t size, shape_error *error)
{
    size_t wanted = *capacity + *capacity / 2;
    if (wanted < needed)
        wanted = needed;
    if (wanted < 16)
        wanted = 16;
    if (wanted > PTRDIFF_MAX / size)
        return shape_error_memory(error);
    void *grown = realloc(*array, wanted * size);
    if (!grown)
        return shape_error_memory(error);
    *array = grown;
    *capacity = wanted;
    return SHAPE_OK;
}
