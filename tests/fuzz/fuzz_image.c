/* Any bytes as a PNG, EXR or PFM: an image within its limits, or an error. */
#include <stdint.h>
#include <stdlib.h>

#include "shape/image.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    shape_image *image = NULL;
    shape_error error;
    if (!shape_image_decode(data, size, &image, &error)) {
        if (image->width < 1 || image->height < 1 || image->width > SHAPE_IMAGE_SIDE_MAX ||
            image->height > SHAPE_IMAGE_SIDE_MAX)
            abort();
        shape_image_destroy(image);
    }
    return 0;
}
