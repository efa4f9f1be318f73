/* Rays against boxes, spheres and ellipsoids where single precision or 0/0 decides; and the sweep that depends on the
 * side from which one looks. */
#include "row.h"
#include "shape/paper.h"
#include "shape/random.h"

/* --- boxes --- */

static bool plain_box(shape_box box, shape_ray ray)
{
    const float *low = &box.min.x, *high = &box.max.x, *o = &ray.origin.x, *d = &ray.direction.x;
    float near = 0, far = INFINITY;
    for (int a = 0; a < 3; a++) {
        float t0 = (low[a] - o[a]) / d[a], t1 = (high[a] - o[a]) / d[a];
        float least = t0 < t1 ? t0 : t1, most = t0 < t1 ? t1 : t0;
        near = near > least ? near : least;
        far = far < most ? far : most;
    }
    return near <= far;
}

/* Rays along each axis, either way, with zeros of either sign, on the four edges and the middles of the four faces that
 * run along it: all lie in the closed box. */
static void box_edges(double x, double *plain, double *ours)
{
    (void)x;
    const shape_box box = {{-1, -1, -1}, {1, 1, 1}};
    *plain = *ours = 0;
    for (int axis = 0; axis < 3; axis++)
        for (int way = -1; way <= 1; way += 2)
            for (int zero = 0; zero < 4; zero++)
                for (int place = 0; place < 9; place++) {
                    float o[3], d[3], t0 = 0, t1 = INFINITY;
                    int j = (axis + 1) % 3, k = (axis + 2) % 3;
                    o[axis] = -3 * (float)way, o[j] = (float)(place % 3 - 1), o[k] = (float)(place / 3 - 1);
                    d[axis] = (float)way, d[j] = zero & 1 ? -0.0f : 0.0f, d[k] = zero & 2 ? -0.0f : 0.0f;
                    shape_ray ray = {{o[0], o[1], o[2]}, {d[0], d[1], d[2]}};
                    *plain += !plain_box(box, ray);
                    *ours += !shape_box_intersect(box, ray, &t0, &t1);
                }
}

/* --- spheres --- */

/* b^2 - a c, all in single precision; the chord, NAN where it misses. */
static double plain_chord(shape_vec3 v, shape_vec3 d, float radius)
{
    float a = shape_vec3_dot(d, d), b = shape_vec3_dot(v, d), c = shape_vec3_dot(v, v) - radius * radius;
    float room = b * b - a * c;
    return room > 0 ? (double)(2 * sqrtf(room) / a) : 0;
}

/* The largest error of a chord over the diameter, of rays parallel to z from `distance` away, up to 0.9 of the radius. */
static void far_eye(double distance, double *plain, double *ours)
{
    sample_scene scene = stability_ball(1, 1, 0);
    *plain = *ours = 0;
    for (int i = 0; i < 200; i++) {
        double b = 0.9 * i / 200, truth = 2 * sqrt(1 - b * b), p = 0.3 * b;
        shape_dvec3 eye = {p, sqrt(b * b - p * p), distance}, d = {0, 0, -1};
        shape_ray ray = shape_volume_ray(&scene.volume->clouds[0], eye, d);
        shape_candidate hit;
        bool meets = shape_sphere_intersect(&scene.set->lists[0].spheres[0], 1, ray, &hit);
        double seen = meets ? (double)hit.t_out - (double)hit.t_in : 0;
        *ours = fmax(*ours, fabs(seen - truth) / 2);
        *plain = fmax(*plain, fabs(plain_chord(ray.origin, ray.direction, 1) - truth) / 2);
    }
    sample_end(&scene);
}

/* A ball of 4 mm whose cloud stands `distance` from the world's origin, the eye 1 m before it: world coordinates in
 * single precision against a frame in double precision. */
static void far_cloud(double distance, double *plain, double *ours)
{
    const double radius = 0.004;
    sample_scene scene = stability_ball(radius, 1, 0);
    shape_volume_cloud *cloud = &scene.volume->clouds[0];
    cloud->frame.m[0][3] = distance + 0.01;
    shape_frame_invert(&cloud->frame, &cloud->inverse);
    *plain = *ours = 0;
    for (int i = 0; i < 100; i++) {
        double b = radius * 0.9 * i / 100, truth = 2 * sqrt(radius * radius - b * b);
        shape_dvec3 eye = {distance + 0.01 + b, 0, 1}, d = {0, 0, -1};
        shape_ray ray = shape_volume_ray(cloud, eye, d);
        shape_candidate hit = {0, 0, 0};
        shape_sphere_intersect(&scene.set->lists[0].spheres[0], 1, ray, &hit);
        *ours = fmax(*ours, fabs((double)(hit.t_out - hit.t_in) - truth) / truth);
        shape_vec3 v = {(float)eye.x - (float)(distance + 0.01), 0, 1};
        *plain = fmax(*plain, fabs(plain_chord(v, shape_vec3_make(0, 0, -1), (float)radius) - truth) / truth);
    }
    sample_end(&scene);
}

/* A chord at an impact parameter of 1 - share radii, from 1,000 radii away. */
static void grazing(double share, double *plain, double *ours)
{
    const double distance = 1000, b = (double)(float)(1 - share), truth = 2 * sqrt(1 - b * b);
    shape_sphere sphere = {0, 0, 0, 1};
    shape_ray ray = {{(float)b, 0, (float)distance}, {0, 0, -1}};
    shape_candidate hit = {0, 0, 0};
    shape_sphere_intersect(&sphere, 1, ray, &hit);
    *ours = fabs((double)(hit.t_out - hit.t_in) - truth) / truth;
    *plain = fabs(plain_chord(ray.origin, ray.direction, 1) - truth) / truth;
}

/* --- ellipsoids --- */

/* The quadric's matrix R diag(1/a^2) R^T, and a t^2 + 2 b t + c with it, in single precision. */
static double plain_quadric(const shape_ellipsoid *e, shape_ray ray)
{
    double r[3][3];
    float m[3][3], s[3] = {1 / (e->a * e->a), 1 / (e->b * e->b), 1 / (e->c * e->c)};
    float v[3] = {ray.origin.x - e->x, ray.origin.y - e->y, ray.origin.z - e->z};
    const float *d = &ray.direction.x;
    float a = 0, b = 0, c = -1;
    shape_quat_matrix(e->q, r);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            m[i][j] = 0;
            for (int k = 0; k < 3; k++)
                m[i][j] += (float)r[i][k] * s[k] * (float)r[j][k];
            a += d[i] * m[i][j] * d[j];
            b += d[i] * m[i][j] * v[j];
            c += v[i] * m[i][j] * v[j];
        }
    float room = b * b - a * c;
    return room > 0 ? (double)(2 * sqrtf(room) / a) : 0;
}

/* In double precision, by the unit ball and the closest approach. */
static double true_chord(const shape_ellipsoid *e, shape_ray ray)
{
    double r[3][3], v[3] = {0, 0, 0}, d[3] = {0, 0, 0}, dd = 0, vd = 0, cc = 0;
    double w[3] = {(double)ray.origin.x - (double)e->x, (double)ray.origin.y - (double)e->y,
                   (double)ray.origin.z - (double)e->z};
    const double size[3] = {e->a, e->b, e->c}, way[3] = {ray.direction.x, ray.direction.y, ray.direction.z};
    shape_quat_matrix(e->q, r);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            v[i] += r[j][i] * w[j] / size[i];
            d[i] += r[j][i] * way[j] / size[i];
        }
        dd += d[i] * d[i];
        vd += v[i] * d[i];
    }
    for (int i = 0; i < 3; i++)
        cc += (v[i] - vd / dd * d[i]) * (v[i] - vd / dd * d[i]);
    return cc < 1 ? 2 * sqrt((1 - cc) / dd) : 0;
}

/* The mean error of the chord over its mean, of 2,000 rays at points inside, for semi-axes 1, 1, ratio. The same ray in
 * single precision goes to all three, so what is compared is the arithmetic. */
static void odd_ellipsoid(double ratio, double *plain, double *ours)
{
    shape_random random = shape_random_seed(7, 0);
    double sum = 0, wrong_plain = 0, wrong_ours = 0;
    for (int i = 0; i < 2000; i++) {
        double x[3], q[4];
        for (int k = 0; k < 4; k++)
            q[k] = shape_random_normal(&random);
        shape_quat turn = {(float)q[0], (float)q[1], (float)q[2], (float)q[3]};
        shape_ellipsoid e = {0, 0, 0, 0, 1, 1, (float)ratio, 0, shape_quat_normalize(turn)};
        for (int k = 0; k < 3; k++)
            x[k] = shape_random_range(&random, -0.5, 0.5) * (k == 2 ? ratio : 1);
        shape_vec3 in = shape_quat_rotate(e.q, shape_vec3_make((float)x[0], (float)x[1], (float)x[2]));
        shape_dvec3 way = {shape_random_normal(&random), shape_random_normal(&random),
                           shape_random_normal(&random)};
        way = shape_dvec3_normalize(way);
        shape_vec3 d = {(float)way.x, (float)way.y, (float)way.z};
        shape_ray ray = {shape_vec3_sub(in, shape_vec3_scale(d, 10)), d};
        shape_candidate hit = {0, 0, 0};
        double truth = true_chord(&e, ray);
        bool meets = shape_ellipsoid_intersect(&e, 1, ray, &hit);
        sum += truth;
        wrong_ours += fabs((meets ? (double)hit.t_out - (double)hit.t_in : 0) - truth);
        wrong_plain += fabs(plain_quadric(&e, ray) - truth);
    }
    *plain = wrong_plain / sum;
    *ours = wrong_ours / sum;
}

/* --- from opposite sides --- */

enum { SIDE = 16 };

/* Optical depths through two overlapping balls of pseudo-spheroids, the large one 20 m, from +z or -z; pixel (x, y) of the
 * one is (width - 1 - x, y) of the other, under a field of view so narrow that rays are parallel to a thousandth. */
static void look_from(const sample_scene *scene, double z, bool sweep, double depth[SIDE * SIDE])
{
    shape_view view = shape_view_defaults();
    shape_light light = stability_white_sky();
    float radiance[3 * SIDE * SIDE];
    shape_error error;
    view.width = view.height = SIDE;
    view.eye = shape_dvec3_make(0, 0, z);
    view.fov = 2 * atan(18 / fabs(z)) * 180 / 3.14159265358979;
    if (sweep) {
        shape_paper_options options = shape_paper_defaults();
        options.sweep = true;
        options.resolution = 2;
        stability_must(
            shape_paper_render(scene->volume, &view, &light, &options, radiance, NULL, NULL, &error), &error);
    } else {
        shape_march_options options = shape_march_defaults();
        shape_marcher *marcher;
        options.light = SHAPE_MARCH_SINGLE;
        options.step = 0.1;
        stability_must(shape_marcher_create(scene->volume, &light, view.eye, &options, &marcher, &error),
                       &error);
        stability_must(shape_march_render(marcher, &view, radiance, NULL, &error), &error);
        shape_marcher_destroy(marcher);
    }
    for (int i = 0; i < SIDE * SIDE; i++)
        depth[i] = -log((double)radiance[3 * i]);
}

static double asymmetry(const sample_scene *scene, bool sweep)
{
    double front[SIDE * SIDE], back[SIDE * SIDE], apart = 0, sum = 0;
    look_from(scene, 20000, sweep, front);
    look_from(scene, -20000, sweep, back);
    for (int i = 0; i < SIDE * SIDE; i++) {
        double other = back[i / SIDE * SIDE + SIDE - 1 - i % SIDE];
        apart += fabs(front[i] - other);
        sum += 0.5 * (front[i] + other);
    }
    return apart / sum;
}

static void opposite_sides(double x, double *plain, double *ours)
{
    (void)x;
    sample_scene scene = sample_begin(SHAPE_MODEL_SPHEROID, 0.05f);
    scene.set->clouds[0].medium.albedo = 0;
    scene.set->clouds[0].field.noise_scale = 8;
    sample_add(&scene, 0, 0, 0, 20, 20, 20);
    sample_add(&scene, 4, 2, 12, 14, 14, 14);
    sample_finish(&scene);
    *plain = asymmetry(&scene, true);
    *ours = asymmetry(&scene, false);
    sample_end(&scene);
}

#define CLOSEST "from the point of closest approach (Haines et al. 2019)"
#define UNIT "in the space where it is the unit ball, from the closest approach"
#define CHORD "largest error of a chord over the diameter"

static const stability_row rows[] = {
    {"parallel to an axis, on a face or edge of a box", "slabs by division: 0/0",
     "a ray along a slab is in or out by its origin alone", "of 216 rays in the closed box, those that miss",
     0, 0, box_edges, 0},
    {"sphere of 1 m, 10 km from the eye", "b^2 - ac cancels: chords come and go", CLOSEST, CHORD, 0, 0.002,
     far_eye, 1e4},
    {"sphere of 1 m, 1,000 km from the eye", "the same: nothing is left of it",
     CLOSEST ", places to 1/16 m as single precision has them", CHORD, 0, 0.07, far_eye, 1e6},
    {"sphere of 4 mm, 200 km from the world's origin", "world coordinates in single precision",
     "a frame in double precision a cloud", "largest relative error of a chord", 0, 1e-2, far_cloud, 2e5},
    {"the same, 1,000 km from it", "the same", "the same", "largest relative error of a chord", 0, 1e-2,
     far_cloud, 1e6},
    {"grazing a sphere, 1e-4 of the radius inside", "b^2 - ac: the chord is noise, or missed", CLOSEST,
     "relative error of the chord", 0, 0.05, grazing, 1e-4},
    {"needle, 1 : 1 : 10,000", "quadric in world space, b^2 - ac", UNIT, "mean error over the mean chord", 0,
     1e-3, odd_ellipsoid, 1e4},
    {"coin, 10,000 : 10,000 : 1", "the same", UNIT, "mean error over the mean chord", 0, 1e-2, odd_ellipsoid,
     1e-4},
    {"the same cloud from opposite sides",
     "`paper-ndt`: density of the sphere that the sweep is in (Jiménez Algorithm 2)",
     "density depends on the point alone; joined intervals",
     "mean difference of optical depths over their mean", 0, 0.02, opposite_sides, 0},
};

const stability_part stability_rays = {"Rays", rows, sizeof rows / sizeof *rows};
