/* Settings of the march for an allowed error: octaves by their size on the picture, steps, and cells of the light grid. The
 * errors of steps and octaves are measured on a few hundred rays of the picture; that of the light is told from small grids,
 * by how it shrinks from one to the next. Independent errors add by their squares. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "budget/view.h"
#include "shape/imageerror.h"

/* The rungs of steps have half as many again each; cells end at the default of all programs. */
enum { STEP_RUNGS = 16, CUTS = 5, CELL_RUNGS = 11, CELLS_TRIED = 4, CELLS_TRIED_MOST = 6, STEPS_GAP = 3 };
static const int cell_rungs[CELL_RUNGS] = {4, 6, 9, 13, 16, 20, 25, 30, 36, 42, 48};
static const double cut_pixels[CUTS] = {0, 0.5, 1, 2, 4};

/* What is predicted is raised by this before it is held against what is allowed (fitted, docs/error.md). */
static const double caution = 1.15;

typedef struct chooser {
    const shape_volume *volume;
    const shape_view *view;
    const shape_light *light;
    shape_march_options options;
    double allowed;
    shape_budget_choice *choice;
    double *across;         /* of each cloud in pixels, over that of the largest seen */
    double side, seen_side; /* longest side of all clouds, and of the largest seen [m] */
    probe probe;
    shape_volume cut; /* with fewer octaves */
    /* Found out: */
    int step_count, cut_count, tried;
    double step_error[STEP_RUNGS], looks[STEP_RUNGS]; /* looks: a ray of the picture */
    double cut_error[CUTS], cut_cost[CUTS];           /* cost: of a look, over that with all octaves */
    double cell_error[CELL_RUNGS], cell_cost[CELL_RUNGS];
} chooser;

/* --- what is there --- */

static double longest_side(shape_dvec3 low, shape_dvec3 high)
{
    return fmax(high.x - low.x, fmax(high.y - low.y, high.z - low.z));
}

static void measure_clouds(chooser *c)
{
    shape_budget_choice *choice = c->choice;
    shape_dvec3 least = {INFINITY, INFINITY, INFINITY}, most = {-INFINITY, -INFINITY, -INFINITY};
    double largest = 0;
    for (size_t i = 0; i < c->volume->cloud_count; i++) {
        const shape_volume_cloud *cloud = &c->volume->clouds[i];
        shape_dvec3 low, high;
        if (shape_box_is_empty(cloud->box))
            continue;
        shape_frame_box(&cloud->frame, cloud->box, &low, &high);
        least = shape_dvec3_make(fmin(least.x, low.x), fmin(least.y, low.y), fmin(least.z, low.z));
        most = shape_dvec3_make(fmax(most.x, high.x), fmax(most.y, high.y), fmax(most.z, high.z));
        if (choice->sights[i] != SHAPE_BUDGET_SEEN)
            continue;
        choice->seen++;
        c->seen_side = fmax(c->seen_side, longest_side(low, high));
        /* Where the eye is inside, it fills the picture. */
        c->across[i] = fmin(shape_budget_pixels(c->view, low, high), 4.0 * c->view->height);
        largest = fmax(largest, c->across[i]);
    }
    for (size_t i = 0; i < c->volume->cloud_count; i++)
        c->across[i] = largest > 0 ? c->across[i] / largest : 0;
    c->side = choice->seen ? longest_side(least, most) : 1;
}

/* Cells of each cloud's grid: the fewer, the smaller it is in the picture. */
static void set_cells(const chooser *c, int cells)
{
    for (size_t i = 0; i < c->volume->cloud_count; i++) {
        bool seen = c->choice->sights[i] == SHAPE_BUDGET_SEEN;
        c->choice->resolutions[i] = seen ? (int)fmax(ceil(cells * c->across[i]), 2) : 0;
    }
}

static int rung_steps(const chooser *c, int rung)
{
    return (int)fmin(ceil(c->side / c->seen_side * 6 * pow(1.5, rung)), 1e6);
}

static shape_status make_marcher(chooser *c, int cells, int steps, shape_marcher **marcher,
                                 shape_error *error)
{
    shape_march_options options = c->options;
    set_cells(c, cells);
    options.resolutions = c->choice->resolutions;
    options.step = c->side / steps;
    shape_status status = shape_marcher_create(c->volume, c->light, c->view->eye, &options, marcher, error);
    if (!status)
        c->probe.work.cells += shape_marcher_work(*marcher).cells;
    return status;
}

/* --- steps --- */

/* Up the rungs, until three of them change no more than a part of what is allowed. */
static shape_status try_steps(chooser *c, shape_marcher *marcher, probe_picture *pictures, shape_error *error)
{
    shape_status status = SHAPE_OK;
    int k = 0;
    for (; k < STEP_RUNGS && !status; k++) {
        uint64_t before = c->probe.work.looks;
        marcher->step = c->side / rung_steps(c, k);
        status = probe_march(&c->probe, marcher, &pictures[k], error);
        c->looks[k] = (double)(c->probe.work.looks - before) / c->probe.tries;
        if (k >= STEPS_GAP &&
            probe_change(&c->probe, &pictures[k - STEPS_GAP], &pictures[k]) <= 0.3 * c->allowed) {
            k++;
            break;
        }
    }
    c->step_count = k;
    for (int i = 0; i < k && !status; i++)
        c->step_error[i] = probe_change(&c->probe, &pictures[i], &pictures[k - 1]);
    /* The last itself: errors fall by a third at least from rung to rung. */
    if (k > 1)
        c->step_error[k - 1] = c->step_error[k - 2] / 2;
    return status;
}

/* --- octaves --- */

/* How many octaves have cells of at least so many pixels, seen at the nearest. */
static int octaves_for(const chooser *c, size_t i, double pixels)
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

static void cut_octaves(shape_volume_cloud *cloud, int octaves)
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
        int octaves = octaves_for(c, i, pixels), before = cloud->field.octaves;
        *cloud = c->volume->clouds[i];
        changed = changed || octaves != before;
        all += c->across[i] * (2 + cloud->field.octaves);
        kept += c->across[i] * (2 + octaves);
        cut_octaves(cloud, octaves);
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

static shape_status try_octaves(chooser *c, shape_marcher *marcher, const probe_picture *whole,
                                probe_picture *picture, shape_error *error)
{
    shape_status status = SHAPE_OK;
    c->cut_count = 1;
    c->cut_error[0] = 0;
    make_cut(c, 0, &c->cut_cost[0]);
    look_through(marcher, &c->cut);
    for (int k = 1; k < CUTS && !status; k++) {
        /* A cut that changes nothing costs what the one before it does. */
        c->cut_error[k] = c->cut_error[k - 1];
        if (make_cut(c, cut_pixels[k], &c->cut_cost[k])) {
            status = probe_march(&c->probe, marcher, picture, error);
            c->cut_error[k] = probe_change(&c->probe, picture, whole);
        }
        c->cut_count = k + 1;
        if (c->cut_error[k] > c->allowed)
            break;
    }
    look_through(marcher, c->volume);
    return status;
}

/* --- light --- */

/* The slope V of pictures over 1 / cells, by least squares over all grids tried but the coarsest. How the cells happen to
 * lie on the cloud is noise in it, which makes V longer: by the residuals' share it is shortened (James and Stein 1961). */
static void find_slope(const chooser *c, const probe_picture *pictures, probe_picture *slope)
{
    double mean = 0, square = 0, length = 0, noise = 0;
    int count = c->tried - 1;
    const double *last = pictures[count].rgb;
    for (int k = 1; k <= count; k++)
        mean += 1.0 / cell_rungs[k] / count;
    for (int k = 1; k <= count; k++)
        square += pow(1.0 / cell_rungs[k] - mean, 2);
    for (int i = 0; i < 3 * c->probe.rays; i++) {
        double sum = 0, middle = 0, weight = 1 / (last[i] * last[i] + SHAPE_IMAGEERROR_EPSILON);
        for (int k = 1; k <= count; k++) {
            sum += pictures[k].rgb[i] * (1.0 / cell_rungs[k] - mean);
            middle += pictures[k].rgb[i] / count;
        }
        slope->rgb[i] = sum / square;
        length += weight * slope->rgb[i] * slope->rgb[i];
        for (int k = 1; k <= count; k++) {
            double rest = pictures[k].rgb[i] - middle - slope->rgb[i] * (1.0 / cell_rungs[k] - mean);
            noise += weight * rest * rest / ((count - 2) * square);
        }
    }
    double keep = length > 0 ? fmax(1 - noise / length, 0.25) : 0;
    for (int i = 0; i < 3 * c->probe.rays; i++)
        slope->rgb[i] *= keep;
}

/* Upwind differences make the light's error shrink like 1 / cells: picture(c) = picture(48) + V (1 / c - 1 / 48). Of grids
 * that were made the error is measured against that picture(48); of others it is V's. spare: three pictures. */
static void extrapolate(chooser *c, const probe_picture *pictures, probe_picture *spare)
{
    probe_picture *slope = spare, *off = spare + 1, *finest = spare + 2;
    double full = 1.0 / cell_rungs[CELL_RUNGS - 1];
    int last = c->tried - 1, values = 3 * c->probe.rays;
    find_slope(c, pictures, slope);
    for (int i = 0; i < values; i++)
        finest->rgb[i] = pictures[last].rgb[i] + slope->rgb[i] * (full - 1.0 / cell_rungs[last]);
    for (int k = 0; k < CELL_RUNGS; k++) {
        for (int i = 0; i < values; i++)
            off->rgb[i] = finest->rgb[i] + slope->rgb[i] * (1.0 / cell_rungs[k] - full);
        c->cell_error[k] = probe_change(&c->probe, k <= last ? &pictures[k] : off, finest);
    }
}

static shape_status try_grid(chooser *c, int k, int steps, probe_picture *picture, shape_error *error)
{
    shape_marcher *marcher = NULL;
    uint64_t before = c->probe.work.cells;
    shape_status status = make_marcher(c, cell_rungs[k], steps, &marcher, error);
    c->cell_cost[k] = (double)(c->probe.work.cells - before);
    if (!status)
        status = probe_march(&c->probe, marcher, picture, error);
    shape_marcher_destroy(marcher);
    return status;
}

/* The first few grids; further ones as long as what would do is much dearer than they are. */
static shape_status try_light(chooser *c, int steps, probe_picture *pictures, shape_error *error)
{
    shape_status status = SHAPE_OK;
    probe_picture *spare = malloc(3 * sizeof *spare);
    if (!spare)
        return shape_error_memory(error);
    for (int k = 0; k < CELLS_TRIED_MOST && !status; k++) {
        status = try_grid(c, k, steps, &pictures[k], error);
        c->tried = k + 1;
        if (status || c->tried < CELLS_TRIED)
            continue;
        extrapolate(c, pictures, spare);
        int enough = 0;
        while (enough < CELL_RUNGS - 1 && c->cell_error[enough] > 0.8 * c->allowed)
            enough++;
        if (enough < k + 3)
            break;
    }
    free(spare);
    for (int k = 1; k < CELL_RUNGS; k++)
        if (k >= c->tried)
            c->cell_cost[k] = c->cell_cost[k - 1] * pow((double)cell_rungs[k] / cell_rungs[k - 1], 3);
    return status;
}

/* --- the choice --- */

/* Cells count as so many looks: their sun march, and the rounds of the solution for the scattered light. */
static const double cell_looks = 25;

static double total_error(const chooser *c, int step, int cut, int cell)
{
    double s = c->step_error[step], o = c->cut_error[cut], l = c->cell_error[cell];
    return sqrt(s * s + o * o + l * l);
}

static void decide(chooser *c, int *step, int *cut, int *cell)
{
    shape_budget_choice *choice = c->choice;
    double rays = (double)c->view->width * c->view->height * c->options.samples, least = INFINITY;
    *step = c->step_count - 1, *cut = 0, *cell = CELL_RUNGS - 1;
    for (int s = 0; s < c->step_count; s++)
        for (int o = 0; o < c->cut_count; o++)
            for (int l = 0; l < CELL_RUNGS; l++) {
                double cost = c->cut_cost[o] * rays * c->looks[s] +
                              cell_looks * c->cell_cost[l] * (0.5 + 0.5 * c->cut_cost[o]);
                if (caution * total_error(c, s, o, l) <= c->allowed && cost < least) {
                    least = cost;
                    *step = s, *cut = o, *cell = l;
                }
            }
    choice->predicted = caution * total_error(c, *step, *cut, *cell);
}

static void describe(chooser *c, int step, int cut, int cell)
{
    shape_budget_choice *choice = c->choice;
    choice->steps = rung_steps(c, step);
    choice->step = c->side / choice->steps;
    choice->pixels = cut_pixels[cut];
    choice->cells = cell_rungs[cell];
    set_cells(c, choice->cells);
    for (size_t i = 0; i < c->volume->cloud_count; i++) {
        choice->cloud_octaves[i] = octaves_for(c, i, choice->pixels);
        if (choice->sights[i] != SHAPE_BUDGET_SEEN)
            continue;
        choice->octaves =
            choice->cloud_octaves[i] > choice->octaves ? choice->cloud_octaves[i] : choice->octaves;
        int own = c->volume->clouds[i].field.octaves;
        choice->octaves_of = own > choice->octaves_of ? own : choice->octaves_of;
    }
}

static shape_status choose(chooser *c, shape_error *error)
{
    shape_marcher *marcher = NULL;
    probe_picture *pictures = malloc((STEP_RUNGS + 1) * sizeof *pictures);
    shape_status status = pictures ? SHAPE_OK : shape_error_memory(error);
    if (!status)
        status = make_marcher(c, cell_rungs[2], rung_steps(c, 0), &marcher, error);
    uint64_t cells = c->probe.work.cells;
    if (!status)
        status = probe_open(&c->probe, marcher, c->view, error);
    c->probe.work.cells = cells;
    if (!status)
        status = try_steps(c, marcher, pictures, error);
    if (!status)
        status = try_octaves(c, marcher, &pictures[c->step_count - 1], &pictures[STEP_RUNGS], error);
    shape_marcher_destroy(marcher);
    int step = 0, cut, cell;
    while (step < c->step_count - 1 && c->step_error[step] > 0.5 * c->allowed)
        step++;
    if (!status)
        status = try_light(c, rung_steps(c, step), pictures, error);
    free(pictures);
    if (status)
        return status;
    decide(c, &step, &cut, &cell);
    describe(c, step, cut, cell);
    c->choice->work = c->probe.work;
    return SHAPE_OK;
}

static shape_status check(const shape_view *view, const shape_light *light,
                          const shape_march_options *options, double allowed, shape_error *error)
{
    shape_status status = shape_view_check(view, error);
    if (!status)
        status = shape_light_check(light, error);
    if (!status)
        status = shape_march_check(options, error);
    if (!status && !(allowed >= 1e-4 && allowed <= 1))
        status =
            shape_error_set(error, SHAPE_ERROR_ARGUMENT, "an error of %g (it must be 0.0001 to 1)", allowed);
    if (!status && (options->light != SHAPE_MARCH_GRID || options->stepping != SHAPE_STEP_FIXED))
        status = shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                                 "an allowed error goes with the light grid and steps of one length");
    return status;
}

shape_status shape_budget_march(const shape_volume *volume, const shape_view *view, const shape_light *light,
                                const shape_march_options *options, double allowed,
                                shape_budget_choice *choice, shape_error *error)
{
    size_t count = volume->cloud_count + 1;
    memset(choice, 0, sizeof *choice);
    shape_status status = check(view, light, options, allowed, error);
    if (status)
        return status;
    chooser *c = calloc(1, sizeof *c);
    choice->clouds = volume->cloud_count;
    choice->sights = calloc(count, sizeof *choice->sights);
    choice->resolutions = calloc(count, sizeof *choice->resolutions);
    choice->cloud_octaves = calloc(count, sizeof *choice->cloud_octaves);
    if (c) {
        *c = (chooser){.volume = volume,
                       .view = view,
                       .light = light,
                       .options = *options,
                       .allowed = allowed,
                       .choice = choice,
                       .cut = *volume};
        c->options.progress = NULL;
        c->across = calloc(count, sizeof *c->across);
        c->cut.clouds = calloc(count, sizeof *c->cut.clouds);
    }
    if (!c || !choice->sights || !choice->resolutions || !choice->cloud_octaves || !c->across ||
        !c->cut.clouds) {
        status = shape_error_memory(error);
    } else {
        memcpy(c->cut.clouds, volume->clouds, volume->cloud_count * sizeof *volume->clouds);
        shape_budget_sights(volume, view, light, options->opaque, allowed, choice->sights);
        measure_clouds(c);
        if (choice->seen)
            status = choose(c, error);
        else
            describe(c, 0, 0, 0), choice->steps = 1, choice->step = c->side;
    }
    if (c) {
        free(c->across);
        free(c->cut.clouds);
    }
    free(c);
    return status;
}

void shape_budget_free(shape_budget_choice *choice)
{
    free(choice->sights);
    free(choice->resolutions);
    free(choice->cloud_octaves);
    memset(choice, 0, sizeof *choice);
}

void shape_budget_apply(const shape_budget_choice *choice, shape_volume *volume, shape_march_options *options)
{
    for (size_t i = 0; i < volume->cloud_count; i++)
        cut_octaves(&volume->clouds[i], choice->cloud_octaves[i]);
    options->step = choice->step;
    options->resolution = choice->cells < 2 ? 2 : choice->cells;
    options->resolutions = choice->resolutions;
}
