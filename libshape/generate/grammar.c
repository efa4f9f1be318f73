/* A grammar's text to a shape_grammar: statements, defaults, and what belongs to the whole. The language is
 * docs/grammar.md; it holds the grammar of Jiménez 2018, Eq. 18, as it is printed there. */
#include "shape/grammar.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generate/grammar_private.h"

static shape_grammar_settings settings_defaults(void)
{
    shape_grammar_settings s = {.iterations = 5,
                                .angle = {25, 25},
                                .radius = {1, 1},
                                .length = {1, 1},
                                .shrink = {1, 1},
                                .stretch = {1, 1, 1},
                                .field = shape_field_defaults(),
                                .medium = shape_medium_defaults()};
    return s;
}

/* Whether the part before an arrow is the word "axiom", as the paper prints it: Axiom -> X. */
static bool is_axiom(const parser *p, size_t arrow)
{
    char word[NAME_ROOM];
    parser look = *p;
    look.end = arrow;
    if (!grammar_word(&look, false, word) || !grammar_at_end(&look))
        return false;
    for (char *c = word; *c; c++)
        *c = (char)tolower((unsigned char)*c);
    return !strcmp(word, "axiom");
}

static void parse_statement(parser *p)
{
    size_t arrow;
    int length;
    if (grammar_at_end(p))
        return;
    place at = grammar_here(p);
    if (!grammar_find_arrow(p, &arrow, &length)) {
        grammar_settings_line(p);
    } else if (is_axiom(p, arrow)) {
        p->next = arrow + (size_t)length;
        grammar_axiom(p, at, false);
    } else {
        grammar_rule(p, arrow, length);
    }
}

static void parse_all(parser *p)
{
    for (size_t start = 0; start < p->cell_count && !p->out_of_memory;) {
        size_t end = start;
        while (p->cells[end].c && p->cells[end].c != '\n')
            end++;
        p->next = start;
        p->end = end;
        parse_statement(p);
        start = end + 1;
    }
    place top = {1, 1};
    if (!p->has_axiom && !p->axiom_misspelt)
        grammar_mistake(p, top, "there is no axiom (write the symbols to start with, as in: axiom X)");
    if (!p->out_of_memory)
        grammar_check_uses(p);
}

static shape_grammar *create(const char *name)
{
    shape_grammar *g = calloc(1, sizeof *g);
    if (!g)
        return NULL;
    g->name = malloc(strlen(name) + 1);
    if (!g->name) {
        free(g);
        return NULL;
    }
    memcpy(g->name, name, strlen(name) + 1);
    g->settings = settings_defaults();
    for (int c = 'A'; c <= 'Z'; c++)
        g->puffs[c] = c != 'G';
    for (int c = 0; c < LETTERS; c++)
        g->first_rule[c] = NO_RULE;
    return g;
}

void shape_grammar_destroy(shape_grammar *g)
{
    if (!g)
        return;
    free(g->name);
    free(g->rules);
    free(g->tokens);
    free(g->arguments);
    free(g->nodes);
    free(g);
}

shape_status shape_grammar_parse(const void *text, size_t size, const char *name, shape_grammar **grammar,
                                 shape_mistakes *mistakes, shape_error *error)
{
    mistakes->count = 0;
    mistakes->more = false;
    if (size > SHAPE_GRAMMAR_TEXT_MAX)
        return shape_error_set(error, SHAPE_ERROR_LIMIT, "%s: larger than %d bytes (split the grammar)", name,
                               SHAPE_GRAMMAR_TEXT_MAX);
    parser p = {.mistakes = mistakes, .grammar = create(name)};
    if (!p.grammar)
        return shape_error_memory(error);
    grammar_lex(&p, text, size);
    if (!p.out_of_memory)
        parse_all(&p);
    free(p.cells);
    if (p.out_of_memory || mistakes->count) {
        shape_grammar_destroy(p.grammar);
        if (p.out_of_memory)
            return shape_error_memory(error);
        const shape_mistake *first = &mistakes->items[0];
        return shape_error_set(error, SHAPE_ERROR_FORMAT, "%s:%d:%d: %s", name, first->line, first->column,
                               first->text);
    }
    *grammar = p.grammar;
    return SHAPE_OK;
}

const shape_grammar_settings *shape_grammar_get_settings(const shape_grammar *g)
{
    return &g->settings;
}

bool shape_grammar_is_puff(const shape_grammar *g, char letter)
{
    return (unsigned char)letter < LETTERS && g->puffs[(unsigned char)letter];
}
