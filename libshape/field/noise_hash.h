/* Private: the integer hash under Perlin's and Worley's noise, pcg3d (Jarzynski and Olano 2020, "Hash functions for GPU
 * rendering"): three numbers of 32 bits from three. Mirrored by shaders/field/noise_gradient.glsl. */
#ifndef SHAPE_FIELD_NOISE_HASH_H
#define SHAPE_FIELD_NOISE_HASH_H

#include <stdint.h>

#include "shape/noise.h"

typedef struct noise_bits {
    uint32_t x, y, z;
} noise_bits;

/* The hash of a cell, whose coordinates count modulo the period. */
static inline noise_bits noise_hash(int x, int y, int z, uint32_t key)
{
    const uint32_t mask = SHAPE_NOISE_PERIOD - 1;
    noise_bits v = {((uint32_t)x & mask) + key, ((uint32_t)y & mask) + key * 0x9e3779b1u,
                    ((uint32_t)z & mask) + key * 0x85ebca77u};
    v.x = v.x * 1664525u + 1013904223u;
    v.y = v.y * 1664525u + 1013904223u;
    v.z = v.z * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.x ^= v.x >> 16;
    v.y ^= v.y >> 16;
    v.z ^= v.z >> 16;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return v;
}

/* Beyond this a float has no fraction worth the name, and soon no int: there the noise is constant. */
static inline float noise_guard(float x)
{
    return x > -1e8f && x < 1e8f ? x : 0.0f;
}

#endif
