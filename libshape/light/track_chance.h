/* Private: chances and bounds of the tracking through majorant grids and through blocks of voxels. */
#ifndef SHAPE_LIGHT_TRACK_CHANCE_H
#define SHAPE_LIGHT_TRACK_CHANCE_H

#include "shape/random.h"

/* A uniform number above 0 and below 1. */
static inline double track_unit(shape_random *random)
{
    return ((double)shape_random_u32(random) + 0.5) * 0x1p-32;
}

/* Unlike fmin and fmax no calls: nothing here is NaN. */
static inline double track_min(double a, double b)
{
    return a < b ? a : b;
}

static inline double track_max(double a, double b)
{
    return a > b ? a : b;
}

/* Low weights live on with a chance in proportion, and then as much heavier. */
static inline bool track_roulette(double *weight, shape_random *random)
{
    const double below = 0.1;
    if (*weight >= below)
        return true;
    if (track_unit(random) * below >= *weight)
        return false;
    *weight = below;
    return true;
}

#endif
