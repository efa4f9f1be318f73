/* What is seen at a time. */
#include "moment.h"

#include <math.h>

view_course view_course_defaults(void)
{
    view_course course = {.day = {12, 50, 0}, .day_speed = 0.5, .morph_seconds = 4, .motion = {.seed = 1}};
    return course;
}

shape_status view_course_set(const view_course *course, const shape_set *set, const shape_morph *morph,
                             double time, shape_set **moved, shape_error *error)
{
    shape_set *morphed = NULL;
    shape_status status = SHAPE_OK;
    if (morph) {
        double share = fmin(fmax(time / course->morph_seconds, 0), 1);
        /* Slow at both ends. */
        status = shape_morph_at(morph, share * share * (3 - 2 * share), &morphed, error);
    }
    if (!status)
        status = shape_motion_apply(morphed ? morphed : set, &course->motion, time, moved, error);
    shape_set_destroy(morphed);
    return status;
}

void view_course_view(const view_course *course, double time, shape_view *view)
{
    if (course->turn_seconds > 0)
        view_orbit(view, remainder(360 * time / course->turn_seconds, 360));
}

void view_course_light(const view_course *course, double time, shape_light *light)
{
    if (!course->day_runs)
        return;
    shape_day day = course->day;
    day.hour += course->day_speed * time;
    shape_day_apply(&day, light);
}

void view_orbit(shape_view *view, double degrees)
{
    double angle = degrees * 3.14159265358979323846 / 180, c = cos(angle), s = sin(angle);
    shape_dvec3 d = shape_dvec3_sub(view->eye, view->target);
    view->eye = shape_dvec3_add(view->target, shape_dvec3_make(c * d.x + s * d.z, d.y, c * d.z - s * d.x));
}
