// The light grid of a cloud, and the light scattered towards the eye at a point. See libshape/include/shape/lightgrid.h
// for what a cell holds.
uniform highp sampler3D light_a, light_b; // atlas of all clouds' grids; values 0..3 and 4..7
uniform vec3 sun_direction, sun_irradiance, sky_upper, sky_lower;
uniform vec3 world_up; // unit

// Source function (radiance per unit of extinction, albedo included) at p of the loaded cloud, towards the eye.
// direction is the world ray's. Beer's law for the sun, its phase function exactly; the light that left the beam within
// the phase function's peak goes on as a wider beam; the rest from the grid to first order, mean + 3 g flux. The viewer and the
// march know more: shape_lightgrid_seen follows light through the grid to the eye (docs/light.md).
vec3 scattered_light(vec3 p, vec3 direction)
{
    vec4 slot = cloud_texel(cloud_index, 8), size = cloud_texel(cloud_index, 9);
    vec4 low = cloud_texel(cloud_index, 10), high = cloud_texel(cloud_index, 11);
    vec4 medium = cloud_texel(cloud_index, 16), more = cloud_texel(cloud_index, 17);
    vec3 cell = clamp((p - low.xyz) / (high.xyz - low.xyz) * size.xyz, vec3(0.5), size.xyz - 0.5);
    vec3 place = (slot.xyz + cell) / vec3(textureSize(light_a, 0));
    vec4 a = texture(light_a, place), b = texture(light_b, place);
    fetches += 8.0;
    float albedo = medium.x, mean_cosine = more.y, peak = more.z, rest = more.w;
    float cos_sun = dot(direction, sun_direction); // travel before: -sun, after: -direction
    float direct = exp(-a.x), wide = exp(-(1.0 - albedo * peak) * a.x);
    float beam = direct * phase_value(int(medium.y), medium.z, medium.w, more.x, size.w, cos_sun) +
                 (1.0 - peak) * (wide - direct) * phase_value(0, rest, 0.0, 0.0, 0.0, cos_sun);
    vec3 travel = -normalize(cloud_direction);
    float sun_scattered = max(a.y + 3.0 * mean_cosine * dot(b.xyz, travel), 0.0);
    float upper = max(a.z + 3.0 * mean_cosine * b.w * -dot(direction, world_up), 0.0);
    return albedo * (sun_irradiance * (beam + sun_scattered) + sky_upper * upper + sky_lower * a.w);
}
