/* Errors as values: every function that can fail returns a shape_status and fills a shape_error. */
#ifndef SHAPE_STATUS_H
#define SHAPE_STATUS_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum shape_status {
    SHAPE_OK = 0,
    SHAPE_ERROR_MEMORY,   /* an allocation failed */
    SHAPE_ERROR_ARGUMENT, /* a parameter is outside its stated range */
    SHAPE_ERROR_FORMAT,   /* the bytes or text read are not what they should be */
    SHAPE_ERROR_IO,       /* the system could not read or write */
    SHAPE_ERROR_LIMIT,    /* a stated limit would be passed */
    SHAPE_ERROR_SYSTEM,   /* something outside the library is missing (GL, a driver) */
    SHAPE_ERROR_STOPPED   /* the caller broke the work off (shape_stop) */
} shape_status;

/* One mistake in one line, without a newline and without the program's name. */
typedef struct shape_error {
    shape_status status;
    char text[512];
} shape_error;

#if defined(__GNUC__)
#define SHAPE_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define SHAPE_PRINTF(text, first)
#endif

/* Fills *error (which may be NULL) with a printf-formatted line, and returns status, so that a caller can write
 * `return shape_error_set(error, SHAPE_ERROR_FORMAT, "...", ...)`. Too long a text is cut, and control
 * characters in it (of a name that a file brought) are shown as '?'. */
shape_status shape_error_set(shape_error *error, shape_status status, const char *format, ...)
    SHAPE_PRINTF(3, 4);

/* The usual line for a failed allocation. Returns SHAPE_ERROR_MEMORY. */
shape_status shape_error_memory(shape_error *error);

/* Of threads that share work, each with an error of its own, zeroed before: joins that into *status and *error (which may be NULL)
 * of all, the last one stays; nothing where it is SHAPE_OK. Threads may call it at once. */
void shape_error_join(const shape_error *own, shape_status *status, shape_error *error);

/* clang's analyser does not look into the other file, and would take either for a success. */
#ifdef __clang_analyzer__
#define shape_error_set(error, status, ...) (shape_error_set(error, status, __VA_ARGS__), (status))
#define shape_error_memory(error) (shape_error_memory(error), SHAPE_ERROR_MEMORY)
#endif

/* Of long work, called now and then by one thread. done is the share of the work, 0 to 1; false ends the work. */
typedef bool (*shape_progress)(void *context, double done);

/* A way to break long work off, of functions that have a shape_stop among their options; zeroed: none. asked(context) is
 * called by every thread of the work, several at once, about every few milliseconds of each one's own: it must be
 * thread-safe and quick (an atomic flag), and once it is true it must stay true until the function has returned. That then
 * gives back what it took, and returns SHAPE_ERROR_STOPPED. */
typedef struct shape_stop {
    bool (*asked)(void *context);
    void *context;
} shape_stop;

/* The library's version, "major.minor.patch". Static storage. */
const char *shape_version(void);

#ifdef __cplusplus
}
#endif
#endif
