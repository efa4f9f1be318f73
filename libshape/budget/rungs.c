/* What steps, octaves and light grids cost and miss, measured on a few hundred rays of the picture: steps until more of them
 * change nothing, octaves left out one after the other, and light grids up to where it is clear which will do. */
#include <math.h>
#include <stdlib.h>

#include "budget/chooser.h"
#include "base/memory.h"

enum { GRIDS_LEAST = 3, GRIDS_LAYER = 4 };
const int chooser_cells[CELL_RUNGS] = {4, 6, 8, 12, 16, 24, 32, 40, 48};
const double chooser_pixels[CUTS] = {0, 0.5, 1, 2, 4};

void chooser_set_cells(const chooser *c, int cells)
{
    const bool all =
        cells == chooser_cells[CELL_RUNGS - 1]; /* nothing finer is on offer: it is to miss nothing */
    for (size_t i = 0; i < c->volume->cloud_count; i++) {
        bool seen = c->choice->sights[i] == SHAPE_BUDGET_SEEN;
        c->choice->resolutions[i] = seen ? (int)fmax(ceil(all ? cells : cells * c->across[i]), 2) : 0;
    }
}

int chooser_steps(const chooser *c, int rung)
{
    return (int)fmin(ceil(c->side / c->seen_side * 6 * pow(2, 0.5 * rung)), 1e6);
}

/* What a cell of a light grid costs, in looks: its march to the sun and its mean density; and each round of the solution
 * for the scattered light. Fitted to the times of forty scenes. */
static const double cell_looks = 5, visit_looks = 0.8;

static shape_status make_grid(chooser *c, int k, shape_error *error)
{
    shape_march_options options = c->options;
    chooser_set_cells(c, chooser_cells[k]);
    options.resolutions = c->choice->resolutions;
    shape_status status =
        shape_marcher_create(c->volume, c->light, c->view->eye, &options, &c->grids[k], error);
    if (status)
        return status;
    c->tried = k + 1;
    shape_march_work work = shape_marcher_work(c->grids[k]);
    c->cell_cost[k] = cell_looks * (double)work.cells + visit_looks * (double)work.visits;
    c->probe.work.cells += work.cells;
    c->probe.work.visits += work.visits;
    return SHAPE_OK;
}

void chooser_drop(chooser *c)
{
    for (int i = 0; i < GRIDS_MOST; i++) {
        shape_marcher_destroy(c->grids[i]);
        c->grids[i] = NULL;
    }
}

static shape_status look(chooser *c, int grid, int step, probe_picture *picture, shape_error *error)
{
    c->grids[grid]->step = c->side / chooser_steps(c, step);
    return probe_march(&c->probe, c->grids[grid], picture, error);
}

/* --- steps --- */

/* Up every other rung, until twice as many steps change no more than a part of what is allowed. */
static shape_status try_steps(chooser *c, int grid, probe_picture *pictures, shape_error *error)
{
    int k = 0;
    for (; k < STEP_RUNGS; k += 2) {
        uint64_t before = c->probe.work.looks;
        shape_status status = look(c, grid, k, &pictures[k], error);
        if (status)
            return status;
        c->looks[k] = (double)(c->probe.work.looks - before) / c->probe.tries;
        if (k > 0 && probe_change(&c->probe, &pictures[k - 2], &pictures[k]) <= 0.2 * c->allowed) {
            k += 2;
            break;
        }
    }
    c->step_count = k - 1;
    for (int i = 0; i < k - 2; i += 2)
        c->step_error[i] = probe_change(&c->probe, &pictures[i], &pictures[k - 2]);
    /* The last itself: of order 1 at the jumps of a density. */
    c->step_error[k - 2] = k >= 4 ? c->step_error[k - 4] / 2 : 0;
    for (int i = 1; i < k - 2; i += 2) {
        c->step_error[i] = sqrt(c->step_error[i - 1] * c->step_error[i + 1]);
        c->looks[i] = sqrt(c->looks[i - 1] * c->looks[i + 1]);
    }
    return SHAPE_OK;
}

/* --- octaves --- */

int chooser_octaves(const chooser *c, size_t i, double pixels)
{
    const shape_volume_cloud *cloud = &c->volume->clouds[i];
    shape_dvec3 low, high;
    /* Nothing is gained where there is no noise. */
    bool plain = cloud->field.model == SHAPE_MODEL_GRID ||
                 (cloud->field.model == SHAPE_MODEL_UNIFORM && !cloud->detailed);
    if (shape_box_is_empty(cloud->box) || pixels == 0 || plain)
        return cloud->field.octaves;
    shape_frame_box(&cloud->frame, cloud->box, &low, &high);
    double across = shape_budget_pixels(c->view, low, high);
    double metres = shape_dvec3_length(shape_dvec3_sub(high, low));
    double cell = cbrt(fabs(shape_frame_determinant(&cloud->frame))) / (double)cloud->inverse_noise_scale;
    int octaves = 1;
    while (octaves < cloud->field.octaves && ldexp(cell, -octaves) * across / metres >= pixels)
        octaves++;
    return octaves;
}

void chooser_cut(shape_volume_cloud *cloud, int octaves)
{
    cloud->mean_octaves += cloud->field.octaves - octaves;
    cloud->field.octaves = octaves;
}

/* The volume with fewer octaves, into c->cut; false where that changes nothing. *cost: of a look. */
static bool make_cut(chooser *c, double pixels, double *cost)
{
    double all = 0, kept = 0;
    bool changed = false;
    for (size_t i = 0; i < c->volume->cloud_count; i++) {
        shape_volume_cloud *cloud = &c->cut.clouds[i];
        int octaves = chooser_octaves(c, i, pixels), before = cloud->field.octaves;
        *cloud = c->volume->clouds[i];
        changed = changed || octaves != before;
        all += c->across[i] * (2 + cloud->field.octaves);
        kept += c->across[i] * (2 + octaves);
        chooser_cut(cloud, octaves);
    }
    *cost = all > 0 ? kept / all : 1;
    return changed;
}

static void look_through(shape_marcher *marcher, const shape_volume *volume)
{
    marcher->volume = volume;
    for (size_t i = 0; i < volume->cloud_count; i++)
        marcher->clouds[i].cloud = &volume->clouds[i];
}

/* whole: the picture with all of them, and the steps of rung `step`. */
static shape_status try_octaves(chooser *c, int grid, int step, const probe_picture *whole,
                                probe_picture *picture, shape_error *error)
{
    shape_status status = SHAPE_OK;
    c->cut_count = 1;
    c->cut_error[0] = 0;
    make_cut(c, 0, &c->cut_cost[0]);
    look_through(c->grids[grid], &c->cut);
    for (int k = 1; k < CUTS; k++) {
        /* A cut that changes nothing costs what the one before it does. */
        c->cut_error[k] = c->cut_error[k - 1];
        if (make_cut(c, chooser_pixels[k], &c->cut_cost[k])) {
            status = look(c, grid, step, picture, error);
            if (status)
                break;
            c->cut_error[k] = probe_change(&c->probe, picture, whole);
        }
        c->cut_count = k + 1;
        if (c->cut_error[k] > 1.5 * c->allowed)
            break;
    }
    look_through(c->grids[grid], c->volume);
    return status;
}

/* --- light --- */

/* Errors are told from small grids to within such factors. Where none of the grids made will do, the next one may cost that
 * share of the picture; and so many looks, where it may save much of a small one. */
static const double doubt = 1.4, hope = 0.4, share = 0.25, looks_free = 1e5;

/* A layer's grid has no more cells across at 6 than at 4. */
static bool has_layer(const chooser *c)
{
    for (size_t i = 0; i < c->volume->cloud_count; i++)
        if (c->volume->clouds[i].field.model == SHAPE_MODEL_LAYER &&
            c->choice->sights[i] == SHAPE_BUDGET_SEEN)
            return true;
    return false;
}

/* The light's error shrinks like 1 / cells, those of the clear border not counted; none is left at the last rung. */
static double off(int cells)
{
    return 1.0 / (cells - 2) - 1.0 / (chooser_cells[CELL_RUNGS - 1] - 2);
}

/* The share of an error `change` that is still there where it has shrunk from one rung's to another's. */
static double left(double change, int from, int to)
{
    /* NOLINTNEXTLINE: `from` is at least 0, since grids have been tried */
    double a = off(chooser_cells[from]), b = off(chooser_cells[to]);
    return change * b / (a - b);
}

/* Errors of the grids made, against the finest of them and what that one misses itself, told from the last two changes; of
 * finer ones by that, which shrinks more slowly than by the law. The 0.7 was fitted to forty scenes (docs/error.md). */
static void rate_light(chooser *c, const probe_picture *pictures)
{
    int last = c->tried - 1; /* 2 at least: GRIDS_LEAST have been tried */
    for (int k = 0; k < last; k++)
        c->cell_error[k] = probe_change(&c->probe, &pictures[k], &pictures[last]);
    c->tail = sqrt(0.7 * left(c->cell_error[last - 1], last - 1, last) *
                   left(c->cell_error[last - 2], last - 2, last));
    for (int k = 0; k < last; k++)
        c->cell_error[k] = hypot(c->cell_error[k], c->tail);
    for (int k = last; k < CELL_RUNGS; k++)
        c->cell_error[k] = c->tail * pow(off(chooser_cells[k]) / off(chooser_cells[last]), 0.7);
}

/* What finer grids cost: their cells. */
static void rate_cost(chooser *c)
{
    int last = c->tried - 1;
    for (int k = last + 1; k < CELL_RUNGS; k++)
        c->cell_cost[k] = c->cell_cost[last] * pow((double)chooser_cells[k] / chooser_cells[last], 3);
}

/* The least that the picture costs [looks], were all errors so many times what they are thought to be. */
static double least_cost(const chooser *c, double times)
{
    double rays = (double)c->view->width * c->view->height * c->options.samples;
    double least = rays * c->looks[c->step_count - 1] + c->cell_cost[CELL_RUNGS - 1];
    for (int s = 0; s < c->step_count; s++)
        for (int l = 0; l < CELL_RUNGS; l++)
            if (times * hypot(c->step_error[s], c->cell_error[l]) <= c->allowed)
                least = fmin(least, rays * c->looks[s] + c->cell_cost[l]);
    return least;
}

/* Grids from coarse to fine, as long as the next one costs less than knowing better may save. */
static shape_status try_light(chooser *c, int step, probe_picture *pictures, shape_error *error)
{
    shape_status status = SHAPE_OK;
    int least = has_layer(c) ? GRIDS_LAYER : GRIDS_LEAST;
    for (int k = 0; k < GRIDS_MOST && !status; k++) {
        if (!c->grids[k])
            status = make_grid(c, k, error);
        if (!status)
            status = look(c, k, step, &pictures[k], error);
        if (status || k + 1 < least || k + 1 == GRIDS_MOST)
            continue;
        rate_light(c, pictures);
        rate_cost(c);
        double picture = least_cost(c, doubt), saved = picture - least_cost(c, hope);
        double granted = c->cell_error[k] * doubt > c->allowed ? share * picture : 0;
        if (saved > 0.4 * picture)
            granted = fmax(granted, looks_free);
        if (c->cell_cost[k + 1] > fmax(saved, granted))
            break;
    }
    rate_cost(c);
    return status;
}

/* The finer the light, the more of it a step can miss: up the rungs once more, with the finest grid. Not where fewer steps miss
 * no more of it than they did of coarse light: `fewer` is its picture with those of rung `step`. */
static shape_status confirm_steps(chooser *c, int step, const probe_picture *fewer, probe_picture *spare,
                                  shape_error *error)
{
    const double alike = 1.1;
    shape_status status = look(c, c->tried - 1, c->step_count - 1, &c->best, error);
    if (status)
        return status;
    if (step < c->step_count - 1 && probe_change(&c->probe, fewer, &c->best) <= alike * c->step_error[step])
        return SHAPE_OK;
    while (c->step_count + 1 < STEP_RUNGS) {
        int last = c->step_count - 1;
        status = look(c, c->tried - 1, last + 2, spare, error);
        if (status)
            return status;
        double change = probe_change(&c->probe, &c->best, spare);
        c->best = *spare;
        if (change <= 0.2 * c->allowed)
            break;
        for (int i = 0; i < last; i++)
            c->step_error[i] = hypot(c->step_error[i], change);
        c->step_error[last] = change;
        c->step_error[last + 2] = 0.5 * change;
        c->step_error[last + 1] = sqrt(0.5) * change;
        c->looks[last + 2] = 2 * c->looks[last];
        c->looks[last + 1] = sqrt(2) * c->looks[last];
        c->step_count += 2;
    }
    return SHAPE_OK;
}

/* --- all --- */

shape_status chooser_measure(chooser *c, shape_error *error)
{
    enum { STEPS_GRID = 1 };
    probe_picture *pictures = malloc((STEP_RUNGS + 1 + GRIDS_MOST) * sizeof *pictures);
    shape_status status = pictures ? SHAPE_OK : shape_error_memory(error);
    for (int k = 0; k <= STEPS_GRID && !status; k++)
        status = make_grid(c, k, error);
    shape_march_work work = c->probe.work;
    if (!status)
        status = probe_open(&c->probe, c->grids[STEPS_GRID], c->view, error);
    c->probe.work = work;
    if (!status)
        status = try_steps(c, STEPS_GRID, pictures, error);
    /* What octaves and light change is told with as few steps as will do; only every other rung's were looked through. */
    int step = 0;
    while (!status && step < c->step_count - 1 && c->step_error[step] > 0.5 * c->allowed)
        step += 2;
    probe_picture *lit = pictures ? pictures + STEP_RUNGS + 1 : NULL;
    if (!status)
        status = try_octaves(c, STEPS_GRID, step, &pictures[step], &pictures[STEP_RUNGS], error);
    if (!status)
        status = try_light(c, step, lit, error);
    if (!status)
        status = confirm_steps(c, step, &lit[c->tried - 1], &pictures[0], error);
    free(pictures);
    return status;
}

shape_status chooser_confirm(chooser *c, int *step, int cut, int cell, double *found, shape_error *error)
{
    if (cell < c->tried || !has_layer(c))
        return SHAPE_OK;
    double cost, change = 0;
    shape_marcher *unmade = c->grids[0], *made = NULL;
    probe_picture *pictures = malloc(2 * sizeof *pictures);
    shape_march_options options = c->options;
    if (!pictures)
        return shape_error_memory(error);
    chooser_set_cells(c, chooser_cells[cell]);
    options.resolutions = c->choice->resolutions;
    make_cut(c, chooser_pixels[cut], &cost);
    shape_status status = shape_marcher_create(&c->cut, c->light, c->view->eye, &options, &made, error);
    c->grids[0] = made;
    if (!status)
        status = look(c, 0, *step, &pictures[0], error);
    while (!status && *step + 2 < STEP_RUNGS) {
        status = look(c, 0, *step + 2, &pictures[1], error);
        if (status)
            break;
        change = probe_change(&c->probe, &pictures[0], &pictures[1]);
        if (2 * change <= 0.5 * c->allowed) /* of order 1: twice the change is what there is to miss */
            break;
        pictures[0] = pictures[1];
        *step += 2;
    }
    *found = fmax(*found, 2 * change);
    c->grids[0] = unmade;
    shape_marcher_destroy(made);
    free(pictures);
    return status;
}

shape_status chooser_try(chooser *c, int step, int cut, int cell, double *found, shape_error *error)
{
    int g = cell < c->tried ? cell : c->tried - 1;
    double cost;
    probe_picture *picture = malloc(sizeof *picture);
    if (!picture)
        return shape_error_memory(error);
    make_cut(c, chooser_pixels[cut], &cost);
    look_through(c->grids[g], &c->cut);
    shape_status status = look(c, g, step, picture, error);
    look_through(c->grids[g], c->volume);
    /* The finer the light, the more of it a step misses: as much as its cells are smaller. */
    double finer = (double)chooser_cells[cell] / chooser_cells[g];
    if (!status)
        *found = hypot(finer * probe_change(&c->probe, picture, &c->best),
                       cell < c->tried ? c->tail : c->cell_error[cell]);
    free(picture);
    return status;
}
