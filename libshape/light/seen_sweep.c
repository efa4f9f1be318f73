/* Light that travels through a light grid towards one eye: short characteristics (Kunasz and Auer 1988) with rays that meet in
 * the eye. The way to a cell's middle begins where the ray crosses the next plane of middles behind it; what is there is
 * interpolated from that plane's four nearest, which are farther from the eye along every axis, and so are done before. */
#include <math.h>

#include "light/seen.h"

seen_cell seen_look(const seen_grid *s, const int at[3])
{
    const double(*m)[4] = s->cloud->frame.m;
    const shape_vec3 low = s->grid->box.min;
    seen_cell c;
    c.v = shape_vec3_make(low.x + s->edge.x * ((float)at[0] + 0.5f) - s->eye.x,
                          low.y + s->edge.y * ((float)at[1] + 0.5f) - s->eye.y,
                          low.z + s->edge.z * ((float)at[2] + 0.5f) - s->eye.z);
    double x = (double)c.v.x, y = (double)c.v.y, z = (double)c.v.z;
    c.world = shape_vec3_make((float)(m[0][0] * x + m[0][1] * y + m[0][2] * z),
                              (float)(m[1][0] * x + m[1][1] * y + m[1][2] * z),
                              (float)(m[2][0] * x + m[2][1] * y + m[2][2] * z));
    c.away = shape_vec3_length(c.world);
    c.world = shape_vec3_scale(c.world, 1 / fmaxf(c.away, 1e-20f));
    return c;
}

/* The cell behind along an axis. */
static int behind(const seen_grid *s, int axis, int at)
{
    return at < s->turn[axis] ? at - 1 : at + 1;
}

static bool outside(const seen_grid *s, int axis, int at)
{
    return at < 0 || at >= s->grid->size[axis];
}

static size_t cell_index(const seen_grid *s, const int at[3])
{
    return ((size_t)at[2] * (size_t)s->grid->size[1] + (size_t)at[1]) * (size_t)s->grid->size[0] +
           (size_t)at[0];
}

/* The i-th cell from behind, along an axis: from either end to the eye. */
static int from_behind(const seen_grid *s, int axis, int i)
{
    return i < s->turn[axis] ? i : s->grid->size[axis] - 1 - (i - s->turn[axis]);
}

/* Where the ray to a cell crosses the plane behind it: the cells there, and how much of each. */
typedef struct crossing {
    size_t cell[4];
    float weight[4];
    bool inside[4];
    float way; /* from there to the cell's middle [m of the world] */
} crossing;

/* q: how many cells the ray crosses along each axis up to the eye; d: the axis along which these are most. */
static crossing find_crossing(const seen_grid *s, const int at[3], const float q[3], int d, float away)
{
    const int b = (d + 1) % 3, c = (d + 2) % 3;
    const float share = 1 / q[d], part_b = q[b] * share, part_c = q[c] * share;
    int place[3];
    crossing x = {.way = away * share};
    place[d] = behind(s, d, at[d]);
    for (int k = 0; k < 4; k++) {
        x.weight[k] = (k & 1 ? part_b : 1 - part_b) * (k & 2 ? part_c : 1 - part_c);
        place[b] = k & 1 ? behind(s, b, at[b]) : at[b];
        place[c] = k & 2 ? behind(s, c, at[c]) : at[c];
        x.inside[k] = !outside(s, d, place[d]) && !outside(s, b, place[b]) && !outside(s, c, place[c]);
        x.cell[k] = x.inside[k] ? cell_index(s, place) : 0;
    }
    return x;
}

/* Beyond the grid there is nothing but the sky, all of which comes through. */
static void cross(const seen_grid *s, const int at[3], const float q[3], const seen_lanes *added,
                  seen_lanes *arriving)
{
    const size_t index = cell_index(s, at);
    const seen_lanes here = added[index];
    const float away = arriving[index][3];
    arriving[index] = (seen_lanes){0, 0, 0, 0};
    int d = q[0] > q[1] ? 0 : 1;
    d = q[2] > q[d] ? 2 : d;
    if (!(q[d] > 1e-4f)) /* the eye is here; no direction is meant */
        return;
    const crossing x = find_crossing(s, at, q, d, away);
    seen_lanes far = {0, 0, 0, 0}, light = {0, 0, 0, 0};
    for (int k = 0; k < 4; k++)
        if (x.inside[k]) {
            far += x.weight[k] * added[x.cell[k]];
            light += x.weight[k] * arriving[x.cell[k]];
        } else {
            light[3] += x.weight[k];
        }
    const seen_lanes mean = 0.5f * (far + here);
    float depth = mean[3] * x.way, passed = expf(-depth), through = light[3] * passed;
    light = light * passed + mean * (depth > 1e-4f ? (1 - passed) / mean[3] : x.way);
    light[3] = through;
    arriving[index] = light;
}

void seen_sweep(const seen_grid *s, const seen_lanes *added, seen_lanes *arriving)
{
    const int *n = s->grid->size;
    const shape_vec3 low = shape_vec3_sub(s->grid->box.min, s->eye), e = s->edge;
    for (int k = 0; k < n[2]; k++)
        for (int j = 0; j < n[1]; j++)
            for (int i = 0; i < n[0]; i++) {
                const int at[3] = {from_behind(s, 0, i), from_behind(s, 1, j), from_behind(s, 2, k)};
                const float q[3] = {fabsf(low.x / e.x + (float)at[0] + 0.5f),
                                    fabsf(low.y / e.y + (float)at[1] + 0.5f),
                                    fabsf(low.z / e.z + (float)at[2] + 0.5f)};
                cross(s, at, q, added, arriving);
            }
}
