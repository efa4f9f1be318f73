/* PNG through libpng: 8-bit sRGB out (tone curve and dithering are here), anything in. libpng reports by longjmp; each
 * guarded piece of work keeps what it took in a struct that outlives the jump. */
#include "image_private.h"

#include <math.h>
#include <png.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef struct png_job {
    png_structp png;
    png_infop info;
    char text[160]; /* libpng's own word on what failed */
    /* writing */
    const shape_image *source;
    const shape_image_options *options;
    image_buffer out;
    unsigned char *row;
    /* reading */
    const unsigned char *bytes;
    size_t size, at;
    unsigned char *raw;
    unsigned char **rows;
    shape_image *made;
    bool memory_out;
} png_job;

static void on_error(png_structp png, png_const_charp text)
{
    png_job *job = png_get_error_ptr(png);
    strncpy(job->text, text, sizeof job->text - 1);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp text)
{
    (void)png;
    (void)text; /* a damaged side chunk does not spoil the picture */
}

/* Runs work; false where libpng jumped out of it. */
static bool guarded(png_job *job, void (*work)(png_job *job))
{
    if (setjmp(png_jmpbuf(job->png)))
        return false;
    work(job);
    return true;
}

/* --- writing --- */

static void write_bytes(png_structp png, png_bytep bytes, size_t size)
{
    png_job *job = png_get_io_ptr(png);
    if (image_buffer_write(&job->out, job->out.size, bytes, size))
        png_error(png, "not enough memory");
}

static void flush_nothing(png_structp png)
{
    (void)png;
}

/* A fixed number in [0, 1) for a pixel: integer mixing by Wellons' "lowbias32" (2018). The same for all channels, so
 * that grey stays grey. */
static float dither_at(uint32_t x, uint32_t y)
{
    uint32_t h = x + y * (uint32_t)SHAPE_IMAGE_SIDE_MAX;
    h = (h ^ h >> 16) * 0x7feb352du;
    h = (h ^ h >> 15) * 0x846ca68bu;
    h ^= h >> 16;
    return (float)(h >> 8) * 0x1p-24f;
}

/* floor(255 v + t) is exact for whole codes whatever t in [0, 1) is, and right on average where t is spread evenly. */
static unsigned char code(float v, float t)
{
    float scaled = 255 * v + t;
    return scaled >= 255 ? 255 : (unsigned char)scaled;
}

static void fill_row(const png_job *job, int y)
{
    const shape_image *image = job->source;
    size_t start = (size_t)y * (size_t)image->width;
    float gain = exp2f(job->options->exposure);
    unsigned char *to = job->row;
    for (int x = 0; x < image->width; x++) {
        const float *rgb = image->pixels + (start + (size_t)x) * 3;
        float alpha = image->alpha ? image->alpha[start + (size_t)x] : 1;
        float factor = alpha > 0 ? gain / alpha : 0; /* PNG's colours are not multiplied by alpha */
        float t = job->options->dither ? dither_at((uint32_t)x, (uint32_t)y) : 0.5f;
        for (int c = 0; c < 3; c++) {
            float v = rgb[c] > 0 ? rgb[c] * factor : 0; /* 0 times an infinite factor stays 0 */
            *to++ = code(shape_image_srgb_encode(job->options->tone ? shape_image_tone(v) : v), t);
        }
        if (image->alpha)
            *to++ = code(alpha, 0.5f);
    }
}

static bool is_ascii(const char *text)
{
    for (; *text; text++)
        if (*text & 0x80)
            return false;
    return true;
}

static void write_texts(png_job *job)
{
    for (size_t i = 0; i < job->options->text_count; i++) {
        const shape_image_text *from = &job->options->texts[i];
        png_text text;
        memset(&text, 0, sizeof text);
        text.compression = is_ascii(from->value) ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE;
        text.key = (png_charp)from->key;
        text.text = (png_charp)from->value;
        text.text_length = strlen(from->value);
        png_set_text(job->png, job->info, &text, 1);
    }
}

static void write_work(png_job *job)
{
    const shape_image *image = job->source;
    png_set_write_fn(job->png, job, write_bytes, flush_nothing);
    png_set_user_limits(job->png, SHAPE_IMAGE_SIDE_MAX, SHAPE_IMAGE_SIDE_MAX);
    png_set_IHDR(job->png, job->info, (png_uint_32)image->width, (png_uint_32)image->height, 8,
                 image->alpha ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(job->png, job->info, PNG_sRGB_INTENT_PERCEPTUAL);
    write_texts(job);
    png_write_info(job->png, job->info);
    for (int y = 0; y < image->height; y++) {
        fill_row(job, y);
        png_write_row(job->png, job->row);
    }
    png_write_end(job->png, job->info);
}

shape_status image_png_encode(const shape_image *image, const shape_image_options *options,
                              unsigned char **bytes, size_t *size, shape_error *error)
{
    png_job job = {.source = image, .options = options};
    job.row = malloc((size_t)image->width * 4);
    job.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &job, on_error, on_warning);
    job.info = job.png ? png_create_info_struct(job.png) : NULL;
    bool done = job.row && job.info && guarded(&job, write_work);
    png_destroy_write_struct(&job.png, &job.info);
    free(job.row);
    if (!done) {
        free(job.out.bytes);
        return shape_error_set(error, SHAPE_ERROR_MEMORY, "cannot write PNG: %s (make the picture smaller)",
                               job.text[0] ? job.text : "not enough memory");
    }
    *bytes = job.out.bytes;
    *size = job.out.size;
    return SHAPE_OK;
}

/* --- reading --- */

static void read_bytes(png_structp png, png_bytep bytes, size_t size)
{
    png_job *job = png_get_io_ptr(png);
    if (size > job->size - job->at)
        png_error(png, "the file ends too early");
    memcpy(bytes, job->bytes + job->at, size);
    job->at += size;
}

/* Asks libpng for 8- or 16-bit RGB or RGBA whatever the file has. */
static void ask_for_rgb(png_job *job)
{
    png_set_expand(job->png); /* palettes, few bits, a transparent colour */
    png_set_gray_to_rgb(job->png);
    png_set_interlace_handling(job->png);
    png_read_update_info(job->png, job->info);
}

static void read_work(png_job *job)
{
    png_set_read_fn(job->png, job, read_bytes);
    png_set_user_limits(job->png, SHAPE_IMAGE_SIDE_MAX, SHAPE_IMAGE_SIDE_MAX);
    png_set_chunk_malloc_max(job->png, 1 << 24);
    png_set_chunk_cache_max(job->png, 128);
    png_read_info(job->png, job->info);
    size_t width = png_get_image_width(job->png, job->info),
           height = png_get_image_height(job->png, job->info);
    if (png_get_rowbytes(job->png, job->info) * height / IMAGE_DEFLATE_MAX > job->size)
        png_error(job->png, "so few bytes cannot hold so many pixels");
    ask_for_rgb(job);
    size_t row_bytes = png_get_rowbytes(job->png, job->info);
    job->made = shape_image_create((int)width, (int)height, NULL);
    job->raw = malloc(row_bytes * height);
    job->rows = malloc(height * sizeof *job->rows);
    bool alpha = png_get_channels(job->png, job->info) == 4;
    if (!job->made || !job->raw || !job->rows || (alpha && shape_image_add_alpha(job->made, NULL))) {
        job->memory_out = true;
        png_error(job->png, "not enough memory");
    }
    for (size_t y = 0; y < height; y++)
        job->rows[y] = job->raw + y * row_bytes;
    png_read_image(job->png, job->rows);
    png_read_end(job->png, NULL);
}

/* sRGB codes to linear, alpha multiplied in. */
static void raw_to_linear(png_job *job)
{
    shape_image *image = job->made;
    bool deep = png_get_bit_depth(job->png, job->info) == 16;
    size_t channels = png_get_channels(job->png, job->info), width = (size_t)image->width;
    float top = deep ? 65535 : 255;
    for (size_t y = 0; y < (size_t)image->height; y++)
        for (size_t x = 0; x < width; x++) {
            float value[4] = {0, 0, 0, 1};
            for (size_t c = 0; c < channels; c++) {
                const unsigned char *from = job->rows[y] + (x * channels + c) * (deep ? 2 : 1);
                value[c] = (float)(deep ? from[0] * 256 + from[1] : from[0]) / top;
            }
            for (size_t c = 0; c < 3; c++)
                image->pixels[(y * width + x) * 3 + c] = shape_image_srgb_decode(value[c]) * value[3];
            if (image->alpha)
                image->alpha[y * width + x] = value[3];
        }
}

shape_status image_png_decode(const unsigned char *bytes, size_t size, shape_image **image,
                              shape_error *error)
{
    png_job job = {.bytes = bytes, .size = size};
    job.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &job, on_error, on_warning);
    job.info = job.png ? png_create_info_struct(job.png) : NULL;
    bool done = job.info && guarded(&job, read_work);
    if (done)
        raw_to_linear(&job);
    bool memory = !job.info || job.memory_out;
    png_destroy_read_struct(&job.png, &job.info, NULL);
    free(job.raw);
    free(job.rows);
    if (done) {
        *image = job.made;
        return SHAPE_OK;
    }
    shape_image_destroy(job.made);
    if (memory)
        return shape_error_memory(error);
    return shape_error_set(error, SHAPE_ERROR_FORMAT,
                           "a damaged or too large PNG: %s (write it again, %d pixels a side at most)",
                           job.text, SHAPE_IMAGE_SIDE_MAX);
}
