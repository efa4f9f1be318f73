/* OpenEXR through its C core, from and to memory: scan lines of 32-bit floats, ZIP. The core asks for bytes by their
 * place and reports by a callback; both work on the stream below. */
#include "image_private.h"

#include <openexr.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The core takes memory as a file tells it to; nothing that is read here needs more than this at once. */
enum { LARGEST_ALLOCATION = 1 << 28 };

typedef struct exr_stream {
    const unsigned char *bytes; /* reading */
    size_t size;
    image_buffer out; /* writing */
    bool no_memory;   /* which the core may call an error of the stream or the file */
    char text[200];   /* the core's own first word on what failed */
} exr_stream;

static void *take_memory(size_t size)
{
    return size <= LARGEST_ALLOCATION ? malloc(size) : NULL;
}

static int64_t stream_size(exr_const_context_t context, void *data)
{
    (void)context;
    return (int64_t)((const exr_stream *)data)->size;
}

/* Fewer bytes than asked for at the end: the core reads headers ahead, and tells itself where that is an error. */
static int64_t stream_read(exr_const_context_t context, void *data, void *buffer, uint64_t size,
                           uint64_t offset, exr_stream_error_func_ptr_t on_error)
{
    const exr_stream *stream = data;
    (void)context;
    (void)on_error;
    size_t rest = offset < stream->size ? stream->size - offset : 0;
    size_t count = size < rest ? size : rest;
    memcpy(buffer, stream->bytes + (offset < stream->size ? offset : 0), count);
    return (int64_t)count;
}

static int64_t stream_write(exr_const_context_t context, void *data, const void *buffer, uint64_t size,
                            uint64_t offset, exr_stream_error_func_ptr_t on_error)
{
    exr_stream *stream = data;
    if (image_buffer_write(&stream->out, offset, buffer, size)) {
        stream->no_memory = true;
        on_error(context, EXR_ERR_OUT_OF_MEMORY, "not enough memory");
        return -1;
    }
    return (int64_t)size;
}

static void keep_text(exr_const_context_t context, exr_result_t result, const char *text)
{
    void *data = NULL;
    if (exr_get_user_data(context, &data) || !data)
        return;
    exr_stream *stream = data;
    stream->no_memory = stream->no_memory || result == EXR_ERR_OUT_OF_MEMORY;
    if (!stream->text[0])
        snprintf(stream->text, sizeof stream->text, "%s", text);
}

/* A context that is written stays locked while it tells an error, and asking it for anything would wait for ever. */
static void keep_silent(exr_const_context_t context, exr_result_t result, const char *text)
{
    (void)context;
    (void)result;
    (void)text;
}

static exr_context_initializer_t stream_initializer(exr_stream *stream)
{
    exr_context_initializer_t start = EXR_DEFAULT_CONTEXT_INITIALIZER;
    start.error_handler_fn = keep_text;
    start.alloc_fn = take_memory;
    start.free_fn = free;
    start.user_data = stream;
    start.read_fn = stream_read;
    start.size_fn = stream_size;
    start.write_fn = stream_write;
    start.max_image_width = start.max_image_height = SHAPE_IMAGE_SIDE_MAX;
    start.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    return start;
}

/* Where a channel's first value of the first row is, and how many floats lie between values; NULL where the image has
 * no such plane. Names: R, G, B, A, layer.R, layer.G, layer.B. */
static float *channel_start(const shape_image *image, const char *name, size_t *step)
{
    *step = 3;
    const char *dot = strrchr(name, '.');
    const char *last = dot ? dot + 1 : name;
    if (!strcmp(name, "A")) {
        *step = 1;
        return image->alpha;
    }
    const char *place = *last ? strchr("RGB", *last) : NULL;
    if (!place || last[1])
        return NULL;
    float *pixels = image->pixels;
    if (dot) {
        char layer[SHAPE_IMAGE_LAYER_NAME_MAX + 1];
        if ((size_t)(dot - name) >= sizeof layer)
            return NULL;
        snprintf(layer, sizeof layer, "%.*s", (int)(dot - name), name);
        pixels = shape_image_layer_pixels(image, layer);
    }
    return pixels ? pixels + (place - "RGB") : NULL;
}

/* --- writing --- */

static exr_result_t add_channels(exr_context_t context, const char *layer)
{
    char name[SHAPE_IMAGE_LAYER_NAME_MAX + 3];
    exr_result_t result = EXR_ERR_SUCCESS;
    for (const char *c = "BGR"; *c && !result; c++) {
        snprintf(name, sizeof name, "%s%s%c", layer, *layer ? "." : "", *c);
        result = exr_add_channel(context, 0, name, EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    }
    return result;
}

static exr_result_t write_header(exr_context_t context, const shape_image *image,
                                 const shape_image_options *options)
{
    int part;
    exr_result_t result = exr_add_part(context, NULL, EXR_STORAGE_SCANLINE, &part);
    if (!result)
        result =
            exr_initialize_required_attr_simple(context, 0, image->width, image->height, EXR_COMPRESSION_ZIP);
    if (!result && image->alpha)
        result = exr_add_channel(context, 0, "A", EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LINEAR, 1, 1);
    if (!result)
        result = add_channels(context, "");
    for (int i = 0; i < image->layer_count && !result; i++)
        result = add_channels(context, image->layers[i].name);
    for (size_t i = 0; i < options->text_count && !result; i++)
        result = exr_attr_set_string(context, 0, options->texts[i].key, options->texts[i].value);
    return result ? result : exr_write_header(context);
}

typedef exr_result_t (*exr_step)(exr_encode_pipeline_t *pipeline);

/* A reader takes a chunk of exactly its raw size to be raw, but the core (3.1) keeps a compressed one of that size: such a
 * chunk must be stored as it was. */
static exr_result_t compress_chunk(exr_encode_pipeline_t *pipeline)
{
    exr_step compress = *(exr_step *)pipeline->encoding_user_data;
    exr_result_t result = compress(pipeline);
    if (!result && pipeline->compressed_buffer && pipeline->compressed_buffer != pipeline->packed_buffer &&
        pipeline->compressed_bytes == pipeline->packed_bytes)
        memcpy(pipeline->compressed_buffer, pipeline->packed_buffer, pipeline->packed_bytes);
    return result;
}

static exr_result_t write_chunk(exr_context_t context, exr_encode_pipeline_t *pipeline, exr_step *compress,
                                const shape_image *image, int y)
{
    exr_chunk_info_t chunk;
    exr_result_t result = exr_write_scanline_chunk_info(context, 0, y, &chunk);
    bool first = y == 0;
    if (!result)
        result = first ? exr_encoding_initialize(context, 0, &chunk, pipeline)
                       : exr_encoding_update(context, 0, &chunk, pipeline);
    for (int i = 0; i < pipeline->channel_count && !result; i++) {
        exr_coding_channel_info_t *channel = &pipeline->channels[i];
        size_t step;
        const float *start = channel_start(image, channel->channel_name, &step);
        channel->user_pixel_stride = (int32_t)(step * sizeof(float));
        channel->user_line_stride = (int32_t)(step * sizeof(float)) * image->width;
        channel->encode_from_ptr = (const uint8_t *)(start + (size_t)y * (size_t)image->width * step);
    }
    if (!result && first) {
        result = exr_encoding_choose_default_routines(context, 0, pipeline);
        *compress = pipeline->compress_fn;
        if (pipeline->compress_fn)
            pipeline->compress_fn = compress_chunk;
    }
    pipeline->encoding_user_data = compress;
    return result ? result : exr_encoding_run(context, 0, pipeline);
}

static exr_result_t write_image(exr_context_t context, const shape_image *image,
                                const shape_image_options *options)
{
    exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
    exr_step compress = NULL;
    int32_t lines = 0;
    exr_result_t result = write_header(context, image, options);
    if (!result)
        result = exr_get_scanlines_per_chunk(context, 0, &lines);
    for (int y = 0; y < image->height && !result; y += lines)
        result = write_chunk(context, &pipeline, &compress, image, y);
    exr_encoding_destroy(context, &pipeline);
    return result;
}

shape_status image_exr_encode(const shape_image *image, const shape_image_options *options,
                              unsigned char **bytes, size_t *size, shape_error *error)
{
    exr_stream stream = {0};
    exr_context_initializer_t start = stream_initializer(&stream);
    start.error_handler_fn = keep_silent;
    exr_context_t context;
    exr_result_t result = exr_start_write(&context, "memory", EXR_WRITE_FILE_DIRECTLY, &start);
    if (!result) {
        result = write_image(context, image, options);
        exr_result_t finished = exr_finish(&context);
        if (!result)
            result = finished;
    }
    if (result) {
        free(stream.out.bytes);
        if (stream.no_memory || result == EXR_ERR_OUT_OF_MEMORY)
            return shape_error_memory(error);
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "cannot write EXR: %s (change the text's key, or make the picture smaller)",
                               exr_get_default_error_message(result));
    }
    *bytes = stream.out.bytes;
    *size = stream.out.size;
    return SHAPE_OK;
}

/* --- reading --- */

typedef struct exr_reader {
    exr_context_t context;
    exr_stream stream;
    const exr_attr_chlist_t *channels;
    exr_attr_box2i_t window;
    shape_image *image;
    bool grey; /* Y alone */
} exr_reader;

static bool has_channel(const exr_reader *reader, const char *name)
{
    for (int i = 0; i < reader->channels->num_channels; i++)
        if (!strcmp(reader->channels->entries[i].name.str, name))
            return true;
    return false;
}

/* Refuses what is not read, before memory for pixels is taken. */
static shape_status check_header(exr_reader *reader, shape_error *error)
{
    exr_storage_t storage;
    exr_compression_t compression;
    exr_context_t context = reader->context;
    if (exr_get_storage(context, 0, &storage) || exr_get_compression(context, 0, &compression) ||
        exr_get_channels(context, 0, &reader->channels) || exr_get_data_window(context, 0, &reader->window))
        return shape_error_set(error, SHAPE_ERROR_FORMAT,
                               "the EXR header lacks what it must have (write it again)");
    if (storage != EXR_STORAGE_SCANLINE || compression > EXR_COMPRESSION_ZIP)
        return shape_error_set(
            error, SHAPE_ERROR_FORMAT,
            "this kind of EXR is not read (write it as scan lines with ZIP or no compression)");
    exr_attr_box2i_t w = reader->window;
    double width = (double)w.max.x - w.min.x + 1, height = (double)w.max.y - w.min.y + 1;
    shape_status status = image_size_check(width, height, error);
    if (status)
        return status;
    double row = 0;
    for (int i = 0; i < reader->channels->num_channels; i++) {
        const exr_attr_chlist_entry_t *channel = &reader->channels->entries[i];
        if (channel->x_sampling != 1 || channel->y_sampling != 1)
            return shape_error_set(error, SHAPE_ERROR_FORMAT,
                                   "channel %.40s is subsampled (write it in full size)", channel->name.str);
        row += width * (channel->pixel_type == EXR_PIXEL_HALF ? 2 : 4);
    }
    if (row * height / IMAGE_DEFLATE_MAX > (double)reader->stream.size || row * 16 > LARGEST_ALLOCATION)
        return shape_error_set(
            error, SHAPE_ERROR_FORMAT,
            "the EXR claims %.0fx%.0f pixels, which its bytes cannot hold (copy the file again)", width,
            height);
    return SHAPE_OK;
}

static shape_status check_channels(exr_reader *reader, shape_error *error)
{
    bool colour = has_channel(reader, "R") && has_channel(reader, "G") && has_channel(reader, "B");
    reader->grey = !colour && has_channel(reader, "Y");
    if (colour || reader->grey)
        return SHAPE_OK;
    return shape_error_set(error, SHAPE_ERROR_FORMAT,
                           "the EXR has no channels R, G and B, and no Y (rename them)");
}

/* A layer for each name that has .R, .G and .B; beyond what an image holds, and oddly named ones, are left out. */
static shape_status add_layers(exr_reader *reader, shape_error *error)
{
    for (int i = 0; i < reader->channels->num_channels; i++) {
        const char *name = reader->channels->entries[i].name.str;
        size_t length = strlen(name);
        char layer[SHAPE_IMAGE_LAYER_NAME_MAX + 1], other[SHAPE_IMAGE_LAYER_NAME_MAX + 3];
        if (length < 3 || strcmp(name + length - 2, ".R") || length - 2 >= sizeof layer)
            continue;
        snprintf(layer, sizeof layer, "%.*s", (int)(length - 2), name);
        bool whole = true;
        for (const char *c = "GB"; *c; c++) {
            snprintf(other, sizeof other, "%s.%c", layer, *c);
            whole = whole && has_channel(reader, other);
        }
        if (whole && shape_image_add_layer(reader->image, layer, error) == SHAPE_ERROR_MEMORY)
            return SHAPE_ERROR_MEMORY;
    }
    return SHAPE_OK;
}

static float *reader_channel(const exr_reader *reader, const char *name, size_t *step)
{
    *step = 3;
    if (reader->grey && !strcmp(name, "Y"))
        return reader->image->pixels;
    if (reader->grey && strlen(name) == 1 && strchr("RGB", *name))
        return NULL;
    return channel_start(reader->image, name, step);
}

static exr_result_t read_chunk(exr_reader *reader, exr_decode_pipeline_t *pipeline, int row)
{
    exr_chunk_info_t chunk;
    int width = reader->image->width;
    exr_result_t result =
        exr_read_scanline_chunk_info(reader->context, 0, reader->window.min.y + row, &chunk);
    if (!result)
        result = row ? exr_decoding_update(reader->context, 0, &chunk, pipeline)
                     : exr_decoding_initialize(reader->context, 0, &chunk, pipeline);
    if (!result && (chunk.start_y - reader->window.min.y != row || chunk.width != width || chunk.height < 1 ||
                    chunk.height > reader->image->height - row))
        result = EXR_ERR_BAD_CHUNK_LEADER;
    for (int i = 0; i < pipeline->channel_count && !result; i++) {
        exr_coding_channel_info_t *channel = &pipeline->channels[i];
        size_t step;
        float *start = reader_channel(reader, channel->channel_name, &step);
        if (start && channel->data_type == EXR_PIXEL_UINT)
            result = EXR_ERR_FEATURE_NOT_IMPLEMENTED;
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_bytes_per_element = sizeof(float);
        channel->user_pixel_stride = (int32_t)(step * sizeof(float));
        channel->user_line_stride = (int32_t)(step * sizeof(float)) * width;
        channel->decode_to_ptr = start ? (uint8_t *)(start + (size_t)row * (size_t)width * step) : NULL;
    }
    if (!result && row == 0)
        result = exr_decoding_choose_default_routines(reader->context, 0, pipeline);
    return result ? result : exr_decoding_run(reader->context, 0, pipeline);
}

static exr_result_t read_pixels(exr_reader *reader)
{
    exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
    int32_t lines = 0;
    exr_result_t result = exr_get_scanlines_per_chunk(reader->context, 0, &lines);
    for (int row = 0; row < reader->image->height && !result; row += lines)
        result = read_chunk(reader, &pipeline, row);
    exr_decoding_destroy(reader->context, &pipeline);
    return result;
}

static shape_status read_image(exr_reader *reader, shape_error *error)
{
    shape_status status = check_header(reader, error);
    if (!status)
        status = check_channels(reader, error);
    if (status)
        return status;
    exr_attr_box2i_t w = reader->window;
    reader->image = shape_image_create(w.max.x - w.min.x + 1, w.max.y - w.min.y + 1, error);
    if (!reader->image)
        return SHAPE_ERROR_MEMORY;
    if (has_channel(reader, "A"))
        status = shape_image_add_alpha(reader->image, error);
    if (!status)
        status = add_layers(reader, error);
    if (status)
        return status;
    exr_result_t result = read_pixels(reader);
    if (result && (reader->stream.no_memory || result == EXR_ERR_OUT_OF_MEMORY))
        return shape_error_memory(error);
    if (result)
        return shape_error_set(error, SHAPE_ERROR_FORMAT, "damaged EXR: %s (copy the file again)",
                               reader->stream.text[0] ? reader->stream.text
                                                      : exr_get_default_error_message(result));
    size_t count = (size_t)reader->image->width * (size_t)reader->image->height;
    float *pixels = reader->image->pixels;
    for (size_t i = 0; i < count && reader->grey; i++)
        pixels[3 * i + 1] = pixels[3 * i + 2] = pixels[3 * i];
    return SHAPE_OK;
}

shape_status image_exr_decode(const unsigned char *bytes, size_t size, shape_image **image,
                              shape_error *error)
{
    exr_reader reader = {.stream = {.bytes = bytes, .size = size}};
    exr_context_initializer_t start = stream_initializer(&reader.stream);
    exr_result_t result = exr_start_read(&reader.context, "memory", &start);
    if (result && (reader.stream.no_memory || result == EXR_ERR_OUT_OF_MEMORY))
        return shape_error_memory(error);
    if (result)
        return shape_error_set(error, SHAPE_ERROR_FORMAT, "damaged EXR header: %s (copy the file again)",
                               reader.stream.text[0] ? reader.stream.text : "it cannot be read");
    shape_status status = read_image(&reader, error);
    exr_finish(&reader.context);
    if (status)
        shape_image_destroy(reader.image);
    else
        *image = reader.image;
    return status;
}
