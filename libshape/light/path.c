/* One light path: free paths in the clouds, collisions and matt surfaces, and at each a look at the sun and the lamp
 * (next-event estimation; Kajiya 1986 for volumes). Phase function and extinction are grey, so all channels share a path,
 * which carries one number, and the tint of what it met: surfaces, and clouds whose albedo has a colour. */
#include "light/path.h"

#include <math.h>
#include <string.h>

#include "shape/phase.h"

static const double pi = 3.14159265358979323846;

path_scene path_scene_make(const majorant_grid *grid, const shape_light *light,
                           const shape_pathtrace_options *options)
{
    path_scene s;
    memset(&s, 0, sizeof s);
    s.grid = grid;
    s.sky = shape_sky_make(light);
    shape_dvec3 sun = shape_dvec3_normalize(light->sun);
    s.sun[0] = sun.x, s.sun[1] = sun.y, s.sun[2] = sun.z;
    s.sun_cos = cos(options->sun_angle * (pi / 360));
    shape_dvec3 lamp = shape_dvec3_sub(options->lamp.position, grid->origin);
    s.lamp[0] = lamp.x, s.lamp[1] = lamp.y, s.lamp[2] = lamp.z;
    for (int c = 0; c < 3; c++) {
        s.irradiance[c] = (double)light->sun_irradiance[c];
        s.intensity[c] = (double)options->lamp.intensity[c];
        s.has_sun = s.has_sun || s.irradiance[c] > 0;
    }
    s.has_lamp = shape_lamp_shines(&options->lamp);
    s.max_bounces = options->max_bounces;
    s.opaque = options->opaque;
    s.has_air = shape_air_is(&light->air);
    s.light = *light;
    if (s.has_air)
        shape_air_mean(&s.sky, s.sky_mean);
    return s;
}

/* The basis is that of Duff et al. 2017. */
void path_turn(double d[3], double c, shape_random *random)
{
    double sign = copysign(1, d[2]), a = -1 / (sign + d[2]), b = d[0] * d[1] * a;
    double x[3] = {1 + sign * d[0] * d[0] * a, sign * b, -sign * d[0]};
    double y[3] = {b, sign + d[1] * d[1] * a, -d[1]};
    double s = sqrt(track_max(1 - c * c, 0));
    float angle = (float)(2 * pi * track_unit(random));
    double u = s * (double)cosf(angle), v = s * (double)sinf(angle), sum = 0;
    for (int i = 0; i < 3; i++) {
        d[i] = u * x[i] + v * y[i] + c * d[i];
        sum += d[i] * d[i];
    }
    for (int i = 0; i < 3; i++)
        d[i] /= sqrt(sum);
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Whether to look for light of this phase value at all: values below that of even scattering, most of the sphere with
 * forward scattering, get a shadow ray by chance in proportion, and are then as much heavier. Their noise stays below that
 * of the lobe's, also where the lobe is wide (a limit far above it, such as 0.3, made half of the noise at g 0.3). */
static bool worth_a_look(double *value, shape_random *random)
{
    const double enough = 1 / (4 * pi);
    if (*value >= enough)
        return true;
    if (track_unit(random) * enough >= *value)
        return false;
    *value = enough;
    return true;
}

/* A path on its way: the place (metres from the grid's origin) and the direction of travel. */
typedef struct light_path {
    double p[3], d[3], weight, tint[3]; /* tint: 1 at the most */
    shape_random *random;
    double *rgb; /* what it has gathered */
} light_path;

/* Where light is scattered: in a medium, or on a surface with that normal. */
typedef struct scatterer {
    const shape_medium *medium; /* NULL: the surface */
    double normal[3];
} scatterer;

/* Radiance that leaves along the path, backwards, for irradiance 1 on a plane that faces the light at `way`. */
static double scattered(const light_path *path, const scatterer *at, const double way[3])
{
    if (at->medium)
        return path->weight * (double)shape_phase(at->medium, (float)dot(path->d, way));
    return path->weight * track_max(dot(at->normal, way), 0) / pi;
}

static shape_dvec3 to_world(const path_scene *s, const double p[3])
{
    return shape_dvec3_add(s->grid->origin, shape_dvec3_make(p[0], p[1], p[2]));
}

/* By a thing, or by chance by a cloud. */
static bool is_shadowed(const path_scene *s, const light_path *path, const double way[3], double length)
{
    if (s->opaque && shape_opaque_blocks(s->opaque, to_world(s, path->p),
                                         shape_dvec3_make(way[0], way[1], way[2]), length))
        return true;
    return track_blocked(s->grid, path->p, way, length, path->random);
}

static void gain(light_path *path, double value, const double source[3])
{
    for (int c = 0; c < 3; c++)
        path->rgb[c] += value * path->tint[c] * source[c];
}

static void add_sun(const path_scene *s, light_path *path, const scatterer *at)
{
    double way[3] = {s->sun[0], s->sun[1], s->sun[2]};
    if (s->sun_cos < 1)
        path_turn(way, 1 - track_unit(path->random) * (1 - s->sun_cos), path->random);
    double value = scattered(path, at, way);
    if (!(value > 0) || (at->medium && !worth_a_look(&value, path->random)) ||
        is_shadowed(s, path, way, INFINITY))
        return;
    gain(path, value, s->irradiance);
}

static void add_lamp(const path_scene *s, light_path *path, const scatterer *at)
{
    double way[3] = {s->lamp[0] - path->p[0], s->lamp[1] - path->p[1], s->lamp[2] - path->p[2]};
    double square = dot(way, way), distance = sqrt(square);
    if (!(distance > 0))
        return;
    for (int i = 0; i < 3; i++)
        way[i] /= distance;
    double value = scattered(path, at, way) / square;
    if (value > 0 && !is_shadowed(s, path, way, distance))
        gain(path, value, s->intensity);
}

/* Goes on with a light path by chance only; false ends it. */
static bool survives(double *weight, shape_random *random)
{
    const double least = 0.1;
    if (*weight >= least)
        return true;
    if (track_unit(random) * least >= *weight)
        return false;
    *weight = least;
    return true;
}

/* A colour goes into weight and tint. False where nothing is left. */
static bool stain(light_path *path, const float rgb[3])
{
    double most = 0;
    for (int c = 0; c < 3; c++) {
        path->tint[c] *= (double)rgb[c];
        most = track_max(most, path->tint[c]);
    }
    if (!(most > 0))
        return false;
    for (int c = 0; c < 3; c++)
        path->tint[c] /= most;
    path->weight *= most;
    return true;
}

/* Onto a surface. False where it is black. */
static bool land(const path_scene *s, light_path *path, const shape_opaque_hit *hit, scatterer *at)
{
    shape_dvec3 p = shape_dvec3_sub(hit->point, s->grid->origin);
    path->p[0] = p.x, path->p[1] = p.y, path->p[2] = p.z;
    at->medium = NULL;
    at->normal[0] = hit->normal.x, at->normal[1] = hit->normal.y, at->normal[2] = hit->normal.z;
    return stain(path, hit->albedo);
}

/* A collision where the path stands. False where the cloud is black. */
static bool collide(light_path *path, const majorant_cloud *cloud, scatterer *at)
{
    float rgb[3], p[3];
    at->medium = &cloud->cloud->medium;
    if (!shape_cloud_is_coloured(cloud->cloud)) {
        path->weight *= (double)at->medium->albedo;
        return path->weight > 0;
    }
    for (int a = 0; a < 3; a++) {
        const double *row = cloud->to_local[a];
        p[a] = (float)(row[0] * path->p[0] + row[1] * path->p[1] + row[2] * path->p[2] + row[3]);
    }
    shape_cloud_albedo(cloud->cloud, shape_vec3_make(p[0], p[1], p[2]), rgb);
    return stain(path, rgb);
}

/* A new direction: by the phase function, or by the cosine to the normal. */
static void scatter(light_path *path, const scatterer *at)
{
    double u = (double)((float)shape_random_u32(path->random) * 0x1p-32f);
    if (at->medium) {
        path_turn(path->d, (double)shape_phase_sample(at->medium, (float)u), path->random);
        return;
    }
    memcpy(path->d, at->normal, sizeof path->d);
    path_turn(path->d, sqrt(u), path->random);
}

static void add_sky(const path_scene *s, light_path *path)
{
    float sky[3];
    shape_sky_radiance(&s->sky, shape_vec3_make((float)path->d[0], (float)path->d[1], (float)path->d[2]),
                       sky);
    for (int c = 0; c < 3; c++)
        path->rgb[c] += path->weight * path->tint[c] * (double)sky[c];
}

/* The air before a first event at `length` [m], infinite for the sky, on a path that began at p. Its light is the sky's,
 * in closed form; only what it lacks in the shadow is left to chance, at one place drawn by its share in that light. */
static void add_air(const path_scene *s, light_path *path, const double p[3], double length)
{
    shape_dvec3 origin = to_world(s, p), d = {path->d[0], path->d[1], path->d[2]};
    shape_air_ray air = shape_air_along(&s->light, &s->sky, s->sky_mean, origin, d);
    double passed = exp(-shape_air_depth(&air, length)), way[3] = {s->sun[0], s->sun[1], s->sun[2]};
    double lit = isinf(length) ? 0 : 1 - passed,
           dark = 0; /* what comes from the sky has the air in it already */
    light_path here = *path;
    double t = shape_air_distance(&air, -log1p(-track_unit(path->random) * (1 - passed)));
    for (int i = 0; i < 3; i++)
        here.p[i] = p[i] + t * path->d[i];
    if (s->sun_cos < 1)
        path_turn(way, 1 - track_unit(path->random) * (1 - s->sun_cos), path->random);
    if (s->has_sun && passed < 1 && isfinite(t) && is_shadowed(s, &here, way, INFINITY))
        dark = 1 - passed;
    for (int c = 0; c < 3; c++)
        path->rgb[c] += air.sky[c] * (lit - dark * air.share[c]);
    if (isfinite(length))
        path->weight *= passed;
}

/* To the next collision or surface, *length metres ahead; false where there is none, and the path ends in the sky or in
 * black. */
static bool advance(const path_scene *s, light_path *path, double depth, bool last, scatterer *at,
                    double *length)
{
    shape_opaque_hit hit = {.t = INFINITY};
    uint32_t cloud = 0;
    bool met =
        s->opaque && shape_opaque_find(s->opaque, to_world(s, path->p),
                                       shape_dvec3_make(path->d[0], path->d[1], path->d[2]), INFINITY, &hit);
    double from[3] = {path->p[0], path->p[1], path->p[2]};
    *length = hit.t;
    if (track_collide(s->grid, path->p, path->d, hit.t, depth, path->random, &cloud)) {
        double way[3] = {path->p[0] - from[0], path->p[1] - from[1], path->p[2] - from[2]};
        *length = dot(way, path->d);
        return !last && collide(path, &s->grid->clouds[cloud], at);
    }
    if (!met) {
        add_sky(s, path);
        return false;
    }
    return !last && land(s, path, &hit, at);
}

void path_gather(const path_scene *s, const double p[3], const double d[3], double first,
                 shape_random *random, double rgb[3])
{
    light_path way = {{p[0], p[1], p[2]}, {d[0], d[1], d[2]}, 1, {1, 1, 1}, random, rgb};
    scatterer at = {NULL, {0, 0, 0}};
    double depth = -log(first), length;
    for (int bounce = 0;; bounce++) {
        bool goes_on = advance(s, &way, depth, bounce == s->max_bounces, &at, &length);
        if (bounce == 0 && s->has_air)
            add_air(s, &way, p, length);
        if (!goes_on)
            return;
        if (s->has_sun)
            add_sun(s, &way, &at);
        if (s->has_lamp)
            add_lamp(s, &way, &at);
        if (!survives(&way.weight, random))
            return;
        scatter(&way, &at);
        depth = (double)-logf((float)track_unit(random));
    }
}
