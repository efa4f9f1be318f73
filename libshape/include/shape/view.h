/* Where one looks from, and the light: the camera, the sun and the sky that every renderer shares. */
#ifndef SHAPE_VIEW_H
#define SHAPE_VIEW_H

#include "shape/set.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shape_view {
    int width, height;       /* pixels, 1 to 16384; default 640x360 */
    shape_dvec3 eye, target; /* metres, world */
    double fov;              /* vertical, degrees, above 0 and below 180; default 45 */
    float exposure;          /* stops, for 8-bit pictures only; default 0.5 */
} shape_view;

typedef enum shape_sky_kind { SHAPE_SKY_NONE, SHAPE_SKY_CONSTANT, SHAPE_SKY_CLEAR } shape_sky_kind;

/* The air between the eye and what it sees (shape/air.h). All 0, the default: none. */
typedef struct shape_air {
    double
        visibility; /* how far away a black thing is just told from the sky, at height 0 [m], 0.001 to 1e12; 0: no air */
    double height; /* over which the air thins by a factor e [m], 0.001 to 1e12; 0: alike at all heights */
} shape_air;

typedef struct shape_light {
    shape_dvec3 sun;         /* unit vector to the sun; default azimuth 60, height 40 degrees */
    float sun_irradiance[3]; /* on a plane facing the sun; default pi each */
    shape_sky_kind sky;      /* default clear */
    float sky_radiance[3];   /* of SHAPE_SKY_CONSTANT */
    shape_air air;           /* default none */
} shape_light;

shape_view shape_view_defaults(void);
shape_light shape_light_defaults(void);
shape_status shape_view_check(const shape_view *view, shape_error *error);
shape_status shape_light_check(const shape_light *light, shape_error *error);

/* The unit vector to a sun at that azimuth (from +z towards +x) and height above the horizon, both in degrees. */
shape_dvec3 shape_sun_direction(double azimuth, double height);

/* Chooses eye and target so that the box fills most of the picture: seen from 11 degrees below, so that it stands against
 * the sky, 68 degrees round from the sun, on the side from which it looks broader. Width, height and fov must be set. */
void shape_view_frame(shape_view *view, const shape_light *light, shape_dvec3 min, shape_dvec3 max);

/* A pinhole camera made ready. The ray through picture point (x, y), in pixels from the upper left corner (pixel
 * centres at one half), has the direction normalize(forward + (2x/width - 1) right + (1 - 2y/height) up), where right
 * and up are already scaled by the field of view. */
typedef struct shape_camera {
    shape_dvec3 origin, forward, right, up;
} shape_camera;

shape_camera shape_view_camera(const shape_view *view);
shape_dvec3 shape_camera_direction(const shape_camera *camera, const shape_view *view, double x, double y);

/* --- the sky (light/sky.c, mirrored by shaders/light/sky.glsl) --- */

/* A sky made ready for evaluation; its members are what the shader takes as uniforms. The clear sky is the analytic
 * model of Preetham, Shirley and Smits 1999 (turbidity 2.5) in linear Rec. 709, scaled so that it goes with a sun of
 * irradiance pi; below the horizon a ground of albedo 0.2 lit by sun and sky, faded into the horizon's haze. */
typedef struct shape_sky {
    shape_sky_kind kind;
    float constant[3];
    float sun[3];      /* unit vector to the sun */
    float perez[3][5]; /* coefficients A to E of Y, x, y */
    float zenith[3];   /* Y, x, y at the zenith divided by the Perez function there */
    float ground[3];   /* radiance of the ground */
    float night;       /* factor that darkens the sky as the sun sinks below the horizon, 0 to 1 */
} shape_sky;

shape_sky shape_sky_make(const shape_light *light);
/* Radiance from direction (unit vector, where one looks). Finite and not negative for every direction and sun. The
 * sun's disc is not in it. */
void shape_sky_radiance(const shape_sky *sky, shape_vec3 direction, float rgb[3]);
/* Mean radiance over the upper and over the lower half of the sphere, by quadrature. */
void shape_sky_mean(const shape_sky *sky, float upper[3], float lower[3]);

#ifdef __cplusplus
}
#endif
#endif
