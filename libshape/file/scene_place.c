/* Where a thing of a scene stands: the members that clouds, their copies and meshes share. */
#include <string.h>

#include "file/scene_reader.h"

shape_status scene_place_translate(scene_reader *r, const json_t *value, void *to)
{
    return scene_read_three(r, value, -1e12, 1e12, ((shape_transform *)to)->translate);
}

shape_status scene_place_rotate(scene_reader *r, const json_t *value, void *to)
{
    return scene_read_three(r, value, -1e6, 1e6, ((shape_transform *)to)->rotate);
}

shape_status scene_place_scale(scene_reader *r, const json_t *value, void *to)
{
    return scene_read_one_or_three(r, value, 1e-6, 1e6, ((shape_transform *)to)->scale);
}

shape_status scene_place_mirror(scene_reader *r, const json_t *value, void *to)
{
    shape_transform *place = to;
    const char *axes = json_string_value(value);
    if (!axes || !*axes || axes[strspn(axes, "xyz")])
        return scene_wrong(r, "expected x, y, z or several of them, as a text");
    for (; *axes; axes++)
        place->mirror[*axes - 'x'] = true;
    return SHAPE_OK;
}

shape_status scene_place_keep_depth(scene_reader *r, const json_t *value, void *to)
{
    if (!json_is_boolean(value))
        return scene_wrong(r, "expected true or false");
    ((shape_transform *)to)->keep_depth = json_is_true(value);
    return SHAPE_OK;
}
