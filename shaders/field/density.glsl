// Density at a point of the loaded cloud, the mirror of libshape/field/density_model.c.
const float METABALL_POLE = 1e-6;

// u^2 of one primitive; content as in a tree's leaf.
float primitive_u2(int content, vec3 p)
{
    if (content > 0) {
        vec4 s = sphere_at(content - 1);
        vec3 v = p - s.xyz;
        return dot(v, v) / (s.w * s.w);
    }
    vec3 v = p, unused = vec3(0.0);
    ellipsoid_space(-content - 1, v, unused);
    return dot(v, v);
}

void visit_point(inout int i, vec3 p, inout float least)
{
    if (i >= cloud_nodes)
        return;
    vec4 low = linear_texel(nodes, 2 * (cloud_root + i)), high = linear_texel(nodes, 2 * (cloud_root + i) + 1);
    if (any(lessThan(p, low.xyz)) || any(greaterThan(p, high.xyz))) {
        i = int(low.w);
        return;
    }
    i++;
    if (int(high.w) != 0)
        least = min(least, primitive_u2(int(high.w), p));
}

// min u^2 over the supports that hold p, by the tree; 1e30 outside all. visited counts the turns of the loop.
float cloud_u2(vec3 p, inout int visited)
{
    float least = 1e30;
    for (int i = 0; i < cloud_nodes; visited++) {
        visit_point(i, p, least);
        visit_point(i, p, least);
        visit_point(i, p, least);
        visit_point(i, p, least);
    }
    return least;
}

float metaball_sum(vec3 p)
{
    float sum = 0.0;
    for (int i = 0; i < cloud_spheres; i++) {
        vec4 s = sphere_at(i);
        vec3 v = p - s.xyz;
        sum += 1.0 / max(dot(v, v) / (s.w * s.w), METABALL_POLE);
    }
    for (int i = 0; i < cloud_ellipsoids; i++) {
        vec3 v = p, unused = vec3(0.0);
        ellipsoid_space(i, v, unused);
        sum += 1.0 / max(dot(v, v), METABALL_POLE);
    }
    return sum;
}

float spheroid_density(vec3 p, float u)
{
    float n = noise_fbm(p);
    float gamma = exp(-u / max((1.0 - cloud_kappa) + 2.0 * cloud_kappa * n, 1e-6));
    return n < gamma ? n : 0.0;
}

float metaball_density(vec3 p, float sum)
{
    if (sum < 1.0)
        return 0.0;
    float n = noise_fbm(p);
    return cloud_edge * n <= sum ? n : 0.0;
}

// FIELD_PLAIN: no cloud of the scene is a layer, a metaball, a voxel grid or has details. A shader that can do those pays
// for them at every step, whether a cloud has them or not.
#ifndef FIELD_PLAIN
#include "field/detail.glsl"
#include "field/grid.glsl"
#endif

float density_at(vec3 p, float u2)
{
    if (!(u2 <= cloud_support2))
        return 0.0;
#ifndef FIELD_PLAIN
    if (cloud_detailed)
        return detail_density(p);
    if (cloud_model == MODEL_GRID)
        return grid_density(p);
    if (cloud_model == MODEL_METABALL)
        return metaball_density(p, metaball_sum(p));
#endif
    if (cloud_model == MODEL_UNIFORM)
        return 1.0;
    return spheroid_density(p, sqrt(u2));
}
