/* Discrete ordinates on a regular grid: S4 level-symmetric directions (Carlson and Lathrop 1968), step (upwind)
 * differences, which never go negative, and source iteration. Scattering is taken to first order, 1 + 3 g cos. */
#include "light/ordinates.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { OCTANTS = 8, PER_OCTANT = 3 };

static const float low = 0.3500212f, high = 0.8688903f;

typedef struct direction {
    float omega[3];
    float upper, lower; /* radiance that comes in from the sky: 1 from above, 1 from below */
} direction;

static direction make_direction(const ordinates_problem *p, int octant, int which)
{
    direction d;
    for (int axis = 0; axis < 3; axis++)
        d.omega[axis] = (axis == which ? high : low) * (octant >> axis & 1 ? 1.0f : -1.0f);
    float rise = d.omega[0] * p->up.x + d.omega[1] * p->up.y + d.omega[2] * p->up.z;
    d.upper = rise < 0 ? 1.0f : 0.0f; /* what travels down came from above */
    d.lower = 1 - d.upper;
    return d;
}

/* The source function of all lanes in one direction: scattered light, and the sun's first collisions. The two are cut
 * at 0 together: cut one by one they would make light, backwards of a forward peak. */
static inline void source(const ordinates_problem *p, const float *moments, float share, float beam,
                          const direction *d, float sun_factor, float out[ORDINATES_LANES])
{
    const float sun[ORDINATES_LANES] = {sun_factor * (share * beam), 0, 0, 0}, albedo = share * p->albedo;
    for (int lane = 0; lane < ORDINATES_LANES; lane++) {
        float along = d->omega[0] * moments[ORDINATES_LANES + lane] +
                      d->omega[1] * moments[2 * ORDINATES_LANES + lane] +
                      d->omega[2] * moments[3 * ORDINATES_LANES + lane];
        float value = albedo * (moments[lane] + 3 * p->g * along) + sun[lane];
        out[lane] = value > 0 ? value : 0;
    }
}

/* One direction through the grid, in the order in which light travels; adds its share to `sum`. */
static void sweep(const ordinates_problem *p, const direction *d, float *radiance, float *sum)
{
    const int nx = p->size[0], ny = p->size[1], nz = p->size[2];
    const float weight = 1.0f / (OCTANTS * PER_OCTANT);
    float cosine =
        d->omega[0] * p->sun_travel.x + d->omega[1] * p->sun_travel.y + d->omega[2] * p->sun_travel.z;
    float sun_factor = p->albedo * (1 + 3 * p->g * cosine) / (4 * 3.14159265f);
    float kx = fabsf(d->omega[0]) / p->cell[0], ky = fabsf(d->omega[1]) / p->cell[1],
          kz = fabsf(d->omega[2]) / p->cell[2];
    const float border[ORDINATES_LANES] = {0, d->upper, d->lower, 0};
    int dx = d->omega[0] > 0 ? 1 : -1, dy = d->omega[1] > 0 ? 1 : -1, dz = d->omega[2] > 0 ? 1 : -1;
    for (int k = 0; k < nz; k++) {
        int z = dz > 0 ? k : nz - 1 - k;
        for (int j = 0; j < ny; j++) {
            int y = dy > 0 ? j : ny - 1 - j;
            size_t row = ((size_t)z * ny + y) * nx;
            const float *from_y = j ? radiance + (row - (size_t)(dy * nx)) * ORDINATES_LANES : NULL;
            const float *from_z = k ? radiance + (row - (size_t)(dz * nx * ny)) * ORDINATES_LANES : NULL;
            float in_x[ORDINATES_LANES];
            memcpy(in_x, border, sizeof in_x);
            for (int i = 0; i < nx; i++) {
                int x = dx > 0 ? i : nx - 1 - i;
                size_t cell = row + (size_t)x;
                const float *in_y = from_y ? from_y + (size_t)x * ORDINATES_LANES : border;
                const float *in_z = from_z ? from_z + (size_t)x * ORDINATES_LANES : border;
                float *out = radiance + cell * ORDINATES_LANES, *add = sum + cell * ORDINATES_CELL;
                float sigma = p->extinction[cell], scale = 1 / (kx + ky + kz + sigma), s[ORDINATES_LANES];
                source(p, p->moments + cell * ORDINATES_CELL, p->shares ? p->shares[cell] : 1, p->beam[cell],
                       d, sun_factor, s);
                for (int lane = 0; lane < ORDINATES_LANES; lane++) {
                    float value =
                        (kx * in_x[lane] + ky * in_y[lane] + kz * in_z[lane] + sigma * s[lane]) * scale;
                    in_x[lane] = out[lane] = value;
                    value *= weight;
                    add[lane] += value;
                    add[ORDINATES_LANES + lane] += value * d->omega[0];
                    add[2 * ORDINATES_LANES + lane] += value * d->omega[1];
                    add[3 * ORDINATES_LANES + lane] += value * d->omega[2];
                }
            }
        }
    }
}

/* Adds the octants' sums in order; the largest change of a mean radiance, and the largest mean radiance. */
static void gather(const ordinates_problem *p, const float *sums, size_t cells, int threads, float *change,
                   float *peak)
{
    float most_change = 0, most = 0;
#pragma omp parallel for num_threads(threads) reduction(max : most_change, most)
    for (size_t i = 0; i < cells * ORDINATES_CELL; i++) {
        float total = 0;
        for (int octant = 0; octant < OCTANTS; octant++)
            total += sums[(size_t)octant * cells * ORDINATES_CELL + i];
        if (i % ORDINATES_CELL < ORDINATES_LANES) {
            most_change = fmaxf(most_change, fabsf(total - p->moments[i]));
            most = fmaxf(most, total);
        }
        p->moments[i] = total;
    }
    *change = most_change;
    *peak = most;
}

shape_status ordinates_solve(const ordinates_problem *p, int iterations, float tolerance, int threads,
                             shape_error *error)
{
    float last_change = 0;
    size_t cells = (size_t)p->size[0] * (size_t)p->size[1] * (size_t)p->size[2];
    /* Each octant sums into memory of its own and the sums are added in order: equal for any number of threads. */
    float *sums = malloc(OCTANTS * cells * ORDINATES_CELL * sizeof *sums);
    float *radiance = malloc(OCTANTS * cells * ORDINATES_LANES * sizeof *radiance);
    if (!sums || !radiance) {
        free(sums);
        free(radiance);
        return shape_error_memory(error);
    }
    for (int round = 0; round < iterations; round++) {
#pragma omp parallel for schedule(dynamic) num_threads(threads)
        for (int octant = 0; octant < OCTANTS; octant++) {
            float *sum = sums + (size_t)octant * cells * ORDINATES_CELL;
            memset(sum, 0, cells * ORDINATES_CELL * sizeof *sum);
            for (int which = 0; which < PER_OCTANT; which++) {
                direction d = make_direction(p, octant, which);
                sweep(p, &d, radiance + (size_t)octant * cells * ORDINATES_LANES, sum);
            }
        }
        float change, peak;
        gather(p, sums, cells, threads, &change, &peak);
        /* Changes shrink like a geometric series; what is left of it is the error. */
        float ratio = last_change > 0 ? fminf(change / last_change, 0.99f) : 0.99f;
        if (change * ratio / (1 - ratio) <= tolerance * peak)
            break;
        last_change = change;
    }
    free(sums);
    free(radiance);
    return SHAPE_OK;
}
