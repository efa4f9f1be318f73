/* To be preloaded: from the first call of poptGetContext on (where a program begins to work; what libraries do before
 * that is not its), the allocation of number NEPHELE_FAIL, counted from 0, fails, whoever asks: the program, libpng, zlib,
 * OpenEXR, jansson, popt, C++. Without it none fails. NEPHELE_COUNT names a file that gets the number of allocations. */
#include <dlfcn.h>
#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);
void *__libc_memalign(size_t alignment, size_t size);
void *poptGetContext(const char *name, int argc, const char **argv, const void *options, unsigned int flags);
void *memalign(size_t alignment, size_t size);

static long failing = -1, asked;
static int counting;

static int refuse(void)
{
    return __atomic_load_n(&counting, __ATOMIC_RELAXED) &&
           __atomic_fetch_add(&asked, 1, __ATOMIC_RELAXED) == failing;
}

static void *none(void)
{
    errno = ENOMEM;
    return NULL;
}

void *malloc(size_t size)
{
    return refuse() ? none() : __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    return refuse() ? none() : __libc_calloc(count, size);
}

void *realloc(void *old, size_t size)
{
    return refuse() ? none() : __libc_realloc(old, size);
}

void *memalign(size_t alignment, size_t size)
{
    return refuse() ? none() : __libc_memalign(alignment, size);
}

void *aligned_alloc(size_t alignment, size_t size)
{
    return memalign(alignment, size);
}

int posix_memalign(void **block, size_t alignment, size_t size)
{
    void *made = memalign(alignment, size);
    if (!made)
        return ENOMEM;
    *block = made;
    return 0;
}

void *poptGetContext(const char *name, int argc, const char **argv, const void *options, unsigned int flags)
{
    void *(*real)(const char *, int, const char **, const void *, unsigned int) = NULL;
    *(void **)&real = dlsym(RTLD_NEXT, "poptGetContext");
    const char *text = getenv("NEPHELE_FAIL");
    failing = text ? atol(text) : -1;
    counting = 1;
    return real ? real(name, argc, argv, options, flags) : NULL;
}

__attribute__((destructor)) static void tell(void)
{
    const char *path = getenv("NEPHELE_COUNT");
    counting = 0;
    FILE *file = path ? fopen(path, "w") : NULL;
    if (!file)
        return;
    fprintf(file, "%ld\n", asked);
    fclose(file);
}
