/* Settings of the march for an allowed error: octaves by their size on the picture, steps, and cells of the light grid. The
 * errors of each are measured on a few hundred rays of the picture (rungs.c); of the combinations that are cheap enough, by
 * the sum of squares, the first few are drawn on these rays too, since errors cancel in part. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "budget/chooser.h"

/* What is predicted is raised by this before it is held against what is allowed (fitted, docs/error.md). */
static const double caution = 1.25;

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

/* --- the choice --- */

/* A combination of rungs. */
typedef struct offer {
    int step, cut, cell;
    double cost, error; /* looks; error by the sum of squares */
} offer;

static int by_cost(const void *a, const void *b)
{
    const offer *x = a, *y = b;
    return (x->cost > y->cost) - (x->cost < y->cost);
}

static size_t list_offers(const chooser *c, offer *offers)
{
    double rays = (double)c->view->width * c->view->height * c->options.samples;
    size_t count = 0;
    for (int s = 0; s < c->step_count; s++)
        for (int o = 0; o < c->cut_count; o++)
            for (int l = 0; l < CELL_RUNGS; l++) {
                double e = c->cut_error[o];
                offers[count++] = (offer){
                    s, o, l, c->cut_cost[o] * rays * c->looks[s] + c->cell_cost[l],
                    sqrt(c->step_error[s] * c->step_error[s] + e * e + c->cell_error[l] * c->cell_error[l])};
            }
    qsort(offers, count, sizeof *offers, by_cost);
    return count;
}

/* Whether one that was found wanting is at least as fine in everything. */
static bool is_coarser(const offer *o, const offer *wanting, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (o->step <= wanting[i].step && o->cut >= wanting[i].cut && o->cell <= wanting[i].cell)
            return true;
    return false;
}

/* The cheapest whose rays, drawn with all of it at once, are within what is allowed. Which are worth drawing is told by the
 * sum of their squares, times what that was found to be off so far. */
static shape_status decide(chooser *c, offer *chosen, shape_error *error)
{
    enum { TRIES = 24 };
    const double unsure = 1.4;
    offer wanting[TRIES];
    offer *offers = malloc(STEP_RUNGS * CUTS * CELL_RUNGS * sizeof *offers);
    if (!offers)
        return shape_error_memory(error);
    size_t count = list_offers(c, offers), tries = 0, next = 0;
    double off = 0.8;
    shape_status status = SHAPE_OK;
    bool found = false;
    for (; next < count && !status && !found && tries < TRIES; next++) {
        offer o = offers[next];
        double likely = off * o.error;
        if (caution * likely > c->allowed || is_coarser(&o, wanting, tries))
            continue;
        if (caution * o.error > 0.4 * c->allowed) {
            status = chooser_try(c, o.step, o.cut, o.cell, &o.error, error);
            off = fmax(0.5 * (off + off * o.error / likely), 0.6);
        }
        found = caution * o.error <= c->allowed;
        if (found)
            *chosen = o;
        else
            wanting[tries++] = o;
    }
    for (; next < count && !found; next++)
        if (unsure * fmax(off, 1) * offers[next].error <= c->allowed) {
            *chosen = offers[next];
            found = true;
        }
    free(offers);
    return status;
}

static void describe(chooser *c, int step, int cut, int cell)
{
    shape_budget_choice *choice = c->choice;
    choice->steps = chooser_steps(c, step);
    choice->step = c->side / choice->steps;
    choice->pixels = chooser_pixels[cut];
    choice->cells = chooser_cells[cell];
    chooser_set_cells(c, choice->cells);
    for (size_t i = 0; i < c->volume->cloud_count; i++) {
        choice->cloud_octaves[i] = chooser_octaves(c, i, choice->pixels);
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
    shape_status status = chooser_measure(c, error);
    offer chosen = {c->step_count - 1, 0, CELL_RUNGS - 1, 0, 0};
    if (!status) {
        chosen.error = hypot(c->step_error[chosen.step], c->cell_error[chosen.cell]);
        status = decide(c, &chosen, error);
        if (!status)
            status = chooser_confirm(c, &chosen.step, chosen.cut, chosen.cell, &chosen.error, error);
    }
    chooser_drop(c);
    if (status)
        return status;
    c->choice->predicted = caution * chosen.error;
    describe(c, chosen.step, chosen.cut, chosen.cell);
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
        chooser_cut(&volume->clouds[i], choice->cloud_octaves[i]);
    options->step = choice->step;
    options->resolution = choice->cells < 2 ? 2 : choice->cells;
    options->resolutions = choice->resolutions;
}
