// One cloud's baked density and light along a ray, and the march through them. load_baked reads what a ray needs from the
// cloud's record; view/preview_one.frag has it from the corners of its tile instead.
#ifdef AIR
#include "view/air.glsl"
#endif
#include "light/phase.glsl"
#ifdef LAW
#include "light/law.glsl"
uniform highp sampler3D light_depth; // optical depth to the sun, placed like the light grids
#define LIGHT_GRIDS light_depth
#else
#include "light/beam.glsl"
uniform highp sampler3D light_seen; // source function towards the eye and the beam, placed like them
#define LIGHT_GRIDS light_seen
#endif
uniform highp sampler3D baked;      // density, distance in blocks of 4 voxels; all clouds in one atlas
uniform float step_scale;           // steps, in voxels
uniform float step_growth;          // metres a metre
uniform float step_depth;           // optical depth
uniform float step_deep;            // how much longer steps get where little shines through: 1 + step_deep at the end
uniform float transmittance_end;

float transmittance = 1.0;
vec3 radiance = vec3(0.0);
float random_start;

// The loaded cloud's grids along the ray, in texture coordinates: place = base + t * slope.
vec3 baked_base, baked_slope, light_base, light_slope, light_low, light_high;
float voxel; // metres of the world along this ray

// From the cloud's frame to texture coordinates: place = p * factor + offset.
void baked_places(int c, out vec3 factor, out vec3 offset)
{
    vec4 slot = cloud_texel(c, 18), low = cloud_texel(c, 19);
    vec3 atlas = vec3(textureSize(baked, 0));
    factor = slot.w / atlas;
    offset = (slot.xyz - low.xyz * slot.w) / atlas;
}

void light_places(int c, out vec3 factor, out vec3 offset, out vec3 low, out vec3 high)
{
    vec4 slot = cloud_texel(c, 8), size = cloud_texel(c, 9), from = cloud_texel(c, 10), to = cloud_texel(c, 11);
    vec3 atlas = vec3(textureSize(LIGHT_GRIDS, 0)), scale = size.xyz / (to.xyz - from.xyz);
    factor = scale / atlas;
    offset = (slot.xyz - from.xyz * scale) / atlas;
    low = (slot.xyz + 0.5) / atlas;
    high = (slot.xyz + size.xyz - 0.5) / atlas;
}

void load_baked(int c, vec3 direction)
{
    bool known = cloud_index == c;
    load_cloud(c, direction);
    if (known)
        return;
    vec3 factor, offset;
    baked_places(c, factor, offset);
    baked_base = cloud_origin * factor + offset;
    baked_slope = cloud_direction * factor;
    voxel = 1.0 / (cloud_texel(c, 18).w * length(cloud_direction));
    light_places(c, factor, offset, light_low, light_high);
    light_base = cloud_origin * factor + offset;
    light_slope = cloud_direction * factor;
    fetches += 6.0;
    vec4 own = cloud_texel(c, 35);
    float droplet = cloud_texel(c, 9).w;
#ifdef LAW
    law_load(c, cloud_texel(c, 16), cloud_texel(c, 17), droplet, own.rgb, direction);
#else
    beam_load(cloud_texel(c, 16), cloud_texel(c, 17), droplet, vec2(own.w, cloud_texel(c, 34).w), direction,
              light_slope * vec3(textureSize(LIGHT_GRIDS, 0)));
#endif
    fetches += 4.0;
}

vec2 baked_at(float t)
{
    fetches += 1.0;
    return texture(baked, baked_base + t * baked_slope).xy;
}

vec3 light_at(float t)
{
    fetches += 1.0;
    vec3 place = clamp(light_base + t * light_slope, light_low, light_high);
#ifdef LAW
    vec3 light = law_light(texture(light_depth, place).r);
#else
    vec3 light = beam_light(texture(light_seen, place), t);
#endif
#ifdef AIR
    light = through_air(light, t);
#endif
    return light;
}

// How far the empty blocks around a sample reach: the filter may have mixed in a neighbour's number, one less or more.
float leap(float distance) { return (distance * 255.0 - 2.0) * 4.0 * voxel; }

void add_segment(float extinction, vec3 source, float width)
{
    float passed = exp(-extinction * width);
    radiance += transmittance * (1.0 - passed) * source;
    transmittance *= passed;
}

// The step at t: no finer than the voxels, no finer than a pixel or two, and such that its optical depth stays small.
float step_length(float t)
{
    float fine = max(step_scale * voxel, step_growth * t);
    return max(fine, min(step_depth / max(cloud_extinction, 1e-6), 6.0 * voxel)) *
           (1.0 + step_deep * (1.0 - transmittance));
}

// The loaded cloud alone over [t0, t1], by far the usual case. Light changes slowly: one look-up serves two steps.
void march_loaded(float t0, float t1)
{
    for (float t = t0; t < t1 && transmittance > transmittance_end;) {
        float width = min(step_length(t), 0.5 * (t1 - t) + 1e-6), s = t + width * random_start;
        vec2 first = baked_at(s), second = baked_at(s + width);
        steps += 2.0;
        if (first.x + second.x > 0.002) {
#ifdef LAW // what comes from the sun alone does not
            add_segment(first.x * cloud_extinction, light_at(t + 0.5 * width), width);
            add_segment(second.x * cloud_extinction, light_at(t + 1.5 * width), width);
#else
            float kept = beam_kept(t + width);
            vec3 source = light_at(t + width) / kept;
            add_segment(first.x * cloud_extinction * kept, source, width);
            add_segment(second.x * cloud_extinction * kept, source, width);
#endif
            t += 2.0 * width;
        } else
            t += max(2.0 * width, leap(first.y));
    }
}

// What is cut off is shared out over what was seen, so that nothing shines through.
void close_ray()
{
    if (transmittance <= transmittance_end) {
        radiance /= 1.0 - transmittance;
        transmittance = 0.0;
    }
}
