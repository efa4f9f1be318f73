/* A volume as few primitives: spheres packed into its solid part, then made ellipsoids and moved, stretched and turned
 * until their union fits. What is fitted is extinction, of any volume: a voxel grid, or clouds of other models. */
#ifndef SHAPE_VOLUMEFIT_H
#define SHAPE_VOLUMEFIT_H

#include "shape/volume.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { SHAPE_VOLUMEFIT_MAX_PRIMITIVES = 100000 };

typedef struct shape_volumefit_options {
    size_t primitives; /* at most so many, 1 to SHAPE_VOLUMEFIT_MAX_PRIMITIVES; default 64 */
    double
        error; /* stop with the fewest (found in steps of a half) whose error, see the report, is at most this;
                       0: use all; default 0 */
    int resolution; /* cells along the longest side that the fit looks at, 16 to 512; default 80 */
    int rounds;     /* of improvement for each number of primitives, 0 to 10000; default 240 */
    shape_model
        model; /* uniform (default) or spheroid, whose noise erodes the edges: the number of primitives is
                              * chosen by their plain union even so, and the report tells what the noise leaves */
    shape_progress progress; /* default none */
    void *progress_context;
} shape_volumefit_options;

typedef struct shape_volumefit_report {
    size_t primitives;
    double
        level; /* extinction that the solid part has on average [1/m]; solid is what has more than half of it */
    double error; /* RMSE of extinction over the cells in which either is above 0, in units of level */
    double
        overlap; /* intersection over union of the volume and the primitives, both as shares of level up to 1 */
    double cell; /* edge of a cell [m] */
    int cells[3];
    bool reached; /* `error` was met, or not asked for */
} shape_volumefit_report;

shape_volumefit_options shape_volumefit_defaults(void);
shape_status shape_volumefit_check(const shape_volumefit_options *options, shape_error *error);

/* Appends a cloud to the set that stands for the volume: medium of its first cloud, but an extinction that keeps the
 * integral of extinction over space. Spheres that are round to 2 % are kept as spheres. The result does not depend on the
 * number of threads. *cloud (may be NULL) gets its number. Errors: the check's, SHAPE_ERROR_FORMAT for a volume without
 * density, memory. */
shape_status shape_volumefit(const shape_volume *volume, const shape_volumefit_options *options,
                             shape_set *set, const char *name, size_t *cloud, shape_volumefit_report *report,
                             shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
