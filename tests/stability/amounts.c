/* Nothing, much, and too much: empty clouds, a hundred thousand primitives on a ray, sizes a million times apart, optical
 * depth 10,000, numbers that 16 bits do not hold. */
#include "light/march.h"
#include "row.h"
#include "shape/gaussian.h"
#include "shape/image.h"

/* --- how many --- */

static void empty_cloud(double x, double *plain, double *ours)
{
    (void)x;
    sample_scene scene = sample_begin(SHAPE_MODEL_SPHEROID, 2);
    sample_finish(&scene);
    shape_light light = stability_white_sky();
    shape_march_options options = shape_march_defaults();
    /* The middle of the box of nothing, from which a view is framed or a grid is laid out. */
    volatile float low = INFINITY, high = -INFINITY;
    *plain = (double)(0.5f * (low + high));
    *ours = stability_look(&scene, &light, &options, shape_dvec3_make(0, 0, 9), shape_dvec3_make(0, 0, -1));
    sample_end(&scene);
}

/* The depth of that many balls of 1 m in one place. Plain: the bin that a centre falls into among sixteen
 * between the least and the greatest of them (Wald 2007); what is in
 * none is not found. */
static void in_one_place(double count, double *plain, double *ours)
{
    enum { BINS = 16 };
    const shape_dvec3 place = {3, 4, 5};
    sample_scene scene = sample_begin(SHAPE_MODEL_UNIFORM, 0.1f);
    float low = INFINITY, high = -INFINITY;
    for (int i = 0; i < (int)count; i++) {
        sample_add(&scene, (float)place.x, (float)place.y, (float)place.z, 1, 1, 1);
        low = fminf(low, (float)place.x), high = fmaxf(high, (float)place.x);
    }
    sample_finish(&scene);
    float bin = BINS / (high - low) * ((float)place.x - low);
    *plain = bin >= 0 && bin <= BINS ? 1 : 0; /* not with a NaN */
    shape_candidates found = {0};
    shape_error error;
    double depth;
    stability_must(shape_volume_optical_depth(scene.volume, shape_dvec3_make(3, 4, 30),
                                              shape_dvec3_make(0, 0, -1), 0, INFINITY, 0.1f, &found, &depth,
                                              &error),
                   &error);
    *ours = depth / 0.2;
    shape_candidates_free(&found);
    sample_end(&scene);
}

/* Primitives left of that many that a hollow cumulus draws, the least of a hundred seeds. Plain: each that is in the core
 * (Jiménez section 3.6.1) is left out. */
static void hollow(double count, double *plain, double *ours)
{
    shape_gaussian options = shape_gaussian_defaults();
    options.count = (size_t)count;
    shape_primitives list = {0};
    shape_gaussian_report report;
    shape_error error;
    *plain = *ours = INFINITY;
    for (uint64_t seed = 1; seed <= 100; seed++) {
        size_t left = 0;
        options.hollow = false;
        stability_must(shape_gaussian_make(&options, seed, &list, &report, &error), &error);
        for (size_t i = 0; i < list.sphere_count; i++) {
            const shape_sphere *s = &list.spheres[i];
            left += !shape_gaussian_in_core(&options, shape_dvec3_make(s->x, s->y, s->z));
        }
        *plain = fmin(*plain, (double)left);
        list.sphere_count = 0;
        options.hollow = true;
        stability_must(shape_gaussian_make(&options, seed, &list, &report, &error), &error);
        *ours = fmin(*ours, (double)list.sphere_count);
        list.sphere_count = 0;
    }
    free(list.spheres);
}

/* That many balls of 1 m strung over 10 m; plain: each marched from its entry to its exit (Algorithm 1). */
static void many_on_a_ray(double count, double *plain, double *ours)
{
    sample_scene scene = sample_begin(SHAPE_MODEL_UNIFORM, 0.1f);
    for (int i = 0; i < (int)count; i++)
        sample_add(&scene, 0, 0, count > 1 ? 10 * (float)i / (float)(count - 1) : 0, 1, 1, 1);
    sample_finish(&scene);
    const shape_volume_cloud *cloud = &scene.volume->clouds[0];
    shape_dvec3 eye = {0, 0, 30}, d = {0, 0, -1};
    shape_candidates found = {0};
    shape_error error;
    double depth, truth = 0.1 * (count > 1 ? 12 : 2);
    stability_must(
        shape_cloud_candidates(cloud, shape_volume_ray(cloud, eye, d), 0, INFINITY, &found, &error), &error);
    *plain = 0;
    for (size_t i = 0; i < found.count; i++)
        *plain += 0.1 * (double)(found.items[i].t_out - found.items[i].t_in) / truth;
    stability_must(
        shape_volume_optical_depth(scene.volume, eye, d, 0, INFINITY, 0.1f, &found, &depth, &error), &error);
    *ours = depth / truth;
    shape_candidates_free(&found);
    sample_end(&scene);
}

/* One primitive, by a march that steps through the box of a volume and not through intervals: a sphere of `radius` beside one
 * of 1,000 m. */
static void small_beside_large(double radius, double *plain, double *ours)
{
    sample_scene scene = sample_begin(SHAPE_MODEL_UNIFORM, 500);
    sample_add(&scene, 0, 0, 0, (float)radius, (float)radius, (float)radius);
    sample_add(&scene, 2000, 0, 0, 1000, 1000, 1000);
    sample_finish(&scene);
    scene.volume->clouds[0].medium.albedo = 0;
    shape_light light = stability_white_sky();
    shape_march_options options = shape_march_defaults();
    const double truth = 2 * radius * 500;
    const int steps = 100;
    *plain = 0;
    for (int i = 0; i < steps; i++) {
        double z = -1000 + 2000 * (i + 0.5) / steps;
        *plain += 2000.0 / steps * shape_volume_extinction(scene.volume, shape_dvec3_make(0, 0, z)) / truth;
    }
    options.light = SHAPE_MARCH_SINGLE;
    *ours = -log(stability_look(&scene, &light, &options, shape_dvec3_make(0, 0, 3),
                                shape_dvec3_make(0, 0, -1))) /
            truth;
    sample_end(&scene);
}

/* --- how deep --- */

/* What reaches the middle of a ball after a depth, by exp(-depth / 128), the last of the light `octaves`: from a grid that
 * keeps transmittances, against one that keeps depths. */
static void deep_shadow(double depth, double *plain, double *ours)
{
    sample_scene scene = stability_ball(1, depth, 1);
    shape_light light = shape_light_defaults();
    shape_lightgrid_options options = shape_lightgrid_defaults();
    shape_lightgrid grid;
    shape_error error;
    light.sun = shape_dvec3_make(0, 1, 0);
    options.resolution = 11;
    options.scattering = false;
    stability_must(shape_lightgrid_build(scene.volume, 0, &light, &options, &grid, &error), &error);
    double kept = march_grid_value(&grid, grid.cells, SHAPE_LIGHTGRID_VALUES, 0, shape_vec3_make(0, 0, 0));
    double truth = exp(-depth / 128);
    *plain = pow((double)(float)exp(-kept), 1.0 / 128) / truth;
    *ours = exp(-kept / 128) / truth;
    shape_lightgrid_free(&grid);
    sample_end(&scene);
}

/* A white ball of that optical diameter in a white furnace: paths cut after 64 collisions, and after 4,096. */
static double furnace(double depth, int bounces)
{
    sample_scene scene = stability_ball(1, depth / 2, 1);
    shape_light light = stability_white_sky();
    shape_pathtrace_options options = shape_pathtrace_defaults();
    shape_random random = shape_random_seed(3, 3);
    shape_tracer *tracer;
    shape_error error;
    double sum = 0, rgb[3];
    const int paths = 2000;
    stability_must(shape_tracer_create(scene.volume, &tracer, &error), &error);
    options.max_bounces = bounces;
    for (int i = 0; i < paths; i++) {
        shape_pathtrace_radiance(tracer, &light, &options, shape_dvec3_make(0.3, 0, 9),
                                 shape_dvec3_make(0, 0, -1), &random, rgb);
        sum += rgb[0] / paths;
    }
    shape_tracer_destroy(tracer);
    sample_end(&scene);
    return sum;
}

static void deep_furnace(double depth, double *plain, double *ours)
{
    *plain = furnace(depth, 64);
    *ours = furnace(depth, shape_pathtrace_defaults().max_bounces);
}

/* --- 16 bits --- */

/* The nearest half-float: what matters here is that it ends at 65,504, and rounds to infinity from 65,520 on. */
static double to_half(double x)
{
    if (!(fabs(x) < 65520))
        return copysign(INFINITY, x);
    int exponent;
    frexp(x, &exponent);
    double unit = ldexp(1, exponent - 11 < -24 ? -24 : exponent - 11);
    return rint(x / unit) * unit;
}

static void bright_picture(double radiance, double *plain, double *ours)
{
    shape_error error;
    shape_image *image = shape_image_create(1, 1, &error), *back = NULL;
    unsigned char *bytes = NULL;
    size_t size = 0;
    if (!image)
        abort();
    for (int c = 0; c < 3; c++)
        image->pixels[c] = (float)radiance;
    stability_must(shape_image_encode(image, SHAPE_IMAGE_EXR, NULL, &bytes, &size, &error), &error);
    stability_must(shape_image_decode(bytes, size, &back, &error), &error);
    *plain = to_half(radiance) / radiance;
    *ours = (double)back->pixels[0] / radiance;
    free(bytes);
    shape_image_destroy(image);
    shape_image_destroy(back);
}

static void deep_grid(double depth, double *plain, double *ours)
{
    sample_scene scene = stability_ball(1, depth / 2, 1);
    shape_light light = shape_light_defaults();
    shape_lightgrid_options options = shape_lightgrid_defaults();
    shape_lightgrid grid;
    shape_error error;
    options.resolution = 8;
    options.scattering = false;
    stability_must(shape_lightgrid_build(scene.volume, 0, &light, &options, &grid, &error), &error);
    *ours = 0;
    for (int i = 0; i < grid.size[0] * grid.size[1] * grid.size[2]; i++)
        *ours = fmax(*ours, to_half((double)grid.cells[i * SHAPE_LIGHTGRID_VALUES]));
    *plain = to_half(depth);
    shape_lightgrid_free(&grid);
    sample_end(&scene);
}

#define RATIO "optical depth over the truth"

static const stability_row rows[] = {
    {"cloud without primitives", "the middle of the box of nothing is NaN", "empty boxes are asked for first",
     "radiance before a sky of 1", 1, 1, empty_cloud, 0},
    {"one primitive, in bins between the outermost centres (Wald 2007)",
     "16 / 0 times 0: it is in no bin, and no ray finds it", "a leaf is not divided", RATIO, 0.999, 1.001,
     in_one_place, 1},
    {"100 primitives in one place", "the same", "an axis without extent is not cut; without any, halves",
     RATIO, 0.999, 1.001, in_one_place, 100},
    {"one primitive of a hollow cumulus (Jiménez section 3.6.1)", "in the core it is left out: no cloud",
     "a cloud of core alone stays whole", "primitives left, the least of 100 seeds", 1, 1, hollow, 1},
    {"20 primitives of 1 m over 10 m",
     "each marched on its own (Jiménez Algorithm 1): exact only where they are apart",
     "joined intervals, each marched once", RATIO, 0.999, 1.001, many_on_a_ray, 20},
    {"100,000 primitives on one ray", "the same", "the same", RATIO, 0.999, 1.001, many_on_a_ray, 1e5},
    {"radii a million times apart", "steps through the whole box miss the small one",
     "steps fill each interval on its own", RATIO, 0.99, 1.01, small_beside_large, 1e-3},
    {"optical depth 10,000, light that reaches far", "a grid of transmittances holds 0 there",
     "the grid holds depths", "exp(-x / 128) over the truth", 0.9, 1.1, deep_shadow, 1e4},
    {"white furnace, optical depth 10,000", "paths cut after 64 collisions lose light",
     "4,096, and what is still lost is stated: below 4 %", "radiance, of 1", 0.96, 1 + 1e-9, deep_furnace,
     1e4},
    {"picture of radiance 100,000", "half-float EXR: infinity", "EXR and PFM are written as 32-bit float",
     "what is read over what was written", 1 - 1e-6, 1 + 1e-6, bright_picture, 1e5},
    {"optical depth 1,000,000 in a 16-bit texture", "infinity, and NaN between two of them",
     "depths end at 60,000", "largest value kept", 0, 65504, deep_grid, 1e6},
};

const stability_part stability_amounts = {"Amounts", rows, sizeof rows / sizeof *rows};
