/* Rules of a grammar: left side, condition, body, weight; and the checks that need the whole text. */
#include "generate/grammar_private.h"

#include <stdio.h>
#include <string.h>

#include "base/memory.h"

enum { EPSILON = 0x3b5 };

bool grammar_find_arrow(const parser *p, size_t *arrow, int *length)
{
    for (size_t ahead = 0; p->next + ahead < p->end; ahead++) {
        uint32_t c = grammar_peek(p, ahead), second = grammar_peek(p, ahead + 1);
        *length = c == ARROW                                                       ? 1
                  : c == '-' && second == '>'                                      ? 2
                  : c == ':' && second == ':' && grammar_peek(p, ahead + 2) == '=' ? 3
                                                                                   : 0;
        if (*length) {
            *arrow = p->next + ahead;
            return true;
        }
    }
    return false;
}

/* --- one rule --- */

static bool parse_parameters(parser *p)
{
    char text[48];
    place open = grammar_here(p);
    do {
        char word[NAME_ROOM];
        p->next++;
        grammar_skip_blanks(p);
        place at = grammar_here(p);
        if (!grammar_word(p, false, word)) {
            grammar_mistake(p, at, "%s where a parameter's name should stand (write a name, as in A(r))",
                            grammar_show(grammar_peek(p, 0), text));
            return false;
        }
        for (int i = 0; i < p->parameter_count; i++)
            if (!strcmp(word, p->parameters[i])) {
                grammar_mistake(p, at, "%s names two parameters (give each a name of its own)", word);
                return false;
            }
        if (p->parameter_count == SHAPE_GRAMMAR_ARGUMENTS_MAX) {
            grammar_mistake(p, at, "more than %d parameters (write fewer)", SHAPE_GRAMMAR_ARGUMENTS_MAX);
            return false;
        }
        memcpy(p->parameters[p->parameter_count++], word, sizeof word);
        grammar_skip_blanks(p);
    } while (grammar_peek(p, 0) == ',');
    if (grammar_peek(p, 0) != ')') {
        if (p->next >= p->end)
            grammar_mistake(p, open, "'(' is not closed (write ')')");
        else
            grammar_mistake(p, grammar_here(p), "%s is not expected here (write ',' or ')')",
                            grammar_show(grammar_peek(p, 0), text));
        return false;
    }
    p->next++;
    return true;
}

/* Left of the arrow: letter, parameters, condition. False after a mistake, where the condition is of no use. */
static bool parse_left(parser *p, rule *r)
{
    char word[NAME_ROOM], text[48];
    grammar_skip_blanks(p);
    r->at = grammar_here(p);
    if (grammar_at_end(p)) {
        grammar_mistake(p, r->at, "nothing before the arrow (write the symbol that is rewritten)");
        return false;
    }
    if (!grammar_word(p, true, word)) {
        grammar_mistake(p, r->at, "%s before the arrow (only a letter can be rewritten)",
                        grammar_show(grammar_peek(p, 0), text));
        return false;
    }
    if (word[1]) {
        grammar_mistake(p, r->at, "%s before the arrow (a rule rewrites one letter; the start is \"axiom\")",
                        word);
        return false;
    }
    p->letter = r->letter = word[0];
    grammar_skip_blanks(p);
    if (grammar_peek(p, 0) == '(' && !parse_parameters(p))
        return false;
    grammar_skip_blanks(p);
    if (grammar_peek(p, 0) == ':') {
        p->next++;
        r->condition = grammar_expression(p);
        if (r->condition == NO_NODE)
            return true; /* reported; the names are known, so the body can be read */
    }
    if (!grammar_at_end(p)) {
        grammar_mistake(p, grammar_here(p),
                        "%s is not expected here (write the arrow, or ':' and a condition)",
                        grammar_show(grammar_peek(p, 0), text));
    }
    r->parameter_count = p->parameter_count;
    return true;
}

static void parse_weight(parser *p, rule *r)
{
    char text[48];
    p->next++; /* the colon */
    grammar_skip_blanks(p);
    place at = grammar_here(p);
    r->weight = grammar_expression(p);
    if (r->weight == NO_NODE)
        return;
    const node *n = &p->grammar->nodes[r->weight];
    if (n->kind == NODE_NUMBER && n->value < 0)
        grammar_mistake(p, at, "the probability %g is negative (write 0 or more)", n->value);
    if (!grammar_at_end(p))
        grammar_mistake(p, grammar_here(p), "%s behind the probability (a rule ends with it)",
                        grammar_show(grammar_peek(p, 0), text));
}

/* The body, or '*' (or an epsilon) for nothing. */
static void parse_right(parser *p, rule *r, place arrow)
{
    uint32_t first = grammar_at_end(p) ? 0 : grammar_peek(p, 0);
    if (first == '*' || first == EPSILON) {
        p->next++;
        grammar_skip_blanks(p);
        r->body.first = (int)p->grammar->token_count;
        if (p->next < p->end && grammar_peek(p, 0) != ':')
            grammar_mistake(p, grammar_here(p), "a symbol behind %s (it stands alone: the letter vanishes)",
                            first == '*' ? "'*'" : "'\xce\xb5'");
    } else if (!first || first == ':') {
        grammar_mistake(p, arrow, "nothing behind the arrow (write what %c becomes, or * for nothing)",
                        r->letter ? r->letter : 'X');
    } else {
        grammar_body(p, false, &r->body);
    }
    if (grammar_peek(p, 0) == ':')
        parse_weight(p, r);
}

static void add_rule(parser *p, const rule *r)
{
    shape_grammar *g = p->grammar;
    if (p->out_of_memory || shape_array_reserve((void **)&g->rules, &g->rule_capacity, g->rule_count + 1,
                                                sizeof *g->rules, NULL)) {
        p->out_of_memory = true;
        return;
    }
    int *link = &g->first_rule[(unsigned char)r->letter];
    while (*link != NO_RULE)
        link = &g->rules[*link].next;
    *link = (int)g->rule_count;
    g->rules[g->rule_count++] = *r;
}

void grammar_rule(parser *p, size_t arrow, int arrow_length)
{
    rule r = {.parameter_count = -1, .condition = NO_NODE, .weight = NO_NODE, .next = NO_RULE};
    size_t end = p->end;
    place at = p->cells[arrow].at;
    p->letter = 0;
    p->parameter_count = 0;
    p->end = arrow;
    p->any_parameter = !parse_left(p, &r);
    p->next = arrow + (size_t)arrow_length;
    p->end = end;
    parse_right(p, &r, at);
    p->any_parameter = false;
    if (r.letter)
        add_rule(p, &r);
    p->letter = 0;
    p->parameter_count = 0;
}

/* --- checks over the whole text --- */

static void check_use(parser *p, const token *t)
{
    const shape_grammar *g = p->grammar;
    int first = g->first_rule[(unsigned char)t->letter], count = t->argument_count;
    if (count < 0 || !grammar_is_letter((unsigned char)t->letter))
        return;
    if (first != NO_RULE) {
        const rule *r = &g->rules[first];
        if (r->parameter_count >= 0 && r->parameter_count != count)
            grammar_mistake(p, t->at, "%c has %d argument%s, but its rule in line %d has %d (write as many)",
                            t->letter, count, count == 1 ? "" : "s", r->at.line, r->parameter_count);
    } else if (g->puffs[(unsigned char)t->letter] && count > 2) {
        grammar_mistake(p, t->at, "%c has %d arguments (a puff without a rule takes two: radius and step)",
                        t->letter, count);
    } else if (t->letter == 'G' && !g->puffs['G'] && count > 1) {
        grammar_mistake(p, t->at, "G has %d arguments (it takes one, the step)", count);
    }
}

void grammar_check_uses(parser *p)
{
    const shape_grammar *g = p->grammar;
    for (size_t i = 0; i < g->rule_count; i++) {
        const rule *r = &g->rules[i], *first = &g->rules[g->first_rule[(unsigned char)r->letter]];
        if (first->parameter_count >= 0 && r->parameter_count >= 0 &&
            r->parameter_count != first->parameter_count)
            grammar_mistake(p, r->at,
                            "%c has %d parameter%s here, but %d in line %d (all its rules have as many)",
                            r->letter, r->parameter_count, r->parameter_count == 1 ? "" : "s",
                            first->parameter_count, first->at.line);
    }
    for (size_t i = 0; i < g->token_count; i++)
        check_use(p, &g->tokens[i]);
}
