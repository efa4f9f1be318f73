// The sun's first scattering for each ray, and what goes straight on near the eye, the mirror of libshape/light/beam.c. Before it: light/phase.glsl, field/cloud.glsl.
uniform vec3 beam_sun_direction, beam_sun; // irradiance on a plane that faces it

// Of the cloud whose medium is loaded, for one ray: what the beam's value, and a power of it, are to be multiplied with.
int beam_cloud = -1; // for those who ask at each look
vec3 beam_blunt, beam_peak;
float beam_power;
float beam_straight, beam_near; // of extinction, what goes straight on; the square of a metre, in cells, over 16

// medium, more: texels 16 and 17 of the cloud's record (shape/record.h); cap: shape_beam_cap's; ray: of the world, unit; cells: of
// the light grid, that a metre of it crosses along each axis.
void beam_load(vec4 medium, vec4 more, float droplet, float cap, vec3 ray, vec3 cells)
{
    float value = phase_value(int(medium.y), medium.z, medium.w, more.x, droplet, dot(ray, beam_sun_direction));
    float blunt = min(value, cap);
    beam_blunt = medium.x * blunt * beam_sun;
    beam_peak = medium.x * (value - blunt) * beam_sun;
    beam_power = 1.0 / max(1.0 - medium.x * more.z, 1e-5);
    beam_straight = medium.x * more.z;
    beam_near = 0.0625 * dot(cells, cells);
}

// seen: a texel of the light grid composed for this eye. Source function: radiance per unit of extinction, albedo included.
vec3 beam_light(vec4 seen) { return seen.rgb + seen.a * beam_blunt + pow(seen.a, beam_power) * beam_peak; }

// What is left of the extinction at t [m], shape_beam_kept.
float beam_kept(float t) { return 1.0 - beam_straight / (1.03125 + beam_near * t * t); }
