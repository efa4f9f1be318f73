/* The edits of scenes from JSON: what is changed of single clouds after all have been made. */
#include <string.h>

#include "file/scene_reader.h"

static shape_status edit_scale(scene_reader *r, const json_t *value, void *to)
{
    return scene_read_number(r, value, 1e-6, 1e6, to);
}

static shape_status edit_translate(scene_reader *r, const json_t *value, void *to)
{
    return scene_read_three(r, value, -1e12, 1e12, to);
}

static shape_status edit_rotate(scene_reader *r, const json_t *value, void *to)
{
    return scene_read_three(r, value, -1e6, 1e6, to);
}

static shape_status edit_hidden(scene_reader *r, const json_t *value, void *to)
{
    if (!json_is_boolean(value))
        return scene_wrong(r, "expected true or false");
    *(bool *)to = json_is_true(value);
    return SHAPE_OK;
}

static const scene_member edit_members[] = {
    {"cloud", scene_read_text, offsetof(shape_scene_edit, cloud)},
    {"medium", scene_read_options, offsetof(shape_scene_edit, medium)},
    {"translate", edit_translate, offsetof(shape_scene_edit, translate)},
    {"rotate", edit_rotate, offsetof(shape_scene_edit, rotate)},
    {"scale", edit_scale, offsetof(shape_scene_edit, scale)},
    {"hidden", edit_hidden, offsetof(shape_scene_edit, hidden)},
    {"note", scene_read_note, offsetof(shape_scene_edit, note)},
    {0}};

static shape_status read_edit(scene_reader *r, const json_t *value, void *to)
{
    shape_scene *scene = to;
    shape_scene_edit *edit;
    if (scene->edit_count == SHAPE_SCENE_EDITS_MAX)
        return scene_wrong(r, "more than %d edits (change the files themselves)", SHAPE_SCENE_EDITS_MAX);
    shape_status status = shape_scene_add_edit(scene, NULL, &edit, r->error);
    if (!status)
        status = scene_read_object(r, value, edit_members, edit);
    if (status)
        return status;
    if (!edit->cloud)
        return scene_wrong(r, "names no cloud (write \"cloud\": \"its name\")");
    for (size_t i = 0; i + 1 < scene->edit_count; i++)
        if (!strcmp(scene->edits[i].cloud, edit->cloud))
            return scene_wrong(r, "the cloud \"%.60s\" is edited already (make one edit of both)",
                               edit->cloud);
    return SHAPE_OK;
}

shape_status scene_edits(scene_reader *r, const json_t *value, void *to)
{
    return scene_read_each(r, value, read_edit, to);
}
