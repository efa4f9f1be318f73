#define _GNU_SOURCE /* dl_iterate_phdr, RTLD_NEXT */
/* To be preloaded: from the first call of poptGetContext on (where a program begins to work; what libraries do before
 * that is not its), the allocation of number NEPHELE_FAIL, counted from 0, fails, whoever asks: the program, libpng, zlib,
 * OpenEXR, jansson, popt, C++. Without it none fails. NEPHELE_COUNT names a file that gets the number of allocations.
 * NEPHELE_OWN: only what the program's own code asks for counts, not what libraries do (a graphics driver asks a hundred
 * thousand times, and ends the program where it gets nothing). */
#include <dlfcn.h>
#include <errno.h>
#include <link.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);
void *__libc_memalign(size_t alignment, size_t size);
void *poptGetContext(const char *name, int argc, const char **argv, const void *options, unsigned int flags);
void *memalign(size_t alignment, size_t size);

static long failing = -1, asked;
static int counting;
static uintptr_t own_from, own_to; /* the program's addresses; 0, 0: whoever asks */

/* OpenVDB's compression does not look at what it has got, so it always gets it. */
static int is_spared(const void *caller)
{
    Dl_info from;
    return dladdr(caller, &from) && from.dli_fname && strstr(from.dli_fname, "libblosc");
}

static int refuse(const void *caller)
{
    if (!__atomic_load_n(&counting, __ATOMIC_RELAXED))
        return 0;
    if (own_to && ((uintptr_t)caller < own_from || (uintptr_t)caller >= own_to))
        return 0;
    return __atomic_fetch_add(&asked, 1, __ATOMIC_RELAXED) == failing && !is_spared(caller);
}

#define REFUSE() refuse(__builtin_return_address(0))

/* The first of the loaded objects is the program. */
static int find_program(struct dl_phdr_info *info, size_t size, void *data)
{
    (void)size;
    (void)data;
    own_from = UINTPTR_MAX;
    for (int i = 0; i < info->dlpi_phnum; i++)
        if (info->dlpi_phdr[i].p_type == PT_LOAD) {
            uintptr_t from = info->dlpi_addr + info->dlpi_phdr[i].p_vaddr,
                      to = from + info->dlpi_phdr[i].p_memsz;
            own_from = from < own_from ? from : own_from;
            own_to = to > own_to ? to : own_to;
        }
    return 1;
}

static void *none(void)
{
    errno = ENOMEM;
    return NULL;
}

void *malloc(size_t size)
{
    return REFUSE() ? none() : __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    return REFUSE() ? none() : __libc_calloc(count, size);
}

void *realloc(void *old, size_t size)
{
    return REFUSE() ? none() : __libc_realloc(old, size);
}

void *memalign(size_t alignment, size_t size)
{
    return REFUSE() ? none() : __libc_memalign(alignment, size);
}

void *aligned_alloc(size_t alignment, size_t size)
{
    return REFUSE() ? none() : __libc_memalign(alignment, size);
}

int posix_memalign(void **block, size_t alignment, size_t size)
{
    void *made = REFUSE() ? NULL : __libc_memalign(alignment, size);
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
    if (getenv("NEPHELE_OWN"))
        dl_iterate_phdr(find_program, NULL);
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
