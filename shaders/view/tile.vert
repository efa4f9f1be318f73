// The tiles of a list, as squares; a tile's one cloud is read here, at the corners, and not in every pixel.
#include "field/cloud.glsl"
float fetches, steps;
#include "view/baked.glsl"

uniform highp sampler2D tile_list; // a texel a tile: column, row, and the cloud's row in the clouds texture
uniform int tile_first;            // of the list
uniform vec2 target_size;          // texels of what is drawn into
uniform float pixel_stride;        // pixels a texel of it
const float TILE_SIZE = 32.0;      // pixels

flat out vec4 tile_x, tile_y, tile_z;    // rows of the world-to-cloud matrix; w: the eye in the cloud's frame
flat out vec4 tile_low, tile_high;       // the cloud's box; w: extinction, voxels a metre of the cloud's frame
flat out vec3 tile_baked, tile_baked_offset;
flat out vec3 tile_light, tile_light_offset, tile_light_low, tile_light_high;
flat out vec4 tile_medium, tile_more; // texels 16 and 17 of the record
flat out vec4 tile_own;               // texel 35
flat out float tile_droplet, tile_ahead; // w of texels 9 and 34

void main()
{
    vec4 tile = linear_texel(tile_list, tile_first + gl_InstanceID);
    vec2 corner = vec2(gl_VertexID == 1 || gl_VertexID == 3 ? 1.0 : 0.0, gl_VertexID >= 2 ? 1.0 : 0.0);
    gl_Position = vec4((tile.xy + corner) * (TILE_SIZE / pixel_stride) / target_size * 2.0 - 1.0, 0.0, 1.0);
    int c = int(tile.z);
    tile_x = cloud_texel(c, 0);
    tile_y = cloud_texel(c, 1);
    tile_z = cloud_texel(c, 2);
    tile_low = cloud_texel(c, 3);
    tile_high = vec4(cloud_texel(c, 4).xyz, cloud_texel(c, 18).w);
    baked_places(c, tile_baked, tile_baked_offset);
    light_places(c, tile_light, tile_light_offset, tile_light_low, tile_light_high);
    tile_medium = cloud_texel(c, 16);
    tile_more = cloud_texel(c, 17);
    tile_own = cloud_texel(c, 35);
    tile_droplet = cloud_texel(c, 9).w;
    tile_ahead = cloud_texel(c, 34).w;
}
