// How the preview's shaders end: the picture, or the first pass of a moving view's.
#include "view/sky_picture.glsl"
#include "view/surface.glsl"
uniform float pixel_stride; // pixels a texel of what is drawn into: 2 in the first pass of a moving view, else 1

layout(location = 0) out vec4 radiance_out; // radiance, coverage; first pass: radiance without the sky, transmittance
layout(location = 1) out vec4 work_out;

vec2 drawn_pixel() { return floor(gl_FragCoord.xy) * pixel_stride; }

void put_pixel(vec2 pixel)
{
    if (pixel_stride > 1.0)
        radiance_out = vec4(radiance, transmittance);
    else {
        vec4 behind = surface_at(pixel);
        bool sky = behind.a > NO_SURFACE;
#ifdef AIR
        behind.rgb = sky ? sky_through_air() : through_air(behind.rgb, behind.a);
#else
        behind.rgb = sky ? sky_behind(pixel) : behind.rgb;
#endif
        radiance_out = vec4(radiance + transmittance * behind.rgb, sky ? 1.0 - transmittance : 1.0);
    }
    work_out = vec4(steps, fetches, 0.0, 0.0);
}
