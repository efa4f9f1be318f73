/* Raw float volumes: three 32-bit sizes, then the values (Páleník 2016 section 5.2, after Pavelka). The format has no mark
 * of its own: what tells it is that the sizes agree with the number of bytes. */
#include <string.h>

#include "shape/grid.h"

enum { HEADER = 12, SIDE = SHAPE_GRID_SIDE };

typedef struct raw_volume {
    const unsigned char *values;
    int size[3];
} raw_volume;

static uint32_t get_u32(const unsigned char *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static float get_float(const unsigned char *p)
{
    uint32_t bits = get_u32(p);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* The sizes; false where they are out of range. */
static bool get_sizes(const unsigned char *bytes, uint32_t size[3])
{
    bool good = true;
    for (int a = 0; a < 3; a++) {
        size[a] = get_u32(bytes + 4 * a);
        good = good && size[a] >= 1 && size[a] <= SHAPE_GRID_MAX_SIDE - 2;
    }
    return good;
}

/* Three sizes below 2^16: no overflow in 64 bits. */
static uint64_t wanted_bytes(const uint32_t size[3])
{
    return HEADER + 4 * (uint64_t)size[0] * size[1] * size[2];
}

bool shape_volume_raw_is(const void *bytes, size_t size)
{
    uint32_t sizes[3];
    return size > HEADER && get_sizes(bytes, sizes) && wanted_bytes(sizes) == size;
}

/* Grid point i holds value i - 1. */
static bool fill_brick(void *context, const int low[3], float *values)
{
    const raw_volume *raw = context;
    bool any = false;
    for (int k = 0; k < SIDE; k++)
        for (int j = 0; j < SIDE; j++)
            for (int i = 0; i < SIDE; i++) {
                int x = low[0] + i - 1, y = low[1] + j - 1, z = low[2] + k - 1;
                bool inside =
                    x >= 0 && y >= 0 && z >= 0 && x < raw->size[0] && y < raw->size[1] && z < raw->size[2];
                float value = 0;
                if (inside)
                    value = get_float(raw->values + 4 * (((size_t)z * (size_t)raw->size[1] + (size_t)y) *
                                                             (size_t)raw->size[0] +
                                                         (size_t)x));
                any = any || !(value <= 0); /* NaN is to be found */
                if (!values && any)
                    return true;
                if (values)
                    values[(k * SIDE + j) * SIDE + i] = value;
            }
    return any;
}

shape_status shape_volume_raw_decode(const char *name, const void *bytes, size_t size, size_t max_bytes,
                                     shape_grid **grid, shape_error *error)
{
    uint32_t sizes[3];
    if (size < HEADER || !get_sizes(bytes, sizes))
        return shape_error_set(error, SHAPE_ERROR_FORMAT,
                               "%s: no raw volume (three 32-bit sizes from 1 to %d must come first)", name,
                               SHAPE_GRID_MAX_SIDE - 2);
    if (wanted_bytes(sizes) != size)
        return shape_error_set(
            error, SHAPE_ERROR_FORMAT,
            "%s: a raw volume of %u x %u x %u floats has %llu bytes, not %zu (cut short, or "
            "not a raw volume)",
            name, sizes[0], sizes[1], sizes[2], (unsigned long long)wanted_bytes(sizes), size);
    raw_volume raw = {(const unsigned char *)bytes + HEADER, {(int)sizes[0], (int)sizes[1], (int)sizes[2]}};
    shape_grid_source source = {{raw.size[0] + 2, raw.size[1] + 2, raw.size[2] + 2}, fill_brick, &raw};
    shape_error own;
    shape_status status = shape_grid_create(&source, max_bytes, grid, &own);
    return status ? shape_error_set(error, status, "%s: %s", name, own.text) : SHAPE_OK;
}
