/* Opaque meshes from files: OBJ, PLY, STL, OFF, glTF, GLB, as they are placed there, in metres. PLY, STL and OFF are taken
 * as z up, as by neph-mesh. */
#include "render_opaque.h"

#include <stdlib.h>
#include <string.h>

#include "render_resume.h"
#include "shape/file.h"

enum { MAX_MESH_FILE = 0x7fffffff };

static cli_texts meshes, colours;

const cli_option render_opaque_options[] = {
    {"mesh", 0, CLI_TEXTS, &meshes, 0, 0, "FILE",
     "an opaque thing: OBJ, PLY, STL, OFF, glTF or GLB, in metres; may be given again [none]", NULL, false},
    {"mesh-colour", 0, CLI_TEXTS, &colours, 0, 0, "R,G,B",
     "share of light that the first, second ... mesh gives back, 0 to 1 [0.5,0.5,0.5]", NULL, false},
    {0}};

bool render_opaque_given(void)
{
    return meshes.count > 0;
}

static shape_mesh *decode(const char *path, shape_mesh_format format, const unsigned char *bytes, size_t size)
{
    shape_error error;
    shape_mesh *mesh;
    if (format != SHAPE_MESH_GLTF && format != SHAPE_MESH_GLB) {
        cli_check(shape_mesh_decode(format, path, bytes, size, &mesh, &error), &error);
        return mesh;
    }
    const char *slash = strrchr(path, '/');
    size_t length = slash == path ? 1 : slash ? (size_t)(slash - path) : 0;
    char *folder = calloc(length + 1, 1);
    if (!folder)
        cli_fail("out of memory");
    memcpy(folder, path, length);
    cli_check(shape_gltf_decode(path, folder, bytes, size, &mesh, &error), &error);
    free(folder);
    return mesh;
}

static shape_mesh *read_mesh(const char *path, bool *z_up)
{
    shape_error error;
    unsigned char *bytes;
    size_t size;
    cli_check(shape_file_read(path, MAX_MESH_FILE, &bytes, &size, &error), &error);
    shape_mesh_format format = shape_mesh_format_guess(path, bytes, size);
    if (format == SHAPE_MESH_UNKNOWN)
        cli_fail("%s: not a mesh that is known (give an OBJ, PLY, STL, OFF, glTF or GLB file)", path);
    *z_up = format == SHAPE_MESH_PLY || format == SHAPE_MESH_STL || format == SHAPE_MESH_OFF;
    shape_mesh *mesh = decode(path, format, bytes, size);
    free(bytes);
    return mesh;
}

static void read_colour(int i, float albedo[3])
{
    double rgb[3] = {0.5, 0.5, 0.5};
    if (i < colours.count && !cli_numbers(colours.text[i], 3, rgb))
        cli_wrong("--mesh-colour \"%s\": expected three numbers R,G,B", colours.text[i]);
    for (int c = 0; c < 3; c++) {
        if (!(rgb[c] >= 0 && rgb[c] <= 1))
            cli_wrong("--mesh-colour %s: must be from 0 to 1", colours.text[i]);
        albedo[c] = (float)rgb[c];
    }
}

shape_opaque *render_opaque_read(void)
{
    shape_error error;
    if (colours.count > meshes.count)
        cli_wrong("--mesh-colour: there are more colours than meshes");
    if (!meshes.count)
        return NULL;
    shape_opaque *opaque = shape_opaque_create(&error);
    if (!opaque)
        cli_fail("%s", error.text);
    for (int i = 0; i < meshes.count; i++) {
        float albedo[3];
        bool z_up;
        static const shape_frame turned = {{{1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}}};
        read_colour(i, albedo);
        shape_mesh *mesh = read_mesh(meshes.text[i], &z_up);
        render_resume_note_mesh(mesh, z_up, albedo);
        if (shape_opaque_add(opaque, mesh, z_up ? &turned : NULL, albedo, &error))
            cli_fail("%s: %s", meshes.text[i], error.text);
        shape_mesh_destroy(mesh);
    }
    cli_check(shape_opaque_finish(opaque, &error), &error);
    return opaque;
}
