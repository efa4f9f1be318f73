// The preview: density from a baked grid, light from a grid composed for this eye. What is marched is the supports' union
// as the baked grid knows it: empty blocks are leapt over by their distance to the next one that holds anything.
#define CANDIDATES 12
#include "field/cloud.glsl"
#include "field/interval.glsl"
#include "light/sky.glsl"
#include "view/camera.glsl"

uniform highp sampler3D baked;      // density, distance in blocks of 4 voxels; all clouds in one atlas
uniform highp sampler3D light_seen; // source function towards the eye, placed like the light grids
uniform float step_scale;           // steps, in voxels
uniform float step_growth;          // metres a metre
uniform float step_depth;           // optical depth
uniform float transmittance_end;

layout(location = 0) out vec4 radiance_out;
layout(location = 1) out vec4 work_out;

float transmittance = 1.0;
vec3 radiance = vec3(0.0);
vec3 ray;
float random_start;

// The loaded cloud's grids along the ray, in texture coordinates: place = base + t * slope.
vec3 baked_base, baked_slope, light_base, light_slope, light_low, light_high;
float voxel; // metres of the world along this ray

void load_baked(int c)
{
    bool known = cloud_index == c;
    load_cloud(c, ray);
    if (known)
        return;
    vec4 slot = cloud_texel(c, 18), low = cloud_texel(c, 19);
    vec3 atlas = vec3(textureSize(baked, 0));
    baked_base = ((cloud_origin - low.xyz) * slot.w + slot.xyz) / atlas;
    baked_slope = cloud_direction * slot.w / atlas;
    voxel = 1.0 / (slot.w * length(cloud_direction));
    vec4 light_slot = cloud_texel(c, 8), size = cloud_texel(c, 9), box_low = cloud_texel(c, 10),
         box_high = cloud_texel(c, 11);
    vec3 scale = size.xyz / (box_high.xyz - box_low.xyz);
    atlas = vec3(textureSize(light_seen, 0));
    light_base = ((cloud_origin - box_low.xyz) * scale + light_slot.xyz) / atlas;
    light_slope = cloud_direction * scale / atlas;
    light_low = (light_slot.xyz + 0.5) / atlas;
    light_high = (light_slot.xyz + size.xyz - 0.5) / atlas;
    fetches += 6.0;
}

vec2 baked_at(float t)
{
    fetches += 1.0;
    return texture(baked, baked_base + t * baked_slope).xy;
}

vec3 light_at(float t)
{
    fetches += 1.0;
    return texture(light_seen, clamp(light_base + t * light_slope, light_low, light_high)).rgb;
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
    return max(max(step_scale * voxel, step_growth * t), min(step_depth / max(cloud_extinction, 1e-6), 6.0 * voxel));
}

// One cloud alone over [t0, t1], by far the usual case. Light changes slowly: one look-up serves two steps.
void march_one(int c, float t0, float t1)
{
    load_baked(c);
    for (float t = t0; t < t1 && transmittance > transmittance_end;) {
        float width = min(step_length(t), 0.5 * (t1 - t) + 1e-6), s = t + width * random_start;
        vec2 first = baked_at(s), second = baked_at(s + width);
        steps += 2.0;
        if (first.x + second.x > 0.002) {
            vec3 source = light_at(t + width);
            add_segment(first.x * cloud_extinction, source, width);
            add_segment(second.x * cloud_extinction, source, width);
            t += 2.0 * width;
        } else
            t += max(2.0 * width, leap(first.y));
    }
}

// Several clouds' boxes overlap: extinctions add.
void march_mixed(int first, int end, float t0, float t1)
{
    for (float t = t0; t < t1 && transmittance > transmittance_end;) {
        float width = t1 - t, extinction = 0.0, next = t1 - t;
        vec3 source = vec3(0.0);
        for (int i = first; i < end; i++) {
            load_baked(int(candidate[i].w));
            width = min(width, step_length(t));
        }
        float s = t + width * random_start;
        steps += 1.0;
        for (int i = first; i < end; i++) {
            if (s < candidate[i].x || s > candidate[i].y)
                continue;
            load_baked(int(candidate[i].w));
            vec2 here = baked_at(s);
            if (here.x > 0.001) {
                extinction += here.x * cloud_extinction;
                source += here.x * cloud_extinction * light_at(s);
                next = width;
            } else
                next = min(next, max(width, leap(here.y)));
        }
        if (extinction > 0.0)
            add_segment(extinction, source / extinction, width);
        for (int i = first; i < end; i++)
            if (candidate[i].x > t)
                next = min(next, max(candidate[i].x - t, width));
        t += max(next, width);
    }
}

// More boxes hold one point than the list has room for: every cloud of the tile is asked at every step.
void march_crowd(float t0, float t1)
{
    ivec2 list = tile_clouds();
    for (float t = t0; t < t1 && transmittance > transmittance_end;) {
        load_baked(int(candidate[0].w));
        float width = min(step_length(t), t1 - t), s = t + width * random_start;
        float extinction = 0.0;
        vec3 source = vec3(0.0);
        for (int i = 0; i < list.y; i++) {
            load_baked(int(linear_texel(tiles, list.x + i).x));
            vec3 p = cloud_origin + s * cloud_direction;
            if (any(lessThan(p, cloud_min)) || any(greaterThan(p, cloud_max)))
                continue;
            float density = baked_at(s).x;
            extinction += density * cloud_extinction;
            source += density * cloud_extinction * light_at(s);
        }
        steps += 1.0;
        if (extinction > 0.0)
            add_segment(extinction, source / extinction, width);
        t += width;
    }
}

void gather_boxes(float t_min)
{
    candidate_count = 0;
    window_end = 1e30;
    gather_start = t_min;
    ivec2 list = tile_clouds();
    for (int i = 0; i < list.y; i++) {
        int c = int(linear_texel(tiles, list.x + i).x);
        float t0 = t_min, t1 = 1e30;
        load_ray(c, ray);
        cloud_index = -1;
        fetches += 6.0;
        if (box_intersect(cloud_min, cloud_max, cloud_origin, cloud_direction, t0, t1))
            insert_candidate(vec4(t0, t1, 0.0, float(c)));
    }
}

void march_window(float t_min)
{
    for (int next = 0; next < candidate_count && transmittance > transmittance_end;) {
        int first = next;
        float end = candidate[first].y;
        for (next++; next < candidate_count && candidate[next].x < end; next++)
            end = max(end, candidate[next].y);
        float t0 = max(candidate[first].x, t_min), t1 = min(end, window_end);
        if (next == first + 1)
            march_one(int(candidate[first].w), t0, t1);
        else
            march_mixed(first, next, t0, t1);
    }
}

void main()
{
    ray = camera_ray();
    random_start = pixel_random();
    fetches = steps = 0.0;
    ivec2 list = tile_clouds();
    float begin = 0.0;
    if (list.y == 1) {
        /* One cloud in the tile: no list of candidates is needed. */
        int c = int(linear_texel(tiles, list.x).x);
        float t0 = 0.0, t1 = 1e30;
        load_baked(c);
        if (box_intersect(cloud_min, cloud_max, cloud_origin, cloud_direction, t0, t1))
            march_one(c, t0, t1);
        begin = 1e30;
    }
    for (float t = begin; t < 1e30 && transmittance > transmittance_end;) {
        gather_boxes(t);
        if (candidate_count == 0)
            break;
        if (window_end <= t) {
            float until = 1e30;
            for (int i = 0; i < candidate_count; i++)
                until = min(until, candidate[i].y);
            until = max(until, t + 1e-5 * abs(t) + 1e-6);
            march_crowd(t, until);
            t = until;
            continue;
        }
        march_window(t);
        t = window_end;
    }
    if (transmittance <= transmittance_end) {
        radiance /= 1.0 - transmittance;
        transmittance = 0.0;
    }
    if (transmittance > 0.0)
        radiance += transmittance * sky_radiance(ray);
    radiance_out = vec4(radiance, 1.0 - transmittance);
    work_out = vec4(steps, fetches, 0.0, 0.0);
}
