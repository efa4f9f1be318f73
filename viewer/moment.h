/* moment.c: what is seen at a time: the clouds, carried by the wind or on their way to others, the sun by the time of
 * day, the eye on its turntable. A moment depends on its time alone. */
#ifndef NEPHELE_VIEW_MOMENT_H
#define NEPHELE_VIEW_MOMENT_H

#include "shape/day.h"
#include "shape/morph.h"
#include "shape/motion.h"
#include "shape/view.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What moves, and how fast. */
typedef struct view_course {
    shape_motion motion;
    bool day_runs;        /* the sun goes by the time of day */
    shape_day day;        /* at time 0 */
    double day_speed;     /* hours of the day a second */
    double turn_seconds;  /* of one turn of the eye about the target; 0: it stands */
    double morph_seconds; /* from the first clouds to the others; there it stays */
} view_course;

view_course view_course_defaults(void);

/* The clouds at a time [s]; morph may be NULL. The caller destroys *moved. */
shape_status view_course_set(const view_course *course, const shape_set *set, const shape_morph *morph,
                             double time, shape_set **moved, shape_error *error);
/* Moves a view and a light from time 0 to a time. */
void view_course_view(const view_course *course, double time, shape_view *view);
void view_course_light(const view_course *course, double time, shape_light *light);

/* The eye, turned about the target's vertical axis. */
void view_orbit(shape_view *view, double degrees);

#ifdef __cplusplus
}
#endif
#endif
