// The preview, in a tile that one cloud alone is seen in: by far the usual case, so nothing here asks for others.
#define CANDIDATES 1
#include "field/cloud.glsl"
#include "field/interval.glsl"
#include "view/camera.glsl"
#include "view/baked.glsl"
#include "view/preview_out.glsl"

flat in vec4 tile_x, tile_y, tile_z, tile_low, tile_high;
flat in vec3 tile_baked, tile_baked_offset, tile_light, tile_light_offset, tile_light_low, tile_light_high;
flat in vec4 tile_medium, tile_more, tile_own;
flat in float tile_droplet, tile_ahead;

void load_tile(vec3 ray)
{
    cloud_origin = vec3(tile_x.w, tile_y.w, tile_z.w);
    cloud_direction = vec3(dot(tile_x.xyz, ray), dot(tile_y.xyz, ray), dot(tile_z.xyz, ray));
    cloud_extinction = tile_low.w;
    voxel = 1.0 / (tile_high.w * length(cloud_direction));
    baked_base = cloud_origin * tile_baked + tile_baked_offset;
    baked_slope = cloud_direction * tile_baked;
    light_base = cloud_origin * tile_light + tile_light_offset;
    light_slope = cloud_direction * tile_light;
    light_low = tile_light_low;
    light_high = tile_light_high;
#ifdef LAW
    law_load(0, tile_medium, tile_more, tile_droplet, tile_own.rgb, ray);
#else
    beam_load(tile_medium, tile_more, tile_droplet, vec2(tile_own.w, tile_ahead), ray,
              light_slope * vec3(textureSize(LIGHT_GRIDS, 0)));
#endif
}

void main()
{
    vec2 pixel = drawn_pixel();
    fetches = steps = 0.0;
    random_start = pixel_random_at(pixel);
    load_tile(camera_ray_at(pixel));
#ifdef AIR
    load_air(camera_ray_at(pixel), pixel, sky_behind(pixel));
#endif
    float t0 = 0.0, t1 = 1e30;
    if (!box_intersect(tile_low.xyz, tile_high.xyz, cloud_origin, cloud_direction, t0, t1))
        t1 = -1.0;
    march_loaded(t0, min(t1, surface_at(pixel).a));
    close_ray();
    put_pixel(pixel);
}
