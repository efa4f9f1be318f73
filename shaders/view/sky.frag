// The sky of a picture, once every SKY_SPACING pixels: it changes slowly, and its formula costs more than a look-up.
#include "light/sky.glsl"
#include "view/camera.glsl"
#include "view/sky_picture.glsl"

layout(location = 0) out vec4 radiance_out;
layout(location = 1) out vec4 work_out;

void main()
{
    radiance_out = vec4(sky_radiance(camera_ray_at(floor(gl_FragCoord.xy) * SKY_SPACING)), 1.0);
    work_out = vec4(0.0);
}
