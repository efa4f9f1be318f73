// The layer model, the mirror of libshape/field/layer.c.
const int BOUNDS_SPHERE = 0, BOUNDS_BOX = 1;
const int NOISE_LATTICE = 0, NOISE_WORLEY = 2, NOISE_PERLIN_WORLEY = 3;

float smooth_ramp(float x)
{
    x = clamp(x, 0.0, 1.0);
    return x * x * (3.0 - 2.0 * x);
}

float layer_fade(float x, float share) { return share > 0.0 ? smooth_ramp(x / share) : 1.0; }

float layer_weight(vec3 v, int bounds)
{
    vec4 fades = cloud_texel(cloud_index, 33);
    float r = length(v.xz), size = length(v);
    float side = bounds == BOUNDS_BOX ? 1.0 - max(abs(v.x), abs(v.z)) : 1.0 - r;
    bool inside = bounds == BOUNDS_SPHERE ? size <= 1.0 : abs(v.y) <= 1.0 && side >= 0.0;
    if (!inside)
        return -1.0;
    return layer_fade(1.0 - size, fades.x) * layer_fade(0.5 * (1.0 + v.y), fades.y) *
           layer_fade(0.5 * (1.0 - v.y), fades.z) * layer_fade(side, fades.w);
}

// |w + R y| - R without the difference of two large numbers.
bool layer_place(int content, vec3 p, float radius, out vec3 v)
{
    vec3 axes, w;
    if (content > 0) {
        vec4 s = sphere_at(content - 1);
        axes = vec3(s.w);
        w = p - s.xyz;
    } else {
        int texel = 3 * (cloud_first_ellipsoid - content - 1);
        vec4 q = linear_texel(ellipsoids, texel + 2);
        axes = linear_texel(ellipsoids, texel + 1).xyz;
        w = turn(vec4(-q.xyz, q.w), p - linear_texel(ellipsoids, texel).xyz);
    }
    v = w / axes;
    if (!(radius > 0.0))
        return true;
    float y = radius + w.y;
    if (!(y > 0.0))
        return false;
    v.y = (dot(w, w) + 2.0 * radius * w.y) / (length(vec3(w.x, y, w.z)) + radius) / axes.y;
    return true;
}

float layer_inside(vec3 p, int bounds, float radius)
{
    int root = int(cloud_texel(cloud_index, 25).x), count = int(cloud_texel(cloud_index, 24).w);
    float most = -1.0;
    for (int i = 0; i < count;) {
        vec4 low = linear_texel(nodes, 2 * (root + i)), high = linear_texel(nodes, 2 * (root + i) + 1);
        bool beside = any(lessThan(p, low.xyz)) || any(greaterThan(p, high.xyz));
        if (beside && !(radius > 0.0)) {
            i = int(low.w);
            continue;
        }
        i++;
        vec3 v;
        if (int(high.w) != 0 && layer_place(int(high.w), p, radius, v))
            most = max(most, layer_weight(v, bounds));
    }
    return most;
}

float layer_noise(vec3 p, int kind, float blend, float gain)
{
    vec4 worley = cloud_texel(cloud_index, 31);
    vec3 q = p * cloud_texel(cloud_index, 34).xyz;
    float first = 0.0, second = 0.0;
    if (kind == NOISE_WORLEY)
        blend = 0.0;
    else if (kind != NOISE_PERLIN_WORLEY)
        blend = 1.0;
    if (blend > 0.0) {
        float about_0;
        if (kind == NOISE_LATTICE)
            about_0 = noise_fbm_cells(q) / (1.0 - exp2(-float(cloud_octaves))) - 0.5;
        else
            about_0 = 0.5 * noise_perlin_fbm(q, cloud_octaves, cloud_key(0));
        first = 0.5 + gain * about_0;
    }
    if (blend < 1.0)
        second = 0.5 + worley.x * (noise_worley_fbm(q * worley.y, int(worley.z), cloud_key(1)) - 0.5);
    return blend * first + (1.0 - blend) * second;
}

float layer_density(vec3 p)
{
    vec4 kinds = cloud_texel(cloud_index, 30), thresholds = cloud_texel(cloud_index, 32);
    float inside = layer_inside(p, int(kinds.x), cloud_texel(cloud_index, 31).w);
    if (!(inside > 0.0))
        return 0.0;
    float n = clamp(layer_noise(p, int(kinds.y), kinds.z, kinds.w) + 2.0 * thresholds.z - 1.0, 0.0, 1.0);
    float x = (n - thresholds.w) / (1.0 - thresholds.w) + inside - 1.0;
    if (!(x > thresholds.x))
        return 0.0;
    return x >= thresholds.y ? 1.0 : smooth_ramp((x - thresholds.x) / (thresholds.y - thresholds.x));
}
