/* neph-render's --mesh: opaque things in the picture. */
#ifndef NEPHELE_RENDER_OPAQUE_H
#define NEPHELE_RENDER_OPAQUE_H

#include "cli.h"
#include "shape/opaque.h"

extern const cli_option render_opaque_options[];
bool render_opaque_given(void);
/* Reads all --mesh files; NULL where none was given. The caller destroys it. Exits 1 with what is wrong with a file, 2
 * where colours are. */
shape_opaque *render_opaque_read(void);

#endif
