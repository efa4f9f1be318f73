/* Private: the look-up in the noise lattice, for loops that cannot afford a call an octave. */
#ifndef SHAPE_FIELD_LATTICE_H
#define SHAPE_FIELD_LATTICE_H

#include "shape/noise.h"

enum { LATTICE_MASK = SHAPE_NOISE_SIZE - 1 };

/* The whole number at or below x, |x| < 2^31, without a call to libm. */
static inline int lattice_floor(float x)
{
    int i = (int)x;
    return i - ((float)i > x);
}

/* From the rows, which fit a second-level cache where the cells do not. */
static inline float lattice_trilinear(const shape_noise *noise, shape_vec3 q, int ox, int oy, int oz)
{
    int ix = lattice_floor(q.x), iy = lattice_floor(q.y), iz = lattice_floor(q.z);
    int x = (ix + ox) & LATTICE_MASK, y = (iy + oy) & LATTICE_MASK, z = (iz + oz) & LATTICE_MASK;
    int y1 = (y + 1) & LATTICE_MASK, z1 = (z + 1) & LATTICE_MASK;
    float ax = q.x - (float)ix, ay = q.y - (float)iy, az = q.z - (float)iz;
    const uint16_t *near = noise->rows + x, *a = near + SHAPE_NOISE_ROW * (y + SHAPE_NOISE_SIZE * z);
    const uint16_t *b = near + SHAPE_NOISE_ROW * (y1 + SHAPE_NOISE_SIZE * z);
    const uint16_t *c = near + SHAPE_NOISE_ROW * (y + SHAPE_NOISE_SIZE * z1);
    const uint16_t *d = near + SHAPE_NOISE_ROW * (y1 + SHAPE_NOISE_SIZE * z1);
    float x00 = (float)a[0] + ax * (float)(a[1] - a[0]), x10 = (float)b[0] + ax * (float)(b[1] - b[0]);
    float x01 = (float)c[0] + ax * (float)(c[1] - c[0]), x11 = (float)d[0] + ax * (float)(d[1] - d[0]);
    float z00 = x00 + ay * (x10 - x00), z01 = x01 + ay * (x11 - x01);
    return (z00 + az * (z01 - z00)) * (1.0f / 65535.0f);
}

/* Beyond a million cells a float has no fraction worth the name, and beyond 2^31 no int: there the noise is constant. */
static inline float lattice_guard(float x)
{
    return fabsf(x) < 1e8f ? x : 0.0f;
}

#endif
