// What things and clouds leave of the sun at a place, relative to the eye. Before it: field/cloud.glsl, with the records of all
// clouds, in sight or not, and sun_direction.
uniform vec3 middle, map_right, map_up;
uniform float map_radius;
uniform highp sampler2DShadow sun_map; // 0: nearest to the sun
uniform highp sampler3D shade;         // the sun's share that clouds let through to their light grids' cells
uniform int has_ground;
uniform float ground; // its height above the eye [m]

// Whether the things leave p the sun, 0 to 1. p is off the surface by more than a texel of the map.
float sun_past_things(vec3 p)
{
    vec3 q = p - middle;
    vec3 at = vec3(dot(q, map_right), dot(q, map_up), -dot(q, sun_direction)) / map_radius * 0.5 + 0.5;
    float lit = at.z < 0.0 ? 1.0 : texture(sun_map, vec3(at.xy, min(at.z, 1.0)));
    if (has_ground == 1 && (sun_direction.y > 0.0) == (p.y < ground))
        lit = 0.0; // the ground is between
    return lit;
}

void clip(float low, float high, float origin, float direction, inout float t0, inout float t1)
{
    float a = (low - origin) / direction, b = (high - origin) / direction;
    if (direction == 0.0) {
        t1 = origin >= low && origin <= high ? t1 : -1.0;
        return;
    }
    t0 = max(t0, min(a, b));
    t1 = min(t1, max(a, b));
}

// What clouds leave of it: a cell knows of all clouds on its way to the sun, so the first grid that the way enters does.
float sun_past_clouds(vec3 p)
{
    float nearest = 1e30, share = 1.0;
    for (int c = 0; c < cloud_count; c++) {
        vec4 x = cloud_texel(c, 0), y = cloud_texel(c, 1), z = cloud_texel(c, 2);
        vec3 origin = vec3(x.w + dot(x.xyz, p), y.w + dot(y.xyz, p), z.w + dot(z.xyz, p));
        vec3 direction = vec3(dot(x.xyz, sun_direction), dot(y.xyz, sun_direction), dot(z.xyz, sun_direction));
        vec4 low = cloud_texel(c, 10), high = cloud_texel(c, 11);
        float t0 = 0.0, t1 = 1e30;
        clip(low.x, high.x, origin.x, direction.x, t0, t1);
        clip(low.y, high.y, origin.y, direction.y, t0, t1);
        clip(low.z, high.z, origin.z, direction.z, t0, t1);
        if (t0 > t1 || t0 >= nearest)
            continue;
        nearest = t0;
        vec3 size = cloud_texel(c, 9).xyz;
        vec3 cell = (origin + t0 * direction - low.xyz) / (high.xyz - low.xyz) * size;
        share = texture(shade, (cloud_texel(c, 8).xyz + clamp(cell, vec3(0.5), size - 0.5)) / vec3(textureSize(shade, 0))).x;
    }
    return share;
}
