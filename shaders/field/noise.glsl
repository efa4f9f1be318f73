// Lattice noise and its fractal sum, the mirror of libshape/field/noise.c. One texel holds a cell's eight corners as
// 16-bit numbers, so an octave costs one fetch.
uniform highp usampler3D noise_cells;

// OCTAVES: how many the scene's one cloud has, so that compilers unroll the loop.
#ifndef OCTAVES
#define OCTAVES cloud_octaves
#endif

float noise_guard(float x) { return abs(x) < 1e8 ? x : 0.0; }

float noise_value(vec3 q, ivec3 offset)
{
    vec3 whole = floor(q), f = q - whole;
    uvec4 c = texelFetch(noise_cells, (ivec3(whole) + offset) & 63, 0);
    vec4 even = vec4(c & 0xffffu), odd = vec4(c >> 16u);
    vec4 x = even + f.x * (odd - even);
    vec2 y = x.xz + f.y * (x.yw - x.xz);
    return (y.x + f.z * (y.y - y.x)) * (1.0 / 65535.0);
}

ivec3 noise_offset(int c, int octave)
{
    float code = cloud_texel(c, 12 + octave / 4)[octave % 4];
    int bits = int(code);
    return ivec3(bits & 63, (bits >> 6) & 63, (bits >> 12) & 63);
}

// Jiménez 2018 Eq. 1 with w = 1/2, s = 2; q in cells of the first octave.
float noise_fbm_cells(vec3 q)
{
    float sum = 0.0, weight = 0.5;
    for (int i = 0; i < OCTAVES; i++) {
        q = vec3(noise_guard(q.x), noise_guard(q.y), noise_guard(q.z));
        sum += weight * noise_value(q, noise_offset(cloud_index, i));
        q *= 2.0;
        weight *= 0.5;
    }
    return sum;
}

// p in the cloud's frame.
float noise_fbm(vec3 p) { return noise_fbm_cells(p * cloud_inverse_scale); }
