// The shadow of the air up to the end of each slice: integral of sigma exp(-depth) (1 - V) dt, from view/air_slice.frag's.
#include "view/camera.glsl"
uniform vec3 sun_direction;
#include "light/air.glsl"
#include "view/air_layout.glsl"

uniform ivec2 air_size;
uniform highp sampler2D air_dark;

layout(location = 0) out vec4 sum_out;

void main()
{
    ivec2 texel = ivec2(gl_FragCoord.xy), tile = texel / air_size, column = texel - tile * air_size;
    int slice = tile.y * AIR_ACROSS + tile.x;
    air_load(camera_ray_at(vec2(column) * AIR_SPACING + (pixel_shift - 0.5) * (AIR_SPACING - 1.0)));
    float before = exp(-air_depth(air_t0)), sum = 0.0;
    for (int i = 0; i <= slice; i++) {
        float after = exp(-air_depth(air_place(float(i + 1) / float(AIR_SLICES))));
        sum += texelFetch(air_dark, air_corner(i, air_size) + column, 0).r * (before - after);
        before = after;
    }
    sum_out = vec4(sum);
}
