/* A set made ready to be looked at: density at a point, and the intervals of a ray that hold any. */
#ifndef SHAPE_VOLUME_H
#define SHAPE_VOLUME_H

#include "shape/noise.h"
#include "shape/set.h"
#include "shape/tree.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One cloud, with all that its density needs. Points and rays are in the cloud's frame unless said otherwise. */
typedef struct shape_volume_cloud {
    shape_frame frame, inverse; /* cloud to world and back */
    shape_field field;
    shape_medium medium;
    const shape_primitives
        *list;              /* the supports' primitives: the set's, or grown copies where there is a margin */
    const shape_tree *tree; /* shared by clouds with one list and support */
    const shape_noise *noise;
    int offsets[SHAPE_OCTAVES_MAX][3];
    float inverse_noise_scale;
    int mean_octaves; /* octaves above field.octaves that are taken as their mean rather than evaluated; 0 */
    float support;    /* a primitive's support is the primitive grown by this factor */
    float most;       /* the largest density; 1 but for grids */
    shape_box box;    /* around all supports */
    uint32_t tree_index;
    bool portable; /* take exponentials by shape_exp, slower, but the same on every machine; default false */
    /* For clouds with details and for layers, else unused. */
    bool detailed;
    const shape_primitives *shape_list; /* the set's */
    const shape_tree *detail_tree;      /* over shape_list, as far as its primitives count */
    uint32_t detail_tree_index, grown_index;
    float margin;
    float base, inverse_height; /* of the primitives: y of their box, 1 / its height */
    float inverse_displace_scale, inverse_detail_scale, inverse_detail_depth;
    shape_vec3 inverse_cell; /* of a layer's noise, stretched */
    uint32_t keys[4];        /* see shape_noise_key */
    const shape_stop
        *stop; /* asked on long ways through the primitives of one point; where it is true, the density
                                is of no use. For copies of a cloud that work can be broken off with; default NULL */
} shape_volume_cloud;

typedef struct shape_volume {
    shape_volume_cloud *clouds;
    size_t cloud_count;
    shape_tree *trees;
    size_t tree_count;
    shape_primitives *grown; /* lists of supports with a margin */
    size_t grown_count;
    shape_noise *noise;
} shape_volume;

/* Builds trees and noise. The set must outlive the volume and stay as it is. The caller destroys it. Reading a volume
 * is thread-safe. Errors: memory, limits, SHAPE_ERROR_ARGUMENT where a model is not made of primitives. */
shape_status shape_volume_create(const shape_set *set, shape_volume **volume, shape_error *error);
/* The same without what shape_voxels_fill and _count have no need of: trees, but for clouds with details, and noise where
 * no cloud has any. For nothing else: shape_cloud_u2 finds nothing in it. */
shape_status shape_volume_create_bare(const shape_set *set, shape_volume **volume, shape_error *error);
void shape_volume_destroy(shape_volume *volume); /* NULL is allowed */

/* u_i(p)^2 of one primitive: 1 on its surface (DESIGN: |diag(1/a) R^T (p - c)|). */
float shape_sphere_u2(const shape_sphere *sphere, shape_vec3 p);
float shape_ellipsoid_u2(const shape_ellipsoid *ellipsoid, shape_vec3 p);

/* The square of u(p) = min over i of u_i(p), or any number above 1 where p is outside every support. Uses the tree. */
float shape_cloud_u2(const shape_volume_cloud *cloud, shape_vec3 p);

/* Density at p, 0 to 1 (of a grid 0 to cloud->most), with u2 = shape_cloud_u2(p) already known (marching code knows it from the ray's
 * candidates). uniform: 1 where u <= 1. spheroid: Jiménez 2018 Eq. 2 and Algorithm 1. metaball: Eq. 19 to 21. layer and
 * details: docs/fields.md. In metaball and layer clouds and in those with details u2 only tells the support; a number
 * that is too small, such as 0, is then right anywhere. */
float shape_cloud_density_at(const shape_volume_cloud *cloud, shape_vec3 p, float u2);
/* Density at p, 0 to 1. */
float shape_cloud_density(const shape_volume_cloud *cloud, shape_vec3 p);
/* Whether a cloud's albedo is not one number: a grid with a colour of its own. */
bool shape_cloud_is_coloured(const shape_volume_cloud *cloud);
/* The albedo at p, red, green, blue, 0 to 1: the medium's, times a grid's colour there, cut at 1. */
void shape_cloud_albedo(const shape_volume_cloud *cloud, shape_vec3 p, float rgb[3]);
/* Extinction at a world point, the sum over clouds of density times extinction [1/m]. */
double shape_volume_extinction(const shape_volume *volume, shape_dvec3 world);

/* A ray in a cloud's frame: p(t) = origin + t direction. direction need not be a unit vector: with the inverse frame's
 * image of a world unit vector, t stays in metres of the world. */
typedef struct shape_ray {
    shape_vec3 origin, direction;
} shape_ray;

/* The world ray as the cloud sees it; computed in double precision, so a cloud far from the origin keeps its shape. */
shape_ray shape_volume_ray(const shape_volume_cloud *cloud, shape_dvec3 origin, shape_dvec3 direction);

/* The slab test of Williams et al. 2005 (an improvement of Smits 1998): where a ray is inside a box, within
 * [*t0, *t1]; false where it is not. Axis-parallel rays, also on a face, are handled. */
bool shape_box_intersect(shape_box box, shape_ray ray, float *t0, float *t1);

/* A ray's meeting with one support: entry, exit, and the growth of u^2, so that along the ray
 * u^2(t) = 1 * support^2 + a (t - t_in) (t - t_out). */
typedef struct shape_candidate {
    float t_in, t_out, a;
} shape_candidate;

/* Where a ray enters and leaves one support; false where it misses or only touches. The discriminant is taken from the
 * point of closest approach, so that spheres far from the ray's origin do not cancel (Haines et al. 2019). */
bool shape_sphere_intersect(const shape_sphere *sphere, float support, shape_ray ray, shape_candidate *hit);
bool shape_ellipsoid_intersect(const shape_ellipsoid *ellipsoid, float support, shape_ray ray,
                               shape_candidate *hit);

/* A growing list of candidates; zero it before first use, free it with shape_candidates_free. One a thread. stop may be set
 * then: shape_cloud_candidates and shape_volume_optical_depth ask it. */
typedef struct shape_candidates {
    shape_candidate *items;
    size_t count, capacity;
    shape_stop stop;
    size_t work; /* done since it was asked last */
} shape_candidates;

/* All supports that the ray meets within (t_min, t_max), sorted by entry; entries and exits are not clipped. The list
 * is emptied first. */
shape_status shape_cloud_candidates(const shape_volume_cloud *cloud, shape_ray ray, float t_min, float t_max,
                                    shape_candidates *found, shape_error *error);
void shape_candidates_free(shape_candidates *found);

/* No duplicate tracing: walks the joined intervals of sorted candidates. Start with *next = 0; each call gives the
 * next interval [*t0, *t1], clipped to [t_min, t_max], with its candidates items[*first .. *next); false at the end.
 * Jiménez 2018 Algorithm 2, on the union rather than sphere by sphere. */
bool shape_candidates_join(const shape_candidates *found, float t_min, float t_max, size_t *first,
                           size_t *next, float *t0, float *t1);

/* min u^2 at t over items[first .. end); above support^2 where none holds t. */
float shape_candidates_u2(const shape_candidates *found, size_t first, size_t end, float support2, float t);

/* The optical depth of the whole volume along a world ray from t_min to t_max [m], marched over the joined intervals
 * with steps of at most `step` metres at their midpoints. direction is a unit vector. */
/* Grids are integrated exactly where a step is no longer than a voxel. */
shape_status shape_volume_optical_depth(const shape_volume *volume, shape_dvec3 origin, shape_dvec3 direction,
                                        float t_min, float t_max, float step, shape_candidates *scratch,
                                        double *depth, shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
