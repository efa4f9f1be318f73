// What programs seldom need of OpenVDB: loading it takes longer (45 ms) than a program may take until it shows something, so
// it is loaded with the first call, as a module that holds the real functions (openvdb_module.c).
#include <cstring>

#include <dlfcn.h>

#include "orderly_end.hpp"
#include "shape/mesh.h"
#include "shape/vdb_read.h"

namespace
{

// A function of the module; null where that is not there, and *why says so.
template <typename Function> Function find(const char *name, const char **why)
{
    // The libraries' own beginnings ask for memory, and what they throw cannot be caught through the loader.
    const OrderlyEnd guard("to load OpenVDB");
    // Stays loaded: OpenVDB registers its types, once. Found by the program's run path.
    void *module = dlopen(NEPHELE_OPENVDB_MODULE, RTLD_NOW | RTLD_LOCAL);
    void *symbol = module ? dlsym(module, name) : nullptr;
    if (!symbol)
        *why = dlerror();
    return reinterpret_cast<Function>(symbol);
}

} // namespace

extern "C" shape_status shape_vdb_read(const char *path, const shape_vdb_read_options *options,
                                       shape_vdb_contents *contents, shape_error *error)
{
    const char *why = "";
    auto read = find<decltype(&shape_vdb_read)>("nephele_vdb_read", &why);
    std::memset(contents, 0, sizeof *contents);
    if (!read)
        return shape_error_set(error, SHAPE_ERROR_SYSTEM,
                               "%s: cannot be read, since OpenVDB is not there: %s (install it)",
                               options->shown ? options->shown : path, why);
    return read(path, options, contents, error);
}

extern "C" shape_status shape_mesh_fill(const shape_mesh *mesh, size_t count, int resolution,
                                        shape_primitives *list, size_t *made, shape_error *error)
{
    const char *why = "";
    auto fill = find<decltype(&shape_mesh_fill)>("nephele_mesh_fill", &why);
    *made = 0;
    if (!fill)
        return shape_error_set(error, SHAPE_ERROR_SYSTEM,
                               "cannot be filled, since OpenVDB is not there: %s (install it)", why);
    return fill(mesh, count, resolution, list, made, error);
}
