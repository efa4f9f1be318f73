/* Meshes from files: OBJ, PLY, STL, OFF, glTF, GLB. Programs that use this link shape_gltf. */
#ifndef NEPHELE_MESH_FILE_H
#define NEPHELE_MESH_FILE_H

#include "cli.h"
#include "shape/mesh.h"

/* Reads a mesh as its file has it. note: the file is one of the inputs that a .neph tells of. Mistakes end the program,
 * exit 1. The caller destroys it. */
shape_mesh *mesh_file_read(const char *path, bool note, shape_mesh_format *format);
/* Whether files of that format have z as up, where nothing else is said. */
bool mesh_file_z_up(shape_mesh_format format);

#endif
