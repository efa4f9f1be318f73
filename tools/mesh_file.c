/* Meshes from files, as they are there: what neph-mesh fits ellipsoids to, and what neph-render draws. */
#include "mesh_file.h"

#include <stdlib.h>
#include <string.h>

#include "shape/file.h"

enum { MAX_FILE = 0x40000000 };

static shape_mesh *decode(const char *path, const char *name, shape_mesh_format format,
                          const unsigned char *bytes, size_t size)
{
    shape_error error;
    shape_mesh *mesh;
    if (format != SHAPE_MESH_GLTF && format != SHAPE_MESH_GLB) {
        cli_check(shape_mesh_decode(format, name, bytes, size, &mesh, &error), &error);
        return mesh;
    }
    const char *slash = strrchr(path, '/');
    size_t length = slash == path ? 1 : slash ? (size_t)(slash - path) : 0;
    char *folder = calloc(length + 1, 1);
    if (!folder)
        cli_fail("out of memory");
    memcpy(folder, path, length);
    cli_check(shape_gltf_decode(name, folder, bytes, size, &mesh, &error), &error);
    free(folder);
    return mesh;
}

shape_mesh *mesh_file_read(const char *path, bool note, shape_mesh_format *format)
{
    shape_error error;
    unsigned char *bytes;
    size_t size;
    cli_check(shape_file_read(path, MAX_FILE, &bytes, &size, &error), &error);
    if (note)
        cli_note_input(path, bytes, size);
    const char *name = strcmp(path, "-") ? path : "standard input";
    if (!size)
        cli_fail("%s: the file is empty", name);
    *format = shape_mesh_format_guess(path, bytes, size);
    if (*format == SHAPE_MESH_UNKNOWN)
        cli_fail("%s: not a mesh that is known (give an OBJ, PLY, STL, OFF, glTF or GLB file)", name);
    shape_mesh *mesh = decode(path, name, *format, bytes, size);
    free(bytes);
    return mesh;
}

bool mesh_file_z_up(shape_mesh_format format)
{
    return format == SHAPE_MESH_PLY || format == SHAPE_MESH_STL || format == SHAPE_MESH_OFF;
}
