/* Opaque things read from their files. */
#include "things.h"

#include <stdlib.h>
#include <string.h>

#include "mesh_file.h"
#include "shape/file.h"

enum { MAX_FILE = 0x40000000 };

static shape_status decode(const char *path, const unsigned char *bytes, size_t size, bool *z_up,
                           shape_mesh **mesh, shape_error *error)
{
    shape_mesh_format format = shape_mesh_format_guess(path, bytes, size);
    *z_up = mesh_file_z_up(format);
    if (!size || format == SHAPE_MESH_UNKNOWN)
        return shape_error_set(error, SHAPE_ERROR_FORMAT, "%.400s: not a mesh that is known", path);
    if (format != SHAPE_MESH_GLTF && format != SHAPE_MESH_GLB)
        return shape_mesh_decode(format, path, bytes, size, mesh, error);
    const char *slash = strrchr(path, '/');
    size_t length = slash == path ? 1 : slash ? (size_t)(slash - path) : 0;
    char *folder = calloc(length + 1, 1);
    if (!folder)
        return shape_error_memory(error);
    memcpy(folder, path, length);
    shape_status status = shape_gltf_decode(path, folder, bytes, size, mesh, error);
    free(folder);
    return status;
}

static shape_status add_file(shape_opaque *opaque, const shape_scene_mesh *entry, const char *path,
                             shape_error *error)
{
    unsigned char *bytes;
    size_t size;
    shape_mesh *mesh;
    bool z_up;
    shape_status status = shape_file_read(path, MAX_FILE, &bytes, &size, error);
    if (status)
        return status;
    status = decode(path, bytes, size, &z_up, &mesh, error);
    free(bytes);
    if (status)
        return status;
    float albedo[3];
    shape_frame frame = shape_scene_mesh_frame(entry, z_up);
    for (int c = 0; c < 3; c++)
        albedo[c] = (float)entry->albedo[c];
    status = shape_opaque_add(opaque, mesh, &frame, albedo, error);
    shape_mesh_destroy(mesh);
    return status;
}

static shape_status add_all(shape_opaque *opaque, const shape_scene *scene, const char *scene_path,
                            bool outside, const view_more_things *more, shape_error *error)
{
    shape_status status = SHAPE_OK;
    for (size_t i = 0; scene && i < scene->mesh_count && !status; i++) {
        char *path;
        status = shape_scene_find_file(scene_path, scene->meshes[i].file, outside, &path, error);
        if (status)
            break;
        status = add_file(opaque, &scene->meshes[i], path, error);
        free(path);
    }
    for (size_t i = 0; more->list && i < more->list->mesh_count && !status; i++)
        status = add_file(opaque, &more->list->meshes[i], more->list->meshes[i].file, error);
    if (!status && more->has_ground)
        status = shape_opaque_add_ground(opaque, more->height, more->ground_albedo, error);
    else if (!status && scene && scene->ground_given) {
        float albedo[3];
        for (int c = 0; c < 3; c++)
            albedo[c] = (float)scene->ground_albedo[c];
        status = shape_opaque_add_ground(opaque, scene->ground, albedo, error);
    }
    return status ? status : shape_opaque_finish(opaque, error);
}

shape_status view_things_read(const shape_scene *scene, const char *scene_path, bool outside,
                              const view_more_things *more, shape_opaque **opaque, shape_error *error)
{
    *opaque = NULL;
    bool any = (scene && (scene->mesh_count || scene->ground_given)) ||
               (more->list && more->list->mesh_count) || more->has_ground;
    if (!any)
        return SHAPE_OK;
    shape_opaque *made = shape_opaque_create(error);
    if (!made)
        return SHAPE_ERROR_MEMORY;
    shape_status status = add_all(made, scene, scene_path, outside, more, error);
    if (status)
        shape_opaque_destroy(made);
    else
        *opaque = made;
    return status;
}
