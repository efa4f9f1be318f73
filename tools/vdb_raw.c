/* neph-vdb, raw: density as little-endian 32- or 16-bit floats, x fastest, then y, then z (with --header behind the three
 * sizes as 32-bit integers, the form of Páleník 2016), and a sidecar .json. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jansson.h>

#include "shape/file.h"
#include "vdb.h"

/* The voxels of a lattice, all of them. */
typedef struct block {
    const shape_voxel_lattice *lattice;
    float *values;
} block;

static float *row_of(const block *b, int32_t y, int32_t z)
{
    const int32_t *size = b->lattice->size;
    return b->values + ((size_t)z * (size_t)size[1] + (size_t)y) * (size_t)size[0];
}

static void clip(const block *b, const int32_t first[3], int32_t edge, int32_t from[3], int32_t to[3])
{
    for (int k = 0; k < 3; k++) {
        from[k] = first[k] > 0 ? first[k] : 0;
        to[k] = first[k] + edge < b->lattice->size[k] ? first[k] + edge : b->lattice->size[k];
    }
}

static bool put_brick(void *context, const int32_t first[3], const float *values)
{
    const block *b = context;
    int32_t from[3], to[3], edge = SHAPE_VOXEL_EDGE;
    clip(b, first, edge, from, to);
    for (int32_t z = from[2]; z < to[2]; z++)
        for (int32_t y = from[1]; y < to[1]; y++)
            for (int32_t x = from[0]; x < to[0]; x++)
                row_of(b, y, z)[x] = values[((x - first[0]) * edge + (y - first[1])) * edge + (z - first[2])];
    return true;
}

static bool put_tile(void *context, const int32_t first[3], int32_t edge, float value)
{
    const block *b = context;
    int32_t from[3], to[3];
    clip(b, first, edge, from, to);
    for (int32_t z = from[2]; z < to[2]; z++)
        for (int32_t y = from[1]; y < to[1]; y++)
            for (int32_t x = from[0]; x < to[0]; x++)
                row_of(b, y, z)[x] = value;
    return true;
}

/* IEEE 754 binary16, rounded to nearest even. A density's size is what it is for: above 65504 is infinity. */
static uint16_t half_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    uint32_t sign = bits >> 16 & 0x8000, size = bits & 0x7fffffff;
    if (size >= 0x47800000)
        return (uint16_t)(sign | 0x7c00);
    if (size < 0x38800000) { /* denormal: whole multiples of 2^-24, which adding a half does */
        float magic = 0.5f, whole;
        memcpy(&whole, &size, sizeof whole);
        whole += magic;
        memcpy(&size, &whole, sizeof size);
        return (uint16_t)(sign | (size - 0x3f000000));
    }
    uint32_t odd = size >> 13 & 1;
    return (uint16_t)(sign | ((size - 0x38000000 + 0xfff + odd) >> 13));
}

static void put_word(unsigned char *to, uint32_t word, int bytes)
{
    for (int i = 0; i < bytes; i++)
        to[i] = (unsigned char)(word >> 8 * i);
}

static unsigned char *encode(const block *b, size_t *size)
{
    const int32_t *n = b->lattice->size;
    size_t count = (size_t)n[0] * (size_t)n[1] * (size_t)n[2], at = vdb.header ? 12 : 0;
    *size = at + count * (vdb.half ? 2 : 4);
    if (!vdb.half && !vdb.header) { /* already what it should be on a little-endian machine */
        unsigned char *bytes = (unsigned char *)b->values;
        for (size_t i = 0; i < count; i++) {
            uint32_t word;
            memcpy(&word, &b->values[i], sizeof word);
            put_word(bytes + 4 * i, word, 4);
        }
        return bytes;
    }
    unsigned char *bytes = malloc(*size);
    if (!bytes)
        cli_fail("out of memory");
    for (int k = 0; k < 3 && vdb.header; k++)
        put_word(bytes + 4 * k, (uint32_t)n[k], 4);
    for (size_t i = 0; i < count; i++) {
        uint32_t word;
        memcpy(&word, &b->values[i], sizeof word);
        if (vdb.half)
            put_word(bytes + at + 2 * i, half_of(b->values[i]), 2);
        else
            put_word(bytes + at + 4 * i, word, 4);
    }
    return bytes;
}

static json_t *three(double x, double y, double z)
{
    return json_pack("[f, f, f]", x, y, z);
}

static char *bare_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return strdup(slash ? slash + 1 : path);
}

/* What the numbers are, for whoever reads them without this program. */
static char *describe(const cli_common *common, const shape_set *set, const shape_voxel_lattice *l,
                      const block *b)
{
    char made_by[SHAPE_MADE_BY_MAX + 1], *file = bare_name(common->output);
    const int32_t *n = l->size;
    size_t count = (size_t)n[0] * (size_t)n[1] * (size_t)n[2], filled = 0, best = 0;
    float most = 0;
    for (size_t i = 0; i < count; i++) {
        filled += b->values[i] > 0;
        most = b->values[i] > most ? b->values[i] : most;
    }
    for (size_t i = 0; i < set->cloud_count; i++)
        if (set->clouds[i].medium.extinction > set->clouds[best].medium.extinction)
            best = i;
    const shape_medium *m = &set->clouds[best].medium;
    static const char *const phases[] = {"hg", "isotropic", "rayleigh", "mie", "two-lobe"};
    cli_made_by(made_by);
    json_t *root = json_pack(
        "{s:s, s:s, s:s, s:[i, i, i], s:s, s:s, s:i, s:f, s:o, s:s, s:o, s:f, s:I, s:o, s:s}", "file",
        file ? file : "", "grid", "density", "type", vdb.half ? "float16" : "float32", "size", n[0], n[1],
        n[2], "order", "x fastest, then y, then z", "endian", "little", "offset", vdb.header ? 12 : 0,
        "voxel_size", l->edge, "origin", three(l->origin[0], l->origin[1], l->origin[2]), "up",
        vdb.up ? "y" : "z", "scale", three(l->edge * n[0], l->edge * n[1], l->edge * n[2]), "max",
        (double)most, "filled", (json_int_t)filled, "medium",
        json_pack("{s:f, s:f, s:s, s:f, s:f, s:f, s:f}", "extinction", vdb.values ? 1 : (double)m->extinction,
                  "albedo", (double)m->albedo, "phase", phases[m->phase], "g", (double)m->g, "g2",
                  (double)m->g2, "lobe_mix", (double)m->lobe_mix, "droplet", (double)m->droplet),
        "made_by", made_by);
    free(file);
    char *text = root ? json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(9)) : NULL;
    json_decref(root);
    if (!text)
        cli_fail("out of memory");
    return text;
}

/* The output's name with the suffix .json. */
static char *sidecar_name(const char *path)
{
    const char *dot = strrchr(path, '.'), *slash = strrchr(path, '/');
    int length = (int)(dot && (!slash || dot > slash) ? (size_t)(dot - path) : strlen(path));
    size_t room = (size_t)length + sizeof ".json";
    char *name = malloc(room);
    if (!name)
        cli_fail("out of memory");
    snprintf(name, room, "%.*s.json", length, path);
    return name;
}

void vdb_write_raw(const cli_common *common, const shape_set *set, const shape_volume *volume,
                   const shape_voxel_lattice *lattice, const shape_voxel_request *request)
{
    shape_error error;
    const int32_t *n = lattice->size;
    block b = {lattice, calloc((size_t)n[0] * (size_t)n[1] * (size_t)n[2], sizeof(float))};
    if (!b.values)
        cli_fail("out of memory");
    shape_voxel_sink sink = {&b, put_brick, put_tile};
    cli_check(shape_voxels_fill(volume, lattice, request, &sink, &error), &error);
    char *text = strcmp(common->output, "-") ? describe(common, set, lattice, &b) : NULL;
    size_t size;
    unsigned char *bytes = encode(&b, &size);
    cli_write(common, bytes, size, true);
    if (text) {
        char *name = sidecar_name(common->output);
        cli_check(shape_file_write(name, text, strlen(text), &error), &error);
        free(name);
    }
    cli_say("density: %d x %d x %d voxels", n[0], n[1], n[2]);
    free(text);
    if (bytes != (unsigned char *)b.values)
        free(bytes);
    free(b.values);
}
