/* Derivation of a parametric stochastic L-system (Prusinkiewicz and Lindenmayer 1990, sections 1.7 and 1.10), depth
 * first: a stack of half-read bodies, one for each level, stands for the string, which is never held. */
#include "shape/grammar.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/random_inline.h"
#include "generate/grammar_private.h"

/* Which stream of a symbol's key serves what; the turtle's is its own (turtle.c). */
enum { STREAM_ARGUMENTS = 1, STREAM_CONDITION = 2, STREAM_CHOICE = 3, STREAM_SHRINK = 4 };

enum { PLACES = 32 }; /* of symbols in a body, from its end, whose hashes are kept at hand */

/* A body being read: the symbols from `next` on are still to come. */
typedef struct level {
    int next, end;     /* in grammar->tokens */
    size_t parameters; /* where the rule's parameters begin in the stack of values */
    int parameter_count;
    double scale;
    uint64_t key;
} level;

typedef struct derivation {
    const shape_grammar *grammar;
    shape_derive_options options;
    shape_symbol_visitor *visitor;
    void *user;
    shape_derive_counts counts;
    uint64_t work; /* symbols rewritten or derived */
    uint64_t place_hashes[PLACES];
    level *levels;
    double *values;
    size_t level_count, level_capacity, value_count, value_capacity;
    shape_error *error;
} derivation;

shape_derive_options shape_derive_defaults(const shape_grammar *grammar)
{
    const shape_grammar_settings *s = &grammar->settings;
    shape_derive_options options = {.seed = 1,
                                    .iterations = s->iterations,
                                    .angle = s->angle,
                                    .radius = s->radius,
                                    .length = s->length,
                                    .shrink = s->shrink,
                                    .max_primitives = 1000000,
                                    .max_symbols = 0};
    return options;
}

static shape_status check_range(const char *name, shape_grammar_range r, double min, double max,
                                const char *range, shape_error *error)
{
    if (!(r.low >= min && r.high <= max && r.low <= r.high))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "%s %g..%g: out of range (it must be %s)", name,
                               r.low, r.high, range);
    return SHAPE_OK;
}

shape_status shape_derive_check(const shape_derive_options *o, shape_error *error)
{
    if (o->iterations < 0 || o->iterations > SHAPE_GRAMMAR_ITERATIONS_MAX)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "iterations is %d (it must be 0 to %d)",
                               o->iterations, SHAPE_GRAMMAR_ITERATIONS_MAX);
    if (o->max_primitives < 1)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "max-primitives is 0 (it must be at least 1)");
    shape_status status = check_range("angle", o->angle, -1e6, 1e6, "-1e6 to 1e6 degrees", error);
    if (!status)
        status = check_range("radius", o->radius, 1e-9, 1e9, "above 0, at most 1e9 m", error);
    if (!status)
        status = check_range("length", o->length, 0, 1e9, "0 to 1e9 m", error);
    if (!status)
        status = check_range("shrink", o->shrink, 1e-9, 1000, "above 0, at most 1000", error);
    return status;
}

static shape_status no_value(derivation *d, const evaluation *e)
{
    return shape_error_set(d->error, SHAPE_ERROR_FORMAT, "%s:%d:%d: %s", d->grammar->name, e->at.line,
                           e->at.column, e->problem);
}

/* The key of a symbol, by its place counted from its body's end: all chance below it follows from it. */
static uint64_t child_key(const derivation *d, uint64_t key, uint64_t index)
{
    return random_hash(key + (index < PLACES ? d->place_hashes[index] : random_hash(index + 1)));
}

static shape_status evaluate_arguments(derivation *d, const token *t, const level *l, uint64_t key,
                                       double *arguments)
{
    evaluation e = {.grammar = d->grammar,
                    .parameters = d->values + l->parameters,
                    .key = key,
                    .stream = STREAM_ARGUMENTS};
    for (int i = 0; i < t->argument_count; i++)
        if (!grammar_evaluate(&e, d->grammar->arguments[t->first_argument + i], &arguments[i]))
            return no_value(d, &e);
    return SHAPE_OK;
}

/* A rule's weight under these parameters, 0 where its condition does not hold. */
static shape_status weigh(derivation *d, const rule *r, evaluation *e, double *weight)
{
    double holds = 1;
    *weight = 0;
    if (r->condition != NO_NODE && !grammar_evaluate(e, r->condition, &holds))
        return no_value(d, e);
    if (holds == 0)
        return SHAPE_OK;
    *weight = 1;
    if (r->weight != NO_NODE && !grammar_evaluate(e, r->weight, weight))
        return no_value(d, e);
    if (*weight < 0) {
        place at = d->grammar->nodes[r->weight].at;
        return shape_error_set(d->error, SHAPE_ERROR_FORMAT,
                               "%s:%d:%d: the probability is %g (make it 0 or more, with max)",
                               d->grammar->name, at.line, at.column, *weight);
    }
    return SHAPE_OK;
}

/* The rule that rewrites a symbol, or NULL where it stays as it is. Two passes over the symbol's rules: the sum of
 * the weights, then the one in which the drawn point lies. The second pass repeats the first one's draws. */
static shape_status choose(derivation *d, const token *t, const double *arguments, uint64_t key,
                           const rule **chosen)
{
    const shape_grammar *g = d->grammar;
    int first = g->first_rule[(unsigned char)t->letter];
    *chosen = NULL;
    if (first == NO_RULE)
        return SHAPE_OK;
    const rule *only = &g->rules[first];
    if (only->next == NO_RULE && only->condition == NO_NODE && only->weight == NO_NODE) {
        *chosen = only;
        return SHAPE_OK;
    }
    double sum = 0, point = 0, weight;
    for (int pass = 0; pass < 2; pass++) {
        evaluation e = {.grammar = g, .parameters = arguments, .key = key, .stream = STREAM_CONDITION};
        double below = 0;
        for (int i = first; i != NO_RULE; i = g->rules[i].next) {
            shape_status status = weigh(d, &g->rules[i], &e, &weight);
            if (status)
                return status;
            below += weight;
            if (pass && weight > 0) {
                *chosen = &g->rules[i]; /* the last of them where rounding leaves the point at the sum */
                if (point < below)
                    return SHAPE_OK;
            }
        }
        sum = below;
        if (!(sum > 0))
            return SHAPE_OK;
        if (!pass) {
            shape_random random = random_seed(key, STREAM_CHOICE);
            point = random_unit(&random) * sum;
        }
    }
    return SHAPE_OK;
}

static shape_status push_level(derivation *d, const rule *r, const double *arguments, int count, double scale,
                               uint64_t key)
{
    if (shape_array_reserve((void **)&d->levels, &d->level_capacity, d->level_count + 1, sizeof *d->levels,
                            d->error) ||
        shape_array_reserve((void **)&d->values, &d->value_capacity,
                            d->value_count + SHAPE_GRAMMAR_ARGUMENTS_MAX, sizeof *d->values, d->error))
        return SHAPE_ERROR_MEMORY;
    if (d->options.shrink.low < d->options.shrink.high) {
        shape_random random = random_seed(key, STREAM_SHRINK);
        scale *= random_range(&random, d->options.shrink.low, d->options.shrink.high);
    } else {
        scale *= d->options.shrink.low;
    }
    level l = {r->body.first, r->body.first + r->body.count, d->value_count, count, scale, key};
    if (count)
        memcpy(d->values + d->value_count, arguments, (size_t)count * sizeof *arguments);
    d->value_count += (size_t)count;
    d->levels[d->level_count++] = l;
    return SHAPE_OK;
}

static shape_status over_limit(derivation *d, const token *t, uint64_t limit, const char *what,
                               const char *remedy)
{
    return shape_error_set(d->error, SHAPE_ERROR_LIMIT, "%s:%d:%d: more than %llu %s by %d iterations (%s)",
                           d->grammar->name, t->at.line, t->at.column, (unsigned long long)limit, what,
                           d->options.iterations, remedy);
}

static shape_status emit(derivation *d, const token *t, const double *arguments, double scale, uint64_t key)
{
    d->counts.symbols++;
    if (d->grammar->puffs[(unsigned char)t->letter]) {
        if (d->counts.primitives == d->options.max_primitives)
            return over_limit(d, t, d->options.max_primitives, "primitives",
                              "lower the iterations, or raise max-primitives");
        d->counts.primitives++;
    }
    if (!d->visitor)
        return SHAPE_OK;
    shape_symbol symbol = {t->letter, t->argument_count, arguments, scale, key, t->at.line, t->at.column};
    return d->visitor(d->user, &symbol, d->error);
}

/* Reads the next symbol of the innermost body: rewrites it or hands it to the visitor. */
static shape_status step(derivation *d)
{
    level *l = &d->levels[d->level_count - 1];
    if (l->next == l->end) {
        d->value_count = l->parameters;
        d->level_count--;
        return SHAPE_OK;
    }
    double arguments[SHAPE_GRAMMAR_ARGUMENTS_MAX];
    const rule *chosen = NULL;
    const token *t = &d->grammar->tokens[l->next++];
    uint64_t key = child_key(d, l->key, (uint64_t)(l->end - l->next));
    double scale = l->scale;
    if (d->work++ == d->options.max_symbols)
        return over_limit(d, t, d->options.max_symbols, "symbols",
                          "lower the iterations, or raise max-primitives, which raises this limit too");
    shape_status status = evaluate_arguments(d, t, l, key, arguments);
    if (!status && d->level_count <= (size_t)d->options.iterations)
        status = choose(d, t, arguments, key, &chosen);
    if (status)
        return status;
    return chosen ? push_level(d, chosen, arguments, t->argument_count, scale, key)
                  : emit(d, t, arguments, scale, key);
}

shape_status shape_grammar_derive(const shape_grammar *grammar, const shape_derive_options *options,
                                  shape_symbol_visitor *visitor, void *user, shape_derive_counts *counts,
                                  shape_error *error)
{
    enum { SYMBOLS_A_PRIMITIVE = 16, LEAST_SYMBOLS = 1000000 };
    shape_status status = shape_derive_check(options, error);
    if (status)
        return status;
    derivation d = {
        .grammar = grammar, .options = *options, .visitor = visitor, .user = user, .error = error};
    for (uint64_t i = 0; i < PLACES; i++)
        d.place_hashes[i] = random_hash(i + 1);
    if (!d.options.max_symbols)
        d.options.max_symbols = options->max_primitives > UINT64_MAX / SYMBOLS_A_PRIMITIVE
                                    ? UINT64_MAX
                                    : options->max_primitives * SYMBOLS_A_PRIMITIVE;
    if (!options->max_symbols && d.options.max_symbols < LEAST_SYMBOLS)
        d.options.max_symbols = LEAST_SYMBOLS;
    level start = {grammar->axiom.first,      grammar->axiom.first + grammar->axiom.count, 0, 0, 1,
                   random_hash(options->seed)};
    status = shape_array_reserve((void **)&d.levels, &d.level_capacity, 1, sizeof *d.levels, error);
    if (!status)
        status = shape_array_reserve((void **)&d.values, &d.value_capacity, 1, sizeof *d.values, error);
    if (!status)
        d.levels[d.level_count++] = start;
    while (!status && d.level_count)
        status = step(&d);
    free(d.levels);
    free(d.values);
    if (counts)
        *counts = d.counts;
    return status;
}
