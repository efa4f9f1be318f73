/* The sun's way over a day (Meeus 1998, chapter 13) and the air that it shines through (Kasten and Young 1989). */
#include "shape/day.h"

#include <math.h>

static const double degree = 3.14159265358979323846 / 180;

void shape_day_sun(const shape_day *day, double *azimuth, double *height)
{
    double hour_angle = remainder(day->hour - 12, 24) * 15 * degree; /* westward from the south */
    double latitude = day->latitude * degree, declination = day->declination * degree;
    double up = sin(latitude) * sin(declination) + cos(latitude) * cos(declination) * cos(hour_angle);
    double east = -cos(declination) * sin(hour_angle);
    double south = sin(latitude) * cos(declination) * cos(hour_angle) - cos(latitude) * sin(declination);
    *height = asin(fmin(fmax(up, -1), 1)) / degree;
    *azimuth = atan2(east, south) / degree;
}

static double air_mass(double height)
{
    double h = fmax(height, 0);
    return 1 / (sin(h * degree) + 0.50572 * pow(h + 6.07995, -1.6364));
}

void shape_day_transmittance(double height, float rgb[3])
{
    /* Vertical optical depths at 615, 535 and 445 nm: Rayleigh scattering 0.062, 0.109, 0.233 (Bodhaine et al. 1999)
     * and an aerosol of 0.05, 0.06, 0.08 as in clean country air. */
    static const double depth[3] = {0.112, 0.169, 0.313};
    static const double set = -0.833, reference = 40;
    double rim = fmin(fmax((height - set) / -set, 0), 1);
    for (int i = 0; i < 3; i++)
        rgb[i] =
            (float)(rim * rim * (3 - 2 * rim) * exp(-depth[i] * (air_mass(height) - air_mass(reference))));
}

void shape_day_apply(const shape_day *day, shape_light *light)
{
    double azimuth, height;
    float rgb[3];
    shape_day_sun(day, &azimuth, &height);
    shape_day_transmittance(height, rgb);
    light->sun = shape_sun_direction(azimuth, height);
    for (int i = 0; i < 3; i++)
        light->sun_irradiance[i] *= rgb[i];
}
