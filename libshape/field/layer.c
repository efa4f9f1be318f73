/* The layer model (docs/fields.md): noise through thresholds A and B with coverage and cut (Páleník 2016 section 5.1;
 * article 004), inside a box, a sphere or two altitudes, thinning out towards their walls (article 003). Mirrored by
 * shaders/field/layer.glsl. */
#include "field/layer.h"

#include <math.h>

#include "field/density_model.h"

static float clamp01(float x)
{
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

static float smoothstep(float x)
{
    x = clamp01(x);
    return x * x * (3 - 2 * x);
}

/* How much of a margin of the share `fade` lies behind us at distance x from a wall; all where there is no margin. */
static float fade(float x, float share)
{
    return share > 0 ? smoothstep(x / share) : 1;
}

/* The altitude over the shell through the primitive's centre, of a point w away from it; R is the shell's radius.
 * |w + R y| - R without the difference of two large numbers. False below the planet's centre. */
static bool shell_altitude(shape_vec3 w, float radius, float *altitude)
{
    float y = radius + w.y;
    if (!(y > 0))
        return false;
    float length = sqrtf(w.x * w.x + w.z * w.z + y * y);
    *altitude = (shape_vec3_dot(w, w) + 2 * radius * w.y) / (length + radius);
    return true;
}

/* The weight of a place inside bounds, 0 to 1; negative outside. v: where the primitive is the unit ball. */
static float weight(const shape_layer *layer, shape_vec3 v)
{
    float x = fabsf(v.x), y = fabsf(v.y), z = fabsf(v.z), r = sqrtf(v.x * v.x + v.z * v.z);
    float length = shape_vec3_length(v);
    float side = layer->bounds == SHAPE_BOUNDS_BOX ? 1 - fmaxf(x, z) : 1 - r;
    bool inside = layer->bounds == SHAPE_BOUNDS_SPHERE ? length <= 1 : y <= 1 && side >= 0;
    if (!inside)
        return -1;
    return fade(1 - length, layer->falloff) * fade(0.5f * (1 + v.y), layer->fade_bottom) *
           fade(0.5f * (1 - v.y), layer->fade_top) * fade(side, layer->fade_side);
}

/* v of one primitive of the tree, with the planet's curve in it; false where there is none. */
static bool unit_place(const shape_volume_cloud *cloud, float content, shape_vec3 p, shape_vec3 *v)
{
    float radius = cloud->field.layer.planet_radius;
    shape_vec3 axes, w;
    if (content > 0) {
        const shape_sphere *s = &cloud->shape_list->spheres[(size_t)content - 1];
        axes = shape_vec3_make(s->radius, s->radius, s->radius);
        w = shape_vec3_make(p.x - s->x, p.y - s->y, p.z - s->z);
    } else {
        const shape_ellipsoid *e = &cloud->shape_list->ellipsoids[(size_t)-content - 1];
        axes = shape_vec3_make(e->a, e->b, e->c);
        w = shape_quat_rotate(shape_quat_conjugate(e->q),
                              shape_vec3_make(p.x - e->x, p.y - e->y, p.z - e->z));
    }
    *v = shape_vec3_make(w.x / axes.x, w.y / axes.y, w.z / axes.z);
    float altitude;
    if (!(radius > 0))
        return true;
    if (!shell_altitude(w, radius, &altitude))
        return false;
    v->y = altitude / axes.y;
    return true;
}

/* The largest weight of all bounds that hold p; negative outside all. */
static float bounds_weight(const shape_volume_cloud *cloud, shape_vec3 p)
{
    const shape_tree *tree = cloud->detail_tree;
    float most = -1;
    for (size_t i = 0; i < tree->count;) {
        const shape_tree_node *node = &tree->nodes[i];
        /* A shell dips below its primitive's box, so there all are asked. */
        if (!(cloud->field.layer.planet_radius > 0) && !density_node_holds(node, p)) {
            i = (size_t)node->skip;
            continue;
        }
        i++;
        shape_vec3 v;
        if (node->content != 0 && unit_place(cloud, node->content, p, &v))
            most = fmaxf(most, weight(&cloud->field.layer, v));
    }
    return most;
}

/* What the sum of the first octaves is of the weights of all: the octaves left out (mean_octaves) count as their mean. */
static float weight_share(const shape_volume_cloud *cloud)
{
    int octaves = cloud->field.octaves;
    return (1 - ldexpf(1, -octaves)) / (1 - ldexpf(1, -octaves - cloud->mean_octaves));
}

static float perlin_or_lattice(const shape_volume_cloud *cloud, shape_vec3 q)
{
    int octaves = cloud->field.octaves;
    float about_0;
    if (cloud->field.layer.noise == SHAPE_NOISE_LATTICE)
        about_0 =
            shape_noise_fbm(cloud->noise, cloud->offsets, octaves, q) / (1 - ldexpf(1, -octaves)) - 0.5f;
    else
        about_0 = 0.5f * shape_noise_perlin_fbm(q, octaves, cloud->keys[0]);
    return 0.5f + cloud->field.layer.gain * weight_share(cloud) * about_0;
}

static float layer_noise(const shape_volume_cloud *cloud, shape_vec3 p)
{
    const shape_layer *l = &cloud->field.layer;
    shape_vec3 q = {p.x * cloud->inverse_cell.x, p.y * cloud->inverse_cell.y, p.z * cloud->inverse_cell.z};
    float first = 0, second = 0,
          blend = l->noise == SHAPE_NOISE_PERLIN_WORLEY ? l->blend
                  : l->noise == SHAPE_NOISE_WORLEY      ? 0
                                                        : 1;
    if (blend > 0)
        first = perlin_or_lattice(cloud, q);
    if (blend < 1)
        second = 0.5f + l->worley_gain * (shape_noise_worley_fbm(shape_vec3_scale(q, l->worley_frequency),
                                                                 l->worley_octaves, cloud->keys[1]) -
                                          0.5f);
    return blend * first + (1 - blend) * second;
}

float layer_density(const shape_volume_cloud *cloud, shape_vec3 p)
{
    const shape_layer *l = &cloud->field.layer;
    float inside = bounds_weight(cloud, p);
    if (!(inside > 0))
        return 0;
    float n = clamp01(layer_noise(cloud, p) + 2 * l->coverage - 1);
    float x = (n - l->cut) / (1 - l->cut) + inside - 1;
    if (!(x > l->ramp[0]))
        return 0;
    return x >= l->ramp[1] ? 1 : smoothstep((x - l->ramp[0]) / (l->ramp[1] - l->ramp[0]));
}
