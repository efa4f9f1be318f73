// glTF 2.0 accessors (section 3.6.2): bytes to numbers. The file is not trusted: nothing is read before the bytes it
// names are known to be there.
#include "gltf_private.hpp"

#include <cmath>
#include <cstring>

namespace shape_gltf
{
namespace
{

struct Bytes {
    const unsigned char *data;
    size_t size;
};

Bytes view_bytes(const tinygltf::Model &model, int index)
{
    const tinygltf::BufferView &view = at(model.bufferViews, index, "bufferView");
    for (const char *extension : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
        if (view.extensions.count(extension))
            throw Problem("is compressed by " + std::string(extension) + " (export it without compression)");
    const tinygltf::Buffer &buffer = at(model.buffers, view.buffer, "buffer");
    if (view.byteOffset > buffer.data.size() || view.byteLength > buffer.data.size() - view.byteOffset)
        throw Problem("bufferView " + std::to_string(index) + " reaches beyond its buffer of " +
                      std::to_string(buffer.data.size()) + " bytes (the file is damaged or cut off)");
    return {buffer.data.data() + view.byteOffset, view.byteLength};
}

size_t component_size(int type)
{
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return 4;
    default:
        throw Problem("has an accessor of the unknown component type " + std::to_string(type));
    }
}

template <class T> double load(const unsigned char *from)
{
    T value;
    std::memcpy(&value, from, sizeof value);
    return double(value);
}

// One component. Buffers are little-endian, as is every system that the project runs on.
double component(const unsigned char *from, int type, bool normalized)
{
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
        return normalized ? std::fmax(load<int8_t>(from) / 127, -1) : load<int8_t>(from);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return load<uint8_t>(from) / (normalized ? 255 : 1);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
        return normalized ? std::fmax(load<int16_t>(from) / 32767, -1) : load<int16_t>(from);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return load<uint16_t>(from) / (normalized ? 65535 : 1);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return load<uint32_t>(from);
    default:
        return load<float>(from);
    }
}

// The first byte of `count` elements of `size` bytes, each `stride` after the other.
const unsigned char *check_range(Bytes bytes, size_t offset, size_t count, size_t stride, size_t size,
                                 const char *what)
{
    // count - 1 elements of a stride and one of its size; count is at most SHAPE_MESH_MAX_*, stride below 2^32.
    size_t needed = count ? (count - 1) * stride + size : 0;
    if (offset > bytes.size || needed > bytes.size - offset)
        throw Problem(std::string("its ") + what + " need " + std::to_string(needed) + " bytes from byte " +
                      std::to_string(offset) + " of a bufferView that holds " + std::to_string(bytes.size) +
                      " (the file is damaged or cut off)");
    return bytes.data + offset;
}

size_t checked_offset(long long offset)
{
    if (offset < 0)
        throw Problem("has a negative byteOffset");
    return size_t(offset);
}

void put_sparse(const tinygltf::Model &model, const tinygltf::Accessor &accessor, size_t width,
                std::vector<double> &values, const char *what)
{
    const auto &sparse = accessor.sparse;
    if (sparse.count < 0 || size_t(sparse.count) > accessor.count)
        throw Problem("has a sparse accessor with more elements than it has in all");
    size_t count = size_t(sparse.count), index_size = component_size(sparse.indices.componentType);
    size_t size = component_size(accessor.componentType);
    if (sparse.indices.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
        sparse.indices.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
        sparse.indices.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
        throw Problem("has a sparse accessor whose indices are not whole numbers");
    const unsigned char *indices =
        check_range(view_bytes(model, sparse.indices.bufferView), checked_offset(sparse.indices.byteOffset),
                    count, index_size, index_size, what);
    const unsigned char *from =
        check_range(view_bytes(model, sparse.values.bufferView), checked_offset(sparse.values.byteOffset),
                    count, size * width, size * width, what);
    for (size_t i = 0; i < count; i++) {
        size_t place = size_t(component(indices + i * index_size, sparse.indices.componentType, false));
        if (place >= accessor.count)
            throw Problem("has a sparse accessor that names an element beyond its end");
        for (size_t k = 0; k < width; k++)
            values[place * width + k] =
                component(from + (i * width + k) * size, accessor.componentType, accessor.normalized);
    }
}

const tinygltf::Accessor &find(const tinygltf::Model &model, int index, size_t limit, const char *what)
{
    const tinygltf::Accessor &accessor = at(model.accessors, index, "accessor");
    if (accessor.count > limit)
        throw Problem(std::string("has more than ") + std::to_string(limit) + " " + what +
                      " (decimate the mesh before)");
    return accessor;
}

} // namespace

size_t accessor_count(const tinygltf::Model &model, int index, const char *what)
{
    return find(model, index, 3 * size_t(SHAPE_MESH_MAX_TRIANGLES), what).count;
}

std::vector<double> read_accessor(const tinygltf::Model &model, int index, size_t width, const char *what)
{
    const tinygltf::Accessor &accessor = find(model, index, SHAPE_MESH_MAX_POINTS, what);
    size_t has = size_t(tinygltf::GetNumComponentsInType(uint32_t(accessor.type)));
    if (has != width)
        throw Problem(std::string("its ") + what + " have " + std::to_string(has) + " components, not " +
                      std::to_string(width));
    size_t size = component_size(accessor.componentType), count = accessor.count;
    if (accessor.bufferView < 0 && !accessor.sparse.isSparse)
        throw Problem(std::string("its ") + what + " have no data (export it without compression)");
    std::vector<double> values;
    if (accessor.bufferView >= 0) {
        Bytes bytes = view_bytes(model, accessor.bufferView);
        size_t stride = model.bufferViews[size_t(accessor.bufferView)].byteStride;
        if (stride == 0)
            stride = size * width;
        if (stride < size * width || stride > UINT32_MAX)
            throw Problem(std::string("its ") + what + " lie closer together than they are long");
        const unsigned char *from =
            check_range(bytes, accessor.byteOffset, count, stride, size * width, what);
        values.resize(count * width);
        for (size_t i = 0; i < count; i++)
            for (size_t k = 0; k < width; k++)
                values[i * width + k] =
                    component(from + i * stride + k * size, accessor.componentType, accessor.normalized);
    } else {
        values.resize(count * width, 0.0);
    }
    if (accessor.sparse.isSparse)
        put_sparse(model, accessor, width, values, what);
    return values;
}

std::vector<uint32_t> read_indices(const tinygltf::Model &model, int index)
{
    const tinygltf::Accessor &accessor = find(model, index, 3 * size_t(SHAPE_MESH_MAX_TRIANGLES), "indices");
    int type = accessor.componentType;
    if (accessor.type != TINYGLTF_TYPE_SCALAR ||
        (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
         type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT))
        throw Problem("its indices are not whole numbers of 8, 16 or 32 bits");
    if (accessor.sparse.isSparse)
        throw Problem("its indices are a sparse accessor (export it with plain indices)");
    size_t size = component_size(type),
           stride = at(model.bufferViews, accessor.bufferView, "bufferView").byteStride;
    if (stride == 0)
        stride = size;
    if (stride < size || stride > UINT32_MAX)
        throw Problem("its indices lie closer together than they are long");
    const unsigned char *from = check_range(view_bytes(model, accessor.bufferView), accessor.byteOffset,
                                            accessor.count, stride, size, "indices");
    std::vector<uint32_t> indices(accessor.count);
    for (size_t i = 0; i < indices.size(); i++)
        indices[i] = uint32_t(component(from + i * stride, type, false));
    return indices;
}

} // namespace shape_gltf
