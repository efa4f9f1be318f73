/* Any bytes as an OpenVDB file, read as the programs read them: in a process of its own, with limits. Whatever becomes of
 * that process, here it is one line or a sound grid. The branches that the process takes in the bridge, and in what the
 * bridge makes of OpenVDB's templates, are counted in memory that both processes share, and so guide the fuzzer; OpenVDB's
 * own library counts nothing. The mutator keeps the head of the file, without which nothing is read. */
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "shape/vdb_read.h"

enum { HEAD = 12, MOST_BYTES = 64 << 20 };

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size);
bool share_counters(void);
int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed);
void __sanitizer_set_death_callback(void (*callback)(void));

static char path[] = "/tmp/nephele-fuzz-XXXXXX";

static void must(int truth)
{
    if (!truth)
        abort();
}

/* The reader dies as it would in a program: the fuzzer's own handlers are for this process. */
static void die_plainly(void)
{
    static const int signals[] = {SIGSEGV, SIGBUS, SIGABRT, SIGILL, SIGFPE, SIGALRM, SIGTERM, SIGXCPU};
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
        signal(signals[i], SIG_DFL);
    __sanitizer_set_death_callback(NULL);
}

static void remove_file(void)
{
    unlink(path);
}

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    (void)argc;
    (void)argv;
    must(share_counters());
    int file = mkstemp(path);
    must(file >= 0 && !close(file) && !atexit(remove_file) && !pthread_atfork(NULL, NULL, die_plainly));
    return 0;
}

static void check(const shape_vdb_contents *contents)
{
    const shape_grid *grid = contents->grid;
    shape_frame inverse;
    must(grid->most > 0 && isfinite(grid->most));
    for (int i = 0; i < 12; i++)
        must(isfinite(contents->frame.m[i / 4][i % 4]));
    must(shape_frame_invert(&contents->frame, &inverse));
    must(strlen(contents->name) <= SHAPE_NAME_MAX);
    for (int i = 0; i < 64; i++) { /* within, at the faces and outside */
        shape_vec3 p = {(float)grid->points[0] * (float)(i % 4) / 3,
                        (float)grid->points[1] * (float)(i / 4 % 4) / 3,
                        (float)grid->points[2] * (float)(i / 16) / 3};
        float value = shape_grid_sample(grid, p);
        must(value >= 0 && value <= grid->most * 1.0001f);
    }
    must(shape_grid_sum(grid) > 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    shape_error error = {0};
    shape_vdb_contents contents;
    shape_vdb_read_options options = shape_vdb_read_defaults();
    options.max_bytes = MOST_BYTES;
    FILE *file = fopen(path, "wb");
    must(file && fwrite(data, 1, size, file) == size && !fclose(file));
    if (shape_vdb_read(path, &options, &contents, &error)) {
        must(!strncmp(error.text, path, strlen(path)) && !strchr(error.text, '\n'));
        return 0;
    }
    check(&contents);
    shape_grid_release(contents.grid);
    return 0;
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed)
{
    uint8_t head[HEAD];
    if (size < HEAD || seed % 16 == 15)
        return LLVMFuzzerMutate(data, size, max_size);
    memcpy(head, data, HEAD);
    size = LLVMFuzzerMutate(data, size, max_size);
    if (size < HEAD)
        size = HEAD;
    memcpy(data, head, HEAD);
    return size;
}
