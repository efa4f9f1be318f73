/* The picture options, and how they and the set become a view and a light. */
#include "cli_picture.h"

#include <string.h>

#define PI 3.14159265358979323846

cli_picture cli_picture_values = {.size = {640, 360},
                                  .fov = 45,
                                  .sun = {60, 40},
                                  .sun_irradiance = {PI, PI, PI},
                                  .sky = "clear",
                                  .exposure = 0.5,
                                  .sun_angle = 0.53,
                                  .lamp_intensity = {10, 10, 10}};

#define GIVEN(name) &cli_picture_values.name##_given, false
#define VALUE(name) &cli_picture_values.name
#define VALUES(name) cli_picture_values.name

const cli_option cli_picture_options[] = {
    {"size", 0, CLI_SIZE, VALUES(size), 1, 16384, "WxH", "width and height, pixels [640x360]", GIVEN(size)},
    {"eye", 0, CLI_VECTOR, VALUES(eye), -1e12, 1e12, "X,Y,Z",
     "where one looks from, metres [frames the cloud]", GIVEN(eye)},
    {"target", 0, CLI_VECTOR, VALUES(target), -1e12, 1e12, "X,Y,Z", "what one looks at, metres [the middle]",
     GIVEN(target)},
    {"fov", 0, CLI_NUMBER, VALUE(fov), 0.001, 179, "DEGREES", "vertical field of view, degrees [45]",
     GIVEN(fov)},
    {"sun", 0, CLI_PAIR, VALUES(sun), 0, 0, "AZIMUTH,HEIGHT",
     "where the sun stands, degrees; azimuth from +z towards +x [60,40]", GIVEN(sun)},
    {"sun-irradiance", 0, CLI_VECTOR, VALUES(sun_irradiance), 0, 1e9, "R,G,B",
     "of the sun on a plane that faces it [pi,pi,pi]", GIVEN(sun_irradiance)},
    {"sky", 0, CLI_TEXT, VALUE(sky), 0, 0, "none|R,G,B|clear",
     "black, one radiance, or a clear day's [clear]", GIVEN(sky)},
    {"visibility", 0, CLI_NUMBER, VALUE(visibility), 0, 1e12, "METRES",
     "of the air: how far away a black thing is just told from the sky; 0: there is no air [0]",
     GIVEN(visibility)},
    {"air-height", 0, CLI_NUMBER, VALUE(air_height), 0, 1e12, "METRES",
     "over which the air thins by a factor e, from y = 0 upwards; 0: alike at all heights [0]",
     GIVEN(air_height)},
    {"exposure", 0, CLI_NUMBER, VALUE(exposure), -32, 32, "STOPS", "of 8-bit pictures, stops [0.5]",
     GIVEN(exposure)},
    {0}};

static shape_dvec3 vector(const double v[3])
{
    return shape_dvec3_make(v[0], v[1], v[2]);
}

static void apply_light(shape_light *light)
{
    const cli_picture *v = &cli_picture_values;
    if (!(v->sun[0] >= -360 && v->sun[0] <= 360 && v->sun[1] >= -90 && v->sun[1] <= 90))
        cli_wrong("--sun %g,%g: the azimuth must be from -360 to 360, the height from -90 to 90", v->sun[0],
                  v->sun[1]);
    light->sun = shape_sun_direction(v->sun[0], v->sun[1]);
    for (int i = 0; i < 3; i++)
        light->sun_irradiance[i] = (float)v->sun_irradiance[i];
    double rgb[3];
    if (!strcmp(v->sky, "clear")) {
        light->sky = SHAPE_SKY_CLEAR;
    } else if (!strcmp(v->sky, "none")) {
        light->sky = SHAPE_SKY_NONE;
    } else if (cli_numbers(v->sky, 3, rgb)) {
        light->sky = SHAPE_SKY_CONSTANT;
        for (int i = 0; i < 3; i++) {
            if (!(rgb[i] >= 0 && rgb[i] <= 1e9))
                cli_wrong("--sky %s: a radiance must be from 0 to 1e9", v->sky);
            light->sky_radiance[i] = (float)rgb[i];
        }
    } else {
        cli_wrong("--sky \"%s\": expected none, clear or a radiance R,G,B", v->sky);
    }
    light->air.visibility = v->visibility;
    light->air.height = v->air_height;
    shape_error error;
    if (v->air_height_given && !(v->visibility > 0))
        cli_wrong("--air-height: there is no air (give --visibility METRES)");
    if (shape_light_check(light, &error))
        cli_wrong("%s", error.text);
}

void cli_picture_apply(const shape_set *set, shape_view *view, shape_light *light)
{
    const cli_picture *v = &cli_picture_values;
    shape_error error;
    *view = shape_view_defaults();
    *light = shape_light_defaults();
    apply_light(light);
    if (v->day_given)
        shape_day_apply(&v->day, light);
    view->width = (int)v->size[0];
    view->height = (int)v->size[1];
    view->fov = v->fov;
    view->exposure = (float)v->exposure;
    shape_dvec3 min = {-1, -1, -1}, max = {1, 1, 1};
    if (!shape_set_bounds(set, &min, &max) && !v->eye_given)
        cli_say("there is no cloud in the picture");
    shape_view_frame(view, light, min, max);
    if (v->eye_given)
        view->eye = vector(v->eye);
    if (v->target_given)
        view->target = vector(v->target);
    if (shape_view_check(view, &error))
        cli_wrong("%s", error.text);
}
