/* Generators' options as plain numbers: which there are, what they are by themselves, how a command line writes them. */
#include "setting.h"

#include <stdio.h>
#include <string.h>

#include "cli_generator.h"

static const char *const changeable[] = {"neph-gauss", "neph-meta", "neph-lsys", "neph-mesh", "neph-layer"};

/* Numbers of an option; 0 where the panel has nothing for it. */
static int count_numbers(cli_kind kind)
{
    switch (kind) {
    case CLI_NUMBER:
    case CLI_INTEGER:
    case CLI_FLAG:
    case CLI_CHOICE:
        return 1;
    case CLI_PAIR:
    case CLI_RANGE:
        return 2;
    case CLI_VECTOR:
        return 3;
    default:
        return 0;
    }
}

/* Option i of a generator, medium and what changes nothing in the file left out. */
static const cli_option *option_at(int which, int i)
{
    if (which < 0)
        return NULL;
    for (const cli_group *group = cli_generators[which]->groups; group->title; group++) {
        if (group->options == cli_medium_options)
            continue;
        for (const cli_option *o = group->options; o->name; o++)
            if (!o->unrecorded && count_numbers(o->kind) && i-- == 0)
                return o;
    }
    return NULL;
}

static void take_default(const cli_option *o, double number[3])
{
    for (int k = 0; k < count_numbers(o->kind); k++)
        switch (o->kind) {
        case CLI_INTEGER:
            number[k] = (double)((const int64_t *)o->value)[k];
            break;
        case CLI_FLAG:
            number[k] = *(const bool *)o->value;
            break;
        case CLI_CHOICE:
            number[k] = *(const int *)o->value;
            break;
        default:
            number[k] = ((const double *)o->value)[k];
            break;
        }
}

view_generator view_generator_none(uint64_t seed)
{
    view_generator generator;
    memset(&generator, 0, sizeof generator); /* it is compared as bytes */
    generator.which = -1;
    generator.seed = seed;
    return generator;
}

view_generator view_generator_named(const char *program, uint64_t seed)
{
    view_generator generator = view_generator_none(seed);
    bool known = false;
    for (size_t i = 0; i < sizeof changeable / sizeof *changeable; i++)
        known = known || !strcmp(program, changeable[i]);
    for (int i = 0; known && cli_generators[i]; i++)
        if (!strcmp(cli_generators[i]->name, program))
            generator.which = i;
    const cli_option *o;
    for (int i = 0; i < VIEW_SETTINGS_MAX && (o = option_at(generator.which, i)) != NULL; i++)
        take_default(o, generator.settings[i].number);
    return generator;
}

view_generator view_generator_of_path(const char *path, uint64_t seed)
{
    static const char *const meshes[] = {".obj", ".ply", ".stl", ".off", ".gltf", ".glb"};
    for (size_t i = 0; i < sizeof meshes / sizeof *meshes; i++)
        if (cli_has_suffix(path, meshes[i]))
            return view_generator_named("neph-mesh", seed);
    return cli_has_suffix(path, ".lsys") ? view_generator_named("neph-lsys", seed)
                                         : view_generator_none(seed);
}

const char *view_generator_program(const view_generator *generator)
{
    return generator->which < 0 ? "" : cli_generators[generator->which]->name;
}

bool view_setting_get_row(const view_generator *generator, int i, view_setting_row *row)
{
    const cli_option *o = i < VIEW_SETTINGS_MAX ? option_at(generator->which, i) : NULL;
    if (!o)
        return false;
    *row = (view_setting_row){.name = o->name,
                              .help = o->help,
                              .choices = o->choices,
                              .count = count_numbers(o->kind),
                              .range = o->kind == CLI_RANGE,
                              .min = o->min,
                              .max = o->max};
    row->kind = o->kind == CLI_INTEGER  ? VIEW_SETTING_INTEGER
                : o->kind == CLI_FLAG   ? VIEW_SETTING_FLAG
                : o->kind == CLI_CHOICE ? VIEW_SETTING_CHOICE
                                        : VIEW_SETTING_NUMBER;
    return true;
}

int view_setting_find(const view_generator *generator, const char *name)
{
    view_setting_row row;
    for (int i = 0; view_setting_get_row(generator, i, &row); i++)
        if (!strcmp(row.name, name))
            return i;
    return -1;
}

/* Word number `place` of "a|b|c". */
static void take_word(const char *words, int place, char *text, size_t room)
{
    for (; place > 0 && strchr(words, '|'); place--)
        words = strchr(words, '|') + 1;
    snprintf(text, room, "%.*s", (int)strcspn(words, "|"), words);
}

void view_setting_text(const view_setting_row *row, const view_setting *setting, char *text, size_t room)
{
    const double *n = setting->number;
    text[0] = 0;
    if (row->kind == VIEW_SETTING_FLAG)
        return;
    if (row->kind == VIEW_SETTING_CHOICE)
        take_word(row->choices, (int)n[0], text, room);
    else if (row->kind == VIEW_SETTING_INTEGER)
        snprintf(text, room, "%.0f", n[0]);
    else if (row->count == 1 || (row->range && n[0] == n[1]))
        snprintf(text, room, "%.9g", n[0]);
    else if (row->count == 2)
        snprintf(text, room, row->range ? "%.9g..%.9g" : "%.9g,%.9g", n[0], n[1]);
    else
        snprintf(text, room, "%.9g,%.9g,%.9g", n[0], n[1], n[2]);
}

/* Which word of "a|b|c" a text is, or -1. */
static int find_word(const char *words, const char *text)
{
    for (int place = 0;; place++) {
        size_t length = strcspn(words, "|");
        if (strlen(text) == length && !strncmp(words, text, length))
            return place;
        if (!words[length])
            return -1;
        words += length + 1;
    }
}

static bool read_range(const char *text, double range[3])
{
    char low[64];
    const char *dots = strstr(text, "..");
    size_t length = dots ? (size_t)(dots - text) : strlen(text);
    if (length >= sizeof low)
        return false;
    snprintf(low, sizeof low, "%.*s", (int)length, text);
    return cli_numbers(low, 1, &range[0]) && cli_numbers(dots ? dots + 2 : text, 1, &range[1]);
}

bool view_setting_read(const view_setting_row *row, const char *text, view_setting *setting)
{
    double n[3] = {0};
    bool good = !text == (row->kind == VIEW_SETTING_FLAG);
    if (good && !text)
        n[0] = 1;
    else if (good && row->kind == VIEW_SETTING_CHOICE)
        good = (n[0] = find_word(row->choices, text)) >= 0;
    else if (good)
        good = row->range ? read_range(text, n) : cli_numbers(text, row->count, n);
    if (good)
        memcpy(setting->number, n, sizeof n);
    return good;
}

shape_status view_setting_options(const view_generator *g, bool seed, shape_scene_options *options,
                                  shape_error *error)
{
    view_setting_row row;
    char text[96];
    shape_status status = SHAPE_OK;
    for (int i = 0; !status && view_setting_get_row(g, i, &row); i++) {
        bool flag = row.kind == VIEW_SETTING_FLAG;
        if (!g->settings[i].given || (flag && g->settings[i].number[0] == 0))
            continue;
        view_setting_text(&row, &g->settings[i], text, sizeof text);
        status = shape_scene_add_option(options, row.name, flag ? NULL : text, error);
    }
    snprintf(text, sizeof text, "%llu", (unsigned long long)g->seed);
    return status || !seed ? status : shape_scene_add_option(options, "seed", text, error);
}

bool view_generator_same(const view_generator *a, const view_generator *b)
{
    bool same = a->which == b->which && a->seed == b->seed && a->entry == b->entry && a->digest == b->digest;
    for (int i = 0; i < VIEW_SETTINGS_MAX && same; i++) {
        const view_setting *s = &a->settings[i], *t = &b->settings[i];
        same = s->given == t->given && (!s->given || !memcmp(s->number, t->number, sizeof s->number));
    }
    return same;
}
