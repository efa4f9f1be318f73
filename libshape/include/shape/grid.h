/* Voxel grids: density sampled by trilinear interpolation, the model `grid`. Kept in bricks of 8^3 cells, so that empty
 * space costs nothing. Read from OpenVDB files (shape/vdb_read.h) and raw float volumes (below). */
#ifndef SHAPE_GRID_H
#define SHAPE_GRID_H

#include <stddef.h>
#include <stdint.h>

#include "shape/set.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    SHAPE_GRID_BRICK = 8,                   /* cells a side of a brick */
    SHAPE_GRID_SIDE = SHAPE_GRID_BRICK + 1, /* points: both faces */
    SHAPE_GRID_BRICK_POINTS = SHAPE_GRID_SIDE * SHAPE_GRID_SIDE * SHAPE_GRID_SIDE, /* 729 */
    SHAPE_GRID_MAX_SIDE = 1 << 16                                                  /* points along an axis */
};

/* Values stand at the points with whole coordinates 0 to points - 1 along each axis; between them density is trilinear,
 * outside it is 0. So the unit of length of a grid is its voxel. A brick holds the points of both its faces: a look
 * reads one brick. */
typedef struct shape_grid {
    int points[3];     /* along x, y, z, 2 to SHAPE_GRID_MAX_SIDE */
    int bricks[3];     /* that cover the cells between them */
    uint32_t *table;   /* [bricks z][bricks y][bricks x]: which brick of `values`; 0: the empty one */
    float *values;     /* [brick_count][9][9][9], x fastest; brick 0 is all 0 */
    float *low, *high; /* the range of each brick's values */
    uint64_t *
        filled; /* a bit for each part of 2^3 cells of a brick, x fastest, then y: whether it holds anything */
    size_t brick_count;
    float most;     /* the largest value */
    float gain;     /* density is the sample times this, >= 0 and finite; 1 unless the caller sets it */
    unsigned users; /* lists that name it; by shape_grid_keep and shape_grid_release only */
    bool coloured;  /* scattering has a colour, of which the cloud's albedo is multiplied: */
    struct shape_grid
        *colour[3]; /* red, green, blue, 0 or more, each with as many points; the grid owns them. NULL in a
                                     coloured grid: that channel is 0 */
} shape_grid;

/* Where a grid's values come from. brick() fills the 9^3 values, x fastest, of the points from low[] to low[] + 8 (those
 * beyond the last point are 0) and returns true; or returns false where all of them are 0. With values NULL it only tells
 * whether there may be any. It is called from one thread. */
typedef struct shape_grid_source {
    int points[3];
    bool (*brick)(void *context, const int low[3], float *values);
    void *context;
} shape_grid_source;

/* Makes a grid of at most max_bytes, counted before memory is taken; bricks of one value are stored once. Values below 0
 * count as 0. Errors: SHAPE_ERROR_FORMAT for NaN or infinite values and where all are 0; SHAPE_ERROR_LIMIT;
 * SHAPE_ERROR_MEMORY. The caller destroys it, or gives it to a set. */
shape_status shape_grid_create(const shape_grid_source *source, size_t max_bytes, shape_grid **grid,
                               shape_error *error);
/* One use more, for another list that names it. Sets on different threads may share a grid. NULL is allowed. */
void shape_grid_keep(shape_grid *grid);
/* Gives up one use; the last one frees. NULL is allowed. */
void shape_grid_release(shape_grid *grid);

/* The value at p [voxels], times the gain. Trilinear. */
float shape_grid_sample(const shape_grid *grid, shape_vec3 p);
/* The colour at p [voxels], trilinear: red, green, blue, 0 or more; 1 each where the grid has none. */
void shape_grid_colour(const shape_grid *grid, shape_vec3 p, float rgb[3]);
/* Bytes that the grid takes, without those of its colour. */
size_t shape_grid_bytes(const shape_grid *grid);
/* Bounds of the samples within the box [voxels]. */
void shape_grid_range(const shape_grid *grid, const double low[3], const double high[3], float *least,
                      float *most);
/* The integral of density over t along origin + t direction [voxels] from t0 to t1: cell by cell (Amanatides and Woo
 * 1987), in each by Simpson's rule, which is exact for the cubic that a trilinear density is along a line. */
double shape_grid_integral(const shape_grid *grid, shape_vec3 origin, shape_vec3 direction, float t0,
                           float t1);
/* The sum of all values, times the gain [voxels^3]: the integral of density over space, if the outermost points are 0. */
double shape_grid_sum(const shape_grid *grid);

/* Writes all values, times the gain and `scale`, into an array of size[0] x size[1] x size[2] floats, x fastest, from
 * the place `at` on; they must fit. */
void shape_grid_copy(const shape_grid *grid, float scale, const int at[3], const int size[3], float *values);

/* Adds a cloud of the model `grid`; frame takes voxels to metres of the world. The set owns the grid from here on, also
 * after an error. The cloud's list holds one ellipsoid, which touches the grid's box: its support. */
shape_status shape_set_add_grid(shape_set *set, const char *name, shape_grid *grid, const shape_frame *frame,
                                size_t *index, shape_error *error);

/* --- raw volumes (file/volume_raw.c) --- */

/* Decodes a raw volume: three 32-bit little-endian sizes, each 1 to 65,534, then that many 32-bit floats, x fastest, then
 * y, then z (as Páleník 2016 used). Sizes are held against the number of bytes before memory is taken. The grid has a
 * point more on every side, whose value is 0. `name` is used in errors. */
shape_status shape_volume_raw_decode(const char *name, const void *bytes, size_t size, size_t max_bytes,
                                     shape_grid **grid, shape_error *error);
/* Whether the bytes may be a raw volume: as many as their sizes say. */
bool shape_volume_raw_is(const void *bytes, size_t size);

#ifdef __cplusplus
}
#endif
#endif
