// The camera's rays (shape/view.h) and the random start of each pixel.
uniform vec3 camera_forward, camera_right, camera_up;
uniform vec2 picture_size; // pixels
uniform vec2 picture_origin; // of a tile: pixels to the left of it and below
uniform vec2 pixel_shift;  // within the pixel, 0 to 1
uniform int sample_number;
uniform int seed; // of the starts; 0 for the default seed

vec3 camera_ray()
{
    vec2 pixel = (floor(gl_FragCoord.xy) + picture_origin + pixel_shift) / picture_size * 2.0 - 1.0;
    return normalize(camera_forward + pixel.x * camera_right + pixel.y * camera_up);
}

uint hash_bits(uint x)
{
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ (x >> 16);
}

// Uniform in [0, 1): hashed by pixel, then a golden-ratio sequence over the samples of a pixel.
float pixel_random()
{
    uvec2 p = uvec2(gl_FragCoord.xy + picture_origin);
    float start = float(hash_bits(p.x + hash_bits(p.y + uint(seed))) >> 8) / 16777216.0;
    return fract(start + float(sample_number) * 0.6180339887);
}
