/* Discrete ordinates on a regular grid: S4 level-symmetric directions (Carlson and Lathrop 1968), step (upwind)
 * differences, which never go negative, and source iteration. Scattering is taken to first order, 1 + 3 g cos. */
#include "light/ordinates.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/stop.h"

enum { OCTANTS = ORDINATES_OCTANTS, PER_OCTANT = ORDINATES_PER_OCTANT };

static const float low = 0.3500212f, high = 0.8688903f;

/* All lanes of a cell at once. */
typedef float lanes __attribute__((vector_size(ORDINATES_LANES * sizeof(float))));
typedef int32_t lanes_mask __attribute__((vector_size(ORDINATES_LANES * sizeof(int32_t))));

static inline lanes load(const float *from)
{
    lanes v;
    memcpy(&v, from, sizeof v);
    return v;
}

static inline void store(float *to, lanes v)
{
    memcpy(to, &v, sizeof v);
}

typedef struct direction {
    float omega[3];
    float kx, ky, kz; /* cells that it crosses a metre */
    lanes border;     /* what comes in from outside: a sky of 1 from above, or from below */
    float sun_factor; /* radiance of the sun's first collisions there, for an irradiance of 1 */
} direction;

void ordinates_direction(int number, float omega[3])
{
    int octant = number / PER_OCTANT, which = number % PER_OCTANT;
    for (int axis = 0; axis < 3; axis++)
        omega[axis] = (axis == which ? high : low) * (octant >> axis & 1 ? 1.0f : -1.0f);
}

static direction make_direction(const ordinates_problem *p, int octant, int which)
{
    const int number = octant * PER_OCTANT + which;
    direction d = {0};
    ordinates_direction(number, d.omega);
    float rise = d.omega[0] * p->up.x + d.omega[1] * p->up.y + d.omega[2] * p->up.z;
    float upper = rise < 0 ? 1.0f : 0.0f; /* what travels down came from above */
    float share = p->sky ? p->sky[number] : 1;
    d.border = (lanes){0, share * upper, share * (1 - upper), 0};
    d.kx = fabsf(d.omega[0]) / p->cell[0];
    d.ky = fabsf(d.omega[1]) / p->cell[1];
    d.kz = fabsf(d.omega[2]) / p->cell[2];
    float cosine = d.omega[0] * p->sun_travel.x + d.omega[1] * p->sun_travel.y + d.omega[2] * p->sun_travel.z;
    d.sun_factor = p->albedo * (1 + 3 * p->g * cosine) / (4 * 3.14159265f);
    return d;
}

/* What a cell has for all directions. */
typedef struct cell_state {
    lanes moments[ORDINATES_MOMENTS];
    float extinction, albedo, beam;
} cell_state;

/* The source function in one direction: scattered light, and the sun's first collisions. The two are cut at 0 together: cut
 * one by one they would make light, backwards of a forward peak. */
static inline lanes source(const ordinates_problem *p, const cell_state *c, const direction *d)
{
    const lanes sun = {d->sun_factor * c->beam, 0, 0, 0};
    lanes along = d->omega[0] * c->moments[1] + d->omega[1] * c->moments[2] + d->omega[2] * c->moments[3];
    lanes value = c->albedo * (c->moments[0] + 3 * p->g * along) + sun;
    return (lanes)((lanes_mask)value & (value > 0));
}

static inline cell_state read_cell(const ordinates_problem *p, size_t cell)
{
    float share = p->shares ? p->shares[cell] : 1;
    cell_state c = {
        .extinction = p->extinction[cell], .albedo = share * p->albedo, .beam = share * p->beam[cell]};
    for (int m = 0; m < ORDINATES_MOMENTS; m++)
        c.moments[m] = load(p->moments + cell * ORDINATES_CELL + m * ORDINATES_LANES);
    return c;
}

/* An octant's directions at one cell: in_x goes on to the next one, *plane holds what comes from the layer before and takes
 * what goes to the next; before: the row before. Writes the cell's sum. */
static inline void cross(const ordinates_problem *p, const direction d[PER_OCTANT], size_t cell,
                         lanes in_x[PER_OCTANT], const lanes *before, lanes *plane, bool first_row,
                         bool first_layer, float *sum)
{
    const float weight = 1.0f / (OCTANTS * PER_OCTANT);
    const cell_state c = read_cell(p, cell);
    lanes total[ORDINATES_MOMENTS] = {{0}};
    for (int i = 0; i < PER_OCTANT; i++) {
        lanes in_y = first_row ? d[i].border : before[i], in_z = first_layer ? d[i].border : plane[i];
        float scale = 1 / (d[i].kx + d[i].ky + d[i].kz + c.extinction);
        lanes out =
            (d[i].kx * in_x[i] + d[i].ky * in_y + d[i].kz * in_z + c.extinction * source(p, &c, &d[i])) *
            scale;
        in_x[i] = plane[i] = out;
        out *= weight;
        total[0] += out;
        for (int axis = 0; axis < 3; axis++)
            total[axis + 1] += out * d[i].omega[axis];
    }
    for (int m = 0; m < ORDINATES_MOMENTS; m++)
        store(sum + m * ORDINATES_LANES, total[m]);
}

/* An octant's directions through the grid, in the order in which their light travels; their share into `sum`. plane: of as
 * many cells as a layer has. */
static void sweep(const ordinates_problem *p, int octant, lanes *plane, float *sum)
{
    const int nx = p->size[0], ny = p->size[1], nz = p->size[2];
    direction d[PER_OCTANT];
    for (int i = 0; i < PER_OCTANT; i++)
        d[i] = make_direction(p, octant, i);
    int dx = octant & 1 ? 1 : -1, dy = octant & 2 ? 1 : -1, dz = octant & 4 ? 1 : -1;
    stop_watch watch = {.stop = p->stop};
    for (int k = 0; k < nz && !stop_after(&watch, (size_t)nx * (size_t)ny); k++) {
        int z = dz > 0 ? k : nz - 1 - k;
        for (int j = 0; j < ny; j++) {
            int y = dy > 0 ? j : ny - 1 - j;
            lanes in_x[PER_OCTANT];
            for (int i = 0; i < PER_OCTANT; i++)
                in_x[i] = d[i].border;
            for (int i = 0; i < nx; i++) {
                int x = dx > 0 ? i : nx - 1 - i;
                size_t cell = ((size_t)z * (size_t)ny + (size_t)y) * (size_t)nx + (size_t)x;
                lanes *here = plane + ((size_t)y * (size_t)nx + (size_t)x) * PER_OCTANT;
                const lanes *before = j ? here - dy * nx * PER_OCTANT : here;
                cross(p, d, cell, in_x, before, here, j == 0, k == 0, sum + cell * ORDINATES_CELL);
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
    shape_status status = SHAPE_OK;
    size_t cells = (size_t)p->size[0] * (size_t)p->size[1] * (size_t)p->size[2];
    const size_t layer = (size_t)p->size[0] * (size_t)p->size[1] * PER_OCTANT;
    /* Each octant sums into memory of its own and the sums are added in order: equal for any number of threads. */
    float *sums = malloc(OCTANTS * cells * ORDINATES_CELL * sizeof *sums);
    lanes *planes = malloc(OCTANTS * layer * sizeof *planes);
    if (!sums || !planes) {
        free(sums);
        free(planes);
        return shape_error_memory(error);
    }
    for (int round = 0; round < iterations; round++) {
#pragma omp parallel for schedule(dynamic) num_threads(threads)
        for (int octant = 0; octant < OCTANTS; octant++)
            sweep(p, octant, planes + (size_t)octant * layer, sums + (size_t)octant * cells * ORDINATES_CELL);
        stop_watch watch = {.stop = p->stop};
        if (stop_now(&watch)) {
            status = stop_error(error);
            break;
        }
        float change, peak;
        if (p->visits)
            *p->visits += cells;
        gather(p, sums, cells, threads, &change, &peak);
        /* Changes shrink like a geometric series; what is left of it is the error. */
        float ratio = last_change > 0 ? fminf(change / last_change, 0.99f) : 0.99f;
        if (change * ratio / (1 - ratio) <= tolerance * peak)
            break;
        last_change = change;
    }
    free(sums);
    free(planes);
    return status;
}
