/* Lattice noise and its fractal sum (Jiménez 2018 Eq. 1, section 3.1: a 64^3 cube of uniform noise, weights 1/2,
 * factor 2). Mirrored by shaders/field/noise.glsl. */
#include "shape/noise.h"

#include <stdlib.h>

#include "field/lattice.h"
#include "shape/random.h"

static uint16_t lattice_bits(int x, int y, int z)
{
    uint64_t index =
        (uint64_t)((x & LATTICE_MASK) +
                   SHAPE_NOISE_SIZE * ((y & LATTICE_MASK) + SHAPE_NOISE_SIZE * (z & LATTICE_MASK)));
    return (uint16_t)(shape_hash(index) >> 48);
}

float shape_noise_lattice(int x, int y, int z)
{
    return lattice_bits(x, y, z) * (1.0f / 65535.0f);
}

shape_status shape_noise_create(shape_noise **noise, shape_error *error)
{
    size_t cells = (size_t)SHAPE_NOISE_SIZE * SHAPE_NOISE_SIZE * SHAPE_NOISE_SIZE;
    shape_noise *made = malloc(sizeof *made);
    void *memory = NULL;
    if (!made || posix_memalign(&memory, 64, cells * 8 * sizeof(uint16_t))) {
        free(made);
        return shape_error_memory(error);
    }
    made->cells = memory;
    made->rows = malloc(cells / SHAPE_NOISE_SIZE * SHAPE_NOISE_ROW * sizeof(uint16_t));
    if (!made->rows) {
        shape_noise_destroy(made);
        return shape_error_memory(error);
    }
    uint16_t *row = made->rows;
    for (int z = 0; z < SHAPE_NOISE_SIZE; z++)
        for (int y = 0; y < SHAPE_NOISE_SIZE; y++)
            for (int x = 0; x < SHAPE_NOISE_ROW; x++)
                *row++ = lattice_bits(x, y, z);
    uint16_t *cell = made->cells;
    for (int z = 0; z < SHAPE_NOISE_SIZE; z++)
        for (int y = 0; y < SHAPE_NOISE_SIZE; y++)
            for (int x = 0; x < SHAPE_NOISE_SIZE; x++, cell += 8)
                for (int corner = 0; corner < 8; corner++)
                    cell[corner] = lattice_bits(x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2));
    *noise = made;
    return SHAPE_OK;
}

void shape_noise_destroy(shape_noise *noise)
{
    if (noise) {
        free(noise->cells);
        free(noise->rows);
    }
    free(noise);
}

void shape_noise_offsets(uint64_t seed, int octaves, int offsets[][3])
{
    for (int i = 0; i < octaves; i++) {
        uint64_t bits = shape_hash(shape_hash(seed) + (uint64_t)i);
        for (int axis = 0; axis < 3; axis++)
            offsets[i][axis] = (int)(bits >> (8 * axis)) & LATTICE_MASK;
    }
}

float shape_noise_value(const shape_noise *noise, shape_vec3 q)
{
    return lattice_trilinear(
        noise, shape_vec3_make(lattice_guard(q.x), lattice_guard(q.y), lattice_guard(q.z)), 0, 0, 0);
}

float shape_noise_fbm(const shape_noise *noise, const int offsets[][3], int octaves, shape_vec3 q)
{
    float sum = 0, weight = 0.5f;
    for (int i = 0; i < octaves; i++) {
        q = shape_vec3_make(lattice_guard(q.x), lattice_guard(q.y), lattice_guard(q.z));
        sum += weight * lattice_trilinear(noise, q, offsets[i][0], offsets[i][1], offsets[i][2]);
        q = shape_vec3_scale(q, 2);
        weight *= 0.5f;
    }
    return sum;
}
