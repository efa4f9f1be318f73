/* Fewer primitives for a picture that changes by no more than is allowed: neighbours are merged, needless ones dropped,
 * and the change is measured on pictures of the cloud from six sides (docs/simplify.md). */
#ifndef SHAPE_SIMPLIFY_H
#define SHAPE_SIMPLIFY_H

#include "shape/set.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shape_simplify_options {
    double error; /* allowed relative change of the pictures, 0 to 1; below 0 (the default): not asked for */
    size_t most;  /* primitives that may stay, at least 1; 0 (the default): any number */
    int resolution; /* of the measuring pictures, pixels along the cloud's longest side, 8 to 256; default 64 */
} shape_simplify_options;

typedef struct shape_simplify_result {
    size_t before, after; /* primitives */
    double error;         /* the measured change; 0 where nothing was changed */
} shape_simplify_result;

shape_simplify_options shape_simplify_defaults(void);
shape_status shape_simplify_check(const shape_simplify_options *options, shape_error *error);

/* Replaces a cloud's list by a shorter one. `cloud` says which field the list makes, how dense, and by its frame how
 * large; its own list is not looked at. With `error`, as few primitives as bisection finds whose measured change is at
 * most that; with `most`, that number exactly where there are more that
 * differ (exact duplicates go first); with both, the fewer of the two, and the change
 * may then be larger than `error`. A larger `error` never keeps more. What is not merged stays bit for bit, and the order
 * stays. Layers and grids, whose primitives are no heap, are left as they are. The result is the same for any number of
 * threads, and on every machine. result may be NULL. Errors: options, memory; the list is then untouched. */
shape_status shape_primitives_simplify(shape_primitives *list, const shape_cloud *cloud,
                                       const shape_simplify_options *options, shape_simplify_result *result,
                                       shape_error *error);

/* The measure by itself: how much the pictures of `other` differ from those of `list`, both with the field, medium and
 * frame of `cloud`. From each of six sides, the root mean square of the difference divided by the pictures' own root mean
 * square: of the cover (1 - transmittance), and of the radiance under suns from three sides, before black. The largest
 * of these twelve numbers. Infinite where `list` shows nothing
 * and `other` does. Errors: memory, a resolution outside 8 to 256, a grid's list. */
shape_status shape_simplify_error(const shape_primitives *list, const shape_primitives *other,
                                  const shape_cloud *cloud, int resolution, double *change,
                                  shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
