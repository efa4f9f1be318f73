// The preview where a tile may see several clouds: density from a baked grid, light from a grid composed for this eye.
// What is marched is the supports' union as the baked grid knows it: empty blocks are leapt over by their distance to the
// next one that holds anything.
#define CANDIDATES 12
#include "field/cloud.glsl"
#include "field/interval.glsl"
#include "view/camera.glsl"
#include "view/baked.glsl"
#include "view/preview_out.glsl"

vec2 pixel; // the one that is drawn
vec3 ray;
float ray_end; // where something opaque stands

// Several clouds' boxes overlap: extinctions add.
void march_mixed(int first, int end, float t0, float t1)
{
    for (float t = t0; t < t1 && transmittance > transmittance_end;) {
        float width = t1 - t, extinction = 0.0, next = t1 - t;
        vec3 source = vec3(0.0);
        for (int i = first; i < end; i++) {
            load_baked(int(candidate[i].w), ray);
            width = min(width, step_length(t));
        }
        float s = t + width * random_start;
        steps += 1.0;
        for (int i = first; i < end; i++) {
            if (s < candidate[i].x || s > candidate[i].y)
                continue;
            load_baked(int(candidate[i].w), ray);
            vec2 here = baked_at(s);
            if (here.x > 0.001) {
                extinction += here.x * cloud_extinction * beam_kept(s);
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
    ivec2 list = tile_clouds_at(ivec2(pixel));
    for (float t = t0; t < t1 && transmittance > transmittance_end;) {
        load_baked(int(candidate[0].w), ray);
        float width = min(step_length(t), t1 - t), s = t + width * random_start;
        float extinction = 0.0;
        vec3 source = vec3(0.0);
        for (int i = 0; i < list.y; i++) {
            load_baked(int(linear_texel(tiles, list.x + i).x), ray);
            vec3 p = cloud_origin + s * cloud_direction;
            if (any(lessThan(p, cloud_min)) || any(greaterThan(p, cloud_max)))
                continue;
            float density = baked_at(s).x;
            extinction += density * cloud_extinction * beam_kept(s);
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
    ivec2 list = tile_clouds_at(ivec2(pixel));
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
        float t0 = max(candidate[first].x, t_min), t1 = min(min(end, window_end), ray_end);
        if (next == first + 1) {
            load_baked(int(candidate[first].w), ray);
            march_loaded(t0, t1);
        } else
            march_mixed(first, next, t0, t1);
    }
}

void main()
{
    pixel = drawn_pixel();
    ray = camera_ray_at(pixel);
    random_start = pixel_random_at(pixel);
    fetches = steps = 0.0;
    ray_end = surface_at(pixel).a;
#ifdef AIR
    load_air(ray, pixel, sky_behind(pixel));
#endif
    for (float t = 0.0; t < ray_end && transmittance > transmittance_end;) {
        gather_boxes(t);
        if (candidate_count == 0)
            break;
        if (window_end <= t) {
            float until = 1e30;
            for (int i = 0; i < candidate_count; i++)
                until = min(until, candidate[i].y);
            until = max(until, t + 1e-5 * abs(t) + 1e-6);
            march_crowd(t, min(until, ray_end));
            t = until;
            continue;
        }
        march_window(t);
        t = window_end;
    }
    close_ray();
    put_pixel(pixel);
}
