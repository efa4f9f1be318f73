/* Delta tracking (Woodcock et al. 1965) and residual ratio tracking (Novák et al. 2014) cell by cell (Amanatides and Woo
 * 1987). A cell's minorant spares most looks at the density: what it alone explains needs none. */
#include "light/track.h"

#include <math.h>

#include "light/blocks.h"

typedef struct walker {
    int at[3], step[3];
    size_t index, stride[3];
    double t, end, next[3], delta[3];
} walker;

/* Starts where the ray enters the grid, and ends by `end`; false where it misses. */
static bool walker_start(walker *w, const majorant_grid *grid, const double p[3], const double d[3],
                         double length)
{
    double inverse[3];
    w->t = 0;
    w->end = length;
    w->index = 0;
    if (!grid->n[0])
        return false;
    for (int a = 0; a < 3; a++) {
        inverse[a] = 1 / d[a];
        if (d[a] == 0) {
            if (!(p[a] >= 0 && p[a] <= grid->extent[a]))
                return false;
            continue;
        }
        double near = -p[a] * inverse[a], far = (grid->extent[a] - p[a]) * inverse[a];
        w->t = track_max(w->t, track_min(near, far));
        w->end = track_min(w->end, track_max(near, far));
    }
    if (!(w->t < w->end))
        return false;
    size_t stride = 1;
    for (int a = 0; a < 3; a++) {
        int at = (int)((p[a] + d[a] * w->t) * grid->inverse_cell[a]);
        w->at[a] = at < 0 ? 0 : at >= grid->n[a] ? grid->n[a] - 1 : at;
        w->step[a] = d[a] < 0 ? -1 : 1;
        w->stride[a] = stride;
        w->delta[a] = grid->cell[a] * fabs(inverse[a]);
        w->next[a] = d[a] == 0 ? INFINITY : ((w->at[a] + (d[a] > 0)) * grid->cell[a] - p[a]) * inverse[a];
        w->index += stride * (size_t)w->at[a];
        stride *= (size_t)grid->n[a];
    }
    return true;
}

/* The t at which the present cell ends. */
static inline double walker_exit(const walker *w)
{
    return track_min(track_min(w->next[0], w->next[1]), track_min(w->next[2], w->end));
}

/* On to the next cell; false at the end. */
static inline bool walker_next(walker *w, const majorant_grid *grid)
{
    int a = w->next[0] < w->next[1] ? (w->next[0] < w->next[2] ? 0 : 2) : (w->next[1] < w->next[2] ? 1 : 2);
    w->t = track_max(w->t, w->next[a]);
    if (!(w->t < w->end))
        return false;
    w->at[a] += w->step[a];
    if (w->at[a] < 0 || w->at[a] >= grid->n[a])
        return false;
    w->index = w->step[a] > 0 ? w->index + w->stride[a] : w->index - w->stride[a];
    w->next[a] += w->delta[a];
    return true;
}

/* Narrows a ray's part within a cell to where that cell's clouds are, which matters where a cell is large beside them. False
 * where it meets none. */
static bool clip_to_clouds(const majorant_grid *grid, const majorant_cell *cell, const double p[3],
                           const double d[3], double *from, double *to)
{
    double first = INFINITY, last = -INFINITY;
    for (uint32_t i = 0; i < cell->count; i++) {
        const majorant_cloud *cloud = &grid->clouds[grid->groups[cell->first + i].cloud];
        double near = *from, far = *to;
        for (int a = 0; a < 3; a++) {
            if (d[a] == 0) {
                if (!(p[a] >= cloud->low[a] && p[a] <= cloud->high[a]))
                    far = -INFINITY;
                continue;
            }
            double low = (cloud->low[a] - p[a]) / d[a], high = (cloud->high[a] - p[a]) / d[a];
            near = track_max(near, track_min(low, high));
            far = track_min(far, track_max(low, high));
        }
        if (near < far) {
            first = track_min(first, near);
            last = track_max(last, far);
        }
    }
    if (!(first < last))
        return false;
    *from = first;
    *to = last;
    return true;
}

/* Which cloud a tentative collision at p belongs to, if any: the sum of extinctions up to some cloud passes x, which
 * was drawn from [0, cell->max). The minorants come first, as they cost no look at the density. */
static bool choose_cloud(const majorant_grid *grid, const majorant_cell *cell, const double p[3], double x,
                         uint32_t *chosen)
{
    const majorant_group *group = &grid->groups[cell->first];
    double sum = 0;
    for (uint32_t i = 0; i < cell->count; i++) {
        sum += (double)group[i].min;
        *chosen = group[i].cloud;
        if (x < sum)
            return true;
    }
    for (uint32_t i = 0; i < cell->count; i++) {
        float extinction = grid->clouds[group[i].cloud].extinction;
        bool last = i + 1 == cell->count;
        double before = sum - (double)group[i].min;
        float floor = last ? (float)track_max((x - before) / (double)extinction, 0) : 0;
        sum = before + (double)(extinction * majorant_density(grid, &group[i], p, floor));
        *chosen = group[i].cloud;
        if (x < sum)
            return true;
    }
    return false;
}

/* Delta tracking as far as length: where the first collision is, as t, and whose. */
static bool collide(const majorant_grid *grid, const double p[3], const double d[3], double length,
                    double depth, shape_random *random, double *t, uint32_t *cloud)
{
    walker w;
    if (grid->blocks) {
        *cloud = 0;
        return block_collide(grid->blocks, p, d, length, depth, random, t);
    }
    if (!walker_start(&w, grid, p, d, length))
        return false;
    do {
        const majorant_cell *cell = &grid->cells[w.index];
        double exit = walker_exit(&w), max = (double)cell->max;
        if (grid->sparse && max > 0 && !clip_to_clouds(grid, cell, p, d, &w.t, &exit))
            continue;
        while (depth < (exit - w.t) * max) {
            w.t += depth / max;
            double at[3] = {p[0] + d[0] * w.t, p[1] + d[1] * w.t, p[2] + d[2] * w.t};
            if (choose_cloud(grid, cell, at, track_unit(random) * max, cloud)) {
                *t = w.t;
                return true;
            }
            depth = (double)-logf((float)track_unit(random));
        }
        depth -= track_max(exit - w.t, 0) * max;
    } while (walker_next(&w, grid));
    return false;
}

bool track_collide(const majorant_grid *grid, double p[3], const double d[3], double length, double depth,
                   shape_random *random, uint32_t *cloud)
{
    double t;
    if (!collide(grid, p, d, length, depth, random, &t, cloud))
        return false;
    for (int a = 0; a < 3; a++)
        p[a] += d[a] * t;
    return true;
}

bool track_blocked(const majorant_grid *grid, const double p[3], const double d[3], double length,
                   shape_random *random)
{
    double t;
    uint32_t cloud;
    return collide(grid, p, d, length, (double)-logf((float)track_unit(random)), random, &t, &cloud);
}

static double extinction_at(const majorant_grid *grid, const majorant_cell *cell, const double p[3])
{
    double sum = 0;
    for (uint32_t i = 0; i < cell->count; i++) {
        const majorant_group *group = &grid->groups[cell->first + i];
        sum += (double)(grid->clouds[group->cloud].extinction * majorant_density(grid, group, p, 0));
    }
    return sum;
}

double track_transmittance(const majorant_grid *grid, const double p[3], const double d[3], double length,
                           shape_random *random)
{
    walker w;
    if (grid->blocks)
        return block_transmittance(grid->blocks, p, d, length, random);
    if (!walker_start(&w, grid, p, d, length))
        return 1;
    double weight = 1, depth = (double)-logf((float)track_unit(random));
    do {
        const majorant_cell *cell = &grid->cells[w.index];
        if (!(cell->max > 0))
            continue;
        double exit = walker_exit(&w), rest = (double)cell->max - (double)cell->min;
        if (grid->sparse && !(cell->min > 0) && !clip_to_clouds(grid, cell, p, d, &w.t, &exit))
            continue;
        if (cell->min > 0)
            weight *= exp(-track_max(exit - w.t, 0) * (double)cell->min);
        while (depth < (exit - w.t) * rest) {
            w.t += depth / rest;
            double at[3] = {p[0] + d[0] * w.t, p[1] + d[1] * w.t, p[2] + d[2] * w.t};
            weight *= track_max((double)cell->max - extinction_at(grid, cell, at), 0) / rest;
            if (!track_roulette(&weight, random))
                return 0;
            depth = (double)-logf((float)track_unit(random));
        }
        depth -= track_max(exit - w.t, 0) * rest;
        if (!track_roulette(&weight, random))
            return 0;
    } while (walker_next(&w, grid));
    return weight;
}
