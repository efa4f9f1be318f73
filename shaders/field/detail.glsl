// Details on a cloud of primitives, the mirror of libshape/field/detail.c. The record's texels are named in upload.c.
#include "field/noise_gradient.glsl"
#include "field/noise_cellular.glsl"

uint cloud_key(int use)
{
    vec4 halves = cloud_texel(cloud_index, 28 + use / 2);
    vec2 key = use % 2 == 0 ? halves.xy : halves.zw;
    return uint(key.x) + (uint(key.y) << 16u);
}

#include "field/layer.glsl"

vec3 displaced(vec3 p)
{
    vec4 settings = cloud_texel(cloud_index, 25);
    if (!(settings.z > 0.0))
        return p;
    return p + noise_perlin3_fbm(p * settings.w, 2, cloud_key(2)) * (settings.z * 0.57735027);
}

// Smooth union of the two nearest primitives. The lists are the shapes' own (see detail_density).
float union_u(vec3 p, int root, int count, float k)
{
    float least = 1e30, second = 1e30;
    for (int i = 0; i < count;) {
        vec4 low = linear_texel(nodes, 2 * (root + i)), high = linear_texel(nodes, 2 * (root + i) + 1);
        if (any(lessThan(p, low.xyz)) || any(greaterThan(p, high.xyz))) {
            i = int(low.w);
            continue;
        }
        i++;
        int content = int(high.w);
        if (content == 0)
            continue;
        float u2 = primitive_u2(content, p);
        second = min(second, max(least, u2));
        least = min(least, u2);
    }
    least = sqrt(least);
    second = sqrt(second);
    if (k > 0.0 && second - least < 4.0 * k) {
        float h = 1.0 - (second - least) / (4.0 * k);
        least -= h * h * k;
    }
    return max(least, 0.0);
}

float eroded(vec3 p, float u)
{
    vec4 settings = cloud_texel(cloud_index, 26), place = cloud_texel(cloud_index, 27);
    float most = max(settings.x, settings.y), depth = (1.0 - u) * settings.z;
    if (!(most > 0.0) || depth >= 1.0)
        return 1.0;
    float height = smooth_ramp(((p.y - place.x) * place.y - 0.1) * 5.0);
    float n = clamp(2.0 * noise_worley_fbm(p * settings.w, 2, cloud_key(3)) - 0.5, 0.0, 1.0);
    float gone = 0.8 * (settings.x * height * (1.0 - n) + settings.y * (1.0 - height) * n);
    return smooth_ramp((depth - gone) / (0.2 * most));
}

float primitives_density(vec3 p)
{
    vec4 lists = cloud_texel(cloud_index, 24), settings = cloud_texel(cloud_index, 25);
    float sum = 0.0, u;
    if (cloud_model == MODEL_METABALL) {
        sum = metaball_sum(p);
        u = 1.0 / sqrt(max(sum, 1e-12));
    } else {
        u = union_u(p, int(settings.x), int(lists.w), settings.y);
    }
    if (!(u <= 1.0))
        return 0.0;
    float left = eroded(p, u);
    if (!(left > 0.0))
        return 0.0;
    if (cloud_model == MODEL_SPHEROID)
        return left * spheroid_density(p, u);
    if (cloud_model == MODEL_METABALL)
        return left * metaball_density(p, sum);
    return left;
}

// The loaded cloud's lists are those of its supports; while a detailed density is asked they are those of its shapes.
float detail_density(vec3 p)
{
    vec4 lists = cloud_texel(cloud_index, 24);
    int first_sphere = cloud_first_sphere, first_ellipsoid = cloud_first_ellipsoid;
    cloud_first_sphere = int(lists.y);
    cloud_first_ellipsoid = int(lists.z);
    p = displaced(p);
    float density = cloud_model == MODEL_LAYER ? layer_density(p) : primitives_density(p);
    cloud_first_sphere = first_sphere;
    cloud_first_ellipsoid = first_ellipsoid;
    return density;
}
