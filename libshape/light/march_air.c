/* The air's light on a marched ray (shape/air.h): integral of T_clouds sigma T_air L (1 - s (1 - V)) dt. All but the
 * shadow V is in closed form between the marched points; V is looked at where equal shares of that light come from, with starts
 * of blue noise (Toth and Umenhoffer 2009: few looks a ray, begun differently in neighbouring pixels). */
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "light/march.h"

enum { SHADOW_LOOKS = 24 };

void march_air_knot(march_ray *ray, double t)
{
    shape_march_scratch *s = ray->scratch;
    if (!ray->marcher->has_air || ray->status)
        return;
    ray->status =
        shape_array_reserve((void **)&s->air, &s->air_capacity, s->air_count + 1, sizeof *s->air, ray->error);
    if (ray->status)
        return;
    s->air[s->air_count][0] = t;
    s->air[s->air_count++][1] = ray->depth;
}

/* A piece of the ray between two knots: what its ends are seen through, and the air's share of it. */
typedef struct air_piece {
    double before, after; /* share of light that passes the air up to its ends */
    double share;         /* of the air's light, the clouds before it taken into account */
} air_piece;

typedef struct air_sum {
    march_ray *ray;
    double gain, whole; /* whole: all pieces' shares */
} air_sum;

/* Piece i, from knot i - 1 to knot i; the first begins at the eye. */
static air_piece find_piece(const air_sum *sum, size_t i)
{
    double(*knots)[2] = sum->ray->scratch->air;
    double from = i ? knots[i - 1][0] : 0, depth = i ? knots[i - 1][1] : 0;
    air_piece piece = {exp(-shape_air_depth(&sum->ray->air, from)),
                       exp(-shape_air_depth(&sum->ray->air, knots[i][0])), 0};
    double seen = 1 + sum->gain * 0.5 * (expm1(-depth) + expm1(-knots[i][1]));
    piece.share = seen * (piece.before - piece.after);
    return piece;
}

/* Whether the sun is seen, 0 to 1, from where the air lets `passed` of the light through. */
static double sun_seen(march_ray *ray, double passed)
{
    shape_vec3 nowhere = {0, 0, 0};
    double t = shape_air_distance(&ray->air, -log(passed));
    if (!isfinite(t) || !ray->marcher->has_sun)
        return 1;
    march_way way = march_sun_way(ray->marcher);
    shape_dvec3 place = shape_dvec3_add(ray->origin, shape_dvec3_scale(ray->direction, t));
    return exp(-march_depth(ray, place, &way, NULL, nowhere));
}

/* The share of the air's light that lies in the shadow. */
static double find_dark(const air_sum *sum)
{
    const shape_march_scratch *s = sum->ray->scratch;
    double dark = 0, passed = 0, width = sum->whole / SHADOW_LOOKS, next = s->air_start * width;
    for (size_t i = 0; i < s->air_count; i++) {
        air_piece piece = find_piece(sum, i);
        for (; next < passed + piece.share; next += width) {
            double within = (next - passed) / piece.share;
            dark += 1 - sun_seen(sum->ray, piece.before + within * (piece.after - piece.before));
        }
        passed += piece.share;
    }
    return dark * width;
}

double march_air_add(march_ray *ray, double end, double gain, double rgb[3])
{
    march_air_knot(ray, end);
    air_sum sum = {ray, gain, 0};
    if (ray->status)
        return 1;
    for (size_t i = 0; i < ray->scratch->air_count; i++)
        sum.whole += find_piece(&sum, i).share;
    double dark = sum.whole > 0 ? find_dark(&sum) : 0;
    for (int c = 0; c < 3; c++)
        rgb[c] += ray->air.sky[c] * fmax(sum.whole - ray->air.share[c] * dark, 0);
    return exp(-shape_air_depth(&ray->air, end));
}
