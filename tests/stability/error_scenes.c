/* How well --error keeps its word (docs/error.md): over scenes of the generators, the error that the chosen settings have in
 * truth, and the time that they take over that of the best settings, found by trying all of a grid.
 *
 *     error_scenes COUNT [FIRST]
 *
 * A scene depends on its number alone. Exit 1 where fewer than 95 % of the scenes keep within what was allowed, or where the
 * mean of the times' ratio is above 1.5. Times are the thread's own (CLOCK_THREAD_CPUTIME_ID), one thread a scene. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "generated_scene.h"
#include "light/march.h"
#include "shape/budget.h"

enum { PIXELS = 96 * 54, VALUES = 3 * PIXELS };

/* The grid of settings that is tried whole. */
enum { STEPS = 11, CELLS = 8, CUTS = 4 };
static const int grid_steps[STEPS] = {6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192};
static const int grid_cells[CELLS] = {4, 6, 8, 12, 16, 24, 32, 48};

typedef struct outcome {
    bool seen;
    double allowed, predicted, error; /* of the choice */
    double best_time, time, choosing; /* seconds */
    double best_error;                /* infinite: none of the grid is within what is allowed */
    shape_march_work work, probing;
} outcome;

static double seconds(void)
{
    struct timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static void sure(shape_status status, const shape_error *error)
{
    if (!status)
        return;
    fprintf(stderr, "error_scenes: %s\n", error->text);
    exit(1);
}

/* A volume with so many octaves fewer, at least 1: their mean stays. It shares all else with the scene's. */
static shape_volume cut_volume(const generated_scene *s, int cut)
{
    shape_volume v = *s->volume;
    v.clouds = malloc(v.cloud_count * sizeof *v.clouds);
    if (!v.clouds)
        abort();
    for (size_t i = 0; i < v.cloud_count; i++) {
        v.clouds[i] = s->volume->clouds[i];
        int all = v.clouds[i].field.octaves, kept = all - cut < 1 ? 1 : all - cut;
        v.clouds[i].field.octaves = kept, v.clouds[i].mean_octaves = all - kept;
    }
    return v;
}

static double longest_side(const generated_scene *s)
{
    shape_dvec3 low = {0, 0, 0}, high = {1, 1, 1};
    shape_set_bounds(s->set, &low, &high);
    return fmax(high.x - low.x, fmax(high.y - low.y, high.z - low.z));
}

/* Makes light (NULL where it is not asked for) and picture, and tells their times. */
static void draw(const generated_scene *s, const shape_volume *volume, const shape_march_options *options,
                 float *radiance, double *light_time, double *view_time, shape_march_work *work)
{
    shape_error error;
    shape_marcher *marcher;
    double start = seconds();
    sure(shape_marcher_create(volume, &s->light, s->view.eye, options, &marcher, &error), &error);
    double middle = seconds();
    sure(shape_march_render(marcher, &s->view, radiance, NULL, &error), &error);
    *view_time = seconds() - middle;
    *light_time = middle - start;
    if (work)
        *work = shape_marcher_work(marcher);
    shape_marcher_destroy(marcher);
}

static double change(const generated_scene *s, const float *picture, const float *truth)
{
    shape_error error;
    double e;
    sure(shape_budget_change(picture, truth, s->view.width, s->view.height, &e, &error), &error);
    return e;
}

/* All octaves, fine steps, and the light grid's default of 48 cells. */
static void draw_truth(const generated_scene *s, float *truth)
{
    shape_march_options o = shape_march_defaults();
    double ignored;
    o.step = longest_side(s) / 600;
    o.resolution = 48;
    draw(s, s->volume, &o, truth, &ignored, &ignored, NULL);
}

/* The fastest settings of the grid that keep to what is allowed. Times grow with steps and with cells, so what can only be
 * slower than the best so far is left out; it begins with the fewest octaves, which are the fastest. */
static void search(const generated_scene *s, const float *truth, outcome *out)
{
    float *picture = malloc(VALUES * sizeof *picture);
    double side = longest_side(s);
    shape_error error;
    if (!picture)
        abort();
    out->best_time = out->best_error = INFINITY;
    for (int cut = CUTS - 1; cut >= 0; cut--) {
        shape_volume v = cut_volume(s, cut);
        double light = 0;
        for (int l = 0; l < CELLS && light < out->best_time; l++) {
            shape_march_options o = shape_march_defaults();
            shape_marcher *marcher;
            o.resolution = grid_cells[l];
            double start = seconds();
            sure(shape_marcher_create(&v, &s->light, s->view.eye, &o, &marcher, &error), &error);
            light = seconds() - start;
            for (int k = 0; k < STEPS; k++) {
                marcher->step = side / grid_steps[k];
                start = seconds();
                sure(shape_march_render(marcher, &s->view, picture, NULL, &error), &error);
                double time = light + seconds() - start;
                if (time >= out->best_time)
                    break;
                double e = change(s, picture, truth);
                if (e > s->error)
                    continue;
                out->best_time = time;
                out->best_error = e;
                break;
            }
            shape_marcher_destroy(marcher);
        }
        free(v.clouds);
    }
    free(picture);
}

static void measure_choice(const generated_scene *s, const float *truth, outcome *out)
{
    shape_error error;
    shape_budget_choice choice;
    shape_march_options o = shape_march_defaults();
    shape_volume v = cut_volume(s, 0);
    float *picture = malloc(VALUES * sizeof *picture);
    double light, view, start = seconds();
    if (!picture)
        abort();
    sure(shape_budget_march(s->volume, &s->view, &s->light, &o, s->error, &choice, &error), &error);
    out->choosing = seconds() - start;
    shape_budget_apply(&choice, &v, &o);
    draw(s, &v, &o, picture, &light, &view, &out->work);
    out->time = light + view;
    out->seen = choice.seen > 0;
    out->allowed = s->error;
    out->predicted = choice.predicted;
    out->error = change(s, picture, truth);
    out->probing = choice.work;
    printf("%ld %s, %zu of %zu clouds, E %.3f: %d steps, %d cells, %d of %d octaves; predicted %.4f, is %.4f",
           s->number, s->kind, choice.seen, choice.clouds, s->error, choice.steps, choice.cells,
           choice.octaves, choice.octaves_of, out->predicted, out->error);
    shape_budget_free(&choice);
    free(picture);
    free(v.clouds);
}

static void run(long number, outcome *out)
{
    generated_scene s;
    float *truth = malloc(VALUES * sizeof *truth);
    if (!truth)
        abort();
    generated_open(&s, number);
    draw_truth(&s, truth);
    search(&s, truth, out);
#pragma omp critical
    {
        measure_choice(&s, truth, out);
        printf("; %.1f ms, best %.1f ms (%.4f), choosing %.1f ms\n", 1e3 * out->time, 1e3 * out->best_time,
               out->best_error, 1e3 * out->choosing);
    }
    generated_close(&s);
    free(truth);
}

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void print_spread(const char *what, double *values, long count)
{
    double sum = 0;
    qsort(values, (size_t)count, sizeof *values, compare);
    for (long i = 0; i < count; i++)
        sum += values[i];
    printf("%s: mean %.2f, median %.2f, 95 %% below %.2f, largest %.2f\n", what, sum / (double)count,
           values[count / 2], values[(count - 1) * 95 / 100], values[count - 1]);
}

/* The summary; whether it is good enough. */
static bool judge(const outcome *all, long count)
{
    long kept = 0, missed = 0, rated = 0, refused = 0;
    double sum = 0, choosing = 0, time = 0, best = 0, *ratios = malloc((size_t)count * sizeof *ratios);
    double *errors = malloc((size_t)count * sizeof *errors);
    if (!ratios || !errors)
        abort();
    for (long i = 0; i < count; i++) {
        const outcome *o = &all[i];
        if (o->predicted > o->allowed) { /* said so */
            refused++;
            continue;
        }
        errors[kept + missed] = o->error / o->allowed;
        kept += o->error <= o->allowed;
        missed += o->error > o->allowed;
        if (!isfinite(o->best_time))
            continue;
        ratios[rated++] = o->time / o->best_time;
        sum += o->time / o->best_time;
        time += o->time, best += o->best_time, choosing += o->choosing;
    }
    printf("%ld of %ld scenes within what was allowed; %ld more said that nothing on offer is\n", kept,
           kept + missed, refused);
    if (kept + missed)
        print_spread("error over what was allowed", errors, kept + missed);
    if (rated) {
        print_spread("time over the best of the grid", ratios, rated);
        printf("all scenes together: %.2f, with the choosing %.2f\n", time / best, (time + choosing) / best);
    }
    bool good = kept >= 0.95 * (double)(kept + missed) && rated > 0 && sum / (double)rated <= 1.5;
    free(ratios);
    free(errors);
    return good;
}

int main(int argc, char **argv)
{
    long count = argc > 1 ? strtol(argv[1], NULL, 10) : 0, first = argc > 2 ? strtol(argv[2], NULL, 10) : 0;
    if (argc < 2 || argc > 3 || count < 1 || count > 100000 || first < 0) {
        fprintf(stderr, "usage: error_scenes COUNT [FIRST] (how many scenes; the first one's number)\n");
        return 2;
    }
    outcome *all = calloc((size_t)count, sizeof *all);
    if (!all)
        return 1;
    setvbuf(stdout, NULL, _IOLBF, BUFSIZ);
#pragma omp parallel for schedule(dynamic, 1)
    for (long i = 0; i < count; i++)
        run(first + i, &all[i]);
    bool good = judge(all, count);
    free(all);
    return !good;
}
