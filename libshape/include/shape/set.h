/* The primitive set: what every generator makes, every tool changes and every renderer reads. A set holds clouds; a
 * cloud is a list of spheres and rotated ellipsoids in a frame of its own, with the field and the medium that turn
 * them into extinction. Copies of a cloud share one list. */
#ifndef SHAPE_SET_H
#define SHAPE_SET_H

#include <stddef.h>
#include <stdint.h>

#include "shape/status.h"
#include "shape/vector.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Centre and radius [m, cloud's frame]; radius > 0. 16 bytes, as in the file and in a float texture. */
typedef struct shape_sphere {
    float x, y, z, radius;
} shape_sphere;

/* Centre and semi-axes a, b, c > 0 [m, cloud's frame], turned by the unit quaternion q. 48 bytes, three texels;
 * the two paddings are zero. */
typedef struct shape_ellipsoid {
    float x, y, z, pad0;
    float a, b, c, pad1;
    shape_quat q;
} shape_ellipsoid;

/* A list of primitives, shared by all clouds that name it. Grow it by the functions below. */
typedef struct shape_primitives {
    shape_sphere *spheres;
    shape_ellipsoid *ellipsoids;
    size_t sphere_count, ellipsoid_count;
    size_t sphere_capacity, ellipsoid_capacity;
} shape_primitives;

/* How primitives become density; see docs/fields.md. The numbers are those of the file format. */
typedef enum shape_model {
    SHAPE_MODEL_UNIFORM = 0,  /* 1 inside a primitive */
    SHAPE_MODEL_SPHEROID = 1, /* Jiménez 2018 Eq. 1, 2, Algorithm 1 */
    SHAPE_MODEL_METABALL = 2, /* Jiménez 2018 Eq. 19 to 21 */
    SHAPE_MODEL_LAYER = 3,    /* bounded noise volume (Páleník 2016 section 5.1) */
    SHAPE_MODEL_GRID = 4      /* a voxel grid, kept outside the set */
} shape_model;

/* What may be added to the field of any cloud made of primitives; docs/fields.md has the formulas. All zero: nothing.
 * u is the distance from a primitive's centre in units of its radius, 1 on its surface. */
typedef struct shape_detail {
    float
        smoothness; /* smooth union: two surfaces that meet bulge by at most this share of their radius, 0 to 1;
                            not for metaball and layer, which blend by themselves */
    float displace; /* how far vector noise moves the query point at most [m, cloud's frame], 0 to 1e9 */
    float displace_scale; /* edge of a cell of that noise [m], 0 to 1e9; 0: five times noise_scale */
    float billow,
        wisp; /* share of detail_depth that puffs erode at the cloud's top, and wisps at its base, 0 to 1;
                            not for layer */
    float detail_depth; /* how deep they reach, as a share of the radius, 0 to 1; 0: a half */
    float detail_scale; /* edge of a cell of their noise [m], 0 to 1e9; 0: twice noise_scale */
} shape_detail;

/* What a primitive of a layer cloud bounds. v is a point in the space where the primitive is the unit ball. */
typedef enum shape_bounds {
    SHAPE_BOUNDS_SPHERE = 0,   /* the primitive itself: |v| <= 1 */
    SHAPE_BOUNDS_BOX = 1,      /* the box that touches it: |v_x|, |v_y|, |v_z| <= 1 */
    SHAPE_BOUNDS_ALTITUDES = 2 /* two altitudes, |v_y| <= 1, out to the primitive's rim, v_x^2 + v_z^2 <= 1 */
} shape_bounds;

typedef enum shape_noise_kind {
    SHAPE_NOISE_LATTICE = 0,      /* Jiménez 2018 Eq. 1 */
    SHAPE_NOISE_PERLIN = 1,       /* Perlin 2002 */
    SHAPE_NOISE_WORLEY = 2,       /* 1 - F1 of Worley 1996 */
    SHAPE_NOISE_PERLIN_WORLEY = 3 /* both, mixed by `blend` (Páleník 2016 section 5.1) */
} shape_noise_kind;

/* A bounded noise volume: the field of SHAPE_MODEL_LAYER. Each primitive of the cloud bounds a piece of it. octaves and
 * noise_scale of the field (metres a cell, that is 1 / frequency) are those of its noise. */
typedef struct shape_layer {
    shape_bounds bounds;
    shape_noise_kind noise;
    float blend;            /* perlin-worley: the share of Perlin, 0 to 1; default 0.5 */
    float gain;             /* contrast of lattice or Perlin noise about its middle, 0 to 100; default 1 */
    float worley_gain;      /* the same of Worley noise */
    float worley_frequency; /* Worley cells a cell of noise_scale, 1e-3 to 1e3; default 1 */
    int worley_octaves;     /* 1 to 8; default 3 */
    float stretch[3];       /* of the cells along x, y, z, 1e-3 to 1e3; default 1 */
    float coverage;         /* 0: nothing, 0.5: the noise as it is, 1: full; default 0.5 */
    float cut;              /* noise up to here is nothing, the rest is stretched, 0 to below 1; default 0 */
    float ramp[2]; /* A, B: no density up to A, all from B on, smooth between, 0 <= A <= B <= 1; default
                               0.45, 0.65 */
    float falloff; /* share of the radius |v| over which the layer thins out to nothing, 0 to 1; default 0 */
    float fade_bottom,
        fade_top;    /* the same, shares of its thickness at its base and top, 0 to 1; default 0 */
    float fade_side; /* the same, a share of its half width at its sides; default 0 */
    float
        planet_radius; /* altitudes: from the planet's centre, straight below the primitive's, to the primitive's
                               centre [m, cloud's frame], 0 to 1e9; default 0: flat */
} shape_layer;

typedef struct shape_field {
    shape_model model;
    float kappa; /* share of noise in the spheroid's threshold, 0 to 1; default 0.5 */
    int octaves; /* of the fBm noise, 1 to 16; default 5 */
    float
        noise_scale; /* edge of a lattice cell of the first octave [m, cloud's frame], > 0; 0: not chosen yet, see
                          shape_cloud_choose_noise_scale */
    float edge;      /* metaball threshold on the noise, >= 0; default 4.2 */
    uint64_t seed;       /* of the noise lattice */
    shape_detail detail; /* default all 0: none */
    shape_layer layer;   /* of the layer model only; others leave it unread, and files leave it out */
} shape_field;

typedef enum shape_phase_kind {
    SHAPE_PHASE_HG = 0, /* Henyey and Greenstein 1941 */
    SHAPE_PHASE_ISOTROPIC = 1,
    SHAPE_PHASE_RAYLEIGH = 2,
    SHAPE_PHASE_MIE = 3,     /* cloud droplets, the fit of Jendersie and d'Eon 2023 */
    SHAPE_PHASE_TWO_LOBE = 4 /* a mix of two Henyey-Greenstein lobes */
} shape_phase_kind;

typedef struct shape_medium {
    float extinction;       /* sigma_t at density 1 [1/m of the world], >= 0; default 2 */
    float albedo;           /* sigma_s / sigma_t, 0 to 1; default 1 */
    shape_phase_kind phase; /* default Henyey-Greenstein */
    float g;                /* mean cosine (first lobe), -1 < g < 1; default 0.85 */
    float g2;               /* second lobe's; default -0.3 */
    float lobe_mix;         /* weight of the second lobe, 0 to 1; default 0.3 */
    float droplet;          /* droplet diameter for mie [micrometre], 5 to 50; default 10 */
} shape_medium;

enum { SHAPE_NAME_MAX = 63, SHAPE_MADE_BY_MAX = 255 };

typedef struct shape_cloud {
    char name[SHAPE_NAME_MAX + 1];       /* UTF-8, unique within a set */
    char made_by[SHAPE_MADE_BY_MAX + 1]; /* program, version, options, inputs; one line */
    uint64_t seed;                       /* the one it was made with */
    shape_frame frame;                   /* cloud to world */
    shape_field field;
    shape_medium medium;
    uint32_t list; /* which of the set's lists holds its primitives */
} shape_cloud;

/* A chunk of a file that this version does not know, kept so that rewriting loses nothing. */
typedef struct shape_extra {
    char type[4];
    uint32_t list; /* the chunk's parameter in the file's table */
    size_t size;
    unsigned char *bytes;
} shape_extra;

typedef struct shape_set {
    shape_cloud *clouds;
    shape_primitives *lists;
    shape_extra *extras;
    size_t cloud_count, list_count, extra_count;
    size_t cloud_capacity, list_capacity, extra_capacity;
    uint32_t *name_slots; /* a table of the first named_count names; of shape_set_add_cloud alone */
    size_t name_slot_count, named_count;
} shape_set;

shape_field shape_field_defaults(void);
shape_medium shape_medium_defaults(void);
shape_layer shape_layer_defaults(void);
/* Whether any detail changes the field. */
bool shape_detail_is_on(const shape_detail *detail);
/* Checks every member's range; the error names the member. */
shape_status shape_field_check(const shape_field *field, shape_error *error);
shape_status shape_medium_check(const shape_medium *medium, shape_error *error);

/* An empty set. The caller destroys it; NULL and *error where memory is out. */
shape_set *shape_set_create(shape_error *error);
void shape_set_destroy(shape_set *set); /* NULL is allowed */

/* Adds a cloud with an empty list of its own, identity frame and defaults; *index (may be NULL) gets its number.
 * Pointers into set->clouds and set->lists end with the call. A name that is taken gets "-2", "-3", ...;
 * a name that was written into a cloud afterwards may go unnoticed, until shape_set_check. */
shape_status shape_set_add_cloud(shape_set *set, const char *name, size_t *index, shape_error *error);
/* Adds a placed copy that shares cloud `of`'s list and description. */
shape_status shape_set_add_copy(shape_set *set, size_t of, const shape_frame *frame, size_t *index,
                                shape_error *error);
/* Keeps a copy of an unknown chunk. */
shape_status shape_set_add_extra(shape_set *set, const char type[4], uint32_t list, const void *bytes,
                                 size_t size, shape_error *error);

/* The list of a cloud. */
shape_primitives *shape_set_list(shape_set *set, size_t cloud);
const shape_primitives *shape_set_list_const(const shape_set *set, size_t cloud);

/* Append one primitive. The quaternion is normalised; sizes and finiteness are checked (SHAPE_ERROR_ARGUMENT). */
shape_status shape_primitives_add_sphere(shape_primitives *list, shape_sphere sphere, shape_error *error);
shape_status shape_primitives_add_ellipsoid(shape_primitives *list, shape_ellipsoid ellipsoid,
                                            shape_error *error);
/* Makes room for that many in all, so that appending up to them cannot fail. */
shape_status shape_primitives_reserve(shape_primitives *list, size_t spheres, size_t ellipsoids,
                                      shape_error *error);
size_t shape_primitives_count(const shape_primitives *list);

/* The box of one primitive, grown by the factor `grow` about its centre; exact for a rotated ellipsoid. */
shape_box shape_sphere_box(const shape_sphere *sphere, float grow);
shape_box shape_ellipsoid_box(const shape_ellipsoid *ellipsoid, float grow);

/* A primitive's support, the set outside which it makes no density for certain, is the primitive grown about its centre
 * by a factor, then by a margin [m] all round.
 * The factor: 1; the square root of N for metaballs; 1 + smoothness; for a layer 1, the square root of 2 (altitudes) or
 * of 3 (box), which take in the bounds' corners. */
float shape_cloud_support(const shape_cloud *cloud, const shape_primitives *list);
/* The margin: how far points are displaced, and how far a planet's curve drops below a primitive's rim; mostly 0. */
float shape_cloud_margin(const shape_cloud *cloud, const shape_primitives *list);
/* A primitive grown by factor and margin. Of an ellipsoid, the margin gives the smallest ellipsoid of its orientation
 * that surely holds all points within it (the outer sum of Kurzhanski and Vályi 1997 for the traces' optimum). */
shape_sphere shape_sphere_grow(const shape_sphere *sphere, float support, float margin);
shape_ellipsoid shape_ellipsoid_grow(const shape_ellipsoid *ellipsoid, float support, float margin);
/* The box outside which a cloud has no density, in its own frame: around the supports of its primitives, or, of a layer,
 * around what they bound, grown by the margin; empty for an empty cloud. */
shape_box shape_cloud_box(const shape_cloud *cloud, const shape_primitives *list);
/* The same in world space, double precision; false for an empty cloud. */
bool shape_set_cloud_bounds(const shape_set *set, size_t cloud, shape_dvec3 *min, shape_dvec3 *max);
/* The box around all clouds; false where there is nothing. */
bool shape_set_bounds(const shape_set *set, shape_dvec3 *min, shape_dvec3 *max);

/* Sets field.noise_scale to a fifth of the median radius (of an ellipsoid: its mean semi-axis) where it is 0; to 0.2
 * where the list is empty. Programs call it when the list is complete. */
shape_status shape_cloud_choose_noise_scale(shape_cloud *cloud, const shape_primitives *list,
                                            shape_error *error);

/* Checks the whole set as a reader of untrusted bytes must: lists in range, finite frames with an inverse, finite
 * primitives of positive size, unit quaternions to 1e-3, fields and media in range, names unique. */
shape_status shape_set_check(const shape_set *set, shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
