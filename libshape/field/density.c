/* Density at a point (DESIGN's table of models). Mirrored by shaders/field/density.glsl. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "field/detail.h"
#include "shape/grid.h"
#include "shape/random.h"
#include "shape/volume.h"

/* u^2 below which a metaball's pole is cut off: a thousandth of the radius. */
static const float metaball_pole = 1e-6f;

float shape_sphere_u2(const shape_sphere *s, shape_vec3 p)
{
    float x = p.x - s->x, y = p.y - s->y, z = p.z - s->z;
    return (x * x + y * y + z * z) / (s->radius * s->radius);
}

/* diag(1/a) R^T v. */
static shape_vec3 to_unit(const shape_ellipsoid *e, shape_vec3 v)
{
    v = shape_quat_rotate(shape_quat_conjugate(e->q), v);
    return shape_vec3_make(v.x / e->a, v.y / e->b, v.z / e->c);
}

float shape_ellipsoid_u2(const shape_ellipsoid *e, shape_vec3 p)
{
    shape_vec3 v = to_unit(e, shape_vec3_make(p.x - e->x, p.y - e->y, p.z - e->z));
    return shape_vec3_dot(v, v);
}

static bool inside(const shape_tree_node *n, shape_vec3 p)
{
    return p.x >= n->min.x && p.x <= n->max.x && p.y >= n->min.y && p.y <= n->max.y && p.z >= n->min.z &&
           p.z <= n->max.z;
}

float shape_cloud_u2(const shape_volume_cloud *cloud, shape_vec3 p)
{
    const shape_tree *tree = cloud->tree;
    float least = INFINITY;
    for (size_t i = 0; i < tree->count;) {
        const shape_tree_node *node = &tree->nodes[i];
        if (!inside(node, p)) {
            i = (size_t)node->skip;
            continue;
        }
        if (node->content != 0) {
            float u2 = node->content > 0
                           ? shape_sphere_u2(&cloud->list->spheres[(size_t)node->content - 1], p)
                           : shape_ellipsoid_u2(&cloud->list->ellipsoids[(size_t)-node->content - 1], p);
            least = u2 < least ? u2 : least;
        }
        i++;
    }
    return least;
}

float density_fbm(const shape_volume_cloud *cloud, shape_vec3 p)
{
    int octaves = cloud->field.octaves;
    float n = shape_noise_fbm(cloud->noise, cloud->offsets, octaves,
                              shape_vec3_scale(p, cloud->inverse_noise_scale));
    if (cloud->mean_octaves > 0)
        n += 0.5f * (ldexpf(1, -octaves) - ldexpf(1, -octaves - cloud->mean_octaves));
    return n;
}

float density_gamma(float kappa, float n, float u)
{
    return expf(-u / fmaxf((1 - kappa) + 2 * kappa * n, 1e-6f));
}

float density_spheroid(const shape_volume_cloud *cloud, shape_vec3 p, float u)
{
    float n = density_fbm(cloud, p), kappa = cloud->field.kappa;
    float gamma = cloud->portable ? (float)shape_exp((double)(-u / fmaxf((1 - kappa) + 2 * kappa * n, 1e-6f)))
                                  : density_gamma(kappa, n, u);
    return n < gamma ? n : 0;
}

float density_metaball_sum(const shape_primitives *list, shape_vec3 p)
{
    float sum = 0;
    for (size_t i = 0; i < list->sphere_count; i++)
        sum += 1 / fmaxf(shape_sphere_u2(&list->spheres[i], p), metaball_pole);
    for (size_t i = 0; i < list->ellipsoid_count; i++)
        sum += 1 / fmaxf(shape_ellipsoid_u2(&list->ellipsoids[i], p), metaball_pole);
    return sum;
}

float density_metaball(const shape_volume_cloud *cloud, shape_vec3 p, float sum)
{
    if (sum < 1)
        return 0;
    float n = density_fbm(cloud, p);
    return cloud->field.edge * n <= sum ? n : 0;
}

float shape_cloud_density_at(const shape_volume_cloud *cloud, shape_vec3 p, float u2)
{
    if (!(u2 <= cloud->support * cloud->support))
        return 0;
    if (cloud->detailed)
        return detail_density(cloud, p);
    switch (cloud->field.model) {
    case SHAPE_MODEL_UNIFORM:
        return 1;
    case SHAPE_MODEL_SPHEROID:
        return density_spheroid(cloud, p, sqrtf(u2));
    case SHAPE_MODEL_METABALL:
        return density_metaball(cloud, p, density_metaball_sum(cloud->list, p));
    case SHAPE_MODEL_GRID:
        return shape_grid_sample(cloud->list->grid, p);
    case SHAPE_MODEL_LAYER: /* always detailed */
        break;
    }
    return 0;
}

float shape_cloud_density(const shape_volume_cloud *cloud, shape_vec3 p)
{
    return shape_cloud_density_at(cloud, p, shape_cloud_u2(cloud, p));
}

bool shape_cloud_is_coloured(const shape_volume_cloud *cloud)
{
    return cloud->field.model == SHAPE_MODEL_GRID && cloud->list->grid->coloured;
}

void shape_cloud_albedo(const shape_volume_cloud *cloud, shape_vec3 p, float rgb[3])
{
    rgb[0] = rgb[1] = rgb[2] = 1;
    if (shape_cloud_is_coloured(cloud))
        shape_grid_colour(cloud->list->grid, p, rgb);
    for (int c = 0; c < 3; c++)
        rgb[c] = fminf(rgb[c] * cloud->medium.albedo, 1);
}

double shape_volume_extinction(const shape_volume *volume, shape_dvec3 world)
{
    double sum = 0;
    for (size_t i = 0; i < volume->cloud_count; i++) {
        const shape_volume_cloud *cloud = &volume->clouds[i];
        shape_dvec3 p = shape_frame_point(&cloud->inverse, world);
        shape_vec3 local = {(float)p.x, (float)p.y, (float)p.z};
        sum += (double)cloud->medium.extinction * (double)shape_cloud_density(cloud, local);
    }
    return sum;
}
