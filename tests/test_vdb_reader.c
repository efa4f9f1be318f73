/* The process that reads .vdb files, and the one that waits for it, when calls of the system fail, when memory is out, and
 * when what comes through the pipe is not what a sound reader sends: one line of error or a sound grid, never harm. */
#include "failing_memory.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/types.h>
#include <unistd.h>

#include "shape/vdb_read.h"

/* Three grids of numbers beside each other; two of them serve as its colour. */
static const char path[] = TEST_DATA "/frozen/vdb/several.vdb";

/* --- calls of the system that fail, and a stream that is played again --- */

static bool playing, pipe_fails, fork_fails;
static int interruptions;     /* so many times each call is interrupted before it goes on */
static long writes_left = -1; /* of the reader, before one fails; below 0: none does */
static int end_by;            /* the signal that ends a reader which is played; 0: none */
static unsigned char stream[1 << 18];
static size_t stream_size, stream_at, first_read;

static bool interrupted(void)
{
    if (interruptions <= 0)
        return false;
    interruptions--;
    errno = EINTR;
    return true;
}

int __real_pipe(int ends[2]);
int __wrap_pipe(int ends[2]);
int __wrap_pipe(int ends[2])
{
    errno = EMFILE;
    return pipe_fails ? -1 : __real_pipe(ends);
}

pid_t __real_fork(void);
pid_t __wrap_fork(void);
pid_t __wrap_fork(void)
{
    errno = EAGAIN;
    return fork_fails ? -1 : playing ? 1 : __real_fork();
}

pid_t __real_waitpid(pid_t child, int *how, int options);
pid_t __wrap_waitpid(pid_t child, int *how, int options);
pid_t __wrap_waitpid(pid_t child, int *how, int options)
{
    if (interrupted())
        return -1;
    if (!playing)
        return __real_waitpid(child, how, options);
    *how = end_by;
    return child;
}

ssize_t __real_write(int file, const void *bytes, size_t size);
ssize_t __wrap_write(int file, const void *bytes, size_t size);
ssize_t __wrap_write(int file, const void *bytes, size_t size)
{
    if (interrupted())
        return -1;
    errno = EPIPE;
    return writes_left >= 0 && writes_left-- == 0 ? -1 : __real_write(file, bytes, size);
}

ssize_t __real_read(int file, void *bytes, size_t size);
ssize_t __wrap_read(int file, void *bytes, size_t size);
ssize_t __wrap_read(int file, void *bytes, size_t size)
{
    if (interrupted())
        return -1;
    if (playing) {
        size_t left = stream_size - stream_at, taken = size < left ? size : left;
        memcpy(bytes, stream + stream_at, taken);
        stream_at += taken;
        return (ssize_t)taken;
    }
    ssize_t got = __real_read(file, bytes, size);
    if (got > 0) {
        if (!stream_at)
            first_read = size; /* of the whole head */
        assert_true(stream_at + (size_t)got <= sizeof stream);
        memcpy(stream + stream_at, bytes, (size_t)got);
        stream_at += (size_t)got;
    }
    return got;
}

/* --- reading --- */

static bool coloured;

static shape_status read_it(shape_vdb_contents *contents, shape_error *error)
{
    shape_vdb_read_options options = shape_vdb_read_defaults();
    options.max_bytes = (size_t)16 << 20;
    options.shown = "shown.vdb";
    options.grid = "density";
    if (coloured)
        options.colour = "density,heat,heat";
    stream_at = 0;
    return shape_vdb_read(path, &options, contents, error);
}

/* As a grid that may be looked at without harm. */
static void check_grid(const shape_grid *grid)
{
    shape_vec3 middle = {0.5f * (float)grid->points[0], 0.5f * (float)grid->points[1],
                         0.5f * (float)grid->points[2]};
    float value = shape_grid_sample(grid, middle), rgb[3];
    assert_true(value >= 0 && value <= grid->most);
    assert_true(isfinite(shape_grid_sum(grid)));
    shape_grid_colour(grid, middle, rgb);
    for (int c = 0; c < 3; c++)
        assert_true(rgb[c] >= 0 && isfinite(rgb[c]));
    assert_true(grid->gain == 1 && grid->users == 1);
}

static shape_status read_and_drop(shape_error *error)
{
    shape_vdb_contents contents;
    shape_status status = read_it(&contents, error);
    if (!status) {
        check_grid(contents.grid);
        shape_grid_release(contents.grid);
    } else {
        assert_non_null(strstr(error->text, "shown.vdb"));
        assert_null(strchr(error->text, '\n'));
    }
    return status;
}

static void expect(shape_status wanted, const char *words)
{
    shape_error error = {.text = ""};
    assert_int_equal(read_and_drop(&error), wanted);
    if (!strstr(error.text, words))
        fail_msg("\"%s\" does not say \"%s\"", error.text, words);
}

static void record(bool with_colour)
{
    shape_error error;
    coloured = with_colour;
    playing = false;
    if (read_and_drop(&error))
        fail_msg("%s", error.text);
    stream_size = stream_at;
    assert_true(first_read > 1000 && stream_size > first_read);
}

/* --- tests --- */

static void test_calls_fail(void **state)
{
    (void)state;
    shape_vdb_contents contents;
    shape_vdb_read_options options = shape_vdb_read_defaults();
    shape_error error;
    record(false);
    pipe_fails = true;
    expect(SHAPE_ERROR_SYSTEM, "no pipe to read it through");
    pipe_fails = false;
    fork_fails = true;
    expect(SHAPE_ERROR_SYSTEM, "no process to read it in");
    fork_fails = false;
    interruptions = 3; /* both processes: written, read and waited for again */
    expect(SHAPE_OK, "");
    interruptions = 0;
    assert_int_equal(shape_vdb_read("/tmp", &options, &contents, &error), SHAPE_ERROR_IO);
    assert_non_null(strstr(error.text, "/tmp: cannot read it"));
}

/* A reader whose n-th write fails ends, and this process says that the file cannot be read. */
static void test_reader_cannot_write(void **state)
{
    (void)state;
    record(true);
    int failures = 0;
    for (;; failures++) {
        shape_error error = {.text = ""};
        writes_left = failures;
        shape_status status = read_and_drop(&error);
        writes_left = -1;
        if (!status)
            break;
        assert_int_equal(status, SHAPE_ERROR_FORMAT);
        assert_non_null(strstr(error.text, "damaged or cut short"));
    }
    assert_int_equal(failures, 1 + 4 * 5); /* the head, and five arrays of the density and of each channel */
}

/* Fewer seconds than a reader would be given hold for it, too. */
static void test_limits_of_ours_hold(void **state)
{
    (void)state;
    struct rlimit before, less;
    assert_int_equal(getrlimit(RLIMIT_CPU, &before), 0);
    less = before;
    less.rlim_cur = 9;
    record(false);
    assert_int_equal(setrlimit(RLIMIT_CPU, &less), 0);
    shape_error error = {.text = ""};
    shape_status status = read_and_drop(&error);
    assert_int_equal(setrlimit(RLIMIT_CPU, &before), 0);
    assert_int_equal(status, SHAPE_OK);
}

static void test_reader_is_ended(void **state)
{
    (void)state;
    record(false);
    playing = true;
    stream_size = 0;
    expect(SHAPE_ERROR_FORMAT, "damaged or cut short");
    end_by = SIGXCPU;
    expect(SHAPE_ERROR_LIMIT, "of processor time");
    end_by = SIGSEGV;
    expect(SHAPE_ERROR_FORMAT, "damaged or cut short");
    end_by = 0;
    playing = false;
}

static void test_stream_is_cut(void **state)
{
    (void)state;
    record(true);
    size_t whole = stream_size;
    playing = true;
    expect(SHAPE_OK, "");
    for (size_t n = 0; n < whole; n += n < first_read ? first_read / 3 : whole / 50) {
        stream_size = n;
        expect(SHAPE_ERROR_FORMAT, "damaged or cut short");
    }
    playing = false;
}

/* Each word of the head, and some of what follows, as a reader with damaged memory may send it. */
static void test_stream_is_damaged(void **state)
{
    (void)state;
    static const uint32_t words[] = {0xffffffff, 0, 1, 0x7fc00000, 0x80000000, 0x7f800000, 0x00010101};
    size_t refused = 0;
    for (int c = 0; c < 2; c++) {
        record(c);
        playing = true;
        for (size_t at = 0; at + 4 <= stream_size; at += at < first_read ? 4 : stream_size / 400 * 4)
            for (size_t w = 0; w < sizeof words / sizeof *words; w++) {
                uint32_t kept;
                shape_error error = {.text = ""};
                memcpy(&kept, stream + at, 4);
                memcpy(stream + at, &words[w], 4);
                refused += read_and_drop(&error) != SHAPE_OK;
                memcpy(stream + at, &kept, 4);
            }
        playing = false;
    }
    assert_true(refused > 200);
}

static void test_memory_is_out(void **state)
{
    (void)state;
    record(true);
    playing = true;
    other_errors = 1;                   /* it is taken for a stream that is cut */
    fail_each(read_and_drop, 4 * 6, 0); /* four grids: each itself, and its five arrays */
    other_errors = 0;
    playing = false;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_calls_fail),          cmocka_unit_test(test_reader_cannot_write),
        cmocka_unit_test(test_limits_of_ours_hold), cmocka_unit_test(test_reader_is_ended),
        cmocka_unit_test(test_stream_is_cut),       cmocka_unit_test(test_stream_is_damaged),
        cmocka_unit_test(test_memory_is_out)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
