/* Pictures as other programs write them, made here byte by byte or by libpng itself: half floats, data windows away
 * from the origin, grey, deep, palette and interlaced PNG. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <png.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "shape/image.h"

#define assert_near(a, b, e) assert_true(fabs((double)(a) - (double)(b)) <= (e))

typedef struct bytes {
    unsigned char data[4096];
    size_t size;
} bytes;

static void put(bytes *to, const void *from, size_t size)
{
    assert_true(to->size + size <= sizeof to->data);
    memcpy(to->data + to->size, from, size);
    to->size += size;
}

static void put_int(bytes *to, uint64_t value, int size)
{
    for (int i = 0; i < size; i++) {
        unsigned char byte = (unsigned char)(value >> 8 * i);
        put(to, &byte, 1);
    }
}

static void put_float(bytes *to, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, 4);
    put_int(to, bits, 4);
}

static void put_attribute(bytes *to, const char *name, const char *type, int size)
{
    put(to, name, strlen(name) + 1);
    put(to, type, strlen(type) + 1);
    put_int(to, (uint64_t)size, 4);
}

/* A channel of the list: 1 half, 2 float. */
static void put_channel(bytes *to, const char *name, int type)
{
    put(to, name, strlen(name) + 1);
    put_int(to, (uint64_t)type, 4);
    put_int(to, 0, 4);
    put_int(to, 1, 4);
    put_int(to, 1, 4);
}

static void put_window(bytes *to, const char *name, int x, int y, int width, int height)
{
    put_attribute(to, name, "box2i", 16);
    put_int(to, (uint32_t)x, 4);
    put_int(to, (uint32_t)y, 4);
    put_int(to, (uint32_t)(x + width - 1), 4);
    put_int(to, (uint32_t)(y + height - 1), 4);
}

/* The header of an uncompressed scan-line EXR up to its channels, which end with a zero byte. */
static void put_exr_start(bytes *to, int channels_size)
{
    put_int(to, 20000630, 4);
    put_int(to, 2, 4);
    put_attribute(to, "channels", "chlist", channels_size);
}

/* The rest of the header, and the table of `height` chunks of `row` bytes each. */
static void put_exr_end(bytes *to, int x, int y, int width, int height, int row)
{
    put_attribute(to, "compression", "compression", 1);
    put_int(to, 0, 1);
    put_window(to, "dataWindow", x, y, width, height);
    put_window(to, "displayWindow", 0, 0, 640, 480);
    put_attribute(to, "lineOrder", "lineOrder", 1);
    put_int(to, 0, 1);
    put_attribute(to, "pixelAspectRatio", "float", 4);
    put_float(to, 1);
    put_attribute(to, "screenWindowCenter", "v2f", 8);
    put_float(to, 0);
    put_float(to, 0);
    put_attribute(to, "screenWindowWidth", "float", 4);
    put_float(to, 1);
    put_int(to, 0, 1);
    size_t first = to->size + 8 * (size_t)height;
    for (int i = 0; i < height; i++)
        put_int(to, first + (size_t)(i * (8 + row)), 8);
}

static shape_image *decode(const void *data, size_t size)
{
    shape_error error = {0};
    shape_image *image = NULL;
    if (shape_image_decode(data, size, &image, &error))
        fail_msg("%s", error.text);
    return image;
}

/* Half floats by their bits: 0x3c00 is 1, 0x3800 is 1/2, 0x4200 is 3, 0x0001 is 2^-24. B is a float; Z is let be. */
static void exr_with_halves_is_read(void **state)
{
    (void)state;
    bytes file = {.size = 0};
    put_exr_start(&file, 4 * 18 + 1);
    put_channel(&file, "B", 2);
    put_channel(&file, "G", 1);
    put_channel(&file, "R", 1);
    put_channel(&file, "Z", 2);
    put_int(&file, 0, 1);
    const int x = -5, y = 300, width = 2, height = 2, row = width * (4 + 2 + 2 + 4);
    put_exr_end(&file, x, y, width, height, row);
    for (int i = 0; i < height; i++) {
        put_int(&file, (uint32_t)(y + i), 4);
        put_int(&file, (uint32_t)row, 4);
        put_float(&file, 0.125f + (float)i);
        put_float(&file, 0.25f + (float)i);
        put_int(&file, 0x3c00, 2);
        put_int(&file, 0x3800, 2);
        put_int(&file, 0x4200, 2);
        put_int(&file, 0x0001, 2);
        put_float(&file, 10);
        put_float(&file, 20);
    }
    shape_image *image = decode(file.data, file.size);
    const float expected[] = {3, 1, 0.125f, 0x1p-24f, 0.5f, 0.25f, 3, 1, 1.125f, 0x1p-24f, 0.5f, 1.25f};
    assert_true(image->width == 2 && image->height == 2 && !image->alpha && !image->layer_count);
    assert_memory_equal(image->pixels, expected, sizeof expected);
    shape_image_destroy(image);
}

static void grey_exr_is_read_and_depth_alone_is_not(void **state)
{
    (void)state;
    for (const char *name = "YZ"; *name; name++) {
        const char channel[] = {*name, 0};
        bytes file = {.size = 0};
        put_exr_start(&file, 18 + 1);
        put_channel(&file, channel, 2);
        put_int(&file, 0, 1);
        put_exr_end(&file, 0, 0, 1, 1, 4);
        put_int(&file, 0, 4);
        put_int(&file, 4, 4);
        put_float(&file, 7);
        if (*name == 'Y') {
            shape_image *image = decode(file.data, file.size);
            assert_true(image->pixels[0] == 7 && image->pixels[1] == 7 && image->pixels[2] == 7);
            shape_image_destroy(image);
        } else {
            shape_error error;
            shape_image *image = NULL;
            assert_int_equal(shape_image_decode(file.data, file.size, &image, &error), SHAPE_ERROR_FORMAT);
            assert_non_null(strstr(error.text, "no channels R, G and B"));
        }
    }
}

static void write_png(png_structp png, png_bytep from, size_t size)
{
    put(png_get_io_ptr(png), from, size);
}
static void flush_png(png_structp png)
{
    (void)png;
}

/* What libpng writes of given rows. */
static void make_png(bytes *file, int side, int depth, int type, bool interlaced, unsigned char **rows)
{
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    if (setjmp(png_jmpbuf(png)))
        fail_msg("libpng cannot write the picture of the test");
    png_set_write_fn(png, file, write_png, flush_png);
    png_set_IHDR(png, info, (png_uint_32)side, (png_uint_32)side, depth, type,
                 interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    if (type == PNG_COLOR_TYPE_PALETTE) {
        png_color palette[2] = {{255, 0, 0}, {0, 0, 255}};
        png_byte clear[1] = {51};
        png_set_PLTE(png, info, palette, 2);
        png_set_tRNS(png, info, clear, 1, NULL);
    }
    png_write_info(png, info);
    png_write_image(png, rows);
    png_write_end(png, NULL);
    png_destroy_write_struct(&png, &info);
}

enum { SIDE = 9 };

/* 16 bits of RGB, interlaced: the code by the closed form of sRGB, to float's rounding. */
static void deep_interlaced_png_is_read(void **state)
{
    (void)state;
    unsigned char raw[SIDE][SIDE * 6], *rows[SIDE];
    for (int y = 0; y < SIDE; y++) {
        rows[y] = raw[y];
        for (int i = 0; i < SIDE * 6; i++)
            raw[y][i] = (unsigned char)(y * 83 + i * 57);
    }
    bytes file = {.size = 0};
    make_png(&file, SIDE, 16, PNG_COLOR_TYPE_RGB, true, rows);
    shape_image *image = decode(file.data, file.size);
    assert_true(image->width == SIDE && image->height == SIDE && !image->alpha);
    for (int i = 0; i < SIDE * SIDE * 3; i++) {
        const unsigned char *at = &raw[i / (SIDE * 3)][i % (SIDE * 3) * 2];
        double v = (at[0] * 256 + at[1]) / 65535.0;
        assert_near(image->pixels[i], v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4), 1e-6);
    }
    shape_image_destroy(image);
}

/* One bit a pixel: red with alpha 51/255 and opaque blue. */
static void palette_png_is_read(void **state)
{
    (void)state;
    unsigned char raw[SIDE][2], *rows[SIDE];
    for (int y = 0; y < SIDE; y++) {
        rows[y] = raw[y];
        raw[y][0] = 0x55;
        raw[y][1] = 0;
    }
    bytes file = {.size = 0};
    make_png(&file, SIDE, 1, PNG_COLOR_TYPE_PALETTE, false, rows);
    shape_image *image = decode(file.data, file.size);
    assert_non_null(image->alpha);
    for (int i = 0; i < SIDE * SIDE; i++) {
        bool blue = i % SIDE % 2 == 1;
        const float expected[3] = {blue ? 0 : 0.2f, 0, blue ? 1 : 0};
        for (int c = 0; c < 3; c++)
            assert_near(image->pixels[3 * i + c], expected[c], 1e-6);
        assert_near(image->alpha[i], blue ? 1 : 0.2, 1e-6);
    }
    shape_image_destroy(image);
}

/* 8 bits of grey, at the two ends and in the middle. */
static void grey_png_is_read(void **state)
{
    (void)state;
    unsigned char raw[SIDE][SIDE], *rows[SIDE];
    for (int y = 0; y < SIDE; y++) {
        rows[y] = raw[y];
        memset(raw[y], y == 0 ? 0 : y == 1 ? 255 : 188, SIDE);
    }
    bytes file = {.size = 0};
    make_png(&file, SIDE, 8, PNG_COLOR_TYPE_GRAY, false, rows);
    shape_image *image = decode(file.data, file.size);
    for (int c = 0; c < 3; c++) {
        assert_true(image->pixels[c] == 0 && image->pixels[SIDE * 3 + c] == 1);
        assert_near(image->pixels[2 * SIDE * 3 + c], 0.502886, 1e-6); /* ((188/255 + 0.055) / 1.055)^2.4 */
    }
    shape_image_destroy(image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exr_with_halves_is_read),
        cmocka_unit_test(grey_exr_is_read_and_depth_alone_is_not),
        cmocka_unit_test(deep_interlaced_png_is_read),
        cmocka_unit_test(palette_png_is_read),
        cmocka_unit_test(grey_png_is_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
