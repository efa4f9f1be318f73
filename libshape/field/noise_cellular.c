/* Worley's cellular noise (Worley 1996, "A cellular texture basis function"): the distance to the nearest of randomly
 * placed points, one a cell, of hashed, periodic cells. Mirrored by shaders/field/noise_cellular.glsl. */
#include <math.h>

#include "field/noise_hash.h"

static inline float unit(uint32_t bits)
{
    return (float)(bits >> 8) * 0x1p-24f;
}

float shape_noise_worley(shape_vec3 q, uint32_t key)
{
    float x = noise_guard(q.x), y = noise_guard(q.y), z = noise_guard(q.z);
    float wx = floorf(x), wy = floorf(y), wz = floorf(z);
    float fx = x - wx, fy = y - wy, fz = z - wz, least = 1;
    /* Points beyond the neighbours are more than a cell away, where the distance counts as 1. */
    for (int dz = -1; dz <= 1; dz++)
        for (int dy = -1; dy <= 1; dy++)
            for (int dx = -1; dx <= 1; dx++) {
                noise_bits bits = noise_hash((int)wx + dx, (int)wy + dy, (int)wz + dz, key);
                float ax = (float)dx + unit(bits.x) - fx, ay = (float)dy + unit(bits.y) - fy;
                float az = (float)dz + unit(bits.z) - fz, d2 = ax * ax + ay * ay + az * az;
                least = d2 < least ? d2 : least;
            }
    return sqrtf(least);
}

float shape_noise_worley_fbm(shape_vec3 q, int octaves, uint32_t key)
{
    float sum = 0, weight = 1, weights = 0;
    for (int i = 0; i < octaves; i++) {
        sum += weight * (1 - shape_noise_worley(q, key + (uint32_t)i));
        weights += weight;
        weight *= 0.5f;
        q = shape_vec3_scale(q, 2);
    }
    return sum / weights;
}
