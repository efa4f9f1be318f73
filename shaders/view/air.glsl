// What the air between makes of what a ray sees; only where AIR is defined. load_air first.
uniform vec3 sun_direction, sun_irradiance, air_sky_mean;
uniform int sky_hidden; // the sky lights the air, and is not seen itself
#include "light/air.glsl"
#include "view/air_layout.glsl"
uniform highp sampler2D air_shadow; // view/air_sum.frag's

vec3 air_sky, air_sun_light; // the air's light where it lies in the sun, and the sun's part of it
vec2 air_column;

void load_air(vec3 ray, vec2 pixel, vec3 sky)
{
    const float g = 0.76; // of haze, as in libshape/light/air.c
    float base = (1.0 - g) * (1.0 - g) + 2.0 * g * max(1.0 - dot(ray, sun_direction), 0.0);
    vec3 sun = sun_irradiance * ((1.0 - g * g) / (12.5663706 * base * sqrt(base)));
    air_sky = sky;
    air_sun_light = sky * sun / max(sun + air_sky_mean, vec3(1e-20));
    air_column = pixel / AIR_SPACING + 0.5;
    air_load(ray);
}

float air_picture(int slice)
{
    vec2 whole = vec2(textureSize(air_shadow, 0)), size = whole / vec2(AIR_ACROSS, AIR_SLICES / AIR_ACROSS);
    vec2 at = clamp(air_column, vec2(0.5), size - 0.5);
    return texture(air_shadow, (vec2(air_corner(slice, ivec2(size))) + at) / whole).r;
}

// The shadow of the air before t.
float air_dark_before(float t)
{
    float x = air_slice(t) * float(AIR_SLICES);
    int slice = min(int(x), AIR_SLICES - 1);
    return mix(slice > 0 ? air_picture(slice - 1) : 0.0, air_picture(slice), x - float(slice));
}

vec3 through_air(vec3 light, float t)
{
    float passed = exp(-air_depth(t)), air = 1.0 - passed;
    return passed * light + air * air_sky - min(air_dark_before(t), air) * air_sun_light;
}

vec3 sky_through_air() { return sky_hidden == 1 ? vec3(0.0) : max(air_sky - air_dark_before(1e30) * air_sun_light, 0.0); }
