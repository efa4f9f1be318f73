/* Random pictures over the whole parameter space, none of which may hold a NaN, an infinity or a negative value; and the
 * methods that claim to conserve energy, held to it in the same scenes.
 *
 *     sweep COUNT [FIRST]
 *
 * renders COUNT pictures of up to 8x6, forty a scene, from scene number FIRST (default 0) on. A scene depends on its
 * number alone, so what fails can be looked at again: sweep 40 NUMBER. Exit 1 where anything fails. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "random_scene.h"
#include "shape/denoise.h"
#include "shape/march.h"
#include "shape/paper.h"
#include "shape/phase.h"

enum { PICTURES = 40, MARCHED = 26, TRACED = 32, RAYS = 8, FLUX_RAYS = 512 };

/* What was found, over all scenes. */
typedef struct tally {
    long pictures, bad, paths, cut, rays, broken;
    double grid_low, grid_high; /* mean radiance of a scene in a white furnace, light `grid` */
    long grid_near;             /* how many are within 5 % of 1 */
    long claimed;               /* scenes where `grid` claims to conserve energy */
    double claim_low, claim_high;
    long flux;        /* of them, those that scatter alike to all sides: the flux was measured */
    double flux_seen; /* sum over them of what left a cloud over what it scattered */
} tally;

/* --- pictures --- */

static shape_march_options draw_march(scene *s)
{
    shape_march_options o = shape_march_defaults();
    o.rule = (shape_rule)scene_choose(s, SHAPE_RULE_EXPONENTIAL + 1);
    o.light = (shape_march_light)scene_choose(s, SHAPE_MARCH_GRID + 1);
    o.shadow = (shape_march_shadow)scene_choose(s, SHAPE_SHADOW_GRID + 1);
    o.stepping = (shape_march_stepping)scene_choose(s, SHAPE_STEP_EXPONENTIAL + 1);
    o.jitter = scene_choose(s, 40) ? (shape_march_jitter)scene_choose(s, 2) : SHAPE_JITTER_BLUE;
    o.end = (shape_march_end)scene_choose(s, 2);
    o.step = fmin(s->size / scene_spread(s, 1, 50), 9e8);
    o.light_step = fmin(s->size / scene_spread(s, 1, 30), 9e8);
    o.growth = scene_choose(s, 2) ? scene_range(s, 1, 2) : 1;
    o.share = scene_spread(s, 0.02, 1);
    o.resolution = 2 + scene_choose(s, 9);
    o.samples = 1 + scene_choose(s, 2);
    o.powder = scene_choose(s, 4) ? scene_range(s, 0, 5) : 1000;
    o.shade = scene_share(s);
    o.forward = scene_share(s);
    if (scene_choose(s, 4) == 0)
        o.emission[scene_choose(s, 3)] = (float)scene_spread(s, 1e-6, 1e9);
    o.silver = scene_choose(s, 2) && o.light != SHAPE_MARCH_GRID && o.light != SHAPE_MARCH_OCTAVES;
    o.lock = scene_choose(s, 6) ? 0 : fmin(scene_spread(s, 1, 100) / s->size, 1e9);
    if (scene_choose(s, 4) == 0)
        o.alpha_power = scene_spread(s, 0.01, 100), o.alpha_peel = scene_share(s);
    o.seed = shape_random_u32(&s->random);
    o.octaves = 1 + scene_choose(s, SHAPE_MARCH_OCTAVES_MAX);
    if (scene_choose(s, 4) == 0)
        o.ambient[scene_choose(s, 3)] = (float)scene_spread(s, 1e-6, 1e9);
    o.opaque = s->opaque;
    return o;
}

static void march_picture(scene *s, const shape_march_options *options, const shape_light *light,
                          float *radiance)
{
    shape_error error;
    shape_marcher *marcher;
    scene_sure(s, shape_marcher_create(s->volume, light, s->view.eye, options, &marcher, &error), &error);
    scene_sure(s, shape_march_render(marcher, &s->view, radiance, NULL, &error), &error);
    shape_marcher_destroy(marcher);
}

/* The optical depth that a cloud at its densest would have along its longest side, the largest of all clouds. */
static double most_depth(const scene *s)
{
    double deepest = 0;
    for (size_t i = 0; i < s->volume->cloud_count; i++) {
        const shape_volume_cloud *c = &s->volume->clouds[i];
        const shape_vec3 size = shape_vec3_sub(c->box.max, c->box.min);
        for (int axis = 0; axis < 3; axis++) {
            shape_dvec3 side = {c->frame.m[0][axis], c->frame.m[1][axis], c->frame.m[2][axis]};
            double length = (double)(&size.x)[axis] * shape_dvec3_length(side);
            deepest = fmax(deepest, (double)c->medium.extinction * length);
        }
    }
    return deepest;
}

/* Paths look at a density about once for each unit of that depth and collision, so that one scene of a hundred would take ten
 * minutes: above a thousand they have 30 collisions at most, and above ten thousand there are none. */
static int most_bounces(const scene *s, int wanted)
{
    return most_depth(s) > 1e3 && wanted > 30 ? 30 : wanted;
}

static bool traceable(const scene *s)
{
    return most_depth(s) <= 1e4;
}

/* smooth: the same without its grain (shape/denoise.h). */
static void trace_picture(scene *s, const shape_tracer *tracer, float *radiance, float *smooth)
{
    shape_error error;
    float variance[3 * SCENE_PIXELS];
    shape_pathtrace_result result;
    shape_pathtrace_options o = shape_pathtrace_defaults();
    o.samples = 1 + scene_choose(s, 2);
    o.max_bounces = most_bounces(s, scene_choose(s, 3) ? scene_choose(s, 100) : 4096);
    o.sun_angle = scene_choose(s, 2) ? 0.53 : scene_range(s, 0, 90);
    o.seed = shape_random_u32(&s->random);
    if (scene_choose(s, 4) == 0) {
        o.lamp.position = scene_point(s);
        for (int c = 0; c < 3; c++)
            o.lamp.intensity[c] = (float)(s->size * s->size * scene_spread(s, 1e-3, 10));
    }
    o.opaque = s->opaque;
    scene_sure(s,
               shape_pathtrace_render(tracer, &s->view, &s->light, &o, radiance, variance, &result, &error),
               &error);
    scene_sure(s, shape_denoise(radiance, variance, s->view.width, s->view.height, smooth, &error), &error);
}

/* The methods of 2018 take steps of 0.1 m whatever the scene: a cloud of 100 m and more is left to the march. */
static bool paper_picture(scene *s, bool sweep, float *radiance)
{
    shape_error error;
    shape_paper_options o = shape_paper_defaults();
    if (s->size > 100 || s->grid || shape_dvec3_length(s->view.eye) > 1e4)
        return false;
    o.sweep = sweep;
    o.lod = scene_choose(s, 2);
    o.resolution = 2 + scene_choose(s, 4);
    scene_sure(s, shape_paper_render(s->volume, &s->view, &s->light, &o, radiance, NULL, NULL, &error),
               &error);
    return true;
}

static void judge(const scene *s, int picture, const char *method, const float *radiance, tally *t)
{
    int bad = scene_find_bad(radiance, 3 * s->view.width * s->view.height);
    t->pictures++;
    t->bad += bad >= 0;
    if (bad >= 0)
        printf("scene %ld, picture %d (%s): %g at x %d, y %d\n", s->number, picture, method,
               (double)radiance[bad], bad / 3 % s->view.width, bad / 3 / s->view.width);
}

/* --- energy --- */

static void expect(const scene *s, const char *what, double value, double low, double high, tally *t)
{
    t->rays++;
    if (value >= low && value <= high)
        return;
    t->broken++;
    printf("scene %ld: %s %.9g, must be from %.9g to %.9g\n", s->number, what, value, low, high);
}

static void set_albedo(scene *s, float albedo)
{
    for (size_t i = 0; i < s->volume->cloud_count; i++)
        s->volume->clouds[i].medium.albedo = albedo;
}

/* White clouds in a white furnace, and walks through them: each path brings 1, neither more nor less, unless it met more than
 * 4,096 droplets (30 in deep clouds) and was cut. */
static void reference_conserves(scene *s, const shape_tracer *tracer, tally *t)
{
    shape_light white = scene_white_sky();
    shape_pathtrace_options o = shape_pathtrace_defaults();
    shape_camera camera = shape_view_camera(&s->view);
    o.max_bounces = most_bounces(s, o.max_bounces);
    for (int i = 0; i < RAYS; i++) {
        double rgb[3];
        shape_dvec3 d = shape_camera_direction(&camera, &s->view, scene_range(s, 0, s->view.width),
                                               scene_range(s, 0, s->view.height));
        shape_walk walk = shape_tracer_walk(tracer, s->view.eye, d, o.max_bounces, &s->random);
        shape_pathtrace_radiance(tracer, &white, &o, s->view.eye, d, &s->random, rgb);
        t->paths += 2;
        t->cut += (walk.weight == 0) + (rgb[0] == 0);
        if (walk.weight != 0)
            expect(s, "weight of a walk in white clouds", walk.weight, 1 - 1e-9, 1 + 1e-9, t);
        if (rgb[0] != 0)
            expect(s, "a path's radiance in a white furnace", rgb[0], 1 - 1e-9, 1 + 1e-9, t);
    }
}

/* Through black clouds a sky of 1 is seen by the transmittance, 0 to 1, with any rule; and what glows with a source of 1 shows
 * at most 1 with the exponential rule. */
static void march_conserves(scene *s, tally *t)
{
    float radiance[3 * SCENE_PIXELS];
    shape_light white = scene_white_sky(), dark = white;
    shape_march_options o = shape_march_defaults();
    const shape_medium *medium = &s->volume->clouds[0].medium;
    o.light = SHAPE_MARCH_SINGLE;
    o.step = fmin(s->size / scene_spread(s, 1, 50), 9e8);
    o.rule = (shape_rule)scene_choose(s, SHAPE_RULE_EXPONENTIAL + 1);
    set_albedo(s, 0);
    march_picture(s, &o, &white, radiance);
    for (int i = 0; i < 3 * s->view.width * s->view.height; i += 3)
        expect(s, "transmittance", (double)radiance[i], 0, 1 + 1e-6, t);
    if (s->volume->cloud_count > 1)
        return;
    dark.sky = SHAPE_SKY_NONE;
    o.rule = SHAPE_RULE_EXPONENTIAL;
    o.emission[0] = fminf(medium->extinction, 1e9f);
    march_picture(s, &o, &dark, radiance);
    for (int i = 0; i < 3 * s->view.width * s->view.height; i += 3)
        expect(s, "light of a source of 1", (double)radiance[i], 0, 1 + 1e-6, t);
}

/* Where the light grid claims to conserve energy (docs/stability.md): it solves one cloud at a time, by eight streams a
 * quarter of the sphere and the phase function's first moment, to a tolerance that deep clouds of nothing but white need more rounds for. */
static bool grid_claims(const scene *s)
{
    const shape_medium *medium = &s->volume->clouds[0].medium;
    double g = (double)shape_phase_mean_cosine(medium), depth = (double)medium->extinction * s->size;
    return s->volume->cloud_count == 1 && !s->opaque && g >= -0.5 && g <= 0.86 && depth <= 300;
}

/* A white furnace by light `grid`: all is 1. */
static void grid_in_furnace(scene *s, tally *t)
{
    float radiance[3 * SCENE_PIXELS];
    shape_light white = scene_white_sky();
    shape_march_options o = shape_march_defaults();
    double mean = 0;
    int count = 3 * s->view.width * s->view.height;
    o.resolution = 10;
    o.step = fmin(s->size / 50, 9e8);
    march_picture(s, &o, &white, radiance);
    for (int i = 0; i < count; i++)
        mean += (double)radiance[i] / count;
    t->grid_low = fmin(t->grid_low, mean);
    t->grid_high = fmax(t->grid_high, mean);
    t->grid_near += fabs(mean - 1) <= 0.05;
    if (!grid_claims(s))
        return;
    t->claimed++;
    t->claim_low = fmin(t->claim_low, mean);
    t->claim_high = fmax(t->claim_high, mean);
    expect(s, "light `grid` in a white furnace", mean, 0.9, 1.1, t);
}

/* A point of the disc that the ball around all shows to somebody who looks along d, and out of the ball. */
static shape_dvec3 disc_point(scene *s, shape_dvec3 d)
{
    shape_dvec3 side =
        shape_dvec3_cross(d, fabs(d.y) < 0.9 ? shape_dvec3_make(0, 1, 0) : shape_dvec3_make(1, 0, 0));
    shape_dvec3 x = shape_dvec3_normalize(side), y = shape_dvec3_cross(d, x);
    double radius = 0.5 * shape_dvec3_length(shape_dvec3_sub(s->high, s->low));
    double r = radius * sqrt(scene_range(s, 0, 1)), turn = scene_range(s, 0, 6.283185307179586);
    shape_dvec3 p = shape_dvec3_scale(shape_dvec3_add(s->low, s->high), 0.5);
    p = shape_dvec3_add(p, shape_dvec3_scale(x, r * cos(turn)));
    p = shape_dvec3_add(p, shape_dvec3_scale(y, r * sin(turn)));
    return shape_dvec3_sub(p, shape_dvec3_scale(d, radius));
}

/* The share of the sun's light that a white cloud sends on of what it scatters: by rays of light `grid` from all sides, over
 * rays along the sun's. Only where scattering is alike to all sides, since that grid is made for one eye. */
static void grid_flux(scene *s, tally *t)
{
    shape_light sun = shape_light_defaults();
    shape_march_options o = shape_march_defaults();
    shape_march_scratch scratch = {0};
    shape_candidates candidates = {0};
    shape_marcher *marcher;
    shape_error error;
    double seen = 0, caught = 0, depth, rgb[3];
    if (!grid_claims(s) || s->volume->clouds[0].medium.phase != SHAPE_PHASE_ISOTROPIC)
        return;
    sun.sky = SHAPE_SKY_NONE;
    o.resolution = 12;
    o.step = fmin(s->size / 50, 9e8);
    scene_sure(s, shape_marcher_create(s->volume, &sun, s->view.eye, &o, &marcher, &error), &error);
    for (int i = 0; i < FLUX_RAYS; i++) {
        double up = scene_range(s, -1, 1), turn = scene_range(s, 0, 6.283185307179586),
               level = sqrt(1 - up * up);
        shape_dvec3 d = {level * cos(turn), up, level * sin(turn)}, away = shape_dvec3_scale(sun.sun, -1);
        scene_sure(s, shape_march_radiance(marcher, disc_point(s, d), d, 0, &scratch, rgb, &error), &error);
        scene_sure(s,
                   shape_volume_optical_depth(s->volume, disc_point(s, away), away, 0, 1e30f, (float)o.step,
                                              &candidates, &depth, &error),
                   &error);
        seen += rgb[0], caught += 1 - exp(-depth);
    }
    t->flux += caught > 0;
    t->flux_seen += caught > 0 ? 12.566370614359172 * seen / ((double)sun.sun_irradiance[0] * caught) : 0;
    shape_candidates_free(&candidates);
    shape_march_scratch_free(&scratch);
    shape_marcher_destroy(marcher);
}

/* --- all of it --- */

static void run_scene(long number, tally *t)
{
    scene s;
    float radiance[3 * SCENE_PIXELS], smooth[3 * SCENE_PIXELS];
    shape_error error;
    shape_tracer *tracer;
    scene_open(&s, number);
    scene_sure(&s, shape_tracer_create(s.volume, &tracer, &error), &error);
    for (int i = 0; i < PICTURES; i++) {
        scene_draw_light(&s);
        scene_draw_view(&s);
        shape_march_options o = draw_march(&s);
        if (i >= MARCHED && i < TRACED && traceable(&s)) {
            trace_picture(&s, tracer, radiance, smooth);
            judge(&s, i, "reference", radiance, t);
            judge(&s, i, "the same denoised", smooth, t);
            t->pictures--; /* it is no other picture */
        } else if (i >= TRACED && paper_picture(&s, i % 2, radiance)) {
            judge(&s, i, i % 2 ? "paper-ndt" : "paper", radiance, t);
        } else {
            char method[128];
            snprintf(
                method, sizeof method,
                "march: rule %d, light %d, shadow %d, stepping %d, end %d, silver %d, lock %g, alpha %g %g",
                o.rule, o.light, o.shadow, o.stepping, o.end, o.silver, o.lock, o.alpha_power, o.alpha_peel);
            march_picture(&s, &o, &s.light, radiance);
            judge(&s, i, method, radiance, t);
        }
    }
    set_albedo(&s, 1);
    if (traceable(&s))
        reference_conserves(&s, tracer, t);
    grid_in_furnace(&s, t);
    grid_flux(&s, t);
    march_conserves(&s, t);
    shape_tracer_destroy(tracer);
    scene_close(&s);
}

static void add(tally *all, const tally *t)
{
    all->pictures += t->pictures, all->bad += t->bad, all->paths += t->paths, all->cut += t->cut;
    all->rays += t->rays, all->broken += t->broken, all->grid_near += t->grid_near;
    all->claimed += t->claimed, all->flux += t->flux, all->flux_seen += t->flux_seen;
    all->grid_low = fmin(all->grid_low, t->grid_low), all->grid_high = fmax(all->grid_high, t->grid_high);
    all->claim_low = fmin(all->claim_low, t->claim_low),
    all->claim_high = fmax(all->claim_high, t->claim_high);
}

static void print(FILE *to, const tally *t, long scenes)
{
    fprintf(to, "- %ld pictures of %ld scenes: %ld with a NaN, an infinity or a negative value\n",
            t->pictures, scenes, t->bad);
    fprintf(to,
            "- %ld checks of energy: %ld failed; %ld of %ld paths cut after 4096 collisions, or 30 "
            "where an optical depth is above a thousand\n",
            t->rays, t->broken, t->cut, t->paths);
    fprintf(to,
            "- light `grid` in a white furnace: from %.4f to %.4f in the %ld scenes where it claims 1 within "
            "10 %%;\n"
            "  %ld of all %ld within 5 %%, from %.4f to %.4f\n",
            t->claim_low, t->claim_high, t->claimed, t->grid_near, scenes, t->grid_low, t->grid_high);
    if (t->flux)
        fprintf(to, "- light `grid`, flux: %.3f of what was scattered, mean of %ld of those scenes\n",
                t->flux_seen / (double)t->flux, t->flux);
}

static const tally nothing = {.grid_low = INFINITY, .claim_low = INFINITY};

int main(int argc, char **argv)
{
    long count, first;
    if (!scene_numbers("sweep", argc, argv, &count, &first))
        return 2;
    setvbuf(stdout, NULL, _IOLBF, BUFSIZ); /* what failed stands there even if the rest is cut off */
    tally all = nothing;
    long done = 0;
    long scenes = (count + PICTURES - 1) / PICTURES;
#pragma omp parallel for schedule(dynamic, 1)
    for (long i = 0; i < scenes; i++) {
        tally t = nothing;
        run_scene(first + i, &t);
#pragma omp critical
        {
            add(&all, &t);
            if (++done % 500 == 0 && done < scenes) {
                fprintf(stderr, "%ld of %ld scenes:\n", done, scenes);
                print(stderr, &all, done);
            }
        }
    }
    print(stdout, &all, scenes);
    return all.bad > 0 || all.broken > 0;
}
