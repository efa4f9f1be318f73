/* The noises of the density fields: a lattice of 64^3 random values, trilinear between them; Perlin's; Worley's; each
 * summed over octaves. */
#ifndef SHAPE_NOISE_H
#define SHAPE_NOISE_H

#include <stddef.h>
#include <stdint.h>

#include "shape/status.h"
#include "shape/vector.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { SHAPE_NOISE_SIZE = 64, SHAPE_OCTAVES_MAX = 16 };
/* A row of 64 values, the first again, and one unused: no look-up across the seam. */
enum { SHAPE_NOISE_ROW = SHAPE_NOISE_SIZE + 2 };

/* The one lattice that every seed reads, each at places of its own (shape_noise_offsets). cells holds, for each cell
 * (x fastest, then y, z), the values of its eight corners as 16-bit numbers, corner number x + 2 y + 4 z, so that one
 * 16-byte load (one RGBA32UI texel) serves a trilinear look-up. A value v stands for v / 65535. 4 MiB. */
typedef struct shape_noise {
    uint16_t *cells; /* [64][64][64][8] */
    uint16_t *rows;  /* the plain lattice for the processor's caches: [64][64][SHAPE_NOISE_ROW], z, y, x */
} shape_noise;

/* Makes the lattice. The caller destroys it. Thread-safe once made. */
shape_status shape_noise_create(shape_noise **noise, shape_error *error);
void shape_noise_destroy(shape_noise *noise); /* NULL is allowed */
/* The lattice value at whole coordinates, 0 to 1; the lattice repeats every 64. */
float shape_noise_lattice(int x, int y, int z);

/* Where octave i of a seed's noise begins: whole lattice steps 0 to 63 a axis. Octaves read far-apart places, so that
 * they do not agree at the origin as the plain sum of scaled copies does. */
void shape_noise_offsets(uint64_t seed, int octaves, int offsets[][3]);

/* Trilinear value at q [lattice cells], 0 to 1. */
float shape_noise_value(const shape_noise *noise, shape_vec3 q);

/* fBm (Jiménez 2018 Eq. 1 with w = 1/2, s = 2): the sum over i = 1..octaves of 2^-i value(2^(i-1) q + offset_i).
 * 0 to 1 - 2^-octaves, mean (1 - 2^-octaves) / 2. q = p / noise_scale. */
float shape_noise_fbm(const shape_noise *noise, const int offsets[][3], int octaves, shape_vec3 q);

/* --- Noises of an integer hash (noise_gradient.c, noise_cellular.c); they need no table. q is in cells, any number; each
 * repeats every SHAPE_NOISE_PERIOD cells along every axis, without a seam. `key` tells independent noises apart; octave
 * i of a sum takes key + i. --- */

enum { SHAPE_NOISE_PERIOD = 1024 };

/* The key that belongs to a seed and a use of it (0 a layer's Perlin, 1 Worley, 2 displacement, 3 billow and wisp). */
uint32_t shape_noise_key(uint64_t seed, uint32_t use);

/* Gradient noise (Perlin 2002): -1 to 1, 0 at whole coordinates, mean 0. */
float shape_noise_perlin(shape_vec3 q, uint32_t key);
/* Three of them at once, with gradients of their own, from the same hashes. */
shape_vec3 shape_noise_perlin3(shape_vec3 q, uint32_t key);
/* Sum over i = 0..octaves-1 of 2^-i perlin(2^i q), divided by the sum of the weights: -1 to 1, mean 0. */
float shape_noise_perlin_fbm(shape_vec3 q, int octaves, uint32_t key);
shape_vec3 shape_noise_perlin3_fbm(shape_vec3 q, int octaves, uint32_t key);

/* The distance F1 to the nearest of the feature points, one a cell at a uniform place (Worley 1996), in cells; distances
 * above 1 give 1. 0 to 1. */
float shape_noise_worley(shape_vec3 q, uint32_t key);
/* The same sum of 1 - F1: 0 to 1, 1 at the feature points. */
float shape_noise_worley_fbm(shape_vec3 q, int octaves, uint32_t key);

#ifdef __cplusplus
}
#endif
#endif
