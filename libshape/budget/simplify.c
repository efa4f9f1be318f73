/* Fewer primitives to an allowed error: merged all the way down once (budget/merge.c), then the fewest whose pictures
 * (budget/measure.c) stay close enough, by bisection. */
#include "shape/simplify.h"

#include <stdlib.h>
#include <string.h>

#include "budget/distinct.h"
#include "budget/measure.h"
#include "budget/merge.h"

shape_simplify_options shape_simplify_defaults(void)
{
    shape_simplify_options options = {.error = -1, .most = 0, .resolution = 64};
    return options;
}

static shape_status check_resolution(int resolution, shape_error *error)
{
    if (resolution < 8 || resolution > 256)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "the measuring resolution is %d (it must be 8 to 256)", resolution);
    return SHAPE_OK;
}

shape_status shape_simplify_check(const shape_simplify_options *options, shape_error *error)
{
    if (!(options->error <= 1))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "the allowed error is %g (it must be 0 to 1, or negative for none)",
                               options->error);
    return check_resolution(options->resolution, error);
}

/* One list's simplification. */
typedef struct job {
    const shape_primitives *list; /* as it was */
    shape_primitives distinct;    /* what is merged: the same, but for duplicates where these show nothing */
    budget_stage stage;
    budget_merges merges;
    double *original, *changed; /* pictures */
} job;

static void free_arrays(shape_primitives *list)
{
    free(list->spheres);
    free(list->ellipsoids);
    memset(list, 0, sizeof *list);
}

static shape_status change_at(job *j, size_t wanted, double *change, shape_error *error)
{
    shape_primitives cut = {0};
    shape_status status = budget_merges_cut(&j->merges, &j->distinct, wanted, &cut, error);
    if (!status)
        status = budget_pictures_draw(&j->stage, &cut, j->changed, error);
    if (!status)
        *change = budget_pictures_change(&j->stage, j->original, j->changed);
    free_arrays(&cut);
    return status;
}

/* The steps are the same for every allowed error up to the first answer that differs, so a larger one never keeps more. */
static shape_status bisect(job *j, double allowed, size_t *wanted, double *change, shape_error *error)
{
    size_t too_few = 0, enough = j->merges.count;
    *change = 0;
    while (enough - too_few > 1) {
        size_t middle = too_few + (enough - too_few) / 2;
        double measured = 0;
        shape_status status = change_at(j, middle, &measured, error);
        if (status)
            return status;
        if (measured <= allowed) {
            enough = middle;
            *change = measured;
        } else {
            too_few = middle;
        }
    }
    *wanted = enough;
    return SHAPE_OK;
}

static shape_status run(job *j, const shape_cloud *cloud, const shape_simplify_options *options,
                        size_t *wanted, double *change, shape_error *error)
{
    shape_status status = budget_merges_make(&j->merges, &j->distinct, cloud->field.model, error);
    if (!status)
        status = budget_stage_set(&j->stage, j->list, cloud, options->resolution, error);
    if (status)
        return status;
    j->original = malloc((j->stage.values + 1) * sizeof *j->original);
    j->changed = malloc((j->stage.values + 1) * sizeof *j->changed);
    if (!j->original || !j->changed)
        return shape_error_memory(error);
    status = budget_pictures_draw(&j->stage, j->list, j->original, error);
    *wanted = j->merges.count;
    if (!status && options->error >= 0)
        status = bisect(j, options->error, wanted, change, error);
    if (!status && options->most && options->most < *wanted) {
        *wanted = options->most;
        status = change_at(j, *wanted, change, error);
    }
    return status;
}

/* A duplicate shows nothing where the nearest primitive alone makes the density. */
static shape_status take_list(job *j, const shape_cloud *cloud, shape_error *error)
{
    bool nearest = cloud->field.model != SHAPE_MODEL_METABALL && !(cloud->field.detail.smoothness > 0);
    if (nearest)
        return budget_distinct_copy(j->list, &j->distinct, error);
    size_t spheres = j->list->sphere_count, ellipsoids = j->list->ellipsoid_count;
    shape_status status = shape_primitives_reserve(&j->distinct, spheres, ellipsoids, error);
    if (status)
        return status;
    if (spheres)
        memcpy(j->distinct.spheres, j->list->spheres, spheres * sizeof *j->list->spheres);
    if (ellipsoids)
        memcpy(j->distinct.ellipsoids, j->list->ellipsoids, ellipsoids * sizeof *j->list->ellipsoids);
    j->distinct.sphere_count = spheres;
    j->distinct.ellipsoid_count = ellipsoids;
    return SHAPE_OK;
}

static void job_end(job *j)
{
    free_arrays(&j->distinct);
    budget_merges_free(&j->merges);
    free(j->original);
    free(j->changed);
}

static bool is_heap(const shape_cloud *cloud, const shape_primitives *list)
{
    return cloud->field.model != SHAPE_MODEL_LAYER && cloud->field.model != SHAPE_MODEL_GRID && !list->grid;
}

shape_status shape_primitives_simplify(shape_primitives *list, const shape_cloud *cloud,
                                       const shape_simplify_options *options, shape_simplify_result *result,
                                       shape_error *error)
{
    size_t count = shape_primitives_count(list), wanted = count;
    double change = 0;
    shape_status status = shape_simplify_check(options, error);
    bool needed = options->error >= 0 || (options->most && options->most < count);
    if (!status && count > 1 && needed && is_heap(cloud, list)) {
        job j = {.list = list};
        shape_primitives cut = {0};
        status = take_list(&j, cloud, error);
        if (!status)
            status = run(&j, cloud, options, &wanted, &change, error);
        if (!status && wanted < count)
            status = budget_merges_cut(&j.merges, &j.distinct, wanted, &cut, error);
        job_end(&j);
        if (!status && wanted < count) {
            free_arrays(list);
            *list = cut;
        } else {
            free_arrays(&cut);
        }
    }
    if (!status && result)
        *result = (shape_simplify_result){count, wanted, change};
    return status;
}

shape_status shape_simplify_error(const shape_primitives *list, const shape_primitives *other,
                                  const shape_cloud *cloud, int resolution, double *change,
                                  shape_error *error)
{
    shape_status status = check_resolution(resolution, error);
    budget_stage stage;
    if (!status)
        status =
            budget_stage_set(&stage, shape_primitives_count(list) ? list : other, cloud, resolution, error);
    if (status)
        return status;
    double *from = calloc(2 * stage.values + 1, sizeof *from);
    if (!from)
        return shape_error_memory(error);
    status = budget_pictures_draw(&stage, list, from, error);
    if (!status)
        status = budget_pictures_draw(&stage, other, from + stage.values, error);
    if (!status)
        *change = budget_pictures_change(&stage, from, from + stage.values);
    free(from);
    return status;
}
