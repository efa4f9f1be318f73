/* Primitives as a lattice of voxels sees them: centres, boxes and quadratic forms in voxel units. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "field/voxels_private.h"

/* The world's x, y, z in output axes: with z up, x, -z, y. */
static void turn(bool z_up, const double from[3], double to[3])
{
    to[0] = from[0];
    to[1] = z_up ? -from[2] : from[1];
    to[2] = z_up ? from[1] : from[2];
}

shape_dvec3 shape_voxel_point(const shape_voxel_lattice *l, const int32_t index[3])
{
    double v[3];
    for (int k = 0; k < 3; k++)
        v[k] = index[k] * l->edge + l->origin[k];
    return l->z_up ? shape_dvec3_make(v[0], v[2], -v[1]) : shape_dvec3_make(v[0], v[1], v[2]);
}

/* How a cloud's frame lies in the lattice. */
typedef struct placing {
    double to[3][3], back[3][3]; /* directions: cloud to voxels and back */
    double offset[3];            /* of the cloud's origin [voxels] */
    double scale;                /* of a placing that keeps angles, else 0 */
    double stretch;              /* no length grows by more */
} placing;

static placing place(const shape_volume_cloud *cloud, const shape_voxel_lattice *l)
{
    placing p;
    double column[3], turned[3], sum = 0;
    for (int j = 0; j < 4; j++) {
        for (int i = 0; i < 3; i++)
            column[i] = cloud->frame.m[i][j];
        turn(l->z_up, column, turned);
        for (int i = 0; i < 3; i++) {
            if (j < 3)
                p.to[i][j] = turned[i] / l->edge;
            else
                p.offset[i] = (turned[i] - l->origin[i]) / l->edge;
        }
    }
    for (int i = 0; i < 3; i++) { /* a row of the inverse is turned as a column is */
        turn(l->z_up, cloud->inverse.m[i], turned);
        for (int j = 0; j < 3; j++)
            p.back[i][j] = turned[j] * l->edge;
    }
    double dots[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            dots[i][j] = 0;
            for (int k = 0; k < 3; k++)
                dots[i][j] += p.to[k][i] * p.to[k][j];
            sum += i == j ? dots[i][j] : 0;
        }
    p.stretch = sqrt(sum);
    bool keeps = true;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            keeps = keeps && fabs(dots[i][j] - (i == j ? dots[0][0] : 0)) <= 1e-9 * dots[0][0];
    p.scale = keeps ? sqrt(dots[0][0]) : 0;
    return p;
}

/* The least and greatest semi-axis of u = |m v|, from bounds on the matrix' norm: not above and not below the true ones. */
static void measure(voxel_form *f, const double ball_to[3][3])
{
    double out = 0, back = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            out += ball_to[i][j] * ball_to[i][j];
            back += (double)f->m[i][j] * (double)f->m[i][j];
        }
    f->thin = (float)(1 / sqrt(back));
    f->fat = (float)sqrt(out);
}

/* The form of an ellipsoid with centre c, axes a along the columns of r, both in the cloud's frame. */
static void shape_form(voxel_form *f, const placing *p, const double c[3], const double a[3],
                       const double r[3][3])
{
    double ball_to[3][3]; /* the unit ball to voxels */
    for (int i = 0; i < 3; i++) {
        f->c[i] = p->offset[i];
        double square = 0;
        for (int j = 0; j < 3; j++) {
            double sum = 0, back = 0;
            for (int k = 0; k < 3; k++) {
                sum += p->to[i][k] * r[k][j];
                back += r[k][i] * p->back[k][j];
            }
            f->c[i] += p->to[i][j] * c[j];
            ball_to[i][j] = sum * a[j];
            f->m[i][j] = (float)(back / a[i]);
            square += ball_to[i][j] * ball_to[i][j];
        }
        f->h[i] = (float)sqrt(square);
    }
    measure(f, ball_to);
}

/* The form of a ball that stays one. */
static void ball_form(voxel_form *f, const placing *p, const shape_sphere *s, double support)
{
    double radius = (double)s->radius * support, to_unit = 1 / radius;
    f->radius = f->thin = f->fat = (float)(radius * p->scale);
    for (int i = 0; i < 3; i++) {
        f->c[i] = p->offset[i] + p->to[i][0] * (double)s->x + p->to[i][1] * (double)s->y +
                  p->to[i][2] * (double)s->z;
        f->h[i] = f->radius;
        for (int j = 0; j < 3; j++)
            f->m[i][j] = (float)(p->back[i][j] * to_unit);
    }
}

static const double identity[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

static void add_cloud(const shape_volume *volume, size_t index, const shape_voxel_lattice *lattice,
                      voxel_forms *forms)
{
    const shape_volume_cloud *cloud = &volume->clouds[index];
    const shape_primitives *list = cloud->list;
    placing p = place(cloud, lattice);
    double support = (double)cloud->support, reach = 0;
    for (int k = 0; k < 3; k++)
        reach = fmax(reach, fmax(fabs((double)(&cloud->box.min.x)[k]), fabs((double)(&cloud->box.max.x)[k])));
    float slack = (float)(1e-3 + 1e-6 * reach * p.stretch);
    voxel_form *to = forms->items + forms->count;
#pragma omp parallel for schedule(static) if (list->sphere_count > 10000)
    for (size_t i = 0; i < list->sphere_count; i++) {
        const shape_sphere *s = &list->spheres[i];
        double r = (double)s->radius * support;
        voxel_form *f = &to[i];
        f->radius = 0;
        if (p.scale > 0)
            ball_form(f, &p, s, support);
        else
            shape_form(f, &p, (double[3]){(double)s->x, (double)s->y, (double)s->z}, (double[3]){r, r, r},
                       identity);
        f->slack = slack, f->cloud = (uint32_t)index, f->content = (int32_t)(i + 1);
    }
    to += list->sphere_count;
#pragma omp parallel for schedule(static) if (list->ellipsoid_count > 10000)
    for (size_t i = 0; i < list->ellipsoid_count; i++) {
        const shape_ellipsoid *e = &list->ellipsoids[i];
        double r[3][3];
        voxel_form *f = &to[i];
        shape_quat_matrix(e->q, r);
        shape_form(f, &p, (double[3]){(double)e->x, (double)e->y, (double)e->z},
                   (double[3]){(double)e->a * support, (double)e->b * support, (double)e->c * support}, r);
        f->radius = 0;
        f->slack = slack, f->cloud = (uint32_t)index, f->content = -(int32_t)(i + 1);
    }
    forms->count += shape_primitives_count(list);
}

shape_status voxel_forms_make(const shape_volume *volume, int cloud, const shape_voxel_lattice *lattice,
                              voxel_forms *forms, shape_error *error)
{
    size_t count = 0;
    for (size_t i = 0; i < volume->cloud_count; i++)
        if (cloud < 0 || i == (size_t)cloud)
            count += shape_primitives_count(volume->clouds[i].list);
    forms->count = 0;
    if (count > INT32_MAX)
        return shape_error_set(error, SHAPE_ERROR_LIMIT, "more than 2^31 primitives (split the set)");
    forms->items = malloc((count ? count : 1) * sizeof *forms->items);
    if (!forms->items)
        return shape_error_memory(error);
    for (size_t i = 0; i < volume->cloud_count; i++)
        if (cloud < 0 || i == (size_t)cloud)
            add_cloud(volume, i, lattice, forms);
    return SHAPE_OK;
}

/* A cloud's box: around its forms, and no more than the placed box of its own frame, which of a layer is closer. */
static void cloud_bounds(const shape_volume_cloud *cloud, const voxel_form *forms, size_t count, bool z_up,
                         double min[3], double max[3])
{
    for (int k = 0; k < 3; k++)
        min[k] = INFINITY, max[k] = -INFINITY;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            min[k] = fmin(min[k], forms[i].c[k] - (double)forms[i].h[k]);
            max[k] = fmax(max[k], forms[i].c[k] + (double)forms[i].h[k]);
        }
    shape_dvec3 low, high;
    shape_frame_box(&cloud->frame, cloud->box, &low, &high);
    double a[3], b[3];
    turn(z_up, (double[3]){low.x, low.y, low.z}, a);
    turn(z_up, (double[3]){high.x, high.y, high.z}, b);
    for (int k = 0; k < 3; k++) {
        min[k] = fmax(min[k], fmin(a[k], b[k]));
        max[k] = fmin(max[k], fmax(a[k], b[k]));
    }
}

shape_status shape_voxels_bounds(const shape_volume *volume, int cloud, bool z_up, double min[3],
                                 double max[3], bool *any, shape_error *error)
{
    const shape_voxel_lattice metres = {.edge = 1, .z_up = z_up};
    *any = false;
    for (size_t i = 0; i < volume->cloud_count; i++) {
        voxel_forms forms = {0};
        double low[3], high[3];
        if ((cloud >= 0 && i != (size_t)cloud) || !shape_primitives_count(volume->clouds[i].list))
            continue;
        shape_status status = voxel_forms_make(volume, (int)i, &metres, &forms, error);
        if (status)
            return status;
        cloud_bounds(&volume->clouds[i], forms.items, forms.count, z_up, low, high);
        free(forms.items);
        for (int k = 0; k < 3; k++) {
            min[k] = *any ? fmin(min[k], low[k]) : low[k];
            max[k] = *any ? fmax(max[k], high[k]) : high[k];
        }
        *any = true;
    }
    return SHAPE_OK;
}

shape_status shape_voxels_lay_out(const double min[3], const double max[3], double edge, bool z_up,
                                  shape_voxel_lattice *lattice, shape_error *error)
{
    if (!(edge > 0) || !isfinite(edge))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "a voxel of %g m (it must be above 0)", edge);
    memset(lattice, 0, sizeof *lattice);
    lattice->edge = edge;
    lattice->z_up = z_up;
    for (int k = 0; k < 3; k++) {
        double voxels = (max[k] - min[k]) / edge;
        if (!(voxels <= SHAPE_VOXEL_MOST))
            return shape_error_set(error, SHAPE_ERROR_LIMIT,
                                   "a voxel of %g m makes more than %d voxels a side (take a larger one)",
                                   edge, SHAPE_VOXEL_MOST);
        double whole = fmax(1, ceil(voxels - 1e-6));
        lattice->size[k] = (int32_t)whole;
        /* What a whole number of voxels has too much lies on both sides alike. */
        lattice->origin[k] = min[k] + 0.5 * edge - 0.5 * edge * (whole - voxels);
    }
    return SHAPE_OK;
}
