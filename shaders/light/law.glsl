// The light of a point by its optical depth to the sun alone, the mirror of libshape/light/march_light.c; docs/light.md has each
// law and its source. LAW is its number: 1 single, 2 powder, 3 powder-angle, 4 beer-max, 5 octaves. Before it: light/phase.glsl.
uniform vec3 law_sun_direction, law_sun; // irradiance on a plane that faces it
uniform vec3 law_sky;                    // mean radiance of the sky's two halves; octaves
uniform float law_powder;                // k
uniform float law_weights[8];            // of the copies, 1 in all; octaves

#if LAW == 5
const int LAW_COPIES = 8;
#else
const int LAW_COPIES = 1;
#endif

// The cloud whose medium is loaded, and what of it is the same all along a ray: its phase function with the albedo (and with
// the weights, of octaves), the cosine between the ray and the way to the sun, and what comes from all round.
int law_cloud = -1;
float law_scatter[LAW_COPIES];
float law_cosine;
vec3 law_sky_here, law_glow;

// medium, more, glow: texels 16, 17 and 35 of the cloud's record (shape/record.h); ray: of the world, unit.
void law_load(int c, vec4 medium, vec4 more, float droplet, vec3 glow, vec3 ray)
{
    int kind = int(medium.y);
    // Loops, since Mesa's software renderer runs through an `if` whatever it says.
    for (int k = c == law_cloud ? 1 : 0; k < 1; k++) {
        law_cosine = dot(ray, law_sun_direction);
        law_scatter[0] = medium.x * phase_value(kind, medium.z, medium.w, more.x, droplet, law_cosine);
        law_sky_here = medium.x * law_sky;
        law_glow = glow;
    }
#if LAW == 5
    // Copy k has the mean cosine halved k times; Mie's function begins as itself and goes on as that of its mean cosine.
    for (int k = c == law_cloud ? LAW_COPIES : 1; k < LAW_COPIES; k++) {
        float share = exp2(-float(k)), one = phase_hg((kind == 3 ? more.y : medium.z) * share, law_cosine);
        float two = phase_hg(medium.w * share, law_cosine), value = kind == 4 ? mix(one, two, more.x) : one;
        law_scatter[k] = law_weights[k] * (kind == 1 || kind == 2 ? law_scatter[0] : medium.x * value);
    }
    for (int k = c == law_cloud ? 1 : 0; k < 1; k++)
        law_scatter[0] *= law_weights[0];
#endif
    law_cloud = c;
}

// As of light/beam.glsl: by a law, what is scattered straight on is lost to the ray.
float beam_kept(float t) { return 1.0; }

// Source function (radiance per unit of extinction, albedo included) towards the eye.
vec3 law_light(float depth)
{
#if LAW == 5
    float passed = exp(-depth / 128.0), sum = 0.0, sky = 0.0;
    for (int k = LAW_COPIES - 1; k >= 0; k--) { // exp(-depth / 2^k)
        sum += law_scatter[k] * passed;
        sky = k == 3 ? passed : sky;
        passed *= passed;
    }
    return sum * law_sun + sky * law_sky_here + law_glow;
#else
    float passed = exp(-depth);
#if LAW == 2
    passed *= 1.0 - exp(-law_powder * depth);
#elif LAW == 3
    passed *= 1.0 - (0.5 - 0.5 * law_cosine) * exp(-law_powder * depth);
#elif LAW == 4
    passed = max(passed, 0.7 * exp(-0.25 * depth));
#endif
    return law_scatter[0] * passed * law_sun + law_glow;
#endif
}
