/* Perlin's gradient noise (Perlin 2002, "Improving noise": the quintic fade, twelve gradients) on hashed, periodic
 * cells. Mirrored by shaders/field/noise_gradient.glsl. */
#include <math.h>

#include "field/noise_hash.h"
#include "shape/random.h"

uint32_t shape_noise_key(uint64_t seed, uint32_t use)
{
    return (uint32_t)(shape_hash(shape_hash(seed) + 0x100u + use) >> 32);
}

/* A cell corner, and the three fractions. */
typedef struct cell {
    int x, y, z;
    float fx, fy, fz;
} cell;

static inline cell find_cell(shape_vec3 q)
{
    float x = noise_guard(q.x), y = noise_guard(q.y), z = noise_guard(q.z);
    float wx = floorf(x), wy = floorf(y), wz = floorf(z);
    cell c = {(int)wx, (int)wy, (int)wz, x - wx, y - wy, z - wz};
    return c;
}

/* The dot product with one of the directions to the middles of a cube's edges; four of the sixteen come twice. */
static inline float gradient(uint32_t bits, float x, float y, float z)
{
    uint32_t h = bits >> 28;
    float u = h < 8 ? x : y, v = h < 4 ? y : h == 12 || h == 14 ? x : z;
    return (h & 1 ? -u : u) + (h & 2 ? -v : v);
}

static inline float fade(float t)
{
    return t * t * t * (t * (t * 6 - 15) + 10);
}

static inline float mix(float a, float b, float t)
{
    return a + t * (b - a);
}

/* Between the eight corners' values, corner number x + 2 y + 4 z. */
static float between(const float v[8], cell c)
{
    float x = fade(c.fx), y = fade(c.fy), z = fade(c.fz);
    float value = mix(mix(mix(v[0], v[1], x), mix(v[2], v[3], x), y),
                      mix(mix(v[4], v[5], x), mix(v[6], v[7], x), y), z);
    return value < -1 ? -1 : value > 1 ? 1 : value;
}

float shape_noise_perlin(shape_vec3 q, uint32_t key)
{
    cell c = find_cell(q);
    float corner[8];
    for (int i = 0; i < 8; i++) {
        int x = i & 1, y = i >> 1 & 1, z = i >> 2;
        noise_bits bits = noise_hash(c.x + x, c.y + y, c.z + z, key);
        corner[i] = gradient(bits.x, c.fx - (float)x, c.fy - (float)y, c.fz - (float)z);
    }
    return between(corner, c);
}

shape_vec3 shape_noise_perlin3(shape_vec3 q, uint32_t key)
{
    cell c = find_cell(q);
    float corner[3][8];
    for (int i = 0; i < 8; i++) {
        int x = i & 1, y = i >> 1 & 1, z = i >> 2;
        noise_bits bits = noise_hash(c.x + x, c.y + y, c.z + z, key);
        float dx = c.fx - (float)x, dy = c.fy - (float)y, dz = c.fz - (float)z;
        corner[0][i] = gradient(bits.x, dx, dy, dz);
        corner[1][i] = gradient(bits.y, dx, dy, dz);
        corner[2][i] = gradient(bits.z, dx, dy, dz);
    }
    return shape_vec3_make(between(corner[0], c), between(corner[1], c), between(corner[2], c));
}

float shape_noise_perlin_fbm(shape_vec3 q, int octaves, uint32_t key)
{
    float sum = 0, weight = 1, weights = 0;
    for (int i = 0; i < octaves; i++) {
        sum += weight * shape_noise_perlin(q, key + (uint32_t)i);
        weights += weight;
        weight *= 0.5f;
        q = shape_vec3_scale(q, 2);
    }
    return sum / weights;
}

shape_vec3 shape_noise_perlin3_fbm(shape_vec3 q, int octaves, uint32_t key)
{
    shape_vec3 sum = {0, 0, 0};
    float weight = 1, weights = 0;
    for (int i = 0; i < octaves; i++) {
        sum = shape_vec3_add(sum, shape_vec3_scale(shape_noise_perlin3(q, key + (uint32_t)i), weight));
        weights += weight;
        weight *= 0.5f;
        q = shape_vec3_scale(q, 2);
    }
    return shape_vec3_scale(sum, 1 / weights);
}
