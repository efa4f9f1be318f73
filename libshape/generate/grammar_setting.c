/* Settings lines of a grammar: "name value" pairs, checked against one table. */
#include "generate/grammar_private.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

typedef enum setting_kind {
    SETTING_AXIOM,
    SETTING_PUFFS,
    SETTING_RANGE,  /* shape_grammar_range */
    SETTING_WHOLE,  /* int */
    SETTING_NUMBER, /* float */
    SETTING_VECTOR, /* double[3] */
    SETTING_CHOICE  /* int-sized enum, by its place in `words` */
} setting_kind;

typedef struct setting {
    const char *name;
    setting_kind kind;
    size_t offset; /* in shape_grammar_settings */
    double min, max;
    const char *range; /* what is allowed, in words */
    const char *words[6];
} setting;

#define AT(member) offsetof(shape_grammar_settings, member)
static const setting settings[] = {
    {"axiom", SETTING_AXIOM, 0, 0, 0, NULL, {NULL}},
    {"puffs", SETTING_PUFFS, 0, 0, 0, NULL, {NULL}},
    {"iterations",
     SETTING_WHOLE,
     AT(iterations),
     0,
     SHAPE_GRAMMAR_ITERATIONS_MAX,
     "a whole number, 0 to 100000",
     {NULL}},
    {"angle", SETTING_RANGE, AT(angle), -1e6, 1e6, "degrees, -1e6 to 1e6", {NULL}},
    {"radius", SETTING_RANGE, AT(radius), 1e-9, 1e9, "metres, above 0, at most 1e9", {NULL}},
    {"length", SETTING_RANGE, AT(length), 0, 1e9, "metres, 0 to 1e9", {NULL}},
    {"shrink", SETTING_RANGE, AT(shrink), 1e-9, 1000, "a factor above 0, at most 1000", {NULL}},
    {"stretch", SETTING_VECTOR, AT(stretch), 1e-6, 1e6, "three factors X,Y,Z, each 1e-6 to 1e6", {NULL}},
    {"model", SETTING_CHOICE, AT(field.model), 0, 0, NULL, {"uniform", "spheroid", "metaball", NULL}},
    {"kappa", SETTING_NUMBER, AT(field.kappa), 0, 1, "0 to 1", {NULL}},
    {"octaves", SETTING_WHOLE, AT(field.octaves), 1, 16, "a whole number, 1 to 16", {NULL}},
    {"noise-scale", SETTING_NUMBER, AT(field.noise_scale), 1e-9, 1e9, "metres, above 0, at most 1e9", {NULL}},
    {"edge", SETTING_NUMBER, AT(field.edge), 0, 1e9, "0 to 1e9", {NULL}},
    {"smoothness", SETTING_NUMBER, AT(field.detail.smoothness), 0, 1, "0 to 1", {NULL}},
    {"displace", SETTING_NUMBER, AT(field.detail.displace), 0, 1e9, "metres, 0 to 1e9", {NULL}},
    {"displace-scale", SETTING_NUMBER, AT(field.detail.displace_scale), 0, 1e9, "metres, 0 to 1e9", {NULL}},
    {"billow", SETTING_NUMBER, AT(field.detail.billow), 0, 1, "0 to 1", {NULL}},
    {"wisp", SETTING_NUMBER, AT(field.detail.wisp), 0, 1, "0 to 1", {NULL}},
    {"detail-depth", SETTING_NUMBER, AT(field.detail.detail_depth), 0, 1, "0 to 1", {NULL}},
    {"detail-scale", SETTING_NUMBER, AT(field.detail.detail_scale), 0, 1e9, "metres, 0 to 1e9", {NULL}},
    {"extinction", SETTING_NUMBER, AT(medium.extinction), 0, 1e9, "1/m, 0 to 1e9", {NULL}},
    {"albedo", SETTING_NUMBER, AT(medium.albedo), 0, 1, "0 to 1", {NULL}},
    {"phase",
     SETTING_CHOICE,
     AT(medium.phase),
     0,
     0,
     NULL,
     {"hg", "isotropic", "rayleigh", "mie", "two-lobe", NULL}},
    {"g", SETTING_NUMBER, AT(medium.g), -0.9999, 0.9999, "-0.9999 to 0.9999", {NULL}},
    {"g2", SETTING_NUMBER, AT(medium.g2), -0.9999, 0.9999, "-0.9999 to 0.9999", {NULL}},
    {"lobe-mix", SETTING_NUMBER, AT(medium.lobe_mix), 0, 1, "0 to 1", {NULL}},
    {"droplet", SETTING_NUMBER, AT(medium.droplet), 5, 50, "micrometres, 5 to 50", {NULL}},
};
#undef AT
enum { SETTING_COUNT = sizeof settings / sizeof *settings };
_Static_assert(sizeof(shape_model) == sizeof(int) && sizeof(shape_phase_kind) == sizeof(int),
               "choices are ints");
_Static_assert((int)SETTING_COUNT <= (int)GRAMMAR_SETTINGS_MAX, "make room for the settings' places");

static const setting *find(const char *name)
{
    for (int i = 0; i < SETTING_COUNT; i++)
        if (!strcmp(settings[i].name, name))
            return &settings[i];
    return NULL;
}

bool grammar_at_setting(const parser *p)
{
    char word[NAME_ROOM];
    parser look = *p;
    uint32_t before = p->next ? p->cells[p->next - 1].c : ' ';
    if ((before != ' ' && before != '\t') || !grammar_word(&look, true, word) || !word[1] || !find(word))
        return false;
    uint32_t behind = grammar_peek(&look, 0);
    return behind == 0 || behind == ' ' || behind == '\t';
}

/* To the next setting that can be recognised, after a mistake. */
static void skip_to_setting(parser *p)
{
    while (p->next < p->end && !grammar_at_setting(p))
        p->next++;
}

static void skip_word(parser *p)
{
    while (p->next < p->end && grammar_peek(p, 0) != ' ' && grammar_peek(p, 0) != '\t')
        p->next++;
}

/* The word at the cursor, up to a blank, for a message. */
static const char *show_word(const parser *p, char text[NAME_ROOM])
{
    size_t used = 0;
    for (size_t ahead = 0; used + 1 < NAME_ROOM; ahead++) {
        uint32_t c = grammar_peek(p, ahead);
        if (c == 0 || c == ' ' || c == '\t')
            break;
        text[used++] = c < 0x80 ? (char)c : '?';
    }
    text[used] = 0;
    return text;
}

/* A signed number at the cursor; false without a report where there is none. */
static bool signed_number(parser *p, double *value)
{
    size_t start = p->next;
    uint32_t sign = grammar_peek(p, 0);
    if (sign == '-' || sign == '+')
        p->next++;
    if (!grammar_number(p, value)) {
        p->next = start;
        return false;
    }
    if (sign == '-')
        *value = -*value;
    return true;
}

/* Numbers with a separator between, up to a blank. How many there were, or 0 after a report. */
static int parse_numbers(parser *p, const setting *s, const char *form, const char *separator, int most,
                         double values[3])
{
    char text[NAME_ROOM];
    place at = grammar_here(p);
    size_t start = p->next, width = strlen(separator);
    int count = 0;
    bool good = true;
    while (good) {
        good = signed_number(p, &values[count]);
        count += good;
        if (!good || count == most || grammar_peek(p, 0) != (unsigned char)separator[0])
            break;
        for (size_t i = 0; i < width; i++)
            good = good && grammar_peek(p, i) == (unsigned char)separator[i];
        p->next += width;
    }
    uint32_t behind = grammar_peek(p, 0);
    if (!good || (behind && behind != ' ' && behind != '\t')) {
        p->next = start;
        if (grammar_at_end(p))
            grammar_mistake(p, at, "%s has no value (write %s)", s->name, form);
        else
            grammar_mistake(p, at, "%s %s: not %s (write %s)", s->name, show_word(p, text), form, s->range);
        skip_word(p);
        return 0;
    }
    for (int i = 0; i < count; i++)
        if (!(values[i] >= s->min && values[i] <= s->max)) {
            grammar_mistake(p, at, "%s %g: out of range (write %s)", s->name, values[i], s->range);
            return 0;
        }
    return count;
}

static void parse_range(parser *p, const setting *s, shape_grammar_range *range)
{
    double v[3];
    place at = grammar_here(p);
    int count = parse_numbers(p, s, "a number or a range A..B", "..", 2, v);
    if (count == 2 && v[0] > v[1])
        grammar_mistake(p, at, "%s %g..%g: the range runs backwards (write %g..%g)", s->name, v[0], v[1],
                        v[1], v[0]);
    if (count) {
        range->low = v[0];
        range->high = v[count - 1];
    }
}

static void parse_whole(parser *p, const setting *s, int *value)
{
    double v[3];
    place at = grammar_here(p);
    if (!parse_numbers(p, s, "a whole number", " ", 1, v))
        return;
    if (v[0] != floor(v[0]))
        grammar_mistake(p, at, "%s %g: not a whole number (write %s)", s->name, v[0], s->range);
    *value = (int)v[0];
}

static void parse_vector(parser *p, const setting *s, double *value)
{
    double v[3];
    place at = grammar_here(p);
    int count = parse_numbers(p, s, "three numbers X,Y,Z", ",", 3, v);
    if (count && count != 3)
        grammar_mistake(p, at, "%s has %d number%s (write three, X,Y,Z)", s->name, count,
                        count == 1 ? "" : "s");
    if (count == 3)
        memcpy(value, v, sizeof v);
}

static void parse_choice(parser *p, const setting *s, int *value)
{
    char word[NAME_ROOM] = "", shown[NAME_ROOM], all[96] = "";
    place at = grammar_here(p);
    show_word(p, shown);
    if (grammar_word(p, true, word) && !strcmp(word, shown))
        for (int i = 0; s->words[i]; i++)
            if (!strcmp(word, s->words[i])) {
                *value = i;
                return;
            }
    for (int i = 0; s->words[i]; i++)
        snprintf(all + strlen(all), sizeof all - strlen(all), "%s%s", i ? ", " : "", s->words[i]);
    const char *near = grammar_nearest(shown, s->words);
    if (!shown[0])
        grammar_mistake(p, at, "%s has no value (write one of %s)", s->name, all);
    else if (near)
        grammar_mistake(p, at, "%s %s: not known (did you mean %s?)", s->name, shown, near);
    else
        grammar_mistake(p, at, "%s %s: not known (write one of %s)", s->name, shown, all);
    skip_word(p);
}

static void parse_puffs(parser *p, place at)
{
    char text[48];
    memset(p->grammar->puffs, 0, sizeof p->grammar->puffs);
    int count = 0;
    for (; !grammar_at_end(p) && !grammar_at_setting(p); p->next++) {
        uint32_t c = grammar_peek(p, 0);
        if (grammar_is_letter(c)) {
            p->grammar->puffs[c] = true;
            count++;
        } else if (c != ',') {
            grammar_mistake(p, grammar_here(p), "%s cannot be a puff (only letters can)",
                            grammar_show(c, text));
        }
    }
    if (!count)
        grammar_mistake(p, at,
                        "puffs has no letters (write the symbols that set a sphere, as in: puffs X Y)");
}

void grammar_axiom(parser *p, place at, bool stop)
{
    char text[48];
    if (p->has_axiom) {
        grammar_mistake(p, at, "a second axiom (the first is in line %d; keep one)", p->axiom_at.line);
    } else {
        p->has_axiom = true;
        p->axiom_at = at;
    }
    p->letter = 0;
    p->parameter_count = 0;
    if (!grammar_at_end(p) && grammar_peek(p, 0) == '=') {
        grammar_mistake(p, grammar_here(p), "'=' behind axiom (write: axiom X)");
        p->next++;
    }
    body start;
    grammar_body(p, stop, &start);
    if (!start.count)
        grammar_mistake(p, at, "the axiom is empty (write the symbols to start with, as in: axiom X)");
    if (p->next < p->end && grammar_peek(p, 0) == ':') {
        grammar_mistake(p, grammar_here(p),
                        "%s behind the axiom (only a rule has a condition or a probability)",
                        grammar_show(':', text));
        p->next = p->end;
    }
    p->grammar->axiom = start;
}

static void parse_value(parser *p, const setting *s, place at)
{
    char *target = (char *)&p->grammar->settings + s->offset;
    grammar_skip_blanks(p);
    switch (s->kind) {
    case SETTING_AXIOM:
        grammar_axiom(p, at, true);
        break;
    case SETTING_PUFFS:
        parse_puffs(p, at);
        break;
    case SETTING_RANGE:
        parse_range(p, s, (shape_grammar_range *)(void *)target);
        break;
    case SETTING_WHOLE:
        parse_whole(p, s, (int *)(void *)target);
        break;
    case SETTING_NUMBER: {
        double v[3];
        if (parse_numbers(p, s, "a number", " ", 1, v))
            *(float *)(void *)target = (float)v[0];
        break;
    }
    case SETTING_VECTOR:
        parse_vector(p, s, (double *)(void *)target);
        break;
    case SETTING_CHOICE:
        parse_choice(p, s, (int *)(void *)target);
        break;
    }
}

static void unknown(parser *p, const char *name, place at)
{
    const char *names[SETTING_COUNT + 1];
    for (int i = 0; i < SETTING_COUNT; i++)
        names[i] = settings[i].name;
    names[SETTING_COUNT] = NULL;
    const char *near = grammar_nearest(name, names);
    bool rule_like = !name[1] && name[0] >= 'A' && name[0] <= 'Z';
    if (rule_like || grammar_peek(p, 0) == '(' || grammar_peek(p, 0) == ':')
        grammar_mistake(p, at, "a rule without an arrow (write %c -> ...)", name[0]);
    else if (near) {
        p->axiom_misspelt = p->axiom_misspelt || !strcmp(near, "axiom");
        grammar_mistake(p, at, "%s is not a setting (did you mean %s?)", name, near);
    } else
        grammar_mistake(p, at, "%s is not a setting (write a setting's name, or a rule X -> ...)", name);
}

void grammar_settings_line(parser *p)
{
    char word[NAME_ROOM], text[48];
    while (!grammar_at_end(p) && !p->out_of_memory) {
        place at = grammar_here(p);
        if (!grammar_word(p, true, word)) {
            grammar_mistake(p, at, "%s where a setting or a rule should begin (write a name, or X -> ...)",
                            grammar_show(grammar_peek(p, 0), text));
            p->next++;
            skip_to_setting(p);
            continue;
        }
        const setting *s = find(!strcmp(word, "Axiom") || !strcmp(word, "AXIOM") ? "axiom" : word);
        if (!s) {
            grammar_skip_blanks(p);
            unknown(p, word, at);
            skip_to_setting(p);
            continue;
        }
        int *line = &p->setting_lines[s - settings];
        if (*line && s->kind != SETTING_AXIOM) /* the axiom says it itself, since it can also be a rule */
            grammar_mistake(p, at, "%s is set twice (first in line %d; keep one)", s->name, *line);
        *line = at.line;
        parse_value(p, s, at);
    }
}
