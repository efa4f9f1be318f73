/* For tests: voxel grids from formulas. */
#ifndef GRID_SAMPLE_H
#define GRID_SAMPLE_H

#include "shape/grid.h"
#include "volume_sample.h"

typedef struct grid_formula {
    double (*value)(const void *context, int x, int y, int z); /* at a point of the grid */
    const void *context;
    int points[3];
} grid_formula;

static bool grid_formula_brick(void *context, const int low[3], float *values)
{
    const grid_formula *f = context;
    for (int z = 0; z < SHAPE_GRID_SIDE && values; z++)
        for (int y = 0; y < SHAPE_GRID_SIDE; y++)
            for (int x = 0; x < SHAPE_GRID_SIDE; x++) {
                int at[3] = {low[0] + x, low[1] + y, low[2] + z};
                bool in = at[0] < f->points[0] && at[1] < f->points[1] && at[2] < f->points[2];
                *values++ = in ? (float)f->value(f->context, at[0], at[1], at[2]) : 0;
            }
    return true;
}

static inline shape_grid *grid_of(double (*value)(const void *, int, int, int), const void *context, int nx,
                                  int ny, int nz)
{
    shape_error error;
    shape_grid *grid = NULL;
    grid_formula f = {value, context, {nx, ny, nz}};
    shape_grid_source source = {{nx, ny, nz}, grid_formula_brick, &f};
    must(shape_grid_create(&source, (size_t)1 << 30, &grid, &error), &error);
    return grid;
}

/* A set of one cloud, whose voxels have that edge and whose point 0 stands at `at`. */
static inline shape_set *grid_set(shape_grid *grid, double edge, shape_dvec3 at)
{
    shape_error error;
    shape_set *set = new_set();
    shape_frame frame = {{{edge, 0, 0, at.x}, {0, edge, 0, at.y}, {0, 0, edge, at.z}}};
    must(shape_set_add_grid(set, "grid", grid, &frame, NULL, &error), &error);
    return set;
}

/* --- formulas --- */

/* Smooth, with empty parts, and nothing at the faces of a grid of 41 x 33 x 37. */
static inline double bumps(const void *context, int x, int y, int z)
{
    (void)context;
    bool face = !x || !y || !z || x >= 40 || y >= 32 || z >= 36;
    return face ? 0 : fmax(sin(0.31 * x) * sin(0.23 * y + 1) * cos(0.27 * z), 0);
}

/* A cloud, sampled at points that stand `edge` apart, the first at `at`. */
typedef struct sampled_cloud {
    const shape_volume_cloud *cloud;
    double edge;
    shape_dvec3 at;
} sampled_cloud;

/* Its context is a sampled_cloud. */
static inline double of_cloud(const void *context, int x, int y, int z)
{
    const sampled_cloud *s = context;
    return (double)shape_cloud_density(s->cloud, shape_vec3_make((float)(s->at.x + s->edge * x),
                                                                 (float)(s->at.y + s->edge * y),
                                                                 (float)(s->at.z + s->edge * z)));
}

#endif
