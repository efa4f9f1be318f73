/* The steps of neph-lsys, which can also show what a grammar derives. */
#ifndef NEPHELE_CLI_LSYS_H
#define NEPHELE_CLI_LSYS_H

#include "cli_generator.h"
#include "shape/turtle.h"

/* Reads a grammar from a path or "-"; its mistakes end the program, a line each. */
shape_grammar *cli_lsys_read(const char *path);
/* The grammar's settings under what the options say. */
shape_derive_options cli_lsys_options(const shape_grammar *grammar, uint64_t seed);
/* The cloud; path is the grammar's, for its name. */
shape_set *cli_lsys_make(const shape_grammar *grammar, const shape_derive_options *options, const char *path);

#endif
