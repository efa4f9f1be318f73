// One cloud of a scene over what is already there: its density marched, its light looked up. The engine's own shader;
// all that knows about clouds comes from Nephele's (shaders/README.md), whose inputs engine.c fills.
#include "field/cloud.glsl"
#include "field/noise.glsl"
#include "field/density.glsl"
#include "field/interval.glsl"
#include "light/phase.glsl"
#include "light/lightgrid.glsl"
#include "view/camera.glsl"

const int SAMPLES = 4; // rays a pixel
const float EXPOSURE = 1.41;

layout(location = 0) out vec4 colour_out; // premultiplied

// Where the next of the gathered supports begins behind t; none: stop.
float next_support(float t, float stop)
{
    for (int i = 0; i < candidate_count; i++)
        if (candidate[i].x > t)
            return min(candidate[i].x, stop);
    return stop;
}

// The radiance of the cloud along a ray from the eye, and what passes. The supports that the ray meets are gathered in
// windows (field/interval.glsl); where more hold a place than a window has room for, the tree is asked instead.
vec4 march(vec3 ray, float random_start)
{
    float passed = 1.0;
    vec3 radiance = vec3(0.0);
    for (float t = 0.0; t < 1e30 && passed > 0.002;) {
        candidate_count = 0;
        window_end = 1e30;
        gather_start = t;
        gather_cloud(0, ray, t, 1e30);
        if (candidate_count == 0)
            break;
        float width = 0.25 * cloud_step; // cloud_step: metres a cell of the noise's first octave
        bool crowded = window_end <= t;
        float stop = crowded ? t + 8.0 * width : window_end;
        while (t < stop && passed > 0.002) {
            float s = t + random_start * width;
            vec3 p = cloud_origin + s * cloud_direction;
            float u2 = crowded ? cloud_u2(p, work) : candidates_u2(0, candidate_count, 0.0, s);
            float density = density_at(p, u2);
            if (density > 0.0) {
                float kept = exp(-density * cloud_extinction * width);
                radiance += passed * (1.0 - kept) * scattered_light(p, ray);
                passed *= kept;
            }
            t = u2 > cloud_support2 && !crowded ? max(t + width, next_support(t, stop)) : t + width;
        }
    }
    return vec4(radiance, passed);
}

// The screen's values: what is brighter than 0.6 is bent below 1, then the curve of sRGB.
vec3 to_screen(vec3 x)
{
    x = min(x, vec3(0.6)) + 0.4 * (1.0 - exp(-max(x - 0.6, 0.0) / 0.4));
    return pow(x, vec3(1.0 / 2.2));
}

void main()
{
    vec4 sum = vec4(0.0);
    for (int i = 0; i < SAMPLES; i++) {
        vec2 shift = fract(0.5 + float(i) * vec2(0.7548777, 0.5698403)); // Roberts' R2 sequence
        vec2 pixel = (gl_FragCoord.xy - 0.5 + shift) / picture_size * 2.0 - 1.0;
        vec3 ray = normalize(camera_forward + pixel.x * camera_right + pixel.y * camera_up);
        sum += march(ray, fract(pixel_random() + float(i) * 0.6180340)) / float(SAMPLES);
    }
    float cover = 1.0 - sum.a;
    colour_out = cover > 0.0 ? vec4(to_screen(sum.rgb / cover * EXPOSURE) * cover, cover) : vec4(0.0);
}
