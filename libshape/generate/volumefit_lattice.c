/* The volume fit's view of a volume: extinction in cubic cells, its solid part, and distances within. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "generate/volumefit_private.h"

enum { MARGIN = 2 }; /* empty cells round the volume */

static shape_status lay_out(const shape_volume *volume, int resolution, fit_lattice *lattice,
                            shape_error *error)
{
    shape_dvec3 low = {INFINITY, INFINITY, INFINITY}, high = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < volume->cloud_count; i++) {
        shape_dvec3 a, b;
        if (shape_box_is_empty(volume->clouds[i].box))
            continue;
        shape_frame_box(&volume->clouds[i].frame, volume->clouds[i].box, &a, &b);
        low = shape_dvec3_make(fmin(low.x, a.x), fmin(low.y, a.y), fmin(low.z, a.z));
        high = shape_dvec3_make(fmax(high.x, b.x), fmax(high.y, b.y), fmax(high.z, b.z));
    }
    shape_dvec3 side = shape_dvec3_sub(high, low);
    double longest = fmax(side.x, fmax(side.y, side.z));
    if (!(longest > 0) || !isfinite(longest))
        return shape_error_set(error, SHAPE_ERROR_FORMAT, "there is no density to fit anything to");
    lattice->cell = longest / (resolution - 2 * MARGIN);
    lattice->middle = shape_dvec3_scale(shape_dvec3_add(low, high), 0.5);
    lattice->count = 1;
    for (int a = 0; a < 3; a++) {
        lattice->n[a] = (int)ceil((&side.x)[a] / lattice->cell * (1 - 1e-9)) + 2 * MARGIN;
        lattice->count *= (size_t)lattice->n[a];
    }
    lattice->extinction = malloc(lattice->count * sizeof *lattice->extinction);
    lattice->target = malloc(lattice->count * sizeof *lattice->target);
    lattice->depth = malloc(lattice->count * sizeof *lattice->depth);
    lattice->solid = malloc(lattice->count);
    if (!lattice->extinction || !lattice->target || !lattice->depth || !lattice->solid)
        return shape_error_memory(error);
    return SHAPE_OK;
}

/* The mean of eight places in each cell. */
static void sample(const shape_volume *volume, fit_lattice *lattice)
{
    const int *n = lattice->n;
#pragma omp parallel for schedule(dynamic, 1)
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++)
            for (int x = 0; x < n[0]; x++) {
                double sum = 0;
                for (int k = 0; k < 8; k++) {
                    double at[3] = {x + (k & 1 ? 0.75 : 0.25), y + (k & 2 ? 0.75 : 0.25),
                                    z + (k & 4 ? 0.75 : 0.25)};
                    shape_dvec3 p = lattice->middle;
                    for (int a = 0; a < 3; a++)
                        (&p.x)[a] += (at[a] - 0.5 * n[a]) * lattice->cell;
                    sum += shape_volume_extinction(volume, p);
                }
                lattice->extinction[((size_t)z * (size_t)n[1] + (size_t)y) * (size_t)n[0] + (size_t)x] =
                    (float)(sum / 8);
            }
}

/* Two levels, 0 and the one that leaves the least squared error: it is the mean of what lies above its half. */
static double find_level(const fit_lattice *lattice)
{
    double level = 0;
    for (size_t i = 0; i < lattice->count; i++) {
        double value =
            (double)lattice->extinction[i]; /* not fmax: gcc 12 for arm64 breaks on it here, at -O3 */
        level = value > level ? value : level;
    }
    for (int round = 0; round < 50; round++) {
        double sum = 0, count = 0;
        for (size_t i = 0; i < lattice->count; i++)
            if ((double)lattice->extinction[i] > level / 2) {
                sum += (double)lattice->extinction[i];
                count++;
            }
        if (!(count > 0) || fabs(sum / count - level) <= 1e-6 * level)
            break;
        level = sum / count;
    }
    return level;
}

shape_status fit_lattice_make(const shape_volume *volume, int resolution, fit_lattice *lattice,
                              shape_error *error)
{
    memset(lattice, 0, sizeof *lattice);
    shape_status status = lay_out(volume, resolution, lattice, error);
    if (status)
        return status;
    sample(volume, lattice);
    lattice->level = find_level(lattice);
    if (!(lattice->level > 0))
        return shape_error_set(error, SHAPE_ERROR_FORMAT, "there is no density to fit anything to");
    for (size_t i = 0; i < lattice->count; i++) {
        double share = (double)lattice->extinction[i] / lattice->level;
        lattice->target[i] = (float)(share < 1 ? share : 1);
        lattice->solid[i] = share > 0.5;
    }
    return fit_distances(lattice->n, lattice->solid, lattice->depth, error);
}

void fit_lattice_free(fit_lattice *lattice)
{
    free(lattice->extinction);
    free(lattice->target);
    free(lattice->solid);
    free(lattice->depth);
    memset(lattice, 0, sizeof *lattice);
}

/* The lower envelope of parabolas along one row; values are squared distances, `stride` apart. */
typedef struct envelope {
    float *values, *edges;
    int *roots;
} envelope;

static void distances_of_row(float *row, size_t stride, int n, const envelope *e)
{
    int last = 0;
    for (int i = 0; i < n; i++)
        e->values[i] = row[(size_t)i * stride];
    e->roots[0] = 0;
    e->edges[0] = -INFINITY;
    e->edges[1] = INFINITY;
    for (int i = 1; i < n; i++) {
        float cross;
        for (;;) {
            int r = e->roots[last];
            cross =
                ((e->values[i] + (float)(i * i)) - (e->values[r] + (float)(r * r))) / (float)(2 * (i - r));
            if (last == 0 || cross > e->edges[last])
                break;
            last--;
        }
        if (last == 0 && !(cross > e->edges[0]))
            cross = -INFINITY;
        last++;
        e->roots[last] = i;
        e->edges[last] = cross;
        e->edges[last + 1] = INFINITY;
    }
    for (int i = 0, k = 0; i < n; i++) {
        while (e->edges[k + 1] < (float)i)
            k++;
        int r = e->roots[k]; /* NOLINT: the loop above has set all up to `last`, whose edge is infinite */
        row[(size_t)i * stride] = (float)((i - r) * (i - r)) + e->values[r];
    }
}

shape_status fit_distances(const int n[3], const uint8_t *marks, float *distance, shape_error *error)
{
    const float far = 1e6f; /* squares of it and sums stay exact enough to be farther than anything */
    size_t strides[3] = {1, (size_t)n[0], (size_t)n[0] * (size_t)n[1]}, count = strides[2] * (size_t)n[2];
    int longest = n[0] > n[1] ? n[0] : n[1];
    longest = longest > n[2] ? longest : n[2];
    size_t room = (size_t)longest + 2;
    float *floats = malloc(2 * room * sizeof *floats);
    int *roots = malloc(room * sizeof *roots);
    if (!floats || !roots) {
        free(floats);
        free(roots);
        return shape_error_memory(error);
    }
    envelope e = {floats, floats + room, roots};
    for (size_t i = 0; i < count; i++)
        distance[i] = marks[i] ? far : 0;
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, c = (a + 2) % 3;
        for (int j = 0; j < n[b]; j++)
            for (int k = 0; k < n[c]; k++)
                distances_of_row(distance + (size_t)j * strides[b] + (size_t)k * strides[c], strides[a], n[a],
                                 &e);
    }
    for (size_t i = 0; i < count; i++)
        distance[i] = sqrtf(distance[i]);
    free(floats);
    free(roots);
    return SHAPE_OK;
}
