/* Private: scattered light on a grid by discrete ordinates. */
#ifndef SHAPE_LIGHT_ORDINATES_H
#define SHAPE_LIGHT_ORDINATES_H

#include <stdint.h>

#include "shape/status.h"
#include "shape/vector.h"
#include "shape/view.h"
#include "shape/volume.h"

/* Three problems are solved at once: light from the sun's first collisions, from the upper and from the lower half of
 * the sky. A cell holds four moments (mean radiance, and the mean of radiance times x, y, z of the direction of
 * travel) of each; the fourth lane is unused and keeps the loops of a whole vector. */
enum { ORDINATES_LANES = 4, ORDINATES_MOMENTS = 4, ORDINATES_CELL = ORDINATES_LANES * ORDINATES_MOMENTS };
enum {
    ORDINATES_OCTANTS = 8,
    ORDINATES_PER_OCTANT = 3,
    ORDINATES_DIRECTIONS = ORDINATES_OCTANTS * ORDINATES_PER_OCTANT
};

typedef struct ordinates_problem {
    int size[3];
    float cell[3];           /* edges of a cell [m of the world] */
    const float *extinction; /* a cell's mean, after the delta scaling [1/m] */
    const float *beam;       /* a cell's unscattered irradiance from the sun, for one of 1 */
    float albedo, g;         /* after the delta scaling */
    const float *shares;     /* what albedo is multiplied by in each cell; NULL: 1 */
    shape_vec3 sun_travel;   /* unit direction in which sun light travels, grid's frame */
    shape_vec3 up;           /* the world's up, grid's frame, unit */
    const float *sky;        /* [ORDINATES_DIRECTIONS] what its half of the sky sends along each; NULL: 1 */
    float *moments;          /* in: a first guess; out: the solution. [cells][ORDINATES_CELL] */
    shape_stop stop;         /* to break off */
    uint64_t *visits;        /* cells times rounds are added; NULL: not counted */
} ordinates_problem;

/* The direction in which light of that number travels: unit, grid's frame. */
void ordinates_direction(int number, float omega[3]);

/* What the sky sends along each direction into the cloud's grid, in units of the mean radiance of the half that it comes from
 * (skyshare.c). All 1 for a sky that is even. */
void ordinates_sky_shares(const shape_sky *sky, const shape_volume_cloud *cloud,
                          float shares[ORDINATES_DIRECTIONS]);

/* Source iteration, `iterations` times at the most, until what is left is estimated below `tolerance` of the largest mean
 * radiance. The result does not depend on the number of threads. */
shape_status ordinates_solve(const ordinates_problem *problem, int iterations, float tolerance, int threads,
                             shape_error *error);

#endif
