/* The sky: the analytic daylight of Preetham, Shirley and Smits 1999 ("A practical analytic model for daylight",
 * appendix A: the Perez et al. 1993 luminance distribution, and the zenith's values) in linear Rec. 709. Mirrored by
 * shaders/light/sky.glsl. */
#include <math.h>
#include <string.h>

#include "shape/view.h"

static const double turbidity = 2.5;
static const float ground_albedo = 0.2f;
/* Radiance units in 1 kcd/m^2: a sun of 100 klx stands for an irradiance of pi. */
static const double scale = 0.0314159265358979;
/* How far below the horizon (in sines) its haze reaches. */
static const float haze = 0.2f;

static float perez(const float k[5], float cos_view, float angle, float cos_angle)
{
    return (1 + k[0] * expf(k[1] / fmaxf(cos_view, 1e-3f))) *
           (1 + k[2] * expf(k[3] * angle) + k[4] * cos_angle * cos_angle);
}

/* Slope and offset in turbidity of A to E, for Y, x and y. */
static const double perez_table[3][5][2] = {
    {{0.1787, -1.4630}, {-0.3554, 0.4275}, {-0.0227, 5.3251}, {0.1206, -2.5771}, {-0.0670, 0.3703}},
    {{-0.0193, -0.2592}, {-0.0665, 0.0008}, {-0.0004, 0.2125}, {-0.0641, -0.8989}, {-0.0033, 0.0452}},
    {{-0.0167, -0.2608}, {-0.0950, 0.0092}, {-0.0079, 0.2102}, {-0.0441, -1.6537}, {-0.0109, 0.0529}}};

/* The zenith's x and y: rows for T^2, T and 1, columns for the powers 3 to 0 of the sun's zenith angle. */
static const double zenith_table[2][3][4] = {{{0.00166, -0.00375, 0.00209, 0},
                                              {-0.02903, 0.06377, -0.03202, 0.00394},
                                              {0.11693, -0.21196, 0.06052, 0.25886}},
                                             {{0.00275, -0.00610, 0.00317, 0},
                                              {-0.04214, 0.08970, -0.04153, 0.00516},
                                              {0.15346, -0.26756, 0.06670, 0.26688}}};

static double zenith_chromaticity(const double table[3][4], double angle)
{
    double sum = 0;
    for (int row = 0; row < 3; row++) {
        const double *c = table[row];
        sum = sum * turbidity + ((c[0] * angle + c[1]) * angle + c[2]) * angle + c[3];
    }
    return sum;
}

static double zenith_luminance(double angle)
{
    double chi = (4.0 / 9 - turbidity / 120) * (3.14159265358979 - 2 * angle);
    return (4.0453 * turbidity - 4.9710) * tan(chi) - 0.2155 * turbidity + 2.4192;
}

/* The model is a fit for a sun above the horizon: below, the sun is taken to stand on it. */
static void place_sun(shape_sky *sky, shape_dvec3 sun)
{
    double height = sun.y > 0 ? sun.y : 0, level = hypot(sun.x, sun.z);
    double shrink = level > 0 ? sqrt(fmax(1 - height * height, 0)) / level : 0;
    sky->sun[0] = (float)(sun.x * shrink);
    sky->sun[1] = (float)fmin(height, 1);
    sky->sun[2] = level > 0 ? (float)(sun.z * shrink) : height > 0 ? 0 : 1;
    /* Twilight: a factor e each 3 degrees that the sun has sunk. */
    double sunk = sun.y < 0 ? asin(fmax(sun.y, -1)) * (180 / 3.14159265358979) : 0;
    sky->night = (float)exp(sunk / 3);
}

static void make_ground(shape_sky *sky, const shape_light *light)
{
    float rgb[3], sum[3] = {0, 0, 0};
    const int rows = 16, columns = 32;
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < columns; j++) {
            /* Equal steps in sin^2: directions of equal share in the irradiance. */
            float up = sqrtf(((float)i + 0.5f) / (float)rows), level = sqrtf(1 - up * up);
            float turn = ((float)j + 0.5f) * (6.2831853f / (float)columns);
            shape_sky_radiance(sky, shape_vec3_make(level * sinf(turn), up, level * cosf(turn)), rgb);
            for (int c = 0; c < 3; c++)
                sum[c] += rgb[c] / (float)(rows * columns);
        }
    for (int c = 0; c < 3; c++)
        sky->ground[c] = ground_albedo *
                         (sum[c] + light->sun_irradiance[c] * 0.318309886f * fmaxf((float)light->sun.y, 0));
}

shape_sky shape_sky_make(const shape_light *light)
{
    shape_sky sky;
    memset(&sky, 0, sizeof sky);
    sky.kind = light->sky;
    memcpy(sky.constant, light->sky_radiance, sizeof sky.constant);
    place_sun(&sky, light->sun);
    double cos_sun = (double)sky.sun[1], angle = acos(cos_sun);
    double zenith[3] = {zenith_luminance(angle) * scale, zenith_chromaticity(zenith_table[0], angle),
                        zenith_chromaticity(zenith_table[1], angle)};
    for (int c = 0; c < 3; c++) {
        for (int i = 0; i < 5; i++)
            sky.perez[c][i] = (float)(perez_table[c][i][0] * turbidity + perez_table[c][i][1]);
        sky.zenith[c] = (float)zenith[c] / perez(sky.perez[c], 1, (float)angle, (float)cos_sun);
    }
    if (sky.kind == SHAPE_SKY_CLEAR)
        make_ground(&sky, light);
    return sky;
}

/* CIE 1931 xyY to linear Rec. 709; what lies outside the gamut is cut at 0. */
static void to_rgb(const float yxy[3], float rgb[3])
{
    float luminance = yxy[0], x = luminance * yxy[1] / yxy[2];
    float z = luminance * (1 - yxy[1] - yxy[2]) / yxy[2];
    rgb[0] = fmaxf(3.2404542f * x - 1.5371385f * luminance - 0.4985314f * z, 0);
    rgb[1] = fmaxf(-0.9692660f * x + 1.8760108f * luminance + 0.0415560f * z, 0);
    rgb[2] = fmaxf(0.0556434f * x - 0.2040259f * luminance + 1.0572252f * z, 0);
}

/* The model's own colours show a pink horizon by day and a green one at sunset. Real skylight stays near the CIE
 * daylight locus (Judd et al. 1964), so y is drawn three quarters of the way to it. */
static const float colour_lift =
    0.08f; /* and colours are taken a few degrees higher, clear of the worst of it */

static float daylight(float x, float y)
{
    return 0.25f * y + 0.75f * (-3 * x * x + 2.87f * x - 0.275f);
}

static void clear_sky(const shape_sky *sky, shape_vec3 d, float rgb[3])
{
    float up = fmaxf(d.y, 0), yxy[3];
    float cos_angle = d.x * sky->sun[0] + d.y * sky->sun[1] + d.z * sky->sun[2];
    cos_angle = fminf(fmaxf(cos_angle, -1), 1);
    float angle = acosf(cos_angle);
    for (int c = 0; c < 3; c++)
        yxy[c] = sky->zenith[c] * perez(sky->perez[c], c ? fminf(up + colour_lift, 1) : up, angle, cos_angle);
    yxy[2] = daylight(yxy[1], yxy[2]);
    to_rgb(yxy, rgb);
    float t = fminf(fmaxf(-d.y / haze, 0), 1), share = t * t * (3 - 2 * t);
    for (int c = 0; c < 3; c++)
        rgb[c] = rgb[c] * sky->night * (1 - share) + sky->ground[c] * share;
}

void shape_sky_radiance(const shape_sky *sky, shape_vec3 direction, float rgb[3])
{
    switch (sky->kind) {
    case SHAPE_SKY_CLEAR:
        clear_sky(sky, direction, rgb);
        return;
    case SHAPE_SKY_CONSTANT:
        memcpy(rgb, sky->constant, 3 * sizeof *rgb);
        return;
    case SHAPE_SKY_NONE:
        break;
    }
    rgb[0] = rgb[1] = rgb[2] = 0;
}

static void mean_half(const shape_sky *sky, float sign, float mean[3])
{
    const int rows = 16, columns = 32;
    float rgb[3], sum[3] = {0, 0, 0};
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < columns; j++) {
            float up = ((float)i + 0.5f) / (float)rows, level = sqrtf(1 - up * up);
            float turn = ((float)j + 0.5f) * (6.2831853f / (float)columns);
            shape_sky_radiance(sky, shape_vec3_make(level * sinf(turn), sign * up, level * cosf(turn)), rgb);
            for (int c = 0; c < 3; c++)
                sum[c] += rgb[c];
        }
    for (int c = 0; c < 3; c++)
        mean[c] = sum[c] / (float)(rows * columns);
}

void shape_sky_mean(const shape_sky *sky, float upper[3], float lower[3])
{
    mean_half(sky, 1, upper);
    mean_half(sky, -1, lower);
}
