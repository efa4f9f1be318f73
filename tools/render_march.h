/* neph-render's options of --method march, and what they become. */
#ifndef NEPHELE_RENDER_MARCH_H
#define NEPHELE_RENDER_MARCH_H

#include "cli.h"
#include "shape/march.h"

extern const cli_option render_march_options[];
/* Whether any of them but --light-resolution was given, and whether that was (and as what): the paper's methods have a
 * light grid too. */
bool render_march_given(void);
bool render_march_resolution(int *cells);
/* Ends the program with exit 2 where options do not go together. */
void render_march_check(bool has_things);
/* Whether the light and shadow that are chosen can show a lamp. */
bool render_march_takes_lamp(void);
/* What the command line says, for clouds whose longest side is so many metres. */
shape_march_options render_march_make(double side, const shape_view *view);

#endif
