/* Private: work that can be broken off. Each thread has a watch of its own, tells it what it has done, and is asked to stop
 * now and then. */
#ifndef SHAPE_BASE_STOP_H
#define SHAPE_BASE_STOP_H

#include <stddef.h>

#include "shape/status.h"

/* Units of work, each a few nanoseconds to a few tens of them (a primitive looked at), between two looks. */
enum { STOP_INTERVAL = 1 << 16 };

/* Zeroed: nobody ever stops. */
typedef struct stop_watch {
    shape_stop stop;
    size_t done; /* since the last look */
    bool stopped;
} stop_watch;

/* Whether the caller wants no more; looks at once. */
static inline bool stop_now(stop_watch *watch)
{
    watch->done = 0;
    if (!watch->stopped && watch->stop.asked)
        watch->stopped = watch->stop.asked(watch->stop.context);
    return watch->stopped;
}

/* Whether to stop, after so much more work; looks when enough has been done. */
static inline bool stop_after(stop_watch *watch, size_t work)
{
    watch->done += work;
    return watch->done >= STOP_INTERVAL ? stop_now(watch) : watch->stopped;
}

/* The error of work that was broken off. Returns SHAPE_ERROR_STOPPED. */
static inline shape_status stop_error(shape_error *error)
{
    return shape_error_set(error, SHAPE_ERROR_STOPPED, "broken off (begin it again to have it)");
}

#endif
