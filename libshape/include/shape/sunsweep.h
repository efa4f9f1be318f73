/* The sun's way into clouds, quickly: each cloud's density once a cell of a grid whose columns run along the sun, and
 * running sums down these columns. So a grid costs its cells and not its cells times the steps of a march, and a cloud's
 * shadow on others is a look-up. */
#ifndef SHAPE_SUNSWEEP_H
#define SHAPE_SUNSWEEP_H

#include "shape/change.h"
#include "shape/view.h"
#include "shape/volume.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Running sums of clouds. Opaque; reading is thread-safe. */
typedef struct shape_sunsweep shape_sunsweep;

/* Sweeps the clouds that are asked for and those that throw shadows on them. cells[i]: cells along the longest side of
 * cloud i's grid, 2 to 256, or 0 where its light is not asked for (it still throws shadows, by a grid of 16). Octaves of
 * noise that are finer than a cell are taken as their mean. threads 0: all; the result does not depend on it. The volume
 * must outlive the sweep. The caller destroys it. Errors: a number of cells out of range (SHAPE_ERROR_ARGUMENT), memory. */
shape_status shape_sunsweep_create(const shape_volume *volume, const shape_light *light, const int *cells,
                                   int threads, shape_sunsweep **made, shape_error *error);
typedef struct shape_sunsweep_options {
    int threads; /* 0: all */
    bool keep;   /* densities too, so that a later sweep can begin from this one; twice the memory */
    /* An earlier sweep that has kept its densities, under the same sun; default NULL. Columns of clouds that lie as they did
     * are taken out of it: shared where nothing has changed, and else, where changes[i] touches cloud i, evaluated and summed
     * again. It is good for less afterwards, but still to be destroyed, and its volume may be gone. What comes of it is what
     * it would be without it, to the bit. */
    shape_sunsweep *from;
    const shape_change *changes; /* one a cloud, since `from` was made; default NULL: nothing has changed */
    shape_stop stop;             /* to break off */
} shape_sunsweep_options;

/* The same with more to choose. */
shape_status shape_sunsweep_create_with(const shape_volume *volume, const shape_light *light,
                                        const int *cells, const shape_sunsweep_options *options,
                                        shape_sunsweep **made, shape_error *error);
void shape_sunsweep_destroy(shape_sunsweep *sweep); /* NULL is allowed */

/* How many clouds were swept, asked for or not. */
size_t shape_sunsweep_count(const shape_sunsweep *sweep);
/* The optical depth from a point of cloud number `cloud` (its frame) to the sun, through all clouds: trilinear between
 * cells. 0 for a cloud that was not asked for. */
float shape_sunsweep_depth(const shape_sunsweep *sweep, size_t cloud, shape_vec3 p);

/* The memory of its columns in bytes, and how many of their rows were evaluated for it. */
size_t shape_sunsweep_bytes(const shape_sunsweep *sweep);
uint64_t shape_sunsweep_rows(const shape_sunsweep *sweep);

/* Whether a cloud may throw a shadow on another: by the balls around their boxes. sun: as in shape_light. */
bool shape_sun_may_shade(const shape_volume_cloud *caster, const shape_volume_cloud *on, shape_dvec3 sun);

#ifdef __cplusplus
}
#endif
#endif
