/* Private: the rows of a picture, shared out over the threads, with progress and an early end. */
#ifndef SHAPE_LIGHT_ROWS_H
#define SHAPE_LIGHT_ROWS_H

#include "shape/pathtrace.h"

/* Fills row y of the picture. Called by several threads at once, each row once. */
typedef shape_status (*rows_work)(void *context, int y);

/* Progress of a piece of work that is the share from..to of the whole. */
typedef struct rows_progress {
    shape_progress call; /* NULL: none */
    void *context;
    double from, to;
} rows_progress;

/* Works on rows 0 to height - 1. *cancelled: the caller's progress ended it. Returns the status of a row that failed. */
shape_status rows_share(int height, rows_work work, void *context, const rows_progress *progress,
                        bool *cancelled);

#endif
