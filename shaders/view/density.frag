// For the tests: the density at given points of cloud 0, one a pixel.
#include "field/cloud.glsl"
#include "field/noise.glsl"
#include "field/density.glsl"

uniform highp sampler2D points; // xyz in the cloud's frame

layout(location = 0) out vec4 density_out;
layout(location = 1) out vec4 unused_out;

void main()
{
    load_cloud(0, vec3(0.0, 0.0, 1.0));
    vec3 p = texelFetch(points, ivec2(gl_FragCoord.xy), 0).xyz;
    int visited = 0;
    float u2 = cloud_u2(p, visited);
    density_out = vec4(density_at(p, u2), u2, noise_fbm(p), 0.0);
    unused_out = vec4(0.0);
}
