/* The settings that neph-chart measures, as a table; their names; and what they do to a set of clouds. */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "chart.h"
#include "shape/combine.h"
#include "shape/prune.h"
#include "shape/refine.h"

/* NOLINTBEGIN(bugprone-macro-parentheses): these are initialisers and parts of names. */
#define MARCH(by, count, lit, depth, grid)                                                                   \
    .method = CHART_MARCH, .rule = SHAPE_RULE_##by, .steps = count, .light = SHAPE_MARCH_##lit,              \
    .shadow = SHAPE_SHADOW_##depth, .cells = grid, .samples = 1
#define PAPER(which, grid) .method = CHART_##which, .cells = grid, .samples = 1
#define GL(which, grid, count) GL_LIT(which, grid, count, GRID)
#define GL_LIT(which, grid, count, lit)                                                                      \
    .method = CHART_##which, .cells = grid, .samples = count, .voxels = 12000, .light = SHAPE_MARCH_##lit
#define QUICK .quick = true
/* NOLINTEND(bugprone-macro-parentheses) */

/* Of each method, the first is the program's own default. */
const chart_setting chart_settings[] = {
    {MARCH(EXPONENTIAL, 100, GRID, MARCH, 48), QUICK},
    /* steps */
    {MARCH(EXPONENTIAL, 6, GRID, MARCH, 48)},
    {MARCH(EXPONENTIAL, 12, GRID, MARCH, 48), QUICK},
    {MARCH(EXPONENTIAL, 25, GRID, MARCH, 48), QUICK},
    {MARCH(EXPONENTIAL, 50, GRID, MARCH, 48)},
    {MARCH(EXPONENTIAL, 200, GRID, MARCH, 48)},
    {MARCH(EXPONENTIAL, 400, GRID, MARCH, 48), QUICK},
    /* rules */
    {MARCH(RIEMANN_LEFT, 25, GRID, MARCH, 48)},
    {MARCH(RIEMANN_LEFT, 100, GRID, MARCH, 48), QUICK},
    {MARCH(RIEMANN_LEFT, 400, GRID, MARCH, 48)},
    {MARCH(RIEMANN_RIGHT, 25, GRID, MARCH, 48)},
    {MARCH(RIEMANN_RIGHT, 100, GRID, MARCH, 48)},
    {MARCH(RIEMANN_RIGHT, 400, GRID, MARCH, 48)},
    {MARCH(TRAPEZOID, 25, GRID, MARCH, 48)},
    {MARCH(TRAPEZOID, 100, GRID, MARCH, 48), QUICK},
    {MARCH(TRAPEZOID, 400, GRID, MARCH, 48)},
    {MARCH(SIMPSON, 25, GRID, MARCH, 48)},
    {MARCH(SIMPSON, 100, GRID, MARCH, 48), QUICK},
    {MARCH(SIMPSON, 400, GRID, MARCH, 48)},
    {MARCH(SIMPSON38, 25, GRID, MARCH, 48)},
    {MARCH(SIMPSON38, 100, GRID, MARCH, 48)},
    {MARCH(SIMPSON38, 400, GRID, MARCH, 48)},
    /* jitter and rays a pixel */
    {MARCH(EXPONENTIAL, 25, GRID, MARCH, 48), .jitter = SHAPE_JITTER_HASH},
    {MARCH(EXPONENTIAL, 25, GRID, MARCH, 48), .jitter = SHAPE_JITTER_BLUE},
    {.method = CHART_MARCH,
     .rule = SHAPE_RULE_EXPONENTIAL,
     .steps = 100,
     .light = SHAPE_MARCH_GRID,
     .cells = 48,
     .samples = 4,
     .jitter = SHAPE_JITTER_HASH},
    /* lights */
    {MARCH(EXPONENTIAL, 100, SINGLE, MARCH, 48), QUICK},
    {MARCH(EXPONENTIAL, 100, SINGLE, CONE, 48)},
    {MARCH(EXPONENTIAL, 100, SINGLE, GRID, 48)},
    {MARCH(EXPONENTIAL, 100, POWDER, GRID, 48)},
    {MARCH(EXPONENTIAL, 100, POWDER_ANGLE, GRID, 48)},
    {MARCH(EXPONENTIAL, 100, BEER_MAX, GRID, 48)},
    {MARCH(EXPONENTIAL, 100, HARRIS, MARCH, 48)},
    {MARCH(EXPONENTIAL, 100, TWO_PASS, MARCH, 48), QUICK},
    {MARCH(EXPONENTIAL, 100, OCTAVES, MARCH, 48)},
    {MARCH(EXPONENTIAL, 100, OCTAVES, GRID, 48), QUICK},
    /* cells of the light grid */
    {MARCH(EXPONENTIAL, 100, GRID, MARCH, 12), QUICK},
    {MARCH(EXPONENTIAL, 100, GRID, MARCH, 24), QUICK},
    {MARCH(EXPONENTIAL, 100, GRID, MARCH, 96)},
    /* octaves of the noise, fewer primitives, smaller pictures */
    {MARCH(EXPONENTIAL, 100, GRID, MARCH, 48), .octaves = 1},
    {MARCH(EXPONENTIAL, 100, GRID, MARCH, 48), .octaves = 3, QUICK},
    {MARCH(EXPONENTIAL, 100, GRID, MARCH, 48), .change = CHART_PRUNED, QUICK},
    {MARCH(EXPONENTIAL, 100, GRID, MARCH, 48), .change = CHART_HOLLOWED},
    {MARCH(EXPONENTIAL, 100, GRID, MARCH, 48), .change = CHART_HALVED},
    {MARCH(EXPONENTIAL, 100, GRID, MARCH, 48), .shrink = 2, QUICK},
    {MARCH(EXPONENTIAL, 100, GRID, MARCH, 48), .shrink = 4},
    /* several at once */
    {MARCH(EXPONENTIAL, 50, GRID, MARCH, 24)},
    {MARCH(EXPONENTIAL, 25, GRID, MARCH, 24)},
    {MARCH(EXPONENTIAL, 25, GRID, MARCH, 24), .shrink = 2, QUICK},
    {MARCH(EXPONENTIAL, 12, GRID, MARCH, 12), .shrink = 4},
    {MARCH(EXPONENTIAL, 12, OCTAVES, GRID, 12), .shrink = 2},
    /* the methods of 2018 */
    {PAPER(PAPER, 40), QUICK},
    {PAPER(PAPER, 20)},
    {PAPER(PAPER, 80)},
    {PAPER(PAPER_NDT, 40), QUICK},
    /* the viewer */
    {GL(GL, 48, 1), QUICK},
    {GL(GL, 48, 4)},
    {GL(GL, 48, 16), QUICK},
    {GL(GL, 12, 1)},
    {GL(GL, 24, 1), QUICK},
    {GL(GL, 96, 1)},
    {.method = CHART_GL, .cells = 48, .samples = 1, .voxels = 1000, .light = SHAPE_MARCH_GRID},
    {.method = CHART_GL, .cells = 48, .samples = 1, .voxels = 100, .light = SHAPE_MARCH_GRID, QUICK},
    {GL(GL, 48, 1), .moving = true, QUICK},
    {GL(GL, 24, 1), .moving = true},
    {GL_LIT(GL, 48, 1, SINGLE)},
    {GL_LIT(GL, 48, 1, POWDER)},
    {GL_LIT(GL, 48, 1, OCTAVES), QUICK},
    {GL(GL, 48, 1), .octaves = 3},
    {GL(GL, 48, 1), .change = CHART_PRUNED},
    {GL(GL, 48, 1), .change = CHART_HALVED},
    {GL(GL_EXACT, 48, 1), QUICK},
    {GL(GL_EXACT, 48, 8)},
    {GL(GL_EXACT, 24, 1)},
    {GL(GL_EXACT, 96, 1)},
    {GL(GL_PAPER, 40, 1), QUICK},
    {GL(GL_PAPER, 20, 1)},
    {GL(GL_PAPER_NDT, 40, 1), QUICK},
};
const size_t chart_setting_count = sizeof chart_settings / sizeof *chart_settings;

static const char *const method_names[] = {"march",    "paper",    "paper-ndt",   "gl",
                                           "gl-exact", "gl-paper", "gl-paper-ndt"};
static const char *const rule_names[] = {"riemann-left", "riemann-right", "trapezoid",
                                         "simpson",      "simpson38",     "exponential"};
static const char *const light_names[] = {"single", "powder",   "powder-angle", "beer-max",
                                          "harris", "two-pass", "octaves",      "grid"};
static const char *const shadow_names[] = {"march", "cone", "grid"};
static const char *const jitter_names[] = {"none", "hash", "blue"};
static const char *const change_names[] = {"", "pruned", "hollowed", "halved"};

const char *chart_method_name(chart_method method)
{
    return method_names[method];
}

bool chart_method_is_gl(chart_method method)
{
    return method >= CHART_GL;
}

bool chart_setting_is_default(const chart_setting *setting)
{
    return setting == chart_settings || setting->method != setting[-1].method;
}

/* Of a method's default, the setting that differs by `moving` alone; NULL: it has none. */
static const chart_setting *moving_twin(const chart_setting *setting)
{
    char text[CHART_TEXT], other[CHART_TEXT];
    chart_setting twin = *setting;
    twin.moving = true;
    chart_setting_text(&twin, text);
    for (size_t i = 0; i < chart_setting_count; i++) {
        chart_setting_text(&chart_settings[i], other);
        if (chart_settings[i].method == twin.method && !strcmp(text, other))
            return &chart_settings[i];
    }
    return NULL;
}

bool chart_setting_is_default_of(const chart_setting *setting, chart_kind kind)
{
    for (size_t i = 0; kind == CHART_FRAME && i < chart_setting_count; i++)
        if (chart_settings[i].method == setting->method && chart_setting_is_default(&chart_settings[i])) {
            const chart_setting *twin = moving_twin(&chart_settings[i]);
            return setting == (twin ? twin : &chart_settings[i]);
        }
    return chart_setting_is_default(setting);
}

/* Appends to a text of CHART_TEXT bytes, after a blank. */
static void SHAPE_PRINTF(2, 3) add(char *text, const char *format, ...)
{
    va_list values;
    size_t used = strlen(text);
    if (used && used + 1 < CHART_TEXT) {
        text[used++] = ' ';
        text[used] = 0;
    }
    va_start(values, format);
    vsnprintf(text + used, CHART_TEXT - used, format, values);
    va_end(values);
}

static bool asks_depth(const chart_setting *s)
{
    return s->light != SHAPE_MARCH_GRID && s->light != SHAPE_MARCH_TWO_PASS && s->light != SHAPE_MARCH_HARRIS;
}

static bool has_cells(const chart_setting *s)
{
    if (s->method != CHART_MARCH)
        return true;
    return asks_depth(s) ? s->shadow == SHAPE_SHADOW_GRID : s->light != SHAPE_MARCH_HARRIS;
}

/* What both texts end by. */
static void add_common(const chart_setting *s, char *text)
{
    if ((s->method == CHART_GL || s->method == CHART_GL_EXACT) && s->light != SHAPE_MARCH_GRID)
        add(text, "light=%s", light_names[s->light]);
    if (s->jitter)
        add(text, "jitter=%s", jitter_names[s->jitter]);
    if (s->samples > 1)
        add(text, "samples=%d", s->samples);
    if (s->octaves)
        add(text, "octaves=%d", s->octaves);
    if (s->change)
        add(text, "%s", change_names[s->change]);
    if (s->shrink > 1)
        add(text, "size=1/%d", s->shrink);
    if (s->moving)
        add(text, "moving");
}

void chart_setting_text(const chart_setting *s, char text[CHART_TEXT])
{
    *text = 0;
    if (s->method == CHART_MARCH) {
        add(text, "rule=%s steps=%d light=%s", rule_names[s->rule], s->steps, light_names[s->light]);
        if (asks_depth(s))
            add(text, "shadow=%s", shadow_names[s->shadow]);
    }
    if (has_cells(s))
        add(text, "cells=%d", s->cells);
    if (s->method == CHART_GL)
        add(text, "voxels=%dk", s->voxels);
    add_common(s, text);
}

void chart_setting_label(const chart_setting *s, char text[CHART_TEXT])
{
    *text = 0;
    add(text, "%s", method_names[s->method]);
    if (s->method == CHART_MARCH) {
        add(text, "%d steps", s->steps);
        if (s->rule != SHAPE_RULE_EXPONENTIAL)
            add(text, "%s", rule_names[s->rule]);
        if (s->light != SHAPE_MARCH_GRID)
            add(text, "%s", light_names[s->light]);
    }
    if (has_cells(s))
        add(text, "%d^3", s->cells);
    if (s->method == CHART_GL && s->voxels != 12000)
        add(text, "%dk voxels", s->voxels);
    add_common(s, text);
}

static shape_status change_list(shape_primitives *list, chart_change change, size_t *removed,
                                shape_error *error)
{
    size_t count = shape_primitives_count(list);
    shape_core core = shape_primitives_core(list);
    switch (change) {
    case CHART_PRUNED:
        return shape_primitives_prune(list, removed, error);
    case CHART_HOLLOWED:
        *removed = shape_primitives_hollow(list, &core);
        return SHAPE_OK;
    case CHART_HALVED:
        *removed = shape_primitives_thin(list, (count + 1) / 2, 1);
        return SHAPE_OK;
    default:
        *removed = 0;
        return SHAPE_OK;
    }
}

shape_status chart_setting_apply(const chart_setting *setting, const shape_set *set, shape_set **made,
                                 bool *changed, shape_error *error)
{
    shape_set *copy = shape_set_create(error);
    if (!copy)
        return SHAPE_ERROR_MEMORY;
    *changed = !setting->octaves && !setting->change;
    shape_status status = shape_set_append(copy, set, error);
    for (size_t i = 0; i < copy->cloud_count && !status && setting->octaves; i++) {
        shape_field *field = &copy->clouds[i].field;
        *changed = *changed || field->octaves > setting->octaves;
        field->octaves = field->octaves > setting->octaves ? setting->octaves : field->octaves;
    }
    for (size_t i = 0; i < copy->list_count && !status && setting->change; i++) {
        size_t removed = 0;
        status = change_list(&copy->lists[i], setting->change, &removed, error);
        *changed = *changed || removed;
    }
    if (status)
        shape_set_destroy(copy);
    else
        *made = copy;
    return status;
}
