// What is opaque and stands in the picture, as view/surface.frag has drawn it: where a ray ends, and what is seen there.
uniform highp sampler2D surface; // radiance, distance along the ray [m]
uniform int surface_on;          // 0: nothing is opaque
const float NO_SURFACE = 1e29;   // distances beyond this are none

// pixel: whole numbers, from the left and from below.
vec4 surface_at(vec2 pixel)
{
    return surface_on == 1 ? texelFetch(surface, ivec2(pixel), 0) : vec4(0.0, 0.0, 0.0, 1e30);
}
