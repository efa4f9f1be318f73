/* Pictures: round trips, closed forms of sRGB and the tone curve, dithering, and hostile bytes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "shape/image.h"
#include "shape/neph.h"

#define assert_near(a, b, e) assert_true(fabs((double)(a) - (double)(b)) <= (e))

/* Odd sizes, so that the last chunk of an EXR is not whole (16 lines) and rows are not aligned. */
enum { W = 37, H = 21 };

static shape_image *make_image(void)
{
    shape_image *image = shape_image_create(W, H, NULL);
    assert_non_null(image);
    uint32_t seed = 7;
    for (int i = 0; i < W * H * 3; i++) {
        seed = seed * 1664525u + 1013904223u;
        image->pixels[i] = ldexpf((float)(seed >> 8) * 0x1p-24f, (int)(seed >> 4 & 15) - 8);
    }
    return image;
}

static void encode(const shape_image *image, shape_image_format format, const shape_image_options *options,
                   unsigned char **bytes, size_t *size)
{
    shape_error error = {0};
    if (shape_image_encode(image, format, options, bytes, size, &error))
        fail_msg("%s", error.text);
}

static shape_image *decode(const unsigned char *bytes, size_t size)
{
    shape_error error = {0};
    shape_image *image = NULL;
    if (shape_image_decode(bytes, size, &image, &error))
        fail_msg("%s", error.text);
    return image;
}

static void assert_same_bits(const float *a, const float *b, size_t count)
{
    assert_memory_equal(a, b, count * sizeof *a);
}

static void exr_keeps_every_bit(void **state)
{
    (void)state;
    shape_image *image = make_image();
    assert_int_equal(shape_image_add_alpha(image, NULL), SHAPE_OK);
    assert_int_equal(shape_image_add_layer(image, "variance", NULL), SHAPE_OK);
    assert_int_equal(shape_image_add_layer(image, "albedo", NULL), SHAPE_OK);
    for (int i = 0; i < W * H; i++)
        image->alpha[i] = (float)(i % 11) / 10;
    for (int i = 0; i < W * H * 3; i++) {
        shape_image_layer_pixels(image, "variance")[i] = (float)i / 3;
        shape_image_layer_pixels(image, "albedo")[i] = (float)(i * i % 97);
    }
    unsigned char *bytes, *again;
    size_t size, size_again;
    encode(image, SHAPE_IMAGE_EXR, NULL, &bytes, &size);
    encode(image, SHAPE_IMAGE_EXR, NULL, &again, &size_again);
    assert_int_equal(size, size_again);
    assert_memory_equal(bytes, again, size);
    shape_image *back = decode(bytes, size);
    assert_true(back->width == W && back->height == H && back->layer_count == 2);
    assert_same_bits(image->pixels, back->pixels, W * H * 3);
    assert_same_bits(image->alpha, back->alpha, W * H);
    const char *const layers[] = {"variance", "albedo"};
    for (int i = 0; i < 2; i++)
        assert_same_bits(shape_image_layer_pixels(image, layers[i]),
                         shape_image_layer_pixels(back, layers[i]), W * H * 3);
    free(bytes);
    free(again);
    shape_image_destroy(image);
    shape_image_destroy(back);
}

/* Noise behind a few equal values compresses to a little less or more than its own size, now and then (here in some of 150
 * pictures) to exactly that, of which a reader thinks that it was not compressed. */
static void exr_keeps_chunks_that_stay_as_large(void **state)
{
    (void)state;
    enum { WIDTH = 32, HEIGHT = 16, COUNT = WIDTH * HEIGHT * 3, TRIES = 50 };
    shape_image_options options = shape_image_options_defaults();
    shape_image *image = shape_image_create(WIDTH, HEIGHT, NULL);
    assert_non_null(image);
    for (int k = 0; k < 3 * TRIES; k++) {
        uint32_t seed = 1 + (uint32_t)(k % TRIES);
        for (int i = 0; i < COUNT; i++) {
            seed = seed * 1664525u + 1013904223u;
            uint32_t bits = i < 18 + k / TRIES ? 0x3f800000u : (seed ^ seed >> 15) & 0x7effffffu;
            memcpy(&image->pixels[i], &bits, sizeof bits);
        }
        unsigned char *bytes;
        size_t size;
        encode(image, SHAPE_IMAGE_EXR, &options, &bytes, &size);
        shape_image *back = decode(bytes, size);
        assert_same_bits(image->pixels, back->pixels, COUNT);
        shape_image_destroy(back);
        free(bytes);
    }
    shape_image_destroy(image);
}

static void pfm_keeps_every_bit(void **state)
{
    (void)state;
    shape_image *image = make_image();
    unsigned char *bytes;
    size_t size;
    encode(image, SHAPE_IMAGE_PFM, NULL, &bytes, &size);
    shape_image *back = decode(bytes, size);
    assert_true(back->width == W && back->height == H && !back->alpha && !back->layer_count);
    assert_same_bits(image->pixels, back->pixels, W * H * 3);
    free(bytes);
    shape_image_destroy(image);
    shape_image_destroy(back);
}

/* Written by hand from the format's description: rows from the bottom, both byte orders, grey, a scale. */
static void pfm_of_others_is_read(void **state)
{
    (void)state;
    static const unsigned char big[] =
        "PF\n1 2\n1.0\n\x3f\x80\0\0\x40\0\0\0\x40\x40\0\0\x40\x80\0\0\x40\xa0\0\0\x40\xc0\0\0";
    static const unsigned char grey[] = "Pf 2 1 -2.0\n\0\0\x80\x3f\0\0\0\x40";
    shape_image *image = decode(big, sizeof big - 1);
    const float expected[] = {4, 5, 6, 1, 2, 3};
    assert_true(image->width == 1 && image->height == 2);
    assert_same_bits(image->pixels, expected, 6);
    shape_image_destroy(image);
    image = decode(grey, sizeof grey - 1);
    const float doubled[] = {2, 2, 2, 4, 4, 4};
    assert_true(image->width == 2 && image->height == 1);
    assert_same_bits(image->pixels, doubled, 6);
    shape_image_destroy(image);
}

/* Without dithering a code is right to half a code, with it to one: the code before or after. */
static void png_is_right_to_half_a_code(void **state)
{
    (void)state;
    shape_image *image = make_image();
    shape_image_options options = shape_image_options_defaults();
    options.exposure = 1.5f;
    for (int dithered = 0; dithered <= 1; dithered++) {
        options.dither = dithered;
        unsigned char *bytes;
        size_t size;
        encode(image, SHAPE_IMAGE_PNG, &options, &bytes, &size);
        shape_image *back = decode(bytes, size);
        assert_true(back->width == W && back->height == H && !back->alpha);
        for (int i = 0; i < W * H * 3; i++) {
            double wanted = 255 * shape_image_srgb_encode(shape_image_tone(image->pixels[i] * powf(2, 1.5f)));
            double got = 255 * shape_image_srgb_encode(back->pixels[i]);
            assert_near(got, wanted, (dithered ? 1 : 0.5) + 1e-3); /* float's rounding of 255 */
        }
        free(bytes);
        shape_image_destroy(back);
    }
    shape_image_destroy(image);
}

/* All 256 codes come back as they went, through decoding to linear and dithered encoding. */
static void whole_codes_are_not_dithered(void **state)
{
    (void)state;
    shape_image *image = shape_image_create(256, 8, NULL);
    for (int i = 0; i < 256 * 8 * 3; i++)
        image->pixels[i] = shape_image_srgb_decode((float)(i / 3 % 256) / 255);
    shape_image_options options = shape_image_options_defaults();
    options.tone = false;
    unsigned char *bytes;
    size_t size;
    encode(image, SHAPE_IMAGE_PNG, &options, &bytes, &size);
    shape_image *back = decode(bytes, size);
    double moved = 0;
    for (int i = 0; i < 256 * 8 * 3; i++) {
        int from = i / 3 % 256, to = (int)lround(255 * shape_image_srgb_encode(back->pixels[i]));
        /* Rounding of the powers in single precision leaves a code a hair beside the whole number. */
        assert_in_range(to, from ? from - 1 : 0, from);
        moved += from != to;
        if (from == 0 || from == 255)
            assert_int_equal(to, from);
    }
    assert_true(moved / (256 * 8 * 3) < 1e-3);
    free(bytes);
    shape_image_destroy(image);
    shape_image_destroy(back);
}

/* The mean over a patch is the value asked for: 4096 draws of variance at most 1/4, five standard errors. */
static void dithering_keeps_the_mean(void **state)
{
    (void)state;
    enum { SIDE = 64 };
    for (int step = 0; step < 10; step++) {
        double wanted = 100 + step / 10.0;
        shape_image *image = shape_image_create(SIDE, SIDE, NULL);
        for (int i = 0; i < SIDE * SIDE * 3; i++)
            image->pixels[i] = shape_image_srgb_decode((float)(wanted / 255));
        unsigned char *bytes;
        size_t size;
        encode(image, SHAPE_IMAGE_PNG, NULL, &bytes, &size);
        shape_image *back = decode(bytes, size);
        double sum = 0;
        for (int i = 0; i < SIDE * SIDE; i++) {
            const float *rgb = back->pixels + 3 * i;
            assert_true(rgb[0] == rgb[1] && rgb[1] == rgb[2]); /* grey stays grey */
            sum += 255 * shape_image_srgb_encode(rgb[0]);
        }
        assert_near(sum / (SIDE * SIDE), wanted, 5 * 0.5 / SIDE);
        free(bytes);
        shape_image_destroy(image);
        shape_image_destroy(back);
    }
}

/* PNG's colours are not multiplied by alpha, ours are: half-covered white comes back as half. */
static void png_keeps_alpha(void **state)
{
    (void)state;
    shape_image *image = shape_image_create(4, 1, NULL);
    assert_int_equal(shape_image_add_alpha(image, NULL), SHAPE_OK);
    shape_image_options options = shape_image_options_defaults();
    options.tone = false;
    for (int x = 0; x < 4; x++) {
        image->alpha[x] = (float)x * 51 / 255;
        for (int c = 0; c < 3; c++)
            image->pixels[3 * x + c] = image->alpha[x];
    }
    unsigned char *bytes;
    size_t size;
    encode(image, SHAPE_IMAGE_PNG, &options, &bytes, &size);
    shape_image *back = decode(bytes, size);
    assert_non_null(back->alpha);
    for (int x = 0; x < 4; x++) {
        assert_near(back->alpha[x], image->alpha[x], 1e-6);
        /* One code of colour, near white 1/255 * 2.3 of radiance, where rounding took it below 255. */
        assert_near(back->pixels[3 * x], image->pixels[3 * x], 0.01);
    }
    free(bytes);
    shape_image_destroy(image);
    shape_image_destroy(back);
}

static void srgb_has_its_closed_forms(void **state)
{
    (void)state;
    assert_true(shape_image_srgb_encode(0) == 0 && shape_image_srgb_encode(1) == 1);
    assert_true(shape_image_srgb_encode(-1) == 0 && shape_image_srgb_encode(2) == 1);
    assert_true(shape_image_srgb_encode(NAN) == 0 && shape_image_srgb_decode(NAN) == 0);
    assert_near(shape_image_srgb_encode(0.002f), 0.02584, 1e-7);  /* 12.92 x, the straight part */
    assert_near(shape_image_srgb_encode(0.18f), 0.461356, 1e-6);  /* 1.055 * 0.18^(1/2.4) - 0.055 */
    assert_near(shape_image_srgb_decode(0.5f), 0.21404114, 1e-6); /* ((0.5 + 0.055) / 1.055)^2.4 */
    assert_near(shape_image_srgb_decode(0.04f), 0.04 / 12.92, 1e-8);
    for (int i = 0; i <= 4096; i++) {
        float x = (float)i / 4096;
        /* Four roundings to 24 bits, amplified by at most the slope of 12.92. */
        assert_near(shape_image_srgb_decode(shape_image_srgb_encode(x)), x, 1e-6);
    }
}

static void the_tone_curve_is_smooth(void **state)
{
    (void)state;
    const float h = 1e-3f;
    assert_true(shape_image_tone(-1) == 0 && shape_image_tone(NAN) == 0 && shape_image_tone(INFINITY) == 1);
    for (int i = 1; i < 20000; i++) {
        float x = (float)i * h, y = shape_image_tone(x), before = shape_image_tone(x - h),
              after = shape_image_tone(x + h);
        assert_true(y <= 1 && y >= before);
        if (x <= 0.6f)
            assert_true(y == x);
        else if (x < 4)
            assert_true(y > before && y < 1);
        /* C1: slopes on both sides differ by h times the second derivative, at most 1 / 0.4, and the rounding of two
         * differences. */
        assert_near((after - y) / h, (y - before) / h, h / 0.4f + 4 * 6e-8f / h);
    }
}

static void bad_values_are_refused(void **state)
{
    (void)state;
    const float bad[] = {NAN, INFINITY, -INFINITY, -1e-30f};
    for (int i = 0; i < 4; i++)
        for (int format = 0; format < 3; format++) {
            shape_image *image = make_image();
            shape_error error;
            unsigned char *bytes = NULL;
            size_t size = 0;
            image->pixels[(5 * W + 3) * 3 + 1] = image->pixels[(9 * W + 30) * 3] = bad[i];
            assert_int_equal(
                shape_image_encode(image, (shape_image_format)format, NULL, &bytes, &size, &error),
                SHAPE_ERROR_ARGUMENT);
            assert_non_null(strstr(error.text, "2 values"));
            assert_non_null(strstr(error.text, "the picture at x 3, y 5 (green)"));
            assert_null(bytes);
            shape_image_destroy(image);
        }
    shape_image *image = make_image();
    shape_error error;
    assert_int_equal(shape_image_check(image, &error), SHAPE_OK);
    assert_int_equal(shape_image_add_alpha(image, NULL), SHAPE_OK);
    image->alpha[W + 2] = 1.5f;
    assert_int_equal(shape_image_check(image, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "alpha at x 2, y 1"));
    image->alpha[W + 2] = 1;
    assert_int_equal(shape_image_add_layer(image, "variance", NULL), SHAPE_OK);
    shape_image_layer_pixels(image, "variance")[4] = -1;
    assert_int_equal(shape_image_check(image, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "variance at x 1, y 0 (green)"));
    shape_image_destroy(image);
}

static void arguments_are_checked(void **state)
{
    (void)state;
    shape_error error;
    assert_null(shape_image_create(0, 5, &error));
    assert_int_equal(error.status, SHAPE_ERROR_LIMIT);
    assert_null(shape_image_create(SHAPE_IMAGE_SIDE_MAX + 1, 5, &error));
    shape_image *image = make_image();
    unsigned char *bytes;
    size_t size;
    assert_int_equal(shape_image_add_layer(image, "a.b", &error), SHAPE_ERROR_ARGUMENT);
    assert_int_equal(shape_image_add_layer(image, "", &error), SHAPE_ERROR_ARGUMENT);
    for (int i = 0; i < SHAPE_IMAGE_LAYERS_MAX; i++) {
        char name[] = {'a', (char)('a' + i), 0};
        assert_int_equal(shape_image_add_layer(image, name, &error), SHAPE_OK);
        assert_int_equal(shape_image_add_layer(image, name, &error), SHAPE_ERROR_ARGUMENT);
    }
    assert_int_equal(shape_image_add_layer(image, "more", &error), SHAPE_ERROR_LIMIT);
    assert_int_equal(shape_image_encode(image, SHAPE_IMAGE_PNG, NULL, &bytes, &size, &error),
                     SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "only EXR holds layers"));
    shape_image_options options = shape_image_options_defaults();
    options.exposure = NAN;
    assert_int_equal(shape_image_encode(image, SHAPE_IMAGE_EXR, &options, &bytes, &size, &error),
                     SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "exposure"));
    options.exposure = 0;
    shape_image_text text = {"a key", "value"};
    options.texts = &text;
    options.text_count = 1;
    assert_int_equal(shape_image_options_check(&options, &error), SHAPE_ERROR_ARGUMENT);
    shape_image_destroy(image);
    image = make_image();
    assert_int_equal(shape_image_add_alpha(image, NULL), SHAPE_OK);
    assert_int_equal(shape_image_encode(image, SHAPE_IMAGE_PFM, NULL, &bytes, &size, &error),
                     SHAPE_ERROR_ARGUMENT);
    shape_image_destroy(image);
    shape_image_format format;
    assert_int_equal(shape_image_format_find("a/b.PNG", &format, &error), SHAPE_OK);
    assert_int_equal(format, SHAPE_IMAGE_PNG);
    assert_int_equal(shape_image_format_find("x.exr", &format, &error), SHAPE_OK);
    assert_int_equal(format, SHAPE_IMAGE_EXR);
    assert_int_equal(shape_image_format_find("x.pfm", &format, &error), SHAPE_OK);
    assert_int_equal(format, SHAPE_IMAGE_PFM);
    assert_int_equal(shape_image_format_find("x.jpg", &format, &error), SHAPE_ERROR_ARGUMENT);
    assert_int_equal(shape_image_format_find(".png", &format, &error), SHAPE_ERROR_ARGUMENT);
}

static bool contains(const unsigned char *bytes, size_t size, const void *part, size_t length)
{
    for (size_t i = 0; i + length <= size; i++)
        if (!memcmp(bytes + i, part, length))
            return true;
    return false;
}

static void texts_are_kept(void **state)
{
    (void)state;
    shape_image *image = make_image();
    shape_image_text texts[] = {{"scene", "{\"sun\": [35, 40]}"}, {"title", "M\xc3\xa9lange"}};
    shape_image_options options = shape_image_options_defaults();
    options.texts = texts;
    options.text_count = 2;
    unsigned char *bytes;
    size_t size;
    encode(image, SHAPE_IMAGE_PNG, &options, &bytes, &size);
    assert_true(contains(bytes, size, "tEXtscene\0{\"sun\": [35, 40]}", 27));
    assert_true(contains(bytes, size, "iTXttitle\0\0\0\0\0M\xc3\xa9lange", 22));
    shape_image_destroy(decode(bytes, size));
    free(bytes);
    encode(image, SHAPE_IMAGE_EXR, &options, &bytes, &size);
    assert_true(contains(bytes, size, "scene\0string\0\x11\0\0\0{\"sun\": [35, 40]}", 34));
    shape_image_destroy(decode(bytes, size));
    free(bytes);
    shape_image_destroy(image);
}

static void refuse(const unsigned char *bytes, size_t size, const char *what, size_t where)
{
    shape_error error = {0};
    shape_image *image = NULL;
    /* A copy of just that size, so that the sanitizer sees a read beyond it. */
    unsigned char *copy = malloc(size ? size : 1);
    assert_non_null(copy);
    memcpy(copy, bytes, size);
    if (!shape_image_decode(copy, size, &image, &error))
        fail_msg("%s of %zu bytes was read as an image", what, where);
    assert_true(error.text[0] && !image);
    free(copy);
}

static void every_truncation_is_an_error(void **state)
{
    (void)state;
    static const char *const names[] = {"PNG", "EXR", "PFM"};
    for (int format = 0; format < 3; format++) {
        shape_image *image = make_image();
        if (format == SHAPE_IMAGE_EXR)
            assert_int_equal(shape_image_add_layer(image, "variance", NULL), SHAPE_OK);
        unsigned char *bytes;
        size_t size;
        encode(image, (shape_image_format)format, NULL, &bytes, &size);
        for (size_t i = 0; i < size; i++)
            refuse(bytes, i, names[format], i);
        free(bytes);
        shape_image_destroy(image);
    }
}

/* Damage anywhere gives an error or some picture, never a crash: what the sanitizers watch. Every byte once. */
static void damage_does_no_harm(void **state)
{
    (void)state;
    for (int format = 0; format < 3; format++) {
        shape_image *image = make_image();
        unsigned char *bytes;
        size_t size, refused = 0;
        encode(image, (shape_image_format)format, NULL, &bytes, &size);
        for (size_t i = 0; i < size; i++) {
            unsigned char kept = bytes[i];
            shape_image *back = NULL;
            bytes[i] = (unsigned char)(kept ^ (1 + i * 37 % 255));
            refused += shape_image_decode(bytes, size, &back, NULL) != SHAPE_OK;
            if (back)
                assert_true(back->width >= 1 && back->width <= SHAPE_IMAGE_SIDE_MAX);
            shape_image_destroy(back);
            bytes[i] = kept;
        }
        assert_true(refused > 0);
        free(bytes);
        shape_image_destroy(image);
    }
}

static void put_big(unsigned char *to, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        to[i] = (unsigned char)(value >> (24 - 8 * i));
}

/* Sizes that a few bytes cannot stand for are refused before memory is taken: a whole picture of them would need
 * gigabytes, and the test would not be quick. */
static void hostile_sizes_are_refused(void **state)
{
    (void)state;
    shape_image *image = make_image();
    unsigned char *bytes;
    size_t size;
    const uint32_t sizes[] = {SHAPE_IMAGE_SIDE_MAX, SHAPE_IMAGE_SIDE_MAX + 1, 0x7fffffff, 0xffffffff, 0};
    encode(image, SHAPE_IMAGE_PNG, NULL, &bytes, &size);
    for (int i = 0; i < 5; i++) {
        put_big(bytes + 16, sizes[i]); /* IHDR: width, height, and its CRC after 13 bytes */
        put_big(bytes + 20, sizes[i]);
        put_big(bytes + 29, shape_crc32(bytes + 12, 17));
        refuse(bytes, size, "a PNG with a hostile size", size);
    }
    free(bytes);
    encode(image, SHAPE_IMAGE_EXR, NULL, &bytes, &size);
    size_t at = 0;
    while (memcmp(bytes + at, "dataWindow\0box2i\0\x10\0\0\0", 21))
        at++;
    for (int i = 0; i < 5; i++) {
        for (int side = 0; side < 2; side++)
            for (int byte = 0; byte < 4; byte++) /* max x and max y, little endian, the last pixel's place */
                bytes[at + 29 + 4 * side + byte] = (unsigned char)((sizes[i] - 1) >> 8 * byte);
        refuse(bytes, size, "an EXR with a hostile size", size);
    }
    free(bytes);
    static const char *const headers[] = {"PF\n16384 16384\n-1.0\n",
                                          "PF\n16385 1\n-1.0\n",
                                          "PF\n99999999999 1\n-1\n",
                                          "PF\n-1 1\n-1.0\n",
                                          "PF\n1 1\n0\n",
                                          "PF\n1 1\nnan\n",
                                          "PF\n0 0\n-1.0\n",
                                          "PF\n1 1\n-1.0\n123456789",
                                          "PFx1 1\n-1\n123456789012"};
    for (int i = 0; i < 9; i++)
        refuse((const unsigned char *)headers[i], strlen(headers[i]), headers[i], strlen(headers[i]));
    refuse((const unsigned char *)"GIF89a, and more", 16, "a GIF", 16);
    shape_image_destroy(image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exr_keeps_every_bit),
        cmocka_unit_test(exr_keeps_chunks_that_stay_as_large),
        cmocka_unit_test(pfm_keeps_every_bit),
        cmocka_unit_test(pfm_of_others_is_read),
        cmocka_unit_test(png_is_right_to_half_a_code),
        cmocka_unit_test(whole_codes_are_not_dithered),
        cmocka_unit_test(dithering_keeps_the_mean),
        cmocka_unit_test(png_keeps_alpha),
        cmocka_unit_test(srgb_has_its_closed_forms),
        cmocka_unit_test(the_tone_curve_is_smooth),
        cmocka_unit_test(bad_values_are_refused),
        cmocka_unit_test(arguments_are_checked),
        cmocka_unit_test(texts_are_kept),
        cmocka_unit_test(every_truncation_is_an_error),
        cmocka_unit_test(damage_does_no_harm),
        cmocka_unit_test(hostile_sizes_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
