// A cloud's record and primitives, as viewer/gl/upload.c lays them out in float textures.
uniform highp sampler2D clouds;     // a row of texels a cloud, see upload.c
uniform highp sampler2D spheres;    // one texel a sphere: centre, radius
uniform highp sampler2D ellipsoids; // three texels an ellipsoid: centre; semi-axes; quaternion
uniform highp sampler2D nodes;      // two texels a tree node: min, skip; max, content
uniform int cloud_count;

const int MODEL_UNIFORM = 0, MODEL_SPHEROID = 1, MODEL_METABALL = 2, MODEL_LAYER = 3, MODEL_GRID = 4;

// The cloud that is being looked at; load_cloud fills these.
int cloud_index = -1;
vec3 cloud_origin, cloud_direction; // the ray in the cloud's frame; t stays in metres of the world
vec3 cloud_min, cloud_max;
float cloud_extinction, cloud_kappa, cloud_inverse_scale, cloud_support2, cloud_support, cloud_edge, cloud_step;
int cloud_model, cloud_octaves, cloud_root, cloud_nodes, cloud_first_sphere, cloud_first_ellipsoid;
int cloud_spheres, cloud_ellipsoids;
bool cloud_detailed;

// ONE_CLOUD: the scene has no more, and its record is a uniform, which costs nothing to look at.
#ifdef ONE_CLOUD
uniform vec4 one_cloud[36];
vec4 cloud_texel(int c, int i) { return one_cloud[i]; }
#else
vec4 cloud_texel(int c, int i) { return texelFetch(clouds, ivec2(i, c), 0); }
#endif

// Texel i of a list. LIST_BITS: lists are 2^LIST_BITS texels wide; without it they may have any width, but a division of
// whole numbers can cost more than the look-up.
vec4 linear_texel(highp sampler2D from, int i)
{
#ifdef LIST_BITS
    return texelFetch(from, ivec2(i & ((1 << LIST_BITS) - 1), i >> LIST_BITS), 0);
#else
    int width = textureSize(from, 0).x;
    return texelFetch(from, ivec2(i % width, i / width), 0);
#endif
}

// origin and direction of the world ray are relative to the eye: the rows hold the eye's place in the cloud's frame.
void load_ray(int c, vec3 direction)
{
    vec4 x = cloud_texel(c, 0), y = cloud_texel(c, 1), z = cloud_texel(c, 2);
    cloud_origin = vec3(x.w, y.w, z.w);
    cloud_direction = vec3(dot(x.xyz, direction), dot(y.xyz, direction), dot(z.xyz, direction));
    vec4 low = cloud_texel(c, 3), high = cloud_texel(c, 4);
    cloud_min = low.xyz;
    cloud_extinction = low.w;
    cloud_max = high.xyz;
    cloud_root = int(high.w);
}

void load_cloud(int c, vec3 direction)
{
#ifndef ONE_CLOUD
    if (c == cloud_index)
        return;
#endif
    cloud_index = c;
    load_ray(c, direction);
    vec4 field = cloud_texel(c, 5), place = cloud_texel(c, 6), more = cloud_texel(c, 7);
    cloud_kappa = field.x;
    cloud_octaves = int(field.y);
    cloud_inverse_scale = field.z;
    cloud_model = int(field.w);
    cloud_first_sphere = int(place.x);
    cloud_first_ellipsoid = int(place.y);
    cloud_nodes = int(place.z);
    cloud_support = place.w;
    cloud_support2 = place.w * place.w;
    cloud_edge = more.x;
    cloud_spheres = int(more.y);
    cloud_ellipsoids = int(more.z);
    cloud_step = more.w;
    cloud_detailed = cloud_texel(c, 24).x != 0.0;
}

vec4 sphere_at(int i) { return linear_texel(spheres, cloud_first_sphere + i); }

vec3 turn(vec4 q, vec3 v)
{
    vec3 t = 2.0 * cross(q.xyz, v);
    return v + q.w * t + cross(q.xyz, t);
}

// diag(1/a) R^T applied to a point difference and to a direction of ellipsoid i.
void ellipsoid_space(int i, inout vec3 point, inout vec3 direction)
{
    int texel = 3 * (cloud_first_ellipsoid + i);
    vec3 centre = linear_texel(ellipsoids, texel).xyz, axes = linear_texel(ellipsoids, texel + 1).xyz;
    vec4 q = linear_texel(ellipsoids, texel + 2);
    q.xyz = -q.xyz;
    point = turn(q, point - centre) / axes;
    direction = turn(q, direction) / axes;
}
