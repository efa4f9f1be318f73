// Worley's cellular noise (Worley 1996), the mirror of libshape/field/noise_cellular.c.
float noise_worley(vec3 q, uint key)
{
    q = noise_guard3(q);
    vec3 whole = floor(q), f = q - whole;
    float least = 1.0;
    for (int z = -1; z <= 1; z++)
        for (int y = -1; y <= 1; y++)
            for (int x = -1; x <= 1; x++) {
                ivec3 d = ivec3(x, y, z);
                vec3 a = vec3(d) + vec3(noise_hash(ivec3(whole) + d, key) >> 8u) * (1.0 / 16777216.0) - f;
                least = min(least, dot(a, a));
            }
    return sqrt(least);
}

float noise_worley_fbm(vec3 q, int octaves, uint key)
{
    float sum = 0.0, weight = 1.0, weights = 0.0;
    for (int i = 0; i < octaves; i++) {
        sum += weight * (1.0 - noise_worley(q, key + uint(i)));
        weights += weight;
        weight *= 0.5;
        q *= 2.0;
    }
    return sum / weights;
}
