/* results.csv: one row a setting and scene, with every single time in it, so that work goes on where it was broken off. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "chart.h"
#include "cli.h"
#include "shape/file.h"

enum { MAX_RESULTS = 1 << 26, COLUMNS = 12 };

static const char header[] = "scene,method,settings,milliseconds,relmse,frame_milliseconds,relmse_unexposed,"
                             "exposure,front,runs,frame_runs,digest";

static chart_row *find_row(const chart_plan *plan, const char *digest)
{
    for (size_t i = 0; i < plan->scene_count; i++)
        for (size_t k = 0; k < plan->scenes[i].row_count; k++)
            if (!strcmp(plan->scenes[i].rows[k].digest, digest))
                return &plan->scenes[i].rows[k];
    return NULL;
}

/* The text up to a character, which is cut off; *text goes on behind it, NULL at the end. */
static char *cut(char **text, char at)
{
    char *start = *text, *end = start ? strchr(start, at) : NULL;
    if (end)
        *end = 0;
    *text = end ? end + 1 : NULL;
    return start;
}

/* Times separated by blanks; -1: something else stands there. */
static int read_times(char *text, double times[CHART_RUNS])
{
    int count = 0;
    char *rest;
    for (char *word = strtok_r(text, " ", &rest); word; word = strtok_r(NULL, " ", &rest)) {
        if (count == CHART_RUNS || !cli_number(word, &times[count]) || !(times[count] >= 0))
            return -1;
        count++;
    }
    return count;
}

static bool read_row(const chart_plan *plan, char *line, size_t *strangers)
{
    char *fields[COLUMNS];
    chart_row read = {0};
    for (int i = 0; i < COLUMNS; i++)
        if (!(fields[i] = cut(&line, ',')))
            return false;
    read.runs[CHART_PICTURE] = read_times(fields[9], read.times[CHART_PICTURE]);
    read.runs[CHART_FRAME] = read_times(fields[10], read.times[CHART_FRAME]);
    if (line || read.runs[CHART_PICTURE] < 1 || read.runs[CHART_FRAME] < 0 ||
        !cli_number(fields[4], &read.relmse) || !cli_number(fields[6], &read.plain_relmse) ||
        !cli_number(fields[7], &read.exposure))
        return false;
    chart_row *row = find_row(plan, fields[11]);
    if (!row) {
        ++*strangers;
        return true;
    }
    memcpy(row->runs, read.runs, sizeof row->runs);
    memcpy(row->times, read.times, sizeof row->times);
    row->relmse = read.relmse;
    row->plain_relmse = read.plain_relmse;
    row->exposure = read.exposure;
    return true;
}

void chart_results_read(chart_plan *plan)
{
    shape_error error;
    unsigned char *bytes;
    size_t size, strangers = 0;
    char *path = chart_path(plan, "results.csv");
    if (access(path, F_OK)) {
        free(path);
        return;
    }
    cli_check(shape_file_read(path, MAX_RESULTS, &bytes, &size, &error), &error);
    char *rest = (char *)bytes;
    const char *first = cut(&rest, '\n');
    if (strcmp(first, header))
        cli_fail("%s: is not written by this version of neph-chart (name another folder with -o)", path);
    for (int number = 2; rest && *rest; number++)
        if (!read_row(plan, cut(&rest, '\n'), &strangers))
            cli_fail("%s:%d: is not a row of results (remove it, it will be measured anew)", path, number);
    if (strangers)
        cli_say("note: %zu rows of results.csv belong to other scenes, sizes or settings and go", strangers);
    free(bytes);
    free(path);
}

static void print_times(FILE *file, const chart_row *row, chart_kind kind)
{
    for (int i = 0; i < row->runs[kind]; i++)
        fprintf(file, "%s%.6g", i ? " " : "", row->times[kind][i]);
}

static void print_row(FILE *file, const chart_scene *scene, const chart_row *row)
{
    static const char *const fronts[] = {"", "picture", "frame", "both"};
    fprintf(file, "%s,%s,%s,%.6g,%.6g,", scene->name, chart_method_name(row->setting->method), row->text,
            chart_median(row, CHART_PICTURE), row->relmse);
    if (row->runs[CHART_FRAME])
        fprintf(file, "%.6g", chart_median(row, CHART_FRAME));
    fprintf(file, ",%.6g,%.6g,%s,", row->plain_relmse, row->exposure,
            fronts[row->front[CHART_PICTURE] + 2 * row->front[CHART_FRAME]]);
    print_times(file, row, CHART_PICTURE);
    fputc(',', file);
    print_times(file, row, CHART_FRAME);
    fprintf(file, ",%s\n", row->digest);
}

void chart_results_write(const chart_plan *plan)
{
    shape_error error;
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    if (!file)
        cli_fail("not enough memory");
    fprintf(file, "%s\n", header);
    for (size_t i = 0; i < plan->scene_count; i++) {
        chart_scene *scene = &plan->scenes[i];
        for (int kind = 0; kind < CHART_KINDS; kind++)
            chart_front_mark(scene, (chart_kind)kind);
        for (size_t k = 0; k < scene->row_count; k++)
            if (scene->rows[k].runs[CHART_PICTURE])
                print_row(file, scene, &scene->rows[k]);
    }
    if (fclose(file))
        cli_fail("not enough memory");
    char *path = chart_path(plan, "results.csv");
    cli_check(shape_file_write(path, text, size, &error), &error);
    free(path);
    free(text);
}
