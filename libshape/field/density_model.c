/* The models' densities at a point, and how far it is from a primitive (DESIGN's table of models). Mirrored by
 * shaders/field/density.glsl. */
#include "field/density_model.h"

#include <math.h>

#include "shape/random.h"

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

float shape_cloud_u2(const shape_volume_cloud *cloud, shape_vec3 p)
{
    const shape_tree *tree = cloud->tree;
    float least = INFINITY;
    for (size_t i = 0; i < tree->count;) {
        const shape_tree_node *node = &tree->nodes[i];
        if (!density_node_holds(node, p)) {
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
