// Private to the glTF bridge: accessors as checked arrays, nodes as matrices, skins.
#ifndef SHAPE_BRIDGE_GLTF_PRIVATE_HPP
#define SHAPE_BRIDGE_GLTF_PRIVATE_HPP

#include "shape/mesh.h"

#include <tiny_gltf.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace shape_gltf
{

// What is wrong with a file; caught at the bridge's edge.
struct Problem : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// The accessor's values, `width` numbers an element (1, 3, 4 or 16), sparse elements put in, normalised integers
// turned into their share of 1. Every offset, stride, count and index is checked against the buffer's bytes first.
std::vector<double> read_accessor(const tinygltf::Model &model, int index, size_t width, const char *what);

// The same for indices: unsigned whole numbers.
std::vector<uint32_t> read_indices(const tinygltf::Model &model, int index);

// The count that an accessor states, its index checked.
size_t accessor_count(const tinygltf::Model &model, int index, const char *what);

// A node's own placement, from its matrix or its translation, rotation and scale.
shape_frame node_frame(const tinygltf::Node &node);

// Moves `points` by the skin of the primitive: the joints in the pose that the nodes hold (world has a frame a node).
void apply_skin(const tinygltf::Model &model, const tinygltf::Primitive &primitive,
                const tinygltf::Skin &skin, const std::vector<shape_frame> &world,
                std::vector<shape_dvec3> &points);

template <class T> const T &at(const std::vector<T> &list, int index, const char *what)
{
    if (index < 0 || size_t(index) >= list.size())
        throw Problem(std::string("names ") + what + " " + std::to_string(index) + ", of which there are " +
                      std::to_string(list.size()));
    return list[size_t(index)];
}

} // namespace shape_gltf

#endif
