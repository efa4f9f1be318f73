/* Settings lines of a grammar: "name value" pairs, checked against the table. */
#include "generate/grammar_table.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "generate/grammar_private.h"

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
static int parse_numbers(parser *p, const grammar_setting *s, const char *form, const char *separator,
                         int most, double values[3])
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

static void parse_range(parser *p, const grammar_setting *s, shape_grammar_range *range)
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

static void parse_whole(parser *p, const grammar_setting *s, int *value)
{
    double v[3];
    place at = grammar_here(p);
    if (!parse_numbers(p, s, "a whole number", " ", 1, v))
        return;
    if (v[0] != floor(v[0]))
        grammar_mistake(p, at, "%s %g: not a whole number (write %s)", s->name, v[0], s->range);
    *value = (int)v[0];
}

static void parse_vector(parser *p, const grammar_setting *s, double *value)
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

static void parse_choice(parser *p, const grammar_setting *s, int *value)
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

static void parse_value(parser *p, const grammar_setting *s, place at)
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
    const char *names[GRAMMAR_SETTINGS_MAX + 1];
    grammar_setting_names(names);
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
        const grammar_setting *s =
            grammar_setting_find(!strcmp(word, "Axiom") || !strcmp(word, "AXIOM") ? "axiom" : word);
        if (!s) {
            grammar_skip_blanks(p);
            unknown(p, word, at);
            skip_to_setting(p);
            continue;
        }
        int *line = &p->setting_lines[grammar_setting_index(s)];
        if (*line && s->kind != SETTING_AXIOM) /* the axiom says it itself, since it can also be a rule */
            grammar_mistake(p, at, "%s is set twice (first in line %d; keep one)", s->name, *line);
        *line = at.line;
        parse_value(p, s, at);
    }
}
