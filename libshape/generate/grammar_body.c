/* Bodies of a grammar's rules and its axiom: symbols with their arguments. */
#include <string.h>

#include "base/memory.h"
#include "generate/grammar_private.h"

static bool is_turtle(uint32_t c)
{
    return c && c < LETTERS && strchr("+-&^\\/|[]!@", (int)c);
}

/* Behind the ')' that closes the '(' at a place in the cells, or at the statement's end. */
static void skip_arguments(parser *p, size_t open)
{
    int depth = 0;
    p->next = open;
    do {
        depth += (grammar_peek(p, 0) == '(') - (grammar_peek(p, 0) == ')');
        p->next++;
    } while (p->next < p->end && depth);
}

static void add_argument(parser *p, token *t, int node_index)
{
    shape_grammar *g = p->grammar;
    if (shape_array_reserve((void **)&g->arguments, &g->argument_capacity, g->argument_count + 1,
                            sizeof *g->arguments, NULL)) {
        p->out_of_memory = true;
        return;
    }
    g->arguments[g->argument_count++] = node_index;
    t->argument_count++;
}

/* The parenthesis at the cursor. A mistake in one argument ends the list; the rest of the body is still read. */
static void parse_arguments(parser *p, token *t)
{
    char text[48];
    size_t start = p->next;
    place open = grammar_here(p);
    for (bool first = true; first || grammar_peek(p, 0) == ','; first = false) {
        p->next++;
        int one = grammar_argument(p);
        if (one == NO_NODE) {
            skip_arguments(p, start);
            t->argument_count = -1;
            return;
        }
        if (t->argument_count == SHAPE_GRAMMAR_ARGUMENTS_MAX) {
            grammar_mistake(p, t->at, "%c has more than %d arguments (write fewer)", t->letter,
                            SHAPE_GRAMMAR_ARGUMENTS_MAX);
            skip_arguments(p, start);
            t->argument_count = -1;
            return;
        }
        add_argument(p, t, one);
        grammar_skip_blanks(p);
    }
    if (grammar_peek(p, 0) == ')') {
        p->next++;
        return;
    }
    if (p->next >= p->end)
        grammar_mistake(p, open, "'(' is not closed (write ')')");
    else
        grammar_mistake(p, grammar_here(p), "%s is not expected here (write ',' or ')')",
                        grammar_show(grammar_peek(p, 0), text));
    skip_arguments(p, start);
    t->argument_count = -1;
}

static void check_turtle_arguments(parser *p, const token *t)
{
    int count = t->argument_count;
    if (count < 0 || grammar_is_letter((unsigned char)t->letter))
        return;
    if (strchr("[]|", t->letter) && count)
        grammar_mistake(p, t->at, "%c takes no argument (remove the parenthesis)", t->letter);
    else if (t->letter == '@' && count != 0 && count != 3)
        grammar_mistake(p, t->at,
                        "@ has %d argument%s (write @(right,forward,up), or @ alone for round puffs)", count,
                        count == 1 ? "" : "s");
    else if (t->letter == '!' && count > 2)
        grammar_mistake(
            p, t->at, "! has %d arguments (it takes a factor on radius and length, or one for each)", count);
    else if (strchr("+-&^\\/", t->letter) && count > 1)
        grammar_mistake(p, t->at, "%c has %d arguments (it takes one, the angle in degrees)", t->letter,
                        count);
}

static void unexpected(parser *p)
{
    char text[48];
    place at = grammar_here(p);
    uint32_t c = grammar_peek(p, 0);
    size_t start = p->next;
    double ignored;
    grammar_show(c, text);
    if (grammar_number(p, &ignored)) {
        grammar_mistake(p, at, "a number among the symbols (arguments stand in parentheses, as in F(2))");
        return;
    }
    p->next++;
    if (c == '(') {
        grammar_mistake(p, at, "'(' without a symbol before it (write the symbol, as in F(2))");
        skip_arguments(p, start);
    } else if (c == ')')
        grammar_mistake(p, at, "')' without '(' (remove it)");
    else if (c == '>' || c == ARROW)
        grammar_mistake(p, at, "a second arrow (write each rule on a line of its own)");
    else if (c == 0x2212 || c == 0x2013 || c == 0x2014)
        grammar_mistake(p, at, "%s is not the turtle's minus (write '-')", text);
    else
        grammar_mistake(p, at, "%s is not a symbol (symbols are letters and + - & ^ \\ / | [ ] ! @)", text);
}

static void add_token(parser *p, token t)
{
    shape_grammar *g = p->grammar;
    if (p->out_of_memory || shape_array_reserve((void **)&g->tokens, &g->token_capacity, g->token_count + 1,
                                                sizeof *g->tokens, NULL)) {
        p->out_of_memory = true;
        return;
    }
    g->tokens[g->token_count++] = t;
}

/* Every '[' has its ']' within one body, so that a rewritten symbol leaves the brackets around it alone. */
static void check_brackets(parser *p, const body *b)
{
    if (!b->count)
        return;
    const token *tokens = p->grammar->tokens + b->first;
    int open = 0;
    for (int i = 0; i < b->count; i++) {
        open += (tokens[i].letter == '[') - (tokens[i].letter == ']');
        if (open < 0) {
            grammar_mistake(p, tokens[i].at, "']' without '[' (write '[' before it, or remove it)");
            open = 0;
        }
    }
    int closed = 0;
    for (int i = b->count - 1; i >= 0 && open; i--) {
        closed += (tokens[i].letter == ']') - (tokens[i].letter == '[');
        if (closed < 0) {
            grammar_mistake(p, tokens[i].at, "'[' is not closed (write ']' in the same body)");
            closed = 0;
            open--;
        }
    }
}

void grammar_body(parser *p, bool stop, body *b)
{
    b->first = (int)p->grammar->token_count;
    while (!grammar_at_end(p) && !p->out_of_memory) {
        uint32_t c = grammar_peek(p, 0);
        if (c == ':' || (stop && grammar_at_setting(p)))
            break;
        if (!grammar_is_letter(c) && !is_turtle(c)) {
            unexpected(p);
            continue;
        }
        token t = {(char)c, 0, (int)p->grammar->argument_count, grammar_here(p)};
        p->next++;
        grammar_skip_blanks(p);
        if (grammar_peek(p, 0) == '(')
            parse_arguments(p, &t);
        check_turtle_arguments(p, &t);
        add_token(p, t);
    }
    b->count = (int)p->grammar->token_count - b->first;
    check_brackets(p, b);
}
