/* The rows of a picture over the threads (OpenMP): one thread speaks of the progress, all stop when it is told to. */
#include "light/rows.h"

#ifdef _OPENMP
#include <omp.h>
#endif

static bool speaks(void)
{
#ifdef _OPENMP
    return omp_get_thread_num() == 0;
#else
    return true;
#endif
}

static bool go_on(const rows_progress *progress, double done)
{
    double share = progress->from + (progress->to - progress->from) * done;
    return !progress->call || progress->call(progress->context, share);
}

shape_status rows_share(int height, rows_work work, void *context, const rows_progress *progress,
                        bool *cancelled)
{
    int stop = 0, failed = SHAPE_OK, done = 0;
#pragma omp parallel for schedule(dynamic, 1)
    for (int y = 0; y < height; y++) {
        int stopped, rows;
#pragma omp atomic read
        stopped = stop;
        if (stopped)
            continue;
        shape_status status = work(context, y);
        if (status) {
#pragma omp atomic write
            failed = (int)status;
        }
#pragma omp atomic capture
        rows = ++done;
        if (speaks() && !go_on(progress, (double)rows / height)) {
#pragma omp atomic write
            stop = 1;
        }
    }
    /* The thread that speaks may have had no row at all. */
    if (!stop && !go_on(progress, 1))
        stop = 1;
    *cancelled = stop;
    return (shape_status)failed;
}
