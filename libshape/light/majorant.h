/* Private: a grid over a volume's world box. Each cell knows the clouds that reach into it, bounds of their extinction
 * there, and the few primitives that decide the density. */
#ifndef SHAPE_LIGHT_MAJORANT_H
#define SHAPE_LIGHT_MAJORANT_H

#include "shape/volume.h"

enum { MAJORANT_TABLE = 256 };

/* One cloud in one cell. min and max bound its extinction there [1/m]; entries[first ..] name its spheres, then its
 * ellipsoids, but for clouds that are asked as a whole. */
typedef struct majorant_group {
    float min, max;
    float low, high; /* bounds of the noise there, where that is what a spheroid's density comes from */
    uint32_t cloud, first, spheres, ellipsoids;
} majorant_group;

/* The sums over the cell's groups; max is 0 where there is nothing. */
typedef struct majorant_cell {
    float min, max;
    uint32_t first, count;
} majorant_cell;

/* One ellipsoid as the map into the space where it is the unit ball: rows, each with its offset. */
typedef struct majorant_ellipsoid {
    float m[3][4];
} majorant_ellipsoid;

typedef struct majorant_cloud {
    const shape_volume_cloud *cloud;
    double to_local[3][4];  /* from places in the grid (metres from its origin) to the cloud's frame */
    double low[3], high[3]; /* all of it lies between them [m from the grid's origin] */
    majorant_ellipsoid *ellipsoids;
    float extinction;
    float mean; /* of the octaves left out */
    bool
        whole; /* its density is asked as a whole: metaballs, layers, clouds with details; their groups have no entries */
    /* For `spheroid`, at u = i / MAJORANT_TABLE: noise from top[i] on certainly fails n < gamma(u, n), noise below
     * bottom[i] certainly passes. Both fall with u. */
    float top[MAJORANT_TABLE + 2], bottom[MAJORANT_TABLE + 2];
} majorant_cloud;

typedef struct majorant_grid {
    shape_dvec3 origin;        /* world */
    double extent[3], cell[3]; /* metres */
    double inverse_cell[3];
    int n[3];
    majorant_cell *cells; /* x fastest */
    majorant_group *groups;
    uint32_t *entries;
    majorant_cloud *clouds;
    size_t cloud_count;
    bool sparse; /* some cloud is small beside a cell: clouds are far from each other */
    struct block_grid
        *blocks; /* of a volume that is one voxel grid (light/blocks.h); there are no cells then */
} majorant_grid;

/* Builds the grid; n is 0 for a volume without density. Free it by majorant_grid_free, also after an error. */
shape_status majorant_grid_build(majorant_grid *grid, const shape_volume *volume, shape_error *error);
void majorant_grid_free(majorant_grid *grid);

/* --- the density at a point (majorant_density.c) --- */

/* The density of a group's cloud at p (metres from the grid's origin, inside the group's cell). With floor 0 exactly;
 * with a floor above 0 some number above floor where the density is above it, some number not above floor where it is
 * not, which saves octaves. */
float majorant_density(const majorant_grid *grid, const majorant_group *group, const double p[3],
                       float floor);

/* --- bounds (majorant_bounds.c) --- */

/* What stands for the octaves of a cloud's noise that are left out. */
float majorant_noise_mean(const shape_volume_cloud *cloud);
/* The range of a cloud's noise over the box middle +- half in its frame. */
void majorant_noise_range(const shape_volume_cloud *cloud, const double middle[3], const double half[3],
                          float *low, float *high);
/* Fills top and bottom. */
void majorant_threshold_tables(majorant_cloud *cloud);

#endif
