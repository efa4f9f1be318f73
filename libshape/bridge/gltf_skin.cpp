// glTF 2.0 nodes and skins (sections 3.5.3 and 3.7.3): where a mesh stands when no animation is played.
#include "gltf_private.hpp"

namespace shape_gltf
{
namespace
{

// glTF's matrices are stored column by column.
shape_frame from_columns(const double *m)
{
    shape_frame frame;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            frame.m[i][j] = m[4 * j + i];
    return frame;
}

void check_finite(const shape_frame &frame)
{
    for (auto &row : frame.m)
        for (double value : row)
            if (!std::isfinite(value))
                throw Problem("has a transform that is not finite");
}

std::vector<shape_frame> joint_frames(const tinygltf::Model &model, const tinygltf::Skin &skin,
                                      const std::vector<shape_frame> &world)
{
    std::vector<double> inverse;
    if (skin.inverseBindMatrices >= 0) {
        inverse = read_accessor(model, skin.inverseBindMatrices, 16, "inverse bind matrices");
        if (inverse.size() / 16 < skin.joints.size())
            throw Problem("has fewer inverse bind matrices than joints");
    }
    std::vector<shape_frame> frames;
    for (size_t j = 0; j < skin.joints.size(); j++) {
        shape_frame joint = at(world, skin.joints[j], "node");
        if (!inverse.empty()) {
            shape_frame bind = from_columns(&inverse[16 * j]);
            joint = shape_frame_multiply(&joint, &bind);
        }
        check_finite(joint);
        frames.push_back(joint);
    }
    return frames;
}

} // namespace

shape_frame node_frame(const tinygltf::Node &node)
{
    shape_frame frame = shape_frame_identity();
    if (node.matrix.size() == 16) {
        frame = from_columns(node.matrix.data());
    } else {
        if (node.rotation.size() == 4) {
            double x = node.rotation[0], y = node.rotation[1], z = node.rotation[2], w = node.rotation[3];
            double square = x * x + y * y + z * z + w * w;
            if (!(square > 1e-12))
                throw Problem("has a node whose rotation is zero");
            double s = 2 / square;
            const double m[3][3] = {{1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)},
                                    {s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)},
                                    {s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)}};
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++)
                    frame.m[i][j] = m[i][j];
        }
        for (size_t j = 0; j < 3 && node.scale.size() == 3; j++)
            for (int i = 0; i < 3; i++)
                frame.m[i][j] *= node.scale[j];
        for (size_t i = 0; i < 3 && node.translation.size() == 3; i++)
            frame.m[i][3] = node.translation[i];
    }
    check_finite(frame);
    return frame;
}

void apply_skin(const tinygltf::Model &model, const tinygltf::Primitive &primitive,
                const tinygltf::Skin &skin, const std::vector<shape_frame> &world,
                std::vector<shape_dvec3> &points)
{
    auto joints_at = primitive.attributes.find("JOINTS_0"),
         weights_at = primitive.attributes.find("WEIGHTS_0");
    if (joints_at == primitive.attributes.end() || weights_at == primitive.attributes.end())
        throw Problem("has a skin on a mesh without joints and weights");
    std::vector<shape_frame> frames = joint_frames(model, skin, world);
    std::vector<double> joints = read_accessor(model, joints_at->second, 4, "joints");
    std::vector<double> weights = read_accessor(model, weights_at->second, 4, "weights");
    if (joints.size() < 4 * points.size() || weights.size() < 4 * points.size())
        throw Problem("has fewer joints or weights than vertices");
    for (size_t i = 0; i < points.size(); i++) {
        shape_dvec3 sum = {0, 0, 0};
        double total = 0;
        for (size_t k = 4 * i; k < 4 * i + 4; k++) {
            if (!(weights[k] > 0))
                continue;
            if (!(joints[k] < double(frames.size())))
                throw Problem("names a joint that its skin does not have");
            shape_dvec3 moved = shape_frame_point(&frames[size_t(joints[k])], points[i]);
            sum = shape_dvec3_add(sum, shape_dvec3_scale(moved, weights[k]));
            total += weights[k];
        }
        if (total > 0)
            points[i] = shape_dvec3_scale(sum, 1 / total);
    }
}

} // namespace shape_gltf
