/* Pictures in memory: their parts, the check before writing, the tone curve. sRGB: IEC 61966-2-1. */
#include "shape/image.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image_private.h"

shape_image_options shape_image_options_defaults(void)
{
    shape_image_options options = {
        .exposure = 0, .tone = true, .dither = true, .texts = NULL, .text_count = 0};
    return options;
}

/* One rule for keys and layer names: what PNG keywords and EXR names both take. */
static bool name_good(const char *name, size_t max)
{
    static const char digits[] = "0123456789-_";
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_";
    if (!name || !*name || strlen(name) > max || !strchr(letters, *name))
        return false;
    for (const char *c = name; *c; c++)
        if (!strchr(letters, *c) && !strchr(digits, *c))
            return false;
    return true;
}

shape_status shape_image_options_check(const shape_image_options *options, shape_error *error)
{
    if (!(options->exposure >= -32 && options->exposure <= 32))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "exposure %g: must be from -32 to 32 stops",
                               (double)options->exposure);
    if (options->text_count && !options->texts)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "texts: missing (%zu are announced by text_count)", options->text_count);
    for (size_t i = 0; i < options->text_count; i++) {
        const shape_image_text *text = &options->texts[i];
        if (!name_good(text->key, 31))
            return shape_error_set(
                error, SHAPE_ERROR_ARGUMENT,
                "text %zu: a key is 1 to 31 letters, digits, - and _, and begins with a letter", i);
        if (!text->value || strlen(text->value) > 65535)
            return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                                   "text %s: must have a value of at most 65535 bytes", text->key);
    }
    return SHAPE_OK;
}

shape_status image_size_check(double width, double height, shape_error *error)
{
    if (width >= 1 && height >= 1 && width <= SHAPE_IMAGE_SIDE_MAX && height <= SHAPE_IMAGE_SIDE_MAX)
        return SHAPE_OK;
    return shape_error_set(error, SHAPE_ERROR_LIMIT,
                           "an image of %.0fx%.0f pixels: each side must be from 1 to %d", width, height,
                           SHAPE_IMAGE_SIDE_MAX);
}

static float *create_plane(const shape_image *image, size_t channels)
{
    return calloc((size_t)image->width * (size_t)image->height, channels * sizeof(float));
}

shape_image *shape_image_create(int width, int height, shape_error *error)
{
    if (image_size_check(width, height, error))
        return NULL;
    shape_image *image = calloc(1, sizeof *image);
    if (image) {
        image->width = width;
        image->height = height;
        image->pixels = create_plane(image, 3);
    }
    if (!image || !image->pixels) {
        free(image);
        shape_error_set(error, SHAPE_ERROR_MEMORY,
                        "not enough memory for an image of %dx%d (make it smaller)", width, height);
        return NULL;
    }
    return image;
}

void shape_image_destroy(shape_image *image)
{
    if (!image)
        return;
    for (int i = 0; i < image->layer_count; i++)
        free(image->layers[i].pixels);
    free(image->alpha);
    free(image->pixels);
    free(image);
}

shape_status shape_image_add_alpha(shape_image *image, shape_error *error)
{
    if (image->alpha)
        return SHAPE_OK;
    image->alpha = create_plane(image, 1);
    if (!image->alpha)
        return shape_error_memory(error);
    size_t count = (size_t)image->width * (size_t)image->height;
    for (size_t i = 0; i < count; i++)
        image->alpha[i] = 1;
    return SHAPE_OK;
}

float *shape_image_layer_pixels(const shape_image *image, const char *name)
{
    for (int i = 0; i < image->layer_count; i++)
        if (!strcmp(image->layers[i].name, name))
            return image->layers[i].pixels;
    return NULL;
}

shape_status shape_image_add_layer(shape_image *image, const char *name, shape_error *error)
{
    if (!name_good(name, SHAPE_IMAGE_LAYER_NAME_MAX))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "a layer's name is 1 to %d letters, digits, - and _, and begins with a letter",
                               SHAPE_IMAGE_LAYER_NAME_MAX);
    if (shape_image_layer_pixels(image, name))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "layer %s: there is one already", name);
    if (image->layer_count == SHAPE_IMAGE_LAYERS_MAX)
        return shape_error_set(error, SHAPE_ERROR_LIMIT, "layer %s: an image holds at most %d", name,
                               SHAPE_IMAGE_LAYERS_MAX);
    shape_image_layer *layer = &image->layers[image->layer_count];
    layer->pixels = create_plane(image, 3);
    if (!layer->pixels)
        return shape_error_memory(error);
    memcpy(layer->name, name, strlen(name) + 1);
    image->layer_count++;
    return SHAPE_OK;
}

/* What is wrong so far: how many values, and the first of them. */
typedef struct bad_values {
    size_t count, index;
    int channels;
    float value;
    const char *plane;
} bad_values;

static void look_at_plane(const shape_image *image, const float *values, int channels, float max,
                          const char *plane, bad_values *bad)
{
    size_t count = (size_t)image->width * (size_t)image->height * (size_t)channels;
    for (size_t i = 0; i < count; i++) {
        if (values[i] >= 0 && values[i] <= max)
            continue;
        if (!bad->count++) {
            bad->index = i;
            bad->channels = channels;
            bad->value = values[i];
            bad->plane = plane;
        }
    }
}

shape_status shape_image_check(const shape_image *image, shape_error *error)
{
    static const float largest = 3.40282347e38f; /* FLT_MAX: all but infinity */
    bad_values bad = {0};
    look_at_plane(image, image->pixels, 3, largest, "the picture", &bad);
    if (image->alpha)
        look_at_plane(image, image->alpha, 1, 1, "alpha", &bad);
    for (int i = 0; i < image->layer_count; i++)
        look_at_plane(image, image->layers[i].pixels, 3, largest, image->layers[i].name, &bad);
    if (!bad.count)
        return SHAPE_OK;
    size_t pixel = bad.index / (size_t)bad.channels;
    static const char *const names[] = {"red", "green", "blue"};
    const char *channel = bad.channels == 3 ? names[bad.index % 3] : "alpha";
    return shape_error_set(
        error, SHAPE_ERROR_ARGUMENT,
        "%zu values cannot be written; the first is %g in %s at x %zu, y %zu (%s) (values must be "
        "finite and not negative, alpha at most 1; look for the term that makes them)",
        bad.count, (double)bad.value, bad.plane, pixel % (size_t)image->width, pixel / (size_t)image->width,
        channel);
}

shape_status image_buffer_write(image_buffer *buffer, size_t offset, const void *bytes, size_t size)
{
    if (offset > PTRDIFF_MAX || size > PTRDIFF_MAX - offset)
        return SHAPE_ERROR_MEMORY;
    if (shape_array_reserve((void **)&buffer->bytes, &buffer->capacity, offset + size, 1, NULL))
        return SHAPE_ERROR_MEMORY;
    if (offset > buffer->size)
        memset(buffer->bytes + buffer->size, 0, offset - buffer->size);
    memcpy(buffer->bytes + offset, bytes, size);
    if (offset + size > buffer->size)
        buffer->size = offset + size;
    return SHAPE_OK;
}

float shape_image_tone(float x)
{
    const float start = 0.6f, rest = 0.4f;
    if (!(x > 0))
        return 0;
    if (x <= start)
        return x;
    return start + rest * (1 - expf(-(x - start) / rest));
}

float shape_image_srgb_encode(float linear)
{
    if (!(linear > 0))
        return 0;
    if (linear >= 1)
        return 1;
    return linear <= 0.0031308f ? 12.92f * linear : 1.055f * powf(linear, 1 / 2.4f) - 0.055f;
}

float shape_image_srgb_decode(float encoded)
{
    if (!(encoded > 0))
        return 0;
    if (encoded >= 1)
        return 1;
    return encoded <= 0.04045f ? encoded / 12.92f : powf((encoded + 0.055f) / 1.055f, 2.4f);
}
