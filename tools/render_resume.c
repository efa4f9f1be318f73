/* --resume FILE. The file: "NEPHSUM1", width, height, samples of each pixel and 0 (32 bits each), the SHA-256 of all that
 * the picture depends on but for the number of samples, six doubles a pixel (shape_pathtrace_pixel), and the SHA-256 of
 * all that; numbers are little-endian. It is written whole or not at all, between two passes, so that what a kill leaves is
 * the state of an earlier pass, and the picture that goes on from it is the one that was never interrupted. */
#include "render_resume.h"

#include <sys/types.h>

#include <errno.h>
#include <sha2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "cli_volume.h"
#include "shape/file.h"
#include "shape/grid.h"
#include "shape/neph.h"

enum { MAGIC = 8, KEY_AT = 24, PIXELS_AT = KEY_AT + SHA256_DIGEST_LENGTH, PIXEL_BYTES = 48, TEXT = 65536 };

static const char magic[MAGIC + 1] = "NEPHSUM1";
static const char *path;
static double every = 30; /* seconds */
static bool every_given;

const cli_option render_resume_options[] = {
    {"resume", 0, CLI_TEXT, &path, 0, 0, "FILE",
     "keep the paths' sums in FILE, and go on from them where it is there [none]", NULL, true},
    {"resume-every", 0, CLI_NUMBER, &every, 0, 1e6, "S", "write FILE again after so many seconds [30]",
     &every_given, true},
    {0}};

/* One process, one picture. */
static struct {
    SHA2_CTX meshes;
    bool any_mesh;
    int width, height;
    unsigned char *bytes; /* of the file */
    size_t size;
    const shape_pathtrace_pixel *pixels;
    double written; /* when */
} state;

static double seconds(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

const char *render_resume_given(void)
{
    return cli_given_of(render_resume_options);
}

void render_resume_check(void)
{
    if (every_given && !path)
        cli_wrong("--resume-every needs --resume FILE");
    if (path && (!*path || !strcmp(path, "-")))
        cli_wrong("--resume needs a file's name");
}

/* --- what the picture depends on --- */

/* The sum of all that stands in the picture, begun with the first of it. */
static void begin_meshes(void)
{
    if (!state.any_mesh)
        SHA256Init(&state.meshes);
    state.any_mesh = true;
}

void render_resume_note_ground(double height, const float albedo[3])
{
    begin_meshes();
    SHA256Update(&state.meshes, (const uint8_t *)&height, sizeof height);
    SHA256Update(&state.meshes, (const uint8_t *)albedo, 3 * sizeof *albedo);
}

void render_resume_note_mesh(const shape_mesh *mesh, const shape_frame *frame, const float albedo[3])
{
    begin_meshes();
    SHA256Update(&state.meshes, (const uint8_t *)frame, sizeof *frame);
    SHA256Update(&state.meshes, (const uint8_t *)albedo, 3 * sizeof *albedo);
    SHA256Update(&state.meshes, (const uint8_t *)mesh->points, mesh->point_count * sizeof *mesh->points);
    SHA256Update(&state.meshes, (const uint8_t *)mesh->indices,
                 3 * mesh->triangle_count * sizeof *mesh->indices);
}

static void add_grid(SHA2_CTX *sum, const shape_cloud *cloud, const shape_grid *grid)
{
    size_t cells = (size_t)grid->bricks[0] * (size_t)grid->bricks[1] * (size_t)grid->bricks[2];
    SHA256Update(sum, (const uint8_t *)&cloud->frame, sizeof cloud->frame);
    SHA256Update(sum, (const uint8_t *)grid->points, sizeof grid->points);
    SHA256Update(sum, (const uint8_t *)grid->table, cells * sizeof *grid->table);
    SHA256Update(sum, (const uint8_t *)grid->values,
                 grid->brick_count * SHAPE_GRID_BRICK_POINTS * sizeof *grid->values);
    for (int c = 0; c < 3 && grid->coloured; c++) {
        uint8_t has = grid->colour[c] != NULL;
        SHA256Update(sum, &has, sizeof has);
        if (has)
            add_grid(sum, cloud, grid->colour[c]);
    }
}

static void add_set(SHA2_CTX *sum, const cli_input *input)
{
    shape_error error;
    unsigned char *bytes;
    size_t size;
    if (input->volume) { /* of which no .neph can be made; its medium is in the text */
        add_grid(sum, &input->set->clouds[0], shape_set_list_const(input->set, 0)->grid);
        return;
    }
    cli_check(shape_neph_encode(input->set, &bytes, &size, &error), &error);
    SHA256Update(sum, bytes, size);
    free(bytes);
}

static void add_settings(SHA2_CTX *sum, const shape_view *v, const shape_light *l,
                         const shape_pathtrace_options *o)
{
    static char text[TEXT];
    int length = snprintf(
        text, sizeof text,
        "%s %dx%d eye %.17g %.17g %.17g target %.17g %.17g %.17g fov %.17g sun %.17g %.17g %.17g %.9g "
        "%.9g %.9g angle %.17g sky %d %.9g %.9g %.9g lamp %.17g %.17g %.17g %.9g %.9g %.9g bounces %d seed "
        "%llu",
        shape_version(), v->width, v->height, v->eye.x, v->eye.y, v->eye.z, v->target.x, v->target.y,
        v->target.z, v->fov, l->sun.x, l->sun.y, l->sun.z, (double)l->sun_irradiance[0],
        (double)l->sun_irradiance[1], (double)l->sun_irradiance[2], o->sun_angle, (int)l->sky,
        (double)l->sky_radiance[0], (double)l->sky_radiance[1], (double)l->sky_radiance[2],
        o->lamp.position.x, o->lamp.position.y, o->lamp.position.z, (double)o->lamp.intensity[0],
        (double)o->lamp.intensity[1], (double)o->lamp.intensity[2], o->max_bounces,
        (unsigned long long)o->seed);
    if (l->air.visibility > 0)
        length += snprintf(text + length, sizeof text - (size_t)length, " air %.17g %.17g", l->air.visibility,
                           l->air.height);
    cli_given_text(cli_optics_options, text, sizeof text);
    cli_given_text(cli_volume_options, text, sizeof text);
    SHA256Update(sum, (const uint8_t *)text, (size_t)length + strlen(text + length));
}

static void find_key(const cli_input *input, const shape_view *view, const shape_light *light,
                     const shape_pathtrace_options *options, uint8_t key[SHA256_DIGEST_LENGTH])
{
    SHA2_CTX sum;
    SHA256Init(&sum);
    add_settings(&sum, view, light, options);
    add_set(&sum, input);
    if (state.any_mesh) {
        uint8_t meshes[SHA256_DIGEST_LENGTH];
        SHA256Final(meshes, &state.meshes);
        SHA256Update(&sum, meshes, sizeof meshes);
    }
    SHA256Final(key, &sum);
}

/* --- the file --- */

static void put_u32(unsigned char *to, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        to[i] = (unsigned char)(value >> 8 * i);
}

static uint32_t get_u32(const unsigned char *from)
{
    return (uint32_t)from[0] | (uint32_t)from[1] << 8 | (uint32_t)from[2] << 16 | (uint32_t)from[3] << 24;
}

static void put_double(unsigned char *to, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_u32(to, (uint32_t)bits);
    put_u32(to + 4, (uint32_t)(bits >> 32));
}

static double get_double(const unsigned char *from)
{
    uint64_t bits = get_u32(from) | (uint64_t)get_u32(from + 4) << 32;
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static void digest(const unsigned char *bytes, size_t size, uint8_t result[SHA256_DIGEST_LENGTH])
{
    SHA2_CTX sum;
    SHA256Init(&sum);
    SHA256Update(&sum, bytes, size);
    SHA256Final(result, &sum);
}

static size_t count_doubles(void)
{
    return 6 * (size_t)state.width * (size_t)state.height;
}

static void write_state(int samples)
{
    shape_error error;
    size_t end = state.size - SHA256_DIGEST_LENGTH;
    const double *values = (const double *)state.pixels; /* six each */
    put_u32(state.bytes + 16, (uint32_t)samples);
    for (size_t i = 0; i < count_doubles(); i++)
        put_double(state.bytes + PIXELS_AT + 8 * i, values[i]);
    digest(state.bytes, end, state.bytes + end);
    cli_check(shape_file_write(path, state.bytes, state.size, &error), &error);
    state.written = seconds();
}

static bool keep(void *context, int samples)
{
    (void)context;
    if (seconds() - state.written >= every)
        write_state(samples);
    return true;
}

/* The samples that the file holds, and its sums into *pixels. state.bytes has the head that it must have. */
static int read_state(shape_pathtrace_pixel *pixels, int most)
{
    shape_error error;
    unsigned char *bytes;
    uint8_t sum[SHA256_DIGEST_LENGTH] = {0};
    size_t size;
    cli_check(shape_file_read(path, SIZE_MAX / 2, &bytes, &size, &error), &error);
    if (size < MAGIC || memcmp(bytes, magic, MAGIC))
        cli_fail("%s: not what --resume keeps (name another file)", path);
    if (size < PIXELS_AT || memcmp(bytes + MAGIC, state.bytes + MAGIC, 8) ||
        memcmp(bytes + KEY_AT, state.bytes + KEY_AT, SHA256_DIGEST_LENGTH))
        cli_fail(
            "%s: is of another picture: input, view, light, options or version differ (remove it, or name "
            "another file)",
            path);
    size_t end = state.size - SHA256_DIGEST_LENGTH;
    if (size == state.size)
        digest(bytes, end, sum);
    if (size != state.size || memcmp(sum, bytes + end, sizeof sum))
        cli_fail("%s: is damaged (remove it)", path);
    int64_t samples = get_u32(bytes + 16);
    if (samples > most)
        cli_fail("%s: has %lld paths a pixel, more than --spp %d (ask for more, or remove it)", path,
                 (long long)samples, most);
    double *values = (double *)pixels;
    for (size_t i = 0; i < count_doubles(); i++)
        values[i] = get_double(bytes + PIXELS_AT + 8 * i);
    free(bytes);
    return (int)samples;
}

void render_resume_start(const cli_input *input, const shape_view *view, const shape_light *light,
                         shape_pathtrace_options *options)
{
    if (!path)
        return;
    size_t count = (size_t)view->width * (size_t)view->height;
    shape_pathtrace_pixel *pixels = calloc(count, sizeof *pixels);
    state.width = view->width;
    state.height = view->height;
    state.size = PIXELS_AT + PIXEL_BYTES * count + SHA256_DIGEST_LENGTH;
    state.bytes = calloc(state.size, 1);
    if (!pixels || !state.bytes)
        cli_fail("out of memory");
    memcpy(state.bytes, magic, MAGIC);
    put_u32(state.bytes + 8, (uint32_t)view->width);
    put_u32(state.bytes + 12, (uint32_t)view->height);
    find_key(input, view, light, options, state.bytes + KEY_AT);
    if (!access(path, F_OK) || errno != ENOENT) {
        options->samples_before = read_state(pixels, options->samples);
        cli_say("%s: goes on from %d paths a pixel", path, options->samples_before);
    }
    state.pixels = options->pixels = pixels;
    state.written = seconds();
    options->keep = keep;
}

void render_resume_end(shape_pathtrace_options *options, int samples)
{
    if (!path)
        return;
    write_state(samples);
    free(state.bytes);
    free(options->pixels);
    options->pixels = NULL;
}
