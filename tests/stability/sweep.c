/* Random pictures over the whole parameter space, none of which may hold a NaN, an infinity or a negative value; and the
 * methods that claim to conserve energy, held to it in the same scenes.
 *
 *     sweep COUNT [FIRST]
 *
 * renders COUNT pictures of 8x6, eight a scene, from scene number FIRST (default 0) on. A scene depends on its number
 * alone, so what fails can be looked at again: sweep 8 NUMBER. Exit 1 where anything fails. */
#include "grid_sample.h"
#include "shape/march.h"
#include "shape/opaque.h"
#include "shape/paper.h"

#include <stdio.h>

enum { W = 8, H = 6, PICTURES = 8, MARCHED = 5, RAYS = 8 };

/* What was found, over all scenes. */
typedef struct tally {
    long pictures, bad, paths, cut, rays, broken;
    double grid_low, grid_high; /* mean radiance of a scene in a white furnace, light `grid` */
    long grid_near;             /* how many are within 5 % of 1 */
} tally;

typedef struct scene {
    long number;
    shape_random random;
    shape_set *set;
    shape_grid *grid;
    shape_volume *volume;
    shape_dvec3 low, high;
    double size; /* longest side of the box around all; 1 where there is nothing */
    shape_opaque *opaque;
    shape_light light;
    shape_view view;
} scene;

static double range(scene *s, double low, double high)
{
    return shape_random_range(&s->random, low, high);
}

/* Evenly in the logarithm. */
static double spread(scene *s, double low, double high)
{
    return low * pow(high / low, shape_random_unit(&s->random));
}

static int choose(scene *s, int count)
{
    return (int)(shape_random_u32(&s->random) % (unsigned)count);
}

/* 0 to 1, the ends as often as all between. */
static double share(scene *s)
{
    int end = choose(s, 4);
    return end < 2 ? end : shape_random_unit(&s->random);
}

static double asymmetry(scene *s)
{
    static const double ends[] = {-0.9999, 0, 1e-6, 0.85, 0.9999};
    int i = choose(s, 10);
    return i < 5 ? ends[i] : range(s, -0.9999, 0.9999);
}

/* --- clouds --- */

static double voxel(const void *context, int x, int y, int z)
{
    (void)context;
    return x > 0 && y > 0 && z > 0 && x < 7 && y < 6 && z < 5 ? (x * 7 + y * 5 + z * 3) % 4 / 2.0 : 0;
}

static void draw_layer(scene *s, shape_layer *l)
{
    l->bounds = (shape_bounds)choose(s, 3);
    l->noise = (shape_noise_kind)choose(s, 4);
    l->blend = (float)share(s);
    l->gain = (float)range(s, 0, 5);
    l->worley_gain = (float)range(s, 0, 5);
    l->worley_frequency = (float)spread(s, 0.1, 10);
    l->worley_octaves = 1 + choose(s, 8);
    for (int i = 0; i < 3; i++)
        l->stretch[i] = (float)spread(s, 0.1, 10);
    l->coverage = (float)share(s);
    l->cut = (float)range(s, 0, 0.99);
    l->ramp[0] = (float)range(s, 0, 0.5);
    l->ramp[1] = choose(s, 3) ? (float)range(s, 0.5, 1) : l->ramp[0];
    l->falloff = (float)share(s);
    l->fade_bottom = (float)share(s), l->fade_top = (float)share(s), l->fade_side = (float)share(s);
}

static void draw_field(scene *s, shape_field *field, double unit)
{
    field->model = (shape_model)choose(s, 4);
    field->kappa = (float)share(s);
    field->octaves = 1 + choose(s, choose(s, 4) ? 6 : 16);
    field->noise_scale = (float)(unit * spread(s, 0.05, 10));
    field->edge = (float)range(s, 0, 20);
    field->seed = shape_random_u32(&s->random);
    if (field->model == SHAPE_MODEL_LAYER)
        draw_layer(s, &field->layer);
    if (choose(s, 3))
        return;
    shape_detail *d = &field->detail;
    d->displace = (float)(unit * range(s, 0, 0.3));
    d->displace_scale = (float)(unit * spread(s, 0.1, 2));
    if (field->model == SHAPE_MODEL_UNIFORM || field->model == SHAPE_MODEL_SPHEROID)
        d->smoothness = (float)share(s);
    if (field->model != SHAPE_MODEL_LAYER)
        d->billow = (float)share(s), d->wisp = (float)share(s);
    d->detail_depth = (float)share(s);
}

static void draw_medium(scene *s, shape_medium *medium, double length)
{
    medium->extinction = (float)(spread(s, 1e-3, 1e4) / length);
    if (choose(s, 20) == 0)
        medium->extinction = 0;
    medium->albedo = (float)share(s);
    medium->phase = (shape_phase_kind)choose(s, 5);
    medium->g = (float)asymmetry(s), medium->g2 = (float)asymmetry(s);
    medium->lobe_mix = (float)share(s);
    medium->droplet = (float)range(s, 5, 50);
}

/* Turned, scaled, now and then unevenly or mirrored, and far from the origin. */
static shape_frame draw_frame(scene *s, double unit, double *scale)
{
    shape_frame frame = shape_frame_identity();
    double r[3][3], each[3];
    *scale = 1;
    if (choose(s, 3) == 0)
        return frame;
    *scale = spread(s, 0.01, 100);
    for (int i = 0; i < 3; i++)
        each[i] = *scale * (choose(s, 4) ? 1 : spread(s, 0.1, 10)) * (choose(s, 8) ? 1 : -1);
    shape_quat_matrix(draw_rotation(&s->random), r);
    double far = choose(s, 3) ? 0 : unit * *scale * spread(s, 1, 1e5);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            frame.m[i][j] = r[i][j] * each[j];
        frame.m[i][3] = range(s, -1, 1) * unit * *scale + far;
    }
    return frame;
}

static void draw_primitives(scene *s, size_t cloud, double unit)
{
    /* Metaballs and details look at every primitive for each density: a few only, for the time's sake. */
    const shape_field *field = &s->set->clouds[cloud].field;
    bool few = field->model == SHAPE_MODEL_METABALL || shape_detail_is_on(&field->detail);
    int kind = choose(s, few ? 7 : 8);
    int count = kind == 0 ? 0 : kind == 1 ? 1 : kind == 7 ? 150 : 2 + choose(s, few ? 6 : 20);
    double least = choose(s, 8) ? 0.1 : 1e-6;
    for (int i = 0; i < count; i++) {
        shape_vec3 p = draw_point(&s->random, unit);
        double size = unit * spread(s, least, 1);
        if (choose(s, 2)) {
            add_sphere(s->set, cloud, (double)p.x, (double)p.y, (double)p.z, size);
            continue;
        }
        float a = (float)size, b = (float)(size * spread(s, 0.3, 1)), c = (float)(size * spread(s, 0.3, 1));
        if (choose(s, 6) == 0)
            c = (float)(size * 1e-4); /* a coin, or with b a needle */
        if (choose(s, 12) == 0)
            b = c;
        add_ellipsoid(s->set, cloud, p, a, b, c, draw_rotation(&s->random));
    }
}

static void draw_clouds(scene *s)
{
    double unit = choose(s, 2) ? 1 : spread(s, 1e-4, 1e6), scale;
    int count = 1 + (choose(s, 4) == 0) + (choose(s, 8) == 0);
    if (choose(s, 12) == 0) {
        s->grid = grid_of(voxel, NULL, 8, 7, 6);
        s->set = grid_set(s->grid, unit, shape_dvec3_make(range(s, -9, 9), 0, 0));
        draw_medium(s, &s->set->clouds[0].medium, unit * 8);
        return;
    }
    s->set = new_set();
    for (int i = 0; i < count; i++) {
        new_cloud(s->set, SHAPE_MODEL_UNIFORM);
        size_t k = (size_t)i;
        draw_field(s, &s->set->clouds[k].field, unit);
        draw_primitives(s, k, unit);
        s->set->clouds[k].frame = draw_frame(s, unit, &scale);
        draw_medium(s, &s->set->clouds[k].medium, unit * scale);
    }
}

/* --- light, view, things --- */

static void draw_light(scene *s)
{
    static const double heights[] = {0, -0.001, 90, -90, -10};
    int i = choose(s, 10);
    s->light = shape_light_defaults();
    s->light.sun = shape_sun_direction(range(s, 0, 360), i < 5 ? heights[i] : range(s, -90, 90));
    s->light.sky = (shape_sky_kind)choose(s, 3);
    for (int c = 0; c < 3; c++) {
        s->light.sun_irradiance[c] = choose(s, 6) ? (float)spread(s, 1e-3, 1e5) : 0;
        s->light.sky_radiance[c] = (float)spread(s, 1e-3, 1e3);
    }
}

static shape_dvec3 point_in_box(scene *s)
{
    return shape_dvec3_make(range(s, s->low.x, s->high.x), range(s, s->low.y, s->high.y),
                            range(s, s->low.z, s->high.z));
}

/* Somewhere about, inside, on a corner of the box, or at a primitive's centre. */
static void draw_view(scene *s)
{
    int kind = choose(s, 6);
    shape_vec3 way = draw_direction(&s->random);
    double far = s->size * spread(s, 0.5, 100);
    s->view = shape_view_defaults();
    s->view.width = W, s->view.height = H;
    s->view.fov = spread(s, 0.1, 170);
    s->view.target = point_in_box(s);
    s->view.eye = shape_dvec3_add(
        s->view.target, shape_dvec3_make(far * (double)way.x, far * (double)way.y, far * (double)way.z));
    const shape_primitives *list = &s->set->lists[0];
    if (kind == 0)
        s->view.eye = point_in_box(s);
    else if (kind == 1)
        s->view.eye = choose(s, 2) ? s->low : s->high;
    else if (kind == 2 && list->sphere_count)
        s->view.eye = shape_frame_point(
            &s->set->clouds[0].frame, shape_dvec3_make((double)list->spheres[0].x, (double)list->spheres[0].y,
                                                       (double)list->spheres[0].z));
    if (shape_view_check(&s->view, NULL)) /* where the two fell together */
        s->view.eye.x += s->size;
}

/* A triangle through the box. */
static void draw_opaque(scene *s)
{
    float albedo[3] = {(float)share(s), (float)share(s), (float)share(s)};
    shape_mesh *mesh = shape_mesh_create(3, 1, NULL);
    s->opaque = shape_opaque_create(NULL);
    mesh->point_count = 3, mesh->triangle_count = 1;
    for (uint32_t i = 0; i < 3; i++) {
        mesh->points[i] = point_in_box(s);
        mesh->indices[i] = i;
    }
    if (shape_opaque_add(s->opaque, mesh, NULL, albedo, NULL) || shape_opaque_finish(s->opaque, NULL))
        abort();
    shape_mesh_destroy(mesh);
}

static void open_scene(scene *s, long number)
{
    shape_error error;
    memset(s, 0, sizeof *s);
    s->number = number;
    s->random = shape_random_seed((uint64_t)number, 77);
    draw_clouds(s);
    must(shape_set_check(s->set, &error), &error);
    s->volume = new_volume(s->set);
    if (!shape_set_bounds(s->set, &s->low, &s->high))
        s->low = shape_dvec3_make(-0.5, -0.5, -0.5), s->high = shape_dvec3_make(0.5, 0.5, 0.5);
    shape_dvec3 side = shape_dvec3_sub(s->high, s->low);
    s->size = fmax(fmax(side.x, fmax(side.y, side.z)), 1e-12);
    if (choose(s, 4) == 0)
        draw_opaque(s);
}

static void close_scene(scene *s)
{
    shape_opaque_destroy(s->opaque);
    shape_volume_destroy(s->volume);
    shape_set_destroy(s->set);
}

/* --- pictures --- */

static shape_march_options draw_march(scene *s)
{
    shape_march_options o = shape_march_defaults();
    o.rule = (shape_rule)choose(s, SHAPE_RULE_EXPONENTIAL + 1);
    o.light = (shape_march_light)choose(s, SHAPE_MARCH_GRID + 1);
    o.shadow = (shape_march_shadow)choose(s, SHAPE_SHADOW_GRID + 1);
    o.stepping = (shape_march_stepping)choose(s, SHAPE_STEP_EXPONENTIAL + 1);
    o.jitter = choose(s, 40) ? (shape_march_jitter)choose(s, 2) : SHAPE_JITTER_BLUE;
    o.end = (shape_march_end)choose(s, 2);
    o.step = fmin(s->size / spread(s, 1, 50), 9e8);
    o.light_step = fmin(s->size / spread(s, 1, 30), 9e8);
    o.growth = choose(s, 2) ? range(s, 1, 2) : 1;
    o.share = spread(s, 0.02, 1);
    o.resolution = 2 + choose(s, 9);
    o.samples = 1 + choose(s, 2);
    o.powder = choose(s, 4) ? range(s, 0, 5) : 1000;
    o.shade = share(s);
    o.forward = share(s);
    if (choose(s, 4) == 0)
        o.emission[choose(s, 3)] = (float)spread(s, 1e-6, 1e9);
    o.silver = choose(s, 2) && o.light != SHAPE_MARCH_GRID && o.light != SHAPE_MARCH_OCTAVES;
    o.lock = choose(s, 6) ? 0 : fmin(spread(s, 1, 100) / s->size, 1e9);
    if (choose(s, 4) == 0)
        o.alpha_power = spread(s, 0.01, 100), o.alpha_peel = share(s);
    o.seed = shape_random_u32(&s->random);
    o.opaque = s->opaque;
    return o;
}

static void march_picture(scene *s, const shape_march_options *options, const shape_light *light,
                          float *radiance)
{
    shape_error error;
    shape_marcher *marcher;
    must(shape_marcher_create(s->volume, light, s->view.eye, options, &marcher, &error), &error);
    must(shape_march_render(marcher, &s->view, radiance, NULL, &error), &error);
    shape_marcher_destroy(marcher);
}

static void trace_picture(scene *s, const shape_tracer *tracer, float *radiance)
{
    shape_error error;
    shape_pathtrace_result result;
    shape_pathtrace_options o = shape_pathtrace_defaults();
    o.samples = 1 + choose(s, 2);
    o.max_bounces = choose(s, 3) ? choose(s, 100) : 4096;
    o.sun_angle = choose(s, 2) ? 0.53 : range(s, 0, 90);
    o.seed = shape_random_u32(&s->random);
    if (choose(s, 4) == 0) {
        o.lamp.position = point_in_box(s);
        for (int c = 0; c < 3; c++)
            o.lamp.intensity[c] = (float)(s->size * s->size * spread(s, 1e-3, 10));
    }
    o.opaque = s->opaque;
    must(shape_pathtrace_render(tracer, &s->view, &s->light, &o, radiance, NULL, &result, &error), &error);
}

/* The methods of 2018 take steps of 0.1 m whatever the scene: a cloud of 100 m and more is left to the march. */
static bool paper_picture(scene *s, bool sweep, float *radiance)
{
    shape_error error;
    shape_paper_options o = shape_paper_defaults();
    if (s->size > 100 || s->grid || shape_dvec3_length(s->view.eye) > 1e4)
        return false;
    o.sweep = sweep;
    o.lod = choose(s, 2);
    o.resolution = 2 + choose(s, 4);
    must(shape_paper_render(s->volume, &s->view, &s->light, &o, radiance, NULL, NULL, &error), &error);
    return true;
}

static void judge(const scene *s, int picture, const char *method, const float *radiance, tally *t)
{
    int bad = -1;
    for (int i = 0; i < 3 * W * H && bad < 0; i++)
        if (!(radiance[i] >= 0) || !isfinite(radiance[i]))
            bad = i;
    t->pictures++;
    t->bad += bad >= 0;
    if (bad >= 0)
        printf("scene %ld, picture %d (%s): %g at x %d, y %d\n", s->number, picture, method,
               (double)radiance[bad], bad / 3 % W, bad / 3 / W);
}

/* --- energy --- */

static shape_light white_sky(void)
{
    shape_light light = shape_light_defaults();
    light.sky = SHAPE_SKY_CONSTANT;
    for (int c = 0; c < 3; c++) {
        light.sky_radiance[c] = 1;
        light.sun_irradiance[c] = 0;
    }
    return light;
}

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
 * 4,096 droplets and was cut. */
static void reference_conserves(scene *s, const shape_tracer *tracer, tally *t)
{
    shape_light white = white_sky();
    shape_pathtrace_options o = shape_pathtrace_defaults();
    shape_camera camera = shape_view_camera(&s->view);
    for (int i = 0; i < RAYS; i++) {
        double rgb[3];
        shape_dvec3 d = shape_camera_direction(&camera, &s->view, range(s, 0, W), range(s, 0, H));
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
    float radiance[3 * W * H];
    shape_light white = white_sky(), dark = white;
    shape_march_options o = shape_march_defaults();
    const shape_medium *medium = &s->volume->clouds[0].medium;
    o.light = SHAPE_MARCH_SINGLE;
    o.step = fmin(s->size / spread(s, 1, 50), 9e8);
    o.rule = (shape_rule)choose(s, SHAPE_RULE_EXPONENTIAL + 1);
    set_albedo(s, 0);
    march_picture(s, &o, &white, radiance);
    for (int i = 0; i < 3 * W * H; i += 3)
        expect(s, "transmittance", (double)radiance[i], 0, 1 + 1e-6, t);
    if (s->volume->cloud_count > 1)
        return;
    dark.sky = SHAPE_SKY_NONE;
    o.rule = SHAPE_RULE_EXPONENTIAL;
    o.emission[0] = fminf(medium->extinction, 1e9f);
    march_picture(s, &o, &dark, radiance);
    for (int i = 0; i < 3 * W * H; i += 3)
        expect(s, "light of a source of 1", (double)radiance[i], 0, 1 + 1e-6, t);
}

/* `grid` claims nothing here: its cells are coarse. How far it is off is told. */
static void grid_in_furnace(scene *s, tally *t)
{
    float radiance[3 * W * H];
    shape_light white = white_sky();
    shape_march_options o = shape_march_defaults();
    double mean = 0;
    o.resolution = 10;
    o.step = fmin(s->size / 50, 9e8);
    march_picture(s, &o, &white, radiance);
    for (int i = 0; i < 3 * W * H; i++)
        mean += (double)radiance[i] / (3 * W * H);
    t->grid_low = fmin(t->grid_low, mean);
    t->grid_high = fmax(t->grid_high, mean);
    t->grid_near += fabs(mean - 1) <= 0.05;
}

/* --- all of it --- */

static void run_scene(long number, tally *t)
{
    scene s;
    float radiance[3 * W * H];
    shape_error error;
    shape_tracer *tracer;
    open_scene(&s, number);
    must(shape_tracer_create(s.volume, &tracer, &error), &error);
    for (int i = 0; i < PICTURES; i++) {
        draw_light(&s);
        draw_view(&s);
        shape_march_options o = draw_march(&s);
        if (i == MARCHED) {
            trace_picture(&s, tracer, radiance);
            judge(&s, i, "reference", radiance, t);
        } else if (i > MARCHED && paper_picture(&s, i > MARCHED + 1, radiance)) {
            judge(&s, i, i > MARCHED + 1 ? "paper-ndt" : "paper", radiance, t);
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
    reference_conserves(&s, tracer, t);
    grid_in_furnace(&s, t);
    march_conserves(&s, t);
    shape_tracer_destroy(tracer);
    close_scene(&s);
}

static bool read_number(const char *text, long *number)
{
    char *end;
    *number = strtol(text, &end, 10);
    return *text && !*end && *number >= 0 && *number <= 1000000000;
}

int main(int argc, char **argv)
{
    long count = 0, first = 0;
    if (argc < 2 || argc > 3 || !read_number(argv[1], &count) ||
        (argc > 2 && !read_number(argv[2], &first))) {
        fprintf(stderr, "usage: sweep COUNT [FIRST] (how many pictures; the first scene's number)\n");
        return 2;
    }
    setvbuf(stdout, NULL, _IOLBF, BUFSIZ); /* what failed stands there even if the rest is cut off */
    long scenes = (count + PICTURES - 1) / PICTURES;
    long pictures = 0, bad = 0, paths = 0, cut = 0, rays = 0, broken = 0, near = 0;
    double low = INFINITY, high = 0;
#pragma omp parallel for schedule(dynamic, 1) reduction(+ : pictures, bad, paths, cut, rays, broken, near)          \
    reduction(min : low) reduction(max : high)
    for (long i = 0; i < scenes; i++) {
        tally t = {0, 0, 0, 0, 0, 0, INFINITY, 0, 0};
        run_scene(first + i, &t);
        pictures += t.pictures, bad += t.bad, paths += t.paths, cut += t.cut, rays += t.rays,
            broken += t.broken;
        near += t.grid_near;
        low = fmin(low, t.grid_low), high = fmax(high, t.grid_high);
    }
    printf("- %ld pictures of %ld scenes: %ld with a NaN, an infinity or a negative value\n", pictures,
           scenes, bad);
    printf("- %ld checks of energy: %ld failed; %ld of %ld paths cut after 4096 collisions\n", rays, broken,
           cut, paths);
    printf("- light `grid` in a white furnace (no claim): %ld scenes of %ld within 5 %%, from %.4f to %.4f\n",
           near, scenes, low, high);
    return bad > 0 || broken > 0;
}
