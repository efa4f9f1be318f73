/* shape_vdb_read for a program that seldom needs it: loading OpenVDB takes longer (45 ms) than such a program may take until
 * it shows something, so it is loaded with the first file, as a module that holds the real function. */
#include <dlfcn.h>
#include <string.h>

#include "shape/vdb_read.h"

typedef shape_status (*reader)(const char *, const shape_vdb_read_options *, shape_vdb_contents *,
                               shape_error *);

shape_status shape_vdb_read(const char *path, const shape_vdb_read_options *options,
                            shape_vdb_contents *contents, shape_error *error)
{
    reader read = NULL;
    memset(contents, 0, sizeof *contents);
    /* Stays loaded: OpenVDB registers its types, once. Found by the program's run path. */
    void *module = dlopen(NEPHELE_OPENVDB_MODULE, RTLD_NOW | RTLD_LOCAL);
    void *symbol = module ? dlsym(module, "nephele_vdb_read") : NULL;
    if (!symbol)
        return shape_error_set(error, SHAPE_ERROR_SYSTEM,
                               "%s: cannot be read, since OpenVDB is not there: %s (install it)",
                               options->shown ? options->shown : path, dlerror());
    memcpy(&read, &symbol, sizeof read); /* ISO C knows no such cast */
    return read(path, options, contents, error);
}
