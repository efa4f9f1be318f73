/* entry.c: what makes a cloud of a scene, as settings that the panel can change, and these put back into the scene. */
#ifndef NEPHELE_VIEW_ENTRY_H
#define NEPHELE_VIEW_ENTRY_H

#include "shape/scene.h"
#include "source.h"

/* The generator of the first entry of a scene that has one whose options can be changed, as they stand there; which is -1
 * where there is none. What a grammar says by itself is not in it. */
view_generator view_entry_generator(const shape_scene *scene);
/* Whether that entry still says in this scene what it said when the generator was taken from it. */
bool view_entry_stands(const shape_scene *scene, const view_generator *generator);
/* Puts the generator's options into the entry that it is of, in place of those that the panel has; the rest stays. */
shape_status view_entry_apply(shape_scene *scene, const view_generator *generator, shape_error *error);
/* The scene with these options and with its clouds' files as seen from the current folder, as text; the caller frees it.
 * path: the scene's. Errors: a file outside its folder, memory. */
shape_status view_entry_text(const shape_scene *scene, const char *path, const view_generator *generator,
                             char **text, size_t *size, shape_error *error);

/* source.c: what the grammar of a generator that is neph-lsys says by itself, into those of its settings that are not given;
 * nothing where it cannot be read. */
void view_source_fill_entry(const shape_scene *scene, const char *path, view_generator *used);

#endif
