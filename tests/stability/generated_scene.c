#include "generated_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "shape/gaussian.h"
#include "shape/layer.h"
#include "shape/metaball.h"

static void sure(shape_status status, const shape_error *error)
{
    if (!status)
        return;
    fprintf(stderr, "generated scene: %s\n", error->text);
    exit(1);
}

static double range(generated_scene *s, double low, double high)
{
    return shape_random_range(&s->random, low, high);
}

static double spread(generated_scene *s, double low, double high)
{
    return low * pow(high / low, shape_random_unit(&s->random));
}

static int choose(generated_scene *s, int count)
{
    return (int)(shape_random_u32(&s->random) % (unsigned)count);
}

static void add_ellipsoids(generated_scene *s, shape_primitives *list)
{
    shape_error error;
    int count = 5 + choose(s, 40);
    for (int i = 0; i < count; i++) {
        shape_ellipsoid e = {
            .x = (float)range(s, -4, 4), .y = (float)range(s, 0, 3), .z = (float)range(s, -4, 4)};
        e.a = (float)range(s, 0.6, 2), e.b = (float)range(s, 0.4, 1.5), e.c = (float)range(s, 0.6, 2);
        e.q = (shape_quat){(float)range(s, -1, 1), (float)range(s, -1, 1), (float)range(s, -1, 1), 1};
        sure(shape_primitives_add_ellipsoid(list, e, &error), &error);
    }
}

static void make_cloud(generated_scene *s)
{
    shape_error error;
    size_t index;
    uint64_t seed = shape_random_u32(&s->random);
    sure(shape_set_add_cloud(s->set, "cloud", &index, &error), &error);
    shape_cloud *cloud = &s->set->clouds[index];
    shape_primitives *list = shape_set_list(s->set, index);
    shape_gaussian gaussian = shape_gaussian_species((shape_species)choose(s, 3));
    shape_metaball balls = shape_metaball_defaults();
    shape_layer_options layer = shape_layer_options_preset((shape_layer_preset)choose(s, 3));
    cloud->field.model = SHAPE_MODEL_SPHEROID;
    cloud->medium.extinction = (float)spread(s, 0.5, 20);
    switch (choose(s, 7)) {
    case 0:
        s->kind = "metaballs";
        cloud->field.model = SHAPE_MODEL_METABALL;
        balls.count = (size_t)(3 + choose(s, 8));
        sure(shape_metaball_make(&balls, seed, list, &error), &error);
        break;
    case 1:
        s->kind = "layer";
        sure(shape_layer_make(&layer, cloud, list, &error), &error);
        break;
    case 2:
        s->kind = "ellipsoids";
        add_ellipsoids(s, list);
        break;
    case 3:
        s->kind = "uniform";
        cloud->field.model = SHAPE_MODEL_UNIFORM;
        add_ellipsoids(s, list);
        break;
    default:
        s->kind = "heap";
        sure(shape_gaussian_make(&gaussian, seed, list, NULL, &error), &error);
    }
    cloud = &s->set->clouds[index];
    cloud->field.seed = seed;
    cloud->field.kappa = (float)range(s, 0.2, 0.8);
    cloud->field.octaves = 3 + choose(s, 5);
    cloud->medium.phase = choose(s, 3) ? SHAPE_PHASE_HG : (shape_phase_kind)choose(s, 5);
    cloud->medium.g = (float)range(s, 0.3, 0.9);
    cloud->medium.albedo = choose(s, 2) ? 1 : (float)range(s, 0.8, 1);
    sure(shape_cloud_choose_noise_scale(cloud, list, &error), &error);
}

/* Copies of the first beside and behind it. */
static void add_copies(generated_scene *s)
{
    shape_error error;
    shape_dvec3 low, high;
    if (choose(s, 4) || !shape_set_bounds(s->set, &low, &high))
        return;
    double side = fmax(high.x - low.x, high.z - low.z);
    int count = 1 + choose(s, 3);
    for (int i = 0; i < count; i++) {
        shape_frame frame = shape_frame_identity();
        frame.m[0][3] = range(s, -4, 4) * side, frame.m[2][3] = range(s, -4, 4) * side;
        sure(shape_set_add_copy(s->set, 0, &frame, NULL, &error), &error);
    }
}

static void make_view(generated_scene *s)
{
    shape_dvec3 low = {0, 0, 0}, high = {1, 1, 1};
    s->light = shape_light_defaults();
    double height = range(s, 5, 80), azimuth = range(s, 0, 360); /* compilers order arguments as they like */
    s->light.sun = shape_sun_direction(azimuth, height);
    if (choose(s, 3) == 0) {
        s->light.sky = SHAPE_SKY_CONSTANT;
        for (int c = 0; c < 3; c++)
            s->light.sky_radiance[c] = (float)range(s, 0, 1);
    }
    s->view = shape_view_defaults();
    s->view.width = 96, s->view.height = 54;
    s->view.fov = range(s, 30, 60);
    shape_set_cloud_bounds(s->set, 0, &low, &high);
    shape_view_frame(&s->view, &s->light, low, high);
    shape_dvec3 away = shape_dvec3_sub(s->view.eye, s->view.target);
    double distance = shape_dvec3_length(away) * spread(s, 0.5, 4);
    height = range(s, -15, 60), azimuth = range(s, 0, 360);
    away = shape_sun_direction(azimuth, height);
    s->view.eye = shape_dvec3_add(s->view.target, shape_dvec3_scale(away, distance));
}

void generated_open(generated_scene *s, long number)
{
    shape_error error;
    memset(s, 0, sizeof *s);
    s->number = number;
    s->random = shape_random_seed((uint64_t)number, 4711);
    s->set = shape_set_create(&error);
    if (!s->set)
        sure(SHAPE_ERROR_MEMORY, &error);
    make_cloud(s);
    add_copies(s);
    sure(shape_set_check(s->set, &error), &error);
    sure(shape_volume_create(s->set, &s->volume, &error), &error);
    make_view(s);
    s->error = spread(s, 0.02, 0.2);
}

void generated_close(generated_scene *s)
{
    shape_volume_destroy(s->volume);
    shape_set_destroy(s->set);
}
