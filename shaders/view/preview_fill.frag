// The second pass of a moving view: a pixel whose neighbours of the first pass agree is their mean. The others are left
// to the marching that follows (no depth is written there). Tiles without a cloud are sky.
#include "field/cloud.glsl"
#include "field/interval.glsl"
float transmittance = 1.0;
vec3 radiance = vec3(0.0);
#ifdef AIR
#include "view/camera.glsl"
#include "view/air.glsl"
#endif
#include "view/preview_out.glsl"

uniform highp sampler2D coarse_picture; // radiance without the sky, transmittance
uniform float coarse_agreement;         // how far neighbours may differ

// Whether these rays end at places that have nothing to do with each other: at an edge of something opaque.
bool surfaces_differ(ivec2 low, ivec2 high, float here)
{
    float a = surface_at(vec2(2 * low)).a, b = surface_at(vec2(2 * ivec2(high.x, low.y))).a;
    float c = surface_at(vec2(2 * ivec2(low.x, high.y))).a, d = surface_at(vec2(2 * high)).a;
    return max(max(max(a, b), max(c, d)), here) > 1.1 * min(min(min(a, b), min(c, d)), here);
}

void main()
{
    vec2 pixel = drawn_pixel();
#ifdef AIR
    load_air(camera_ray_at(pixel), pixel, sky_behind(pixel));
#endif
    ivec2 whole = ivec2(pixel), low = whole / 2, last = textureSize(coarse_picture, 0) - 1;
    fetches = 4.0;
    steps = 0.0;
    if (tile_clouds_at(whole).y > 0) {
        ivec2 high = min(low + (whole & 1), last);
        vec4 a = texelFetch(coarse_picture, low, 0), b = texelFetch(coarse_picture, ivec2(high.x, low.y), 0);
        vec4 c = texelFetch(coarse_picture, ivec2(low.x, high.y), 0), d = texelFetch(coarse_picture, high, 0);
        vec4 mean = 0.25 * (a + b + c + d);
        vec4 apart = max(max(a, b), max(c, d)) - min(min(a, b), min(c, d));
        if (surface_on == 1 && surfaces_differ(low, high, surface_at(pixel).a))
            discard;
        // Brightness counts relative to what is seen there, with about the sky behind.
        if (max(apart.w, apart.g / (mean.g + mean.w + 0.02)) > coarse_agreement)
            discard;
        radiance = mean.rgb;
        transmittance = mean.w;
    }
    put_pixel(pixel);
}
