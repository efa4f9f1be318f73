/* For tests: memory that runs out on demand. What includes this is linked by the build with --wrap, so that every
 * allocation passes here: counted, and failed when its turn comes. For one source file of a program. */
#ifndef FAILING_MEMORY_H
#define FAILING_MEMORY_H

#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "shape/status.h"

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
int __real_posix_memalign(void **block, size_t alignment, size_t size);
void __real_free(void *block);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t size);
int __wrap_posix_memalign(void **block, size_t alignment, size_t size);
void __wrap_free(void *block);

static long allocations_left = -1; /* below 0: no limit */
static long live, most;            /* blocks; bytes of the largest that was asked for */
static int other_errors;           /* 1: a library may call it another error than memory */

static int refuse(size_t size)
{
    if ((long)size > most)
        most = (long)size;
    return allocations_left >= 0 && allocations_left-- == 0;
}

void *__wrap_malloc(size_t size)
{
    void *block = refuse(size) ? NULL : __real_malloc(size);
    live += block != NULL;
    return block;
}

void *__wrap_calloc(size_t count, size_t size)
{
    void *block = refuse(count * size) ? NULL : __real_calloc(count, size);
    live += block != NULL;
    return block;
}

void *__wrap_realloc(void *old, size_t size)
{
    void *block = refuse(size) ? NULL : __real_realloc(old, size);
    live += block && !old;
    return block;
}

int __wrap_posix_memalign(void **block, size_t alignment, size_t size)
{
    int code = refuse(size) ? ENOMEM : __real_posix_memalign(block, alignment, size);
    live += !code;
    return code;
}

void __wrap_free(void *block)
{
    live -= block != NULL;
    __real_free(block);
}

typedef shape_status (*work)(shape_error *error);

/* Fails the first allocation of the work, then the second, and so on, until it needs no more; at least so many must be
 * seen. `spared` of them the work can do without: memory given back. */
static inline void fail_each(work run, long at_least, int spared)
{
    long before = live, failures = 0;
    for (;; failures++) {
        shape_error error = {0};
        allocations_left = failures;
        shape_status status = run(&error);
        int used_up = allocations_left < 0;
        allocations_left = -1;
        assert_int_equal(live, before);
        if (!status && !used_up)
            break;
        if (!status) {
            if (spared-- <= 0)
                fail_msg("allocation %ld failed, and nobody says so", failures);
            continue;
        }
        if (status != SHAPE_ERROR_MEMORY && !other_errors)
            fail_msg("allocation %ld failed: status %d, \"%s\"", failures, (int)status, error.text);
        if (status == SHAPE_ERROR_MEMORY)
            assert_non_null(strstr(error.text, "memory"));
        assert_true(error.text[0] && !strchr(error.text, '\n'));
        assert_true(failures < 1000);
    }
    assert_true(failures >= at_least);
}

#endif
