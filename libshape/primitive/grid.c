/* Voxel grids: bricks, samples, ranges (shape/grid.h). */
#include "shape/grid.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "primitive/grid_look.h"

enum { BRICK = SHAPE_GRID_BRICK, SIDE = SHAPE_GRID_SIDE, POINTS = SHAPE_GRID_BRICK_POINTS };

/* --- making --- */

static size_t table_size(const shape_grid *grid)
{
    return (size_t)grid->bricks[0] * (size_t)grid->bricks[1] * (size_t)grid->bricks[2];
}

static void brick_place(const shape_grid *grid, size_t index, int low[3])
{
    size_t nx = (size_t)grid->bricks[0], ny = (size_t)grid->bricks[1];
    low[0] = (int)(index % nx) * BRICK;
    low[1] = (int)(index / nx % ny) * BRICK;
    low[2] = (int)(index / nx / ny) * BRICK;
}

static shape_status too_large(double bytes, size_t max_bytes, const int points[3], shape_error *error)
{
    return shape_error_set(error, SHAPE_ERROR_LIMIT,
                           "a grid of %d x %d x %d voxels takes %.4g bytes, more than the %zu allowed "
                           "(--max-memory allows more)",
                           points[0], points[1], points[2], bytes, max_bytes);
}

/* Lays out the table; then counts the bricks, so that memory is known before it is taken. */
static shape_status lay_out(shape_grid *grid, const shape_grid_source *source, size_t max_bytes,
                            shape_error *error)
{
    const double brick_bytes = POINTS * sizeof(float) + 2 * sizeof(float) + sizeof *grid->filled;
    double cells = 1;
    for (int a = 0; a < 3; a++) {
        if (source->points[a] < 2 || source->points[a] > SHAPE_GRID_MAX_SIDE)
            return shape_error_set(
                error, SHAPE_ERROR_LIMIT, "a grid of %d x %d x %d points (each side must have 2 to %d)",
                source->points[0], source->points[1], source->points[2], SHAPE_GRID_MAX_SIDE);
        grid->points[a] = source->points[a];
        grid->bricks[a] = (source->points[a] - 1 + BRICK - 1) / BRICK;
        cells *= grid->bricks[a];
    }
    double bytes = cells * sizeof *grid->table;
    if (bytes > (double)max_bytes)
        return too_large(bytes, max_bytes, source->points, error);
    size_t count = 1, total = (size_t)cells;
    for (size_t i = 0; i < total; i++) {
        int low[3];
        brick_place(grid, i, low);
        count += source->brick(source->context, low, NULL);
    }
    bytes += (double)count * brick_bytes;
    if (bytes > (double)max_bytes || count > UINT32_MAX)
        return too_large(bytes, max_bytes, source->points, error);
    grid->table = calloc(total, sizeof *grid->table); /* NOLINT: every side has a brick at least */
    grid->values = malloc(count * POINTS * sizeof *grid->values);
    grid->low = calloc(count, sizeof *grid->low);
    grid->high = calloc(count, sizeof *grid->high);
    grid->filled = calloc(count, sizeof *grid->filled);
    if (!grid->table || !grid->values || !grid->low || !grid->high || !grid->filled)
        return shape_error_memory(error);
    memset(grid->values, 0, POINTS * sizeof *grid->values);
    grid->brick_count = 1;
    return SHAPE_OK;
}

/* The brick just filled, behind the last: its range. False where a value is not finite. */
static bool measure(float *values, float *low, float *high)
{
    float least = INFINITY, most = 0;
    int wrong = 0;
#pragma omp simd reduction(min : least) reduction(max : most) reduction(| : wrong)
    for (int i = 0; i < POINTS; i++) {
        float value = values[i];
        wrong |= !(fabsf(value) <= FLT_MAX);
        value = value > 0 ? value : 0;
        values[i] = value;
        least = value < least ? value : least;
        most = value > most ? value : most;
    }
    *low = least;
    *high = most;
    return !wrong;
}

/* Which parts touch a point that is not 0. A point belongs to one part along an axis, or as their common face to two. */
static uint64_t find_filled(const float *values)
{
    static const unsigned parts[SIDE] = {1, 1, 3, 2, 6, 4, 12, 8, 8};
    uint64_t filled = 0;
    for (unsigned z = 0; z < SIDE; z++)
        for (unsigned y = 0; y < SIDE; y++) {
            uint64_t row = 0, plane = 0;
            for (unsigned x = 0; x < SIDE; x++)
                row |= values[(z * SIDE + y) * SIDE + x] > 0 ? parts[x] : 0;
            for (unsigned part = 0; part < 4; part++)
                plane |= parts[y] >> part & 1 ? row << 4 * part : 0;
            for (unsigned part = 0; part < 4 && plane; part++)
                filled |= parts[z] >> part & 1 ? plane << 16 * part : 0;
        }
    return filled;
}

static shape_status fill(shape_grid *grid, const shape_grid_source *source, shape_error *error)
{
    size_t total = table_size(grid), even = 0; /* even: the last brick of one value */
    for (size_t i = 0; i < total; i++) {
        int low[3];
        size_t next = grid->brick_count;
        brick_place(grid, i, low);
        if (!source->brick(source->context, low, NULL))
            continue;
        float *values = grid->values + next * POINTS;
        if (!source->brick(source->context, low, values))
            continue;
        if (!measure(values, &grid->low[next], &grid->high[next]))
            return shape_error_set(error, SHAPE_ERROR_FORMAT,
                                   "the grid holds values that are not finite, near voxel %d,%d,%d (mend it "
                                   "where it was made)",
                                   low[0], low[1], low[2]);
        float most = grid->high[next];
        if (!(most > 0))
            continue;
        if (grid->low[next] == most) {
            if (even && grid->high[even] == most) {
                grid->table[i] = (uint32_t)even;
                continue;
            }
            even = next;
        }
        grid->filled[next] = find_filled(values);
        grid->most = most > grid->most ? most : grid->most;
        grid->table[i] = (uint32_t)next;
        grid->brick_count++;
    }
    return grid->most > 0
               ? SHAPE_OK
               : shape_error_set(error, SHAPE_ERROR_FORMAT, "the grid is empty: no density at all");
}

/* What the count took too much of is given back. */
static void trim(shape_grid *grid)
{
    float *values = realloc(grid->values, grid->brick_count * POINTS * sizeof *values);
    if (values)
        grid->values = values;
}

shape_status shape_grid_create(const shape_grid_source *source, size_t max_bytes, shape_grid **grid,
                               shape_error *error)
{
    shape_grid *made = calloc(1, sizeof *made);
    if (!made)
        return shape_error_memory(error);
    made->gain = 1;
    made->users = 1;
    shape_status status = lay_out(made, source, max_bytes, error);
    if (!status)
        status = fill(made, source, error);
    if (status) {
        shape_grid_release(made);
        return status;
    }
    trim(made);
    *grid = made;
    return SHAPE_OK;
}

void shape_grid_keep(shape_grid *grid)
{
    if (grid)
        __atomic_add_fetch(&grid->users, 1, __ATOMIC_RELAXED);
}

void shape_grid_release(shape_grid *grid)
{
    if (!grid || __atomic_sub_fetch(&grid->users, 1, __ATOMIC_ACQ_REL))
        return;
    for (int c = 0; c < 3; c++)
        shape_grid_release(grid->colour[c]);
    free(grid->table);
    free(grid->values);
    free(grid->low);
    free(grid->high);
    free(grid->filled);
    free(grid);
}

size_t shape_grid_bytes(const shape_grid *grid)
{
    return sizeof *grid + table_size(grid) * sizeof *grid->table +
           grid->brick_count * (POINTS * sizeof *grid->values + sizeof *grid->low + sizeof *grid->high);
}

/* --- looking --- */

float shape_grid_sample(const shape_grid *grid, shape_vec3 p)
{
    return grid_look(grid, p.x, p.y, p.z);
}

void shape_grid_colour(const shape_grid *grid, shape_vec3 p, float rgb[3])
{
    for (int c = 0; c < 3; c++)
        rgb[c] = !grid->coloured ? 1 : grid->colour[c] ? shape_grid_sample(grid->colour[c], p) : 0;
}

/* The range over the points [low, high] of one brick, relative to its first. */
static void points_range(const float *values, const int low[3], const int high[3], float *least, float *most)
{
    for (int z = low[2]; z <= high[2]; z++)
        for (int y = low[1]; y <= high[1]; y++)
            for (int x = low[0]; x <= high[0]; x++) {
                float v = values[(z * SIDE + y) * SIDE + x];
                *least = v < *least ? v : *least;
                *most = v > *most ? v : *most;
            }
}

static void brick_range(const shape_grid *grid, const int at[3], const int from[3], const int to[3],
                        float *least, float *most)
{
    size_t brick = grid_brick(grid, (unsigned)at[0], (unsigned)at[1], (unsigned)at[2]);
    int low[3], high[3];
    bool whole = true;
    for (int a = 0; a < 3; a++) {
        low[a] = from[a] > at[a] * BRICK ? from[a] - at[a] * BRICK : 0;
        high[a] = to[a] < at[a] * BRICK + BRICK ? to[a] - at[a] * BRICK : BRICK;
        whole = whole && low[a] == 0 && high[a] == BRICK;
    }
    if (whole || grid->low[brick] == grid->high[brick]) {
        *least = grid->low[brick] < *least ? grid->low[brick] : *least;
        *most = grid->high[brick] > *most ? grid->high[brick] : *most;
    } else {
        points_range(grid->values + brick * POINTS, low, high, least, most);
    }
}

void shape_grid_range(const shape_grid *grid, const double low[3], const double high[3], float *least,
                      float *most)
{
    int from[3], to[3];
    bool beyond = false; /* part of the box lies outside the grid, where density is 0 */
    for (int a = 0; a < 3; a++) {
        double last = grid->points[a] - 1, f = floor(low[a]), t = ceil(high[a]);
        beyond = beyond || low[a] < 0 || high[a] > last;
        if (!(t >= 0 && f <= last)) {
            *least = *most = 0;
            return;
        }
        from[a] = (int)fmax(f, 0);
        to[a] = (int)fmin(t, last);
    }
    *least = beyond ? 0 : INFINITY;
    *most = 0;
    int first[3], end[3], at[3];
    for (int a = 0; a < 3; a++) {
        first[a] = from[a] / BRICK < grid->bricks[a] ? from[a] / BRICK : grid->bricks[a] - 1;
        end[a] = to[a] > from[a] ? (to[a] - 1) / BRICK : first[a];
        end[a] = end[a] < grid->bricks[a] ? end[a] : grid->bricks[a] - 1;
    }
    for (at[2] = first[2]; at[2] <= end[2]; at[2]++)
        for (at[1] = first[1]; at[1] <= end[1]; at[1]++)
            for (at[0] = first[0]; at[0] <= end[0]; at[0]++)
                brick_range(grid, at, from, to, least, most);
    *least *= grid->gain * (1 - 1e-6f);
    *most *= grid->gain * (1 + 1e-6f);
}

double shape_grid_sum(const shape_grid *grid)
{
    double sum = 0;
    size_t total = table_size(grid);
    for (size_t i = 0; i < total; i++) {
        const float *v = grid->values + (size_t)grid->table[i] * POINTS;
        int at[3];
        if (!grid->table[i])
            continue;
        brick_place(grid, i, at);
        /* A face shared by two bricks counts in the one above; the grid's last points in the last brick. */
        int nx = at[0] + BRICK == grid->points[0] - 1 ? SIDE : BRICK,
            ny = at[1] + BRICK == grid->points[1] - 1 ? SIDE : BRICK,
            nz = at[2] + BRICK == grid->points[2] - 1 ? SIDE : BRICK;
        for (int z = 0; z < nz; z++)
            for (int y = 0; y < ny; y++)
                for (int x = 0; x < nx; x++)
                    sum += (double)v[(z * SIDE + y) * SIDE + x];
    }
    return sum * (double)grid->gain;
}

void shape_grid_copy(const shape_grid *grid, float scale, const int at[3], const int size[3], float *values)
{
    size_t total = table_size(grid);
    scale *= grid->gain;
    for (size_t i = 0; i < total; i++) {
        const float *from = grid->values + (size_t)grid->table[i] * POINTS;
        int low[3];
        brick_place(grid, i, low);
        for (int z = 0; z < SIDE && low[2] + z < grid->points[2]; z++)
            for (int y = 0; y < SIDE && low[1] + y < grid->points[1]; y++) {
                float *to = values +
                            ((size_t)(at[2] + low[2] + z) * (size_t)size[1] + (size_t)(at[1] + low[1] + y)) *
                                (size_t)size[0] +
                            (size_t)(at[0] + low[0]);
                for (int x = 0; x < SIDE && low[0] + x < grid->points[0]; x++)
                    to[x] = scale * from[(z * SIDE + y) * SIDE + x];
            }
    }
}
