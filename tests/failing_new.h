/* For tests: C++'s new runs out like malloc does (failing_memory.h), in the bridges and in the libraries behind them. A
 * thrown std::bad_alloc goes through this file's functions, whose tables for unwinding every platform of ours has. */
#ifndef FAILING_NEW_H
#define FAILING_NEW_H

#include "failing_memory.h"

void *_Znwm(size_t size);
void *_Znam(size_t size);
void *_ZnwmRKSt9nothrow_t(size_t size, const void *nothrow);
void *_ZnamRKSt9nothrow_t(size_t size, const void *nothrow);
void _ZdlPv(void *block);
void _ZdaPv(void *block);
void _ZdlPvm(void *block, size_t size);
void _ZdaPvm(void *block, size_t size);
void _ZSt17__throw_bad_allocv(void) __attribute__((noreturn));

void *_Znwm(size_t size)
{
    void *block = malloc(size ? size : 1);
    if (!block)
        _ZSt17__throw_bad_allocv();
    return block;
}

void *_Znam(size_t size)
{
    return _Znwm(size);
}

void *_ZnwmRKSt9nothrow_t(size_t size, const void *nothrow)
{
    (void)nothrow;
    return malloc(size ? size : 1);
}

void *_ZnamRKSt9nothrow_t(size_t size, const void *nothrow)
{
    return _ZnwmRKSt9nothrow_t(size, nothrow);
}

void _ZdlPv(void *block)
{
    free(block);
}

void _ZdaPv(void *block)
{
    free(block);
}

void _ZdlPvm(void *block, size_t size)
{
    (void)size;
    free(block);
}

void _ZdaPvm(void *block, size_t size)
{
    (void)size;
    free(block);
}

#endif
