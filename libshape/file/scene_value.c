/* Values in scenes from JSON: objects by their tables of members, numbers in their ranges, texts; and where a wrong one
 * stands. */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "file/scene_reader.h"

shape_status scene_wrong(scene_reader *r, const char *format, ...)
{
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return shape_error_set(r->error, SHAPE_ERROR_FORMAT, "%s: %s%s%s", r->name, r->path, *r->path ? ": " : "",
                           text);
}

size_t scene_enter(scene_reader *r, const char *key, size_t index)
{
    size_t used = strlen(r->path), room = sizeof r->path - used;
    if (key)
        snprintf(r->path + used, room, "%s%.60s", used ? "." : "", key);
    else
        snprintf(r->path + used, room, "[%zu]", index);
    return used;
}

void scene_leave(scene_reader *r, size_t used)
{
    r->path[used] = 0;
}

static shape_status unknown_key(scene_reader *r, const char *key, const scene_member *members)
{
    char all[160] = "";
    for (const scene_member *m = members; m->key && strcmp(m->key, "note"); m++) {
        size_t used = strlen(all);
        snprintf(all + used, sizeof all - used, "%s%s", used ? ", " : "", m->key);
    }
    return scene_wrong(r, "there is no key \"%.40s\" here (the keys are %s, note)", key, all);
}

shape_status scene_read_object(scene_reader *r, const json_t *object, const scene_member *members, void *to)
{
    const char *key;
    json_t *value;
    shape_status status = SHAPE_OK;
    if (!json_is_object(object))
        return scene_wrong(r, "expected an object, {...}");
    json_object_foreach((json_t *)object, key, value)
    {
        const scene_member *m = members;
        while (m->key && strcmp(m->key, key))
            m++;
        bool note = !m->key && !strcmp(key, "note");
        if (!m->key && !note)
            return unknown_key(r, key, members);
        size_t used = scene_enter(r, key, 0);
        if (!note)
            status = m->read(r, value, (char *)to + m->offset);
        else if (!json_is_string(value))
            status = scene_wrong(r, "expected a text");
        if (status)
            return status;
        scene_leave(r, used);
    }
    return SHAPE_OK;
}

shape_status scene_read_each(scene_reader *r, const json_t *array, scene_read read, void *to)
{
    if (!json_is_array(array))
        return scene_wrong(r, "expected an array, [{...}]");
    for (size_t i = 0; i < json_array_size(array); i++) {
        size_t used = scene_enter(r, NULL, i);
        shape_status status = read(r, json_array_get(array, i), to);
        if (status)
            return status;
        scene_leave(r, used);
    }
    return SHAPE_OK;
}

shape_status scene_read_number(scene_reader *r, const json_t *value, double min, double max, double *number)
{
    if (!json_is_number(value))
        return scene_wrong(r, "expected a number");
    double n = json_number_value(value);
    if (!(n >= min && n <= max))
        return scene_wrong(r, "%.9g is out of range (it must be from %.9g to %.9g)", n, min, max);
    *number = n;
    return SHAPE_OK;
}

shape_status scene_read_three(scene_reader *r, const json_t *value, double min, double max, double numbers[3])
{
    if (!json_is_array(value) || json_array_size(value) != 3)
        return scene_wrong(r, "expected three numbers, [a, b, c]");
    for (size_t i = 0; i < 3; i++) {
        size_t used = scene_enter(r, NULL, i);
        shape_status status = scene_read_number(r, json_array_get(value, i), min, max, &numbers[i]);
        if (status)
            return status;
        scene_leave(r, used);
    }
    return SHAPE_OK;
}

shape_status scene_read_one_or_three(scene_reader *r, const json_t *value, double min, double max,
                                     double numbers[3])
{
    if (!json_is_number(value))
        return json_is_array(value) ? scene_read_three(r, value, min, max, numbers)
                                    : scene_wrong(r, "expected a number, or three, [a, b, c]");
    shape_status status = scene_read_number(r, value, min, max, &numbers[0]);
    numbers[1] = numbers[2] = numbers[0];
    return status;
}

/* JSON cares for UTF-8, so only control characters are left to refuse. */
shape_status scene_read_text(scene_reader *r, const json_t *value, void *to)
{
    if (!json_is_string(value))
        return scene_wrong(r, "expected a text");
    const unsigned char *c = (const unsigned char *)json_string_value(value);
    size_t length = strlen((const char *)c);
    if (!length)
        return scene_wrong(r, "is empty (write something, or leave the key out)");
    if (length > SHAPE_SCENE_TEXT_MAX)
        return scene_wrong(r, "is longer than %d bytes", SHAPE_SCENE_TEXT_MAX);
    for (size_t i = 0; i < length; i++)
        if (c[i] < 0x20 || c[i] == 0x7f || (c[i] == 0xc2 && c[i + 1] < 0xa0))
            return scene_wrong(r, "has a control character in it");
    return shape_scene_set_text(to, (const char *)c, r->error);
}

shape_status scene_read_note(scene_reader *r, const json_t *value, void *to)
{
    if (!json_is_string(value))
        return scene_wrong(r, "expected a text");
    return shape_scene_set_text(to, json_string_value(value), r->error);
}
