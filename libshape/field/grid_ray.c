/* Rays through a voxel grid: a walk from cell to cell, or from brick to brick (Amanatides and Woo, "A Fast Voxel Traversal
 * Algorithm for Ray Tracing", 1987). */
#include <math.h>

#include "base/memory.h"
#include "field/grid_ray.h"
#include "primitive/grid_look.h"

enum { BRICK = SHAPE_GRID_BRICK };

/* A walk over cells of `edge` voxels. */
typedef struct walk {
    int at[3], step[3], count[3];
    double t, end, next[3], delta[3];
} walk;

/* Unlike fmin and fmax no calls: nothing here is NaN. */
static inline double least(double a, double b)
{
    return a < b ? a : b;
}

static inline double greatest(double a, double b)
{
    return a > b ? a : b;
}

/* Starts at t0; false where the ray misses the cells. */
static bool walk_start(walk *w, const shape_grid *grid, shape_vec3 origin, shape_vec3 direction, float t0,
                       float t1, int edge)
{
    const double p[3] = {(double)origin.x, (double)origin.y, (double)origin.z},
                 d[3] = {(double)direction.x, (double)direction.y, (double)direction.z};
    double inverse[3];
    w->t = (double)t0;
    w->end = (double)t1;
    for (int a = 0; a < 3; a++) {
        double last = grid->points[a] - 1;
        inverse[a] = 1 / d[a];
        if (d[a] == 0) {
            if (!(p[a] >= 0 && p[a] <= last))
                return false;
            continue;
        }
        double near = -p[a] * inverse[a], far = (last - p[a]) * inverse[a];
        w->t = greatest(w->t, least(near, far));
        w->end = least(w->end, greatest(near, far));
    }
    if (!(w->t < w->end))
        return false;
    for (int a = 0; a < 3; a++) {
        double place = (p[a] + d[a] * w->t) / edge;
        w->count[a] = (grid->points[a] - 1 + edge - 1) / edge;
        w->at[a] = (int)least(greatest(place, 0), w->count[a] - 1);
        w->step[a] = d[a] < 0 ? -1 : 1;
        w->delta[a] = edge * fabs(inverse[a]);
        w->next[a] = d[a] == 0 ? INFINITY : ((w->at[a] + (d[a] > 0)) * (double)edge - p[a]) * inverse[a];
    }
    return true;
}

static inline double walk_exit(const walk *w)
{
    return least(least(w->next[0], w->next[1]), least(w->next[2], w->end));
}

/* On to the next cell; false at the end. */
static inline bool walk_next(walk *w)
{
    int a = w->next[0] < w->next[1] ? (w->next[0] < w->next[2] ? 0 : 2) : (w->next[1] < w->next[2] ? 1 : 2);
    w->t = greatest(w->t, w->next[a]);
    w->at[a] += w->step[a];
    w->next[a] += w->delta[a];
    return w->t < w->end && w->at[a] >= 0 && w->at[a] < w->count[a];
}

static uint32_t brick_at(const shape_grid *grid, const int at[3])
{
    return (uint32_t)grid_brick(grid, (unsigned)at[0], (unsigned)at[1], (unsigned)at[2]);
}

static inline float look(const shape_grid *grid, shape_vec3 origin, shape_vec3 direction, double t)
{
    return grid_look(grid, (float)((double)origin.x + t * (double)direction.x),
                     (float)((double)origin.y + t * (double)direction.y),
                     (float)((double)origin.z + t * (double)direction.z));
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

static double integrate(const shape_grid *grid, shape_vec3 origin, shape_vec3 direction, float t0, float t1,
                        double enough)
{
    walk w;
    double sum = 0;
    if (!walk_start(&w, grid, origin, direction, t0, t1, BRICK))
        return 0;
    do {
        double exit = walk_exit(&w);
        if (brick_at(grid, w.at) && exit > w.t)
            sum += integrate_cells(grid, origin, direction, (float)w.t, (float)exit);
    } while (sum < enough && walk_next(&w));
    return sum;
}

double shape_grid_integral(const shape_grid *grid, shape_vec3 origin, shape_vec3 direction, float t0,
                           float t1)
{
    return integrate(grid, origin, direction, t0, t1, INFINITY);
}

grid_way grid_way_make(const shape_grid *grid, shape_vec3 direction)
{
    const double d[3] = {(double)direction.x, (double)direction.y, (double)direction.z};
    grid_way way = {.grid = grid, .direction = direction};
    for (int a = 0; a < 3; a++) {
        way.inverse[a] = 1 / d[a];
        way.delta[a] = BRICK * fabs(way.inverse[a]);
    }
    return way;
}

/* Where a ray enters the grid; infinite where it misses it. Most begin inside. */
static double way_entry(const grid_way *way, const double p[3], const double d[3])
{
    double t = 0, end = INFINITY;
    for (int a = 0; a < 3; a++) {
        double last = way->grid->points[a] - 1;
        if (p[a] >= 0 && p[a] <= last)
            continue;
        if (!(d[a] < 0 || d[a] > 0))
            return INFINITY;
        double near = -p[a] * way->inverse[a], far = (last - p[a]) * way->inverse[a];
        t = greatest(t, least(near, far));
        end = least(end, greatest(near, far));
    }
    return t < end ? t : INFINITY;
}

/* A walk over bricks that knows only how many are left along each axis. */
typedef struct way_walk {
    const uint32_t *brick;
    ptrdiff_t stride[3];
    int left[3];
    double t, next[3];
} way_walk;

static bool way_start(const grid_way *way, way_walk *w, shape_vec3 from)
{
    const double p[3] = {(double)from.x, (double)from.y, (double)from.z},
                 d[3] = {(double)way->direction.x, (double)way->direction.y, (double)way->direction.z};
    const int *bricks = way->grid->bricks;
    ptrdiff_t stride = 1;
    w->t = way_entry(way, p, d);
    w->brick = way->grid->table;
    if (!(w->t < INFINITY))
        return false;
    for (int a = 0; a < 3; a++) {
        double place = (p[a] + d[a] * w->t) * (1.0 / BRICK);
        int at = (int)least(greatest(place, 0), bricks[a] - 1);
        bool up = d[a] > 0;
        w->brick += at * stride;
        w->left[a] = up ? bricks[a] - 1 - at : at;
        w->stride[a] = up ? stride : -stride;
        w->next[a] = d[a] < 0 || up ? ((at + up) * (double)BRICK - p[a]) * way->inverse[a] : INFINITY;
        stride *= bricks[a];
    }
    return true;
}

double grid_way_depth(const grid_way *way, shape_vec3 from, float step, double enough)
{
    way_walk w;
    shape_vec3 d = way->direction;
    double next = -1; /* where the next step is looked at; negative: the last brick was empty */
    float sum = 0, most = (float)least(enough / (double)step, 1e30);
    if (step * shape_vec3_length(d) <= 1)
        return integrate(way->grid, from, d, 0, INFINITY, enough);
    if (!way_start(way, &w, from))
        return 0;
    for (int a = 0;; w.t = w.next[a], w.next[a] += way->delta[a], w.brick += w.stride[a]) {
        a = w.next[0] < w.next[1] ? (w.next[0] < w.next[2] ? 0 : 2) : (w.next[1] < w.next[2] ? 1 : 2);
        if (!*w.brick) {
            next = -1;
        } else {
            next = next < 0 ? w.t + (double)step / 2 : next;
            for (; next < w.next[a]; next += (double)step) {
                float t = (float)next;
                sum += grid_look(way->grid, from.x + d.x * t, from.y + d.y * t, from.z + d.z * t);
                if (sum >= most)
                    return (double)sum * (double)step;
            }
        }
        if (--w.left[a] < 0)
            return (double)sum * (double)step;
    }
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
