// The sun's light scattered within the phase function's peak, for each ray, and what goes straight on near the eye: the mirror of libshape/light/beam.c.
// Before it: light/phase.glsl, field/cloud.glsl.
uniform vec3 beam_sun_direction, beam_sun; // irradiance on a plane that faces it

// Of the cloud whose medium is loaded, for one ray: what light that has not left the peak is multiplied with, and what has not
// been scattered at all.
int beam_cloud = -1; // for those who ask at each look
vec3 beam_blunt, beam_peak, beam_spread; // and what has been
float beam_turns;                        // scatterings within the peak where light falls to a half
float beam_wide, beam_aside;             // minus the logarithm of the peak's mean cosine; log2 e (1 - the cosine to the sun)
float beam_straight, beam_near;          // of extinction, what goes straight on; the square of a metre, in cells, over 16

// medium, more: texels 16 and 17 of the cloud's record (shape/record.h); peak: w of 35 and of 34; ray: of the world, unit; cells: of
// the light grid, that a metre of it crosses along each axis.
void beam_load(vec4 medium, vec4 more, float droplet, vec2 peak, vec3 ray, vec3 cells)
{
    float cosine = dot(ray, beam_sun_direction);
    float value = phase_value(int(medium.y), medium.z, medium.w, more.x, droplet, cosine);
    float blunt = min(value, peak.x);
    beam_blunt = medium.x * blunt * beam_sun;
    beam_peak = medium.x * (value - blunt) * beam_sun;
    beam_straight = medium.x * more.z;
    beam_turns = 0.69314718 * beam_straight / max(1.0 - beam_straight, 1e-5);
    beam_spread = 0.159154943 * beam_straight * beam_sun;
    beam_wide = -log(peak.y);
    beam_aside = 1.44269504 * (1.0 - cosine);
    beam_near = 0.0625 * dot(cells, cells);
}

// seen: a texel of the light grid composed for this eye, at t [m]. Source function: radiance per unit of extinction, albedo included.
vec3 beam_light(vec4 seen, float t)
{
    float turns = -beam_turns * log2(max(seen.a, 1e-30)), bare = exp2(-1.44269504 * turns);
    float narrow = 0.5 + (1.0 - bare) / (beam_wide * (1.0 - bare + turns) + 1e-6), away = beam_near * t * t;
    float spread = narrow * exp2(-narrow * beam_aside) * (1.0 - bare) * away / (1.0 + away);
    return seen.rgb + seen.a * (beam_blunt + bare * beam_peak + spread * beam_spread);
}

// What is left of the extinction at t [m], shape_beam_kept.
float beam_kept(float t) { return 1.0 - beam_straight / (1.03125 + beam_near * t * t); }
