/* Puts memory that survives a fork as one under libFuzzer's counters, so that what another process meets guides the fuzzer.
 * Not instrumented itself: clang would give its own symbols other names. */
#define _DEFAULT_SOURCE /* MAP_ANONYMOUS */
#include <stdbool.h>
#include <stdint.h>
#include <sys/mman.h>
#include <unistd.h>

bool share_counters(void);

/* The counters of -fsanitize-coverage=inline-8bit-counters, one after the other. */
extern uint8_t __start___sancov_cntrs[], __stop___sancov_cntrs[];

/* Whole pages, since other variables stand beside them. */
bool share_counters(void)
{
    uintptr_t page = (uintptr_t)sysconf(_SC_PAGESIZE);
    uintptr_t start = ((uintptr_t)__start___sancov_cntrs + page - 1) / page * page;
    uintptr_t stop = (uintptr_t)__stop___sancov_cntrs / page * page;
    return start < stop && mmap((void *)start, stop - start, PROT_READ | PROT_WRITE,
                                MAP_SHARED | MAP_ANONYMOUS | MAP_FIXED, -1, 0) == (void *)start;
}
