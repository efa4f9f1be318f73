// The preview, in tiles where no cloud is.
float transmittance = 1.0, fetches = 1.0, steps = 0.0;
vec3 radiance = vec3(0.0);
#ifdef AIR
#include "view/camera.glsl"
#include "view/air.glsl"
#endif
#include "view/preview_out.glsl"

void main()
{
    vec2 pixel = drawn_pixel();
#ifdef AIR
    load_air(camera_ray_at(pixel), pixel, sky_behind(pixel));
#endif
    put_pixel(pixel);
}
