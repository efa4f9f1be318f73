/* Placements of clouds, and primitives under linear maps. An ellipsoid's image has the columns of A R diag(a, b, c) for
 * conjugate half-diameters; primitive/axes.c turns them into its axes. */
#include "shape/transform.h"

#include <stdlib.h>
#include <string.h>

#include "primitive/axes.h"
#include "shape/combine.h"
#include "shape/random.h"

shape_transform shape_transform_defaults(void)
{
    shape_transform transform = {.scale = {1, 1, 1}};
    return transform;
}

static shape_status out_of_range(const char *what, double value, const char *range, shape_error *error)
{
    return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "%s is %g (it must be %s)", what, value, range);
}

shape_status shape_transform_check(const shape_transform *t, shape_error *error)
{
    for (int i = 0; i < 3; i++) {
        if (!(t->scale[i] >= 1e-6 && t->scale[i] <= 1e6))
            return out_of_range("a scale", t->scale[i], "1e-6 to 1e6; to mirror, use the mirror", error);
        if (!(fabs(t->rotate[i]) <= 1e6))
            return out_of_range("a rotation", t->rotate[i], "-1e6 to 1e6 degrees", error);
        if (!(fabs(t->translate[i]) <= 1e12))
            return out_of_range("a translation", t->translate[i], "-1e12 to 1e12", error);
        if (!(fabs(t->pivot[i]) <= 1e12))
            return out_of_range("a pivot coordinate", t->pivot[i], "-1e12 to 1e12", error);
    }
    return SHAPE_OK;
}

/* Sine and cosine of degrees, exact at every multiple of 90. */
static void turn_of(double degrees, double *sine, double *cosine)
{
    double quarters = floor(degrees / 90 + 0.5), rest = (degrees - 90 * quarters) * 0.017453292519943295;
    double s = shape_sin(rest), c = shape_cos(rest);
    switch ((int)(quarters - 4 * floor(quarters / 4))) {
    case 0:
        *sine = s, *cosine = c;
        break;
    case 1:
        *sine = c, *cosine = -s;
        break;
    case 2:
        *sine = -s, *cosine = -c;
        break;
    default:
        *sine = -c, *cosine = s;
        break;
    }
}

static shape_frame rotation(int axis, double degrees)
{
    shape_frame frame = shape_frame_identity();
    int a = (axis + 1) % 3, b = (axis + 2) % 3;
    double sine, cosine;
    turn_of(degrees, &sine, &cosine);
    frame.m[a][a] = frame.m[b][b] = cosine;
    frame.m[a][b] = -sine;
    frame.m[b][a] = sine;
    return frame;
}

static shape_frame translation(const double by[3], double sign)
{
    shape_frame frame = shape_frame_identity();
    for (int i = 0; i < 3; i++)
        frame.m[i][3] = sign * by[i];
    return frame;
}

/* The transformation with these factors for its scale. */
static shape_frame placement(const shape_transform *t, const double scale[3])
{
    shape_frame frame = translation(t->pivot, -1), step = shape_frame_identity();
    for (int i = 0; i < 3; i++)
        step.m[i][i] = t->mirror[i] ? -scale[i] : scale[i];
    frame = shape_frame_multiply(&step, &frame);
    for (int i = 0; i < 3; i++) {
        step = rotation(i, t->rotate[i]);
        frame = shape_frame_multiply(&step, &frame);
    }
    step = translation(t->pivot, 1);
    frame = shape_frame_multiply(&step, &frame);
    step = translation(t->translate, 1);
    return shape_frame_multiply(&step, &frame);
}

shape_frame shape_transform_frame(const shape_transform *transform)
{
    return placement(transform, transform->scale);
}

shape_ellipsoid shape_ellipsoid_from_sphere(const shape_sphere *sphere)
{
    return shape_axes_sphere(sphere);
}

shape_ellipsoid shape_ellipsoid_transform(const shape_ellipsoid *e, const shape_frame *map)
{
    shape_dvec3 axes[3], centre = shape_frame_point(map, shape_dvec3_make(e->x, e->y, e->z));
    shape_axes_of(e, axes);
    for (int k = 0; k < 3; k++)
        axes[k] = shape_frame_direction(map, axes[k]);
    shape_axes_diagonalize(axes);
    double length[3];
    for (int k = 0; k < 3; k++) {
        length[k] = shape_dvec3_length(axes[k]);
        axes[k] = shape_dvec3_normalize(axes[k]);
    }
    if (shape_dvec3_dot(shape_dvec3_cross(axes[0], axes[1]), axes[2]) < 0)
        axes[2] = shape_dvec3_scale(axes[2], -1); /* an axis has no sign, a rotation has */
    shape_ellipsoid image = {.x = (float)centre.x,
                             .y = (float)centre.y,
                             .z = (float)centre.z,
                             .a = (float)length[0],
                             .b = (float)length[1],
                             .c = (float)length[2],
                             .q = shape_quat_from_columns(axes[0], axes[1], axes[2])};
    return image;
}

/* The factor of a similarity, or 0 where the map is none (to 1e-12). */
static double similarity(const shape_frame *map)
{
    shape_dvec3 column[3];
    for (int k = 0; k < 3; k++)
        column[k] = shape_dvec3_make(map->m[0][k], map->m[1][k], map->m[2][k]);
    double square = shape_dvec3_dot(column[0], column[0]);
    for (int k = 0; k < 3; k++) {
        double other = shape_dvec3_dot(column[k], column[k]);
        double mixed = shape_dvec3_dot(column[k], column[(k + 1) % 3]);
        if (!(fabs(other - square) <= 1e-12 * square && fabs(mixed) <= 1e-12 * square))
            return 0;
    }
    return sqrt(square);
}

shape_status shape_primitives_transform(shape_primitives *list, const shape_frame *map, shape_error *error)
{
    double factor = similarity(map);
    shape_primitives image = {0};
    shape_status status = shape_primitives_reserve(&image, factor > 0 ? list->sphere_count : 0,
                                                   shape_primitives_count(list), error);
    for (size_t i = 0; i < list->sphere_count && !status; i++) {
        const shape_sphere *s = &list->spheres[i];
        if (factor > 0) {
            shape_dvec3 c = shape_frame_point(map, shape_dvec3_make(s->x, s->y, s->z));
            shape_sphere sphere = {(float)c.x, (float)c.y, (float)c.z, (float)(s->radius * factor)};
            status = shape_primitives_add_sphere(&image, sphere, error);
        } else {
            shape_ellipsoid e = shape_axes_sphere(s);
            status = shape_primitives_add_ellipsoid(&image, shape_ellipsoid_transform(&e, map), error);
        }
    }
    for (size_t i = 0; i < list->ellipsoid_count && !status; i++)
        status = shape_primitives_add_ellipsoid(&image, shape_ellipsoid_transform(&list->ellipsoids[i], map),
                                                error);
    shape_primitives gone = status ? image : *list;
    if (!status)
        *list = image;
    free(gone.spheres);
    free(gone.ellipsoids);
    return status;
}

/* The linear part of a frame. */
static shape_frame linear_part(const shape_frame *frame)
{
    shape_frame linear = *frame;
    for (int i = 0; i < 3; i++)
        linear.m[i][3] = 0;
    return linear;
}

/* L^-1 S L: what unequal scaling of the world is to a cloud's primitives. Exactly diagonal where L is. */
static shape_status describe_scale(const shape_set *set, size_t cloud, void *key, void *context,
                                   shape_error *error)
{
    const shape_transform *t = context;
    shape_frame linear = linear_part(&set->clouds[cloud].frame), scale = shape_frame_identity(), inverse, map;
    if (!shape_frame_invert(&linear, &inverse))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "cloud \"%s\" has a frame without an inverse",
                               set->clouds[cloud].name);
    for (int i = 0; i < 3; i++)
        scale.m[i][i] = t->scale[i];
    map = shape_frame_multiply(&scale, &linear);
    map = shape_frame_multiply(&inverse, &map);
    memcpy(key, &map, sizeof map);
    return SHAPE_OK;
}

static shape_status apply_scale(shape_primitives *list, uint32_t number, const void *key, void *context,
                                shape_error *error)
{
    (void)number, (void)context;
    shape_frame map;
    memcpy(&map, key, sizeof map);
    return shape_primitives_transform(list, &map, error);
}

/* The field's own lengths. */
static void scale_lengths(shape_field *field, double factor)
{
    float *lengths[] = {&field->noise_scale, &field->detail.displace, &field->detail.displace_scale,
                        &field->detail.detail_scale, &field->layer.planet_radius};
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++)
        *lengths[i] = (float)((double)*lengths[i] * factor);
}

/* Frame, lengths of the field and extinction of one cloud. */
static shape_status transform_cloud(shape_cloud *cloud, const shape_transform *t, bool equal,
                                    shape_error *error)
{
    shape_frame whole = shape_transform_frame(t), frame = shape_frame_multiply(&whole, &cloud->frame);
    double factor = t->scale[0];
    if (!equal) {
        static const double one[3] = {1, 1, 1};
        shape_frame turned = placement(t, one);
        turned = shape_frame_multiply(&turned, &cloud->frame);
        for (int i = 0; i < 3; i++)
            memcpy(frame.m[i], turned.m[i], 3 * sizeof turned.m[i][0]);
        factor = shape_pow(t->scale[0] * t->scale[1] * t->scale[2], 1.0 / 3);
        scale_lengths(&cloud->field, factor);
    }
    cloud->frame = frame;
    if (t->keep_depth)
        cloud->medium.extinction = (float)(cloud->medium.extinction / factor);
    shape_status status = shape_field_check(&cloud->field, error);
    return status ? status : shape_medium_check(&cloud->medium, error);
}

shape_status shape_set_transform(shape_set *set, const bool *selected, const shape_transform *transform,
                                 shape_error *error)
{
    shape_status status = shape_transform_check(transform, error);
    if (status)
        return status;
    bool equal = transform->scale[0] == transform->scale[1] && transform->scale[1] == transform->scale[2];
    if (!equal) {
        shape_transform copy = *transform;
        shape_list_change change = {sizeof(shape_frame), describe_scale, apply_scale, &copy};
        status = shape_set_change_lists(set, selected, &change, error);
    }
    for (size_t i = 0; i < set->cloud_count && !status; i++)
        if (!selected || selected[i])
            status = transform_cloud(&set->clouds[i], transform, equal, error);
    return status;
}

shape_status shape_cloud_transform(shape_cloud *cloud, const shape_transform *transform, shape_error *error)
{
    const double *scale = transform->scale;
    shape_status status = shape_transform_check(transform, error);
    if (!status && !(scale[0] == scale[1] && scale[1] == scale[2]))
        status = shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                                 "scale %g,%g,%g: one cloud's frame takes equal factors only", scale[0],
                                 scale[1], scale[2]);
    return status ? status : transform_cloud(cloud, transform, true, error);
}
