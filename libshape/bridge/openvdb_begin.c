/* What a reader of OpenVDB files needs without OpenVDB: its defaults, and how such a file begins. */
#include <string.h>

#include "shape/vdb_read.h"

shape_vdb_read_options shape_vdb_read_defaults(void)
{
    shape_vdb_read_options options = {.max_bytes = (size_t)4 << 30};
    return options;
}

bool shape_vdb_is(const void *bytes, size_t size)
{
    return size >= 8 && !memcmp(bytes, " BDV\0\0\0\0", 8);
}
