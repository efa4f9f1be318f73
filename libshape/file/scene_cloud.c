/* The clouds of scenes from JSON: their options, places and copies. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "file/scene_private.h"
#include "file/scene_reader.h"

/* --- options --- */

/* A number as the option parser will see it. */
static void number_text(const json_t *value, char text[SCENE_NUMBER_MAX])
{
    if (json_is_integer(value))
        snprintf(text, SCENE_NUMBER_MAX, "%lld", (long long)json_integer_value(value));
    else
        scene_number_text(json_real_value(value), text);
}

static shape_status list_text(scene_reader *r, const json_t *array, char text[3 * SCENE_NUMBER_MAX])
{
    size_t count = json_array_size(array), used = 0;
    if (count < 2 || count > 3)
        return scene_wrong(r, "expected two or three numbers");
    for (size_t i = 0; i < count; i++) {
        if (!json_is_number(json_array_get(array, i)))
            return scene_wrong(r, "expected two or three numbers");
        if (i)
            text[used++] = ',';
        number_text(json_array_get(array, i), text + used);
        used += strlen(text + used);
    }
    return SHAPE_OK;
}

static shape_status read_option(scene_reader *r, const char *name, const json_t *value,
                                shape_scene_options *options)
{
    char text[3 * SCENE_NUMBER_MAX];
    const char *shown = text;
    char *own = NULL;
    shape_status status = SHAPE_OK;
    if (!*name || name[strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789-")])
        return scene_wrong(r, "is no option's name (write it as on the command line, without its dashes)");
    if (json_is_number(value))
        number_text(value, text);
    else if (json_is_array(value))
        status = list_text(r, value, text);
    else if (json_is_true(value))
        shown = NULL;
    else if (json_is_false(value))
        status = scene_wrong(r, "is false (leave a flag out that is not wanted)");
    else if (json_is_string(value))
        status = scene_read_text(r, value, &own);
    else
        status = scene_wrong(r, "expected a number, two or three of them, a text, or true for a flag");
    if (!status)
        status = shape_scene_add_option(options, name, own ? own : shown, r->error);
    free(own);
    return status;
}

shape_status scene_read_options(scene_reader *r, const json_t *object, void *to)
{
    const char *key;
    json_t *value;
    if (!json_is_object(object))
        return scene_wrong(r, "expected an object, {...}");
    json_object_foreach((json_t *)object, key, value)
    {
        size_t used = scene_enter(r, key, 0);
        bool note = !strcmp(key, "note");
        shape_status status = note && !json_is_string(value) ? scene_wrong(r, "expected a text")
                              : note                         ? SHAPE_OK
                                                             : read_option(r, key, value, to);
        if (status)
            return status;
        scene_leave(r, used);
    }
    return SHAPE_OK;
}

/* --- places --- */

static const scene_member place_members[] = {
    {"translate", scene_place_translate, 0},   {"rotate", scene_place_rotate, 0},
    {"scale", scene_place_scale, 0},           {"mirror", scene_place_mirror, 0},
    {"keep-depth", scene_place_keep_depth, 0}, {0}};

/* --- clouds --- */

static shape_status cloud_name(scene_reader *r, const json_t *value, void *to)
{
    if (json_is_string(value) && json_string_length(value) > SHAPE_NAME_MAX)
        return scene_wrong(r, "is longer than %d bytes", SHAPE_NAME_MAX);
    return scene_read_text(r, value, to);
}

static shape_status cloud_copies(scene_reader *r, const json_t *value, void *to)
{
    if (!json_is_array(value) || !json_array_size(value))
        return scene_wrong(r, "expected an array of at least one place, [{...}]");
    for (size_t i = 0; i < json_array_size(value); i++) {
        shape_transform place = shape_transform_defaults();
        size_t used = scene_enter(r, NULL, i);
        shape_status status = scene_read_object(r, json_array_get(value, i), place_members, &place);
        if (!status && ++r->places > SHAPE_SCENE_CLOUDS_MAX)
            status = scene_wrong(r, "more than %d clouds (make the scene smaller)", SHAPE_SCENE_CLOUDS_MAX);
        if (!status)
            status = shape_scene_add_copy(to, &place, r->error);
        if (status)
            return status;
        scene_leave(r, used);
    }
    return SHAPE_OK;
}

static const scene_member cloud_members[] = {
    {"name", cloud_name, offsetof(shape_scene_cloud, name)},
    {"file", scene_read_text, offsetof(shape_scene_cloud, file)},
    {"generator", scene_read_text, offsetof(shape_scene_cloud, generator)},
    {"input", scene_read_text, offsetof(shape_scene_cloud, input)},
    {"options", scene_read_options, offsetof(shape_scene_cloud, options)},
    {"medium", scene_read_options, offsetof(shape_scene_cloud, medium)},
    {"translate", scene_place_translate, offsetof(shape_scene_cloud, place)},
    {"rotate", scene_place_rotate, offsetof(shape_scene_cloud, place)},
    {"scale", scene_place_scale, offsetof(shape_scene_cloud, place)},
    {"mirror", scene_place_mirror, offsetof(shape_scene_cloud, place)},
    {"keep-depth", scene_place_keep_depth, offsetof(shape_scene_cloud, place)},
    {"copies", cloud_copies, 0},
    {"note", scene_read_note, offsetof(shape_scene_cloud, note)},
    {0}};

static shape_status read_cloud(scene_reader *r, const json_t *value, void *to)
{
    shape_scene *scene = to;
    shape_scene_cloud *cloud;
    shape_status status = shape_scene_add_cloud(scene, &cloud, r->error);
    if (!status)
        status = scene_read_object(r, value, cloud_members, cloud);
    if (status)
        return status;
    if (!cloud->file == !cloud->generator)
        return scene_wrong(r, "names %s (give one of file and generator)",
                           cloud->file ? "both a file and a generator" : "neither a file nor a generator");
    if (cloud->file && (cloud->input || cloud->options.count))
        return scene_wrong(r, "input and options belong to a generator, not to a file");
    if (!cloud->copy_count && ++r->places > SHAPE_SCENE_CLOUDS_MAX)
        return scene_wrong(r, "more than %d clouds (make the scene smaller)", SHAPE_SCENE_CLOUDS_MAX);
    return SHAPE_OK;
}

shape_status scene_clouds(scene_reader *r, const json_t *value, void *to)
{
    return scene_read_each(r, value, read_cloud, to);
}
