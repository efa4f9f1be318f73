// The preview, in tiles where no cloud is.
float transmittance = 1.0, fetches = 1.0, steps = 0.0;
vec3 radiance = vec3(0.0);
#include "view/preview_out.glsl"

void main() { put_pixel(drawn_pixel()); }
