/* What a picture without a window needs besides OpenGL, made on a thread while that is being started. */
#ifndef NEPHELE_READY_H
#define NEPHELE_READY_H

#include "view.h"

typedef struct view_ready view_ready;

/* Begins to place the job's clouds for its time (view_job_place), and to make the first light and density of a view that moves.
 * The job is not to be touched until the end. */
shape_status view_ready_start(view_job *job, const shape_view *view, const shape_light *light,
                              view_ready **made, shape_error *error);
/* Waits until that is done, and frees `ready`. The caller gives *first to a renderer; NULL: there is nothing. */
shape_status view_ready_end(view_ready *ready, shape_gl_first **first, shape_error *error);

#endif
