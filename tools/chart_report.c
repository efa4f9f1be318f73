/* report.md: which setting to pick for an error, and which ones never pay. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "chart.h"
#include "cli.h"
#include "shape/file.h"

enum { NEVER_SHOWN = 10 };
static const double never_margin = 1.1; /* times slower than another as accurate: more than chance */

static void print_time(FILE *file, const chart_row *row, chart_kind kind)
{
    double time = chart_median(row, kind);
    fprintf(file, ", %.*f ms |", time >= 100 ? 0 : time >= 10 ? 1 : 2, time);
}

static void print_pick(FILE *file, const chart_scene *scene, chart_kind kind, double error)
{
    const chart_row *row = chart_front_pick(scene, kind, error * error);
    if (row) {
        fprintf(file, " `%s %s`", chart_method_name(row->setting->method), row->text);
        print_time(file, row, kind);
    } else {
        row = chart_front_best(scene, kind);
        if (!row) {
            fprintf(file, " not measured |");
            return;
        }
        fprintf(file, " none; the best reaches %.2g %%: `%s %s`", 100 * sqrt(row->relmse),
                chart_method_name(row->setting->method), row->text);
        print_time(file, row, kind);
    }
}

/* The methods as they are, and what is as accurate in less time. */
static void print_defaults(FILE *file, const chart_scene *scene)
{
    static const char *const names[] = {"a picture", "a frame"};
    for (int kind = 0; kind < CHART_KINDS; kind++) {
        fprintf(file, "| %s as it is | error | time | as accurate |\n|---|---|---|---|\n", names[kind]);
        for (size_t i = 0; i < scene->row_count; i++) {
            const chart_row *row = &scene->rows[i];
            if (!row->runs[kind] || !chart_setting_is_default_of(row->setting, (chart_kind)kind))
                continue;
            const chart_row *best = chart_front_pick(scene, (chart_kind)kind, row->relmse);
            fprintf(file, "| `%s%s` | %.3g %% |", chart_method_name(row->setting->method),
                    row->setting->moving ? " moving" : "", 100 * sqrt(row->relmse));
            fprintf(file, " %.3g ms |", chart_median(row, (chart_kind)kind));
            if (best == row)
                fprintf(file, " nothing is quicker |\n");
            else
                fprintf(file, " `%s %s`, %.3g ms |\n", chart_method_name(best->setting->method), best->text,
                        chart_median(best, (chart_kind)kind));
        }
        fputc('\n', file);
    }
}

static void print_scene(FILE *file, const chart_scene *scene)
{
    static const double errors[] = {0.01, 0.03, 0.1};
    size_t measured = 0, primitives = 0;
    for (size_t i = 0; i < scene->row_count; i++)
        measured += scene->rows[i].runs[CHART_PICTURE] > 0;
    for (size_t i = 0; i < scene->set->cloud_count; i++)
        primitives += shape_primitives_count(shape_set_list_const(scene->set, i));
    fprintf(file, "## %s\n\n%dx%d pixels, %zu cloud%s of %zu primitives, %zu settings measured", scene->name,
            scene->view.width, scene->view.height, scene->set->cloud_count,
            scene->set->cloud_count == 1 ? "" : "s", primitives, measured);
    if (measured < scene->row_count)
        fprintf(file, ", %zu not (no time or no OpenGL)", scene->row_count - measured);
    fprintf(file,
            ".\nThe reference's own noise is %.2g %%; errors below %.2g %% cannot be told from none.\n\n",
            100 * sqrt(scene->noise2), 100 * sqrt(chart_relmse_least(scene)));
    fprintf(file, "| error at most | fastest picture | fastest frame |\n|---|---|---|\n");
    for (size_t i = 0; i < sizeof errors / sizeof *errors; i++) {
        fprintf(file, "| %g %% |", 100 * errors[i]);
        for (int kind = 0; kind < CHART_KINDS; kind++)
            print_pick(file, scene, (chart_kind)kind, errors[i]);
        fputc('\n', file);
    }
    fputc('\n', file);
    print_defaults(file, scene);
}

/* --- what never pays --- */

typedef struct loser {
    const chart_row *row;
    double factor;           /* times slower than... */
    const chart_row *better; /* ...this one, as accurate */
} loser;

/* How many times slower a row is than the fastest that is at least as accurate, by the kind that suits it best. */
static double slower(const chart_scene *scene, const chart_row *row, const chart_row **better)
{
    double least = INFINITY;
    for (int kind = 0; kind < CHART_KINDS; kind++) {
        if (!row->runs[kind])
            continue;
        const chart_row *other = chart_front_pick(scene, (chart_kind)kind, row->relmse);
        double factor = chart_median(row, (chart_kind)kind) / chart_median(other, (chart_kind)kind);
        if (factor < least) {
            least = factor;
            *better = other;
        }
    }
    return least;
}

static const chart_row *find_setting(const chart_scene *scene, const chart_setting *setting)
{
    for (size_t i = 0; i < scene->row_count; i++)
        if (scene->rows[i].setting == setting && scene->rows[i].runs[CHART_PICTURE])
            return &scene->rows[i];
    return NULL;
}

/* A setting that is beaten on every scene, in whatever time one looks at; by the scene that suits it best. */
static bool never_pays(const chart_plan *plan, const chart_setting *setting, loser *l)
{
    bool seen = false;
    l->factor = INFINITY;
    for (size_t i = 0; i < plan->scene_count; i++) {
        const chart_row *better = NULL, *row = find_setting(&plan->scenes[i], setting);
        double factor = row ? slower(&plan->scenes[i], row, &better) : INFINITY;
        if (row && factor < l->factor)
            *l = (loser){row, factor, better};
        seen = seen || row;
    }
    return seen && l->factor > never_margin;
}

static int by_factor(const void *a, const void *b)
{
    const loser *x = a, *y = b;
    return (x->factor < y->factor) - (x->factor > y->factor);
}

static void print_never(FILE *file, const chart_plan *plan)
{
    loser *losers = calloc(chart_setting_count, sizeof *losers);
    size_t count = 0;
    if (!losers)
        cli_fail("not enough memory");
    for (size_t i = 0; i < chart_setting_count; i++)
        count += never_pays(plan, &chart_settings[i], &losers[count]);
    qsort(losers, count, sizeof *losers, by_factor);
    fprintf(file, "## What never pays\n\n");
    if (!count)
        fprintf(file, "Nothing: each setting is the fastest of its accuracy somewhere.\n");
    else
        fprintf(file,
                "On every scene above another setting is faster and at least as accurate, for pictures and "
                "for frames.\n\n| setting | error | times slower than | which has |\n|---|---|---|---|\n");
    for (size_t i = 0; i < count && i < NEVER_SHOWN; i++)
        fprintf(file, "| `%s %s` | %.2g %% | %.2g x `%s %s` | %.2g %% |\n",
                chart_method_name(losers[i].row->setting->method), losers[i].row->text,
                100 * sqrt(losers[i].row->relmse), losers[i].factor,
                chart_method_name(losers[i].better->setting->method), losers[i].better->text,
                100 * sqrt(losers[i].better->relmse));
    if (count > NEVER_SHOWN)
        fprintf(file, "\nand %zu more, by %.2g times or less.\n", count - NEVER_SHOWN,
                losers[NEVER_SHOWN].factor);
    free(losers);
}

void chart_report(const chart_plan *plan)
{
    shape_error error;
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    if (!file)
        cli_fail("not enough memory");
    fprintf(file,
            "# Speed against accuracy\n\n![Time against error](chart.png)\n\n"
            "Errors are the square root of the relative MSE from a path-traced picture, after the one "
            "best exposure factor.\nA picture is light, baking and drawing from a volume in memory; a "
            "frame is drawing alone, with light and baking\ndone before. Times are medians of up to %d "
            "runs in turn, after one to warm up. results.csv has all of them.\n",
            plan->runs);
    if (*plan->no_gl.text)
        fprintf(file, "There is no OpenGL here, so its methods are left out: %s.\n", plan->no_gl.text);
    fputc('\n', file);
    for (size_t i = 0; i < plan->scene_count; i++)
        print_scene(file, &plan->scenes[i]);
    print_never(file, plan);
    if (fclose(file))
        cli_fail("not enough memory");
    char *path = chart_path(plan, "report.md");
    cli_check(shape_file_write(path, text, size, &error), &error);
    free(path);
    free(text);
}
