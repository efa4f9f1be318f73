/* The light and the camera of scenes from JSON. */
#include <math.h>
#include <string.h>

#include "file/scene_reader.h"

#define PI 3.14159265358979323846

/* --- light --- */

/* The sun's members, before they are put together: a direction and two angles exclude each other. */
typedef struct sun_parts {
    shape_scene *scene;
    double direction[3];
    bool direction_given, azimuth_given, height_given;
} sun_parts;

static shape_status sun_azimuth(scene_reader *r, const json_t *value, void *to)
{
    ((sun_parts *)to)->azimuth_given = true;
    return scene_read_number(r, value, -360, 360, &((sun_parts *)to)->scene->sun[0]);
}

static shape_status sun_height(scene_reader *r, const json_t *value, void *to)
{
    ((sun_parts *)to)->height_given = true;
    return scene_read_number(r, value, -90, 90, &((sun_parts *)to)->scene->sun[1]);
}

static shape_status sun_direction(scene_reader *r, const json_t *value, void *to)
{
    ((sun_parts *)to)->direction_given = true;
    return scene_read_three(r, value, -1e6, 1e6, ((sun_parts *)to)->direction);
}

static shape_status sun_irradiance(scene_reader *r, const json_t *value, void *to)
{
    shape_scene *scene = ((sun_parts *)to)->scene;
    scene->sun_irradiance_given = true;
    return scene_read_one_or_three(r, value, 0, 1e9, scene->sun_irradiance);
}

static shape_status sun_angle(scene_reader *r, const json_t *value, void *to)
{
    shape_scene *scene = ((sun_parts *)to)->scene;
    scene->sun_angle_given = true;
    return scene_read_number(r, value, 0, 90, &scene->sun_angle);
}

static shape_status day_hour(scene_reader *r, const json_t *value, void *to)
{
    return scene_read_number(r, value, 0, 24, &((shape_day *)to)->hour);
}

static shape_status day_latitude(scene_reader *r, const json_t *value, void *to)
{
    return scene_read_number(r, value, -90, 90, &((shape_day *)to)->latitude);
}

static shape_status day_declination(scene_reader *r, const json_t *value, void *to)
{
    return scene_read_number(r, value, -23.45, 23.45, &((shape_day *)to)->declination);
}

static const scene_member day_members[] = {
    {"hour", day_hour, 0}, {"latitude", day_latitude, 0}, {"declination", day_declination, 0}, {0}};

static shape_status sun_day(scene_reader *r, const json_t *value, void *to)
{
    shape_scene *scene = ((sun_parts *)to)->scene;
    scene->day_given = true;
    scene->day = (shape_day){12, 50, 0};
    return scene_read_object(r, value, day_members, &scene->day);
}

static const scene_member sun_members[] = {{"azimuth", sun_azimuth, 0},
                                           {"height", sun_height, 0},
                                           {"direction", sun_direction, 0},
                                           {"irradiance", sun_irradiance, 0},
                                           {"angle", sun_angle, 0},
                                           {"day", sun_day, 0},
                                           {0}};

shape_status scene_sun(scene_reader *r, const json_t *value, void *to)
{
    shape_scene *scene = to;
    sun_parts parts = {.scene = scene};
    if (json_is_string(value) && !strcmp(json_string_value(value), "none")) {
        scene->sun_none = true;
        return SHAPE_OK;
    }
    if (!json_is_object(value))
        return scene_wrong(r, "expected an object, {...}, or \"none\"");
    shape_status status = scene_read_object(r, value, sun_members, &parts);
    if (status)
        return status;
    if (parts.azimuth_given != parts.height_given)
        return scene_wrong(r, "azimuth and height go together (give both)");
    if (parts.direction_given && parts.azimuth_given)
        return scene_wrong(r, "direction says the same as azimuth and height (give one of them)");
    scene->sun_given = parts.azimuth_given || parts.direction_given;
    if (!parts.direction_given)
        return SHAPE_OK;
    const double *d = parts.direction;
    double across = hypot(d[0], d[2]);
    if (!(hypot(across, d[1]) > 1e-9))
        return scene_wrong(r, "direction is [0, 0, 0] (name the direction to the sun)");
    scene->sun[0] = atan2(d[0], d[2]) * (180 / PI);
    scene->sun[1] = atan2(d[1], across) * (180 / PI);
    return SHAPE_OK;
}

typedef struct lamp_parts {
    shape_scene *scene;
    bool position_given;
} lamp_parts;

static shape_status lamp_position(scene_reader *r, const json_t *value, void *to)
{
    ((lamp_parts *)to)->position_given = true;
    return scene_read_three(r, value, -1e12, 1e12, ((lamp_parts *)to)->scene->lamp);
}

static shape_status lamp_intensity(scene_reader *r, const json_t *value, void *to)
{
    return scene_read_one_or_three(r, value, 0, 1e18, ((lamp_parts *)to)->scene->lamp_intensity);
}

static const scene_member lamp_members[] = {
    {"position", lamp_position, 0}, {"intensity", lamp_intensity, 0}, {0}};

shape_status scene_lamp(scene_reader *r, const json_t *value, void *to)
{
    shape_scene *scene = to;
    lamp_parts parts = {.scene = scene};
    for (int i = 0; i < 3; i++)
        scene->lamp_intensity[i] = 10;
    shape_status status = scene_read_object(r, value, lamp_members, &parts);
    if (!status && !parts.position_given)
        status = scene_wrong(r, "has no position (say where it stands)");
    scene->lamp_given = true;
    return status;
}

shape_status scene_sky(scene_reader *r, const json_t *value, void *to)
{
    shape_scene *scene = to;
    scene->sky_given = true;
    if (json_is_number(value) || json_is_array(value)) {
        scene->sky = SHAPE_SKY_CONSTANT;
        return scene_read_one_or_three(r, value, 0, 1e9, scene->sky_radiance);
    }
    const char *word = json_string_value(value);
    if (!word || (strcmp(word, "none") && strcmp(word, "clear")))
        return scene_wrong(r, "expected \"none\", \"clear\" or a radiance, [r, g, b]");
    scene->sky = *word == 'n' ? SHAPE_SKY_NONE : SHAPE_SKY_CLEAR;
    return SHAPE_OK;
}

static shape_status air_visibility(scene_reader *r, const json_t *value, void *to)
{
    ((shape_scene *)to)->air_given = true;
    return scene_read_number(r, value, 1e-3, 1e12, &((shape_scene *)to)->visibility);
}

static shape_status air_height(scene_reader *r, const json_t *value, void *to)
{
    return scene_read_number(r, value, 1e-3, 1e12, &((shape_scene *)to)->air_height);
}

static const scene_member air_members[] = {{"visibility", air_visibility, 0}, {"height", air_height, 0}, {0}};

shape_status scene_air(scene_reader *r, const json_t *value, void *to)
{
    shape_status status = scene_read_object(r, value, air_members, to);
    if (!status && !((shape_scene *)to)->air_given)
        status = scene_wrong(r, "has no visibility (say how far one sees, in metres)");
    return status;
}

/* --- camera --- */

static shape_status camera_eye(scene_reader *r, const json_t *value, void *to)
{
    ((shape_scene *)to)->eye_given = true;
    return scene_read_three(r, value, -1e12, 1e12, ((shape_scene *)to)->eye);
}

static shape_status camera_target(scene_reader *r, const json_t *value, void *to)
{
    ((shape_scene *)to)->target_given = true;
    return scene_read_three(r, value, -1e12, 1e12, ((shape_scene *)to)->target);
}

static shape_status camera_fov(scene_reader *r, const json_t *value, void *to)
{
    ((shape_scene *)to)->fov_given = true;
    return scene_read_number(r, value, 0.001, 179, &((shape_scene *)to)->fov);
}

static shape_status camera_size(scene_reader *r, const json_t *value, void *to)
{
    shape_scene *scene = to;
    if (!json_is_array(value) || json_array_size(value) != 2)
        return scene_wrong(r, "expected two numbers, [width, height]");
    for (size_t i = 0; i < 2; i++) {
        const json_t *side = json_array_get(value, i);
        if (!json_is_integer(side) || json_integer_value(side) < 1 || json_integer_value(side) > 16384)
            return scene_wrong(r, "expected whole numbers from 1 to 16384");
        scene->size[i] = (int)json_integer_value(side);
    }
    scene->size_given = true;
    return SHAPE_OK;
}

static const scene_member camera_members[] = {{"eye", camera_eye, 0},
                                              {"target", camera_target, 0},
                                              {"fov", camera_fov, 0},
                                              {"size", camera_size, 0},
                                              {0}};

shape_status scene_camera(scene_reader *r, const json_t *value, void *to)
{
    shape_scene *scene = to;
    shape_status status = scene_read_object(r, value, camera_members, scene);
    if (!status && scene->eye_given && scene->target_given &&
        !memcmp(scene->eye, scene->target, sizeof scene->eye))
        status = scene_wrong(r, "eye and target are the same point (move one of them)");
    return status;
}

shape_status scene_exposure(scene_reader *r, const json_t *value, void *to)
{
    ((shape_scene *)to)->exposure_given = true;
    return scene_read_number(r, value, -32, 32, &((shape_scene *)to)->exposure);
}
