/* Private: the formats behind shape_image_encode and shape_image_decode, one a file. What they are given has been
 * checked by image.c; errors come without the name of a file. */
#ifndef SHAPE_FILE_IMAGE_PRIVATE_H
#define SHAPE_FILE_IMAGE_PRIVATE_H

#include "shape/image.h"

/* Deflate makes at most 1032 bytes of one (zlib's technical notes): what a header claims is held against that. */
enum { IMAGE_DEFLATE_MAX = 1032 };

shape_status image_png_encode(const shape_image *image, const shape_image_options *options,
                              unsigned char **bytes, size_t *size, shape_error *error);
shape_status image_exr_encode(const shape_image *image, const shape_image_options *options,
                              unsigned char **bytes, size_t *size, shape_error *error);
shape_status image_pfm_encode(const shape_image *image, unsigned char **bytes, size_t *size,
                              shape_error *error);

shape_status image_png_decode(const unsigned char *bytes, size_t size, shape_image **image,
                              shape_error *error);
shape_status image_exr_decode(const unsigned char *bytes, size_t size, shape_image **image,
                              shape_error *error);
shape_status image_pfm_decode(const unsigned char *bytes, size_t size, shape_image **image,
                              shape_error *error);

/* SHAPE_ERROR_LIMIT where a side is outside 1 to SHAPE_IMAGE_SIDE_MAX. */
shape_status image_size_check(double width, double height, shape_error *error);

/* A buffer that grows; shape_array_reserve takes its memory. */
typedef struct image_buffer {
    unsigned char *bytes;
    size_t capacity, size;
} image_buffer;

/* Writes at `offset`; a gap before it (EXR's table of chunks, written last) is filled with zeros.
 * SHAPE_ERROR_MEMORY where the buffer cannot grow. */
shape_status image_buffer_write(image_buffer *buffer, size_t offset, const void *bytes, size_t size);

#endif
