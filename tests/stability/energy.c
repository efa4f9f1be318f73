/* Which lights conserve energy: what leaves a white ball of what it scatters, and a white furnace. */
#include "row.h"
#include "shape/random.h"

static const double pi = 3.14159265358979323846;

const stability_energy stability_energies[STABILITY_ENERGIES] = {
    {"`--method reference`", 0.03, 1e-6, -1},
    {"`grid` (default of `march`)", 0.12, 0.01, SHAPE_MARCH_GRID},
    {"`single`", 0, 0, SHAPE_MARCH_SINGLE},
    {"`powder`", 0, 0, SHAPE_MARCH_POWDER},
    {"`powder-angle`", 0, 0, SHAPE_MARCH_POWDER_ANGLE},
    {"`beer-max`", 0, 0, SHAPE_MARCH_BEER_MAX},
    {"`harris`", 0, 0, SHAPE_MARCH_HARRIS},
    {"`two-pass` (the 2018 sum)", 0, 0, SHAPE_MARCH_TWO_PASS},
    {"`octaves`", 0, 0, SHAPE_MARCH_OCTAVES},
};

/* Radiance along one ray, by either renderer. */
typedef struct gauge {
    shape_marcher *marcher;
    shape_tracer *tracer;
    shape_march_scratch scratch;
    shape_random random;
    shape_light light;
} gauge;

/* eye: where `grid` is looked at from; with isotropic scattering its light is alike from everywhere. */
static void open_gauge(gauge *g, const stability_energy *energy, const sample_scene *scene,
                       const shape_light *light, shape_dvec3 eye)
{
    shape_march_options options = shape_march_defaults();
    shape_error error;
    memset(g, 0, sizeof *g);
    g->random = shape_random_seed(5, 0);
    g->light = *light;
    options.resolution = 12;
    options.light_step = 0.02;
    options.light = (shape_march_light)energy->march;
    if (energy->march < 0)
        stability_must(shape_tracer_create(scene->volume, &g->tracer, &error), &error);
    else
        stability_must(shape_marcher_create(scene->volume, light, eye, &options, &g->marcher, &error),
                       &error);
}

static double read_gauge(gauge *g, shape_dvec3 eye, shape_dvec3 d)
{
    shape_pathtrace_options options = shape_pathtrace_defaults();
    shape_error error;
    double rgb[3];
    options.sun_angle = 0;
    if (g->tracer)
        shape_pathtrace_radiance(g->tracer, &g->light, &options, eye, d, &g->random, rgb);
    else
        stability_must(shape_march_radiance(g->marcher, eye, d, 0, &g->scratch, rgb, &error), &error);
    return rgb[0];
}

static void close_gauge(gauge *g)
{
    shape_marcher_destroy(g->marcher);
    shape_tracer_destroy(g->tracer);
    shape_march_scratch_free(&g->scratch);
}

/* The radiance of rays through a ball of radius 1, from all sides, evenly: their mean is flux / (4 pi pi). */
static double mean_radiance(const stability_energy *energy, const sample_scene *scene,
                            const shape_light *light)
{
    enum { RAYS = 720, PATHS = 60000 };
    const int rays = energy->march < 0 ? PATHS : RAYS;
    shape_random random = shape_random_seed(2, 0);
    gauge g;
    double sum = 0;
    open_gauge(&g, energy, scene, light, shape_dvec3_make(0, 0, 9));
    for (int i = 0; i < rays; i++) {
        double turn = 2 * pi * shape_random_unit(&random), up = 1 - 2 * shape_random_unit(&random);
        double level = sqrt(1 - up * up), r = sqrt(shape_random_unit(&random));
        double at = 2 * pi * shape_random_unit(&random);
        shape_dvec3 d = {level * cos(turn), up, level * sin(turn)}, x = {sin(turn), 0, -cos(turn)};
        shape_dvec3 y = shape_dvec3_cross(d, x), eye = shape_dvec3_scale(d, -3);
        eye = shape_dvec3_add(eye, shape_dvec3_scale(x, r * cos(at)));
        eye = shape_dvec3_add(eye, shape_dvec3_scale(y, r * sin(at)));
        sum += read_gauge(&g, eye, d) / rays;
    }
    close_gauge(&g);
    return sum;
}

/* Of parallel light, a ball of optical diameter D lets 2 [1 - (1 + D) exp(-D)] / D^2 through. */
static double scattered_share(double d)
{
    return 1 - 2 * (1 - (1 + d) * exp(-d)) / (d * d);
}

void stability_energy_measure(const stability_energy *energy, double depth, double *flux, double *furnace)
{
    sample_scene scene = stability_ball(1, depth / 2, 1);
    shape_light light = shape_light_defaults(), white = stability_white_sky();
    bool sky = energy->march < 0 || energy->march >= SHAPE_MARCH_OCTAVES;
    light.sky = SHAPE_SKY_NONE;
    double irradiance = (double)light.sun_irradiance[0];
    *flux = mean_radiance(energy, &scene, &light) * 4 * pi / (irradiance * scattered_share(depth));
    *furnace = sky ? mean_radiance(energy, &scene, &white) : (double)NAN;
    sample_end(&scene);
}

bool stability_energy_holds(const stability_energy *energy, double flux, double furnace)
{
    return fabs(flux - 1) <= energy->flux && fabs(furnace - 1) <= energy->furnace;
}
