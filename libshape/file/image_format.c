/* Pictures to bytes and back: which format it is, and its own file's function. */
#include "shape/image.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "image_private.h"

shape_status shape_image_format_find(const char *path, shape_image_format *format, shape_error *error)
{
    static const char *const suffixes[] = {".png", ".exr", ".pfm"};
    size_t length = strlen(path);
    for (int i = 0; i < 3 && length > 4; i++)
        if (!strcasecmp(path + length - 4, suffixes[i])) {
            *format = (shape_image_format)i;
            return SHAPE_OK;
        }
    return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                           "%s: not the name of an image (let it end in .png, .exr or .pfm)", path);
}

shape_status shape_image_encode(const shape_image *image, shape_image_format format,
                                const shape_image_options *options, unsigned char **bytes, size_t *size,
                                shape_error *error)
{
    shape_image_options defaults = shape_image_options_defaults();
    if (!options)
        options = &defaults;
    shape_status status = shape_image_options_check(options, error);
    if (!status)
        status = shape_image_check(image, error);
    if (status)
        return status;
    if (format != SHAPE_IMAGE_EXR && image->layer_count)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "layer %s: only EXR holds layers (write .exr)",
                               image->layers[0].name);
    if (format == SHAPE_IMAGE_PNG)
        return image_png_encode(image, options, bytes, size, error);
    if (format == SHAPE_IMAGE_EXR)
        return image_exr_encode(image, options, bytes, size, error);
    if (image->alpha)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "PFM holds no alpha (write .exr or .png)");
    return image_pfm_encode(image, bytes, size, error);
}

shape_status shape_image_decode(const void *bytes, size_t size, shape_image **image, shape_error *error)
{
    const unsigned char *start = bytes;
    if (size >= 8 && !memcmp(start, "\x89PNG\r\n\x1a\n", 8))
        return image_png_decode(start, size, image, error);
    if (size >= 4 && !memcmp(start, "\x76\x2f\x31\x01", 4))
        return image_exr_decode(start, size, image, error);
    if (size >= 3 && start[0] == 'P' && (start[1] == 'F' || start[1] == 'f'))
        return image_pfm_decode(start, size, image, error);
    return shape_error_set(error, SHAPE_ERROR_FORMAT, "not an image (PNG, EXR or PFM is read)");
}
