/* Triangles to ellipsoids. Jiménez 2018: barycentre Eq. 22, scaled corners Eq. 23, radii Eq. 24, longest direction
 * Eq. 25 and 26, rotation Eq. 27 to 30. Eq. 27 divides by the length of a cross product, which is 0 for parallel and
 * opposite directions; here the rotation comes as a quaternion from half-angle formulas, without angle or division by
 * a sine, and is the same rotation wherever the paper's is defined. */
#include "shape/meshfit.h"

#include <float.h>

shape_meshfit shape_meshfit_defaults(void)
{
    shape_meshfit fit = {.kind = SHAPE_MESHFIT_PAPER, .scale = 1.1, .thickness = 0.3};
    return fit;
}

shape_status shape_meshfit_check(const shape_meshfit *fit, shape_error *error)
{
    if ((int)fit->kind < SHAPE_MESHFIT_PAPER || fit->kind > SHAPE_MESHFIT_PLANE)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "the fit is %d (it must be a known one)",
                               (int)fit->kind);
    if (!(fit->scale > 0 && fit->scale <= 100))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "scale is %g (it must be above 0, at most 100)",
                               fit->scale);
    if (!(fit->thickness >= 0.001 && fit->thickness <= 10))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "thickness is %g (it must be 0.001 to 10)",
                               fit->thickness);
    return SHAPE_OK;
}

/* A unit vector across the unit vector v. */
static shape_dvec3 across(shape_dvec3 v)
{
    shape_dvec3 helper = fabs(v.x) <= fabs(v.y) && fabs(v.x) <= fabs(v.z) ? shape_dvec3_make(1, 0, 0)
                         : fabs(v.y) <= fabs(v.z)                         ? shape_dvec3_make(0, 1, 0)
                                                                          : shape_dvec3_make(0, 0, 1);
    return shape_dvec3_normalize(shape_dvec3_cross(v, helper));
}

/* The smallest rotation that takes the coordinate axis to the unit vector v: cos(theta) = v[axis]. With h the half
 * angle, w = cos h = sqrt((1 + cos theta) / 2), and the vector part is (axis x v) / (2 w). Near the opposite direction
 * 1 + cos(theta) is formed from the other two components, as sin^2 / (1 - cos), so that nothing cancels. */
static shape_quat turn_axis(int axis, shape_dvec3 v)
{
    double c[3] = {v.x, v.y, v.z}, part[3] = {0, 0, 0};
    int j = (axis + 1) % 3, k = (axis + 2) % 3;
    double one_plus = c[axis] >= 0 ? 1 + c[axis] : (c[j] * c[j] + c[k] * c[k]) / (1 - c[axis]);
    double w = sqrt(one_plus / 2);
    if (w < 1e-150) { /* opposite: half a turn about any axis across */
        w = 0;
        part[j] = 1;
    } else {
        part[j] = -c[k] / (2 * w); /* e_axis x v = -c[k] e_j + c[j] e_k */
        part[k] = c[j] / (2 * w);
    }
    shape_quat q = {(float)part[0], (float)part[1], (float)part[2], (float)w};
    return shape_quat_normalize(q);
}

static void fit_paper(const shape_dvec3 spoke[3], bool rotate, double size[3], shape_quat *q)
{
    int longest = 0;
    for (int i = 0; i < 3; i++) {
        size[i] = shape_dvec3_length(spoke[i]);
        if (size[i] > size[longest])
            longest = i;
    }
    *q = rotate ? turn_axis(longest, shape_dvec3_scale(spoke[longest], 1 / size[longest]))
                : shape_quat_identity();
}

/* Steiner's circumellipse: the affine image of the circle about an equilateral triangle, through the three corners,
 * u cos t + w sin t with conjugate half-diameters u = P1 - B and w = (P2 - P3) / sqrt 3. One Jacobi rotation makes
 * them perpendicular, and so the semi-axes. */
static void fit_plane(const shape_dvec3 spoke[3], double thickness, double size[3], shape_quat *q)
{
    shape_dvec3 u = spoke[0], w = shape_dvec3_scale(shape_dvec3_sub(spoke[1], spoke[2]), 0.57735026918962576);
    double mixed = shape_dvec3_dot(u, w), difference = shape_dvec3_dot(u, u) - shape_dvec3_dot(w, w);
    double length = hypot(2 * mixed, difference);
    /* Half of the angle whose cosine is difference / length and whose sine is 2 mixed / length. */
    double c = 1, s = 0;
    if (length > 0) {
        c = sqrt(fmax(0.5 + 0.5 * difference / length, 0));
        s = sqrt(fmax(0.5 - 0.5 * difference / length, 0));
        if (mixed < 0)
            s = -s;
    }
    shape_dvec3 major = shape_dvec3_add(shape_dvec3_scale(u, c), shape_dvec3_scale(w, s));
    shape_dvec3 minor = shape_dvec3_sub(shape_dvec3_scale(w, c), shape_dvec3_scale(u, s));
    shape_dvec3 x = shape_dvec3_normalize(major);
    size[0] = shape_dvec3_length(major);
    /* What is left of the minor axis across the major one; nothing, where the triangle is a line. */
    minor = shape_dvec3_sub(minor, shape_dvec3_scale(x, shape_dvec3_dot(minor, x)));
    size[1] = shape_dvec3_length(minor);
    shape_dvec3 y = size[1] > 1e-12 * size[0] ? shape_dvec3_scale(minor, 1 / size[1]) : across(x);
    y = shape_dvec3_normalize(shape_dvec3_sub(y, shape_dvec3_scale(x, shape_dvec3_dot(x, y))));
    size[2] = thickness * sqrt(size[0] * size[1]);
    *q = shape_quat_from_columns(x, y, shape_dvec3_cross(x, y));
}

bool shape_meshfit_triangle(const shape_dvec3 corner[3], const shape_meshfit *fit, shape_ellipsoid *ellipsoid)
{
    /* Relative to a corner first: far from the origin the sum of three would round. */
    shape_dvec3 edge1 = shape_dvec3_sub(corner[1], corner[0]), edge2 = shape_dvec3_sub(corner[2], corner[0]);
    shape_dvec3 middle = shape_dvec3_scale(shape_dvec3_add(edge1, edge2), 1.0 / 3);
    shape_dvec3 spoke[3] = {shape_dvec3_scale(middle, -1), shape_dvec3_sub(edge1, middle),
                            shape_dvec3_sub(edge2, middle)};
    double unit = 0;
    for (int i = 0; i < 3; i++)
        unit = fmax(unit, fmax(fabs(spoke[i].x), fmax(fabs(spoke[i].y), fabs(spoke[i].z))));
    if (!(unit > 0) || !isfinite(unit))
        return false;
    /* Of size 1, so that squares neither vanish nor overflow. */
    for (int i = 0; i < 3; i++)
        spoke[i] = shape_dvec3_make(spoke[i].x / unit, spoke[i].y / unit, spoke[i].z / unit);
    double size[3];
    shape_quat q;
    if (fit->kind == SHAPE_MESHFIT_PLANE)
        fit_plane(spoke, fit->thickness, size, &q);
    else
        fit_paper(spoke, fit->kind == SHAPE_MESHFIT_PAPER, size, &q);
    double largest = fmax(size[0], fmax(size[1], size[2]));
    for (int i = 0; i < 3; i++)
        size[i] = fmax(size[i], SHAPE_MESHFIT_THINNEST * largest) * fit->scale * unit;
    shape_dvec3 centre = shape_dvec3_add(corner[0], middle);
    double far = fmax(fabs(centre.x), fmax(fabs(centre.y), fabs(centre.z)));
    if (!(far <= (double)FLT_MAX) || largest * fit->scale * unit > (double)FLT_MAX / 4 ||
        fmin(size[0], fmin(size[1], size[2])) < (double)FLT_MIN)
        return false;
    shape_ellipsoid result = {.x = (float)centre.x,
                              .y = (float)centre.y,
                              .z = (float)centre.z,
                              .a = (float)size[0],
                              .b = (float)size[1],
                              .c = (float)size[2],
                              .q = q};
    *ellipsoid = result;
    return true;
}

shape_status shape_meshfit_add(const shape_mesh *mesh, const shape_meshfit *fit, shape_primitives *list,
                               shape_error *error)
{
    size_t before = list->ellipsoid_count;
    shape_status status = shape_meshfit_check(fit, error);
    if (!status)
        status = shape_primitives_reserve(list, list->sphere_count, before + mesh->triangle_count, error);
    for (size_t t = 0; t < mesh->triangle_count && !status; t++) {
        shape_dvec3 corner[3];
        shape_ellipsoid ellipsoid;
        for (int i = 0; i < 3; i++)
            corner[i] = mesh->points[mesh->indices[3 * t + (size_t)i]];
        if (shape_meshfit_triangle(corner, fit, &ellipsoid))
            status = shape_primitives_add_ellipsoid(list, ellipsoid, error);
    }
    if (!status && list->ellipsoid_count == before)
        return shape_error_set(error, SHAPE_ERROR_LIMIT,
                               "no triangle can be kept in single precision (scale the mesh with --size)");
    return status;
}
