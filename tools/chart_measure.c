/* neph-chart's measuring: each setting once to warm it up and for its error, then all of them in turn, round after round,
 * so that a machine that grows slower or faster does so for all alike. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "chart.h"
#include "cli.h"
#include "shape/imageerror.h"
#include "shape/paper.h"

enum { OCTAVES = 17 };

/* All that the settings of one scene share. */
typedef struct bench {
    chart_plan *plan;
    chart_scene *scene;
    chart_gl *gl; /* NULL: no OpenGL */
    shape_set *sets[CHART_CHANGES][OCTAVES];
    shape_volume *volumes[CHART_CHANGES][OCTAVES];
    float *picture, *small;
    bool *warm, *failed; /* of each row */
    double deadline;     /* seconds; 0: none */
} bench;

static void *need(void *memory)
{
    if (!memory)
        cli_fail("not enough memory");
    return memory;
}

/* --- rows --- */

static bool makes_a_difference(const chart_scene *scene, const chart_setting *setting)
{
    shape_error error;
    shape_set *set;
    bool changed;
    cli_check(chart_setting_apply(setting, scene->set, &set, &changed, &error), &error);
    shape_set_destroy(set);
    return changed;
}

static void add_row(chart_scene *scene, const chart_setting *setting)
{
    chart_row *row = &scene->rows[scene->row_count++];
    char all[CHART_TEXT + 64];
    row->setting = setting;
    chart_setting_text(setting, row->text);
    int length =
        snprintf(all, sizeof all, "%s %s %s", scene->digest, chart_method_name(setting->method), row->text);
    chart_digest(all, (size_t)length, row->digest);
}

void chart_rows_make(const chart_plan *plan, chart_scene *scene)
{
    scene->rows = need(calloc(chart_setting_count, sizeof *scene->rows));
    /* The first of each method comes first, so that none is missing where time runs out. */
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < chart_setting_count; i++) {
            const chart_setting *setting = &chart_settings[i];
            if (chart_setting_is_default(setting) == (pass == 0) && (!plan->quick || setting->quick) &&
                makes_a_difference(scene, setting))
                add_row(scene, setting);
        }
}

/* --- one picture --- */

static const shape_volume *volume_of(bench *b, const chart_setting *setting)
{
    shape_error error;
    bool changed;
    shape_set **set = &b->sets[setting->change][setting->octaves];
    shape_volume **volume = &b->volumes[setting->change][setting->octaves];
    if (!*volume) {
        cli_check(chart_setting_apply(setting, b->scene->set, set, &changed, &error), &error);
        cli_check(shape_volume_create(*set, volume, &error), &error);
    }
    return *volume;
}

static bool go_on(void *context, double done)
{
    const bench *b = context;
    (void)done;
    return b->deadline <= 0 || chart_seconds() < b->deadline;
}

/* Between the pixels' middles, bilinear; the border goes on outwards. */
static void enlarge(const float *small, int w, int h, float *large, int width, int height)
{
    for (int y = 0; y < height; y++) {
        float v = fminf(fmaxf(((float)y + 0.5f) * (float)h / (float)height - 0.5f, 0), (float)(h - 1));
        int y0 = (int)v, y1 = y0 + 1 < h ? y0 + 1 : y0;
        for (int x = 0; x < width; x++) {
            float u = fminf(fmaxf(((float)x + 0.5f) * (float)w / (float)width - 0.5f, 0), (float)(w - 1));
            int x0 = (int)u, x1 = x0 + 1 < w ? x0 + 1 : x0;
            float fu = u - (float)x0, fv = v - (float)y0;
            for (int c = 0; c < 3; c++) {
                float top = (1 - fu) * small[3 * (y0 * w + x0) + c] + fu * small[3 * (y0 * w + x1) + c];
                float low = (1 - fu) * small[3 * (y1 * w + x0) + c] + fu * small[3 * (y1 * w + x1) + c];
                large[3 * ((size_t)y * (size_t)width + (size_t)x) + (size_t)c] = (1 - fv) * top + fv * low;
            }
        }
    }
}

static shape_march_options march_options(const bench *b, const chart_setting *setting)
{
    shape_march_options options = shape_march_defaults();
    options.rule = setting->rule;
    options.light = setting->light;
    options.shadow = setting->shadow;
    options.jitter = setting->jitter;
    options.step = b->scene->side / setting->steps;
    options.resolution = setting->cells;
    options.samples = setting->samples;
    options.seed = b->plan->seed;
    options.progress = go_on;
    options.progress_context = (void *)b;
    return options;
}

static shape_status march(bench *b, const chart_setting *setting, const shape_volume *volume,
                          const shape_view *view, float *radiance, double times[CHART_KINDS], bool *cancelled,
                          shape_error *error)
{
    shape_marcher *marcher;
    shape_march_options options = march_options(b, setting);
    double start = chart_seconds();
    shape_status status =
        shape_marcher_create(volume, &b->scene->light, view->eye, &options, &marcher, error);
    if (status)
        return status;
    double middle = chart_seconds();
    status = shape_march_render(marcher, view, radiance, cancelled, error);
    double end = chart_seconds();
    shape_marcher_destroy(marcher);
    times[CHART_PICTURE] = 1e3 * (end - start);
    times[CHART_FRAME] = 1e3 * (end - middle);
    return status;
}

static shape_status paper(bench *b, const chart_setting *setting, const shape_volume *volume,
                          const shape_view *view, float *radiance, double times[CHART_KINDS], bool *cancelled,
                          shape_error *error)
{
    shape_paper_options options = shape_paper_defaults();
    options.sweep = setting->method == CHART_PAPER_NDT;
    options.resolution = setting->cells;
    options.samples = setting->samples;
    options.progress = go_on;
    options.progress_context = b;
    double start = chart_seconds();
    shape_status status =
        shape_paper_render(volume, view, &b->scene->light, &options, radiance, NULL, cancelled, error);
    times[CHART_PICTURE] = 1e3 * (chart_seconds() - start);
    times[CHART_FRAME] = -1; /* light and picture are one call */
    return status;
}

/* On the CPU, perhaps smaller and then enlarged. */
static shape_status draw(bench *b, const chart_setting *setting, double times[CHART_KINDS], bool *cancelled,
                         shape_error *error)
{
    const shape_volume *volume = volume_of(b, setting);
    shape_view view = b->scene->view;
    if (setting->shrink > 1) {
        view.width = (view.width + setting->shrink - 1) / setting->shrink;
        view.height = (view.height + setting->shrink - 1) / setting->shrink;
    }
    float *radiance = setting->shrink > 1 ? b->small : b->picture;
    shape_status status = setting->method == CHART_MARCH
                              ? march(b, setting, volume, &view, radiance, times, cancelled, error)
                              : paper(b, setting, volume, &view, radiance, times, cancelled, error);
    if (status || setting->shrink <= 1)
        return status;
    double start = chart_seconds();
    enlarge(b->small, view.width, view.height, b->picture, b->scene->view.width, b->scene->view.height);
    double more = 1e3 * (chart_seconds() - start);
    for (int kind = 0; kind < CHART_KINDS; kind++)
        times[kind] += times[kind] >= 0 ? more : 0;
    return SHAPE_OK;
}

/* One measurement; false where it was cut short or failed. */
static bool run(bench *b, size_t index, double times[CHART_KINDS])
{
    shape_error error;
    const chart_row *row = &b->scene->rows[index];
    bool cancelled = false;
    shape_status status =
        chart_method_is_gl(row->setting->method)
            ? chart_gl_draw(b->gl, index, row->setting, volume_of(b, row->setting), &b->scene->view,
                            &b->scene->light, times, b->warm[index] ? NULL : b->picture, &error)
            : draw(b, row->setting, times, &cancelled, &error);
    if (status == SHAPE_ERROR_MEMORY)
        cli_fail("%s", error.text);
    if (status) {
        cli_say("%s: %s %s is left out: %s", b->scene->name, chart_method_name(row->setting->method),
                row->text, error.text);
        b->failed[index] = true;
    }
    return !status && !cancelled;
}

/* The error of the picture that was just drawn. The reference's noise is independent of it, so its mean share is taken
 * off; what is left counts down to a tenth of that share. */
static void take_error(const bench *b, chart_row *row)
{
    shape_error error;
    shape_imageerror e;
    const chart_scene *scene = b->scene;
    cli_check(shape_imageerror_measure(b->picture, scene->reference, scene->view.width, scene->view.height,
                                       &e, &error),
              &error);
    double least = chart_relmse_least(scene);
    row->relmse = fmax(e.exposed_relmse - scene->noise2, least);
    row->plain_relmse = fmax(e.relmse - scene->noise2, least);
    row->exposure = e.exposure;
}

/* --- all --- */

static void record(const chart_plan *plan, chart_row *row, const double times[CHART_KINDS])
{
    for (int kind = 0; kind < CHART_KINDS; kind++)
        if (times[kind] >= 0 && row->runs[kind] < CHART_RUNS)
            row->times[kind][row->runs[kind]++] = times[kind];
    chart_results_write(plan);
}

/* The row's next time, where it has not as many as this round asks for. False where there is no time left. */
static bool visit(bench *b, size_t index, int round)
{
    chart_row *row = &b->scene->rows[index];
    double times[CHART_KINDS];
    if (row->runs[CHART_PICTURE] > round || b->failed[index] ||
        (chart_method_is_gl(row->setting->method) && !b->gl))
        return true;
    if (!go_on(b, 0))
        return false;
    if (!b->warm[index]) {
        if (!run(b, index, times))
            return b->failed[index];
        if (row->runs[CHART_PICTURE] == 0)
            take_error(b, row);
        b->warm[index] = true;
    }
    if (!run(b, index, times))
        return b->failed[index];
    record(b->plan, row, times);
    return true;
}

static bool is_done(const bench *b)
{
    bool done = true;
    for (size_t i = 0; i < b->scene->row_count; i++) {
        const chart_row *row = &b->scene->rows[i];
        bool can = b->gl || !chart_method_is_gl(row->setting->method);
        done = done && (!can || row->runs[CHART_PICTURE] >= b->plan->runs);
    }
    return done;
}

static void measure_rounds(bench *b)
{
    size_t count = b->scene->row_count;
    for (int round = 0; round < b->plan->runs; round++)
        for (size_t i = 0; i < count; i++) {
            if (!visit(b, i, round)) {
                cli_progress("measuring", 1);
                cli_say("%s: time is up in round %d of %d (start it again to go on)", b->scene->name,
                        round + 1, b->plan->runs);
                return;
            }
            cli_progress("measuring",
                         (double)((size_t)round * count + i) / (double)((size_t)b->plan->runs * count));
        }
    cli_progress("measuring", 1);
}

static void measure_scene(chart_plan *plan, chart_scene *scene, chart_gl *gl, double until)
{
    size_t values = (size_t)scene->view.width * (size_t)scene->view.height * 3;
    bench b = {.plan = plan, .scene = scene, .gl = gl, .deadline = until};
    double now = chart_seconds();
    chart_reference(plan, scene, until > 0 ? now + 0.4 * (until - now) : 0);
    if (is_done(&b)) {
        cli_say("%s: everything is measured", scene->name);
        return;
    }
    b.picture = need(malloc(values * sizeof *b.picture));
    b.small = need(malloc(values * sizeof *b.small));
    b.warm = need(calloc(scene->row_count + 1, sizeof *b.warm));
    b.failed = need(calloc(scene->row_count + 1, sizeof *b.failed));
    measure_rounds(&b);
    chart_gl_forget(gl);
    for (int i = 0; i < CHART_CHANGES; i++)
        for (int k = 0; k < OCTAVES; k++) {
            shape_volume_destroy(b.volumes[i][k]);
            shape_set_destroy(b.sets[i][k]);
        }
    free(b.picture);
    free(b.small);
    free(b.warm);
    free(b.failed);
}

void chart_measure(chart_plan *plan)
{
    shape_error error;
    chart_gl *gl = NULL;
    if (chart_gl_open(&gl, &error)) {
        plan->no_gl = error;
        cli_say("note: the OpenGL methods are left out: %s", error.text);
    }
    for (size_t i = 0; i < plan->scene_count; i++) {
        double now = chart_seconds(), left = plan->start + plan->limit - now;
        double until = plan->limit > 0 ? now + left / (double)(plan->scene_count - i) : 0;
        measure_scene(plan, &plan->scenes[i], gl, until);
    }
    chart_gl_close(gl);
}
