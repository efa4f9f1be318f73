/* Whole files in and out: nothing is ever half-written. Where the system can (Linux, O_TMPFILE), a file has no name
 * until all of it is there, so that a program killed in the middle leaves nothing behind. */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE /* O_TMPFILE */
#endif
#include "shape/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"

static shape_status io_error(const char *path, const char *doing, int code, shape_error *error)
{
    return shape_error_set(error, SHAPE_ERROR_IO, "%s: cannot %s: %s", path, doing, strerror(code));
}

static shape_status too_large(const char *path, size_t max_size, shape_error *error)
{
    return shape_error_set(error, SHAPE_ERROR_LIMIT,
                           "%s: larger than the limit of %zu bytes (make it smaller)", path, max_size);
}

static shape_status read_all(int file, const char *path, size_t max_size, unsigned char **bytes, size_t *size,
                             shape_error *error)
{
    unsigned char *buffer = NULL;
    size_t capacity = 0, used = 0;
    struct stat info;
    bool regular = !fstat(file, &info) && S_ISREG(info.st_mode) && info.st_size > 0;
    if (regular && (uintmax_t)info.st_size > max_size)
        return too_large(path, max_size, error);
    if (regular) {
        if (shape_array_reserve((void **)&buffer, &capacity, (size_t)info.st_size + 2, 1, error))
            return SHAPE_ERROR_MEMORY;
    }
    for (;;) {
        if (shape_array_reserve((void **)&buffer, &capacity, used + 4096, 1, error)) {
            free(buffer);
            return SHAPE_ERROR_MEMORY;
        }
        ssize_t got = read(file, buffer + used, capacity - used - 1);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0) {
            int code = errno;
            free(buffer);
            return io_error(path, "read", code, error);
        }
        used += (size_t)got;
        if (used > max_size) {
            free(buffer);
            return too_large(path, max_size, error);
        }
        if (got == 0)
            break;
    }
    buffer[used] = 0;
    *bytes = buffer;
    *size = used;
    return SHAPE_OK;
}

shape_status shape_file_read(const char *path, size_t max_size, unsigned char **bytes, size_t *size,
                             shape_error *error)
{
    if (!strcmp(path, "-"))
        return read_all(STDIN_FILENO, "standard input", max_size, bytes, size, error);
    int file = open(path, O_RDONLY | O_CLOEXEC);
    if (file < 0)
        return io_error(path, "open", errno, error);
    shape_status status = read_all(file, path, max_size, bytes, size, error);
    close(file);
    return status;
}

/* Returns 0 or the errno of what failed. */
static int write_all(int file, const unsigned char *bytes, size_t size)
{
    while (size) {
        ssize_t put = write(file, bytes, size);
        if (put < 0 && errno == EINTR)
            continue;
        if (put < 0)
            return errno;
        bytes += put;
        size -= (size_t)put;
    }
    return 0;
}

static shape_status write_direct(const char *path, const void *bytes, size_t size, shape_error *error)
{
    int file = open(path, O_WRONLY | O_CLOEXEC);
    if (file < 0)
        return io_error(path, "open for writing", errno, error);
    int code = write_all(file, bytes, size);
    if (close(file) && !code)
        code = errno;
    return code ? io_error(path, "write", code, error) : SHAPE_OK;
}

/* Flushes the folder's entry, so that the new name outlives a power cut; a folder that cannot be opened is let be. */
static void flush_folder(const char *path)
{
    char folder[4096];
    const char *slash = strrchr(path, '/');
    int length = slash ? (int)(slash - path) : 1;
    if (length >= (int)sizeof folder)
        return;
    snprintf(folder, sizeof folder, "%.*s", length ? length : 1, slash ? path : ".");
    int file = open(folder, O_RDONLY | O_CLOEXEC);
    if (file >= 0) {
        fsync(file);
        close(file);
    }
}

/* The bytes, the mode and the disk's word that they are there; returns 0 or an errno. */
static int fill(int file, mode_t mode, const void *bytes, size_t size)
{
    int code = fchmod(file, mode) ? errno : write_all(file, bytes, size);
    if (!code && fsync(file))
        code = errno;
    return code;
}

/* Gives the nameless file a name of the pattern of mkstemp, in the same place; false where the system cannot. */
static bool give_name(int file, char *temporary)
{
#ifdef O_TMPFILE
    char source[32];
    char *end = temporary + strlen(temporary) - 6;
    snprintf(source, sizeof source, "/proc/self/fd/%d", file);
    for (unsigned attempt = 0; attempt < 1000; attempt++) {
        snprintf(end, 7, "%06x", ((unsigned)getpid() * 1000u + attempt) & 0xffffffu);
        if (!linkat(AT_FDCWD, source, AT_FDCWD, temporary, AT_SYMLINK_FOLLOW))
            return true;
        if (errno != EEXIST)
            return false;
    }
#else
    (void)file, (void)temporary;
#endif
    return false;
}

/* A file without a name in the folder of `target`, or -1. */
static int open_nameless(char *target)
{
#ifdef O_TMPFILE
    char *slash = strrchr(target, '/'), *cut = slash == target ? slash + 1 : slash, kept = cut ? *cut : 0;
    if (cut)
        *cut = 0;
    int file = open(cut ? target : ".", O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600);
    if (cut)
        *cut = kept;
    return file;
#else
    (void)target;
    return -1;
#endif
}

/* Writes a file of a name that ends in XXXXXX, which are replaced; *temporary is its name if 0 is returned, and no such
 * file is left otherwise. */
static int write_temporary(char *target, char *temporary, mode_t mode, const void *bytes, size_t size)
{
    int file = open_nameless(target), code = 0;
    if (file >= 0) {
        code = fill(file, mode, bytes, size);
        bool named = !code && give_name(file, temporary);
        close(file);
        if (code || named)
            return code;
        memset(temporary + strlen(temporary) - 6, 'X', 6);
    }
    file = mkstemp(temporary);
    if (file < 0)
        return errno;
    code = fill(file, mode, bytes, size);
    if (close(file) && !code)
        code = errno;
    if (code)
        unlink(temporary);
    return code;
}

shape_status shape_file_write(const char *path, const void *bytes, size_t size, shape_error *error)
{
    struct stat info;
    bool exists = !stat(path, &info);
    if (exists && S_ISDIR(info.st_mode))
        return shape_error_set(error, SHAPE_ERROR_IO, "%s: is a folder (name a file)", path);
    if (exists && !S_ISREG(info.st_mode))
        return write_direct(path, bytes, size, error);
    /* A link keeps pointing where it points: the file behind it is replaced. */
    char *target = exists ? realpath(path, NULL) : strdup(path);
    if (!target)
        return errno == ENOMEM ? shape_error_memory(error) : io_error(path, "resolve", errno, error);
    size_t room = strlen(target) + sizeof ".XXXXXX";
    char *temporary = malloc(room);
    if (!temporary) {
        free(target);
        return shape_error_memory(error);
    }
    snprintf(temporary, room, "%s.XXXXXX", target);
    mode_t mask = umask(0);
    umask(mask);
    int code = write_temporary(target, temporary, exists ? info.st_mode & 07777 : 0666 & ~mask, bytes, size);
    if (!code && rename(temporary, target)) {
        code = errno;
        unlink(temporary);
    }
    if (!code)
        flush_folder(target);
    free(temporary);
    free(target);
    return code ? io_error(path, "write", code, error) : SHAPE_OK;
}
