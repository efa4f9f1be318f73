/* Wind, shear, drifting noise, growth and decay: a moment of a set from the set at rest. */
#include "shape/motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "shape/combine.h"
#include "shape/noise.h"
#include "shape/random.h"

static const double smallest = 1e-3; /* of a primitive's size; less is left out */

static shape_status check_number(const char *name, double value, double low, double high, shape_error *error)
{
    if (value >= low && value <= high)
        return SHAPE_OK;
    return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "%s is %g (choose %g to %g)", name, value, low, high);
}

shape_status shape_motion_check(const shape_motion *m, shape_error *error)
{
    shape_status status = SHAPE_OK;
    for (int i = 0; i < 3 && !status; i++) {
        status = check_number("wind", m->wind[i], -1000, 1000, error);
        if (!status)
            status = check_number("drift", m->drift[i], -1000, 1000, error);
    }
    if (!status)
        status = check_number("shear", m->shear, -10, 10, error);
    if (!status && m->life != 0)
        status = check_number("life", m->life, 1e-3, 1e9, error);
    if (!status)
        status = check_number("grow", m->grow, 0, 1e9, error);
    if (!status)
        status = check_number("decay_start", m->decay_start, -1e9, 1e9, error);
    return status ? status : check_number("decay", m->decay, 0, 1e9, error);
}

static bool moves(const double v[3])
{
    return v[0] != 0 || v[1] != 0 || v[2] != 0;
}

bool shape_motion_is_on(const shape_motion *m)
{
    return moves(m->wind) || moves(m->drift) || m->shear != 0 || m->life > 0 || m->grow > 0 || m->decay > 0;
}

/* 0 up to 0, 1 from 1 on, smooth between. */
static double smooth(double x)
{
    x = x < 0 ? 0 : x > 1 ? 1 : x;
    return x * x * (3 - 2 * x);
}

double shape_motion_size(double age)
{
    return smooth(4 * age) * smooth(4 * (1 - age));
}

/* What a list's change depends on: equal keys share the changed list. Every byte is set. */
typedef struct change_key {
    double drift[3];     /* of the noise [m, cloud's frame] */
    double lean[3];      /* of the shear [m/s a metre of height above the base, cloud's frame] */
    double height[4];    /* of a point above the base, in metres of the world: height[0..2] . p + height[3] */
    double low, inverse; /* of the heights within the cloud */
} change_key;

typedef struct change_context {
    const shape_motion *motion;
    double time, base; /* base: y of the clouds' lowest point */
    shape_dvec3 ahead; /* the shear's direction */
} change_context;

/* A number in [0, 1) of a primitive; those of one list lie evenly. */
static double unit_of(uint64_t seed, uint32_t list, size_t primitive)
{
    double start = (double)(shape_hash(seed ^ shape_hash(list + 1)) >> 11) / 9007199254740992.0;
    double x = start + 0.6180339887498949 * (double)primitive;
    return x - floor(x);
}

/* A primitive's age in its present life, 0 to 1. */
static double age_of(const change_context *c, double unit)
{
    double x = c->time / c->motion->life + unit;
    return x - floor(x);
}

/* The share of its size that a primitive has; `relative` is its height in the cloud, 0 to 1. */
static double size_of(const change_context *c, double unit, double relative)
{
    const shape_motion *m = c->motion;
    double size = m->life > 0 ? shape_motion_size(age_of(c, unit)) : 1;
    if (m->grow > 0)
        size *= smooth((c->time / m->grow - 0.6 * relative) / 0.4);
    if (m->decay > 0)
        size *= 1 - smooth(((c->time - m->decay_start) / m->decay - 0.6 * unit) / 0.4);
    return size;
}

/* Where a primitive goes within its cloud, and the share of its size. */
static double place(const change_context *c, const change_key *key, uint32_t list, size_t primitive, float *x,
                    float *y, float *z)
{
    double unit = unit_of(c->motion->seed, list, primitive);
    double above = key->height[0] * (double)*x + key->height[1] * (double)*y + key->height[2] * (double)*z +
                   key->height[3];
    double lean = c->motion->life > 0 ? above * (age_of(c, unit) - 0.5) * c->motion->life : 0;
    *x = (float)((double)*x - key->drift[0] + lean * key->lean[0]);
    *y = (float)((double)*y - key->drift[1] + lean * key->lean[1]);
    *z = (float)((double)*z - key->drift[2] + lean * key->lean[2]);
    return size_of(c, unit, (above - key->low) * key->inverse);
}

static shape_status change_list(shape_primitives *list, uint32_t number, const void *key, void *context,
                                shape_error *error)
{
    (void)error;
    size_t kept = 0, spheres = list->sphere_count;
    for (size_t i = 0; i < spheres; i++) {
        shape_sphere s = list->spheres[i];
        double size = place(context, key, number, i, &s.x, &s.y, &s.z);
        s.radius = (float)((double)s.radius * size);
        if (size > smallest)
            list->spheres[kept++] = s;
    }
    list->sphere_count = kept;
    kept = 0;
    for (size_t i = 0; i < list->ellipsoid_count; i++) {
        shape_ellipsoid e = list->ellipsoids[i];
        double size = place(context, key, number, spheres + i, &e.x, &e.y, &e.z);
        e.a = (float)((double)e.a * size);
        e.b = (float)((double)e.b * size);
        e.c = (float)((double)e.c * size);
        if (size > smallest)
            list->ellipsoids[kept++] = e;
    }
    list->ellipsoid_count = kept;
    return SHAPE_OK;
}

/* The noise's way, in the cloud's frame; plain noise repeats after 64 cells. */
static void drift_in(const shape_cloud *cloud, const shape_frame *inverse, const change_context *c,
                     double drift[3])
{
    const double *v = c->motion->drift;
    shape_dvec3 d =
        shape_frame_direction(inverse, shape_dvec3_make(v[0] * c->time, v[1] * c->time, v[2] * c->time));
    double period = SHAPE_NOISE_SIZE * (double)cloud->field.noise_scale;
    bool plain = cloud->field.model != SHAPE_MODEL_LAYER && !shape_detail_is_on(&cloud->field.detail);
    drift[0] = plain && period > 0 ? remainder(d.x, period) : d.x;
    drift[1] = plain && period > 0 ? remainder(d.y, period) : d.y;
    drift[2] = plain && period > 0 ? remainder(d.z, period) : d.z;
}

static shape_status describe(const shape_set *set, size_t index, void *to, void *context, shape_error *error)
{
    const shape_cloud *cloud = &set->clouds[index];
    const change_context *c = context;
    change_key *key = to;
    memset(key, 0, sizeof *key);
    shape_frame inverse;
    if (!shape_frame_invert(&cloud->frame, &inverse))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "cloud \"%s\": its frame has no inverse",
                               cloud->name);
    drift_in(cloud, &inverse, c, key->drift);
    if (c->motion->life <= 0 && c->motion->grow <= 0 && c->motion->decay <= 0)
        return SHAPE_OK; /* heights are not asked for, and copies at other heights share */
    shape_dvec3 ahead = shape_frame_direction(&inverse, c->ahead), min, max;
    const double lean = c->motion->shear;
    key->lean[0] = lean * ahead.x;
    key->lean[1] = lean * ahead.y;
    key->lean[2] = lean * ahead.z;
    for (int i = 0; i < 4; i++)
        key->height[i] = cloud->frame.m[1][i];
    key->height[3] -= c->base;
    if (shape_set_cloud_bounds(set, index, &min, &max)) {
        key->low = min.y - c->base;
        key->inverse = max.y > min.y ? 1 / (max.y - min.y) : 0;
    }
    return SHAPE_OK;
}

static shape_dvec3 direction_of(const double wind[3])
{
    double length = sqrt(wind[0] * wind[0] + wind[2] * wind[2]);
    return length > 0 ? shape_dvec3_make(wind[0] / length, 0, wind[2] / length) : shape_dvec3_make(1, 0, 0);
}

/* Wind moves frames; so does shear where primitives live for ever. */
static void move_frame(shape_frame *frame, const change_context *c)
{
    const shape_motion *m = c->motion;
    shape_frame move = shape_frame_identity();
    double slope = m->life > 0 ? 0 : m->shear * c->time;
    double ahead[3] = {c->ahead.x, 0, c->ahead.z};
    for (int i = 0; i < 3; i++) {
        move.m[i][1] += slope * ahead[i];
        move.m[i][3] = m->wind[i] * c->time - slope * ahead[i] * c->base;
    }
    *frame = shape_frame_multiply(&move, frame);
}

/* A drifting noise is a cloud whose frame moves while its primitives stay. */
static void drift_frame(shape_cloud *cloud, const double drift[3])
{
    shape_frame move = shape_frame_identity();
    for (int i = 0; i < 3; i++)
        move.m[i][3] = drift[i];
    cloud->frame = shape_frame_multiply(&cloud->frame, &move);
}

/* A voxel grid has no primitives to grow and no noise to drift; wind and shear carry it like any cloud. */
static shape_status refuse_grids(const shape_set *set, const shape_motion *m, shape_error *error)
{
    if (!moves(m->drift) && m->life <= 0 && m->grow <= 0 && m->decay <= 0)
        return SHAPE_OK;
    for (size_t i = 0; i < set->cloud_count; i++)
        if (set->clouds[i].field.model == SHAPE_MODEL_GRID)
            return shape_error_set(
                error, SHAPE_ERROR_ARGUMENT,
                "cloud \"%s\" is a voxel grid: nothing in it grows, decays or drifts (give wind or "
                "shear)",
                set->clouds[i].name);
    return SHAPE_OK;
}

static shape_status apply(shape_set *set, change_context *c, shape_error *error)
{
    const shape_motion *m = c->motion;
    shape_dvec3 min = {0, 0, 0}, max;
    shape_set_bounds(set, &min, &max);
    c->base = min.y;
    c->ahead = direction_of(m->wind);
    change_key *keys = calloc(set->cloud_count + 1, sizeof *keys);
    if (!keys)
        return shape_error_memory(error);
    shape_status status = refuse_grids(set, m, error);
    for (size_t i = 0; i < set->cloud_count && !status; i++)
        status = describe(set, i, &keys[i], c, error);
    const shape_list_change change = {sizeof *keys, describe, change_list, c};
    if (!status && (moves(m->drift) || m->life > 0 || m->grow > 0 || m->decay > 0))
        status = shape_set_change_lists(set, NULL, &change, error);
    for (size_t i = 0; i < set->cloud_count && !status; i++) {
        drift_frame(&set->clouds[i], keys[i].drift);
        move_frame(&set->clouds[i].frame, c);
    }
    free(keys);
    return status;
}

shape_status shape_motion_apply(const shape_set *set, const shape_motion *motion, double time,
                                shape_set **moved, shape_error *error)
{
    shape_status status = shape_motion_check(motion, error);
    if (status)
        return status;
    if (!isfinite(time))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "the time is not a finite number");
    shape_set *made = shape_set_create(error);
    if (!made)
        return SHAPE_ERROR_MEMORY;
    status = shape_set_append(made, set, error);
    change_context context = {.motion = motion, .time = time};
    if (!status)
        status = apply(made, &context, error);
    if (status)
        shape_set_destroy(made);
    else
        *moved = made;
    return status;
}
