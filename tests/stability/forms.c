/* Formulas that divide by zero or cancel: rotations, metaballs, thresholds, phase functions, the sky. */
#include "field/density_model.h"
#include "light/majorant.h"
#include "row.h"
#include "shape/meshfit.h"
#include "shape/phase.h"
#include "shape/random.h"

static const double pi = 3.14159265358979323846;

/* --- rotations --- */

/* Jiménez 2018 Eq. 27 to 30: about the unit vector along x cross v, by the arc cosine of x v. What becomes of x. */
static shape_dvec3 plain_rodrigues(shape_dvec3 v)
{
    const shape_dvec3 x = {1, 0, 0};
    shape_dvec3 k = shape_dvec3_cross(x, v);
    double length = shape_dvec3_length(k), angle = acos(v.x);
    k = shape_dvec3_make(k.x / length, k.y / length, k.z / length);
    shape_dvec3 turned = shape_dvec3_scale(x, cos(angle));
    turned = shape_dvec3_add(turned, shape_dvec3_scale(shape_dvec3_cross(k, x), sin(angle)));
    return shape_dvec3_add(turned, shape_dvec3_scale(k, shape_dvec3_dot(k, x) * (1 - cos(angle))));
}

/* A triangle whose longest spoke is its first, along (way, tilt, 0): how far its ellipsoid's x axis is from there. */
static void rotation(double way, double *plain, double *ours)
{
    const shape_dvec3 corner[3] = {{2 * way, 0, 0}, {-way, 0.5, 0}, {-way, -0.5, 0}};
    shape_meshfit fit = shape_meshfit_defaults();
    shape_ellipsoid e;
    if (!shape_meshfit_triangle(corner, &fit, &e))
        abort();
    shape_vec3 x = shape_quat_rotate(e.q, shape_vec3_make(1, 0, 0));
    shape_dvec3 turned = plain_rodrigues(shape_dvec3_make(way, 0, 0));
    *ours = hypot((double)x.x - way, hypot((double)x.y, (double)x.z));
    *plain = hypot(turned.x - way, hypot(turned.y, turned.z));
}

/* --- densities --- */

static void metaball_pole(double x, double *plain, double *ours)
{
    (void)x;
    shape_sphere sphere = {1, 2, 3, 1.5f};
    sample_scene scene = sample_begin(SHAPE_MODEL_METABALL, 1);
    sample_add(&scene, sphere.x, sphere.y, sphere.z, sphere.radius, sphere.radius, sphere.radius);
    *plain = (double)(sphere.radius * sphere.radius / (0.0f * sphere.x));
    *ours = (double)density_metaball_sum(&scene.set->lists[0], shape_vec3_make(1, 2, 3));
    sample_end(&scene);
}

static void threshold(double kappa, double *plain, double *ours)
{
    float k = (float)kappa, n = 0, u = 0;
    *plain = (double)expf(-u / ((1 - k) + 2 * k * n));
    *ours = (double)density_gamma(k, n, u);
}

/* The noise at which Eq. 2 ends the cloud half a radius from a centre, over exp(-1/2), its value for kappa 0. Plain: n = exp(-u /
 * ((1 - k) + 2 k n)) solved for the n on its right side. Ours: the bound of the path tracer's grid that is further off. */
static void edge_noise(double kappa, double *plain, double *ours)
{
    const int half = MAJORANT_TABLE / 2;
    const double u = 0.5, truth = exp(-u);
    float k = (float)kappa, n = expf(-(float)u);
    *plain = (double)(((float)u / -logf(n) - (1 - k)) / (2 * k)) / truth;
    shape_volume_cloud cloud = {.field = {.kappa = k}};
    majorant_cloud *bounds = calloc(1, sizeof *bounds);
    if (!bounds)
        abort();
    bounds->cloud = &cloud;
    majorant_threshold_tables(bounds);
    double top = (double)bounds->top[half] / truth, bottom = (double)bounds->bottom[half] / truth;
    *ours = fabs(top - 1) > fabs(bottom - 1) ? top : bottom;
    free(bounds);
}

/* --- phase functions --- */

/* At the peak, relative to double precision with the factored base. */
static void phase_peak(double g, double *plain, double *ours)
{
    float f = (float)g, c = g < 0 ? -1.0f : 1.0f, base = 1 + f * f - 2 * f * c;
    double a = fabs((double)f), truth = (1 + a) / (4 * pi * (1 - a) * (1 - a));
    *plain = (double)((1 - f * f) / (base * sqrtf(base))) / (4 * pi) / truth;
    *ours = (double)shape_phase_hg(f, c) / truth;
}

/* A cosine drawn from HG by the inverse as it is usually written, which divides by g. */
static void phase_draw(double g, double *plain, double *ours)
{
    const float u = 0.75f;
    float f = (float)g, q = (1 - f * f) / (1 - f + 2 * f * u);
    shape_medium medium = shape_medium_defaults();
    medium.g = f;
    *plain = (double)((1 + f * f - q * q) / (2 * f));
    *ours = (double)shape_phase_sample(&medium, u);
}

/* --- the sky --- */

/* Radiance of the clear sky at that height (a sine) before the sun; plain: exp(B / cos) of Perez without a floor. */
static void below_horizon(double height, double *plain, double *ours)
{
    const double b = -0.3554 * 2.5 + 0.4275, a = 0.1787 * 2.5 - 1.4630;
    shape_light light = shape_light_defaults();
    shape_sky sky = shape_sky_make(&light);
    float level = (float)sqrt(1 - height * height), rgb[3];
    *plain = fabs(1 + a * exp(b / height));
    shape_sky_radiance(&sky, shape_vec3_make(0, (float)height, level), rgb);
    *ours = (double)rgb[1];
}

/* Luminance at the zenith for a sun at that height, degrees. */
static void sunk_sun(double height, double *plain, double *ours)
{
    double zenith = (90 - height) * pi / 180, t = 2.5, chi = (4.0 / 9 - t / 120) * (pi - 2 * zenith);
    shape_light light = shape_light_defaults();
    float rgb[3];
    light.sun = shape_sun_direction(60, height);
    shape_sky sky = shape_sky_make(&light);
    shape_sky_radiance(&sky, shape_vec3_make(0, 1, 0), rgb);
    *plain = (4.0453 * t - 4.9710) * tan(chi) - 0.2155 * t + 2.4192;
    *ours = (double)rgb[1];
}

#define DRAWN "cosine drawn for the number 0.75, 0.5 in truth"

static const stability_row rows[] = {
    {"Rodrigues at 0 degrees (Jiménez Eq. 27)", "divides by the length of x cross v, which is 0",
     "half-angle quaternion, no division by a sine", "distance of the turned axis from where it should be", 0,
     1e-6, rotation, 1},
    {"Rodrigues at 180 degrees", "the same", "half a turn about any axis across",
     "distance of the turned axis from where it should be", 0, 1e-6, rotation, -1},
    {"metaball's centre (Jiménez Eq. 19)", "r^2 / d^2 with d = 0",
     "d is held above a thousandth of the radius", "F", 1, 1.0001e6, metaball_pole, 0},
    {"kappa 1, noise 0, at a centre (Jiménez Eq. 2)", "exp(-0/0)", "the denominator is held above 1e-6",
     "gamma", 0, 1, threshold, 1},
    {"kappa 0, the noise that bounds a spheroid (Jiménez Eq. 2, solved for it)", "divides by 2 kappa",
     "Eq. 2 over and over, from below and from above", "noise at the edge over the truth", 0.999, 1.001,
     edge_noise, 0},
    {"Henyey-Greenstein, g = 0.9999, straight on", "1 + g^2 - 2 g c cancels in single precision",
     "with h = abs(g): (1 - h)^2 + 2 h (1 - abs(c))", "peak over its true value", 0.999, 1.001, phase_peak,
     0.9999},
    {"the same, g = -0.9999, straight back", "the same", "the same", "peak over its true value", 0.999, 1.001,
     phase_peak, -0.9999},
    {"drawing from Henyey-Greenstein, g = 0", "divides by g", "an inverse without that division", DRAWN,
     0.499, 0.501, phase_draw, 0},
    {"the same, g = 1e-6", "cancels", "the same", DRAWN, 0.499, 0.501, phase_draw, 1e-6},
    {"clear sky just below the horizon", "exp(B / cos) of Perez overflows",
     "cos is held at the horizon, ground below", "radiance", 0, 100, below_horizon, -1e-3},
    {"clear sky, sun 40 degrees below the horizon", "Preetham's zenith is negative",
     "the sun's place is held at the horizon, and darkened by e every 3 degrees", "at the zenith", 0, 100,
     sunk_sun, -40},
};

const stability_part stability_forms = {"Formulas", rows, sizeof rows / sizeof *rows};
