/* Scenes from JSON (docs/scene.md): untrusted text, checked key by key. The limits, the parser, and the members of the
 * whole; what these hold is read by scene_cloud.c, scene_edit.c, scene_mesh.c and scene_light.c. */
#include "file/scene_private.h"
#include "file/scene_reader.h"

static shape_status scene_version(scene_reader *r, const json_t *value, void *to)
{
    (void)to;
    if (!json_is_integer(value) || json_integer_value(value) != SHAPE_SCENE_VERSION)
        return scene_wrong(r, "expected %d, the version of the format that is known", SHAPE_SCENE_VERSION);
    return SHAPE_OK;
}

static const scene_member scene_members[] = {{"scene", scene_version, 0},
                                             {"clouds", scene_clouds, 0},
                                             {"meshes", scene_meshes, 0},
                                             {"ground", scene_ground, 0},
                                             {"medium", scene_read_options, offsetof(shape_scene, medium)},
                                             {"edits", scene_edits, 0},
                                             {"view", scene_read_options, offsetof(shape_scene, view)},
                                             {"compare", scene_read_text, offsetof(shape_scene, compare)},
                                             {"sun", scene_sun, 0},
                                             {"lamp", scene_lamp, 0},
                                             {"sky", scene_sky, 0},
                                             {"air", scene_air, 0},
                                             {"camera", scene_camera, 0},
                                             {"exposure", scene_exposure, 0},
                                             {"note", scene_read_note, offsetof(shape_scene, note)},
                                             {0}};

static shape_status read_scene(scene_reader *r, const json_t *root, shape_scene *scene)
{
    if (!json_object_get(root, "scene"))
        return scene_wrong(r, "not a scene (one begins by {\"scene\": 1, ...})");
    if (!json_object_get(root, "clouds"))
        return scene_wrong(r, "has no clouds (write \"clouds\": [...])");
    return scene_read_object(r, root, scene_members, scene);
}

/* Depth and number of values are told from the brackets and commas outside of texts, before the JSON reader takes
 * memory for any. */
static shape_status check_limits(scene_reader *r, const char *text, size_t size)
{
    size_t depth = 0, values = 1;
    bool quoted = false;
    if (size > SHAPE_SCENE_SIZE_MAX)
        return shape_error_set(r->error, SHAPE_ERROR_LIMIT, "%s: larger than the limit of %d bytes", r->name,
                               SHAPE_SCENE_SIZE_MAX);
    for (size_t i = 0; i < size; i++) {
        char c = text[i];
        if (quoted && c == '\\')
            i++;
        else if (c == '"')
            quoted = !quoted;
        else if (quoted)
            continue;
        else if (c == '{' || c == '[')
            depth++, values++;
        else if ((c == '}' || c == ']') && depth)
            depth--;
        else if (c == ',')
            values++;
        if (depth > SHAPE_SCENE_DEPTH_MAX)
            return shape_error_set(r->error, SHAPE_ERROR_LIMIT,
                                   "%s: more than %d objects and arrays in one another", r->name,
                                   SHAPE_SCENE_DEPTH_MAX);
    }
    if (values > SHAPE_SCENE_VALUES_MAX)
        return shape_error_set(r->error, SHAPE_ERROR_LIMIT, "%s: more than %d values (make it smaller)",
                               r->name, SHAPE_SCENE_VALUES_MAX);
    return SHAPE_OK;
}

static shape_status parse(scene_reader *r, const void *bytes, size_t size, json_t **root)
{
    json_error_t at = {0}; /* without memory jansson sets no code */
    *root = json_loadb(bytes, size, JSON_REJECT_DUPLICATES, &at);
    if (*root)
        return SHAPE_OK;
    if (json_error_code(&at) == json_error_out_of_memory || !at.text[0]) /* jansson says no more of that */
        return shape_error_memory(r->error);
    shape_error_set(r->error, SHAPE_ERROR_FORMAT, "%s:%d:%d: no good JSON: %s", r->name,
                    at.line > 0 ? at.line : 1, at.column > 0 ? at.column : 1, at.text);
    for (char *c = r->error->text; *c; c++)
        if ((unsigned char)*c < 0x20 || (unsigned char)*c == 0x7f)
            *c = '?'; /* JSON's own message quotes the bytes */
    return SHAPE_ERROR_FORMAT;
}

shape_status shape_scene_decode(const void *bytes, size_t size, const char *name, shape_scene **scene,
                                shape_error *error)
{
    shape_error unwanted = {SHAPE_OK, ""};
    scene_reader r = {.name = name, .error = error ? error : &unwanted};
    if (shape_scene_is_picture(bytes, size) && !scene_find_in_picture(&bytes, &size))
        return scene_wrong(&r,
                           "a picture that holds no scene (those that neph-view's window writes hold one)");
    shape_status status = check_limits(&r, bytes, size);
    if (status)
        return status;
    json_t *root;
    status = parse(&r, bytes, size, &root);
    if (status)
        return status;
    shape_scene *made = shape_scene_create(error);
    status = made ? read_scene(&r, root, made) : SHAPE_ERROR_MEMORY;
    json_decref(root);
    if (status)
        shape_scene_destroy(made);
    else
        *scene = made;
    return status;
}
