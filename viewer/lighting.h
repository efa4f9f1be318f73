/* lighting.c: by what the clouds are lit: neph-view's options for it, and what they become. */
#ifndef NEPHELE_VIEW_LIGHTING_H
#define NEPHELE_VIEW_LIGHTING_H

#include "cli.h"
#include "shape_gl.h"
#include "state.h"

extern const cli_option view_light_options[];

/* What the command line says. */
view_lighting view_lighting_given(void);
/* Ends the program with exit 2 where options of the command line do not go together with each other, or with the method
 * (shape_gl_method) that is in force; notes a scene's light that the method has not. */
void view_lighting_check(const view_lighting *lighting, int method);
shape_gl_lighting view_lighting_gl(const view_lighting *lighting);

#endif
