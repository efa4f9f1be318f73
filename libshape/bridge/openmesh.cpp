// The bridge to OpenMesh: decimation by half-edge collapses in the order of the quadric error (Garland and Heckbert
// 1997). Half-edge collapses move no point, so what comes back are points of the mesh as it was, in full precision.
#include "shape/mesh.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModBaseT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

#include <memory>
#include <vector>

namespace
{

struct Traits : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
    using Normal = OpenMesh::Vec3d;
    VertexAttributes(OpenMesh::Attributes::Status);
    FaceAttributes(OpenMesh::Attributes::Status);
    EdgeAttributes(OpenMesh::Attributes::Status);
    HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge);
};
using Mesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;
using Decimater = OpenMesh::Decimater::DecimaterT<Mesh>;
using Quadric = OpenMesh::Decimater::ModQuadricT<Mesh>;

// The quadrics of a flat sheet are zero everywhere, so its outline would melt away. A point of the border may go only
// along the border, and only where the border is straight to within a thousandth of the mesh.
template <class MeshT> class BorderGuard : public OpenMesh::Decimater::ModBaseT<MeshT>
{
  public:
    DECIMATING_MODULE(BorderGuard, MeshT, BorderGuard);

    explicit BorderGuard(MeshT &mesh) : Base(mesh, true) {}

    float collapse_priority(const CollapseInfo &ci) override
    {
        const MeshT &mesh = Base::mesh();
        if (!mesh.is_boundary(ci.v0))
            return float(Base::LEGAL_COLLAPSE);
        if (!mesh.is_boundary(ci.v0v1) && !mesh.is_boundary(ci.v1v0))
            return float(Base::ILLEGAL_COLLAPSE);
        // The border's other neighbour of v0: the line from it to v1 replaces the two edges.
        auto out = mesh.halfedge_handle(ci.v0);
        auto ahead = mesh.to_vertex_handle(out),
             behind = mesh.from_vertex_handle(mesh.prev_halfedge_handle(out));
        auto other = mesh.point(ahead == ci.v1 ? behind : ahead);
        auto line = ci.p1 - other;
        double length = line.norm();
        double away = length > 0 ? (line % (ci.p0 - other)).norm() / length : (ci.p0 - other).norm();
        return float(away <= 1e-3 ? Base::LEGAL_COLLAPSE : Base::ILLEGAL_COLLAPSE);
    }
};

// OpenMesh reports what it repairs on a stream of its own; ours says it in the counts.
class Silence
{
    bool was_on = omerr().is_enabled();

  public:
    Silence() { omerr().disable(); }
    ~Silence()
    {
        if (was_on)
            omerr().enable();
    }
};

// The mesh in OpenMesh's form, centred and scaled to size 1 so that its tolerances fit. source[v] is the point of
// vertex v. Returns how many triangles had to be cut loose.
size_t build(const shape_mesh &from, Mesh &mesh, std::vector<uint32_t> &source)
{
    shape_dvec3 min, max;
    shape_mesh_bounds(&from, &min, &max);
    shape_dvec3 size = shape_dvec3_sub(max, min);
    double scale = 1 / fmax(size.x, fmax(size.y, size.z));
    auto place = [&](uint32_t i) {
        shape_dvec3 p = shape_dvec3_scale(shape_dvec3_sub(from.points[i], min), scale);
        return OpenMesh::Vec3d(p.x, p.y, p.z);
    };
    mesh.reserve(from.point_count, from.point_count + from.triangle_count, from.triangle_count);
    source.reserve(from.point_count);
    for (uint32_t i = 0; i < from.point_count; i++) {
        mesh.add_vertex(place(i));
        source.push_back(i);
    }
    size_t loose = 0;
    for (size_t t = 0; t < from.triangle_count; t++) {
        const uint32_t *c = &from.indices[3 * t];
        using V = OpenMesh::VertexHandle;
        if (mesh.add_face(V(int(c[0])), V(int(c[1])), V(int(c[2]))).is_valid())
            continue;
        V own[3];
        for (int i = 0; i < 3; i++) {
            own[i] = mesh.add_vertex(place(c[i]));
            source.push_back(c[i]);
        }
        mesh.add_face(own[0], own[1], own[2]);
        loose++;
    }
    return loose;
}

bool has_border(const Mesh &mesh)
{
    for (auto edge : mesh.edges())
        if (mesh.is_boundary(edge))
            return true;
    return false;
}

void collapse(Mesh &mesh, size_t faces, bool guarded)
{
    Decimater decimater(mesh);
    OpenMesh::Decimater::ModHandleT<Quadric> quadric;
    OpenMesh::Decimater::ModHandleT<BorderGuard<Mesh>> guard;
    decimater.add(quadric);
    if (guarded)
        decimater.add(guard);
    decimater.initialize();
    decimater.decimate_to_faces(0, faces);
}

// The triangles that are left, and the points that they use, in their old order.
void take_back(shape_mesh &to, const Mesh &mesh, const std::vector<uint32_t> &source)
{
    size_t kept = 0;
    std::vector<uint32_t> place(to.point_count, UINT32_MAX);
    for (auto face : mesh.all_faces()) {
        if (mesh.status(face).deleted())
            continue;
        for (auto vertex : mesh.fv_range(face)) {
            to.indices[kept] = source[size_t(vertex.idx())];
            place[to.indices[kept++]] = 0;
        }
    }
    to.triangle_count = kept / 3;
    uint32_t used = 0;
    for (size_t i = 0; i < to.point_count; i++)
        if (place[i] == 0) {
            to.points[used] = to.points[i];
            place[i] = used++;
        }
    to.point_count = used;
    for (size_t i = 0; i < kept; i++)
        to.indices[i] = place[to.indices[i]];
}

// One pass; false where the border stood in the way of the target.
bool decimate(shape_mesh &mesh, size_t faces, bool keep_border)
{
    Mesh half_edges;
    std::vector<uint32_t> source;
    mesh.counts.non_manifold += build(mesh, half_edges, source);
    bool guarded = keep_border && has_border(half_edges);
    collapse(half_edges, faces, guarded);
    take_back(mesh, half_edges, source);
    return !guarded || mesh.triangle_count <= faces;
}

} // namespace

extern "C" shape_status shape_mesh_decimate(shape_mesh *mesh, size_t faces, shape_error *error)
{
    if (!faces)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "a mesh cannot be decimated to 0 faces (give at least 1)");
    if (mesh->triangle_count <= faces)
        return SHAPE_OK;
    try {
        Silence silence;
        if (!decimate(*mesh, faces, true))
            decimate(*mesh, faces, false);
        return SHAPE_OK;
    } catch (const std::bad_alloc &) {
        return shape_error_memory(error);
    } catch (const std::exception &problem) {
        return shape_error_set(error, SHAPE_ERROR_SYSTEM, "decimation failed: %s", problem.what());
    } catch (...) {
        return shape_error_set(error, SHAPE_ERROR_SYSTEM, "decimation failed");
    }
}
