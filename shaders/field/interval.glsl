// Rays against boxes and supports, and the candidates of a ray, the mirror of libshape/field/interval.c.
//
// A list in a shader has a fixed length, a ray's number of primitives has none. So candidates are gathered in windows:
// the CANDIDATES earliest that are still ahead; the window ends where the first one that found no room begins. Where
// more than CANDIDATES hold one point, the window is empty ("crowded"), and density is asked of the tree instead.
#ifndef CANDIDATES
#define CANDIDATES 40
#endif

vec4 candidate[CANDIDATES]; // entry, exit, growth of u^2, cloud
int candidate_count;
float window_end;
float fetches, steps, candidates_seen; // work counts

// Williams et al. 2005; a ray that runs along a slab is in or out.
bool clip_slab(float low, float high, float origin, float direction, inout float t0, inout float t1)
{
    if (direction == 0.0)
        return origin >= low && origin <= high;
    float inverse = 1.0 / direction, near = (low - origin) * inverse, far = (high - origin) * inverse;
    t0 = max(t0, min(near, far));
    t1 = min(t1, max(near, far));
    return t0 <= t1;
}

bool box_intersect(vec3 low, vec3 high, vec3 origin, vec3 direction, inout float t0, inout float t1)
{
    return clip_slab(low.x, high.x, origin.x, direction.x, t0, t1) &&
           clip_slab(low.y, high.y, origin.y, direction.y, t0, t1) &&
           clip_slab(low.z, high.z, origin.z, direction.z, t0, t1);
}

// The ball |v + t d| <= radius, from the point of closest approach.
bool ball_intersect(vec3 v, vec3 d, float radius, out vec3 hit)
{
    float a = dot(d, d), middle = -dot(v, d) / a;
    vec3 closest = v + middle * d;
    float room = radius * radius - dot(closest, closest);
    if (!(room > 0.0))
        return false;
    float halfway = sqrt(room / a);
    hit = vec3(middle - halfway, middle + halfway, a);
    return hit.x < hit.y;
}

// content as in a tree's leaf.
bool support_intersect(int content, out vec3 hit)
{
    if (content > 0) {
        vec4 s = sphere_at(content - 1);
        fetches += 1.0;
        if (!ball_intersect(cloud_origin - s.xyz, cloud_direction, s.w * cloud_support, hit))
            return false;
        hit.z /= s.w * s.w;
        return true;
    }
    vec3 v = cloud_origin, d = cloud_direction;
    ellipsoid_space(-content - 1, v, d);
    fetches += 3.0;
    return ball_intersect(v, d, cloud_support, hit);
}

// Loop iterations so far. Mesa's software rasteriser ends every loop of a pixel after 65,535 iterations in all, and
// a real GPU's driver may take a long pixel for a hang, so walks visit four nodes a turn and a long ray is drawn in parts.
int work;
const int WORK_LIMIT = 4000;

float gather_start; // supports that hold this place are alike to the order

// Keeps the list sorted by entry; what falls out, or finds no room, ends the window.
void insert_candidate(vec4 item)
{
    work++;
    if (candidate_count == CANDIDATES) {
        float last = candidate[CANDIDATES - 1].x;
        bool later = item.x >= last || last <= gather_start;
        window_end = min(window_end, max(later ? item.x : last, gather_start));
        if (later)
            return;
        candidate_count--;
    }
    int j = candidate_count;
    for (; j > 0; j--, work++) {
        float before = candidate[j - 1].x;
        if (before <= item.x || before <= gather_start)
            break;
        candidate[j] = candidate[j - 1];
    }
    candidate[j] = item;
    candidate_count++;
}

void visit_node(inout int i, float c, float t_min, float t_max)
{
    if (i >= cloud_nodes)
        return;
    vec4 low = linear_texel(nodes, 2 * (cloud_root + i)), high = linear_texel(nodes, 2 * (cloud_root + i) + 1);
    float a = t_min, b = min(t_max, window_end);
    fetches += 2.0;
    if (!box_intersect(low.xyz, high.xyz, cloud_origin, cloud_direction, a, b)) {
        i = int(low.w);
        return;
    }
    i++;
    int content = int(high.w);
    vec3 hit;
    if (content != 0 && support_intersect(content, hit) && hit.y > t_min && hit.x < t_max)
        insert_candidate(vec4(hit, c));
}

void gather_cloud(int c, vec3 direction, float t_min, float t_max)
{
    load_ray(c, direction);
    cloud_index = -1;
    float t0 = t_min, t1 = t_max;
    fetches += 5.0;
    if (!box_intersect(cloud_min, cloud_max, cloud_origin, cloud_direction, t0, t1))
        return;
    load_cloud(c, direction);
    for (int i = 0; i < cloud_nodes; work++) {
        visit_node(i, float(c), t_min, t_max);
        visit_node(i, float(c), t_min, t_max);
        visit_node(i, float(c), t_min, t_max);
        visit_node(i, float(c), t_min, t_max);
    }
}

// The clouds that a tile of the picture may see (viewer/gl/tiles.c): offset and count, then the numbers.
uniform highp sampler2D tiles;
uniform int tile_columns;
const int TILE = 32; // pixels

ivec2 tile_clouds_at(ivec2 pixel)
{
    ivec2 tile = pixel / TILE;
    return ivec2(linear_texel(tiles, tile.y * tile_columns + tile.x).xy);
}

ivec2 tile_clouds() { return tile_clouds_at(ivec2(gl_FragCoord.xy)); }

void gather(vec3 direction, float t_min, float t_max)
{
    candidate_count = 0;
    window_end = t_max;
    gather_start = t_min;
    ivec2 list = tile_clouds();
    for (int i = 0; i < list.y; i++, work++)
        gather_cloud(int(linear_texel(tiles, list.x + i).x), direction, t_min, t_max);
}

void visit_nearest(inout int i, float t_min, inout float nearest)
{
    if (i >= cloud_nodes)
        return;
    vec4 low = linear_texel(nodes, 2 * (cloud_root + i)), high = linear_texel(nodes, 2 * (cloud_root + i) + 1);
    float a = t_min, b = nearest;
    fetches += 2.0;
    if (!box_intersect(low.xyz, high.xyz, cloud_origin, cloud_direction, a, b)) {
        i = int(low.w);
        return;
    }
    i++;
    vec3 hit;
    if (int(high.w) != 0 && support_intersect(int(high.w), hit) && hit.y > t_min)
        nearest = min(nearest, max(hit.x, t_min));
}

// Where the first support at or behind t_min is entered; `none` where there is no more. With very many primitives a
// window is then taken only so far behind it that few begin there: sorting thousands for each window takes too long.
float nearest_entry(vec3 direction, float t_min, float none)
{
    float nearest = none;
    ivec2 list = tile_clouds();
    for (int k = 0; k < list.y; k++, work++) {
        cloud_index = -1;
        load_cloud(int(linear_texel(tiles, list.x + k).x), direction);
        float t0 = t_min, t1 = nearest;
        if (!box_intersect(cloud_min, cloud_max, cloud_origin, cloud_direction, t0, t1))
            continue;
        for (int i = 0; i < cloud_nodes && nearest > t_min; work++) {
            visit_nearest(i, t_min, nearest);
            visit_nearest(i, t_min, nearest);
            visit_nearest(i, t_min, nearest);
            visit_nearest(i, t_min, nearest);
        }
    }
    return nearest;
}

// min u^2 of cloud c at t over candidates first..end, 1e30 where none holds t.
float candidates_u2(int first, int end, float c, float t)
{
    float least = 1e30;
    work++;
    for (int i = first; i < end && candidate[i].x <= t; i++, work++)
        if (t <= candidate[i].y && candidate[i].w == c)
            least = min(least, cloud_support2 + candidate[i].z * (t - candidate[i].x) * (t - candidate[i].y));
    return max(least, 0.0);
}
