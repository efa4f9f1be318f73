/* watch.c: the opened file and all that it names, read again whenever one has been saved, on a thread of its own. */
#ifndef NEPHELE_VIEW_WATCH_H
#define NEPHELE_VIEW_WATCH_H

#include "source.h"

typedef struct view_watch view_watch;

/* What came of the last reading. */
typedef struct view_news {
    view_contents contents; /* contents.set is NULL where the file had mistakes; the caller frees it */
    char text[4096];        /* the mistakes, one a line; empty where there are none */
    double saved;           /* CLOCK_MONOTONIC when the file was written last, or put in its place [ms] */
    double work;            /* of all processors for this process, when that was found [ms] */
    double milliseconds;    /* that the reading took */
} view_news;

/* What all threads of this process have had of the processors so far [ms]. */
double view_work_ms(void);

enum { VIEW_FILES_MAX = 256 }; /* watched at once; of a scene that names more, the first */

/* Whether a path is one of a file that can be read again: no pipe, and no standard input. */
bool view_watch_can(const char *path);
/* Begins to watch the file, those that it names where it is a scene, and those of `more`, which outlives the watch; NULL. `wake` is called from the thread when there is news. Standard input ("-") is read once and not
 * watched; nor is "", which stands for a generator without a file. NULL and *error: threads or memory are out. */
view_watch *view_watch_start(const char *path, const view_generator *generator, const view_more_things *more,
                             void (*wake)(void), shape_error *error);
void view_watch_stop(view_watch *watch); /* NULL is allowed */
/* The same without waiting for the end: the thread frees what is left when it gets there. NULL is allowed. */
void view_watch_leave(view_watch *watch);
/* Breaks off the reading that is under way; nothing comes of it. */
void view_watch_cancel(view_watch *watch);
/* Makes a generator's cloud anew by other settings, breaking off what is being made; not that of standard input. */
void view_watch_ask(view_watch *watch, const view_generator *generator);
/* Takes the newest news; false where there is none since the last time. */
bool view_watch_take(view_watch *watch, view_news *news);
/* Whether a reading is under way. */
bool view_watch_is_busy(view_watch *watch);
/* For how long it has been, in milliseconds; 0: none is. */
double view_watch_busy_for(view_watch *watch);

#endif
