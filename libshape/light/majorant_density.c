/* The density at a point of a cell of the majorant grid, from the cell's list of primitives alone. */
#include <math.h>

#include "field/lattice.h"
#include "light/majorant.h"

static float sphere_u2(const shape_sphere *s, float x, float y, float z)
{
    x -= s->x, y -= s->y, z -= s->z;
    return (x * x + y * y + z * z) / (s->radius * s->radius);
}

static float ellipsoid_u2(const majorant_ellipsoid *e, float x, float y, float z)
{
    float sum = 0;
    for (int i = 0; i < 3; i++) {
        float v = e->m[i][0] * x + e->m[i][1] * y + e->m[i][2] * z + e->m[i][3];
        sum += v * v;
    }
    return sum;
}

/* The spheroid's density; octaves are added only while they can matter. */
static float spheroid_density(const majorant_cloud *cloud, const majorant_group *group, shape_vec3 p,
                              float u2, float floor)
{
    const shape_volume_cloud *c = cloud->cloud;
    float u = sqrtf(u2), n = cloud->mean, weight = 1;
    int row = (int)(u * MAJORANT_TABLE);
    float top = cloud->top[row], bottom = floor > 0 ? cloud->bottom[row + 1] : 0;
    if (top <= floor || group->low >= top)
        return 0;
    if (group->low > floor && group->high < bottom)
        return group->low;
    shape_vec3 q = shape_vec3_scale(p, c->inverse_noise_scale);
    for (int i = 0; i < c->field.octaves; i++) {
        const int *offset = c->offsets[i];
        weight *= 0.5f;
        q = shape_vec3_make(lattice_guard(q.x), lattice_guard(q.y), lattice_guard(q.z));
        n += weight * lattice_trilinear(c->noise, q, offset[0], offset[1], offset[2]);
        q = shape_vec3_scale(q, 2);
        if (n >= top || n + weight <= floor)
            return 0;
        if (n > floor && n + weight < bottom)
            return n;
    }
    float kappa = c->field.kappa;
    float width = (1 - kappa) + 2 * kappa * n;
    return n < expf(-u / (width > 1e-6f ? width : 1e-6f)) ? n : 0;
}

float majorant_density(const majorant_grid *grid, const majorant_group *group, const double p[3], float floor)
{
    const majorant_cloud *cloud = &grid->clouds[group->cloud];
    const double(*m)[4] = (const double(*)[4])cloud->to_local;
    shape_vec3 q = {(float)(m[0][0] * p[0] + m[0][1] * p[1] + m[0][2] * p[2] + m[0][3]),
                    (float)(m[1][0] * p[0] + m[1][1] * p[1] + m[1][2] * p[2] + m[1][3]),
                    (float)(m[2][0] * p[0] + m[2][1] * p[1] + m[2][2] * p[2] + m[2][3])};
    if (cloud->whole)
        return shape_cloud_density_at(cloud->cloud, q, 0);
    const uint32_t *entry = &grid->entries[group->first];
    const shape_sphere *spheres = cloud->cloud->list->spheres;
    float least = INFINITY, u2;
    for (uint32_t i = 0; i < group->spheres; i++)
        u2 = sphere_u2(&spheres[*entry++], q.x, q.y, q.z), least = u2 < least ? u2 : least;
    for (uint32_t i = 0; i < group->ellipsoids; i++)
        u2 = ellipsoid_u2(&cloud->ellipsoids[*entry++], q.x, q.y, q.z), least = u2 < least ? u2 : least;
    if (!(least <= 1))
        return 0;
    if (cloud->cloud->field.model == SHAPE_MODEL_UNIFORM)
        return 1;
    return spheroid_density(cloud, group, q, least, floor);
}
