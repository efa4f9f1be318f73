/* What programs seldom need of OpenVDB: loading it takes longer (45 ms) than a program may take until it shows something, so
 * it is loaded with the first call, as a module that holds the real functions (openvdb_module.c). */
#include <dlfcn.h>
#include <string.h>

#include "shape/mesh.h"
#include "shape/vdb_read.h"

typedef shape_status (*reader)(const char *, const shape_vdb_read_options *, shape_vdb_contents *,
                               shape_error *);
typedef shape_status (*filler)(const shape_mesh *, size_t, int, shape_primitives *, size_t *, shape_error *);

/* A function of the module; NULL where that is not there, and *why says so. */
static void *find(const char *name, const char **why)
{
    /* Stays loaded: OpenVDB registers its types, once. Found by the program's run path. */
    void *module = dlopen(NEPHELE_OPENVDB_MODULE, RTLD_NOW | RTLD_LOCAL);
    void *symbol = module ? dlsym(module, name) : NULL;
    if (!symbol)
        *why = dlerror();
    return symbol;
}

shape_status shape_vdb_read(const char *path, const shape_vdb_read_options *options,
                            shape_vdb_contents *contents, shape_error *error)
{
    const char *why;
    reader read = NULL;
    void *symbol = find("nephele_vdb_read", &why);
    memset(contents, 0, sizeof *contents);
    if (!symbol)
        return shape_error_set(error, SHAPE_ERROR_SYSTEM,
                               "%s: cannot be read, since OpenVDB is not there: %s (install it)",
                               options->shown ? options->shown : path, why);
    memcpy(&read, &symbol, sizeof read); /* ISO C knows no such cast */
    return read(path, options, contents, error);
}

shape_status shape_mesh_fill(const shape_mesh *mesh, size_t count, int resolution, shape_primitives *list,
                             size_t *made, shape_error *error)
{
    const char *why;
    filler fill = NULL;
    void *symbol = find("nephele_mesh_fill", &why);
    *made = 0;
    if (!symbol)
        return shape_error_set(error, SHAPE_ERROR_SYSTEM,
                               "cannot be filled, since OpenVDB is not there: %s (install it)", why);
    memcpy(&fill, &symbol, sizeof fill);
    return fill(mesh, count, resolution, list, made, error);
}
