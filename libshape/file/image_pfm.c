/* Portable float maps (Debevec): "PF" or "Pf", width, height, scale, one blank, then rows from the bottom. A negative
 * scale says little endian. */
#include "image_private.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void put_float(unsigned char *to, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, 4);
    for (int i = 0; i < 4; i++)
        to[i] = (unsigned char)(bits >> 8 * i);
}

static float get_float(const unsigned char *from, bool little)
{
    uint32_t bits = 0;
    for (int i = 0; i < 4; i++)
        bits |= (uint32_t)from[little ? i : 3 - i] << 8 * i;
    float value;
    memcpy(&value, &bits, 4);
    return value;
}

shape_status image_pfm_encode(const shape_image *image, unsigned char **bytes, size_t *size,
                              shape_error *error)
{
    char header[64];
    size_t start = (size_t)snprintf(header, sizeof header, "PF\n%d %d\n-1.0\n", image->width, image->height);
    size_t row = (size_t)image->width * 3, height = (size_t)image->height;
    unsigned char *whole = malloc(start + row * height * 4);
    if (!whole)
        return shape_error_memory(error);
    memcpy(whole, header, start);
    for (size_t y = 0; y < height; y++)
        for (size_t i = 0; i < row; i++)
            put_float(whole + start + ((height - 1 - y) * row + i) * 4, image->pixels[y * row + i]);
    *bytes = whole;
    *size = start + row * height * 4;
    return SHAPE_OK;
}

static bool is_blank(unsigned char c)
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

/* The next word of the header, cut at 31 characters, without the one blank behind it; empty where the bytes end. */
static void next_word(const unsigned char *bytes, size_t size, size_t *at, char word[32])
{
    size_t length = 0;
    while (*at < size && is_blank(bytes[*at]))
        ++*at;
    for (; *at < size && !is_blank(bytes[*at]); ++*at)
        if (length < 31)
            word[length++] = (char)bytes[*at];
    word[*at < size ? length : 0] = 0;
}

/* A whole number of at most six digits, or 0. */
static int word_number(const char *word)
{
    size_t length = strlen(word);
    return length <= 6 && strspn(word, "0123456789") == length ? (int)strtol(word, NULL, 10) : 0;
}

/* A number from 1e-30 to 1e30 in size, or 0. */
static double word_scale(const char *word)
{
    char *end;
    double scale = strtod(word, &end);
    bool good = end != word && !*end && word[strspn(word, "0123456789+-.eE")] == 0;
    return good && fabs(scale) < 1e30 && fabs(scale) > 1e-30 ? scale : 0;
}

shape_status image_pfm_decode(const unsigned char *bytes, size_t size, shape_image **image,
                              shape_error *error)
{
    size_t at = 2, channels = bytes[1] == 'F' ? 3 : 1;
    char word[32];
    next_word(bytes, size, &at, word);
    int width = word_number(word);
    next_word(bytes, size, &at, word);
    int height = word_number(word);
    next_word(bytes, size, &at, word);
    double scale = word_scale(word);
    if (!is_blank(bytes[2]) || !width || !height || scale == 0)
        return shape_error_set(
            error, SHAPE_ERROR_FORMAT,
            "not a PFM header (it is \"PF\", width, height, a scale of 1e-30 to 1e30 or the same below 0)");
    shape_status status = image_size_check(width, height, error);
    if (status)
        return status;
    size_t row = (size_t)width * channels, needed = row * (size_t)height * 4;
    at++;
    if (size - at != needed)
        return shape_error_set(error, SHAPE_ERROR_FORMAT,
                               "the PFM has %zu bytes of pixels and needs %zu (copy the file again)",
                               size - at, needed);
    shape_image *made = shape_image_create(width, height, error);
    if (!made)
        return SHAPE_ERROR_MEMORY;
    float factor = (float)fabs(scale);
    for (size_t y = 0; y < (size_t)height; y++) {
        const unsigned char *from = bytes + at + ((size_t)height - 1 - y) * row * 4;
        float *to = made->pixels + y * (size_t)width * 3;
        for (size_t i = 0; i < (size_t)width * 3; i++)
            to[i] = factor * get_float(from + (channels == 3 ? i : i / 3) * 4, scale < 0);
    }
    *image = made;
    return SHAPE_OK;
}
