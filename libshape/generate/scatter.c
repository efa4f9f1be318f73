/* Poisson-disk points in a rectangle: dart throwing (Cook 1986) with a grid that finds the neighbours (Bridson 2007),
 * repeated with a smaller distance until there are enough. Bridson's own way of drawing around the points there are
 * finds no place in a narrow strip. */
#include "shape/scatter.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "shape/random.h"

enum { STREAM_PLACES = 1, DARTS = 200 };

/* A run of darts, and a grid of cells so small that each holds one point at most. */
typedef struct pattern {
    double width, depth, spacing, cell;
    size_t columns, rows, count;
    uint32_t *cells; /* number of the point + 1; 0: none */
    shape_point2 *points;
    shape_random random;
} pattern;

static size_t cell_of(const pattern *p, double value, double side, size_t cells)
{
    size_t cell = (size_t)((value + side / 2) / p->cell);
    return cell < cells ? cell : cells - 1;
}

static bool is_free(const pattern *p, shape_point2 at)
{
    size_t column = cell_of(p, at.x, p->width, p->columns), row = cell_of(p, at.z, p->depth, p->rows);
    size_t last_column = column + 2 < p->columns ? column + 2 : p->columns - 1;
    size_t last_row = row + 2 < p->rows ? row + 2 : p->rows - 1;
    for (size_t r = row < 2 ? 0 : row - 2; r <= last_row; r++)
        for (size_t c = column < 2 ? 0 : column - 2; c <= last_column; c++) {
            uint32_t number = p->cells[r * p->columns + c];
            if (!number)
                continue;
            double dx = p->points[number - 1].x - at.x, dz = p->points[number - 1].z - at.z;
            if (dx * dx + dz * dz < p->spacing * p->spacing)
                return false;
        }
    return true;
}

/* Throws darts uniformly at the rectangle, keeping those that fall far enough from the ones before, until there are
 * enough or hope is lost. Stopping early leaves no part of the rectangle out. */
static bool throw_darts(pattern *p, size_t count)
{
    for (size_t dart = 0; dart < DARTS * count && p->count < count; dart++) {
        shape_point2 at = {shape_random_range(&p->random, -p->width / 2, p->width / 2),
                           shape_random_range(&p->random, -p->depth / 2, p->depth / 2)};
        if (!is_free(p, at))
            continue;
        size_t column = cell_of(p, at.x, p->width, p->columns), row = cell_of(p, at.z, p->depth, p->rows);
        p->points[p->count++] = at;
        p->cells[row * p->columns + column] = (uint32_t)p->count;
    }
    return p->count == count;
}

static shape_status try_spacing(pattern *p, size_t count, bool *enough, shape_error *error)
{
    p->cell = p->spacing / sqrt(2.0);
    p->columns = (size_t)(p->width / p->cell) + 1;
    p->rows = (size_t)(p->depth / p->cell) + 1;
    p->count = 0;
    p->cells = calloc(p->columns * p->rows, sizeof *p->cells);
    if (!p->cells)
        return shape_error_memory(error);
    *enough = throw_darts(p, count);
    free(p->cells);
    return SHAPE_OK;
}

/* No `count` points in the rectangle can keep more than this: hexagonal packing of the rectangle grown by half a
 * spacing on each side, count * sqrt(3)/2 * s^2 = (width + s) (depth + s). */
static double largest_spacing(size_t count, double width, double depth)
{
    double a = 0.8660254037844386 * (double)count - 1, b = width + depth;
    return (b + sqrt(b * b + 4 * a * width * depth)) / (2 * a);
}

shape_status shape_scatter(size_t count, double width, double depth, uint64_t seed, shape_point2 *points,
                           double *spacing, shape_error *error)
{
    if (count < 1 || count > SHAPE_SCATTER_MAX)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "a pattern of %zu points (it must be 1 to %d)",
                               count, SHAPE_SCATTER_MAX);
    if (!(width >= 1e-3 && width <= 1e9 && depth >= 1e-3 && depth <= 1e9))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "an area of %g by %g m (a side must be 0.001 to 1e9)", width, depth);
    pattern p = {
        .width = width, .depth = depth, .points = points, .random = shape_random_seed(seed, STREAM_PLACES)};
    bool enough = count == 1;
    p.spacing = enough ? sqrt(width * width + depth * depth) : largest_spacing(count, width, depth);
    if (enough)
        points[0].x = points[0].z = 0;
    shape_status status = SHAPE_OK;
    while (!enough && !status) {
        p.spacing *= 0.95;
        status = try_spacing(&p, count, &enough, error);
    }
    if (spacing)
        *spacing = p.spacing;
    return status;
}
