/* Private: the byte layout of a .neph file, version 1.1, as docs/neph-format.md fixes it. Every number is written byte
 * by byte, least significant first, so neither the host's byte order nor a compiler's padding can reach a file. */
#ifndef SHAPE_FILE_NEPH_LAYOUT_H
#define SHAPE_FILE_NEPH_LAYOUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "shape/neph.h"

/* Sizes [bytes]. */
enum {
    NEPH_ALIGN = 16, /* chunks and the file's end lie on multiples of it */
    NEPH_HEADER_SIZE = 32,
    NEPH_ENTRY_SIZE = 32,     /* one row of the chunk table */
    NEPH_TABLE_CRC_SIZE = 4,  /* behind the table */
    NEPH_CLOUDS_HEAD = 16,    /* before the first cloud record */
    NEPH_CLOUD_RECORD = 208,  /* one cloud, in this minor version */
    NEPH_RECORD_MAX = 65536,  /* one cloud, in any later minor version */
    NEPH_LAYERS_HEAD = 16,    /* before the first layer record */
    NEPH_LAYER_RECORD = 112,  /* one cloud's, in this minor version */
    NEPH_SPHERE_SIZE = 16,    /* x y z radius */
    NEPH_ELLIPSOID_SIZE = 48, /* x y z 0, a b c 0, qx qy qz qw */
};

/* The header, from the file's first byte. */
enum {
    NEPH_AT_MAGIC = 0,
    NEPH_AT_MAJOR = 8,      /* u16 */
    NEPH_AT_MINOR = 10,     /* u16 */
    NEPH_AT_CHUNKS = 12,    /* u32 */
    NEPH_AT_FILE_SIZE = 16, /* u64; 8 reserved bytes follow */
};

/* A row of the chunk table. */
enum {
    NEPH_ENTRY_TYPE = 0,      /* 4 characters */
    NEPH_ENTRY_FLAGS = 4,     /* u32 */
    NEPH_ENTRY_PARAMETER = 8, /* u32: the list's index in SPHR and ELLI */
    NEPH_ENTRY_CRC = 12,      /* u32, of the chunk's bytes */
    NEPH_ENTRY_OFFSET = 16,   /* u64, from the file's first byte */
    NEPH_ENTRY_LENGTH = 24,   /* u64, without padding */
};

enum { NEPH_FLAG_REQUIRED = 1 };

/* Of primitives walked again by shape_neph_bounds. */
enum { NEPH_VISITS_MAX = 1 << 28 };

/* The head of the CLUD chunk. */
enum {
    NEPH_CLOUDS_RECORD_SIZE = 0, /* u32 */
    NEPH_CLOUDS_COUNT = 4,       /* u32 */
    NEPH_CLOUDS_LISTS = 8,       /* u32; 4 reserved bytes follow */
};

/* A cloud record. */
enum {
    NEPH_CLOUD_FRAME = 0,        /* 12 f64, row by row */
    NEPH_CLOUD_SEED = 96,        /* u64 */
    NEPH_CLOUD_NOISE_SEED = 104, /* u64 */
    NEPH_CLOUD_BOX = 112,        /* 6 f32: min x y z, max x y z */
    NEPH_CLOUD_LIST = 136,       /* u32 */
    NEPH_CLOUD_NAME = 140,       /* u32 offset in TEXT, u32 length */
    NEPH_CLOUD_MADE_BY = 148,    /* u32 offset in TEXT, u32 length */
    NEPH_CLOUD_MODEL = 156,      /* u32 */
    NEPH_CLOUD_OCTAVES = 160,    /* u32 */
    NEPH_CLOUD_PHASE = 164,      /* u32 */
    NEPH_CLOUD_KAPPA = 168,      /* f32, and so on */
    NEPH_CLOUD_NOISE_SCALE = 172,
    NEPH_CLOUD_EDGE = 176,
    NEPH_CLOUD_EXTINCTION = 180,
    NEPH_CLOUD_ALBEDO = 184,
    NEPH_CLOUD_G = 188,
    NEPH_CLOUD_G2 = 192,
    NEPH_CLOUD_LOBE_MIX = 196,
    NEPH_CLOUD_DROPLET = 200, /* 4 reserved bytes follow */
};

/* The head of the LAYR chunk. */
enum {
    NEPH_LAYERS_RECORD_SIZE = 0, /* u32 */
    NEPH_LAYERS_COUNT = 4,       /* u32; 8 reserved bytes follow */
};

/* A layer record. */
enum {
    NEPH_LAYER_CLOUD = 0, /* u32 */
    NEPH_LAYER_BOUNDS = 4,
    NEPH_LAYER_NOISE = 8,
    NEPH_LAYER_WORLEY_OCTAVES = 12,
    NEPH_LAYER_DETAIL = 16, /* 7 f32, in the order of shape_detail */
    NEPH_LAYER_BLEND = 44,  /* f32, and so on */
    NEPH_LAYER_GAIN = 48,
    NEPH_LAYER_WORLEY_GAIN = 52,
    NEPH_LAYER_WORLEY_FREQUENCY = 56,
    NEPH_LAYER_STRETCH = 60, /* 3 f32 */
    NEPH_LAYER_COVERAGE = 72,
    NEPH_LAYER_CUT = 76,
    NEPH_LAYER_RAMP = 80, /* 2 f32 */
    NEPH_LAYER_FALLOFF = 88,
    NEPH_LAYER_FADES = 92,          /* 3 f32: bottom, top, sides */
    NEPH_LAYER_PLANET_RADIUS = 104, /* 4 reserved bytes follow */
};

/* Carriage return, line feed, control-Z and a byte above 127: what text-mode copying damages, as in PNG. */
#define NEPH_MAGIC "\x89NPH\r\n\x1a\n"

_Static_assert(sizeof(shape_sphere) == NEPH_SPHERE_SIZE, "a sphere is four floats");
_Static_assert(sizeof(shape_ellipsoid) == NEPH_ELLIPSOID_SIZE, "an ellipsoid is twelve floats");
_Static_assert(sizeof(float) == 4 && sizeof(double) == 8, "IEEE single and double precision");

static inline void neph_put_u16(unsigned char *to, uint16_t value)
{
    to[0] = (unsigned char)value;
    to[1] = (unsigned char)(value >> 8);
}

static inline void neph_put_u32(unsigned char *to, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        to[i] = (unsigned char)(value >> (8 * i));
}

static inline void neph_put_u64(unsigned char *to, uint64_t value)
{
    for (int i = 0; i < 8; i++)
        to[i] = (unsigned char)(value >> (8 * i));
}

static inline void neph_put_f32(unsigned char *to, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    neph_put_u32(to, bits);
}

static inline void neph_put_f64(unsigned char *to, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    neph_put_u64(to, bits);
}

static inline uint16_t neph_get_u16(const unsigned char *from)
{
    return (uint16_t)(from[0] | from[1] << 8);
}

static inline uint32_t neph_get_u32(const unsigned char *from)
{
    return (uint32_t)from[0] | (uint32_t)from[1] << 8 | (uint32_t)from[2] << 16 | (uint32_t)from[3] << 24;
}

static inline uint64_t neph_get_u64(const unsigned char *from)
{
    return (uint64_t)neph_get_u32(from) | (uint64_t)neph_get_u32(from + 4) << 32;
}

static inline float neph_get_f32(const unsigned char *from)
{
    uint32_t bits = neph_get_u32(from);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline double neph_get_f64(const unsigned char *from)
{
    uint64_t bits = neph_get_u64(from);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline bool neph_host_is_little(void)
{
    const uint16_t one = 1;
    unsigned char first;
    memcpy(&first, &one, 1);
    return first == 1;
}

/* Arrays of floats, on any host. */
static inline void neph_put_floats_bytewise(unsigned char *to, const float *from, size_t count)
{
    for (size_t i = 0; i < count; i++)
        neph_put_f32(to + 4 * i, from[i]);
}

static inline void neph_get_floats_bytewise(float *to, const unsigned char *from, size_t count)
{
    for (size_t i = 0; i < count; i++)
        to[i] = neph_get_f32(from + 4 * i);
}

/* The same, as one copy where the host's order is the file's. */
static inline void neph_put_floats(unsigned char *to, const float *from, size_t count)
{
    if (!count)
        return;
    if (neph_host_is_little())
        memcpy(to, from, 4 * count);
    else
        neph_put_floats_bytewise(to, from, count);
}

static inline void neph_get_floats(float *to, const unsigned char *from, size_t count)
{
    if (!count)
        return;
    if (neph_host_is_little())
        memcpy(to, from, 4 * count);
    else
        neph_get_floats_bytewise(to, from, count);
}

/* The next multiple of NEPH_ALIGN; the caller sees to it that there is one. */
static inline uint64_t neph_aligned(uint64_t offset)
{
    return (offset + NEPH_ALIGN - 1) / NEPH_ALIGN * NEPH_ALIGN;
}

/* Numbers of enumerations and small counts; what is too large for an int stays out of every range. */
static inline int neph_get_small(const unsigned char *from)
{
    uint32_t value = neph_get_u32(from);
    return value > 0xffff ? 0xffff : (int)value;
}

/* Whether a cloud's field has anything that only a layer record can hold. */
bool neph_needs_layer(const shape_field *field);
/* How many clouds of a set do. */
size_t neph_count_layers(const shape_set *set);
/* Writes, and reads back, what a record holds of a field. What the model does not have is written as zeros; read, the
 * layer of a model other than layer is left as it is. */
void neph_put_layer(unsigned char *to, uint32_t cloud, const shape_field *field);
void neph_get_layer(const unsigned char *from, shape_field *field);

/* Four characters, each A-Z, a-z or 0-9. */
bool neph_type_is_valid(const char type[4]);
/* One of the types of this version. */
bool neph_type_is_known(const char type[4]);

/* A cloud's name and made_by, as the format wants them: UTF-8 without control characters. */
bool neph_text_is_plain(const char *text, size_t length);

#endif
