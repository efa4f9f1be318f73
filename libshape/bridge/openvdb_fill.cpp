// The bridge to OpenVDB's sphere packing: the inside of a closed mesh as spheres, largest first.
#include "shape/mesh.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToSpheres.h>

#include <limits>
#include <vector>

namespace
{

// The mesh in voxels: its longest side is `resolution` of them.
struct Voxels {
    shape_dvec3 min;
    double size; // of a voxel
};

Voxels measure(const shape_mesh &mesh, int resolution)
{
    shape_dvec3 min, max;
    shape_mesh_bounds(&mesh, &min, &max);
    shape_dvec3 side = shape_dvec3_sub(max, min);
    return {min, fmax(side.x, fmax(side.y, side.z)) / resolution};
}

openvdb::FloatGrid::Ptr level_set(const shape_mesh &mesh, const Voxels &voxels)
{
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    points.reserve(mesh.point_count);
    triangles.reserve(mesh.triangle_count);
    for (size_t i = 0; i < mesh.point_count; i++) {
        shape_dvec3 p = shape_dvec3_scale(shape_dvec3_sub(mesh.points[i], voxels.min), 1 / voxels.size);
        points.emplace_back(float(p.x), float(p.y), float(p.z));
    }
    for (size_t t = 0; t < mesh.triangle_count; t++)
        triangles.emplace_back(mesh.indices[3 * t], mesh.indices[3 * t + 1], mesh.indices[3 * t + 2]);
    return openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(
        *openvdb::math::Transform::createLinearTransform(1.0), points, triangles);
}

// Deeper than a voxel somewhere: the thin crust that an open sheet may leave is no inside.
bool has_inside(const openvdb::FloatGrid &grid)
{
    for (auto value = grid.cbeginValueAll(); value; ++value)
        if (*value < -1)
            return true;
    return false;
}

std::vector<openvdb::Vec4s> pack(const shape_mesh &mesh, size_t count, const Voxels &voxels)
{
    openvdb::initialize();
    openvdb::FloatGrid::Ptr grid = level_set(mesh, voxels);
    std::vector<openvdb::Vec4s> spheres;
    if (!has_inside(*grid))
        return spheres;
    // More places tried than spheres wanted: the largest that fit are taken.
    int places = int(count > 5000 ? 4 * count : 20000);
    openvdb::tools::fillWithSpheres(*grid, spheres, openvdb::Vec2i(1, int(count)), true, 1.0f,
                                    std::numeric_limits<float>::max(), 0.0f, places);
    return spheres;
}

shape_status append(const std::vector<openvdb::Vec4s> &spheres, const Voxels &voxels, shape_primitives *list,
                    size_t *made, shape_error *error)
{
    for (const openvdb::Vec4s &sphere : spheres) {
        if (!(sphere[3] > 0) || !std::isfinite(sphere[3]))
            continue;
        shape_sphere own = {float(voxels.min.x + voxels.size * double(sphere[0])),
                            float(voxels.min.y + voxels.size * double(sphere[1])),
                            float(voxels.min.z + voxels.size * double(sphere[2])),
                            float(voxels.size * double(sphere[3]))};
        shape_status status = shape_primitives_add_sphere(list, own, error);
        if (status)
            return status;
        ++*made;
    }
    return SHAPE_OK;
}

} // namespace

extern "C" shape_status shape_mesh_fill(const shape_mesh *mesh, size_t count, int resolution,
                                        shape_primitives *list, size_t *made, shape_error *error)
{
    *made = 0;
    if (!count || count > 1000000 || resolution < 8 || resolution > 1024)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "filling takes 1 to 1,000,000 spheres and 8 to 1,024 voxels a side");
    try {
        Voxels voxels = measure(*mesh, resolution);
        return append(pack(*mesh, count, voxels), voxels, list, made, error);
    } catch (const std::bad_alloc &) {
        return shape_error_memory(error);
    } catch (const std::exception &problem) {
        return shape_error_set(error, SHAPE_ERROR_SYSTEM, "filling failed: %s", problem.what());
    } catch (...) {
        return shape_error_set(error, SHAPE_ERROR_SYSTEM, "filling failed");
    }
}
