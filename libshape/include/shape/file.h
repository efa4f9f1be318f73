/* Whole files in and out. */
#ifndef SHAPE_FILE_H
#define SHAPE_FILE_H

#include <stddef.h>

#include "shape/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Reads a file, or standard input where path is "-", into memory that the caller frees with free(). One zero byte
 * stands behind the contents, not counted in *size. More than max_size bytes: SHAPE_ERROR_LIMIT. The error names the
 * file. */
shape_status shape_file_read(const char *path, size_t max_size, unsigned char **bytes, size_t *size,
                             shape_error *error);

/* Writes a file that appears whole or not at all: beside the target under a temporary name, flushed to the disk, then
 * renamed. An existing file keeps its permissions; on an error it stays as it was and no temporary file is left. A
 * path that is not a regular file (a pipe, /dev/null) is written directly. */
shape_status shape_file_write(const char *path, const void *bytes, size_t size, shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
