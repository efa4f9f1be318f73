/* Details on a cloud of primitives (docs/fields.md): smooth union (the quadratic polynomial of Quilez 2013, as in article
 * 001's Godot renderer, on the two nearest primitives), displacement of the query point by vector noise (Kniss, Premože,
 * Hansen, Shirley and McPherson 2002; Páleník 2016 section 1.2), and erosion by billows above and wisps below (after
 * Schneider and Vos 2015). Mirrored by shaders/field/detail.glsl. */
#include "field/detail.h"

#include <math.h>

#include "base/stop.h"
#include "field/density_model.h"
#include "field/layer.h"

enum { DISPLACE_OCTAVES = 2, DETAIL_OCTAVES = 2 };

/* A second primitive counts up to four smoothnesses behind the nearest one, which itself counts where u <= 1. */
float detail_reach(const shape_field *field, float support)
{
    return field->detail.smoothness > 0 ? 1 + 4 * field->detail.smoothness : support;
}

static float inverse_or(float chosen, float otherwise)
{
    return 1 / (chosen > 0 ? chosen : otherwise);
}

void detail_prepare(shape_volume_cloud *cloud)
{
    const shape_field *field = &cloud->field;
    const shape_detail *detail = &field->detail;
    float cell = 1 / cloud->inverse_noise_scale;
    shape_cloud plain = {.field = shape_field_defaults()};
    shape_box box = shape_cloud_box(&plain, cloud->shape_list);
    float height = box.max.y - box.min.y;
    cloud->base = box.min.y;
    cloud->inverse_height = height > 0 ? 1 / height : 0;
    cloud->inverse_displace_scale = inverse_or(detail->displace_scale, 5 * cell);
    cloud->inverse_detail_scale = inverse_or(detail->detail_scale, 2 * cell);
    cloud->inverse_detail_depth = inverse_or(detail->detail_depth, 0.5f);
    cloud->inverse_cell = shape_vec3_make(cloud->inverse_noise_scale / field->layer.stretch[0],
                                          cloud->inverse_noise_scale / field->layer.stretch[1],
                                          cloud->inverse_noise_scale / field->layer.stretch[2]);
    for (uint32_t use = 0; use < 4; use++)
        cloud->keys[use] = shape_noise_key(field->seed, use);
}

/* Each component of the noise is within 1, so the point moves by at most `displace`. */
static shape_vec3 displaced(const shape_volume_cloud *cloud, shape_vec3 p)
{
    float reach = cloud->field.detail.displace;
    if (!(reach > 0))
        return p;
    shape_vec3 n = shape_noise_perlin3_fbm(shape_vec3_scale(p, cloud->inverse_displace_scale),
                                           DISPLACE_OCTAVES, cloud->keys[2]);
    return shape_vec3_add(p, shape_vec3_scale(n, reach * 0.57735027f));
}

/* Of a crowd, which lies all over the memory: a node takes as long as so many units of stop.h. */
enum { FAR_APART = 8 };

static void nearest_two(const shape_volume_cloud *cloud, shape_vec3 p, float *least, float *second)
{
    const shape_tree *tree = cloud->detail_tree;
    stop_watch watch = {.stop = cloud->stop ? *cloud->stop : (shape_stop){0}};
    *least = *second = INFINITY;
    for (size_t i = 0; i < tree->count;) {
        const shape_tree_node *node = &tree->nodes[i];
        if (stop_after(&watch, FAR_APART))
            break;
        if (!density_node_holds(node, p)) {
            i = (size_t)node->skip;
            continue;
        }
        i++;
        if (node->content == 0)
            continue;
        float u2 = node->content > 0
                       ? shape_sphere_u2(&cloud->shape_list->spheres[(size_t)node->content - 1], p)
                       : shape_ellipsoid_u2(&cloud->shape_list->ellipsoids[(size_t)-node->content - 1], p);
        if (u2 < *least) {
            *second = *least;
            *least = u2;
        } else if (u2 < *second) {
            *second = u2;
        }
    }
    *least = sqrtf(*least);
    *second = sqrtf(*second);
}

/* min(u1, u2) - h^2 k with h = max(4 k - |u1 - u2|, 0) / (4 k): two equal distances sink by k. */
static float union_u(const shape_volume_cloud *cloud, shape_vec3 p)
{
    float least, second, k = cloud->field.detail.smoothness;
    nearest_two(cloud, p, &least, &second);
    if (k > 0 && second - least < 4 * k) {
        float h = 1 - (second - least) / (4 * k);
        least -= h * h * k;
    }
    return least > 0 ? least : 0;
}

static float smoothstep(float x)
{
    x = x < 0 ? 0 : x > 1 ? 1 : x;
    return x * x * (3 - 2 * x);
}

/* What is left of the density, 0 to 1, at distance u: the surface recedes, by billows between the Worley points towards
 * the top, by wisps round the points towards the base. */
static float eroded(const shape_volume_cloud *cloud, shape_vec3 p, float u)
{
    float billow = cloud->field.detail.billow, wisp = cloud->field.detail.wisp;
    float most = billow > wisp ? billow : wisp;
    if (!(most > 0))
        return 1;
    float depth = (1 - u) * cloud->inverse_detail_depth;
    if (depth >= 1)
        return 1;
    /* Wisps up to a tenth of the height, billows from three tenths on; a slow change would let the two cancel. */
    float height = smoothstep(((p.y - cloud->base) * cloud->inverse_height - 0.1f) * 5);
    float n = shape_noise_worley_fbm(shape_vec3_scale(p, cloud->inverse_detail_scale), DETAIL_OCTAVES,
                                     cloud->keys[3]);
    n = 2 * n - 0.5f; /* from about 1/4 to 3/4 to all of 0 to 1 */
    n = n < 0 ? 0 : n > 1 ? 1 : n;
    float gone = 0.8f * (billow * height * (1 - n) + wisp * (1 - height) * n);
    return smoothstep((depth - gone) / (0.2f * most));
}

float detail_density(const shape_volume_cloud *cloud, shape_vec3 p)
{
    p = displaced(cloud, p);
    if (cloud->field.model == SHAPE_MODEL_LAYER)
        return layer_density(cloud, p);
    float sum = 0, u;
    if (cloud->field.model == SHAPE_MODEL_METABALL) {
        sum = density_metaball_sum(cloud->shape_list, p);
        u = 1 / sqrtf(fmaxf(sum, 1e-12f));
    } else {
        u = union_u(cloud, p);
    }
    if (!(u <= 1))
        return 0;
    float left = eroded(cloud, p, u);
    if (!(left > 0))
        return 0;
    switch (cloud->field.model) {
    case SHAPE_MODEL_SPHEROID:
        return left * density_spheroid(cloud, p, u);
    case SHAPE_MODEL_METABALL:
        return left * density_metaball(cloud, p, sum);
    case SHAPE_MODEL_UNIFORM:
    case SHAPE_MODEL_LAYER:
    case SHAPE_MODEL_GRID:
        break;
    }
    return left;
}
