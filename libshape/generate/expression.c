/* Arithmetic in grammars: conditions, arguments, weights. An expression becomes a tree of nodes; one without
 * parameters and chance is evaluated at once, so its mistakes are found while parsing. */
#include "generate/grammar_private.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"

enum { MAX_HEIGHT = 200, MAX_NESTING = 60 };

static const struct function {
    const char *name;
    node_kind kind;
    int arguments;
} functions[] = {{"min", NODE_MIN, 2},     {"max", NODE_MAX, 2},  {"mod", NODE_MOD, 2},
                 {"rand", NODE_RANGE, 2},  {"abs", NODE_ABS, 1},  {"sqrt", NODE_SQRT, 1},
                 {"exp", NODE_EXP, 1},     {"log", NODE_LOG, 1},  {"floor", NODE_FLOOR, 1},
                 {"ceil", NODE_CEIL, 1},   {"sin", NODE_SIN, 1},  {"cos", NODE_COS, 1},
                 {"round", NODE_ROUND, 1}, {NULL, NODE_NUMBER, 0}};

static const char *const function_names[] = {"min", "max",   "mod",  "rand", "abs", "sqrt",  "exp",
                                             "log", "floor", "ceil", "sin",  "cos", "round", NULL};

/* --- evaluation --- */

static bool fail(evaluation *e, const node *n, const char *problem)
{
    e->at = n->at;
    e->problem = problem;
    return false;
}

static double draw(evaluation *e, double low, double high)
{
    if (!e->seeded) {
        e->random = shape_random_seed(e->key, e->stream);
        e->seeded = true;
    }
    return shape_random_range(&e->random, low, high);
}

/* Sine and cosine take degrees, like every angle of a grammar. */
static const double radians = 0x1.1df46a2529d39p-6;

static double round_half_up(double a)
{
    return floor(a + 0.5);
}

/* Operators whose arguments are all evaluated. */
static bool apply(evaluation *e, const node *n, double a, double b, double *value)
{
    switch (n->kind) {
    case NODE_NEGATE:
        *value = -a;
        return true;
    case NODE_NOT:
        *value = a == 0;
        return true;
    case NODE_ADD:
        *value = a + b;
        return true;
    case NODE_SUBTRACT:
        *value = a - b;
        return true;
    case NODE_MULTIPLY:
        *value = a * b;
        return true;
    case NODE_DIVIDE:
        if (b == 0)
            return fail(e, n, "division by zero (guard it by a condition)");
        *value = a / b;
        return true;
    case NODE_MOD:
        if (b == 0)
            return fail(e, n, "mod by zero (guard it by a condition)");
        *value = a - b * floor(a / b);
        return true;
    case NODE_POWER:
        if (a < 0 && b != floor(b))
            return fail(e, n, "a broken power of a negative number (use a whole exponent or abs)");
        if (a < 0 && fabs(b) > 64) { /* shape_pow's exact products end at 64 */
            *value = shape_pow(-a, b) * (b - 2 * floor(b / 2) != 0 ? -1 : 1);
            return true;
        }
        *value = shape_pow(a, b);
        return true;
    case NODE_LESS:
        *value = a < b;
        return true;
    case NODE_LESS_EQUAL:
        *value = a <= b;
        return true;
    case NODE_GREATER:
        *value = a > b;
        return true;
    case NODE_GREATER_EQUAL:
        *value = a >= b;
        return true;
    case NODE_EQUAL:
        *value = a == b;
        return true;
    case NODE_UNEQUAL:
        *value = a != b;
        return true;
    case NODE_RANGE:
        if (a > b)
            return fail(e, n, "the range runs backwards (put the smaller number first)");
        *value = draw(e, a, b);
        return true;
    case NODE_MIN:
        *value = a < b ? a : b;
        return true;
    case NODE_MAX:
        *value = a > b ? a : b;
        return true;
    case NODE_ABS:
        *value = fabs(a);
        return true;
    case NODE_SQRT:
        if (a < 0)
            return fail(e, n, "the square root of a negative number (use abs or a condition)");
        *value = sqrt(a);
        return true;
    case NODE_FLOOR:
        *value = floor(a);
        return true;
    case NODE_CEIL:
        *value = ceil(a);
        return true;
    case NODE_ROUND:
        *value = round_half_up(a);
        return true;
    case NODE_EXP:
        *value = shape_exp(a);
        return true;
    case NODE_LOG:
        if (a <= 0)
            return fail(e, n, "the logarithm of a number that is not above 0 (use a condition)");
        *value = shape_log(a);
        return true;
    case NODE_SIN:
    case NODE_COS:
        if (fabs(a) > 1e9)
            return fail(e, n, "an angle beyond 1e9 degrees (use mod)");
        *value = n->kind == NODE_SIN ? shape_sin(a * radians) : shape_cos(a * radians);
        return true;
    case NODE_NUMBER:
    case NODE_PARAMETER:
    case NODE_AND:
    case NODE_OR:
        break;
    }
    return fail(e, n, "an expression without a value (write a number)");
}

bool grammar_evaluate(evaluation *e, int index, double *value)
{
    const node *n = &e->grammar->nodes[index];
    double a = 0, b = 0;
    if (n->kind == NODE_NUMBER) {
        *value = n->value;
        return true;
    }
    if (n->kind == NODE_PARAMETER) {
        *value = e->parameters[n->left]; /* NOLINT: the parser lets no parameter stand where there are none */
        return true;
    }
    if (!grammar_evaluate(e, n->left, &a))
        return false;
    if (n->kind == NODE_AND || n->kind == NODE_OR) {
        bool decided = (a != 0) == (n->kind == NODE_OR);
        if (!decided && !grammar_evaluate(e, n->right, &b))
            return false;
        *value = decided ? a != 0 : b != 0;
        return true;
    }
    if (n->right != NO_NODE && !grammar_evaluate(e, n->right, &b))
        return false;
    if (!apply(e, n, a, b, value))
        return false;
    if (!isfinite(*value))
        return fail(e, n, "the result is too large for a number (use smaller numbers)");
    return true;
}

/* --- parsing --- */

static int add_node(parser *p, node_kind kind, int left, int right, double value, place at)
{
    shape_grammar *g = p->grammar;
    if (p->out_of_memory || shape_array_reserve((void **)&g->nodes, &g->node_capacity, g->node_count + 1,
                                                sizeof *g->nodes, NULL)) {
        p->out_of_memory = true;
        return NO_NODE;
    }
    node n = {kind, left, right, 1, kind != NODE_PARAMETER && kind != NODE_RANGE, value, at};
    int children[2] = {kind == NODE_PARAMETER ? NO_NODE : left, right};
    for (int i = 0; i < 2; i++)
        if (children[i] != NO_NODE) {
            const node *child = &g->nodes[children[i]];
            n.constant = n.constant && child->constant;
            if (child->height >= n.height)
                n.height = child->height + 1;
        }
    if (n.height > MAX_HEIGHT) {
        grammar_mistake(p, at, "the expression has more than %d operators in a row (split it)", MAX_HEIGHT);
        return NO_NODE;
    }
    g->nodes[g->node_count] = n;
    return (int)g->node_count++;
}

/* An operator over nodes that may be missing after a mistake. */
static int join(parser *p, node_kind kind, int left, int right, place at)
{
    return left == NO_NODE || right == NO_NODE ? NO_NODE : add_node(p, kind, left, right, 0, at);
}

static int parse_range(parser *p);

static int parse_unary(parser *p);

static void list_parameters(const parser *p, char *text, size_t room)
{
    if (!p->letter)
        snprintf(text, room, "the axiom has none; write a number");
    else if (!p->parameter_count)
        snprintf(text, room, "%c has none; write them behind it, as in %c(r)", p->letter, p->letter);
    else {
        size_t used = (size_t)snprintf(text, room, "those of %c: ", p->letter);
        for (int i = 0; i < p->parameter_count && used < room; i++)
            used += (size_t)snprintf(text + used, room - used, "%s%s", i ? ", " : "", p->parameters[i]);
    }
}

static int parse_parameter(parser *p, const char *name, place at)
{
    for (int i = 0; i < p->parameter_count; i++)
        if (!strcmp(name, p->parameters[i]))
            return add_node(p, NODE_PARAMETER, i, NO_NODE, 0, at);
    if (p->any_parameter)
        return add_node(p, NODE_PARAMETER, 0, NO_NODE, 0, at);
    char known[160];
    list_parameters(p, known, sizeof known);
    grammar_mistake(p, at, "%s is not a parameter (%s)", name, known);
    return NO_NODE;
}

/* The closing parenthesis; false after the mistake is reported. */
static bool close(parser *p, place open)
{
    char text[48];
    grammar_skip_blanks(p);
    if (grammar_peek(p, 0) == ')') {
        p->next++;
        return true;
    }
    if (p->next < p->end)
        grammar_mistake(p, grammar_here(p), "%s is not expected here (write an operator, '..' or ')')",
                        grammar_show(grammar_peek(p, 0), text));
    else
        grammar_mistake(p, open, "'(' is not closed (write ')')");
    return false;
}

static int parse_call(parser *p, const char *name, place at)
{
    const struct function *f = functions;
    while (f->name && strcmp(f->name, name))
        f++;
    if (!f->name) {
        const char *near = grammar_nearest(name, function_names);
        if (near)
            grammar_mistake(p, at, "%s is not a function (did you mean %s?)", name, near);
        else
            grammar_mistake(
                p, at,
                "%s is not a function (there are min, max, mod, rand, abs, sqrt, exp, log, floor, ceil, "
                "round, sin, cos)",
                name);
        return NO_NODE;
    }
    place open = grammar_here(p);
    p->next++;
    int given[2] = {NO_NODE, NO_NODE}, count = 0;
    do {
        if (count)
            p->next++; /* the comma */
        int one = parse_range(p);
        if (one == NO_NODE)
            return NO_NODE;
        if (count < 2)
            given[count] = one;
        count++;
        grammar_skip_blanks(p);
    } while (grammar_peek(p, 0) == ',');
    if (!close(p, open))
        return NO_NODE;
    if (count != f->arguments) {
        grammar_mistake(p, at, "%s has %d argument%s (it takes %d)", name, count, count == 1 ? "" : "s",
                        f->arguments);
        return NO_NODE;
    }
    return add_node(p, f->kind, given[0], given[1], 0, at);
}

static int parse_primary(parser *p)
{
    char word[NAME_ROOM], text[48];
    double value;
    grammar_skip_blanks(p);
    place at = grammar_here(p);
    if (grammar_number(p, &value)) {
        if (grammar_is_letter(grammar_peek(p, 0)) || grammar_peek(p, 0) == '_') {
            grammar_mistake(p, grammar_here(p),
                            "%s directly behind a number (write an operator between, as in 2*r)",
                            grammar_show(grammar_peek(p, 0), text));
            return NO_NODE;
        }
        return add_node(p, NODE_NUMBER, NO_NODE, NO_NODE, value, at);
    }
    if (grammar_word(p, false, word)) {
        grammar_skip_blanks(p);
        return grammar_peek(p, 0) == '(' ? parse_call(p, word, at) : parse_parameter(p, word, at);
    }
    if (grammar_peek(p, 0) == '(') {
        p->next++;
        int inner = parse_range(p);
        return inner != NO_NODE && close(p, at) ? inner : NO_NODE;
    }
    grammar_mistake(p, at, "%s where a number should stand (write a number, a parameter or '(')",
                    grammar_show(grammar_peek(p, 0), text));
    return NO_NODE;
}

static int parse_power(parser *p)
{
    int left = parse_primary(p);
    grammar_skip_blanks(p);
    if (left == NO_NODE || grammar_peek(p, 0) != '^')
        return left;
    place at = grammar_here(p);
    p->next++;
    return join(p, NODE_POWER, left, parse_unary(p), at);
}

/* Every way to nest passes through here, so here the parser's own recursion is bounded. */
static int parse_unary(parser *p)
{
    grammar_skip_blanks(p);
    place at = grammar_here(p);
    uint32_t c = grammar_peek(p, 0);
    int result = NO_NODE;
    if (++p->nesting > MAX_NESTING) {
        grammar_mistake(p, at, "the expression is nested deeper than %d (split it)", MAX_NESTING);
    } else if (c == '-' || c == '+' || (c == '!' && grammar_peek(p, 1) != '=')) {
        p->next++;
        result = parse_unary(p);
        if (c != '+' && result != NO_NODE)
            result = add_node(p, c == '-' ? NODE_NEGATE : NODE_NOT, result, NO_NODE, 0, at);
    } else {
        result = parse_power(p);
    }
    p->nesting--;
    return result;
}

static int parse_product(parser *p)
{
    int left = parse_unary(p);
    for (;;) {
        grammar_skip_blanks(p);
        uint32_t c = grammar_peek(p, 0);
        if (left == NO_NODE || (c != '*' && c != '/' && c != '%'))
            return left;
        place at = grammar_here(p);
        p->next++;
        left = join(p,
                    c == '*'   ? NODE_MULTIPLY
                    : c == '/' ? NODE_DIVIDE
                               : NODE_MOD,
                    left, parse_unary(p), at);
    }
}

static int parse_sum(parser *p)
{
    int left = parse_product(p);
    for (;;) {
        grammar_skip_blanks(p);
        uint32_t c = grammar_peek(p, 0);
        if (left == NO_NODE || (c != '+' && c != '-'))
            return left;
        place at = grammar_here(p);
        p->next++;
        left = join(p, c == '+' ? NODE_ADD : NODE_SUBTRACT, left, parse_product(p), at);
    }
}

/* The comparison at the cursor and its length in characters, 0 where there is none. */
static int comparison(const parser *p, node_kind *kind)
{
    uint32_t c = grammar_peek(p, 0);
    bool equal = grammar_peek(p, 1) == '=';
    if (c == '<')
        *kind = equal ? NODE_LESS_EQUAL : NODE_LESS;
    else if (c == '>')
        *kind = equal ? NODE_GREATER_EQUAL : NODE_GREATER;
    else if (c == '=' && equal)
        *kind = NODE_EQUAL;
    else if (c == '!' && equal)
        *kind = NODE_UNEQUAL;
    else
        return 0;
    return equal ? 2 : 1;
}

static int parse_comparison(parser *p)
{
    int left = parse_sum(p);
    node_kind kind = NODE_LESS, second;
    grammar_skip_blanks(p);
    place at = grammar_here(p);
    if (left != NO_NODE && grammar_peek(p, 0) == '=' && grammar_peek(p, 1) != '=') {
        grammar_mistake(p, at, "'=' compares nothing (write ==)");
        return NO_NODE;
    }
    int length = comparison(p, &kind);
    if (left == NO_NODE || !length)
        return left;
    p->next += (size_t)length;
    left = join(p, kind, left, parse_sum(p), at);
    grammar_skip_blanks(p);
    if (left != NO_NODE && comparison(p, &second)) {
        grammar_mistake(p, grammar_here(p), "a second comparison (join two by &&, as in 0 < n && n < 5)");
        return NO_NODE;
    }
    return left;
}

static int parse_and(parser *p)
{
    int left = parse_comparison(p);
    for (;;) {
        grammar_skip_blanks(p);
        if (left == NO_NODE || grammar_peek(p, 0) != '&')
            return left;
        place at = grammar_here(p);
        if (grammar_peek(p, 1) != '&') {
            grammar_mistake(p, at, "a single '&' (write && for \"and\")");
            return NO_NODE;
        }
        p->next += 2;
        left = join(p, NODE_AND, left, parse_comparison(p), at);
    }
}

static int parse_or(parser *p)
{
    int left = parse_and(p);
    for (;;) {
        grammar_skip_blanks(p);
        if (left == NO_NODE || grammar_peek(p, 0) != '|')
            return left;
        place at = grammar_here(p);
        if (grammar_peek(p, 1) != '|') {
            grammar_mistake(p, at, "a single '|' (write || for \"or\")");
            return NO_NODE;
        }
        p->next += 2;
        left = join(p, NODE_OR, left, parse_and(p), at);
    }
}

/* Evaluates what does not change, and puts the number in its place. */
static int fold(parser *p, int index)
{
    if (index == NO_NODE || !p->grammar->nodes[index].constant)
        return index;
    evaluation e = {.grammar = p->grammar};
    double value;
    if (!grammar_evaluate(&e, index, &value)) {
        grammar_mistake(p, e.at, "%s", e.problem);
        return NO_NODE;
    }
    node *n = &p->grammar->nodes[index];
    n->kind = NODE_NUMBER;
    n->left = n->right = NO_NODE;
    n->value = value;
    return index;
}

/* An expression, or a range A..B of two: what stands between parentheses or commas. */
static int parse_range(parser *p)
{
    int low = parse_or(p);
    grammar_skip_blanks(p);
    if (low == NO_NODE || grammar_peek(p, 0) != '.' || grammar_peek(p, 1) != '.')
        return low;
    place at = grammar_here(p);
    p->next += 2;
    low = fold(p, low);
    int high = fold(p, parse_or(p));
    if (low == NO_NODE || high == NO_NODE)
        return NO_NODE;
    const node *a = &p->grammar->nodes[low], *b = &p->grammar->nodes[high];
    if (a->kind == NODE_NUMBER && b->kind == NODE_NUMBER && a->value > b->value) {
        grammar_mistake(p, a->at, "the range %g..%g runs backwards (write %g..%g)", a->value, b->value,
                        b->value, a->value);
        return NO_NODE;
    }
    return add_node(p, NODE_RANGE, low, high, 0, at);
}

int grammar_expression(parser *p)
{
    return fold(p, parse_or(p));
}

int grammar_argument(parser *p)
{
    return fold(p, parse_range(p));
}
