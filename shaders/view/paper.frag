// The method of 2018, for comparison only: Jiménez Algorithm 1 as printed, or with Algorithm 2's sweep in the view.
// Every primitive of a hit box is tested; each candidate is marched from its own entry to its own exit with its own
// gamma, so overlaps are marched twice (Algorithm 1) or take whichever sphere the sweep is in (Algorithm 2, with seams).
#include "field/cloud.glsl"
#include "field/interval.glsl"
#include "light/phase.glsl"
#include "light/sky.glsl"
#include "view/camera.glsl"

uniform highp sampler3D noise_linear; // the 64^3 lattice, filtered by the hardware
uniform highp sampler3D light_a;      // red: Eq. 7
uniform vec3 sun_direction, sun_irradiance;
uniform int paper_sweep, paper_lod;

layout(location = 0) out vec4 radiance_out;
layout(location = 1) out vec4 work_out;

float transmittance = 1.0;
vec3 radiance = vec3(0.0);
vec3 ray;

// Eq. 1 with hardware filtering: a fetch an octave.
float paper_fbm(vec3 p)
{
    vec3 q = p * cloud_inverse_scale;
    float sum = 0.0, weight = 0.5;
    for (int i = 0; i < cloud_octaves; i++) {
        int bits = int(texelFetch(clouds, ivec2(12 + i / 4, cloud_index), 0)[i % 4]);
        vec3 offset = vec3(float(bits & 63), float((bits >> 6) & 63), float((bits >> 12) & 63));
        sum += weight * texture(noise_linear, (q + offset + 0.5) / 64.0).x;
        q *= 2.0;
        weight *= 0.5;
    }
    fetches += float(cloud_octaves);
    return sum;
}

// Algorithm 3 and Eq. 13: reflected and scattered light of one step.
void paper_light(float rho, vec3 p, float width)
{
    vec4 slot = cloud_texel(cloud_index, 8), size = cloud_texel(cloud_index, 9);
    vec4 low = cloud_texel(cloud_index, 10), high = cloud_texel(cloud_index, 11);
    vec4 medium = cloud_texel(cloud_index, 16), more = cloud_texel(cloud_index, 17);
    vec3 cell = clamp((p - low.xyz) / (high.xyz - low.xyz) * size.xyz, vec3(0.5), size.xyz - 0.5);
    float received = texture(light_a, (slot.xyz + cell) / vec3(textureSize(light_a, 0))).x;
    fetches += 1.0;
    float passed = exp(-cloud_extinction * rho * width);
    float phase = phase_value(int(medium.y), medium.z, medium.w, more.x, size.w, dot(ray, sun_direction));
    vec3 light = sun_irradiance * (0.31830988618 * medium.x * received * (1.0 + phase));
    radiance += (1.0 - passed) * transmittance * light;
    transmittance *= passed;
}

float paper_step()
{
    if (paper_lod == 0)
        return 0.1;
    // As printed: A exp(-|origin - centre| delta), shorter steps far away; A = 0.1, delta = 0.01. Held above 0.005.
    return max(0.1 * exp(-length(cloud_origin - 0.5 * (cloud_min + cloud_max)) * 0.01), 0.005);
}

void march_candidate(vec4 item, float support2, inout float t)
{
    float width = paper_step();
    if (paper_sweep == 0)
        t = max(item.x, 0.0);
    else if (t > item.y)
        return;
    else
        t = max(t, item.x);
    while (t <= item.y && transmittance >= 1e-6) {
        vec3 p = cloud_origin + t * cloud_direction;
        float rho = paper_fbm(p);
        float u = sqrt(max(support2 + item.z * (t - item.x) * (t - item.y), 0.0));
        float gamma = exp(-u / max((1.0 - cloud_kappa) + 2.0 * cloud_kappa * rho, 1e-6));
        steps += 1.0;
        if (cloud_model == MODEL_UNIFORM)
            paper_light(1.0, p, width);
        else if (rho < gamma)
            paper_light(rho, p, width);
        t += max(width, 1e-6 * t); // below that a step would stand still
    }
}

// The next CANDIDATES primitives of the loaded cloud behind (entry, number), sorted by entry; number in w.
void paper_candidates(float entry, float number)
{
    candidate_count = 0;
    window_end = 1e30;
    gather_start = -1e30;
    int count = cloud_spheres + cloud_ellipsoids;
    for (int i = 0; i < count; i++) {
        vec3 hit;
        int content = i < cloud_spheres ? i + 1 : -(i - cloud_spheres + 1);
        if (!support_intersect(content, hit) || hit.y <= 0.0)
            continue;
        if (hit.x > entry || (hit.x == entry && float(i) > number))
            insert_candidate(vec4(hit, float(i)));
    }
}

void main()
{
    ray = camera_ray();
    fetches = steps = candidates_seen = 0.0;
    for (int c = 0; c < cloud_count && transmittance >= 1e-6; c++) {
        load_cloud(c, ray);
        float t0 = 0.0, t1 = 1e30;
        if (!box_intersect(cloud_min, cloud_max, cloud_origin, cloud_direction, t0, t1))
            continue;
        float t = 0.0, entry = -1e30, number = -1.0;
        do {
            paper_candidates(entry, number);
            candidates_seen += float(candidate_count);
            for (int i = 0; i < candidate_count && transmittance >= 1e-6; i++) {
                march_candidate(candidate[i], cloud_support2, t);
                entry = candidate[i].x;
                number = candidate[i].w;
            }
        } while (candidate_count == CANDIDATES && transmittance >= 1e-6);
    }
    radiance_out = vec4(radiance + transmittance * sky_radiance(ray), 1.0 - transmittance);
    work_out = vec4(steps, fetches, 0.0, candidates_seen);
}
