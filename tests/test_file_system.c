/* Whole files or none (shape/file.h) when the system fails: a full disk, interrupted and partial calls, folders without
 * nameless files, names that are taken. After a failure the file is as it was, and nothing else lies beside it. */
#include "failing_memory.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include "shape/file.h"

/* --- calls of the system, of which some fail --- */

typedef enum call {
    NAMELESS,
    OPEN,
    READ,
    WRITE,
    CLOSE,
    MODE,
    FLUSH,
    LINK,
    TEMPORARY,
    RENAME,
    RESOLVE,
    CALLS
} call;

static struct {
    int code;  /* its errno */
    int times; /* that it still fails; below 0: always */
} failing[CALLS];
static size_t at_once = SIZE_MAX; /* bytes that go through one call */

static bool fails(call which)
{
    if (!failing[which].times)
        return false;
    failing[which].times -= failing[which].times > 0;
    errno = failing[which].code;
    return true;
}

int __real_open(const char *path, int flags, ...);
int __wrap_open(const char *path, int flags, ...);
int __wrap_open(const char *path, int flags, ...)
{
    if (fails((flags & O_DIRECTORY) == O_DIRECTORY ? NAMELESS : OPEN)) /* O_TMPFILE has its bit */
        return -1;
    return __real_open(path, flags, 0600);
}

ssize_t __real_read(int file, void *bytes, size_t size);
ssize_t __wrap_read(int file, void *bytes, size_t size);
ssize_t __wrap_read(int file, void *bytes, size_t size)
{
    return fails(READ) ? -1 : __real_read(file, bytes, size < at_once ? size : at_once);
}

ssize_t __real_write(int file, const void *bytes, size_t size);
ssize_t __wrap_write(int file, const void *bytes, size_t size);
ssize_t __wrap_write(int file, const void *bytes, size_t size)
{
    return fails(WRITE) ? -1 : __real_write(file, bytes, size < at_once ? size : at_once);
}

int __real_close(int file);
int __wrap_close(int file);
int __wrap_close(int file)
{
    __real_close(file);
    return fails(CLOSE) ? -1 : 0;
}

int __real_fchmod(int file, mode_t mode);
int __wrap_fchmod(int file, mode_t mode);
int __wrap_fchmod(int file, mode_t mode)
{
    return fails(MODE) ? -1 : __real_fchmod(file, mode);
}

int __wrap_fsync(int file);
int __wrap_fsync(int file)
{
    (void)file;
    return fails(FLUSH) ? -1 : 0;
}

int __real_linkat(int from, const char *old, int to, const char *made, int flags);
int __wrap_linkat(int from, const char *old, int to, const char *made, int flags);
int __wrap_linkat(int from, const char *old, int to, const char *made, int flags)
{
    return fails(LINK) ? -1 : __real_linkat(from, old, to, made, flags);
}

int __real_mkstemp(char *path);
int __wrap_mkstemp(char *path);
int __wrap_mkstemp(char *path)
{
    return fails(TEMPORARY) ? -1 : __real_mkstemp(path);
}

int __real_rename(const char *old, const char *made);
int __wrap_rename(const char *old, const char *made);
int __wrap_rename(const char *old, const char *made)
{
    return fails(RENAME) ? -1 : __real_rename(old, made);
}

char *__wrap_realpath(const char *path, char *resolved);
char *__wrap_realpath(const char *path, char *resolved)
{
    assert_null(resolved);
    if (fails(RESOLVE))
        return NULL;
    char *copy = malloc(strlen(path) + 1);
    errno = ENOMEM;
    return copy ? strcpy(copy, path) : NULL;
}

char *__wrap_strdup(const char *text);
char *__wrap_strdup(const char *text)
{
    char *copy = malloc(strlen(text) + 1);
    errno = ENOMEM;
    return copy ? strcpy(copy, text) : NULL;
}

/* --- a folder of one file --- */

static char folder[64], path[128];
static const char before[] = "as it was", after[] = "as it shall be";

static void put_before(void)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(before, 1, sizeof before, file), sizeof before);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(chmod(path, 0640), 0);
}

static int make_folder(void **state)
{
    (void)state;
    strcpy(folder, "/tmp/file_system.XXXXXX");
    if (!mkdtemp(folder))
        return -1;
    snprintf(path, sizeof path, "%s/a.neph", folder);
    return 0;
}

static int drop_folder(void **state)
{
    (void)state;
    unlink(path);
    return rmdir(folder);
}

static int files_in_folder(void)
{
    DIR *listing = opendir(folder);
    int count = 0;
    assert_non_null(listing);
    for (struct dirent *entry; (entry = readdir(listing));)
        count += entry->d_name[0] != '.';
    closedir(listing);
    return count;
}

static void expect_content(const char *wanted, size_t size)
{
    unsigned char *bytes;
    size_t got;
    shape_error error;
    struct stat info;
    assert_int_equal(shape_file_read(path, 1000, &bytes, &got, &error), SHAPE_OK);
    assert_int_equal(got, size);
    assert_memory_equal(bytes, wanted, size);
    free(bytes);
    assert_int_equal(stat(path, &info), 0);
    assert_int_equal(info.st_mode & 07777, 0640); /* kept, too */
    assert_int_equal(files_in_folder(), 1);
}

static void fail_at(call which, int code, int count)
{
    failing[which].code = code;
    failing[which].times = count;
}

static shape_status write_after(shape_error *error)
{
    shape_status status = shape_file_write(path, after, sizeof after, error);
    memset(failing, 0, sizeof failing);
    return status;
}

/* --- writing --- */

static void test_failed_writing_changes_nothing(void **state)
{
    (void)state;
    static const struct {
        call call;
        int code;
    } failures[] = {{WRITE, ENOSPC}, {MODE, EPERM}, {FLUSH, EIO}, {RENAME, EACCES}, {RESOLVE, ELOOP}};
    for (size_t i = 0; i < sizeof failures / sizeof *failures; i++) {
        shape_error error = {.text = ""};
        put_before();
        fail_at(failures[i].call, failures[i].code, 1);
        assert_int_equal(write_after(&error), SHAPE_ERROR_IO);
        assert_non_null(strstr(error.text, path));
        assert_non_null(strstr(error.text, strerror(failures[i].code)));
        expect_content(before, sizeof before);
    }
}

/* Where the system has no nameless files, or cannot name them, a hidden name is taken; the same failures then. */
static void test_named_temporaries(void **state)
{
    (void)state;
    shape_error error;
    const call ways[] = {NAMELESS, LINK};
    for (int i = 0; i < 2; i++) {
        put_before();
        fail_at(ways[i], i ? ENOENT : EOPNOTSUPP, -1);
        assert_int_equal(write_after(&error), SHAPE_OK);
        expect_content(after, sizeof after);
    }
    put_before();
    fail_at(LINK, EEXIST, 3); /* names that are taken: the next one */
    assert_int_equal(write_after(&error), SHAPE_OK);
    expect_content(after, sizeof after);
    put_before();
    fail_at(LINK, EEXIST, -1); /* all of them */
    assert_int_equal(write_after(&error), SHAPE_OK);
    expect_content(after, sizeof after);
}

static void test_failed_named_temporaries(void **state)
{
    (void)state;
    static const struct {
        call call;
        int code;
    } failures[] = {{TEMPORARY, EROFS}, {WRITE, ENOSPC}, {MODE, EPERM},
                    {FLUSH, EIO},       {CLOSE, EDQUOT}, {RENAME, EACCES}};
    for (size_t i = 0; i < sizeof failures / sizeof *failures; i++) {
        shape_error error = {.text = ""};
        put_before();
        fail_at(NAMELESS, EOPNOTSUPP, -1);
        fail_at(failures[i].call, failures[i].code, 1);
        assert_int_equal(write_after(&error), SHAPE_ERROR_IO);
        assert_non_null(strstr(error.text, strerror(failures[i].code)));
        expect_content(before, sizeof before);
    }
    shape_error error = {.text = ""};
    char gone[192];
    snprintf(gone, sizeof gone, "%s/none/a.neph", folder);
    assert_int_equal(shape_file_write(gone, after, sizeof after, &error), SHAPE_ERROR_IO);
    assert_non_null(strstr(error.text, strerror(ENOENT)));
    assert_int_equal(shape_file_write(folder, after, sizeof after, &error), SHAPE_ERROR_IO);
    assert_non_null(strstr(error.text, "is a folder"));
}

static void test_pieces_and_interruptions(void **state)
{
    (void)state;
    shape_error error;
    put_before();
    at_once = 3;
    fail_at(WRITE, EINTR, 2);
    assert_int_equal(write_after(&error), SHAPE_OK);
    expect_content(after, sizeof after); /* read three bytes at a time */
    at_once = SIZE_MAX;
    fail_at(READ, EINTR, 2);
    expect_content(after, sizeof after);
    assert_int_equal(failing[READ].times, 0);
}

/* What is no file of a disk is written to as it stands. */
static void test_devices(void **state)
{
    (void)state;
    shape_error error = {.text = ""};
    assert_int_equal(shape_file_write("/dev/null", after, sizeof after, &error), SHAPE_OK);
    static const struct {
        call call;
        int code;
        const char *words;
    } failures[] = {{OPEN, EACCES, "open for writing"}, {WRITE, ENOSPC, "write"}, {CLOSE, EIO, "write"}};
    for (size_t i = 0; i < 3; i++) {
        fail_at(failures[i].call, failures[i].code, 1);
        assert_int_equal(shape_file_write("/dev/null", after, sizeof after, &error), SHAPE_ERROR_IO);
        assert_non_null(strstr(error.text, failures[i].words));
        assert_non_null(strstr(error.text, strerror(failures[i].code)));
    }
}

/* A name without a folder stands in the current one. */
static void test_current_folder(void **state)
{
    (void)state;
    shape_error error;
    char here[512];
    put_before();
    assert_non_null(getcwd(here, sizeof here));
    assert_int_equal(chdir(folder), 0);
    shape_status status = shape_file_write("a.neph", after, sizeof after, &error);
    assert_int_equal(chdir(here), 0);
    assert_int_equal(status, SHAPE_OK);
    expect_content(after, sizeof after);
}

/* --- reading --- */

static void test_failed_reading(void **state)
{
    (void)state;
    shape_error error = {.text = ""};
    unsigned char *bytes = NULL;
    size_t size;
    put_before();
    fail_at(READ, EIO, 1);
    assert_int_equal(shape_file_read(path, 1000, &bytes, &size, &error), SHAPE_ERROR_IO);
    assert_non_null(strstr(error.text, "cannot read"));
    assert_int_equal(shape_file_read(folder, 1000, &bytes, &size, &error), SHAPE_ERROR_IO);
    assert_int_equal(shape_file_read("/tmp/none/at/all", 1000, &bytes, &size, &error), SHAPE_ERROR_IO);
    assert_non_null(strstr(error.text, "cannot open"));
    assert_int_equal(shape_file_read(path, sizeof before - 1, &bytes, &size, &error), SHAPE_ERROR_LIMIT);
    assert_int_equal(shape_file_read("/dev/zero", 5000, &bytes, &size, &error), SHAPE_ERROR_LIMIT);
    assert_non_null(strstr(error.text, "limit of 5000 bytes"));
    assert_null(bytes);
    assert_int_equal(shape_file_read("/dev/null", 0, &bytes, &size, &error), SHAPE_OK);
    assert_int_equal(size, 0);
    free(bytes);
}

/* --- memory --- */

static shape_status write_and_read(shape_error *error)
{
    unsigned char *bytes;
    size_t size;
    shape_status status = shape_file_write(path, after, sizeof after, error);
    if (!status)
        status = shape_file_read(path, 1000, &bytes, &size, error);
    if (!status)
        free(bytes);
    return status;
}

static shape_status write_new(shape_error *error)
{
    unlink(path);
    return write_and_read(error);
}

static void test_memory_runs_out(void **state)
{
    (void)state;
    put_before();
    fail_each(write_and_read, 3, 0);
    fail_each(write_new, 3, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_failed_writing_changes_nothing),
                                       cmocka_unit_test(test_named_temporaries),
                                       cmocka_unit_test(test_failed_named_temporaries),
                                       cmocka_unit_test(test_pieces_and_interruptions),
                                       cmocka_unit_test(test_devices),
                                       cmocka_unit_test(test_current_folder),
                                       cmocka_unit_test(test_failed_reading),
                                       cmocka_unit_test(test_memory_runs_out)};
    return cmocka_run_group_tests(tests, make_folder, drop_folder);
}
