/* Parametric stochastic L-systems (Prusinkiewicz and Lindenmayer 1990, chapter 1) as the generator of cloud shapes of
 * Jiménez 2018, section 3.6.2. A grammar's text is parsed once; the derived string is then visited symbol by symbol,
 * never held. The language is docs/grammar.md. */
#ifndef SHAPE_GRAMMAR_H
#define SHAPE_GRAMMAR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "shape/set.h"
#include "shape/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A parsed grammar. Read-only after parsing: threads may share it. */
typedef struct shape_grammar shape_grammar;

enum {
    SHAPE_GRAMMAR_TEXT_MAX = 1 << 20,      /* bytes of a grammar's text */
    SHAPE_GRAMMAR_ITERATIONS_MAX = 100000, /* derivation levels */
    SHAPE_GRAMMAR_ARGUMENTS_MAX = 16,      /* of one symbol */
    SHAPE_GRAMMAR_BRACKETS_MAX = 100000,   /* open brackets at one time */
    SHAPE_GRAMMAR_MISTAKES_MAX = 50        /* reported by one parse */
};

/* A number, or a range from which one is drawn at each use; low <= high. */
typedef struct shape_grammar_range {
    double low, high;
} shape_grammar_range;

/* What the settings lines of a file say, with the defaults for what they leave out. */
typedef struct shape_grammar_settings {
    int iterations;             /* 0 to SHAPE_GRAMMAR_ITERATIONS_MAX; default 5 */
    shape_grammar_range angle;  /* degrees, within +-1e6; default 25 */
    shape_grammar_range radius; /* metres, above 0, at most 1e9; default 1 */
    shape_grammar_range length; /* metres, 0 to 1e9; default 1 */
    shape_grammar_range shrink; /* a derivation level, above 0, at most 1000; default 1 */
    double stretch[3];          /* semi-axes over radius: right, forward, up; 1e-6 to 1e6; default 1 */
    shape_field field;          /* noise_scale 0: not set, choose by the radii; seed is not set */
    shape_medium medium;
} shape_grammar_settings;

/* One mistake in a text. Lines and columns are counted from 1; a column is a character, not a byte. */
typedef struct shape_mistake {
    int line, column;
    char text[224]; /* "what is wrong (what to write instead)" */
} shape_mistake;

/* The mistakes of one text, in the text's order. */
typedef struct shape_mistakes {
    shape_mistake items[SHAPE_GRAMMAR_MISTAKES_MAX];
    int count;
    bool more; /* there were more than fit */
} shape_mistakes;

/* Parses UTF-8 text of `size` bytes (no zero byte is needed behind it). `name` stands before the place in the errors
 * of the derivation ("name:line:column: ..."); it is copied. Returns SHAPE_OK and *grammar, which the caller destroys;
 * SHAPE_ERROR_FORMAT where the text holds mistakes, all of which are in *mistakes, while *error holds the first with
 * its place; SHAPE_ERROR_LIMIT for a text above SHAPE_GRAMMAR_TEXT_MAX; SHAPE_ERROR_MEMORY. */
shape_status shape_grammar_parse(const void *text, size_t size, const char *name, shape_grammar **grammar,
                                 shape_mistakes *mistakes, shape_error *error);
void shape_grammar_destroy(shape_grammar *grammar); /* NULL is allowed */

/* The grammar's settings; they live as long as the grammar. */
const shape_grammar_settings *shape_grammar_get_settings(const shape_grammar *grammar);
/* Whether a symbol sets a primitive and steps forward. */
bool shape_grammar_is_puff(const shape_grammar *grammar, char letter);

/* How to derive. */
typedef struct shape_derive_options {
    uint64_t seed;  /* default 1 */
    int iterations; /* as in shape_grammar_settings, and so on */
    shape_grammar_range angle, radius, length, shrink;
    uint64_t max_primitives; /* more end the derivation by SHAPE_ERROR_LIMIT; default 1,000,000 */
    uint64_t
        max_symbols; /* the same for symbols rewritten or derived; 0, the default: 16 times max_primitives, at
                                least 1,000,000 */
} shape_derive_options;

/* What the grammar's settings say, seed 1 and the default limits. */
shape_derive_options shape_derive_defaults(const shape_grammar *grammar);
shape_status shape_derive_check(const shape_derive_options *options, shape_error *error);

/* One symbol of the derived string, its arguments evaluated. */
typedef struct shape_symbol {
    char letter; /* an ASCII letter or one of + - & ^ \ / | [ ] ! @ */
    int argument_count;
    const double *arguments; /* valid during the visit */
    double scale;            /* product of the shrink factors of the rules that led to it */
    uint64_t key;            /* seeds what is drawn for this symbol alone */
    int line, column;        /* where it stands in the grammar's text */
} shape_symbol;

/* Called for each symbol in order. Anything but SHAPE_OK ends the derivation and is returned by it. */
typedef shape_status shape_symbol_visitor(void *user, const shape_symbol *symbol, shape_error *error);

typedef struct shape_derive_counts {
    uint64_t symbols;    /* of the derived string, brackets and turns included */
    uint64_t primitives; /* symbols that are puffs */
} shape_derive_counts;

/* Derives the grammar depth first and visits the string from left to right. Memory grows with the derivation's depth,
 * not with the string. visitor may be NULL (to count); counts may be NULL. Every draw is seeded by the seed and the
 * place of its symbol in the derivation's tree, so a choice does not depend on what happens in other branches or on
 * the number of iterations. Errors: options out of range, a limit passed, memory, an expression without a value
 * ("name:line:column: ..."), the visitor's. */
shape_status shape_grammar_derive(const shape_grammar *grammar, const shape_derive_options *options,
                                  shape_symbol_visitor *visitor, void *user, shape_derive_counts *counts,
                                  shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
