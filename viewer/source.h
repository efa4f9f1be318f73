/* source.c: the file that the viewer shows: a .neph, or a grammar that is derived here. */
#ifndef NEPHELE_VIEW_SOURCE_H
#define NEPHELE_VIEW_SOURCE_H

#include <stdint.h>

#include "shape/set.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { VIEW_PATH_MAX = 4096 }; /* bytes of a file's path */

/* How a grammar is derived. What `own_` names is taken from here, the rest from the file. */
typedef struct view_generator {
    bool own_iterations, own_angle;
    int iterations;
    double angle[2]; /* degrees, low and high */
    uint64_t seed;
} view_generator;

/* What a file held. */
typedef struct view_contents {
    shape_set *set;      /* the caller destroys it */
    bool grammar;        /* made from a grammar */
    view_generator used; /* what the grammar was derived by, settings of the file included */
} view_contents;

/* Reads a .neph, or a grammar and derives it as neph-lsys does. path "-": standard input. Which of the two it is shows in
 * the bytes. Mistakes of a grammar: "path:line:column: text", all of them (as far as there is room), one a line. */
shape_status view_source_read(const char *path, const view_generator *generator, view_contents *contents,
                              char *mistakes, size_t room, shape_error *error);
/* The same of a file's bytes that have been read already. */
shape_status view_source_decode(const char *path, const unsigned char *bytes, size_t size,
                                const view_generator *generator, view_contents *contents, char *mistakes,
                                size_t room, shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
