// Perlin's gradient noise on hashed, periodic cells, the mirror of libshape/field/noise_hash.h and noise_gradient.c.
// pcg3d: Jarzynski and Olano 2020; noise: Perlin 2002.
uvec3 noise_hash(ivec3 cell, uint key)
{
    uvec3 v = (uvec3(cell) & 1023u) + key * uvec3(1u, 0x9e3779b1u, 0x85ebca77u);
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> 16u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return v;
}

vec3 noise_guard3(vec3 q) { return vec3(noise_guard(q.x), noise_guard(q.y), noise_guard(q.z)); }

float noise_gradient(uint bits, vec3 d)
{
    uint h = bits >> 28u;
    float u = h < 8u ? d.x : d.y, v = h < 4u ? d.y : (h == 12u || h == 14u ? d.x : d.z);
    return ((h & 1u) != 0u ? -u : u) + ((h & 2u) != 0u ? -v : v);
}

vec3 noise_gradient3(ivec3 cell, vec3 f, ivec3 corner, uint key)
{
    uvec3 bits = noise_hash(cell + corner, key);
    vec3 d = f - vec3(corner);
    return vec3(noise_gradient(bits.x, d), noise_gradient(bits.y, d), noise_gradient(bits.z, d));
}

vec3 noise_perlin3(vec3 q, uint key)
{
    q = noise_guard3(q);
    vec3 whole = floor(q), f = q - whole, t = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    ivec3 c = ivec3(whole);
    vec3 low = mix(mix(noise_gradient3(c, f, ivec3(0, 0, 0), key), noise_gradient3(c, f, ivec3(1, 0, 0), key), t.x),
                   mix(noise_gradient3(c, f, ivec3(0, 1, 0), key), noise_gradient3(c, f, ivec3(1, 1, 0), key), t.x), t.y);
    vec3 high = mix(mix(noise_gradient3(c, f, ivec3(0, 0, 1), key), noise_gradient3(c, f, ivec3(1, 0, 1), key), t.x),
                    mix(noise_gradient3(c, f, ivec3(0, 1, 1), key), noise_gradient3(c, f, ivec3(1, 1, 1), key), t.x), t.y);
    return clamp(mix(low, high, t.z), -1.0, 1.0);
}

vec3 noise_perlin3_fbm(vec3 q, int octaves, uint key)
{
    vec3 sum = vec3(0.0);
    float weight = 1.0, weights = 0.0;
    for (int i = 0; i < octaves; i++) {
        sum += weight * noise_perlin3(q, key + uint(i));
        weights += weight;
        weight *= 0.5;
        q *= 2.0;
    }
    return sum / weights;
}

// The first of the three is the scalar noise.
float noise_perlin_fbm(vec3 q, int octaves, uint key) { return noise_perlin3_fbm(q, octaves, key).x; }
