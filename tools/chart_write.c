/* The chart, by gnuplot as a child process: for each scene, time against error of a whole picture and of a frame, both
 * logarithmic, the front of the best drawn through. gnuplot reads a script from one file and writes into another, so that
 * no name of a user's reaches it but as text within quotes. */
#include <errno.h>
#include <math.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "chart.h"
#include "cli.h"
#include "shape/file.h"

extern char **environ;

enum { PANEL_WIDTH = 620, PANEL_HEIGHT = 540, BYTES_MOST = 1 << 28 };

static const char *const colours[] = {"#4477aa", "#cc3311", "#ee99aa", "#228833",
                                      "#99cc66", "#aa3377", "#ddaacc"};
static const int points[] = {7, 5, 4, 9, 8, 13, 12};

/* Runs gnuplot; its output is what *out holds. False and its first line of complaint where it fails. */
static bool run_gnuplot(FILE *script, FILE *out, char complaint[256])
{
    posix_spawn_file_actions_t actions;
    pid_t child = -1;
    int status = -1;
    char *arguments[] = {(char *)"gnuplot", NULL};
    FILE *err = tmpfile();
    if (!err || posix_spawn_file_actions_init(&actions))
        cli_fail("no temporary file: %s", strerror(errno));
    fflush(script);
    rewind(script);
    int code = posix_spawn_file_actions_adddup2(&actions, fileno(script), STDIN_FILENO);
    code = code ? code : posix_spawn_file_actions_adddup2(&actions, fileno(out), STDOUT_FILENO);
    code = code ? code : posix_spawn_file_actions_adddup2(&actions, fileno(err), STDERR_FILENO);
    code = code ? code : posix_spawnp(&child, arguments[0], &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    while (!code && waitpid(child, &status, 0) < 0 && errno == EINTR)
        continue;
    snprintf(complaint, 256, "%s", code ? strerror(code) : "it ended without a word");
    rewind(err);
    char line[256];
    bool told = false;
    while (!code && !told && fgets(line, sizeof line, err)) {
        line[strcspn(line, "\n")] = 0;
        told = *line != 0;
    }
    if (told)
        snprintf(complaint, 256, "%s", line);
    fclose(err);
    return !code && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

void chart_need_gnuplot(void)
{
    char complaint[256];
    FILE *script = tmpfile(), *out = tmpfile();
    if (!script || !out)
        cli_fail("no temporary file: %s", strerror(errno));
    fprintf(script, "set terminal svg\nset terminal pngcairo\n");
    if (!run_gnuplot(script, out, complaint))
        cli_fail("gnuplot: %s (install gnuplot-nox, as Debian calls it)", complaint);
    fclose(script);
    fclose(out);
}

/* --- the script --- */

static double percent(const chart_row *row)
{
    return 100 * sqrt(row->relmse);
}

static bool in_panel(const chart_row *row, chart_kind kind)
{
    return row->runs[kind] > 0;
}

static int by_time(const void *a, const void *b)
{
    const double *x = a, *y = b;
    return (x[0] > y[0]) - (x[0] < y[0]);
}

/* The front from left to right: time, error and place of each row. */
static size_t sort_front(const chart_scene *scene, chart_kind kind, double (*front)[3])
{
    size_t count = 0;
    for (size_t i = 0; i < scene->row_count; i++)
        if (scene->rows[i].front[kind]) {
            front[count][0] = chart_median(&scene->rows[i], kind);
            front[count][1] = percent(&scene->rows[i]);
            front[count++][2] = (double)i;
        }
    qsort(front, count, sizeof *front, by_time);
    return count;
}

/* Methods as they are: the viewer's and the march's, and those of 2018. */
static void print_defaults(FILE *file, const chart_scene *scene, chart_kind kind, const char *name,
                           bool of_2018)
{
    fprintf(file, "$%s << EOD\n", name);
    for (size_t i = 0; i < scene->row_count; i++) {
        const chart_row *row = &scene->rows[i];
        chart_method m = row->setting->method;
        bool paper = m != CHART_MARCH && m != CHART_GL && m != CHART_GL_EXACT;
        if (chart_setting_is_default_of(row->setting, kind) && in_panel(row, kind) && paper == of_2018 &&
            m != CHART_GL_EXACT)
            fprintf(file, "%.6g %.6g\n", chart_median(row, kind), percent(row));
    }
    fprintf(file, "EOD\n");
}

/* Data blocks: $m0 ... by method, $front, and $label for those of the front that have room for a name. */
static void print_data(FILE *file, const chart_scene *scene, chart_kind kind)
{
    for (int method = 0; method < CHART_METHODS; method++) {
        fprintf(file, "$m%d << EOD\n", method);
        for (size_t i = 0; i < scene->row_count; i++)
            if (scene->rows[i].setting->method == (chart_method)method && in_panel(&scene->rows[i], kind))
                fprintf(file, "%.6g %.6g\n", chart_median(&scene->rows[i], kind), percent(&scene->rows[i]));
        fprintf(file, "EOD\n");
    }
    double(*front)[3] = calloc(scene->row_count + 1, sizeof *front), last = 0;
    if (!front)
        cli_fail("not enough memory");
    size_t count = sort_front(scene, kind, front);
    fprintf(file, "$front << EOD\n");
    for (size_t i = 0; i < count; i++)
        fprintf(file, "%.6g %.6g\n", front[i][0], front[i][1]);
    fprintf(file, "EOD\n$label << EOD\n");
    /* From the most accurate on; names stand left of their points, a line's height apart. */
    for (size_t i = count; i-- > 0;) {
        char label[CHART_TEXT];
        if (front[i][1] < last * 1.16)
            continue;
        last = front[i][1];
        chart_setting_label(scene->rows[(size_t)front[i][2]].setting, label);
        fprintf(file, "%.6g %.6g \"%s\"\n", front[i][0], front[i][1], label);
    }
    fprintf(file, "EOD\n");
    free(front);
}

/* The axes' ends: room on the left for the front's names. */
static void print_ranges(FILE *file, const chart_scene *scene, chart_kind kind)
{
    double t0 = INFINITY, t1 = 0, e0 = INFINITY, e1 = 0;
    for (size_t i = 0; i < scene->row_count; i++) {
        const chart_row *row = &scene->rows[i];
        if (!in_panel(row, kind))
            continue;
        double t = chart_median(row, kind), e = percent(row);
        t0 = fmin(t0, t), t1 = fmax(t1, t), e0 = fmin(e0, e), e1 = fmax(e1, e);
    }
    if (!(t0 <= t1))
        t0 = t1 = e0 = e1 = 1;
    fprintf(file, "set xrange [%.6g:%.6g]\nset yrange [%.6g:%.6g]\n", t0 / pow(fmax(t1 / t0, 10), 0.85),
            t1 * 1.4, e0 / 1.3, e1 * 1.3);
}

static void print_panel(FILE *file, const chart_scene *scene, chart_kind kind)
{
    static const char *const what[] = {"a picture: light, baking, drawing", "a frame: drawing alone"};
    bool any[CHART_METHODS] = {false}, some = false;
    for (size_t i = 0; i < scene->row_count; i++)
        if (in_panel(&scene->rows[i], kind))
            any[scene->rows[i].setting->method] = some = true;
    print_data(file, scene, kind);
    print_defaults(file, scene, kind, "default", false);
    print_defaults(file, scene, kind, "paper", true);
    print_ranges(file, scene, kind);
    fprintf(file, "set title \"%s, %dx%d - %s\"\n", scene->name, scene->view.width, scene->view.height,
            what[kind]);
    if (!some) {
        fprintf(file, "plot NaN notitle\n");
        return;
    }
    fprintf(file, "plot $front using 1:2 with lines lc rgb \"#222222\" lw 2 title \"the best\"");
    for (int i = 0; i < CHART_METHODS; i++)
        if (any[i])
            fprintf(file, ", $m%d using 1:2 with points lc rgb \"%s\" pt %d ps 0.9 title \"%s\"", i,
                    colours[i], points[i], chart_method_name((chart_method)i));
    fprintf(file, ", $default using 1:2 with points lc rgb \"#000000\" lw 2 pt 6 ps 2.4 title \"defaults\"");
    fprintf(file, ", $paper using 1:2 with points lc rgb \"#cc3311\" lw 2 pt 4 ps 2.4 title \"of 2018\"");
    fprintf(file, ", $label using 1:2:3 with labels right offset -0.8,-0.35 font \",10\" notitle\n");
}

static void print_script(FILE *file, const void *context, const char *terminal)
{
    const chart_plan *plan = context;
    fprintf(file,
            "set encoding utf8\nset terminal %s noenhanced background rgb \"white\" font \"sans,12\" size "
            "%d,%d\n",
            terminal, 2 * PANEL_WIDTH, (int)plan->scene_count * PANEL_HEIGHT);
    fprintf(file, "set logscale xy\nset xlabel \"milliseconds\" offset 0,0.6\nset ylabel \"error, percent\"\n"
                  "set grid xtics ytics back lt 1 lc rgb \"#dddddd\"\nset key below samplen 1.5\n"
                  "set ytics (0.1, 0.2, 0.5, 1, 2, 3, 5, 10, 20, 30, 50, 100, 200)\n");
    fprintf(file, "set multiplot layout %zu,2\n", plan->scene_count);
    for (size_t i = 0; i < plan->scene_count; i++)
        for (int kind = 0; kind < CHART_KINDS; kind++)
            print_panel(file, &plan->scenes[i], (chart_kind)kind);
    fprintf(file, "unset multiplot\n");
}

void chart_draw_script(const chart_plan *plan, const char *terminal, const char *name,
                       void (*print)(FILE *file, const void *context, const char *terminal),
                       const void *context)
{
    shape_error error;
    char complaint[256];
    FILE *script = tmpfile(), *out = tmpfile();
    if (!script || !out)
        cli_fail("no temporary file: %s", strerror(errno));
    print(script, context, terminal);
    if (!run_gnuplot(script, out, complaint))
        cli_fail("gnuplot could not draw %s: %s", name, complaint);
    long size = fseek(out, 0, SEEK_END) ? -1 : ftell(out);
    if (size <= 0 || size > BYTES_MOST)
        cli_fail("gnuplot could not draw %s: %s", name, complaint);
    char *bytes = malloc((size_t)size), *path = chart_path(plan, name);
    rewind(out);
    if (!bytes || fread(bytes, 1, (size_t)size, out) != (size_t)size)
        cli_fail("cannot read what gnuplot drew");
    cli_check(shape_file_write(path, bytes, (size_t)size, &error), &error);
    free(bytes);
    free(path);
    fclose(script);
    fclose(out);
}

void chart_draw(const chart_plan *plan)
{
    chart_draw_script(plan, "svg", "chart.svg", print_script, plan);
    chart_draw_script(plan, "pngcairo", "chart.png", print_script, plan);
}
