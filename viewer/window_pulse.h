/* window_pulse.c: how long the window keeps its user waiting: the time between two looks at the events, its longest, and
 * what was being done meanwhile. */
#ifndef NEPHELE_WINDOW_PULSE_H
#define NEPHELE_WINDOW_PULSE_H

#include <stdbool.h>
#include <stdint.h>

/* A moment: the clock, and how long the thread has been kept from a processor by others so far. */
typedef struct window_moment {
    double clock, kept; /* ms */
} window_moment;

typedef struct window_pulse {
    uint64_t frames;   /* counted so far */
    double longest;    /* the longest frame, the wait for the screen left out [ms] */
    double own;        /* the longest without the time in which other threads had the processor [ms] */
    double screen;     /* the longest wait for the screen, of all frames [ms] */
    const char *where; /* the step that took most of the longest frame; static text */
    int schedule;      /* a file of Linux that tells of that time; -1: none does */
    /* Of this frame. */
    window_moment begun, last, waited; /* waited: how long for the screen */
    const char *most;
    double most_ms;
} window_pulse;

/* Of the thread that calls it. */
void window_pulse_start(window_pulse *pulse);
void window_pulse_stop(window_pulse *pulse);
/* The events have been looked at. */
void window_pulse_begin(window_pulse *pulse);
/* A step of the frame is done; its name is static text. */
void window_pulse_step(window_pulse *pulse, const char *name);
/* The wait for the screen is over, which began at the last step; it does not count. */
void window_pulse_waited(window_pulse *pulse);
/* The frame is done; the next one looks at the events. compiles: the driver does for the first time what it has to compile for,
 * so that the frame does not count, like the very first ones. */
void window_pulse_end(window_pulse *pulse, bool compiles);
/* Says the longest on standard error; nothing where there was no frame. */
void window_pulse_say(const window_pulse *pulse);

#endif
