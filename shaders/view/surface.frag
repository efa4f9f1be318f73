// An opaque thing's radiance towards the eye, and its distance: a matt surface (Lambert 1760) in the sun and under the sky,
// in the shadow of the other things and of the clouds. The mirror of libshape/light/march_surface.c.
#include "field/cloud.glsl"
#include "view/camera.glsl"

in vec3 place;
flat in vec4 face_plane;
flat in vec3 albedo;

uniform vec3 sun_direction, sun_irradiance, sky_upper, sky_lower;
#include "light/shade.glsl"
uniform int is_ground;
uniform vec2 ground_middle; // x and z, relative to the eye
uniform float ground_reach; // from its middle along x and z [m]

layout(location = 0) out vec4 radiance_out; // radiance, distance along the ray
layout(location = 1) out vec4 work_out;

// The distance by the plane, since what is interpolated over a large triangle is too rough; but not along the plane.
float distance_along(vec3 ray)
{
    float facing = dot(face_plane.xyz, ray), by_plane = face_plane.w / facing;
    if (is_ground == 1) {
        vec2 away = abs(by_plane * ray.xz - ground_middle);
        if (!(by_plane > 0.0 && max(away.x, away.y) < ground_reach))
            discard;
        return by_plane;
    }
    return abs(facing) > 1e-3 && by_plane > 0.0 ? by_plane : max(dot(place, ray), 0.0);
}

void main()
{
    vec3 ray = camera_ray();
    float t = distance_along(ray), texel = 2.0 * map_radius / float(textureSize(sun_map, 0).x);
    vec3 normal = dot(face_plane.xyz, ray) > 0.0 ? -face_plane.xyz : face_plane.xyz;
    vec3 p = t * ray;
    float facing = dot(normal, sun_direction), sun = 0.0;
    if (facing > 0.0) {
        vec3 off = p + normal * max(2.0 * texel, 1e-5 * t) + sun_direction * texel;
        sun = facing * sun_past_things(off);
        if (sun > 0.0)
            sun *= sun_past_clouds(p) * 0.31830988618;
    }
    float upper = 0.5 + 0.5 * normal.y;
    radiance_out = vec4(albedo * (sun * sun_irradiance + upper * sky_upper + (1.0 - upper) * sky_lower), t);
    work_out = vec4(0.0);
    gl_FragDepth = clamp(log2(1.0 + 1000.0 * t) / 50.0, 0.0, 1.0); // evenly fine at all distances
}
