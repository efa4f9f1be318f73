/* The meshes of a scene: read, placed, coloured, and held against the limit of a scene. */
#include "opaque_scene.h"

#include <stdlib.h>
#include <string.h>

#include "cli_private.h"
#include "cli_scene.h"
#include "mesh_file.h"

static void add(shape_opaque *opaque, const shape_scene_mesh *mesh, const shape_mesh *read,
                shape_mesh_format format, const char *path)
{
    shape_error error;
    float albedo[3];
    shape_frame frame = shape_scene_mesh_frame(mesh, mesh_file_z_up(format));
    for (int c = 0; c < 3; c++)
        albedo[c] = (float)mesh->albedo[c];
    if (shape_opaque_add(opaque, read, &frame, albedo, &error))
        cli_fail("%s: %s", path, error.text);
}

void opaque_scene_add_file(shape_opaque *opaque, const shape_scene_mesh *mesh, const char *path)
{
    shape_mesh_format format;
    shape_mesh *read = mesh_file_read(path, false, &format);
    add(opaque, mesh, read, format, path);
    shape_mesh_destroy(read);
}

void opaque_scene_add(shape_opaque *opaque, const shape_scene *scene, const char *path)
{
    const char *shown = strcmp(path, "-") ? path : "standard input";
    size_t before = shape_opaque_triangle_count(opaque);
    for (size_t i = 0; i < scene->mesh_count; i++) {
        shape_mesh_format format;
        cli_set_place("%.400s: meshes[%zu]: ", shown, i);
        char *file = cli_scene_file(path, scene->meshes[i].file);
        shape_mesh *read = mesh_file_read(file, false, &format);
        if (read->triangle_count >
            SHAPE_SCENE_TRIANGLES_MAX - (shape_opaque_triangle_count(opaque) - before))
            cli_fail("more than %d triangles in the scene's meshes (decimate them)",
                     SHAPE_SCENE_TRIANGLES_MAX);
        add(opaque, &scene->meshes[i], read, format, file);
        shape_mesh_destroy(read);
        free(file);
    }
    cli_set_place("%s", "");
}
