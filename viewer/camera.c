/* The orbit and fly camera. */
#include <math.h>

#include "view.h"

static const double steepest = 1.55; /* radians; straight up has no right and left */

static shape_dvec3 direction(const view_camera *c)
{
    return shape_dvec3_make(cos(c->pitch) * sin(c->yaw), sin(c->pitch), cos(c->pitch) * cos(c->yaw));
}

static double distance(const view_camera *c)
{
    return shape_dvec3_length(shape_dvec3_sub(c->target, c->eye));
}

static void turn(view_camera *c, double yaw, double pitch)
{
    c->yaw = remainder(c->yaw + yaw, 2 * 3.14159265358979323846);
    c->pitch = fmin(fmax(c->pitch + pitch, -steepest), steepest);
}

view_camera view_camera_start(const shape_view *view, shape_dvec3 min, shape_dvec3 max)
{
    shape_dvec3 d = shape_dvec3_normalize(shape_dvec3_sub(view->target, view->eye));
    view_camera camera = {.eye = view->eye,
                          .target = view->target,
                          .yaw = atan2(d.x, d.z),
                          .pitch = fmin(fmax(asin(fmin(fmax(d.y, -1), 1)), -steepest), steepest),
                          .size = 0.5 * shape_dvec3_length(shape_dvec3_sub(max, min))};
    if (!(camera.size > 0))
        camera.size = 1;
    return camera;
}

void view_camera_orbit(view_camera *camera, double yaw, double pitch)
{
    double length = distance(camera);
    turn(camera, yaw, pitch);
    camera->eye = shape_dvec3_sub(camera->target, shape_dvec3_scale(direction(camera), length));
}

void view_camera_look(view_camera *camera, double yaw, double pitch)
{
    double length = distance(camera);
    turn(camera, yaw, pitch);
    camera->target = shape_dvec3_add(camera->eye, shape_dvec3_scale(direction(camera), length));
}

void view_camera_dolly(view_camera *camera, double factor)
{
    double length = distance(camera), step = length * (1 - factor), nearest = 0.05 * camera->size;
    shape_dvec3 move = shape_dvec3_scale(direction(camera), step);
    camera->eye = shape_dvec3_add(camera->eye, move);
    if (length - step < nearest)
        camera->target = shape_dvec3_add(camera->eye, shape_dvec3_scale(direction(camera), nearest));
}

void view_camera_fly(view_camera *camera, double right, double up, double ahead)
{
    shape_dvec3 d = direction(camera), aside = {-cos(camera->yaw), 0, sin(camera->yaw)};
    shape_dvec3 over = shape_dvec3_cross(aside, d);
    shape_dvec3 move =
        shape_dvec3_add(shape_dvec3_scale(aside, right),
                        shape_dvec3_add(shape_dvec3_scale(over, up), shape_dvec3_scale(d, ahead)));
    camera->eye = shape_dvec3_add(camera->eye, move);
    camera->target = shape_dvec3_add(camera->target, move);
}

void view_camera_apply(const view_camera *camera, shape_view *view)
{
    view->eye = camera->eye;
    view->target = camera->target;
}
