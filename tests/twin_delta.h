/* The slow twin of the path tracer: one majorant for the whole box, every primitive looked at for each density, plain
 * delta tracking for paths and shadows. Written apart from libshape/light, so that the two can check each other. Only
 * for volumes of one cloud in an untouched frame. */
#ifndef TWIN_DELTA_H
#define TWIN_DELTA_H

#include <math.h>

#include "shape/phase.h"
#include "shape/random.h"
#include "shape/view.h"
#include "shape/volume.h"

static inline float twin_density(const shape_volume_cloud *cloud, shape_vec3 p)
{
    float least = INFINITY;
    for (size_t i = 0; i < cloud->list->sphere_count; i++)
        least = fminf(least, shape_sphere_u2(&cloud->list->spheres[i], p));
    for (size_t i = 0; i < cloud->list->ellipsoid_count; i++)
        least = fminf(least, shape_ellipsoid_u2(&cloud->list->ellipsoids[i], p));
    return least <= 1 ? shape_cloud_density_at(cloud, p, least) : 0;
}

/* Moves p to a collision; false where the ray leaves the box. */
static inline bool twin_collide(const shape_volume_cloud *cloud, shape_dvec3 *p, shape_dvec3 d,
                                shape_random *random)
{
    shape_ray ray = {{(float)p->x, (float)p->y, (float)p->z}, {(float)d.x, (float)d.y, (float)d.z}};
    float t0 = 0, t1 = INFINITY;
    if (!shape_box_intersect(cloud->box, ray, &t0, &t1))
        return false;
    for (double t = (double)t0;;) {
        t -= log(1 - shape_random_unit(random)) / (double)cloud->medium.extinction;
        if (!(t < (double)t1))
            return false;
        shape_dvec3 q = shape_dvec3_add(*p, shape_dvec3_scale(d, t));
        shape_vec3 place = {(float)q.x, (float)q.y, (float)q.z};
        if (shape_random_unit(random) < (double)twin_density(cloud, place)) {
            *p = q;
            return true;
        }
    }
}

static inline shape_dvec3 twin_turn(shape_dvec3 d, double c, shape_random *random)
{
    shape_dvec3 other = fabs(d.y) < 0.9 ? shape_dvec3_make(0, 1, 0) : shape_dvec3_make(1, 0, 0);
    shape_dvec3 x = shape_dvec3_normalize(shape_dvec3_cross(d, other)), y = shape_dvec3_cross(d, x);
    double s = sqrt(fmax(1 - c * c, 0)), angle = 2 * 3.14159265358979 * shape_random_unit(random);
    x = shape_dvec3_add(shape_dvec3_scale(x, s * cos(angle)), shape_dvec3_scale(y, s * sin(angle)));
    return shape_dvec3_normalize(shape_dvec3_add(x, shape_dvec3_scale(d, c)));
}

/* One estimate of the radiance from direction d; the sun is a direction. */
static inline void twin_radiance(const shape_volume *volume, const shape_light *light, shape_dvec3 p,
                                 shape_dvec3 d, shape_random *random, double rgb[3])
{
    const shape_volume_cloud *cloud = &volume->clouds[0];
    shape_sky sky = shape_sky_make(light);
    double weight = 1;
    rgb[0] = rgb[1] = rgb[2] = 0;
    while (twin_collide(cloud, &p, d, random)) {
        weight *= (double)cloud->medium.albedo;
        shape_dvec3 shadow = p;
        double value = weight * (double)shape_phase(&cloud->medium, (float)shape_dvec3_dot(d, light->sun));
        bool lit = !twin_collide(cloud, &shadow, light->sun, random);
        for (int c = 0; c < 3 && lit; c++)
            rgb[c] += value * (double)light->sun_irradiance[c];
        d = twin_turn(d, (double)shape_phase_sample(&cloud->medium, (float)shape_random_unit(random)),
                      random);
    }
    float seen[3];
    shape_sky_radiance(&sky, shape_vec3_make((float)d.x, (float)d.y, (float)d.z), seen);
    for (int c = 0; c < 3; c++)
        rgb[c] += weight * (double)seen[c];
}

#endif
