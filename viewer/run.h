/* run.c: another program of this project, run for what it writes to standard output. */
#ifndef NEPHELE_VIEW_RUN_H
#define NEPHELE_VIEW_RUN_H

#include <stddef.h>
#include <stdio.h>

#include "shape/status.h"
#include "source.h"

/* NULL where memory is out. */
view_run *view_run_create(void);
void view_run_destroy(view_run *run); /* NULL is allowed */
/* Ends what is running, if anything is; from any thread. */
void view_run_cancel(view_run *run);
/* Before a piece of work: what was cancelled before does not count. */
void view_run_begin(view_run *run);
/* Whether it has been cancelled since, for work that is done within this program. NULL is allowed. */
bool view_run_is_cancelled(view_run *run);

/* Runs a program, which stands beside this one or in PATH, to its end. arguments[0] is its name; the array ends by NULL.
 * *bytes, which the caller frees, gets its output; where it fails, mistakes gets what it wrote to standard error, without
 * its name, and the status is SHAPE_ERROR_FORMAT. run may be NULL: then nobody can end it. input: a file that it reads as its
 * standard input, from where that stands; NULL: nothing. */
shape_status view_run_program(view_run *run, char **arguments, FILE *input, unsigned char **bytes,
                              size_t *size, char *mistakes, size_t room, shape_error *error);

#endif
