/* What a program says on standard error: errors, notes, progress; each a line that begins with the program's name. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "cli.h"
#include "cli_private.h"

/* One process, one command line: what every line begins with, and whether notes are wanted. */
static const char *program_name = "neph";
static bool be_quiet;
static char error_place[512];

void cli_set_program(const char *name)
{
    program_name = name;
}

/* One line, whatever stands in it: names of files and texts of options may hold line breaks and a terminal's commands. */
static void print_line(const char *format, va_list arguments)
{
    char line[8192];
    size_t length = (size_t)snprintf(line, sizeof line, "%s: %s", program_name, error_place);
    vsnprintf(line + length, sizeof line - length, format, arguments);
    for (char *c = line; *c; c++)
        *c = (unsigned char)*c < 0x20 || *c == 0x7f ? '?' : *c;
    fprintf(stderr, "%s\n", line);
}

void cli_error(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    print_line(format, arguments);
    va_end(arguments);
}

void cli_fail(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    print_line(format, arguments);
    va_end(arguments);
    exit(CLI_FAILED);
}

void cli_wrong(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    print_line(format, arguments);
    va_end(arguments);
    exit(*error_place ? CLI_FAILED : CLI_WRONG); /* what a file says is no wrong command */
}

void cli_set_place(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error_place, sizeof error_place, format, arguments);
    va_end(arguments);
}

bool cli_set_quiet(bool quiet)
{
    bool before = be_quiet;
    be_quiet = quiet;
    return before;
}

void cli_check(shape_status status, const shape_error *error)
{
    if (status)
        cli_fail("%s", error->text);
}

void cli_say(const char *format, ...)
{
    if (be_quiet)
        return;
    va_list arguments;
    va_start(arguments, format);
    print_line(format, arguments);
    va_end(arguments);
}

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

void cli_progress(const char *what, double done)
{
    static double start = -1, shown = 0;
    double time = now();
    if (start < 0)
        start = shown = time;
    if (be_quiet || !isatty(STDERR_FILENO))
        return;
    if (done >= 1) {
        if (shown > start)
            fprintf(stderr, "\r\033[K");
        start = -1;
    } else if (time - start > 1 && time - shown > 0.1 && done > 0) {
        fprintf(stderr, "\r%s: %s %.0f %% (%.0f s left)\033[K", program_name, what, 100 * done,
                (time - start) * (1 - done) / done);
        fflush(stderr);
        shown = time;
    }
}
