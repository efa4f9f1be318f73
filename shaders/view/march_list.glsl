// LISTED: one cloud alone, whose supports are listed for the tiles of the picture, nearest first (viewer/gl/tile_primitives.c).
// A ray reads its tile's list once, window by window, just ahead of its steps. What a window has left behind makes room.
uniform highp sampler2D tile_primitives;
uniform int list_columns;
uniform float list_scale; // least metres of the world a metre of the cloud's frame
const int LIST_TILE = 8;  // pixels
const int READ_AHEAD = 24; // supports; most rays end long before their list does
const int LIST_WORK_LIMIT = 30000; // see WORK_LIMIT; turns are short here

int list_next, list_end; // what is not read yet
vec4 list_ahead;         // of it the first: centre, from the eye; radius of the support, of an ellipsoid negative
float list_nearest;      // no ray of the tile meets what is not read before this

void look_ahead()
{
    list_ahead = linear_texel(tile_primitives, list_next);
    fetches += 1.0;
    list_nearest = list_next < list_end ? (0.9999 * length(list_ahead.xyz) - abs(list_ahead.w)) * list_scale : 1e30;
}

void open_list()
{
    ivec2 tile = ivec2(gl_FragCoord.xy) / LIST_TILE;
    ivec2 list = ivec2(linear_texel(tile_primitives, tile.y * list_columns + tile.x).xy);
    candidate_count = 0;
    list_next = list.x;
    list_end = list.x + list.y;
    look_ahead();
}

// An ellipsoid's support, by the rows that take it to the unit ball; the texel behind its own says where they are.
bool meet_ellipsoid(out vec3 hit)
{
    int row = int(linear_texel(tile_primitives, list_next + 1).x);
    vec4 x = linear_texel(tile_primitives, row), y = linear_texel(tile_primitives, row + 1);
    vec4 z = linear_texel(tile_primitives, row + 2);
    vec3 d = cloud_direction;
    fetches += 4.0;
    return ball_intersect(vec3(x.w, y.w, z.w), vec3(dot(x.xyz, d), dot(y.xyz, d), dot(z.xyz, d)), cloud_support, hit);
}

// Keeps the candidates sorted by entry; those that hold t are alike to the order.
void insert_support(vec3 hit, float t)
{
    int j = candidate_count;
    for (; j > 0; j--, work++) {
        float before = candidate[j - 1].x;
        if (before <= hit.x || before <= t)
            break;
        candidate[j] = candidate[j - 1];
    }
    candidate[j] = vec4(hit, 0.0);
    candidate_count++;
}

// Takes the next support of the list, if the ray meets it behind t.
void read_support(float t)
{
    work++;
    vec3 hit;
#ifdef SPHERES_ONLY
    bool met = ball_intersect(-list_ahead.xyz, cloud_direction, list_ahead.w, hit);
    hit.z *= cloud_support2 / (list_ahead.w * list_ahead.w);
    list_next++;
#else
    bool ball = list_ahead.w > 0.0, met = ball_intersect(-list_ahead.xyz, cloud_direction, abs(list_ahead.w), hit);
    hit.z *= cloud_support2 / (list_ahead.w * list_ahead.w);
    if (met && !ball)
        met = meet_ellipsoid(hit);
    list_next += ball ? 1 : 2;
#endif
    if (met && hit.y > t)
        insert_support(hit, t);
    look_ahead();
}

// The next window's candidates: those that t has not left behind, and more of the list. Where more than CANDIDATES hold t,
// the window is empty.
void read_window(float t, float t_max)
{
    int kept = 0;
    for (int i = 0; i < candidate_count; i++, work++)
        if (candidate[i].y > t)
            candidate[kept++] = candidate[i];
    candidate_count = kept;
    while (list_nearest < t_max && candidate_count < CANDIDATES && (candidate_count < kept + READ_AHEAD || list_nearest <= t))
        read_support(t);
    window_end = min(list_nearest, t_max);
}

// From `reached` to t1. What this leaves, where too many supports hold one place or after too much work, goes on by the
// tree in the next part.
void march_list(float t1)
{
    load_cloud(0, ray);
    open_list();
    work_end = LIST_WORK_LIMIT;
    for (bool crowded = false; !crowded && reached < t1 && going_on(); work++) {
        read_window(reached, t1);
        crowded = window_end <= reached;
        if (!crowded)
            march_window();
    }
}
