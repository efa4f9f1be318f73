/* Rays through a voxel grid: a walk from cell to cell, or from brick to brick (Amanatides and Woo, "A Fast Voxel Traversal
 * Algorithm for Ray Tracing", 1987). */
#include <math.h>

#include "base/memory.h"
#include "field/grid_ray.h"

enum { BRICK = SHAPE_GRID_BRICK };

/* A walk over cells of `edge` voxels. */
typedef struct walk {
    int at[3], step[3], count[3];
    double t, end, next[3], delta[3];
} walk;

/* Starts at t0; false where the ray misses the cells. */
static bool walk_start(walk *w, const shape_grid *grid, shape_vec3 origin, shape_vec3 direction, float t0,
                       float t1, int edge)
{
    const double p[3] = {(double)origin.x, (double)origin.y, (double)origin.z},
                 d[3] = {(double)direction.x, (double)direction.y, (double)direction.z};
    w->t = (double)t0;
    w->end = (double)t1;
    for (int a = 0; a < 3; a++) {
        double last = grid->points[a] - 1;
        w->count[a] = (grid->points[a] - 1 + edge - 1) / edge;
        if (d[a] == 0) {
            if (!(p[a] >= 0 && p[a] <= last))
                return false;
            continue;
        }
        double near = -p[a] / d[a], far = (last - p[a]) / d[a];
        w->t = fmax(w->t, fmin(near, far));
        w->end = fmin(w->end, fmax(near, far));
    }
    if (!(w->t < w->end))
        return false;
    for (int a = 0; a < 3; a++) {
        double place = floor((p[a] + d[a] * w->t) / edge);
        w->at[a] = (int)fmin(fmax(place, 0), w->count[a] - 1);
        w->step[a] = d[a] < 0 ? -1 : 1;
        w->delta[a] = edge / fabs(d[a]);
        w->next[a] = d[a] == 0 ? INFINITY : ((w->at[a] + (d[a] > 0)) * (double)edge - p[a]) / d[a];
    }
    return true;
}

static double walk_exit(const walk *w)
{
    return fmin(fmin(w->next[0], w->next[1]), fmin(w->next[2], w->end));
}

/* On to the next cell; false at the end. */
static bool walk_next(walk *w)
{
    int a = w->next[0] < w->next[1] ? (w->next[0] < w->next[2] ? 0 : 2) : (w->next[1] < w->next[2] ? 1 : 2);
    w->t = fmax(w->t, w->next[a]);
    w->at[a] += w->step[a];
    w->next[a] += w->delta[a];
    return w->t < w->end && w->at[a] >= 0 && w->at[a] < w->count[a];
}

static uint32_t brick_at(const shape_grid *grid, const int at[3])
{
    return grid->table[((size_t)at[2] * (size_t)grid->bricks[1] + (size_t)at[1]) * (size_t)grid->bricks[0] +
                       (size_t)at[0]];
}

static float look(const shape_grid *grid, shape_vec3 origin, shape_vec3 direction, double t)
{
    shape_vec3 p = {(float)((double)origin.x + t * (double)direction.x),
                    (float)((double)origin.y + t * (double)direction.y),
                    (float)((double)origin.z + t * (double)direction.z)};
    return shape_grid_sample(grid, p);
}

/* The cells within one brick, or within any stretch of the ray. */
static double integrate_cells(const shape_grid *grid, shape_vec3 origin, shape_vec3 direction, float t0,
                              float t1)
{
    walk w;
    double sum = 0;
    if (!walk_start(&w, grid, origin, direction, t0, t1, 1))
        return 0;
    float before = look(grid, origin, direction, w.t);
    do {
        double exit = walk_exit(&w), width = exit - w.t;
        if (!(width > 0))
            continue;
        float middle = look(grid, origin, direction, w.t + width / 2),
              after = look(grid, origin, direction, exit);
        sum += width / 6 * ((double)before + 4 * (double)middle + (double)after);
        before = after;
    } while (walk_next(&w));
    return sum;
}

double shape_grid_integral(const shape_grid *grid, shape_vec3 origin, shape_vec3 direction, float t0,
                           float t1)
{
    walk w;
    double sum = 0;
    if (!walk_start(&w, grid, origin, direction, t0, t1, BRICK))
        return 0;
    do {
        double exit = walk_exit(&w);
        if (brick_at(grid, w.at) && exit > w.t)
            sum += integrate_cells(grid, origin, direction, (float)w.t, (float)exit);
    } while (walk_next(&w));
    return sum;
}

shape_status grid_candidates(const shape_grid *grid, shape_ray ray, float t_min, float t_max,
                             shape_candidates *found, shape_error *error)
{
    walk w;
    found->count = 0;
    if (!walk_start(&w, grid, ray.origin, ray.direction, t_min, t_max, BRICK))
        return SHAPE_OK;
    bool open = false; /* the last interval goes on */
    do {
        double exit = walk_exit(&w);
        if (!brick_at(grid, w.at)) {
            open = false;
            continue;
        }
        if (open) {
            found->items[found->count - 1].t_out = (float)exit;
            continue;
        }
        if (shape_array_reserve((void **)&found->items, &found->capacity, found->count + 1,
                                sizeof *found->items, error))
            return SHAPE_ERROR_MEMORY;
        found->items[found->count++] = (shape_candidate){(float)w.t, (float)exit, 0};
        open = true;
    } while (walk_next(&w));
    return SHAPE_OK;
}
