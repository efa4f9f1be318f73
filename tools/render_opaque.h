/* The opaque things of neph-render and neph-view: those of the scene, --mesh and --ground. */
#ifndef NEPHELE_RENDER_OPAQUE_H
#define NEPHELE_RENDER_OPAQUE_H

#include "cli.h"
#include "cli_scene.h"
#include "shape/opaque.h"

extern const cli_option render_opaque_options[];
bool render_opaque_given(void);
/* Reads the meshes of the input's scene and all --mesh files, and --ground; NULL where there are none. The caller destroys it. Exits 1
 * with what is wrong with a file, 2 where colours are. */
shape_opaque *render_opaque_read(const cli_input *input);
/* The --mesh files as the meshes of a scene, by the paths that were given, for programs that read them again. The caller
 * destroys it. */
shape_scene *render_opaque_list(void);
/* The options that were given, as a shell reads them back; cut at room bytes, at least 256. */
void render_opaque_text(char *text, size_t room);
/* Whether there is a ground, and which. */
bool render_opaque_ground(double *height, float albedo[3]);
/* Adds the --mesh files to a scene that is being saved. */
void render_opaque_save(shape_scene *scene);
/* Ends the program, exit 2, where they cannot be saved. */
void render_opaque_save_check(void);

#endif
