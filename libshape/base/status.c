/* Error text and version. */
#include "shape/status.h"

#include <stdarg.h>
#include <stdio.h>

/* Texts are one line: what a file brought into one, a line break in a name for instance, is shown as '?'. */
static void keep_one_line(char *text)
{
    for (; *text; text++)
        if ((unsigned char)*text < 0x20 || *text == 0x7f)
            *text = '?';
}

shape_status(shape_error_set)(shape_error *error, shape_status status, const char *format, ...)
{
    if (error) {
        va_list arguments;
        va_start(arguments, format);
        error->status = status;
        vsnprintf(error->text, sizeof error->text, format, arguments);
        va_end(arguments);
        keep_one_line(error->text);
    }
    return status;
}

shape_status(shape_error_memory)(shape_error *error)
{
    return shape_error_set(error, SHAPE_ERROR_MEMORY, "not enough memory (make the cloud smaller)");
}

const char *shape_version(void)
{
    return NEPHELE_VERSION;
}

void shape_error_join(const shape_error *own, shape_status *status, shape_error *error)
{
    if (!own->status)
        return;
#pragma omp critical(shape_error_join)
    {
        *status = own->status;
        if (error)
            *error = *own;
    }
}
