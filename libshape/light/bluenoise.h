/* Private: a tile of blue noise. */
#ifndef SHAPE_LIGHT_BLUENOISE_H
#define SHAPE_LIGHT_BLUENOISE_H

#include "shape/status.h"

#include <stdint.h>

enum { BLUENOISE_SIZE = 64, BLUENOISE_COUNT = BLUENOISE_SIZE * BLUENOISE_SIZE };

/* Fills rank with the numbers 0 to 4095, each once: whatever the threshold, the places below it lie evenly, without
 * lumps. The tile repeats without a seam. By void and cluster (Ulichney 1993), some hundredths of a second. Error:
 * memory. */
shape_status bluenoise_make(uint64_t seed, uint16_t rank[BLUENOISE_COUNT], shape_error *error);

#endif
