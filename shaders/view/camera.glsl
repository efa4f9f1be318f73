// The camera's rays (shape/view.h) and the random start of each pixel.
uniform vec3 camera_forward, camera_right, camera_up;
uniform vec2 picture_size; // pixels
uniform vec2 picture_origin; // of a tile: pixels to the left of it and below
uniform vec2 pixel_shift;  // within the pixel, 0 to 1
uniform int sample_number;
uniform int seed; // of the starts; 0 for the default seed

// pixel: whole numbers, from the left and from below.
vec3 camera_ray_at(vec2 pixel)
{
    vec2 place = (pixel + picture_origin + pixel_shift) / picture_size * 2.0 - 1.0;
    return normalize(camera_forward + place.x * camera_right + place.y * camera_up);
}

vec3 camera_ray() { return camera_ray_at(floor(gl_FragCoord.xy)); }

uint hash_bits(uint x)
{
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ (x >> 16);
}

// Uniform in [0, 1): hashed by pixel, then a golden-ratio sequence over the samples of a pixel.
float pixel_random_at(vec2 pixel)
{
    uvec2 p = uvec2(pixel + picture_origin);
    float start = float(hash_bits(p.x + hash_bits(p.y + uint(seed))) >> 8) / 16777216.0;
    return fract(start + float(sample_number) * 0.6180339887);
}

float pixel_random() { return pixel_random_at(floor(gl_FragCoord.xy)); }
