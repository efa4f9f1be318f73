/* The longest time between two looks at the events. The first frames are left out, and the first with a picture:
 * the driver compiles its shaders in them. */
#include "window_pulse.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "cli.h"

enum { FIRST_FRAMES = 5 };

/* Linux tells for each thread: nanoseconds on a processor, nanoseconds ready to run while others did, turns. */
static double read_kept(const window_pulse *pulse)
{
    char text[96];
    ssize_t size = pulse->schedule < 0 ? -1 : pread(pulse->schedule, text, sizeof text - 1, 0);
    if (size <= 0)
        return 0;
    text[size] = 0;
    const char *second = strchr(text, ' ');
    return second ? 1e-6 * strtod(second, NULL) : 0;
}

static window_moment now(const window_pulse *pulse)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (window_moment){1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec, read_kept(pulse)};
}

void window_pulse_start(window_pulse *pulse)
{
    pulse->schedule = open("/proc/thread-self/schedstat", O_RDONLY | O_CLOEXEC);
    pulse->where = "";
}

void window_pulse_stop(window_pulse *pulse)
{
    if (pulse->schedule >= 0)
        close(pulse->schedule);
    pulse->schedule = -1;
}

void window_pulse_begin(window_pulse *pulse)
{
    pulse->begun = pulse->last = now(pulse);
    pulse->waited = (window_moment){0, 0};
    pulse->most_ms = 0;
    pulse->most = "";
}

void window_pulse_step(window_pulse *pulse, const char *name)
{
    window_moment is = now(pulse);
    if (is.clock - pulse->last.clock > pulse->most_ms) {
        pulse->most_ms = is.clock - pulse->last.clock;
        pulse->most = name;
    }
    pulse->last = is;
}

void window_pulse_waited(window_pulse *pulse)
{
    window_moment is = now(pulse);
    pulse->waited.clock = is.clock - pulse->last.clock;
    pulse->waited.kept = is.kept - pulse->last.kept;
    pulse->last = is;
}

void window_pulse_end(window_pulse *pulse, bool compiles)
{
    double ms = pulse->last.clock - pulse->begun.clock - pulse->waited.clock;
    double own = ms - (pulse->last.kept - pulse->begun.kept - pulse->waited.kept);
    if (pulse->waited.clock > pulse->screen)
        pulse->screen = pulse->waited.clock;
    if (++pulse->frames <= FIRST_FRAMES || compiles)
        return;
    if (ms > pulse->longest) {
        pulse->longest = ms;
        pulse->where = pulse->most;
    }
    if (own > pulse->own)
        pulse->own = own;
}

void window_pulse_say(const window_pulse *pulse)
{
    if (pulse->longest > 0)
        cli_say(
            "%llu frames of the window, the longest took %.0f ms (most of it to %s), or %.0f ms without what "
            "others had of the processor; the screen was waited for %.0f ms at most",
            (unsigned long long)pulse->frames, pulse->longest, pulse->where, pulse->own, pulse->screen);
}
