/* One set into another: a matching of primitives by halving both sides again and again, and the way between. */
#include "shape/morph.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "shape/combine.h"
#include "shape/transform.h"

/* One primitive's way: both ends as ellipsoids, the end's description nearest to the start's. Size 0 at an end that has
 * no such primitive is told by its semi-axes of 0. */
typedef struct morph_pair {
    shape_ellipsoid from, to;
} morph_pair;

typedef struct morph_cloud {
    morph_pair *pairs;
    size_t count;
    bool round; /* spheres at both ends of every pair */
} morph_cloud;

struct shape_morph {
    const shape_set *from, *to;
    morph_cloud *clouds; /* as many as the set with more clouds has */
    size_t cloud_count;
};

/* --- pairing --- */

typedef struct point {
    shape_ellipsoid shape;
    size_t number;
} point;

static double coordinate(const point *p, int axis)
{
    return (double)(&p->shape.x)[axis];
}

static int compare(const point *a, const point *b, int axis)
{
    double x = coordinate(a, axis), y = coordinate(b, axis);
    if (x != y)
        return x < y ? -1 : 1;
    return a->number < b->number ? -1 : 1;
}

static int compare_x(const void *a, const void *b)
{
    return compare(a, b, 0);
}
static int compare_y(const void *a, const void *b)
{
    return compare(a, b, 1);
}
static int compare_z(const void *a, const void *b)
{
    return compare(a, b, 2);
}

static void extents(const point *points, size_t count, double extent[3])
{
    for (int axis = 0; axis < 3; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < count; i++) {
            double at = coordinate(&points[i], axis); /* no fmin: gcc 12 for arm64 breaks down over it */
            low = at < low ? at : low;
            high = at > high ? at : high;
        }
        extent[axis] = high - low;
    }
}

/* The axis along which both sides together are longest. */
static int longest_axis(const point *a, size_t n, const point *b, size_t m)
{
    double ea[3], eb[3];
    extents(a, n, ea);
    extents(b, m, eb);
    int best = 0;
    for (int axis = 1; axis < 3; axis++)
        if (ea[axis] + eb[axis] > ea[best] + eb[best])
            best = axis;
    return best;
}

static void pair_up(morph_cloud *cloud, const point *a, const point *b)
{
    cloud->pairs[cloud->count].from = a->shape;
    cloud->pairs[cloud->count++].to = b->shape;
}

/* Pairs all of a with all of b; the pairs are as many as the larger side has points. */
static void match(morph_cloud *cloud, point *a, size_t n, point *b, size_t m)
{
    static int (*const by_axis[])(const void *, const void *) = {compare_x, compare_y, compare_z};
    if (n == 1 || m == 1) {
        for (size_t i = 0; i < (n > m ? n : m); i++)
            pair_up(cloud, &a[n > 1 ? i : 0], &b[m > 1 ? i : 0]);
        return;
    }
    int axis = longest_axis(a, n, b, m);
    qsort(a, n, sizeof *a, by_axis[axis]);
    qsort(b, m, sizeof *b, by_axis[axis]);
    /* The smaller side is halved, the larger in proportion, so that neither half has nothing to go to. */
    size_t half_a = n / 2, half_b = m / 2;
    if (n < m)
        half_b = (size_t)((double)m * (double)half_a / (double)n + 0.5);
    else if (m < n)
        half_a = (size_t)((double)n * (double)half_b / (double)m + 0.5);
    match(cloud, a, half_a, b, half_b);
    match(cloud, a + half_a, n - half_a, b + half_b, m - half_b);
}

static point *points_of(const shape_primitives *list)
{
    size_t count = 0;
    point *points = calloc(shape_primitives_count(list) + 1, sizeof *points);
    if (!points)
        return NULL;
    for (size_t i = 0; i < list->sphere_count; i++)
        points[count++].shape = shape_ellipsoid_from_sphere(&list->spheres[i]);
    for (size_t i = 0; i < list->ellipsoid_count; i++)
        points[count++].shape = list->ellipsoids[i];
    for (size_t i = 0; i < count; i++)
        points[i].number = i;
    return points;
}

/* --- turns --- */

static float dot(shape_quat a, shape_quat b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
}

static bool is_round(const shape_ellipsoid *e)
{
    return e->a == e->b && e->b == e->c;
}

/* Number `turn` of the 24 descriptions of one ellipsoid: its axes renamed and turned round, right-handed. */
static shape_ellipsoid describe(const shape_ellipsoid *e, int turn)
{
    static const int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    const int *order = orders[turn / 4];
    double matrix[3][3], sign[3] = {turn & 1 ? -1 : 1, turn & 2 ? -1 : 1, 1};
    sign[2] = sign[0] * sign[1] * (turn / 4 < 3 ? 1 : -1);
    shape_quat_matrix(e->q, matrix);
    shape_dvec3 column[3];
    shape_ellipsoid other = *e;
    for (int i = 0; i < 3; i++) {
        int from = order[i];
        column[i] =
            shape_dvec3_make(sign[i] * matrix[0][from], sign[i] * matrix[1][from], sign[i] * matrix[2][from]);
        (&other.a)[i] = (&e->a)[from];
    }
    other.q = shape_quat_from_columns(column[0], column[1], column[2]);
    return other;
}

/* Describes both ends so that the way from one to the other is the shortest. */
static void align(morph_pair *pair)
{
    if (is_round(&pair->from)) {
        pair->from.q = pair->to.q;
    } else if (is_round(&pair->to)) {
        pair->to.q = pair->from.q;
    } else {
        shape_ellipsoid best = pair->to;
        for (int turn = 0; turn < 24; turn++) {
            shape_ellipsoid other = describe(&pair->to, turn);
            if (fabsf(dot(other.q, pair->from.q)) > fabsf(dot(best.q, pair->from.q)) + 1e-6f)
                best = other;
        }
        pair->to = best;
    }
}

static shape_ellipsoid vanished(const shape_ellipsoid *e)
{
    shape_ellipsoid none = *e;
    none.a = none.b = none.c = 0;
    return none;
}

static shape_status prepare(morph_cloud *cloud, const shape_primitives *from, const shape_primitives *to,
                            shape_error *error)
{
    size_t n = from ? shape_primitives_count(from) : 0, m = to ? shape_primitives_count(to) : 0;
    point *a = from ? points_of(from) : NULL, *b = to ? points_of(to) : NULL;
    cloud->pairs = calloc((n > m ? n : m) + 1, sizeof *cloud->pairs);
    shape_status status = SHAPE_OK;
    if ((from && !a) || (to && !b) || !cloud->pairs)
        status = shape_error_memory(error);
    else if (n && m)
        match(cloud, a, n, b, m);
    else
        for (size_t i = 0; i < n + m; i++) {
            morph_pair *pair = &cloud->pairs[cloud->count++];
            pair->from = n ? a[i].shape : vanished(&b[i].shape);
            pair->to = m ? b[i].shape : vanished(&a[i].shape);
        }
    cloud->round = true;
    for (size_t i = 0; i < cloud->count; i++) {
        align(&cloud->pairs[i]);
        cloud->round = cloud->round && is_round(&cloud->pairs[i].from) && is_round(&cloud->pairs[i].to);
    }
    free(a);
    free(b);
    return status;
}

static shape_status check_models(const shape_cloud *a, const shape_cloud *b, shape_error *error)
{
    if (a->field.model != b->field.model)
        return shape_error_set(
            error, SHAPE_ERROR_ARGUMENT,
            "clouds \"%s\" and \"%s\" have different density models (give both the same by "
            "neph-edit --model)",
            a->name, b->name);
    if (a->field.model == SHAPE_MODEL_LAYER || a->field.model == SHAPE_MODEL_GRID)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "cloud \"%s\" is not made of primitives that could move", a->name);
    return SHAPE_OK;
}

shape_status shape_morph_create(const shape_set *from, const shape_set *to, shape_morph **morph,
                                shape_error *error)
{
    shape_morph *made = calloc(1, sizeof *made);
    if (!made)
        return shape_error_memory(error);
    made->from = from;
    made->to = to;
    made->cloud_count = from->cloud_count > to->cloud_count ? from->cloud_count : to->cloud_count;
    made->clouds = calloc(made->cloud_count + 1, sizeof *made->clouds);
    shape_status status = made->clouds ? SHAPE_OK : shape_error_memory(error);
    for (size_t i = 0; i < made->cloud_count && !status; i++) {
        bool in_from = i < from->cloud_count, in_to = i < to->cloud_count;
        if (in_from && in_to)
            status = check_models(&from->clouds[i], &to->clouds[i], error);
        if (!status)
            status = prepare(&made->clouds[i], in_from ? shape_set_list_const(from, i) : NULL,
                             in_to ? shape_set_list_const(to, i) : NULL, error);
    }
    if (status)
        shape_morph_destroy(made);
    else
        *morph = made;
    return status;
}

void shape_morph_destroy(shape_morph *morph)
{
    if (!morph)
        return;
    for (size_t i = 0; morph->clouds && i < morph->cloud_count; i++)
        free(morph->clouds[i].pairs);
    free(morph->clouds);
    free(morph);
}

/* --- the way between --- */

static float between(float a, float b, double t)
{
    return (float)((1 - t) * (double)a + t * (double)b);
}

static shape_ellipsoid pair_at(const morph_pair *pair, double t)
{
    const shape_ellipsoid *a = &pair->from, *b = &pair->to;
    shape_ellipsoid e = *a;
    for (int i = 0; i < 3; i++) {
        (&e.x)[i] = between((&a->x)[i], (&b->x)[i], t);
        (&e.a)[i] = between((&a->a)[i], (&b->a)[i], t);
    }
    float side = dot(a->q, b->q) < 0 ? -1.0f : 1.0f;
    shape_quat q = {between(a->q.x, side * b->q.x, t), between(a->q.y, side * b->q.y, t),
                    between(a->q.z, side * b->q.z, t), between(a->q.w, side * b->q.w, t)};
    e.q = shape_quat_normalize(q);
    return e;
}

static void mix_field(shape_field *field, const shape_field *to, double t)
{
    field->kappa = between(field->kappa, to->kappa, t);
    field->edge = between(field->edge, to->edge, t);
    field->octaves = (int)floor((1 - t) * field->octaves + t * to->octaves + 0.5);
    /* By equal factors: a scale is a ratio. exp and log of the C library are no part of what generators write. */
    if (field->noise_scale > 0 && to->noise_scale > 0 && t > 0)
        field->noise_scale = t < 1 ? field->noise_scale * powf(to->noise_scale / field->noise_scale, (float)t)
                                   : to->noise_scale;
    shape_detail *d = &field->detail;
    const shape_detail *e = &to->detail;
    d->smoothness = between(d->smoothness, e->smoothness, t);
    d->displace = between(d->displace, e->displace, t);
    d->displace_scale = between(d->displace_scale, e->displace_scale, t);
    d->billow = between(d->billow, e->billow, t);
    d->wisp = between(d->wisp, e->wisp, t);
    d->detail_depth = between(d->detail_depth, e->detail_depth, t);
    d->detail_scale = between(d->detail_scale, e->detail_scale, t);
}

static void mix_medium(shape_medium *medium, const shape_medium *to, double t)
{
    medium->extinction = between(medium->extinction, to->extinction, t);
    medium->albedo = between(medium->albedo, to->albedo, t);
    medium->g = between(medium->g, to->g, t);
    medium->g2 = between(medium->g2, to->g2, t);
    medium->lobe_mix = between(medium->lobe_mix, to->lobe_mix, t);
    medium->droplet = between(medium->droplet, to->droplet, t);
    if (t >= 0.5)
        medium->phase = to->phase;
}

static shape_status mix_frame(shape_frame *frame, const shape_frame *to, double t, const char *name,
                              shape_error *error)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            frame->m[i][j] = (1 - t) * frame->m[i][j] + t * to->m[i][j];
    shape_frame inverse;
    if (!shape_frame_invert(frame, &inverse))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "cloud \"%s\" is turned so far that there is no straight way (turn one of the "
                               "two by less than half a turn)",
                               name);
    return SHAPE_OK;
}

static shape_status fill(shape_primitives *list, const morph_cloud *cloud, double t, shape_error *error)
{
    shape_status status = shape_primitives_reserve(list, cloud->round ? cloud->count : 0,
                                                   cloud->round ? 0 : cloud->count, error);
    for (size_t i = 0; i < cloud->count && !status; i++) {
        shape_ellipsoid e = pair_at(&cloud->pairs[i], t);
        shape_sphere s = {e.x, e.y, e.z, e.a};
        if (!(e.a > 0 && e.b > 0 && e.c > 0))
            continue; /* not born yet, or gone */
        status = cloud->round ? shape_primitives_add_sphere(list, s, error)
                              : shape_primitives_add_ellipsoid(list, e, error);
    }
    return status;
}

shape_status shape_morph_at(const shape_morph *morph, double share, shape_set **set, shape_error *error)
{
    if (!(share >= 0 && share <= 1))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "a share of %g is not within 0 to 1", share);
    shape_set *made = shape_set_create(error);
    if (!made)
        return SHAPE_ERROR_MEMORY;
    shape_status status = SHAPE_OK;
    for (size_t i = 0; i < morph->cloud_count && !status; i++) {
        bool in_from = i < morph->from->cloud_count;
        shape_cloud cloud = in_from ? morph->from->clouds[i] : morph->to->clouds[i];
        size_t index = 0;
        status = shape_set_add_cloud(made, cloud.name, &index, error);
        if (!status && in_from && i < morph->to->cloud_count) {
            const shape_cloud *to = &morph->to->clouds[i];
            mix_field(&cloud.field, &to->field, share);
            mix_medium(&cloud.medium, &to->medium, share);
            status = mix_frame(&cloud.frame, &to->frame, share, cloud.name, error);
        }
        if (status)
            break;
        memcpy(cloud.name, made->clouds[index].name, sizeof cloud.name);
        cloud.list = made->clouds[index].list;
        made->clouds[index] = cloud;
        status = fill(shape_set_list(made, index), &morph->clouds[i], share, error);
    }
    if (status)
        shape_set_destroy(made);
    else
        *set = made;
    return status;
}
