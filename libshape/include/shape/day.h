/* The sun by the time of day: where it stands, and what the air leaves of it. */
#ifndef SHAPE_DAY_H
#define SHAPE_DAY_H

#include "shape/view.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shape_day {
    double hour;     /* true solar time, 0 to 24, 12 when the sun is highest; any number, taken modulo 24 */
    double latitude; /* degrees, -90 to 90; north is above 0 */
    double declination; /* of the sun [degrees]: -23.44 (December) to 23.44 (June), 0 at the equinoxes */
} shape_day;

/* Where the sun stands [degrees]: azimuth from +z (south) towards +x (east), -180 to 180, and height, -90 to 90. The
 * hour-angle formulas of spherical astronomy (Meeus 1998, chapter 13). */
void shape_day_sun(const shape_day *day, double *azimuth, double *height);

/* The share of the sun's light that the air lets through at a height [degrees], of what it lets through at 40, for red,
 * green and blue: exp(-depth m), m being the relative air mass of Kasten and Young 1989. 0 below -0.833 degrees, where
 * the sun's upper rim has set; smooth down to there. */
void shape_day_transmittance(double height, float rgb[3]);

/* Puts the sun into a light: direction, and the irradiance it has, times the transmittance. */
void shape_day_apply(const shape_day *day, shape_light *light);

#ifdef __cplusplus
}
#endif
#endif
