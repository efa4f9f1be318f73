// How much of the air in a slice of a ray lies in the shadow, 0 to 1: a few looks at the sun (Toth and Umenhoffer 2009),
// begun differently in neighbouring rays and in each sample.
#include "field/cloud.glsl"
#include "view/camera.glsl"
uniform vec3 sun_direction;
#include "light/shade.glsl"
#include "light/air.glsl"
#include "view/air_layout.glsl"

uniform ivec2 air_size;  // of a slice's picture
uniform int air_looks;   // a slice
uniform int air_things;  // whether anything is opaque

layout(location = 0) out vec4 dark_out;

void main()
{
    ivec2 texel = ivec2(gl_FragCoord.xy), tile = texel / air_size, column = texel - tile * air_size;
    int slice = tile.y * AIR_ACROSS + tile.x;
    // Another place in the ray's block of pixels with each sample; the first one looks through its middle.
    vec3 ray = camera_ray_at(vec2(column) * AIR_SPACING + (pixel_shift - 0.5) * (AIR_SPACING - 1.0));
    air_load(ray);
    dark_out = vec4(0.0);
    if (air_t1 <= air_t0)
        return;
    // Interleaved gradient noise (Jimenez 2014), on by the golden ratio.
    float start = fract(52.9829189 * fract(dot(vec2(column) + picture_origin / AIR_SPACING, vec2(0.06711056, 0.00583715))) + float(sample_number) * 0.6180339887);
    // Below the ground it is as dark as at the ground: slices are coarser than pixels know where that is.
    float lit = 0.0, last = air_things == 1 && has_ground == 1 && ray.y * ground > 0.0 ? 0.9999 * ground / ray.y : 1e30;
    for (int i = 0; i < air_looks; i++) {
        float t = air_place((float(slice) + (float(i) + start) / float(air_looks)) / float(AIR_SLICES));
        vec3 p = min(t, last) * ray;
        float sun = air_things == 1 ? sun_past_things(p) : 1.0;
        lit += sun > 0.0 ? sun * sun_past_clouds(p) : 0.0;
    }
    dark_out.r = 1.0 - lit / float(air_looks);
}
