// Density of a voxel grid, the mirror of shape_grid_sample: in units of the grid's largest, which the cloud's extinction
// makes up for.
uniform highp sampler3D grid_values; // the values of all grids, in one atlas (viewer/gl/volumes.c)

float grid_value(ivec3 at) { return texelFetch(grid_values, at, 0).x; }

float grid_density(vec3 p)
{
    vec3 last = cloud_texel(cloud_index, 21).xyz - 1.0;
    if (any(lessThan(p, vec3(0.0))) || any(greaterThanEqual(p, last)))
        return 0.0;
    vec3 cell = floor(p), t = p - cell;
    ivec3 at = ivec3(cell + cloud_texel(cloud_index, 20).xyz);
    float low = mix(mix(grid_value(at), grid_value(at + ivec3(1, 0, 0)), t.x),
                    mix(grid_value(at + ivec3(0, 1, 0)), grid_value(at + ivec3(1, 1, 0)), t.x), t.y);
    float high = mix(mix(grid_value(at + ivec3(0, 0, 1)), grid_value(at + ivec3(1, 0, 1)), t.x),
                     mix(grid_value(at + ivec3(0, 1, 1)), grid_value(at + ivec3(1, 1, 1)), t.x), t.y);
    return mix(low, high, t.z);
}
