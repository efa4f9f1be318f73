/* Fits a union of ellipsoids to a volume (shape/volumefit.h): the largest ball that fits is set where the volume is least
 * covered, again and again; then all are moved together by gradient descent on the squared error of their soft union,
 * while those that do little are taken away and set anew where most is missing. */
#include "shape/volumefit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "generate/volumefit_private.h"
#include "primitive/axes.h"

shape_volumefit_options shape_volumefit_defaults(void)
{
    shape_volumefit_options options;
    memset(&options, 0, sizeof options);
    options.primitives = 64;
    options.resolution = 80;
    options.rounds = 240;
    options.model = SHAPE_MODEL_UNIFORM;
    return options;
}

shape_status shape_volumefit_check(const shape_volumefit_options *options, shape_error *error)
{
    if (options->primitives < 1 || options->primitives > SHAPE_VOLUMEFIT_MAX_PRIMITIVES)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "a fit of %zu primitives (it must be 1 to %d)",
                               options->primitives, SHAPE_VOLUMEFIT_MAX_PRIMITIVES);
    if (!(options->error >= 0 && isfinite(options->error)))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "a fit's error of %g (it must be 0 or more)",
                               options->error);
    if (options->resolution < 16 || options->resolution > 512)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "a fit of %d cells a side (it must be 16 to 512)",
                               options->resolution);
    if (options->rounds < 0 || options->rounds > 10000)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "a fit of %d rounds (it must be 0 to 10000)",
                               options->rounds);
    if (options->model != SHAPE_MODEL_UNIFORM && options->model != SHAPE_MODEL_SPHEROID)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "a fit's model must be uniform or spheroid, not number %d",
                               (int)options->model);
    return SHAPE_OK;
}

/* --- setting balls --- */

/* By how much the squared error falls where a ball is set. */
static double gain_of(const fit_union *u, const double centre[3], double radius)
{
    const fit_lattice *l = u->lattice;
    int low[3], high[3];
    double sum = 0;
    for (int a = 0; a < 3; a++) {
        low[a] = (int)fmax(floor(centre[a] - radius), 0);
        high[a] = (int)fmin(ceil(centre[a] + radius), l->n[a] - 1);
    }
    for (int z = low[2]; z <= high[2]; z++)
        for (int y = low[1]; y <= high[1]; y++)
            for (int x = low[0]; x <= high[0]; x++) {
                double dx = x + 0.5 - centre[0], dy = y + 0.5 - centre[1], dz = z + 0.5 - centre[2];
                if (dx * dx + dy * dy + dz * dz > radius * radius)
                    continue;
                size_t i = ((size_t)z * (size_t)l->n[1] + (size_t)y) * (size_t)l->n[0] + (size_t)x;
                double t = (double)l->target[i], before = 1 - (double)u->left[i] - t, after = 1 - t;
                sum += before * before - after * after;
            }
    return sum;
}

/* What finding places needs. */
typedef struct fit_scratch {
    uint8_t *bare;   /* solid and not covered */
    float *distance; /* to what is not bare */
} fit_scratch;

/* The best ball for what is bare: in the middle of the thickest part, as large as the solid allows. *gain is 0 where
 * there is none. */
static shape_status find_ball(const fit_union *u, fit_scratch *scratch, fit_primitive *ball, double *gain,
                              shape_error *error)
{
    const fit_lattice *l = u->lattice;
    for (size_t i = 0; i < l->count; i++)
        scratch->bare[i] = l->solid[i] && u->left[i] > 0.5f;
    shape_status status = fit_distances(l->n, scratch->bare, scratch->distance, error);
    if (status)
        return status;
    size_t best = 0;
    float score = 0;
    for (size_t i = 0; i < l->count; i++)
        if (scratch->distance[i] + 0.25f * l->depth[i] > score && scratch->bare[i]) {
            score = scratch->distance[i] + 0.25f * l->depth[i];
            best = i;
        }
    *gain = 0;
    if (!(score > 0))
        return SHAPE_OK;
    size_t nx = (size_t)l->n[0], ny = (size_t)l->n[1];
    double centre[3] = {(double)(best % nx) + 0.5, (double)(best / nx % ny) + 0.5,
                        (double)(best / nx / ny) + 0.5};
    double radius = fmax((double)l->depth[best] - 0.25, 0.75);
    *ball = fit_ball(centre, radius);
    *gain = gain_of(u, centre, radius);
    return SHAPE_OK;
}

/* Sets balls until there are `count`, or no more that help. */
static shape_status set_balls(fit_union *u, size_t count, fit_scratch *scratch, shape_error *error)
{
    shape_status status =
        shape_array_reserve((void **)&u->items, &u->capacity, count, sizeof *u->items, error);
    fit_union_fill(u);
    while (!status && u->count < count) {
        fit_primitive ball;
        double gain;
        status = find_ball(u, scratch, &ball, &gain, error);
        if (status || !(gain > 0))
            break;
        u->items[u->count++] = ball;
        fit_union_fill(u);
    }
    return status;
}

/* Takes away the least useful and sets it where most is missing, while that pays; at most `most` times. */
static shape_status move_useless(fit_union *u, size_t most, fit_scratch *scratch, shape_error *error)
{
    for (size_t i = 0; i < most; i++) {
        fit_union_fill(u);
        size_t least = 0;
        double use = INFINITY, gain;
        for (size_t k = 0; k < u->count; k++) {
            double here = fit_union_use(u, k);
            if (here < use) {
                use = here;
                least = k;
            }
        }
        fit_primitive ball;
        shape_status status = find_ball(u, scratch, &ball, &gain, error);
        if (status)
            return status;
        if (!(gain > 1.1 * use + 1))
            break;
        u->items[least] = ball;
    }
    return SHAPE_OK;
}

/* --- improving --- */

typedef struct fit_job {
    const shape_volumefit_options *options;
    fit_union u;
    fit_scratch scratch;
    bool stopped;
} fit_job;

static bool tell(fit_job *job, double done)
{
    const shape_volumefit_options *o = job->options;
    if (o->progress && !o->progress(o->progress_context, done))
        job->stopped = true;
    return !job->stopped;
}

/* Wide surfaces that see far first, then thin ones that tell the truth; long steps, then short ones. */
static shape_status improve(fit_job *job, double from, double to, shape_error *error)
{
    enum { MOVES_EVERY = 12 };
    int rounds = job->options->rounds;
    shape_status status = SHAPE_OK;
    for (int i = 0; i < rounds && !status && !job->stopped; i++) {
        double share = (double)i / rounds;
        job->u.width = 2.5 - 1.75 * share;
        if (i && i % MOVES_EVERY == 0 && share < 0.75)
            status = move_useless(&job->u, job->u.count / 16 + 1, &job->scratch, error);
        fit_union_fill(&job->u);
        fit_union_gradients(&job->u);
        fit_union_step(&job->u, 0.06 * pow(0.08, share));
        tell(job, from + (to - from) * share);
    }
    return status;
}

/* --- measuring --- */

/* Exactly, without soft surfaces: shares of cells (by 8 places) inside the union, into `left`. */
static void measure_cover(fit_union *u)
{
    const fit_lattice *l = u->lattice;
#pragma omp parallel for schedule(dynamic, 1)
    for (int z = 0; z < l->n[2]; z++)
        for (int y = 0; y < l->n[1]; y++)
            for (int x = 0; x < l->n[0]; x++) {
                int inside = 0;
                for (int k = 0; k < 8; k++) {
                    double at[3] = {x + (k & 1 ? 0.75 : 0.25), y + (k & 2 ? 0.75 : 0.25),
                                    z + (k & 4 ? 0.75 : 0.25)};
                    bool in = false;
                    for (size_t i = 0; i < u->count && !in; i++) {
                        const fit_primitive *p = &u->items[i];
                        const double *m = p->value + 3;
                        if (x < p->low[0] || x > p->high[0] || y < p->low[1] || y > p->high[1] ||
                            z < p->low[2] || z > p->high[2])
                            continue;
                        double sum = 0;
                        for (int a = 0; a < 3; a++) {
                            double v = m[3 * a] * (at[0] - p->value[0]) +
                                       m[3 * a + 1] * (at[1] - p->value[1]) +
                                       m[3 * a + 2] * (at[2] - p->value[2]);
                            sum += v * v;
                        }
                        in = sum <= 1;
                    }
                    inside += in;
                }
                u->left[((size_t)z * (size_t)l->n[1] + (size_t)y) * (size_t)l->n[0] + (size_t)x] =
                    (float)inside / 8;
            }
}

/* Error and overlap for densities (per cell) that are to keep the sum of extinction; *extinction is what does. Plain
 * densities are shares of cells; others count by their extinction, as the volume does. */
static void compare(const fit_lattice *l, const float *density, bool plain, shape_volumefit_report *report,
                    double *extinction)
{
    double mass = 0, sum = 0, squares = 0, cells = 0, both = 0, either = 0;
    for (size_t i = 0; i < l->count; i++) {
        mass += (double)l->extinction[i];
        sum += (double)density[i];
    }
    *extinction = sum > 0 ? mass / sum : 0;
    for (size_t i = 0; i < l->count; i++) {
        double miss = *extinction * (double)density[i] - (double)l->extinction[i];
        if (density[i] > 0 || l->extinction[i] > 0) {
            squares += miss * miss;
            cells++;
        }
        double share = plain ? 1 : *extinction / l->level;
        double a = fmin((double)density[i] * share, 1), b = (double)l->target[i];
        both += fmin(a, b);
        either += fmax(a, b);
    }
    report->error = cells > 0 ? sqrt(squares / cells) / l->level : 0;
    report->overlap = either > 0 ? both / either : 0;
}

/* --- out --- */

/* Columns of the inverse of m are conjugate half-diameters; Jacobi makes them axes. */
static shape_status put_primitive(const fit_primitive *p, const fit_lattice *l, double grow,
                                  shape_primitives *list, shape_error *error)
{
    const double *m = p->value + 3;
    shape_frame map = {{{m[0], m[1], m[2], 0}, {m[3], m[4], m[5], 0}, {m[6], m[7], m[8], 0}}}, back;
    if (!shape_frame_invert(&map, &back))
        return SHAPE_OK;
    shape_dvec3 axes[3];
    double length[3], scale = l->cell * grow;
    for (int j = 0; j < 3; j++)
        axes[j] = shape_dvec3_make(back.m[0][j], back.m[1][j], back.m[2][j]);
    shape_axes_diagonalize(axes);
    for (int j = 0; j < 3; j++) {
        length[j] = shape_dvec3_length(axes[j]);
        axes[j] = shape_dvec3_scale(axes[j], 1 / length[j]);
    }
    float at[3];
    for (int a = 0; a < 3; a++)
        at[a] = (float)((p->value[a] - 0.5 * l->n[a]) * l->cell);
    double least = fmin(length[0], fmin(length[1], length[2])),
           most = fmax(length[0], fmax(length[1], length[2]));
    if (most <= 1.02 * least) {
        shape_sphere s = {at[0], at[1], at[2], (float)(scale * cbrt(length[0] * length[1] * length[2]))};
        return shape_primitives_add_sphere(list, s, error);
    }
    if (shape_dvec3_dot(shape_dvec3_cross(axes[0], axes[1]), axes[2]) < 0)
        axes[2] = shape_dvec3_scale(axes[2], -1);
    shape_ellipsoid e = {.x = at[0],
                         .y = at[1],
                         .z = at[2],
                         .a = (float)(scale * length[0]),
                         .b = (float)(scale * length[1]),
                         .c = (float)(scale * length[2]),
                         .q = shape_quat_from_columns(axes[0], axes[1], axes[2])};
    return shape_primitives_add_ellipsoid(list, e, error);
}

static shape_status put_all(const fit_union *u, double grow, shape_primitives *list, shape_error *error)
{
    shape_status status = SHAPE_OK;
    list->sphere_count = list->ellipsoid_count = 0;
    for (size_t i = 0; i < u->count && !status; i++)
        status = put_primitive(&u->items[i], u->lattice, grow, list, error);
    return status;
}

/* Densities of the set's cloud in the lattice's cells, at eight places each. */
static shape_status sample_cloud(const shape_set *set, size_t cloud, const fit_lattice *l, float *density,
                                 shape_error *error)
{
    shape_volume *volume;
    shape_status status = shape_volume_create(set, &volume, error);
    if (status)
        return status;
    const shape_volume_cloud *c = &volume->clouds[cloud];
#pragma omp parallel for schedule(dynamic, 1)
    for (int z = 0; z < l->n[2]; z++)
        for (int y = 0; y < l->n[1]; y++)
            for (int x = 0; x < l->n[0]; x++) {
                float sum = 0;
                for (int k = 0; k < 8; k++) {
                    double at[3] = {x + (k & 1 ? 0.75 : 0.25), y + (k & 2 ? 0.75 : 0.25),
                                    z + (k & 4 ? 0.75 : 0.25)};
                    float p[3];
                    for (int a = 0; a < 3; a++)
                        p[a] = (float)((at[a] - 0.5 * l->n[a]) * l->cell);
                    sum += shape_cloud_density(c, shape_vec3_make(p[0], p[1], p[2]));
                }
                density[((size_t)z * (size_t)l->n[1] + (size_t)y) * (size_t)l->n[0] + (size_t)x] = sum / 8;
            }
    shape_volume_destroy(volume);
    return SHAPE_OK;
}

/* The spheroid's noise eats its edge away: primitives are grown by what leaves the least error. */
static shape_status choose_growth(fit_job *job, shape_set *set, size_t cloud, shape_volumefit_report *report,
                                  shape_error *error)
{
    double best = INFINITY, chosen = 1, extinction;
    shape_status status = SHAPE_OK;
    for (int pass = 0; pass < 9 && !status; pass++) {
        double grow = pass < 8 ? 1 + 0.12 * pass : chosen;
        shape_primitives *list = shape_set_list(set, cloud);
        status = put_all(&job->u, grow, list, error);
        if (!status && pass == 0)
            status = shape_cloud_choose_noise_scale(&set->clouds[cloud], list, error);
        if (!status)
            status = sample_cloud(set, cloud, job->u.lattice, job->u.left, error);
        if (status)
            break;
        compare(job->u.lattice, job->u.left, false, report, &extinction);
        set->clouds[cloud].medium.extinction = (float)extinction;
        if (report->error < best) {
            best = report->error;
            chosen = grow;
        }
    }
    return status;
}

static shape_status put_cloud(fit_job *job, const shape_medium *medium, shape_set *set, const char *name,
                              size_t *index, shape_volumefit_report *report, shape_error *error)
{
    const fit_lattice *l = job->u.lattice;
    double extinction;
    shape_status status = shape_set_add_cloud(set, name, index, error);
    if (status)
        return status;
    shape_cloud *cloud = &set->clouds[*index];
    cloud->frame.m[0][3] = l->middle.x;
    cloud->frame.m[1][3] = l->middle.y;
    cloud->frame.m[2][3] = l->middle.z;
    cloud->medium = *medium;
    cloud->field.model = job->options->model;
    if (cloud->field.model == SHAPE_MODEL_SPHEROID) {
        status = choose_growth(job, set, *index, report, error);
    } else {
        measure_cover(&job->u);
        compare(l, job->u.left, true, report, &extinction);
        cloud->medium.extinction = (float)extinction;
        status = put_all(&job->u, 1, shape_set_list(set, *index), error);
        if (!status)
            status = shape_cloud_choose_noise_scale(cloud, shape_set_list(set, *index), error);
    }
    report->primitives = shape_primitives_count(shape_set_list(set, *index));
    return status;
}

/* Grows the number of primitives until the error is met. */
static shape_status fit(fit_job *job, shape_volumefit_report *report, shape_error *error)
{
    enum { FIRST = 8 };
    const shape_volumefit_options *o = job->options;
    bool growing = o->error > 0;
    size_t count = growing && o->primitives > FIRST ? FIRST : o->primitives;
    double steps =
        growing && o->primitives > FIRST ? ceil(log((double)o->primitives / FIRST) / log(1.5)) + 1 : 1;
    double unused;
    shape_status status = SHAPE_OK;
    for (int step = 0; !status && !job->stopped; step++) {
        status = set_balls(&job->u, count, &job->scratch, error);
        if (!status && job->u.count)
            status = improve(job, fmin(step / steps, 1), fmin((step + 1) / steps, 1), error);
        if (status || !growing)
            break;
        fit_union_fill(&job->u);
        measure_cover(&job->u);
        compare(job->u.lattice, job->u.left, true, report, &unused);
        if (report->error <= o->error || count == o->primitives || job->u.count < count)
            break;
        count = count + (count + 1) / 2 < o->primitives ? count + (count + 1) / 2 : o->primitives;
    }
    fit_union_fill(&job->u);
    return status;
}

shape_status shape_volumefit(const shape_volume *volume, const shape_volumefit_options *options,
                             shape_set *set, const char *name, size_t *cloud, shape_volumefit_report *report,
                             shape_error *error)
{
    fit_lattice lattice;
    size_t index = 0;
    shape_status status = shape_volumefit_check(options, error);
    if (status)
        return status;
    memset(report, 0, sizeof *report);
    status = fit_lattice_make(volume, options->resolution, &lattice, error);
    fit_job job = {options, {.lattice = &lattice, .width = 1}, {NULL, NULL}, false};
    if (!status) {
        job.u.left = malloc(lattice.count * sizeof *job.u.left);
        job.scratch.bare = malloc(lattice.count);
        job.scratch.distance = malloc(lattice.count * sizeof *job.scratch.distance);
        if (!job.u.left || !job.scratch.bare || !job.scratch.distance)
            status = shape_error_memory(error);
    }
    if (!status)
        status = fit(&job, report, error);
    if (!status && !job.u.count)
        status = shape_error_set(error, SHAPE_ERROR_FORMAT,
                                 "nothing in it is thick enough to fit a primitive to (take more cells)");
    if (!status)
        status = put_cloud(&job, &volume->clouds[0].medium, set, name, &index, report, error);
    report->level = lattice.level;
    report->cell = lattice.cell;
    memcpy(report->cells, lattice.n, sizeof report->cells);
    report->reached = !(options->error > 0) || report->error <= options->error;
    if (cloud)
        *cloud = index;
    free(job.u.items);
    free(job.u.left);
    free(job.scratch.bare);
    free(job.scratch.distance);
    fit_lattice_free(&lattice);
    return status;
}
