/* The fields of one brick of 8^3 voxels. Density is taken at the voxels' centres in the cloud's frame, with the very
 * operations of shape_cloud_density; depths below the surface are taken in voxel units. */
#include <math.h>
#include <string.h>

#include "field/density_model.h"
#include "field/voxels_private.h"

/* --- depths --- */

/* r - d of a ball, row by row; rows that lie out of reach are left alone. */
static void ball_depth(const voxel_form *f, const float c[3], float least, float *restrict depth)
{
    float r = f->radius, reach = r - least, reach2 = reach * reach, z2[VOXEL_EDGE];
    for (int k = 0; k < VOXEL_EDGE; k++)
        z2[k] = ((float)k - c[2]) * ((float)k - c[2]);
    for (int i = 0; i < VOXEL_EDGE; i++) {
        float x2 = ((float)i - c[0]) * ((float)i - c[0]);
        if (x2 > reach2)
            continue;
        for (int j = 0; j < VOXEL_EDGE; j++) {
            float y = (float)j - c[1], xy2 = x2 + y * y;
            if (xy2 > reach2)
                continue;
            float *restrict row = depth + (i * VOXEL_EDGE + j) * VOXEL_EDGE;
#pragma omp simd
            for (int k = 0; k < VOXEL_EDGE; k++) {
                float d = r - sqrtf(xy2 + z2[k]);
                row[k] = d > row[k] ? d : row[k];
            }
        }
    }
}

/* (1 - u) / |grad u| of another form: Taubin 1991, Eq. 4. */
static void form_depth(const voxel_form *f, const float c[3], float *restrict depth)
{
    for (int i = 0; i < VOXEL_EDGE; i++)
        for (int j = 0; j < VOXEL_EDGE; j++) {
            float x = (float)i - c[0], y = (float)j - c[1];
            float *restrict row = depth + (i * VOXEL_EDGE + j) * VOXEL_EDGE;
            float a = f->m[0][0] * x + f->m[0][1] * y, b = f->m[1][0] * x + f->m[1][1] * y,
                  e = f->m[2][0] * x + f->m[2][1] * y;
#pragma omp simd
            for (int k = 0; k < VOXEL_EDGE; k++) {
                float z = (float)k - c[2];
                float p = a + f->m[0][2] * z, q = b + f->m[1][2] * z, s = e + f->m[2][2] * z;
                float u = sqrtf(p * p + q * q + s * s);
                float gx = f->m[0][0] * p + f->m[1][0] * q + f->m[2][0] * s;
                float gy = f->m[0][1] * p + f->m[1][1] * q + f->m[2][1] * s;
                float gz = f->m[0][2] * p + f->m[1][2] * q + f->m[2][2] * s;
                float slope = sqrtf(gx * gx + gy * gy + gz * gz);
                float d = u > 1e-3f ? (1 - u) * u / slope : f->thin;
                row[k] = d > row[k] ? d : row[k];
            }
        }
}

void voxel_brick_depth(const voxel_form *forms, const int32_t first[3], const int32_t *list, size_t count,
                       float least, float depth[VOXEL_BRICK])
{
    for (int i = 0; i < VOXEL_BRICK; i++)
        depth[i] = least;
    for (size_t i = 0; i < count; i++) {
        const voxel_form *f = &forms[list[i]];
        const float c[3] = {(float)(f->c[0] - first[0]), (float)(f->c[1] - first[1]),
                            (float)(f->c[2] - first[2])};
        if (f->radius > 0)
            ball_depth(f, c, least, depth);
        else
            form_depth(f, c, depth);
    }
}

/* --- points and u --- */

static void find_points(const voxel_job *job, const shape_volume_cloud *cloud, const int32_t first[3],
                        voxel_room *room)
{
    int n = 0;
    for (int32_t i = 0; i < VOXEL_EDGE; i++)
        for (int32_t j = 0; j < VOXEL_EDGE; j++)
            for (int32_t k = 0; k < VOXEL_EDGE; k++, n++) {
                const int32_t index[3] = {first[0] + i, first[1] + j, first[2] + k};
                shape_dvec3 p = shape_frame_point(&cloud->inverse, shape_voxel_point(job->lattice, index));
                room->x[n] = (float)p.x, room->y[n] = (float)p.y, room->z[n] = (float)p.z;
            }
}

/* shape_sphere_u2, voxel by voxel. */
static void sphere_u2(const shape_sphere *s, const voxel_room *room, float *restrict u2)
{
#pragma omp simd
    for (int i = 0; i < VOXEL_BRICK; i++) {
        float x = room->x[i] - s->x, y = room->y[i] - s->y, z = room->z[i] - s->z;
        float own = (x * x + y * y + z * z) / (s->radius * s->radius);
        u2[i] = own < u2[i] ? own : u2[i];
    }
}

/* shape_ellipsoid_u2, voxel by voxel: the operations of shape_quat_rotate in their order. */
static void ellipsoid_u2(const shape_ellipsoid *e, const voxel_room *room, float *restrict u2)
{
    const shape_vec3 u = {-e->q.x, -e->q.y, -e->q.z};
    const float w = e->q.w;
#pragma omp simd
    for (int i = 0; i < VOXEL_BRICK; i++) {
        shape_vec3 v = {room->x[i] - e->x, room->y[i] - e->y, room->z[i] - e->z};
        shape_vec3 t = shape_vec3_scale(shape_vec3_cross(u, v), 2);
        v = shape_vec3_add(shape_vec3_add(v, shape_vec3_scale(t, w)), shape_vec3_cross(u, t));
        v = shape_vec3_make(v.x / e->a, v.y / e->b, v.z / e->c);
        float own = shape_vec3_dot(v, v);
        u2[i] = own < u2[i] ? own : u2[i];
    }
}

static void find_u2(const voxel_job *job, const shape_volume_cloud *cloud, const int32_t *list, size_t count,
                    voxel_room *room)
{
    for (int i = 0; i < VOXEL_BRICK; i++)
        room->u2[i] = INFINITY;
    for (size_t i = 0; i < count; i++) {
        int32_t content = job->forms[list[i]].content;
        if (content > 0)
            sphere_u2(&cloud->list->spheres[(size_t)content - 1], room, room->u2);
        else
            ellipsoid_u2(&cloud->list->ellipsoids[(size_t)-content - 1], room, room->u2);
    }
}

/* --- quantities --- */

static void add_density(const voxel_job *job, size_t index, const int32_t first[3], const int32_t *list,
                        size_t count, voxel_room *room)
{
    const shape_volume_cloud *cloud = &job->volume->clouds[index];
    const float limit = cloud->support * cloud->support, weight = job->weights[index];
    if (job->request->ramp > 0) {
        float scale = (float)(1 / job->request->ramp);
        voxel_brick_depth(job->forms, first, list, count, 0, room->depth);
        for (int i = 0; i < VOXEL_BRICK; i++) {
            float d = room->depth[i] * scale;
            room->values[i] += weight * (d < 1 ? d : 1);
        }
        return;
    }
    find_points(job, cloud, first, room);
    find_u2(job, cloud, list, count, room);
    for (int i = 0; i < VOXEL_BRICK; i++)
        if (room->u2[i] <= limit)
            room->values[i] +=
                weight * shape_cloud_density_at(cloud, shape_vec3_make(room->x[i], room->y[i], room->z[i]),
                                                room->u2[i]);
}

/* The depth [m of the cloud's frame] below a metaball's surface, by first order: u = 1 / sqrt F. */
static float metaball_depth(const shape_volume_cloud *cloud, shape_vec3 p)
{
    const float step = 1e-3f * (cloud->box.max.x - cloud->box.min.x) / cloud->support;
    float u[4];
    for (int k = 0; k < 4; k++) {
        shape_vec3 q = p;
        if (k)
            (&q.x)[k - 1] += step;
        u[k] = 1 / sqrtf(fmaxf(density_metaball_sum(cloud->list, q), 1e-12f));
    }
    float x = u[1] - u[0], y = u[2] - u[0], z = u[3] - u[0];
    float slope = sqrtf(x * x + y * y + z * z) / step;
    return (1 - u[0]) / fmaxf(slope, 1e-12f);
}

static void add_metaball_depth(const voxel_job *job, size_t index, const int32_t first[3], voxel_room *room)
{
    const shape_volume_cloud *cloud = &job->volume->clouds[index];
    float scale = (float)(cbrt(fabs(shape_frame_determinant(&cloud->frame))) / job->lattice->edge);
    find_points(job, cloud, first, room);
    for (int i = 0; i < VOXEL_BRICK; i++) {
        float d = scale * metaball_depth(cloud, shape_vec3_make(room->x[i], room->y[i], room->z[i]));
        room->best[i] = d > room->best[i] ? d : room->best[i];
    }
}

static void add_distance(const voxel_job *job, size_t index, const int32_t first[3], const int32_t *list,
                         size_t count, voxel_room *room)
{
    if (job->volume->clouds[index].field.model == SHAPE_MODEL_METABALL) {
        add_metaball_depth(job, index, first, room);
        return;
    }
    voxel_brick_depth(job->forms, first, list, count, (float)-job->request->band, room->depth);
    for (int i = 0; i < VOXEL_BRICK; i++)
        room->best[i] = room->depth[i] > room->best[i] ? room->depth[i] : room->best[i];
}

static void finish_distance(const voxel_job *job, voxel_room *room)
{
    float band = (float)job->request->band, edge = (float)job->lattice->edge;
    float outside = (float)(job->request->band * job->lattice->edge);
    for (int i = 0; i < VOXEL_BRICK; i++) {
        float d = room->best[i];
        room->values[i] = d >= band ? -outside : d <= -band ? outside : -d * edge;
    }
}

static float smoothstep(float x)
{
    x = x < 0 ? 0 : x > 1 ? 1 : x;
    return x * x * (3 - 2 * x);
}

/* Which of the two erosions of field/detail.c reaches a height, 0 wisps to 1 billows; by height alone where the cloud has
 * neither. */
static float detail_type(const shape_volume_cloud *cloud, shape_vec3 p)
{
    shape_cloud plain = {.field = shape_field_defaults()};
    shape_box box = cloud->detailed ? (shape_box){{0, cloud->base, 0}, {0, 0, 0}}
                                    : shape_cloud_box(&plain, cloud->shape_list);
    float tall = cloud->detailed ? cloud->inverse_height : 1 / fmaxf(box.max.y - box.min.y, 1e-30f);
    float height = smoothstep(((p.y - box.min.y) * tall - 0.1f) * 5);
    float billow = cloud->field.detail.billow, wisp = cloud->field.detail.wisp;
    if (!(billow > 0) && !(wisp > 0))
        return height;
    float sum = billow * height + wisp * (1 - height);
    return sum > 0 ? billow * height / sum : 0;
}

static void set_value(const voxel_job *job, size_t index, shape_vec3 p, int i, voxel_room *room)
{
    const shape_volume_cloud *cloud = &job->volume->clouds[index];
    float value[VOXEL_CHANNELS];
    switch (job->request->quantity) {
    case SHAPE_VOXEL_PROFILE:
        room->values[i] = room->best[i];
        break;
    case SHAPE_VOXEL_DETAIL_TYPE:
        room->values[i] = detail_type(cloud, p);
        break;
    case SHAPE_VOXEL_DENSITY_SCALE:
        room->values[i] = job->weights[index];
        break;
    case SHAPE_VOXEL_SAMPLE:
        job->request->sample(job->request->sample_context, index, p, value);
        for (int k = 0; k < VOXEL_CHANNELS; k++)
            room->values[k * VOXEL_BRICK + i] = value[k];
        break;
    case SHAPE_VOXEL_DENSITY:
    case SHAPE_VOXEL_SDF:
        break;
    }
}

/* Where this cloud's core is nearer than those before, what the request asks for. */
static void add_core(const voxel_job *job, size_t index, const int32_t first[3], const int32_t *list,
                     size_t count, voxel_room *room)
{
    const shape_volume_cloud *cloud = &job->volume->clouds[index];
    const bool metaball = cloud->field.model == SHAPE_MODEL_METABALL;
    find_points(job, cloud, first, room);
    find_u2(job, cloud, list, count, room);
    for (int i = 0; i < VOXEL_BRICK; i++) {
        shape_vec3 p = {room->x[i], room->y[i], room->z[i]};
        float u = sqrtf(room->u2[i]) / cloud->support;
        if (metaball && u <= 1)
            u = 1 / sqrtf(fmaxf(density_metaball_sum(cloud->list, p), 1e-12f));
        if (u <= 1 && 1 - u > room->best[i]) {
            room->best[i] = 1 - u;
            set_value(job, index, p, i, room);
        }
    }
}

void voxel_brick_fill(const voxel_job *job, const int32_t first[3], const int32_t *list, size_t count,
                      voxel_room *room)
{
    const shape_voxel_quantity quantity = job->request->quantity;
    memset(room->values, 0, sizeof room->values);
    float none = quantity == SHAPE_VOXEL_SDF ? (float)-job->request->band : -1;
    for (int i = 0; i < VOXEL_BRICK; i++)
        room->best[i] = none;
    for (size_t begin = 0, end; begin < count; begin = end) {
        size_t cloud = job->forms[list[begin]].cloud;
        for (end = begin + 1; end < count && job->forms[list[end]].cloud == cloud; end++)
            ;
        if (quantity == SHAPE_VOXEL_DENSITY)
            add_density(job, cloud, first, list + begin, end - begin, room);
        else if (quantity == SHAPE_VOXEL_SDF)
            add_distance(job, cloud, first, list + begin, end - begin, room);
        else
            add_core(job, cloud, first, list + begin, end - begin, room);
    }
    if (quantity == SHAPE_VOXEL_SDF)
        finish_distance(job, room);
}
