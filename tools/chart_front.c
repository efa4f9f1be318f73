/* The front: settings that no other one beats in both time and error (Pareto), and picks from it. */
#include <stdlib.h>
#include <string.h>

#include "chart.h"

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double chart_median(const chart_row *row, chart_kind kind)
{
    double sorted[CHART_RUNS];
    int count = row->runs[kind];
    if (count == 0)
        return -1;
    memcpy(sorted, row->times[kind], (size_t)count * sizeof *sorted);
    qsort(sorted, (size_t)count, sizeof *sorted, compare);
    return (sorted[count / 2] + sorted[(count - 1) / 2]) / 2;
}

/* Whether a is better than b in one of the two and as good in the other; of equals the first in the table is. */
static bool beats(const chart_row *a, const chart_row *b, chart_kind kind)
{
    double ta = chart_median(a, kind), tb = chart_median(b, kind);
    if (ta < 0 || ta > tb || a->relmse > b->relmse)
        return false;
    return ta < tb || a->relmse < b->relmse || a < b;
}

void chart_front_mark(chart_scene *scene, chart_kind kind)
{
    for (size_t i = 0; i < scene->row_count; i++) {
        chart_row *row = &scene->rows[i];
        row->front[kind] = row->runs[kind] > 0;
        for (size_t k = 0; k < scene->row_count && row->front[kind]; k++)
            row->front[kind] = k == i || !beats(&scene->rows[k], row, kind);
    }
}

const chart_row *chart_front_pick(const chart_scene *scene, chart_kind kind, double relmse)
{
    const chart_row *best = NULL;
    for (size_t i = 0; i < scene->row_count; i++) {
        const chart_row *row = &scene->rows[i];
        if (row->runs[kind] && row->relmse <= relmse &&
            (!best || chart_median(row, kind) < chart_median(best, kind)))
            best = row;
    }
    return best;
}

const chart_row *chart_front_best(const chart_scene *scene, chart_kind kind)
{
    const chart_row *best = NULL;
    for (size_t i = 0; i < scene->row_count; i++)
        if (scene->rows[i].runs[kind] && (!best || scene->rows[i].relmse < best->relmse))
            best = &scene->rows[i];
    return best;
}

double chart_relmse_least(const chart_scene *scene)
{
    return scene->noise2 / 10 > 1e-12 ? scene->noise2 / 10 : 1e-12;
}
