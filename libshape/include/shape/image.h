/* Pictures: linear radiance in memory, and PNG, EXR and PFM as bytes in memory. Part of the target shape_io; the
 * structs alone may be used without it. No function keeps state: different images may be used by different threads
 * at once. */
#ifndef SHAPE_IMAGE_H
#define SHAPE_IMAGE_H

#include <stdbool.h>
#include <stddef.h>

#include "shape/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Limits, checked before memory is taken: the longest side [pixels], named layers of one image, a layer's name [bytes
 * without the zero]. An image takes 12 bytes a pixel, 4 more with alpha, 12 more a layer; decoding a PNG takes up to 8
 * more for a while. */
enum { SHAPE_IMAGE_SIDE_MAX = 16384, SHAPE_IMAGE_LAYERS_MAX = 8, SHAPE_IMAGE_LAYER_NAME_MAX = 24 };

/* RGB values beside the picture, "variance" for instance: EXR channels variance.R, variance.G, variance.B. */
typedef struct shape_image_layer {
    char name[SHAPE_IMAGE_LAYER_NAME_MAX + 1]; /* letters, digits, - and _ */
    float *pixels; /* width * height * 3, ordered like the picture's; owned by the image */
} shape_image_layer;

typedef struct shape_image {
    int width, height; /* pixels, 1 to SHAPE_IMAGE_SIDE_MAX */
    float *pixels; /* height rows from the top, each width RGB triples: linear radiance, Rec. 709 primaries,
                          multiplied by alpha where there is one; owned */
    float *alpha;  /* width * height, 0 (clear) to 1 (opaque), or NULL; owned */
    shape_image_layer layers[SHAPE_IMAGE_LAYERS_MAX];
    int layer_count;
} shape_image;

typedef enum shape_image_format {
    SHAPE_IMAGE_PNG, /* tone-mapped, sRGB, 8 bits; holds no layers */
    SHAPE_IMAGE_EXR, /* radiance as it is, 32-bit float, ZIP; holds everything */
    SHAPE_IMAGE_PFM  /* radiance as it is; holds neither alpha nor layers */
} shape_image_format;

/* A text kept in the file: a PNG text chunk, an EXR string attribute; PFM has no room for it. */
typedef struct shape_image_text {
    const char *key;   /* 1 to 31 letters, digits, - and _, no digit first */
    const char *value; /* UTF-8, at most 65535 bytes */
} shape_image_text;

/* How an image is written. Only texts and text_count touch EXR, none touches PFM. */
typedef struct shape_image_options {
    float exposure; /* stops: radiance is multiplied by 2^exposure first; -32 to 32, default 0 */
    bool tone;      /* shape_image_tone is applied, default true; without it values above 1 are cut to 1 */
    bool
        dither; /* the rounding to 8 bits is dithered by half a code value, by a fixed hash of the pixel's place, so
                       that smooth skies show no bands; default true. Whole codes stay as they are: 0 stays 0 */
    const shape_image_text *texts; /* default NULL; the caller's */
    size_t text_count;
} shape_image_options;

shape_image_options shape_image_options_defaults(void);
/* Checks every member; the error names it. */
shape_status shape_image_options_check(const shape_image_options *options, shape_error *error);

/* A black image without alpha or layers; the caller destroys it. NULL and *error: a side outside 1 to
 * SHAPE_IMAGE_SIDE_MAX, or no memory. */
shape_image *shape_image_create(int width, int height, shape_error *error);
void shape_image_destroy(shape_image *image); /* NULL is allowed */
/* Gives the image an alpha of 1 everywhere; nothing where it has one already. */
shape_status shape_image_add_alpha(shape_image *image, shape_error *error);
/* Adds a layer of zeros. Its pixels are shape_image_layer_pixels(image, name). Errors: a name that is taken or has
 * other characters, too many layers, memory. */
shape_status shape_image_add_layer(shape_image *image, const char *name, shape_error *error);
/* A layer's pixels, or NULL where there is none of that name. */
float *shape_image_layer_pixels(const shape_image *image, const char *name);

/* Whether the image may be written: SHAPE_ERROR_ARGUMENT where a value is NaN, infinite or negative, or an alpha is
 * above 1; the text says how many there are and where the first is. */
shape_status shape_image_check(const shape_image *image, shape_error *error);

/* The format that a file name's suffix stands for: .png, .exr, .pfm, in any case. Error: another suffix or none. */
shape_status shape_image_format_find(const char *path, shape_image_format *format, shape_error *error);

/* The image as the bytes of a file; equal images and options give equal bytes. The caller frees *bytes with free().
 * options may be NULL: the defaults. Errors: shape_image_check's and shape_image_options_check's, a layer in PNG or
 * PFM, alpha in PFM, memory; on an error *bytes and *size are untouched. */
shape_status shape_image_encode(const shape_image *image, shape_image_format format,
                                const shape_image_options *options, unsigned char **bytes, size_t *size,
                                shape_error *error);

/* Reads untrusted bytes; the format shows in them. *image is the caller's to destroy, and untouched on an error. A
 * side above SHAPE_IMAGE_SIDE_MAX and a size that so few bytes cannot hold are refused before memory is taken.
 * - PNG, 1 to 16 bits, grey, RGB or palette, interlaced or not: taken as sRGB (colour profiles are not looked at) and
 *   decoded to linear; alpha is multiplied in. Nothing undoes the exposure and tone curve.
 * - EXR: the first part, scan lines, uncompressed, RLE, ZIPS or ZIP; channels R, G, B or Y of half or float, A; layers
 *   are what has channels name.R, name.G and name.B. Others are skipped.
 * - PFM, colour or grey, of either byte order; values are multiplied by the size of its scale.
 * Radiance is taken as it stands in EXR and PFM, NaN too: shape_image_check tells. */
shape_status shape_image_decode(const void *bytes, size_t size, shape_image **image, shape_error *error);

/* The tone curve of one channel: x up to 0.6, above it 0.6 + 0.4 (1 - exp(-(x - 0.6) / 0.4)), which goes on with the
 * same slope and nears 1. 0 for a negative number, 1 for infinity. The shaders have the same. */
float shape_image_tone(float x);
/* IEC 61966-2-1: linear 0 to 1 to sRGB 0 to 1 and back; outside, cut to 0 to 1. */
float shape_image_srgb_encode(float linear);
float shape_image_srgb_decode(float encoded);

#ifdef __cplusplus
}
#endif
#endif
