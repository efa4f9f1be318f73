/* Any bytes as a raw float volume: a grid whose values are in its range, or an error. The mutator makes sizes and length
 * agree in most inputs. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "shape/grid.h"

enum { HEADER = 12, MOST_BYTES = 64 << 20 };

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed);

static void must(int truth)
{
    if (!truth)
        abort();
}

static void check(const shape_grid *grid, size_t bytes)
{
    for (int a = 0; a < 3; a++)
        must(grid->points[a] >= 3);
    must(grid->most > 0 && isfinite(grid->most));
    for (int i = 0; i < 64; i++) { /* within, at the faces and outside */
        shape_vec3 p = {(float)(grid->points[0] * (i % 4)) / 3, (float)(grid->points[1] * (i / 4 % 4)) / 3,
                        (float)(grid->points[2] * (i / 16)) / 3};
        float value = shape_grid_sample(grid, p);
        must(value >= 0 && value <= grid->most * 1.0001f);
    }
    must(shape_grid_sum(grid) > 0);
    must(bytes > HEADER);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    shape_error error = {0};
    shape_grid *grid = NULL;
    shape_status status = shape_volume_raw_decode("fuzz", data, size, MOST_BYTES, &grid, &error);
    if (status) {
        must(error.text[0] && !strchr(error.text, '\n'));
        return 0;
    }
    must(shape_volume_raw_is(data, size));
    check(grid, size);
    shape_grid_release(grid);
    return 0;
}

static void put_u32(uint8_t *to, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        to[i] = (uint8_t)(value >> 8 * i);
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed)
{
    size = LLVMFuzzerMutate(data, size, max_size);
    if (seed % 8 == 7 || size < HEADER + 4)
        return size;
    uint32_t values = (uint32_t)(size - HEADER) / 4, x = 1 + seed / 8 % 12, y = 1 + seed / 97 % 12;
    if (x * y > values)
        x = y = 1;
    put_u32(data, x);
    put_u32(data + 4, y);
    put_u32(data + 8, values / (x * y));
    return HEADER + 4 * (size_t)(values / (x * y)) * x * y;
}
