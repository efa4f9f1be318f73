/* Which voxels neph-vdb takes: as asked, or as an allowed error asks, and never more than the memory allowed. */
#include <math.h>

#include "cli_picture.h"
#include "shape/budget.h"
#include "vdb.h"

/* Samples of the error, and how fine it may get: voxels along the longest side. */
enum { ERROR_SAMPLES = 8192, ERROR_SEED = 1, ERROR_FINEST = 8192 };

/* What one brick costs while it is made and written: the leaf with its share of the tree, then the file's bytes; NanoVDB
 * has a copy of its own between the two. */
static double brick_bytes(const shape_voxel_request *request, vdb_format format)
{
    double leaf = 4.0 * SHAPE_VOXEL_BRICK + 200;
    if (request->quantity == SHAPE_VOXEL_SAMPLE)
        leaf *= 3;
    return leaf * (format == VDB_FORMAT_NVDB ? 3 : 2);
}

typedef struct question {
    const shape_volume *volume;
    const shape_voxel_request *requests;
    size_t request_count;
    vdb_format format;
    double min[3], max[3], longest;
} question;

static double brick_count(const shape_voxel_lattice *l)
{
    double count = 1;
    for (int k = 0; k < 3; k++)
        count *= ceil((double)l->size[k] / SHAPE_VOXEL_EDGE) + 1;
    return count;
}

/* Whether voxels of that edge fit. What the box alone says is enough where it does. */
static bool fits(const question *q, double edge)
{
    shape_error error;
    shape_voxel_lattice l;
    double room = (double)vdb.max_memory, most = 0;
    if (shape_voxels_lay_out(q->min, q->max, edge, !vdb.up, &l, &error))
        return false;
    if (q->format == VDB_FORMAT_RAW)
        return (double)l.size[0] * l.size[1] * l.size[2] * (vdb.half ? 6 : 4) <= room;
    for (size_t i = 0; i < q->request_count; i++)
        most += brick_count(&l) * brick_bytes(&q->requests[i], q->format);
    for (size_t i = 0; i < q->request_count && most > room; i++) {
        double bytes = brick_bytes(&q->requests[i], q->format);
        size_t bricks;
        cli_check(shape_voxels_count(q->volume, &l, &q->requests[i], (size_t)(room / bytes), &bricks, &error),
                  &error);
        room -= bytes * (double)bricks;
        if (room < 0)
            return false;
    }
    return true;
}

/* Three digits, not below x. */
static double rounded_up(double x)
{
    double unit = pow(10, floor(log10(x)) - 2);
    return ceil(x / unit - 1e-9) * unit;
}

/* The smallest voxel that fits, to a few per cent. */
static double smallest(const question *q)
{
    double good = q->longest, bad;
    for (bad = q->longest / 2; fits(q, bad) && q->longest / bad < SHAPE_VOXEL_MOST; bad /= 2)
        good = bad;
    for (int round = 0; round < 5; round++) {
        double middle = sqrt(good * bad);
        *(fits(q, middle) ? &good : &bad) = middle;
    }
    return rounded_up(good);
}

static double measured_error(const question *q, double edge)
{
    shape_error error;
    double rmse;
    cli_check(shape_voxels_error(q->volume, &q->requests[0], edge, ERROR_SAMPLES, ERROR_SEED, &rmse, &error),
              &error);
    return rmse;
}

/* The largest voxel found whose error is within --error: by factors of the square root of two, then halfway. */
static double edge_for_error(const question *q)
{
    double bad = 0, good = 0, edge = q->longest / 8, error = 0, best = INFINITY;
    for (; !(good > 0) && q->longest / edge <= ERROR_FINEST; edge /= sqrt(2)) {
        if (!fits(q, edge))
            break;
        error = measured_error(q, edge);
        best = fmin(best, error);
        *(error <= vdb.error ? &good : &bad) = edge;
    }
    if (!(good > 0))
        cli_fail("--error %g: voxels that fit --max-memory are off by %.3g still (allow more of either)",
                 vdb.error, best);
    for (int round = 0; round < 3 && bad > 0; round++) {
        double middle = sqrt(good * bad), own = measured_error(q, middle);
        if (own <= vdb.error)
            good = middle, error = own;
        else
            bad = middle;
    }
    cli_say("voxels of %.4g m (--resolution %.0f) keep the error at %.3g, within %g", good,
            ceil(q->longest / good), error, vdb.error);
    return good;
}

/* The same for the picture of a view. */
static double edge_for_view(const question *q, const shape_set *set)
{
    shape_error error;
    shape_view view;
    shape_light light;
    double edge, predicted;
    bool seen;
    cli_picture_apply(set, &view, &light);
    cli_check(shape_budget_voxel(q->volume, &view, &light, vdb.error, &edge, &predicted, &seen, &error),
              &error);
    if (!seen)
        cli_fail("--error: the view shows none of the clouds (turn it: --eye, --target)");
    if (!fits(q, edge))
        cli_fail("--error %g: this view needs voxels of %.3g m, and --max-memory has room for %.3g m (allow "
                 "more of either)",
                 vdb.error, edge, smallest(q));
    cli_say("voxels of %.4g m (--resolution %.0f): an error of %.2g is expected in the picture%s", edge,
            ceil(q->longest / edge), predicted,
            predicted > vdb.error ? " (more than --error; there is nothing finer)" : "");
    return edge;
}

shape_voxel_lattice vdb_choose_lattice(const cli_common *common, const shape_set *set,
                                       const shape_volume *volume, const shape_voxel_request *requests,
                                       size_t request_count, vdb_format format)
{
    shape_error error;
    shape_voxel_lattice lattice;
    question q = {.volume = volume, .requests = requests, .request_count = request_count, .format = format};
    bool any;
    cli_check(shape_voxels_bounds(volume, -1, !vdb.up, q.min, q.max, &any, &error), &error);
    if (!any)
        cli_fail("%s: no cloud in it has a primitive (there is nothing to write)", common->arguments[0]);
    for (int k = 0; k < 3; k++)
        q.longest = fmax(q.longest, q.max[k] - q.min[k]);
    double edge = vdb.voxel_size_given ? vdb.voxel_size : q.longest / (double)vdb.resolution;
    if (vdb.view)
        edge = edge_for_view(&q, set);
    else if (vdb.error_given)
        edge = edge_for_error(&q);
    else if (!fits(&q, edge)) {
        double good = smallest(&q);
        cli_fail("voxels of %g m need more than --max-memory %lld bytes (take --voxel-size %.3g, that is "
                 "--resolution %.0f, or allow more)",
                 edge, (long long)vdb.max_memory, good, floor(q.longest / good));
    }
    cli_check(shape_voxels_lay_out(q.min, q.max, edge, !vdb.up, &lattice, &error), &error);
    return lattice;
}
