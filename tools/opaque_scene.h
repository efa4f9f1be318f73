/* The meshes of a scene, as opaque things to be rendered. Programs that use this link shape_gltf. */
#ifndef NEPHELE_OPAQUE_SCENE_H
#define NEPHELE_OPAQUE_SCENE_H

#include "shape/opaque.h"
#include "shape/scene.h"

/* Adds all meshes of a scene whose own path is given, for its folder. The caller calls shape_opaque_finish. Mistakes end
 * the program, exit 1, with the mesh's place in the scene. */
void opaque_scene_add(shape_opaque *opaque, const shape_scene *scene, const char *path);
/* One mesh from a file, which the path opens as it is. */
void opaque_scene_add_file(shape_opaque *opaque, const shape_scene_mesh *mesh, const char *path);

#endif
