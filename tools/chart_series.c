/* Time of a frame against one setting at a time, all else alike: the charts of Páleník 2016 appendix B (noise data, rule,
 * Powder variant, steps, resolution, coverage) on our own march, and Jiménez 2018 Table 3 and Figure 16 (camera distance).
 * series.csv holds every single time; started again, nothing is measured twice. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "chart.h"
#include "cli.h"
#include "shape/combine.h"
#include "shape/file.h"
#include "shape/layer.h"

enum { LATTICE, RULE, POWDER, STEPS, RESOLUTION, COVERAGE, DISTANCE, SERIES };
enum { POINTS = 6, MAX_CSV = 1 << 24 };

typedef struct series {
    const char *name, *title, *axis;
    double x[POINTS]; /* 0 ends them */
    const char *labels[POINTS];
} series;

static const series all_series[SERIES] = {
    {"lattice", "noise: lattice cells along the cloud", "cells", {4, 16, 64, 256, 1024}, {0}},
    {"rule",
     "rule of integration",
     "",
     {1, 2, 3, 4, 5, 6},
     {"riemann-left", "riemann-right", "trapezoid", "simpson", "simpson38", "exponential"}},
    {"powder", "Powder variants", "", {1, 2, 3, 4}, {"single", "powder", "powder-angle", "beer-max"}},
    {"steps", "steps along the cloud", "steps", {16, 32, 64, 128, 256, 512}, {0}},
    {"resolution", "resolution", "thousand pixels", {0.25, 0.5, 1, 1.5, 2}, {0}},
    {"coverage", "coverage of a layer, percent", "percent", {20, 35, 50, 65, 80, 95}, {0}},
    {"distance", "distance of the camera", "times the framing one", {0.5, 1, 2, 4, 8, 16}, {0}},
};

typedef struct point {
    const series *series;
    int number, runs;
    double x, times[CHART_RUNS]; /* milliseconds */
    char digest[CHART_DIGEST + 1];
} point;

typedef struct sheet {
    const chart_plan *plan;
    const chart_scene *scene;
    point points[SERIES * POINTS];
    int count;
} sheet;

/* --- what a point draws --- */

static shape_set *copy_set(const shape_set *set)
{
    shape_error error;
    shape_set *copy = shape_set_create(&error);
    if (!copy)
        cli_fail("%s", error.text);
    cli_check(shape_set_append(copy, set, &error), &error);
    return copy;
}

static shape_set *layer_set(double coverage)
{
    shape_error error;
    shape_layer_options options = shape_layer_options_defaults();
    shape_set *set = shape_set_create(&error);
    if (!set)
        cli_fail("%s", error.text);
    cli_check(shape_set_add_cloud(set, "layer", NULL, &error), &error);
    options.layer.coverage = (float)coverage;
    cli_check(shape_layer_make(&options, &set->clouds[0], shape_set_list(set, 0), &error), &error);
    cli_check(shape_cloud_choose_noise_scale(&set->clouds[0], shape_set_list(set, 0), &error), &error);
    return set;
}

static double longest_side(const shape_set *set)
{
    shape_dvec3 low = {0, 0, 0}, high = {1, 1, 1};
    shape_set_bounds(set, &low, &high);
    return fmax(high.x - low.x, fmax(high.y - low.y, high.z - low.z));
}

static shape_set *point_set(const sheet *s, const point *p)
{
    if (p->series == &all_series[COVERAGE])
        return layer_set(p->x / 100);
    shape_set *set = copy_set(s->scene->set);
    if (p->series == &all_series[LATTICE])
        for (size_t i = 0; i < set->cloud_count; i++) {
            double scale = cbrt(fabs(shape_frame_determinant(&set->clouds[i].frame)));
            set->clouds[i].field.noise_scale = (float)(s->scene->side / scale / p->x);
        }
    return set;
}

static shape_view point_view(const sheet *s, const point *p, const shape_set *set)
{
    shape_view view = s->scene->view;
    if (p->series == &all_series[RESOLUTION]) {
        view.width = (int)fmax(round(view.width * p->x), 1);
        view.height = (int)fmax(round(view.height * p->x), 1);
    }
    if (p->series == &all_series[DISTANCE]) {
        shape_dvec3 away = shape_dvec3_sub(view.eye, view.target);
        view.eye = shape_dvec3_add(view.target, shape_dvec3_scale(away, p->x));
    }
    if (p->series == &all_series[COVERAGE]) {
        shape_dvec3 low = {0, 0, 0}, high = {1, 1, 1};
        shape_set_bounds(set, &low, &high);
        shape_view_frame(&view, &s->scene->light, low, high);
    }
    return view;
}

static shape_march_options point_options(const sheet *s, const point *p, const shape_set *set)
{
    static const shape_march_light lights[] = {SHAPE_MARCH_SINGLE, SHAPE_MARCH_POWDER,
                                               SHAPE_MARCH_POWDER_ANGLE, SHAPE_MARCH_BEER_MAX};
    shape_march_options options = shape_march_defaults();
    double steps = p->series == &all_series[STEPS] ? p->x : 64;
    options.step = longest_side(set) / steps;
    options.resolution = 16;
    options.seed = s->plan->seed;
    if (p->series == &all_series[RULE])
        options.rule = (shape_rule)p->number;
    if (p->series == &all_series[POWDER]) {
        options.light = lights[p->number];
        options.shadow = SHAPE_SHADOW_GRID;
    }
    return options;
}

/* One frame; light is made before. Milliseconds. */
static double measure(const sheet *s, const point *p)
{
    shape_error error;
    shape_volume *volume;
    shape_marcher *marcher;
    shape_set *set = point_set(s, p);
    shape_view view = point_view(s, p, set);
    shape_march_options options = point_options(s, p, set);
    float *radiance = malloc(3 * (size_t)view.width * (size_t)view.height * sizeof *radiance);
    if (!radiance)
        cli_fail("not enough memory");
    cli_check(shape_volume_create(set, &volume, &error), &error);
    cli_check(shape_marcher_create(volume, &s->scene->light, view.eye, &options, &marcher, &error), &error);
    double start = chart_seconds();
    cli_check(shape_march_render(marcher, &view, radiance, NULL, &error), &error);
    double time = 1e3 * (chart_seconds() - start);
    shape_marcher_destroy(marcher);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
    free(radiance);
    return time;
}

/* --- series.csv --- */

static const char header[] = "series,x,label,milliseconds,runs,digest";

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(const point *p)
{
    double sorted[CHART_RUNS];
    memcpy(sorted, p->times, sizeof sorted);
    qsort(sorted, (size_t)p->runs, sizeof *sorted, by_value);
    return p->runs % 2 ? sorted[p->runs / 2] : (sorted[p->runs / 2 - 1] + sorted[p->runs / 2]) / 2;
}

/* What stands on the axis: pixels rather than their factor. */
static double shown_x(const sheet *s, const point *p)
{
    const shape_view view = point_view(s, p, s->scene->set);
    return p->series == &all_series[RESOLUTION] ? 1e-3 * view.width * view.height : p->x;
}

static void add_points(sheet *s)
{
    for (int k = 0; k < SERIES; k++)
        for (int i = 0; i < POINTS && all_series[k].x[i] > 0; i++) {
            char all[128];
            point *p = &s->points[s->count++];
            *p = (point){.series = &all_series[k], .number = i, .x = all_series[k].x[i]};
            int length = snprintf(all, sizeof all, "%s %s %g", s->scene->digest, p->series->name, p->x);
            chart_digest(all, (size_t)length, p->digest);
        }
}

static void write_csv(const sheet *s)
{
    shape_error error;
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    if (!file)
        cli_fail("not enough memory");
    fprintf(file, "%s\n", header);
    for (int i = 0; i < s->count; i++) {
        const point *p = &s->points[i];
        if (!p->runs)
            continue;
        const char *label = p->series->labels[p->number];
        fprintf(file, "%s,%g,%s,%.6g,", p->series->name, shown_x(s, p), label ? label : "", median(p));
        for (int k = 0; k < p->runs; k++)
            fprintf(file, "%s%.6g", k ? " " : "", p->times[k]);
        fprintf(file, ",%s\n", p->digest);
    }
    if (fclose(file))
        cli_fail("not enough memory");
    char *path = chart_path(s->plan, "series.csv");
    cli_check(shape_file_write(path, text, size, &error), &error);
    free(path);
    free(text);
}

/* A row's times, where its digest is one of ours. False where it is no row. */
static bool read_row(sheet *s, char *line)
{
    char *fields[6], *rest;
    for (int i = 0; i < 6; i++) {
        fields[i] = line;
        line = line ? strchr(line, ',') : NULL;
        if (line)
            *line++ = 0;
        if (!fields[i])
            return false;
    }
    for (int i = 0; i < s->count; i++) {
        point *p = &s->points[i];
        if (strcmp(p->digest, fields[5]))
            continue;
        p->runs = 0;
        for (char *word = strtok_r(fields[4], " ", &rest); word && p->runs < CHART_RUNS;
             word = strtok_r(NULL, " ", &rest)) {
            if (!cli_number(word, &p->times[p->runs]) || !(p->times[p->runs] >= 0))
                return false;
            p->runs++;
        }
    }
    return true;
}

static void read_csv(sheet *s)
{
    shape_error error;
    unsigned char *bytes;
    size_t size;
    char *path = chart_path(s->plan, "series.csv"), *rest;
    if (access(path, F_OK)) {
        free(path);
        return;
    }
    cli_check(shape_file_read(path, MAX_CSV, &bytes, &size, &error), &error);
    char *text = malloc(size + 1);
    if (!text)
        cli_fail("not enough memory");
    memcpy(text, bytes, size);
    text[size] = 0;
    char *line = strtok_r(text, "\n", &rest);
    bool good = line && !strcmp(line, header);
    while (good && (line = strtok_r(NULL, "\n", &rest)))
        good = read_row(s, line);
    if (!good)
        cli_fail("%s: is not what this program wrote (remove it)", path);
    free(text);
    free(bytes);
    free(path);
}

/* --- the sheet --- */

static void print_panel(FILE *file, const sheet *s, const series *one)
{
    bool named = one->labels[0] != NULL,
         logarithmic = !named && one != &all_series[COVERAGE] && one != &all_series[RESOLUTION];
    double most = 0;
    int names = 0;
    while (names < POINTS && one->labels[names])
        names++;
    fprintf(file, "$d << EOD\n");
    for (int i = 0; i < s->count; i++)
        if (s->points[i].series == one && s->points[i].runs) {
            const char *label = one->labels[s->points[i].number];
            fprintf(file, "%g %g \"%s\"\n", shown_x(s, &s->points[i]), median(&s->points[i]),
                    label ? label : "");
            most = fmax(most, median(&s->points[i]));
        }
    fprintf(file, "EOD\nset title \"%s\"\nset xlabel \"%s\"\nset yrange [0:%g]\n", one->title, one->axis,
            most > 0 ? 1.15 * most : 1);
    fprintf(file, "unset logscale\nset xtics auto\nset xrange [*:*]\n");
    if (logarithmic)
        fprintf(file, "set logscale x %d\n", one == &all_series[LATTICE] ? 4 : 2);
    if (named)
        fprintf(file,
                "set xtics rotate by -25 font \",9\"\nset xrange [0.4:%d.6]\n"
                "plot $d using 1:2:(0.6):xtic(3) with boxes fs solid 0.7 lc rgb \"#4477aa\" notitle\n",
                names);
    else
        fprintf(file,
                "set xtics norotate\nplot $d using 1:2 with linespoints lc rgb \"#4477aa\" pt 7 notitle\n");
}

static void print_script(FILE *file, const void *context, const char *terminal)
{
    const sheet *s = context;
    fprintf(file,
            "set encoding utf8\nset terminal %s noenhanced background rgb \"white\" font \"sans,10\" size "
            "1200,1000\n",
            terminal);
    fprintf(file, "set ylabel \"milliseconds a frame\"\nset grid ytics back lt 1 lc rgb \"#dddddd\"\n");
    fprintf(file, "set multiplot layout 3,3 title \"%s, %dx%d\"\n", s->scene->name, s->scene->view.width,
            s->scene->view.height);
    for (int k = 0; k < SERIES; k++)
        print_panel(file, s, &all_series[k]);
    fprintf(file, "unset multiplot\n");
}

void chart_series(const chart_plan *plan, const chart_scene *scene)
{
    sheet *s = calloc(1, sizeof *s);
    int measured = 0;
    if (!s)
        cli_fail("not enough memory");
    s->plan = plan;
    s->scene = scene;
    add_points(s);
    read_csv(s);
    for (int round = 0; round < plan->runs; round++)
        for (int i = 0; i < s->count; i++) {
            point *p = &s->points[i];
            cli_progress("measuring", (double)(round * s->count + i) / (plan->runs * s->count));
            if (p->runs > round)
                continue;
            p->times[p->runs++] = measure(s, p);
            measured++;
            write_csv(s);
        }
    cli_progress("measuring", 1);
    chart_draw_script(plan, "svg", "series.svg", print_script, s);
    chart_draw_script(plan, "pngcairo", "series.png", print_script, s);
    cli_say("%s: %d frames measured for %d points, %s/series.png shows them", scene->name, measured, s->count,
            plan->folder);
    free(s);
}
