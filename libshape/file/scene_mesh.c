/* What is opaque in scenes, from JSON: meshes with their files, axes, units, places and colours, and the ground. */
#include <string.h>

#include "file/scene_reader.h"

static shape_status mesh_up(scene_reader *r, const json_t *value, void *to)
{
    const char *axis = json_string_value(value);
    if (!axis || (strcmp(axis, "y") && strcmp(axis, "z")))
        return scene_wrong(r, "expected \"y\" or \"z\"");
    *(shape_scene_up *)to = *axis == 'y' ? SHAPE_SCENE_UP_Y : SHAPE_SCENE_UP_Z;
    return SHAPE_OK;
}

static shape_status mesh_unit(scene_reader *r, const json_t *value, void *to)
{
    return scene_read_number(r, value, 1e-9, 1e9, to);
}

static shape_status mesh_albedo(scene_reader *r, const json_t *value, void *to)
{
    return scene_read_one_or_three(r, value, 0, 1, to);
}

static const scene_member mesh_members[] = {
    {"file", scene_read_text, offsetof(shape_scene_mesh, file)},
    {"up", mesh_up, offsetof(shape_scene_mesh, up)},
    {"unit", mesh_unit, offsetof(shape_scene_mesh, unit)},
    {"albedo", mesh_albedo, offsetof(shape_scene_mesh, albedo)},
    {"translate", scene_place_translate, offsetof(shape_scene_mesh, place)},
    {"rotate", scene_place_rotate, offsetof(shape_scene_mesh, place)},
    {"scale", scene_place_scale, offsetof(shape_scene_mesh, place)},
    {"mirror", scene_place_mirror, offsetof(shape_scene_mesh, place)},
    {"note", scene_read_note, offsetof(shape_scene_mesh, note)},
    {0}};

static shape_status read_mesh(scene_reader *r, const json_t *value, void *to)
{
    shape_scene *scene = to;
    shape_scene_mesh *mesh;
    if (scene->mesh_count == SHAPE_SCENE_MESHES_MAX)
        return scene_wrong(r, "more than %d meshes (make the scene smaller)", SHAPE_SCENE_MESHES_MAX);
    shape_status status = shape_scene_add_mesh(scene, &mesh, r->error);
    if (!status)
        status = scene_read_object(r, value, mesh_members, mesh);
    if (!status && !mesh->file)
        return scene_wrong(r, "names no file (write \"file\": \"rock.obj\")");
    return status;
}

shape_status scene_meshes(scene_reader *r, const json_t *value, void *to)
{
    return scene_read_each(r, value, read_mesh, to);
}

static shape_status ground_height(scene_reader *r, const json_t *value, void *to)
{
    return scene_read_number(r, value, -1e6, 1e6, &((shape_scene *)to)->ground);
}

static shape_status ground_albedo(scene_reader *r, const json_t *value, void *to)
{
    return scene_read_one_or_three(r, value, 0, 1, ((shape_scene *)to)->ground_albedo);
}

static const scene_member ground_members[] = {
    {"height", ground_height, 0}, {"albedo", ground_albedo, 0}, {0}};

shape_status scene_ground(scene_reader *r, const json_t *value, void *to)
{
    shape_scene *scene = to;
    scene->ground_given = true;
    for (int i = 0; i < 3; i++)
        scene->ground_albedo[i] = 0.2;
    return scene_read_object(r, value, ground_members, scene);
}
