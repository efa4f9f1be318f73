// The view pass: the joined intervals of the supports, marched once, with the analytic field and exponential segments.
#ifdef LISTED
#define CANDIDATES 96
#endif
#include "field/cloud.glsl"
#include "field/noise.glsl"
#include "field/density.glsl"
#include "field/interval.glsl"
#include "light/sky.glsl"
#include "view/camera.glsl"
#include "view/surface.glsl"
#ifdef AIR
#include "view/air.glsl"
#endif

uniform float step_scale;     // steps, in cells of the noise's first octave
uniform float step_growth;    // steps grow with distance: metres a metre, about a pixel
uniform float step_depth;     // optical depth up to which they do beyond a third of that
uniform float step_deep;      // how much longer steps get where little shines through: 1 + step_deep at the end
uniform float transmittance_end;

#include "light/phase.glsl"
#ifdef LAW
#include "light/law.glsl"
uniform highp sampler3D light_depth; // optical depth to the sun
#define LIGHT_GRIDS light_depth
#else
#include "light/beam.glsl"
uniform highp sampler3D light_seen; // source function towards the eye and the beam, see viewer/gl/grid_light.c
#define LIGHT_GRIDS light_seen
#endif

layout(location = 0) out vec4 radiance_out; // radiance, coverage
layout(location = 1) out vec4 work_out;     // steps, fetches, where to go on or -1

uniform float window_length; // of a scene with very many primitives [m]; else 1e30
uniform int resume; // go on where the picture of the last part stopped
uniform highp sampler2D part_radiance, part_work;

float transmittance = 1.0;
vec3 radiance = vec3(0.0);
vec3 ray;
float random_start;
float reached; // all before it is done

float step_length_of(float t, float deep)
{
    float seen = step_growth * t, thin = step_depth / max(cloud_extinction, 1e-6);
    return max(step_scale * cloud_step, min(seen, max(seen / 3.0, thin))) * (1.0 + deep * (1.0 - transmittance));
}

float step_length(float t) { return step_length_of(t, step_deep); }

// Source function of the loaded cloud at p, towards the eye: radiance per unit of extinction, seen through the air before t.
vec3 light_at(vec3 p, float t)
{
    vec4 slot = cloud_texel(cloud_index, 8), size = cloud_texel(cloud_index, 9);
    vec4 low = cloud_texel(cloud_index, 10), high = cloud_texel(cloud_index, 11);
    vec3 cell = clamp((p - low.xyz) / (high.xyz - low.xyz) * size.xyz, vec3(0.5), size.xyz - 0.5);
    fetches += 5.0;
    vec3 place = (slot.xyz + cell) / vec3(textureSize(LIGHT_GRIDS, 0));
#ifdef LAW
    vec3 glow = cloud_texel(cloud_index, 35).rgb;
    law_load(cloud_index, cloud_texel(cloud_index, 16), cloud_texel(cloud_index, 17), size.w, glow, ray);
    fetches += 3.0;
    vec3 light = law_light(texture(light_depth, place).r);
#else
    for (int k = cloud_index == beam_cloud ? 1 : 0; k < 1; k++) { // once a ray and cloud; a loop, as in light/law.glsl
        beam_load(cloud_texel(cloud_index, 16), cloud_texel(cloud_index, 17), size.w,
                  vec2(cloud_texel(cloud_index, 35).w, cloud_texel(cloud_index, 34).w), ray, cloud_direction / (high.xyz - low.xyz) * size.xyz);
        beam_cloud = cloud_index;
        fetches += 4.0;
    }
    vec3 light = beam_light(texture(light_seen, place), t);
#endif
#ifdef AIR
    light = through_air(light, t);
#endif
    return light;
}

void add_segment(float extinction, vec3 source, float width)
{
    float passed = exp(-extinction * width);
    radiance += transmittance * (1.0 - passed) * source;
    transmittance *= passed;
}

void add_cloud(float density, vec3 p, float s, float width)
{
    vec3 light = light_at(p, s);
    float kept = beam_kept(s);
    add_segment(density * cloud_extinction * kept, light / kept, width);
}

int work_end; // where this part stops

bool going_on() { return transmittance > transmittance_end && (work < work_end || work_end == 0); }

// One cloud alone over [reached, t1], by far the usual case.
void march_one(int first, int end, float t1)
{
    float c = candidate[first].w;
    load_cloud(int(c), ray);
    while (reached < t1 && going_on()) {
        float width = min(step_length(reached), t1 - reached), s = reached + width * random_start;
        vec3 p = cloud_origin + s * cloud_direction;
        for (; first < end - 1 && candidate[first].y < reached; first++)
            work++;
        float density = density_at(p, candidates_u2(first, end, c, s));
        steps += 1.0;
        fetches += float(cloud_octaves);
        work += cloud_octaves + 2;
        if (density > 0.0)
            add_cloud(density, p, s, width);
        reached = width < t1 - reached ? reached + width : t1;
    }
}

// ONE_CLOUD: the scene has no more, so nothing is ever mixed.
#ifndef ONE_CLOUD
// Extinction and source of all clouds at s; c walks over the clouds in the list in rising order.
void mixed_at(int first, int end, float s, bool crowded, out float extinction, out vec3 source)
{
    extinction = 0.0;
    source = vec3(0.0);
    for (float last = -1.0;;) {
        float c = 1e9;
        if (crowded)
            c = last + 1.0 < float(cloud_count) ? last + 1.0 : 1e9;
        for (int i = first; i < end && !crowded; i++, work++)
            if (candidate[i].w > last)
                c = min(c, candidate[i].w);
        if (c == 1e9)
            break;
        load_cloud(int(c), ray);
        vec3 p = cloud_origin + s * cloud_direction;
        float density = density_at(p, crowded ? cloud_u2(p, work) : candidates_u2(first, end, c, s));
        fetches += float(cloud_octaves);
        work += cloud_octaves + 2;
        if (density > 0.0) {
            source += density * cloud_extinction * light_at(p, s);
            extinction += density * cloud_extinction * beam_kept(s);
        }
        last = c;
    }
    if (extinction > 0.0)
        source /= extinction;
}

void march_mixed(int first, int end, float t1, bool crowded)
{
    load_cloud(int(candidate[first].w), ray);
    while (reached < t1 && going_on()) {
        // Borders lie within the interval, so steps may not get as long.
        float width = min(step_length_of(reached, min(step_deep, 1.0)), t1 - reached), extinction;
        vec3 source;
        mixed_at(first, end, reached + width * random_start, crowded, extinction, source);
        steps += 1.0;
        add_segment(extinction, source, width);
        reached = width < t1 - reached ? reached + width : t1;
    }
}
#endif

// Joins the window's candidates into intervals and marches each.
void march_window()
{
    for (int next = 0; next < candidate_count && candidate[next].x < window_end && going_on();) {
        int first = next;
        bool alone = true;
        float end = candidate[first].y;
        for (next++; next < candidate_count && candidate[next].x <= end; next++, work++) {
            end = max(end, candidate[next].y);
            alone = alone && candidate[next].w == candidate[first].w;
        }
        reached = max(candidate[first].x, reached);
#ifdef ONE_CLOUD
        march_one(first, next, min(end, window_end));
#else
        if (alone)
            march_one(first, next, min(end, window_end));
        else
            march_mixed(first, next, min(end, window_end), false);
#endif
    }
    if (going_on())
        reached = window_end;
}

// LISTED: crowds are left to the next part.
#ifndef LISTED
// More supports hold this point than the list has room for: by the tree, to where the last of the known ones ends. Up to
// there the interval is joined, whatever else it holds.
void march_crowd(float last)
{
    float until = reached + 1e-5 * abs(reached) + 1e-6;
    for (int i = 0; i < candidate_count; i++)
        until = max(until, candidate[i].y);
    until = min(until, last);
#ifdef ONE_CLOUD
    load_cloud(int(candidate[0].w), ray);
    while (reached < until && going_on()) {
        float width = min(step_length(reached), until - reached);
        float s = reached + width * random_start;
        vec3 p = cloud_origin + s * cloud_direction;
        float density = density_at(p, cloud_u2(p, work));
        steps += 1.0;
        fetches += float(cloud_octaves);
        work += cloud_octaves + 2;
        if (density > 0.0)
            add_cloud(density, p, s, width);
        reached = width < until - reached ? reached + width : until;
    }
#else
    march_mixed(0, candidate_count, until, true);
#endif
}
#endif

#ifdef LISTED
#include "view/march_list.glsl"
#endif

void main()
{
    vec4 behind = surface_at(gl_FragCoord.xy);
    float ray_end = behind.a; // where something opaque stands, or nothing
    ray = camera_ray();
    random_start = pixel_random();
#ifdef AIR
    load_air(ray, floor(gl_FragCoord.xy), sky_radiance(ray));
#endif
    fetches = steps = candidates_seen = reached = 0.0;
    work = 0;
    work_end = 0; // not known before the first look
#ifndef LISTED
    if (resume == 1) {
        vec4 last = texelFetch(part_work, ivec2(gl_FragCoord.xy), 0);
        vec4 light = texelFetch(part_radiance, ivec2(gl_FragCoord.xy), 0);
        radiance_out = light;
        work_out = last;
        if (last.z < 0.0)
            return;
        radiance = light.rgb;
        transmittance = light.a;
        steps = last.x;
        fetches = last.y;
        reached = last.z;
        candidates_seen = last.w;
    }
#endif
#ifdef LISTED
    march_list(ray_end);
#else
    while (reached < ray_end && going_on()) {
        float until = ray_end;
        if (window_length < ray_end) {
            reached = nearest_entry(ray, reached, ray_end);
            until = min(reached < ray_end ? reached + window_length : ray_end, ray_end);
        }
        gather(ray, reached, until);
        candidates_seen += float(candidate_count);
        work++;
        if (work_end == 0)
            work_end = work + WORK_LIMIT; // so that each part gets on
        if (candidate_count == 0)
            reached = until;
        else if (window_end <= reached)
            march_crowd(ray_end);
        else
            march_window();
    }
#endif
    if (reached < ray_end && transmittance > transmittance_end) {
        radiance_out = vec4(radiance, transmittance);
        work_out = vec4(steps, fetches, reached, candidates_seen);
        return;
    }
    if (transmittance <= transmittance_end) {
        // What is cut off is shared out over what was seen, so that nothing shines through.
        radiance /= 1.0 - transmittance;
        transmittance = 0.0;
    }
    bool sky = behind.a > NO_SURFACE;
#ifdef AIR
    behind.rgb = sky ? sky_through_air() : through_air(behind.rgb, behind.a);
#else
    behind.rgb = sky ? sky_radiance(ray) : behind.rgb;
#endif
    radiance_out = vec4(radiance + transmittance * behind.rgb, sky ? 1.0 - transmittance : 1.0);
    work_out = vec4(steps, fetches, -1.0, candidates_seen);
}
