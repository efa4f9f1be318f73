// Mesh to ellipsoids against OpenMesh's decimation alone: a wavy torus of 100,000 triangles to 370, reading excluded.
// Ours is everything neph-mesh does between reading and writing: repair, half-edges, decimation, ellipsoids. Theirs is
// the decimater on half-edges that are there already, in OpenMesh's default single precision and in double.
#include "shape/mesh.h"
#include "shape/meshfit.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

namespace
{

enum : int { AROUND = 250, ALONG = 200, FACES = 370, RUNS = 3 };

struct DoubleTraits : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
    using Normal = OpenMesh::Vec3d;
};
using FloatMesh = OpenMesh::TriMesh_ArrayKernelT<>;
using DoubleMesh = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;

// Processor time: all of it is one thread, and other work on the machine does not count.
double now()
{
    timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return 1e3 * double(time.tv_sec) + 1e-6 * double(time.tv_nsec);
}

shape_mesh *wavy_torus()
{
    shape_mesh *mesh = shape_mesh_create(AROUND * ALONG, 2 * AROUND * ALONG, nullptr);
    if (!mesh)
        exit(1);
    for (int i = 0; i < AROUND; i++)
        for (int j = 0; j < ALONG; j++) {
            double u = 2 * M_PI * i / AROUND, v = 2 * M_PI * j / ALONG;
            double r = 0.4 + 0.03 * sin(9 * u) * cos(7 * v) + 0.01 * sin(31 * u + 13 * v);
            mesh->points[mesh->point_count++] =
                shape_dvec3_make((1 + r * cos(v)) * cos(u), r * sin(v), (1 + r * cos(v)) * sin(u));
            uint32_t a = uint32_t(i * ALONG + j), b = uint32_t(i * ALONG + (j + 1) % ALONG);
            uint32_t c = uint32_t((i + 1) % AROUND * ALONG + j),
                     d = uint32_t((i + 1) % AROUND * ALONG + (j + 1) % ALONG);
            const uint32_t corner[6] = {a, b, d, a, d, c};
            std::memcpy(&mesh->indices[3 * mesh->triangle_count], corner, sizeof corner);
            mesh->triangle_count += 2;
        }
    return mesh;
}

template <class Mesh> double theirs(const shape_mesh &from, size_t &left)
{
    Mesh mesh;
    mesh.request_vertex_status();
    mesh.request_edge_status();
    mesh.request_face_status();
    for (size_t i = 0; i < from.point_count; i++) {
        typename Mesh::Point p;
        p[0] = typename Mesh::Scalar(from.points[i].x);
        p[1] = typename Mesh::Scalar(from.points[i].y);
        p[2] = typename Mesh::Scalar(from.points[i].z);
        mesh.add_vertex(p);
    }
    for (size_t t = 0; t < from.triangle_count; t++) {
        const uint32_t *c = &from.indices[3 * t];
        using V = OpenMesh::VertexHandle;
        mesh.add_face(V(int(c[0])), V(int(c[1])), V(int(c[2])));
    }
    double start = now();
    OpenMesh::Decimater::DecimaterT<Mesh> decimater(mesh);
    typename OpenMesh::Decimater::ModQuadricT<Mesh>::Handle quadric;
    decimater.add(quadric);
    decimater.initialize();
    decimater.decimate_to_faces(0, FACES);
    double time = now() - start;
    mesh.garbage_collection();
    left = mesh.n_faces();
    return time;
}

// Milliseconds of repair, decimation and ellipsoids.
struct Ours {
    double repair, decimate, fit;
    size_t ellipsoids;
    double all() const { return repair + decimate + fit; }
};

Ours ours(const shape_mesh &from)
{
    shape_mesh *mesh = shape_mesh_create(from.point_count, from.triangle_count, nullptr);
    if (!mesh)
        exit(1);
    std::memcpy(mesh->points, from.points, from.point_count * sizeof *from.points);
    std::memcpy(mesh->indices, from.indices, 3 * from.triangle_count * sizeof *from.indices);
    mesh->point_count = from.point_count;
    mesh->triangle_count = from.triangle_count;
    shape_error error;
    shape_primitives list = {};
    shape_meshfit fit = shape_meshfit_defaults();
    double t0 = now();
    bool good = !shape_mesh_repair(mesh, &error);
    double t1 = now();
    good = good && !shape_mesh_decimate(mesh, FACES, &error);
    double t2 = now();
    good = good && !shape_meshfit_add(mesh, &fit, &list, &error);
    double t3 = now();
    if (!good) {
        fprintf(stderr, "%s\n", error.text);
        exit(1);
    }
    Ours result = {t1 - t0, t2 - t1, t3 - t2, list.ellipsoid_count};
    free(list.ellipsoids);
    shape_mesh_destroy(mesh);
    return result;
}

} // namespace

int main()
{
    shape_mesh *mesh = wavy_torus();
    size_t left_float = 0, left_double = 0;
    double single = HUGE_VAL, twice = HUGE_VAL;
    Ours best = {HUGE_VAL, HUGE_VAL, HUGE_VAL, 0};
    // In turn, and the least of each: what else the machine does then weighs on all of them alike.
    for (int run = 0; run < RUNS; run++) {
        single = fmin(single, theirs<FloatMesh>(*mesh, left_float));
        twice = fmin(twice, theirs<DoubleMesh>(*mesh, left_double));
        Ours own = ours(*mesh);
        if (own.all() < best.all())
            best = own;
    }
    printf("triangles,faces,what,milliseconds,ratio\n");
    printf("%zu,%zu,OpenMesh decimation alone (float),%.1f,1.00\n", mesh->triangle_count, left_float, single);
    printf("%zu,%zu,OpenMesh decimation alone (double),%.1f,%.2f\n", mesh->triangle_count, left_double, twice,
           twice / single);
    printf("%zu,%zu,whole conversion,%.1f,%.2f\n", mesh->triangle_count, best.ellipsoids, best.all(),
           best.all() / single);
    printf("%zu,,of it repair,%.1f,\n", mesh->triangle_count, best.repair);
    printf("%zu,,of it half-edges and decimation,%.1f,\n", mesh->triangle_count, best.decimate);
    printf("%zu,,of it ellipsoids,%.3f,\n", mesh->triangle_count, best.fit);
    shape_mesh_destroy(mesh);
    return best.all() <= 1.3 * single ? 0 : 1;
}
