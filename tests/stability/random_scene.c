#include "random_scene.h"

#include <stdio.h>

#include "grid_sample.h"

double scene_range(scene *s, double low, double high)
{
    return shape_random_range(&s->random, low, high);
}

/* Evenly in the logarithm. */
double scene_spread(scene *s, double low, double high)
{
    return low * pow(high / low, shape_random_unit(&s->random));
}

int scene_choose(scene *s, int count)
{
    return (int)(shape_random_u32(&s->random) % (unsigned)count);
}

/* 0 to 1, the ends as often as all between. */
double scene_share(scene *s)
{
    int end = scene_choose(s, 4);
    return end < 2 ? end : shape_random_unit(&s->random);
}

static double asymmetry(scene *s)
{
    static const double ends[] = {-0.9999, 0, 1e-6, 0.85, 0.9999};
    int i = scene_choose(s, 10);
    return i < 5 ? ends[i] : scene_range(s, -0.9999, 0.9999);
}

/* --- clouds --- */

static double voxel(const void *context, int x, int y, int z)
{
    (void)context;
    return x > 0 && y > 0 && z > 0 && x < 7 && y < 6 && z < 5 ? (x * 7 + y * 5 + z * 3) % 4 / 2.0 : 0;
}

static void draw_layer(scene *s, shape_layer *l, double unit)
{
    l->bounds = (shape_bounds)scene_choose(s, 3);
    l->noise = (shape_noise_kind)scene_choose(s, 4);
    l->blend = (float)scene_share(s);
    l->gain = (float)scene_range(s, 0, 5);
    l->worley_gain = (float)scene_range(s, 0, 5);
    l->worley_frequency = (float)scene_spread(s, 0.1, 10);
    l->worley_octaves = 1 + scene_choose(s, 8);
    for (int i = 0; i < 3; i++)
        l->stretch[i] = (float)scene_spread(s, 0.1, 10);
    l->coverage = (float)scene_share(s);
    l->cut = (float)scene_range(s, 0, 0.99);
    l->ramp[0] = (float)scene_range(s, 0, 0.5);
    l->ramp[1] = scene_choose(s, 3) ? (float)scene_range(s, 0.5, 1) : l->ramp[0];
    l->falloff = (float)scene_share(s);
    if (l->bounds == SHAPE_BOUNDS_ALTITUDES && scene_choose(s, 2))
        l->planet_radius = (float)fmin(unit * scene_spread(s, 1, 1e6), 1e9);
    l->fade_bottom = (float)scene_share(s), l->fade_top = (float)scene_share(s),
    l->fade_side = (float)scene_share(s);
}

static void draw_field(scene *s, shape_field *field, double unit)
{
    field->model = (shape_model)scene_choose(s, 4);
    field->kappa = (float)scene_share(s);
    field->octaves = 1 + scene_choose(s, scene_choose(s, 4) ? 6 : 16);
    field->noise_scale = (float)(unit * scene_spread(s, 0.05, 10));
    field->edge = (float)scene_range(s, 0, 20);
    field->seed = shape_random_u32(&s->random);
    if (field->model == SHAPE_MODEL_LAYER)
        draw_layer(s, &field->layer, unit);
    if (scene_choose(s, 3))
        return;
    shape_detail *d = &field->detail;
    d->displace = (float)(unit * scene_range(s, 0, 0.3));
    d->displace_scale = (float)(unit * scene_spread(s, 0.1, 2));
    if (field->model == SHAPE_MODEL_UNIFORM || field->model == SHAPE_MODEL_SPHEROID)
        d->smoothness = (float)scene_share(s);
    if (field->model != SHAPE_MODEL_LAYER)
        d->billow = (float)scene_share(s), d->wisp = (float)scene_share(s);
    d->detail_depth = (float)scene_share(s);
    d->detail_scale = scene_choose(s, 2) ? 0 : (float)(unit * scene_spread(s, 0.05, 2));
}

static void draw_medium(scene *s, shape_medium *medium, double length)
{
    medium->extinction = (float)fmin(scene_spread(s, 1e-3, 1e4) / length, 1e9);
    if (scene_choose(s, 20) == 0)
        medium->extinction = 0;
    medium->albedo = (float)scene_share(s);
    medium->phase = (shape_phase_kind)scene_choose(s, 5);
    medium->g = (float)asymmetry(s), medium->g2 = (float)asymmetry(s);
    medium->lobe_mix = (float)scene_share(s);
    medium->droplet = (float)scene_range(s, 5, 50);
}

/* Turned, scaled, now and then unevenly or mirrored, and far from the origin. */
static shape_frame draw_frame(scene *s, double unit, double *scale)
{
    shape_frame frame = shape_frame_identity();
    double r[3][3], each[3];
    *scale = 1;
    if (scene_choose(s, 3) == 0)
        return frame;
    *scale = scene_spread(s, 0.01, 100);
    for (int i = 0; i < 3; i++)
        each[i] =
            *scale * (scene_choose(s, 4) ? 1 : scene_spread(s, 0.1, 10)) * (scene_choose(s, 8) ? 1 : -1);
    shape_quat_matrix(draw_rotation(&s->random), r);
    double far = scene_choose(s, 3) ? 0 : unit * *scale * scene_spread(s, 1, 1e5);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            frame.m[i][j] = r[i][j] * each[j];
        frame.m[i][3] = scene_range(s, -1, 1) * unit * *scale + far;
    }
    return frame;
}

static void draw_primitives(scene *s, size_t cloud, double unit)
{
    /* Metaballs and details look at every primitive for each density: a few only, for the time's sake. */
    const shape_field *field = &s->set->clouds[cloud].field;
    bool few = field->model == SHAPE_MODEL_METABALL || shape_detail_is_on(&field->detail);
    int kind = scene_choose(s, few ? 7 : 8);
    int count = kind == 0 ? 0 : kind == 1 ? 1 : kind == 7 ? 150 : 2 + scene_choose(s, few ? 6 : 20);
    double least = scene_choose(s, 8) ? 0.1 : 1e-6;
    for (int i = 0; i < count; i++) {
        shape_vec3 p = draw_point(&s->random, unit);
        double size = unit * scene_spread(s, least, 1);
        if (scene_choose(s, 2)) {
            add_sphere(s->set, cloud, (double)p.x, (double)p.y, (double)p.z, size);
            continue;
        }
        float a = (float)size, b = (float)(size * scene_spread(s, 0.3, 1)),
              c = (float)(size * scene_spread(s, 0.3, 1));
        if (scene_choose(s, 6) == 0)
            c = (float)(size * 1e-4); /* a coin, or with b a needle */
        if (scene_choose(s, 12) == 0)
            b = c;
        add_ellipsoid(s->set, cloud, p, a, b, c, draw_rotation(&s->random));
    }
}

/* The first cloud once more, elsewhere. */
static void draw_copy(scene *s, double unit)
{
    shape_error error;
    double scale;
    shape_frame frame = draw_frame(s, unit, &scale);
    scene_sure(s, shape_set_add_copy(s->set, 0, &frame, NULL, &error), &error);
}

static void draw_clouds(scene *s)
{
    double unit = scene_choose(s, 2) ? 1 : scene_spread(s, 1e-4, 1e6), scale;
    int count = 1 + (scene_choose(s, 4) == 0) + (scene_choose(s, 8) == 0);
    if (scene_choose(s, 12) == 0) {
        s->grid = grid_of(voxel, NULL, 8, 7, 6);
        s->set = grid_set(s->grid, unit, shape_dvec3_make(scene_range(s, -9, 9), 0, 0));
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
    if (scene_choose(s, 6) == 0)
        draw_copy(s, unit);
}

/* --- light, view, things --- */

void scene_draw_light(scene *s)
{
    static const double heights[] = {0, -0.001, 90, -90, -10};
    int i = scene_choose(s, 10);
    s->light = shape_light_defaults();
    s->light.sun = shape_sun_direction(scene_range(s, 0, 360), i < 5 ? heights[i] : scene_range(s, -90, 90));
    s->light.sky = (shape_sky_kind)scene_choose(s, 3);
    for (int c = 0; c < 3; c++) {
        s->light.sun_irradiance[c] = scene_choose(s, 6) ? (float)scene_spread(s, 1e-3, 1e5) : 0;
        s->light.sky_radiance[c] = (float)scene_spread(s, 1e-3, 1e3);
    }
}

shape_dvec3 scene_point(scene *s)
{
    return shape_dvec3_make(scene_range(s, s->low.x, s->high.x), scene_range(s, s->low.y, s->high.y),
                            scene_range(s, s->low.z, s->high.z));
}

/* Somewhere about, inside, on a corner of the box, or at a primitive's centre. */
void scene_draw_view(scene *s)
{
    int kind = scene_choose(s, 6);
    shape_vec3 way = draw_direction(&s->random);
    double far = s->size * scene_spread(s, 0.5, 100);
    s->view = shape_view_defaults();
    s->view.width = 1 + scene_choose(s, SCENE_WIDTH), s->view.height = 1 + scene_choose(s, SCENE_HEIGHT);
    s->view.fov = scene_spread(s, 0.1, 170);
    s->view.target = scene_point(s);
    s->view.eye = shape_dvec3_add(
        s->view.target, shape_dvec3_make(far * (double)way.x, far * (double)way.y, far * (double)way.z));
    const shape_primitives *list = &s->set->lists[0];
    if (kind == 0)
        s->view.eye = scene_point(s);
    else if (kind == 1)
        s->view.eye = scene_choose(s, 2) ? s->low : s->high;
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
    float albedo[3] = {(float)scene_share(s), (float)scene_share(s), (float)scene_share(s)};
    shape_mesh *mesh = shape_mesh_create(3, 1, NULL);
    s->opaque = shape_opaque_create(NULL);
    mesh->point_count = 3, mesh->triangle_count = 1;
    for (uint32_t i = 0; i < 3; i++) {
        mesh->points[i] = scene_point(s);
        mesh->indices[i] = i;
    }
    if (shape_opaque_add(s->opaque, mesh, NULL, albedo, NULL) || shape_opaque_finish(s->opaque, NULL))
        abort();
    shape_mesh_destroy(mesh);
}

void scene_open(scene *s, long number)
{
    shape_error error;
    memset(s, 0, sizeof *s);
    s->number = number;
    s->random = shape_random_seed((uint64_t)number, 77);
    draw_clouds(s);
    scene_sure(s, shape_set_check(s->set, &error), &error);
    s->volume = new_volume(s->set);
    if (!shape_set_bounds(s->set, &s->low, &s->high))
        s->low = shape_dvec3_make(-0.5, -0.5, -0.5), s->high = shape_dvec3_make(0.5, 0.5, 0.5);
    shape_dvec3 side = shape_dvec3_sub(s->high, s->low);
    s->size = fmax(fmax(side.x, fmax(side.y, side.z)), 1e-12);
    if (scene_choose(s, 4) == 0)
        draw_opaque(s);
}

void scene_close(scene *s)
{
    shape_opaque_destroy(s->opaque);
    shape_volume_destroy(s->volume);
    shape_set_destroy(s->set);
}

/* --- for the programs --- */

void scene_sure(const scene *s, shape_status status, const shape_error *error)
{
    if (!status)
        return;
    fprintf(stderr, "scene %ld: %s\n", s->number, error->text);
    exit(1);
}

int scene_find_bad(const float *radiance, int count)
{
    for (int i = 0; i < count; i++)
        if (!(radiance[i] >= 0) || !isfinite(radiance[i]))
            return i;
    return -1;
}

shape_light scene_white_sky(void)
{
    shape_light light = shape_light_defaults();
    light.sky = SHAPE_SKY_CONSTANT;
    for (int c = 0; c < 3; c++) {
        light.sky_radiance[c] = 1;
        light.sun_irradiance[c] = 0;
    }
    return light;
}

static bool read_number(const char *text, long *number)
{
    char *end;
    *number = strtol(text, &end, 10);
    return *text && !*end && *number >= 0 && *number <= 1000000000;
}

bool scene_numbers(const char *program, int argc, char **argv, long *count, long *first)
{
    *first = 0;
    if (argc > 1 && argc <= 3 && read_number(argv[1], count) && (argc == 2 || read_number(argv[2], first)))
        return true;
    fprintf(stderr, "usage: %s COUNT [FIRST] (how many pictures; the first scene's number)\n", program);
    return false;
}
