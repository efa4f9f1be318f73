/* Private: what the light grid takes from a sweep. */
#ifndef SHAPE_LIGHT_SUNSWEEP_H
#define SHAPE_LIGHT_SUNSWEEP_H

#include "shape/lightgrid.h"
#include "shape/sunsweep.h"

/* Clouds that may shade others, given as boxes seen from the sun: see shadowcast.c. */
typedef struct shadow_pairs {
    size_t *first;   /* [clouds + 1]: where a cloud's casters begin in `casters` */
    size_t *casters; /* never the cloud itself */
} shadow_pairs;

/* Finds the casters of all clouds: those whose boxes, seen from the sun, overlap with theirs and are not wholly behind. */
shape_status shadow_pairs_find(const shape_volume *volume, shape_dvec3 sun, shadow_pairs *pairs,
                               shape_error *error);
void shadow_pairs_free(shadow_pairs *pairs);
/* Whether the sweep has this cloud's own sums. */
bool sunsweep_has(const shape_sunsweep *sweep, size_t cloud);
/* Writes the optical depth of each cell's middle into value 0 of the cells. */
shape_status sunsweep_fill(const shape_sunsweep *sweep, size_t cloud, int threads, shape_stop stop,
                           shape_lightgrid *grid, shape_error *error);

#endif
