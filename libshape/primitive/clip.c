/* Cutting clouds by a plane, with noise where the edge is to be ragged. */
#include "shape/refine.h"

#include <string.h>

#include "primitive/axes.h"
#include "shape/combine.h"
#include "shape/random.h"
#include "shape/transform.h"

shape_clip shape_clip_defaults(void)
{
    shape_clip options = {.normal = {0, 1, 0}, .lowest = true, .noise_size = 1, .seed = 1};
    return options;
}

static shape_status out_of_range(const char *what, double value, const char *range, shape_error *error)
{
    return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "%s is %g (it must be %s)", what, value, range);
}

shape_status shape_clip_check(const shape_clip *options, shape_error *error)
{
    double square = 0;
    for (int i = 0; i < 3; i++) {
        if (!(fabs(options->normal[i]) <= 1e6))
            return out_of_range("a part of clip-normal", options->normal[i], "-1e6 to 1e6", error);
        square += options->normal[i] * options->normal[i];
    }
    if (!(square >= 1e-12))
        return out_of_range("the length of clip-normal", sqrt(square), "at least 1e-6", error);
    if (!(fabs(options->height) <= 1e12))
        return out_of_range("clip-height", options->height, "-1e12 to 1e12", error);
    if (!(options->noise >= 0 && options->noise <= 1e6))
        return out_of_range("clip-noise", options->noise, "0 to 1e6", error);
    if (!(options->noise_size >= 1e-6 && options->noise_size <= 1e9))
        return out_of_range("clip-size", options->noise_size, "1e-6 to 1e9", error);
    return SHAPE_OK;
}

/* What describe and apply share. */
typedef struct cut {
    const shape_clip *options;
    size_t removed, squashed;
} cut;

/* The plane in a cloud's frame. */
typedef struct local_plane {
    double normal[3]; /* unit */
    double height, noise, noise_size;
    double lowest; /* 1: the height is that of the lowest centre */
} local_plane;

/* A plane n . x = h of the world is (L^T n) . p = h - n . t in a frame with linear part L and translation t. Lengths
 * along the normal shrink by |L^T n|; the noise's cells by the cube root of L's determinant, its mean scale. */
static shape_status describe(const shape_set *set, size_t cloud, void *key, void *context, shape_error *error)
{
    (void)error;
    const shape_clip *options = ((const cut *)context)->options;
    const shape_frame *frame = &set->clouds[cloud].frame;
    shape_dvec3 n = {options->normal[0], options->normal[1], options->normal[2]};
    n = shape_dvec3_normalize(n);
    const double unit[3] = {n.x, n.y, n.z};
    local_plane plane;
    memset(&plane, 0, sizeof plane);
    double length = 0, offset = 0;
    for (int j = 0; j < 3; j++) {
        for (int i = 0; i < 3; i++)
            plane.normal[j] += frame->m[i][j] * unit[i];
        length += plane.normal[j] * plane.normal[j];
        offset += unit[j] * frame->m[j][3];
    }
    length = sqrt(length);
    for (int j = 0; j < 3; j++)
        plane.normal[j] /= length;
    plane.lowest = options->lowest;
    plane.height = options->lowest ? 0 : (options->height - offset) / length;
    plane.noise = options->noise / length;
    plane.noise_size = options->noise_size / shape_pow(fabs(shape_frame_determinant(frame)), 1.0 / 3);
    memcpy(key, &plane, sizeof plane);
    return SHAPE_OK;
}

/* The value of a lattice point, 0 to 1. */
static double lattice(int64_t x, int64_t y, int64_t z, uint64_t seed)
{
    uint64_t h = shape_hash(seed + shape_hash((uint64_t)x));
    h = shape_hash(h + shape_hash((uint64_t)y));
    return (double)(shape_hash(h + shape_hash((uint64_t)z)) >> 11) * 0x1p-53;
}

/* Value noise, 0 to 1: lattice values blended by 3t^2 - 2t^3. */
static double value_noise(shape_dvec3 p, uint64_t seed)
{
    const double at[3] = {p.x, p.y, p.z};
    int64_t cell[3];
    double weight[3], sum = 0;
    for (int k = 0; k < 3; k++) {
        if (!(fabs(at[k]) < 1e15))
            return 0;
        double whole = floor(at[k]), t = at[k] - whole;
        cell[k] = (int64_t)whole;
        weight[k] = t * t * (3 - 2 * t);
    }
    for (int corner = 0; corner < 8; corner++) {
        int dx = corner & 1, dy = corner >> 1 & 1, dz = corner >> 2;
        double w = (dx ? weight[0] : 1 - weight[0]) * (dy ? weight[1] : 1 - weight[1]) *
                   (dz ? weight[2] : 1 - weight[2]);
        sum += w * lattice(cell[0] + dx, cell[1] + dy, cell[2] + dz, seed);
    }
    return sum;
}

static double height_of(const local_plane *plane, const shape_ellipsoid *e)
{
    return plane->normal[0] * e->x + plane->normal[1] * e->y + plane->normal[2] * e->z;
}

/* How far the ellipsoid reaches along the plane's normal: |M^T n|. */
static double extent(const local_plane *plane, const shape_ellipsoid *e)
{
    shape_dvec3 axes[3], n = {plane->normal[0], plane->normal[1], plane->normal[2]};
    shape_axes_of(e, axes);
    double square = 0;
    for (int k = 0; k < 3; k++)
        square += shape_dvec3_dot(axes[k], n) * shape_dvec3_dot(axes[k], n);
    return sqrt(square);
}

/* 1 + (k - 1) n n^T about the centre, and the centre moved up so that the highest point stays. */
static shape_ellipsoid squash(const local_plane *plane, const shape_ellipsoid *e, double k, double reach)
{
    shape_frame map = shape_frame_identity();
    double height = height_of(plane, e);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            map.m[i][j] += (k - 1) * plane->normal[i] * plane->normal[j];
        /* The map takes the centre to centre + (k - 1) height n; undo that, then lift by (1 - k) reach. */
        map.m[i][3] = ((1 - k) * height + (1 - k) * reach) * plane->normal[i];
    }
    return shape_ellipsoid_transform(e, &map);
}

/* What the plane leaves of one primitive: -1 nothing, 0 all, 1 *image. */
static int cut_primitive(const local_plane *plane, const cut *state, const shape_ellipsoid *e,
                         shape_ellipsoid *image)
{
    double height = plane->height;
    if (plane->noise > 0) {
        shape_dvec3 p = {e->x / plane->noise_size, e->y / plane->noise_size, e->z / plane->noise_size};
        height -= plane->noise * value_noise(p, state->options->seed);
    }
    double above = height_of(plane, e) - height, reach = extent(plane, e);
    if (above < 0)
        return -1;
    if (above >= reach)
        return 0;
    *image = squash(plane, e, (above + reach) / (2 * reach), reach);
    return 1;
}

static double lowest_centre(const local_plane *plane, const shape_primitives *list)
{
    double lowest = INFINITY;
    for (size_t i = 0; i < list->sphere_count; i++) {
        shape_ellipsoid e = shape_axes_sphere(&list->spheres[i]);
        double height = height_of(plane, &e);
        lowest = height < lowest ? height : lowest;
    }
    for (size_t i = 0; i < list->ellipsoid_count; i++) {
        double height = height_of(plane, &list->ellipsoids[i]);
        lowest = height < lowest ? height : lowest;
    }
    return lowest;
}

static shape_status apply(shape_primitives *list, uint32_t number, const void *key, void *context,
                          shape_error *error)
{
    (void)number;
    cut *state = context;
    local_plane plane;
    memcpy(&plane, key, sizeof plane);
    if (plane.lowest > 0)
        plane.height = lowest_centre(&plane, list);
    size_t kept = 0, old_ellipsoids = list->ellipsoid_count;
    shape_ellipsoid image;
    shape_status status = SHAPE_OK;
    for (size_t i = 0; i < old_ellipsoids; i++) {
        int what = cut_primitive(&plane, state, &list->ellipsoids[i], &image);
        state->removed += what < 0;
        state->squashed += what > 0;
        if (what >= 0)
            list->ellipsoids[kept++] = what ? image : list->ellipsoids[i];
    }
    list->ellipsoid_count = kept;
    kept = 0;
    for (size_t i = 0; i < list->sphere_count && !status; i++) {
        shape_ellipsoid e = shape_axes_sphere(&list->spheres[i]);
        int what = cut_primitive(&plane, state, &e, &image);
        state->removed += what < 0;
        state->squashed += what > 0;
        if (what > 0)
            status = shape_primitives_add_ellipsoid(list, image, error);
        else if (!what)
            list->spheres[kept++] = list->spheres[i];
    }
    list->sphere_count = kept;
    return status;
}

shape_status shape_set_clip(shape_set *set, const bool *selected, const shape_clip *options, size_t *removed,
                            size_t *squashed, shape_error *error)
{
    shape_status status = shape_clip_check(options, error);
    if (status)
        return status;
    shape_clip copy = *options;
    cut state = {.options = &copy};
    shape_list_change change = {sizeof(local_plane), describe, apply, &state};
    status = shape_set_change_lists(set, selected, &change, error);
    if (removed)
        *removed = state.removed;
    if (squashed)
        *squashed = state.squashed;
    return status;
}
