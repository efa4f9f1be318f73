/* Files of programs: outputs that appear whole, clouds in and out. */
#include "cli.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "shape/file.h"
#include "shape/neph.h"

enum { MAX_SET_FILE = 0x40000000 };

void cli_write(const cli_common *common, const void *bytes, size_t size, bool binary)
{
    shape_error error;
    if (strcmp(common->output, "-")) {
        cli_check(shape_file_write(common->output, bytes, size, &error), &error);
        return;
    }
    if (binary && isatty(STDOUT_FILENO))
        cli_fail("will not write binary to a terminal (name a file with -o, or use a pipe)");
    if (fwrite(bytes, 1, size, stdout) != size || fflush(stdout))
        cli_fail("standard output: cannot write: %s", strerror(errno));
}

void cli_write_set(const cli_common *common, const shape_set *set)
{
    shape_error error;
    unsigned char *bytes;
    size_t size;
    cli_check(shape_neph_encode(set, &bytes, &size, &error), &error);
    cli_write(common, bytes, size, true);
    free(bytes);
}

shape_set *cli_read_set(const char *path)
{
    shape_error error;
    unsigned char *bytes;
    size_t size;
    shape_set *set;
    cli_check(shape_file_read(path, MAX_SET_FILE, &bytes, &size, &error), &error);
    if (shape_neph_decode(bytes, size, &set, &error))
        cli_fail("%s: %s", strcmp(path, "-") ? path : "standard input", error.text);
    cli_note_input(path, bytes, size);
    free(bytes);
    return set;
}
