/* Triangle meshes: reading, repair, decimation, filling. Points are doubles, so that a small mesh far from the origin
 * keeps its shape. Reading OBJ, PLY, STL and OFF and the repair are in the core; glTF, decimation and filling are in
 * the bridges that their names tell (targets shape_gltf, shape_openmesh, shape_openvdb). */
#ifndef SHAPE_MESH_H
#define SHAPE_MESH_H

#include <stddef.h>
#include <stdint.h>

#include "shape/set.h"
#include "shape/status.h"
#include "shape/vector.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Limits on what is read from a file; beyond them reading ends with SHAPE_ERROR_LIMIT. */
enum { SHAPE_MESH_MAX_POINTS = 1 << 25, SHAPE_MESH_MAX_TRIANGLES = 1 << 25 };
/* Coordinates beyond this [file's units] are refused: squares of areas would overflow. */
#define SHAPE_MESH_MAX_COORDINATE 1e12

/* What a file held and what became of it. */
typedef struct shape_mesh_counts {
    size_t faces;            /* polygons in the file (glTF: triangles of all instances) */
    size_t triangles;        /* that they make */
    size_t zero_area;        /* triangles dropped for having no area */
    size_t duplicate_points; /* points merged into another at exactly the same place */
    size_t duplicate_faces;  /* triangles dropped for having the same three points as another */
    size_t non_manifold;     /* triangles cut loose because an edge has more than two (decimation) */
    size_t skipped;          /* points and lines in a glTF, polygons with fewer than three corners */
    size_t instances;        /* glTF nodes that place a mesh */
    bool skinned, animated;  /* glTF: the rest pose was taken */
} shape_mesh_counts;

typedef struct shape_mesh {
    shape_dvec3 *points;
    uint32_t *indices; /* three a triangle, below point_count */
    size_t point_count, triangle_count;
    shape_mesh_counts counts;
} shape_mesh;

typedef enum shape_mesh_format {
    SHAPE_MESH_UNKNOWN = 0,
    SHAPE_MESH_OBJ,
    SHAPE_MESH_PLY,
    SHAPE_MESH_STL,
    SHAPE_MESH_OFF,
    SHAPE_MESH_GLTF,
    SHAPE_MESH_GLB
} shape_mesh_format;

/* An empty mesh with room for that many; the caller destroys it. NULL and *error where memory is out. */
shape_mesh *shape_mesh_create(size_t points, size_t triangles, shape_error *error);
void shape_mesh_destroy(shape_mesh *mesh); /* NULL is allowed */

/* The format by the name's suffix (.obj .ply .stl .off .gltf .glb, any case), else by what the bytes begin with. */
shape_mesh_format shape_mesh_format_guess(const char *name, const void *bytes, size_t size);
/* "OBJ", "PLY", ... */
const char *shape_mesh_format_name(shape_mesh_format format);

/* Reads an OBJ, PLY (text, binary of either order), STL (text or binary) or OFF (text) from untrusted bytes; one zero
 * byte must stand behind them, as shape_file_read leaves it. Polygons are cut into triangles, concave ones too.
 * `name` is used in errors only: "name:line:column: what is wrong". The mesh is as in the file: no axes turned, nothing
 * repaired. No triangle at all is an error. The caller destroys *mesh. */
shape_status shape_mesh_decode(shape_mesh_format format, const char *name, const void *bytes, size_t size,
                               shape_mesh **mesh, shape_error *error);

/* [shape_gltf] The same for glTF and GLB 2.0: all meshes of the scene, placed by their nodes; skins in the pose that
 * the nodes hold, no animation played, no morph target applied. Files that a .gltf names are read from `folder` (""
 * for the current one) or below it and nowhere else, each at most 1 GiB. Images are not read. One at a time: while it runs, the
 * process's std::terminate is its own, since tinygltf without memory may end there (a line and exit code 1). */
shape_status shape_gltf_decode(const char *name, const char *folder, const void *bytes, size_t size,
                               shape_mesh **mesh, shape_error *error);

/* Cuts a polygon of `count` corners (indices into points) into count - 2 triangles by clipping ears in the plane of
 * its mean normal (Meisters 1975); 3 (count - 2) indices go to `triangles`. A polygon that crosses itself, or is
 * larger than 4,096 corners, is cut as a fan. `scratch` holds 3 count doubles. */
void shape_polygon_cut(const shape_dvec3 *points, const uint32_t *corners, size_t count, uint32_t *triangles,
                       double *scratch);

/* The box around the points; false for a mesh without points. */
bool shape_mesh_bounds(const shape_mesh *mesh, shape_dvec3 *min, shape_dvec3 *max);
/* Every point through the frame; a mirroring frame turns the triangles round, so that the outside stays outside. */
void shape_mesh_transform(shape_mesh *mesh, const shape_frame *frame);

/* Merges points at the same place, drops triangles without area (up to rounding of the coordinates) and triangles
 * that repeat another, drops points that no triangle uses, and adds what it did to mesh->counts. The order of what
 * stays is kept. Errors: memory, or SHAPE_ERROR_FORMAT where no triangle is left. */
shape_status shape_mesh_repair(shape_mesh *mesh, shape_error *error);

/* Edges that belong to one triangle only; 0 for a closed mesh. *count is set; errors: memory. */
shape_status shape_mesh_open_edges(const shape_mesh *mesh, size_t *count, shape_error *error);

/* [shape_openmesh] Reduces a repaired mesh to at most `faces` triangles by half-edge collapses in the order of the
 * quadric error (Garland and Heckbert 1997; OpenMesh's ModQuadric). Points stay where they were, some vanish. A mesh
 * of many separate parts may keep more: each part keeps a triangle or two. The border of an open mesh is kept in
 * shape as long as the target can be reached with it. faces >= 1. A mesh that is small enough is left as it is. */
shape_status shape_mesh_decimate(shape_mesh *mesh, size_t faces, shape_error *error);

/* [shape_openvdb] Fills the inside of a closed mesh with at most `count` spheres (OpenVDB's fillWithSpheres: largest
 * first, overlapping, on a level set of `resolution` voxels along the longest side) and appends them to *list. Where
 * the mesh has no inside (it is open by more than a voxel), nothing is appended. *made gets how many. */
shape_status shape_mesh_fill(const shape_mesh *mesh, size_t count, int resolution, shape_primitives *list,
                             size_t *made, shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
