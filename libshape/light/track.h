/* Private: rays through the majorant grid: free paths and transmittances. */
#ifndef SHAPE_LIGHT_TRACK_H
#define SHAPE_LIGHT_TRACK_H

#include "light/majorant.h"
#include "light/track_chance.h"
#include "shape/random.h"

struct shape_tracer {
    majorant_grid grid;
};

/* Draws where a ray from p (metres from the grid's origin) along the unit vector d collides. depth is the optical depth,
 * drawn by the caller as -log of a uniform number, after which the first tentative collision comes. True: p has moved
 * there and *cloud scatters; false: the ray leaves the grid, or comes as far as length [m], and p is where it was. */
bool track_collide(const majorant_grid *grid, double p[3], const double d[3], double length, double depth,
                   shape_random *random, uint32_t *cloud);

/* Whether something collides with a ray from p along d before length: false with the chance of the transmittance. Cheaper
 * than an estimate of it, as it ends at the first collision and seldom needs a density in full. */
bool track_blocked(const majorant_grid *grid, const double p[3], const double d[3], double length,
                   shape_random *random);

/* An unbiased estimate of the transmittance from p along d as far as length. */
double track_transmittance(const majorant_grid *grid, const double p[3], const double d[3], double length,
                           shape_random *random);

#endif
