/* The camera and the light: defaults, checks, and a view that frames a box. */
#include "shape/view.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

static double radians(double degrees)
{
    return degrees * (pi / 180);
}

shape_view shape_view_defaults(void)
{
    shape_view view = {.width = 640, .height = 360, .eye = {0, 0, 10}, .fov = 45, .exposure = 0.5f};
    return view;
}

shape_dvec3 shape_sun_direction(double azimuth, double height)
{
    double a = radians(azimuth), h = radians(height);
    return shape_dvec3_make(sin(a) * cos(h), sin(h), cos(a) * cos(h));
}

shape_light shape_light_defaults(void)
{
    shape_light light = {.sun = shape_sun_direction(60, 40), .sky = SHAPE_SKY_CLEAR};
    for (int i = 0; i < 3; i++)
        light.sun_irradiance[i] = (float)pi;
    return light;
}

static bool finite3(shape_dvec3 v)
{
    return isfinite(v.x) && isfinite(v.y) && isfinite(v.z);
}

shape_status shape_view_check(const shape_view *view, shape_error *error)
{
    shape_dvec3 way = shape_dvec3_sub(view->target, view->eye);
    if (view->width < 1 || view->width > 16384 || view->height < 1 || view->height > 16384)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "view size %dx%d: both sides must be from 1 to 16384", view->width,
                               view->height);
    if (!(view->fov > 0 && view->fov < 180))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "view fov %g: must be above 0 and below 180 degrees", view->fov);
    if (!finite3(view->eye) || !finite3(view->target))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "view eye or target is not a finite point");
    if (!(shape_dvec3_dot(way, way) > 0))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "view eye and target are the same point (move one of them)");
    if (!isfinite(view->exposure))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "view exposure is not a finite number");
    return SHAPE_OK;
}

static bool is_length(double metres)
{
    return metres == 0 || (metres >= 1e-3 && metres <= 1e12);
}

shape_status shape_light_check(const shape_light *light, shape_error *error)
{
    if (!is_length(light->air.visibility) || !is_length(light->air.height))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "light air: visibility and height must be 0, or from 0.001 to 1e12 metres");
    if (!(fabs(shape_dvec3_length(light->sun) - 1) <= 1e-3))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "light sun: must be a unit vector");
    if (light->sky < SHAPE_SKY_NONE || light->sky > SHAPE_SKY_CLEAR)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "light sky: %d is no kind of sky",
                               (int)light->sky);
    for (int i = 0; i < 3; i++) {
        if (!(light->sun_irradiance[i] >= 0) || !isfinite(light->sun_irradiance[i]))
            return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                                   "light sun_irradiance: must be finite and not negative");
        if (!(light->sky_radiance[i] >= 0) || !isfinite(light->sky_radiance[i]))
            return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                                   "light sky_radiance: must be finite and not negative");
    }
    return SHAPE_OK;
}

shape_camera shape_view_camera(const shape_view *view)
{
    shape_camera camera;
    camera.origin = view->eye;
    camera.forward = shape_dvec3_normalize(shape_dvec3_sub(view->target, view->eye));
    /* Looking straight up or down, the picture's upper edge points along -z or +z. */
    shape_dvec3 sky = {0, 1, 0};
    if (fabs(camera.forward.y) > 1 - 1e-12)
        sky = shape_dvec3_make(0, 0, camera.forward.y > 0 ? 1 : -1);
    shape_dvec3 right = shape_dvec3_normalize(shape_dvec3_cross(camera.forward, sky));
    double tangent = tan(radians(view->fov) / 2);
    camera.up = shape_dvec3_scale(shape_dvec3_cross(right, camera.forward), tangent);
    camera.right = shape_dvec3_scale(right, tangent * view->width / view->height);
    return camera;
}

shape_dvec3 shape_camera_direction(const shape_camera *camera, const shape_view *view, double x, double y)
{
    double right = 2 * x / view->width - 1, up = 1 - 2 * y / view->height;
    shape_dvec3 direction = shape_dvec3_add(camera->forward, shape_dvec3_scale(camera->right, right));
    return shape_dvec3_normalize(shape_dvec3_add(direction, shape_dvec3_scale(camera->up, up)));
}

/* How far from the box's middle the eye must stand, along the camera's own axis, for one corner (given from the
 * middle) to lie within the share `fill` of the picture. */
static double distance_for(const shape_camera *camera, shape_dvec3 corner, double fill)
{
    double depth = shape_dvec3_dot(corner, camera->forward);
    double right =
        fabs(shape_dvec3_dot(corner, camera->right)) / shape_dvec3_dot(camera->right, camera->right);
    double up = fabs(shape_dvec3_dot(corner, camera->up)) / shape_dvec3_dot(camera->up, camera->up);
    return fmax(right, up) / fill - depth;
}

/* How broad a box looks from an azimuth. */
static double breadth(shape_dvec3 min, shape_dvec3 max, double azimuth)
{
    double a = radians(azimuth);
    return (max.x - min.x) * fabs(cos(a)) + (max.z - min.z) * fabs(sin(a));
}

void shape_view_frame(shape_view *view, const shape_light *light, shape_dvec3 min, shape_dvec3 max)
{
    /* Seen from 11 degrees below, so that the cloud stands against the sky; 68 degrees off the sun shows its form. */
    const double below = -11, off_sun = 68, fill = 0.92;
    double sun = atan2(light->sun.x, light->sun.z) * (180 / pi), azimuth = sun + off_sun;
    if (breadth(min, max, sun - off_sun) > breadth(min, max, azimuth))
        azimuth = sun - off_sun;
    shape_dvec3 middle = shape_dvec3_scale(shape_dvec3_add(min, max), 0.5);
    shape_dvec3 half = shape_dvec3_scale(shape_dvec3_sub(max, min), 0.5);
    shape_dvec3 out = shape_sun_direction(azimuth, below);
    shape_view unit = *view;
    unit.eye = out;
    unit.target = shape_dvec3_make(0, 0, 0);
    shape_camera camera = shape_view_camera(&unit);
    double distance = 0;
    for (int i = 0; i < 8; i++) {
        shape_dvec3 corner = {i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z};
        double wanted =
            distance_for(&camera, corner, fill); /* not fmax: gcc 12 for arm64 breaks on it here */
        distance = wanted > distance ? wanted : distance;
    }
    view->target = middle;
    view->eye = shape_dvec3_add(middle, shape_dvec3_scale(out, distance > 0 ? distance : 1));
}
