/* The turtle that turns a derived string into spheres and ellipsoids (Prusinkiewicz and Lindenmayer 1990, section
 * 1.5; Jiménez 2018, section 3.6.2). It starts at the origin with its head along +y, its left side along -x and its
 * back (up) along +z; docs/grammar.md lists its symbols. */
#ifndef SHAPE_TURTLE_H
#define SHAPE_TURTLE_H

#include "shape/grammar.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A turtle at work on one string. Not thread-safe. */
typedef struct shape_turtle shape_turtle;

/* A turtle at the origin that appends to *list, which must outlive it. It copies what it needs of the grammar and
 * the options. The caller destroys it; NULL and *error where memory is out. */
shape_turtle *shape_turtle_create(const shape_grammar *grammar, const shape_derive_options *options,
                                  shape_primitives *list, shape_error *error);
void shape_turtle_destroy(shape_turtle *turtle); /* NULL is allowed */

/* Obeys one symbol. Errors name the symbol's place: a radius that is not above 0, a position beyond 1e9 m, a turn
 * beyond 1e9 degrees, brackets beyond SHAPE_GRAMMAR_BRACKETS_MAX; memory. Symbols without a meaning are passed over. */
shape_status shape_turtle_visit(shape_turtle *turtle, const shape_symbol *symbol, shape_error *error);

/* Derives the grammar and lets a turtle walk the string: its primitives are appended to *list. counts may be NULL. */
shape_status shape_grammar_grow(const shape_grammar *grammar, const shape_derive_options *options,
                                shape_primitives *list, shape_derive_counts *counts, shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
