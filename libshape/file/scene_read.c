/* Scenes from JSON (docs/scene.md): untrusted text, checked key by key. */
#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "file/scene_private.h"
#include "shape/scene.h"

#define PI 3.14159265358979323846

/* Where the reader is, for errors. */
typedef struct reader {
    const char *name;
    char path[192]; /* "clouds[2].copies[0].scale" */
    size_t places;
    shape_error *error;
} reader;

static shape_status wrong(reader *r, const char *format, ...) SHAPE_PRINTF(2, 3);

static shape_status wrong(reader *r, const char *format, ...)
{
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return shape_error_set(r->error, SHAPE_ERROR_FORMAT, "%s: %s%s%s", r->name, r->path, *r->path ? ": " : "",
                           text);
}

/* Adds ".key" or "[index]" to the path; the old length is what leave() takes. */
static size_t enter(reader *r, const char *key, size_t index)
{
    size_t used = strlen(r->path), room = sizeof r->path - used;
    if (key)
        snprintf(r->path + used, room, "%s%.60s", used ? "." : "", key);
    else
        snprintf(r->path + used, room, "[%zu]", index);
    return used;
}

static void leave(reader *r, size_t used)
{
    r->path[used] = 0;
}

/* A member of an object: its key, and what reads its value into *to. */
typedef struct member {
    const char *key;
    shape_status (*read)(reader *r, const json_t *value, void *to);
} member;

static shape_status unknown_key(reader *r, const char *key, const member *members)
{
    char all[160] = "";
    for (const member *m = members; m->key && strcmp(m->key, "note"); m++) {
        size_t used = strlen(all);
        snprintf(all + used, sizeof all - used, "%s%s", used ? ", " : "", m->key);
    }
    return wrong(r, "there is no key \"%.40s\" here (the keys are %s, note)", key, all);
}

/* Reads each member by its row; "note" may stand in every object. */
static shape_status read_object(reader *r, const json_t *object, const member *members, void *to)
{
    const char *key;
    json_t *value;
    shape_status status = SHAPE_OK;
    if (!json_is_object(object))
        return wrong(r, "expected an object, {...}");
    json_object_foreach((json_t *)object, key, value)
    {
        const member *m = members;
        while (m->key && strcmp(m->key, key))
            m++;
        bool note = !m->key && !strcmp(key, "note");
        if (!m->key && !note)
            return unknown_key(r, key, members);
        size_t used = enter(r, key, 0);
        if (!note)
            status = m->read(r, value, to);
        else if (!json_is_string(value))
            status = wrong(r, "expected a text");
        if (status)
            return status;
        leave(r, used);
    }
    return SHAPE_OK;
}

/* --- values --- */

static shape_status read_number(reader *r, const json_t *value, double min, double max, double *number)
{
    if (!json_is_number(value))
        return wrong(r, "expected a number");
    double n = json_number_value(value);
    if (!(n >= min && n <= max))
        return wrong(r, "%.9g is out of range (it must be from %.9g to %.9g)", n, min, max);
    *number = n;
    return SHAPE_OK;
}

static shape_status read_three(reader *r, const json_t *value, double min, double max, double numbers[3])
{
    if (!json_is_array(value) || json_array_size(value) != 3)
        return wrong(r, "expected three numbers, [a, b, c]");
    for (size_t i = 0; i < 3; i++) {
        size_t used = enter(r, NULL, i);
        shape_status status = read_number(r, json_array_get(value, i), min, max, &numbers[i]);
        if (status)
            return status;
        leave(r, used);
    }
    return SHAPE_OK;
}

/* Three numbers, or one for all. */
static shape_status read_one_or_three(reader *r, const json_t *value, double min, double max,
                                      double numbers[3])
{
    if (!json_is_number(value))
        return json_is_array(value) ? read_three(r, value, min, max, numbers)
                                    : wrong(r, "expected a number, or three, [a, b, c]");
    shape_status status = read_number(r, value, min, max, &numbers[0]);
    numbers[1] = numbers[2] = numbers[0];
    return status;
}

/* A text that may stand in a line: JSON cares for UTF-8, so only control characters are left to refuse. */
static shape_status read_text(reader *r, const json_t *value, char **text)
{
    if (!json_is_string(value))
        return wrong(r, "expected a text");
    const unsigned char *c = (const unsigned char *)json_string_value(value);
    size_t length = strlen((const char *)c);
    if (!length)
        return wrong(r, "is empty (write something, or leave the key out)");
    if (length > SHAPE_SCENE_TEXT_MAX)
        return wrong(r, "is longer than %d bytes", SHAPE_SCENE_TEXT_MAX);
    for (size_t i = 0; i < length; i++)
        if (c[i] < 0x20 || c[i] == 0x7f || (c[i] == 0xc2 && c[i + 1] < 0xa0))
            return wrong(r, "has a control character in it");
    return shape_scene_set_text(text, (const char *)c, r->error);
}

static shape_status read_note(reader *r, const json_t *value, char **note)
{
    if (!json_is_string(value))
        return wrong(r, "expected a text");
    return shape_scene_set_text(note, json_string_value(value), r->error);
}

/* --- options --- */

/* A number as the option parser will see it. */
static void number_text(const json_t *value, char text[SCENE_NUMBER_MAX])
{
    if (json_is_integer(value))
        snprintf(text, SCENE_NUMBER_MAX, "%lld", (long long)json_integer_value(value));
    else
        scene_number_text(json_real_value(value), text);
}

static shape_status list_text(reader *r, const json_t *array, char text[3 * SCENE_NUMBER_MAX])
{
    size_t count = json_array_size(array), used = 0;
    if (count < 2 || count > 3)
        return wrong(r, "expected two or three numbers");
    for (size_t i = 0; i < count; i++) {
        if (!json_is_number(json_array_get(array, i)))
            return wrong(r, "expected two or three numbers");
        if (i)
            text[used++] = ',';
        number_text(json_array_get(array, i), text + used);
        used += strlen(text + used);
    }
    return SHAPE_OK;
}

static shape_status read_option(reader *r, const char *name, const json_t *value,
                                shape_scene_options *options)
{
    char text[3 * SCENE_NUMBER_MAX];
    const char *shown = text;
    char *own = NULL;
    shape_status status = SHAPE_OK;
    if (!*name || name[strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789-")])
        return wrong(r, "is no option's name (write it as on the command line, without its dashes)");
    if (json_is_number(value))
        number_text(value, text);
    else if (json_is_array(value))
        status = list_text(r, value, text);
    else if (json_is_true(value))
        shown = NULL;
    else if (json_is_false(value))
        status = wrong(r, "is false (leave a flag out that is not wanted)");
    else if (json_is_string(value))
        status = read_text(r, value, &own);
    else
        status = wrong(r, "expected a number, two or three of them, a text, or true for a flag");
    if (!status)
        status = shape_scene_add_option(options, name, own ? own : shown, r->error);
    free(own);
    return status;
}

static shape_status read_options(reader *r, const json_t *object, shape_scene_options *options)
{
    const char *key;
    json_t *value;
    if (!json_is_object(object))
        return wrong(r, "expected an object, {...}");
    json_object_foreach((json_t *)object, key, value)
    {
        size_t used = enter(r, key, 0);
        bool note = !strcmp(key, "note");
        shape_status status = note && !json_is_string(value) ? wrong(r, "expected a text")
                              : note                         ? SHAPE_OK
                                                             : read_option(r, key, value, options);
        if (status)
            return status;
        leave(r, used);
    }
    return SHAPE_OK;
}

/* --- places --- */

static shape_status place_translate(reader *r, const json_t *value, void *to)
{
    return read_three(r, value, -1e12, 1e12, ((shape_transform *)to)->translate);
}

static shape_status place_rotate(reader *r, const json_t *value, void *to)
{
    return read_three(r, value, -1e6, 1e6, ((shape_transform *)to)->rotate);
}

static shape_status place_scale(reader *r, const json_t *value, void *to)
{
    return read_one_or_three(r, value, 1e-6, 1e6, ((shape_transform *)to)->scale);
}

static shape_status place_mirror(reader *r, const json_t *value, void *to)
{
    shape_transform *place = to;
    const char *axes = json_string_value(value);
    if (!axes || !*axes || axes[strspn(axes, "xyz")])
        return wrong(r, "expected x, y, z or several of them, as a text");
    for (; *axes; axes++)
        place->mirror[*axes - 'x'] = true;
    return SHAPE_OK;
}

static shape_status place_keep_depth(reader *r, const json_t *value, void *to)
{
    if (!json_is_boolean(value))
        return wrong(r, "expected true or false");
    ((shape_transform *)to)->keep_depth = json_is_true(value);
    return SHAPE_OK;
}

static const member place_members[] = {{"translate", place_translate},   {"rotate", place_rotate},
                                       {"scale", place_scale},           {"mirror", place_mirror},
                                       {"keep-depth", place_keep_depth}, {0}};

/* --- clouds --- */

#define PLACE_OF_CLOUD(name)                                                                                 \
    static shape_status cloud_##name(reader *r, const json_t *value, void *to)                               \
    {                                                                                                        \
        return place_##name(r, value, &((shape_scene_cloud *)to)->place);                                    \
    }
PLACE_OF_CLOUD(translate)
PLACE_OF_CLOUD(rotate)
PLACE_OF_CLOUD(scale)
PLACE_OF_CLOUD(mirror)
PLACE_OF_CLOUD(keep_depth)

static shape_status cloud_name(reader *r, const json_t *value, void *to)
{
    if (json_is_string(value) && json_string_length(value) > SHAPE_NAME_MAX)
        return wrong(r, "is longer than %d bytes", SHAPE_NAME_MAX);
    return read_text(r, value, &((shape_scene_cloud *)to)->name);
}

static shape_status cloud_note(reader *r, const json_t *value, void *to)
{
    return read_note(r, value, &((shape_scene_cloud *)to)->note);
}

static shape_status cloud_file(reader *r, const json_t *value, void *to)
{
    return read_text(r, value, &((shape_scene_cloud *)to)->file);
}

static shape_status cloud_generator(reader *r, const json_t *value, void *to)
{
    return read_text(r, value, &((shape_scene_cloud *)to)->generator);
}

static shape_status cloud_input(reader *r, const json_t *value, void *to)
{
    return read_text(r, value, &((shape_scene_cloud *)to)->input);
}

static shape_status cloud_options(reader *r, const json_t *value, void *to)
{
    return read_options(r, value, &((shape_scene_cloud *)to)->options);
}

static shape_status cloud_medium(reader *r, const json_t *value, void *to)
{
    return read_options(r, value, &((shape_scene_cloud *)to)->medium);
}

static shape_status cloud_copies(reader *r, const json_t *value, void *to)
{
    if (!json_is_array(value) || !json_array_size(value))
        return wrong(r, "expected an array of at least one place, [{...}]");
    for (size_t i = 0; i < json_array_size(value); i++) {
        shape_transform place = shape_transform_defaults();
        size_t used = enter(r, NULL, i);
        shape_status status = read_object(r, json_array_get(value, i), place_members, &place);
        if (!status && ++r->places > SHAPE_SCENE_CLOUDS_MAX)
            status = wrong(r, "more than %d clouds (make the scene smaller)", SHAPE_SCENE_CLOUDS_MAX);
        if (!status)
            status = shape_scene_add_copy(to, &place, r->error);
        if (status)
            return status;
        leave(r, used);
    }
    return SHAPE_OK;
}

static const member cloud_members[] = {{"name", cloud_name},
                                       {"file", cloud_file},
                                       {"generator", cloud_generator},
                                       {"input", cloud_input},
                                       {"options", cloud_options},
                                       {"medium", cloud_medium},
                                       {"translate", cloud_translate},
                                       {"rotate", cloud_rotate},
                                       {"scale", cloud_scale},
                                       {"mirror", cloud_mirror},
                                       {"keep-depth", cloud_keep_depth},
                                       {"copies", cloud_copies},
                                       {"note", cloud_note},
                                       {0}};

static shape_status read_cloud(reader *r, const json_t *value, shape_scene *scene)
{
    shape_scene_cloud *cloud;
    shape_status status = shape_scene_add_cloud(scene, &cloud, r->error);
    if (!status)
        status = read_object(r, value, cloud_members, cloud);
    if (status)
        return status;
    if (!cloud->file == !cloud->generator)
        return wrong(r, "names %s (give one of file and generator)",
                     cloud->file ? "both a file and a generator" : "neither a file nor a generator");
    if (cloud->file && (cloud->input || cloud->options.count))
        return wrong(r, "input and options belong to a generator, not to a file");
    if (!cloud->copy_count && ++r->places > SHAPE_SCENE_CLOUDS_MAX)
        return wrong(r, "more than %d clouds (make the scene smaller)", SHAPE_SCENE_CLOUDS_MAX);
    return SHAPE_OK;
}

static shape_status scene_clouds(reader *r, const json_t *value, void *to)
{
    if (!json_is_array(value))
        return wrong(r, "expected an array, [{...}]");
    for (size_t i = 0; i < json_array_size(value); i++) {
        size_t used = enter(r, NULL, i);
        shape_status status = read_cloud(r, json_array_get(value, i), to);
        if (status)
            return status;
        leave(r, used);
    }
    return SHAPE_OK;
}

/* --- light --- */

/* The sun's members, before they are put together: a direction and two angles exclude each other. */
typedef struct sun_parts {
    shape_scene *scene;
    double direction[3];
    bool direction_given, azimuth_given, height_given;
} sun_parts;

static shape_status sun_azimuth(reader *r, const json_t *value, void *to)
{
    ((sun_parts *)to)->azimuth_given = true;
    return read_number(r, value, -360, 360, &((sun_parts *)to)->scene->sun[0]);
}

static shape_status sun_height(reader *r, const json_t *value, void *to)
{
    ((sun_parts *)to)->height_given = true;
    return read_number(r, value, -90, 90, &((sun_parts *)to)->scene->sun[1]);
}

static shape_status sun_direction(reader *r, const json_t *value, void *to)
{
    ((sun_parts *)to)->direction_given = true;
    return read_three(r, value, -1e6, 1e6, ((sun_parts *)to)->direction);
}

static shape_status sun_irradiance(reader *r, const json_t *value, void *to)
{
    shape_scene *scene = ((sun_parts *)to)->scene;
    scene->sun_irradiance_given = true;
    return read_one_or_three(r, value, 0, 1e9, scene->sun_irradiance);
}

static shape_status sun_angle(reader *r, const json_t *value, void *to)
{
    shape_scene *scene = ((sun_parts *)to)->scene;
    scene->sun_angle_given = true;
    return read_number(r, value, 0, 90, &scene->sun_angle);
}

static const member sun_members[] = {{"azimuth", sun_azimuth},     {"height", sun_height},
                                     {"direction", sun_direction}, {"irradiance", sun_irradiance},
                                     {"angle", sun_angle},         {0}};

static shape_status scene_sun(reader *r, const json_t *value, void *to)
{
    shape_scene *scene = to;
    sun_parts parts = {.scene = scene};
    if (json_is_string(value) && !strcmp(json_string_value(value), "none")) {
        scene->sun_none = true;
        return SHAPE_OK;
    }
    if (!json_is_object(value))
        return wrong(r, "expected an object, {...}, or \"none\"");
    shape_status status = read_object(r, value, sun_members, &parts);
    if (status)
        return status;
    if (parts.azimuth_given != parts.height_given)
        return wrong(r, "azimuth and height go together (give both)");
    if (parts.direction_given && parts.azimuth_given)
        return wrong(r, "direction says the same as azimuth and height (give one of them)");
    scene->sun_given = parts.azimuth_given || parts.direction_given;
    if (!parts.direction_given)
        return SHAPE_OK;
    const double *d = parts.direction;
    double across = hypot(d[0], d[2]);
    if (!(hypot(across, d[1]) > 1e-9))
        return wrong(r, "direction is [0, 0, 0] (name the direction to the sun)");
    scene->sun[0] = atan2(d[0], d[2]) * (180 / PI);
    scene->sun[1] = atan2(d[1], across) * (180 / PI);
    return SHAPE_OK;
}

typedef struct lamp_parts {
    shape_scene *scene;
    bool position_given;
} lamp_parts;

static shape_status lamp_position(reader *r, const json_t *value, void *to)
{
    ((lamp_parts *)to)->position_given = true;
    return read_three(r, value, -1e12, 1e12, ((lamp_parts *)to)->scene->lamp);
}

static shape_status lamp_intensity(reader *r, const json_t *value, void *to)
{
    return read_one_or_three(r, value, 0, 1e18, ((lamp_parts *)to)->scene->lamp_intensity);
}

static const member lamp_members[] = {{"position", lamp_position}, {"intensity", lamp_intensity}, {0}};

static shape_status scene_lamp(reader *r, const json_t *value, void *to)
{
    shape_scene *scene = to;
    lamp_parts parts = {.scene = scene};
    for (int i = 0; i < 3; i++)
        scene->lamp_intensity[i] = 10;
    shape_status status = read_object(r, value, lamp_members, &parts);
    if (!status && !parts.position_given)
        status = wrong(r, "has no position (say where it stands)");
    scene->lamp_given = true;
    return status;
}

static shape_status scene_sky(reader *r, const json_t *value, void *to)
{
    shape_scene *scene = to;
    scene->sky_given = true;
    if (json_is_number(value) || json_is_array(value)) {
        scene->sky = SHAPE_SKY_CONSTANT;
        return read_one_or_three(r, value, 0, 1e9, scene->sky_radiance);
    }
    const char *word = json_string_value(value);
    if (!word || (strcmp(word, "none") && strcmp(word, "clear")))
        return wrong(r, "expected \"none\", \"clear\" or a radiance, [r, g, b]");
    scene->sky = *word == 'n' ? SHAPE_SKY_NONE : SHAPE_SKY_CLEAR;
    return SHAPE_OK;
}

/* --- camera --- */

static shape_status camera_eye(reader *r, const json_t *value, void *to)
{
    ((shape_scene *)to)->eye_given = true;
    return read_three(r, value, -1e12, 1e12, ((shape_scene *)to)->eye);
}

static shape_status camera_target(reader *r, const json_t *value, void *to)
{
    ((shape_scene *)to)->target_given = true;
    return read_three(r, value, -1e12, 1e12, ((shape_scene *)to)->target);
}

static shape_status camera_fov(reader *r, const json_t *value, void *to)
{
    ((shape_scene *)to)->fov_given = true;
    return read_number(r, value, 0.001, 179, &((shape_scene *)to)->fov);
}

static shape_status camera_size(reader *r, const json_t *value, void *to)
{
    shape_scene *scene = to;
    if (!json_is_array(value) || json_array_size(value) != 2)
        return wrong(r, "expected two numbers, [width, height]");
    for (size_t i = 0; i < 2; i++) {
        const json_t *side = json_array_get(value, i);
        if (!json_is_integer(side) || json_integer_value(side) < 1 || json_integer_value(side) > 16384)
            return wrong(r, "expected whole numbers from 1 to 16384");
        scene->size[i] = (int)json_integer_value(side);
    }
    scene->size_given = true;
    return SHAPE_OK;
}

static const member camera_members[] = {
    {"eye", camera_eye}, {"target", camera_target}, {"fov", camera_fov}, {"size", camera_size}, {0}};

static shape_status scene_camera(reader *r, const json_t *value, void *to)
{
    shape_scene *scene = to;
    shape_status status = read_object(r, value, camera_members, scene);
    if (!status && scene->eye_given && scene->target_given &&
        !memcmp(scene->eye, scene->target, sizeof scene->eye))
        status = wrong(r, "eye and target are the same point (move one of them)");
    return status;
}

static shape_status scene_exposure(reader *r, const json_t *value, void *to)
{
    ((shape_scene *)to)->exposure_given = true;
    return read_number(r, value, -32, 32, &((shape_scene *)to)->exposure);
}

/* --- the whole --- */

static shape_status scene_version(reader *r, const json_t *value, void *to)
{
    (void)to;
    if (!json_is_integer(value) || json_integer_value(value) != SHAPE_SCENE_VERSION)
        return wrong(r, "expected %d, the version of the format that is known", SHAPE_SCENE_VERSION);
    return SHAPE_OK;
}

static shape_status scene_note(reader *r, const json_t *value, void *to)
{
    return read_note(r, value, &((shape_scene *)to)->note);
}

static shape_status scene_medium(reader *r, const json_t *value, void *to)
{
    return read_options(r, value, &((shape_scene *)to)->medium);
}

static const member scene_members[] = {{"scene", scene_version}, {"clouds", scene_clouds},
                                       {"medium", scene_medium}, {"sun", scene_sun},
                                       {"lamp", scene_lamp},     {"sky", scene_sky},
                                       {"camera", scene_camera}, {"exposure", scene_exposure},
                                       {"note", scene_note},     {0}};

static shape_status read_scene(reader *r, const json_t *root, shape_scene *scene)
{
    if (!json_object_get(root, "scene"))
        return wrong(r, "not a scene (one begins by {\"scene\": 1, ...})");
    if (!json_object_get(root, "clouds"))
        return wrong(r, "has no clouds (write \"clouds\": [...])");
    return read_object(r, root, scene_members, scene);
}

/* Depth and number of values are told from the brackets and commas outside of texts, before the JSON reader takes
 * memory for any. */
static shape_status check_limits(reader *r, const char *text, size_t size)
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

static json_t *parse(reader *r, const void *bytes, size_t size)
{
    json_error_t at;
    json_t *root = json_loadb(bytes, size, JSON_REJECT_DUPLICATES, &at);
    if (!root)
        shape_error_set(r->error, SHAPE_ERROR_FORMAT, "%s:%d:%d: no good JSON: %s", r->name,
                        at.line > 0 ? at.line : 1, at.column > 0 ? at.column : 1, at.text);
    for (char *c = r->error->text; !root && *c; c++)
        if ((unsigned char)*c < 0x20 || (unsigned char)*c == 0x7f)
            *c = '?'; /* JSON's own message quotes the bytes */
    return root;
}

shape_status shape_scene_decode(const void *bytes, size_t size, const char *name, shape_scene **scene,
                                shape_error *error)
{
    shape_error unwanted;
    reader r = {.name = name, .error = error ? error : &unwanted};
    shape_status status = check_limits(&r, bytes, size);
    if (status)
        return status;
    json_t *root = parse(&r, bytes, size);
    if (!root)
        return SHAPE_ERROR_FORMAT;
    shape_scene *made = shape_scene_create(error);
    status = made ? read_scene(&r, root, made) : SHAPE_ERROR_MEMORY;
    json_decref(root);
    if (status)
        shape_scene_destroy(made);
    else
        *scene = made;
    return status;
}
