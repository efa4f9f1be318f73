/* Where the eye stands, and in what unit the scene is: inside a primitive, at its centre, at the light grid's border, in
 * clouds of micrometres and of thousands of kilometres. */
#include "light/march.h"
#include "row.h"
#include "shape/paper.h"

/* --- the eye inside --- */

/* The depth to the rim over what it is; plain: from entry to exit, the entry behind the eye. */
static void eye_inside(double z, double *plain, double *ours)
{
    const double sigma = 0.7, radius = 2;
    sample_scene scene = stability_ball(radius, sigma, 0);
    shape_light light = stability_white_sky();
    shape_march_options options = shape_march_defaults();
    shape_dvec3 eye = {0, 0, z}, d = {0, 0, -1};
    shape_candidate hit = {0, 0, 0};
    shape_ray ray = shape_volume_ray(&scene.volume->clouds[0], eye, d);
    shape_sphere_intersect(&scene.set->lists[0].spheres[0], 1, ray, &hit);
    options.light = SHAPE_MARCH_SINGLE;
    *plain = (double)(hit.t_out - hit.t_in) / (z + radius);
    *ours = -log(stability_look(&scene, &light, &options, eye, d)) / (sigma * (z + radius));
    sample_end(&scene);
}

/* The least of the three channels of a picture taken from the centre of a spheroid, with the default light; plain: the
 * direction from the centre, as a shading normal needs it. */
static void eye_at_centre(double x, double *plain, double *ours)
{
    enum { W = 8, H = 6 };
    sample_scene scene = sample_cumulus(1, 5);
    const shape_sphere *s = &scene.set->lists[0].spheres[0];
    shape_light light = shape_light_defaults();
    shape_view view = shape_view_defaults();
    shape_march_options options = shape_march_defaults();
    shape_marcher *marcher;
    shape_error error;
    float radiance[3 * W * H];
    (void)x;
    view.width = W, view.height = H;
    view.eye = shape_dvec3_make(s->x, s->y, s->z);
    view.target = shape_dvec3_make(s->x, s->y, s->z - 1);
    options.resolution = 12;
    stability_must(shape_marcher_create(scene.volume, &light, view.eye, &options, &marcher, &error), &error);
    stability_must(shape_march_render(marcher, &view, radiance, NULL, &error), &error);
    *ours = INFINITY;
    for (int i = 0; i < 3 * W * H; i++)
        *ours = isfinite(radiance[i]) ? fmin(*ours, (double)radiance[i]) : NAN;
    shape_vec3 away = {s->x - (float)view.eye.x, s->y - (float)view.eye.y, s->z - (float)view.eye.z};
    *plain = (double)(away.x / shape_vec3_length(away));
    shape_marcher_destroy(marcher);
    sample_end(&scene);
}

/* --- the light grid's border --- */

/* The cells' line through the outermost two centres, carried on to p. */
static double extrapolated(const shape_lightgrid *grid, shape_vec3 p)
{
    const float *at = &p.x, *low = &grid->box.min.x, *high = &grid->box.max.x;
    double sum = 0, share[3];
    int first[3];
    for (int a = 0; a < 3; a++) {
        double x = (double)((at[a] - low[a]) / (high[a] - low[a])) * grid->size[a] - 0.5;
        first[a] = (int)fmin(fmax(floor(x), 0), grid->size[a] - 2);
        share[a] = x - first[a];
    }
    for (int k = 0; k < 8; k++) {
        int cell[3];
        double weight = 1;
        for (int a = 0; a < 3; a++) {
            cell[a] = first[a] + (k >> a & 1);
            weight *= k >> a & 1 ? share[a] : 1 - share[a];
        }
        size_t index = ((size_t)cell[2] * (size_t)grid->size[1] + (size_t)cell[1]) * (size_t)grid->size[0] +
                       (size_t)cell[0];
        sum += weight * (double)grid->cells[index * SHAPE_LIGHTGRID_VALUES];
    }
    return sum;
}

/* The largest share of sunlight, exp(-depth), at points on and outside the grid's faces. */
static void grid_border(double x, double *plain, double *ours)
{
    (void)x;
    sample_scene scene = stability_ball(2, 20, 1);
    shape_light light = shape_light_defaults();
    shape_lightgrid_options options = shape_lightgrid_defaults();
    shape_lightgrid grid;
    shape_error error;
    options.resolution = 8;
    options.scattering = false;
    light.sun = shape_dvec3_make(0, 1, 0);
    stability_must(shape_lightgrid_build(scene.volume, 0, &light, &options, &grid, &error), &error);
    *plain = *ours = 0;
    for (int i = 0; i < 20 * 20 * 20; i++) {
        shape_vec3 p = {(float)(i % 20) * 0.4f - 3.8f, (float)(i / 20 % 20) * 0.4f - 3.8f,
                        (float)(i / 400) * 0.4f - 3.8f};
        *plain = fmax(*plain, exp(-extrapolated(&grid, p)));
        *ours = fmax(*ours, exp(-march_grid_value(&grid, grid.cells, SHAPE_LIGHTGRID_VALUES, 0, p)));
    }
    shape_lightgrid_free(&grid);
    sample_end(&scene);
}

/* --- the scene's unit --- */

/* Optical depth through the middle of a ball of optical diameter 2, over 2: `paper` with its steps of 0.1 m against the
 * default steps. */
static void scene_unit(double radius, double *plain, double *ours)
{
    sample_scene scene = stability_ball(radius, 1 / radius, 0);
    shape_light light = stability_white_sky();
    shape_march_options options = shape_march_defaults();
    shape_paper_options paper = shape_paper_defaults();
    shape_view view = shape_view_defaults();
    shape_error error;
    float rgb[3];
    view.width = view.height = 1;
    view.fov = 0.01;
    view.eye = shape_dvec3_make(0, 0, 5 * radius);
    paper.resolution = 2;
    stability_must(shape_paper_render(scene.volume, &view, &light, &paper, rgb, NULL, NULL, &error), &error);
    *plain = rgb[0] > 0 ? -log((double)rgb[0]) / 2 : INFINITY;
    options.light = SHAPE_MARCH_SINGLE;
    *ours = -log(stability_look(&scene, &light, &options, view.eye, shape_dvec3_make(0, 0, -1))) / 2;
    sample_end(&scene);
}

/* The same by t += 0.1f for at most a million steps. */
static void huge_unit(double radius, double *plain, double *ours)
{
    float t = (float)(4 * radius), end = (float)(6 * radius), sum = 0, sigma = (float)(1 / radius);
    for (int k = 0; k < 1000000 && t < end; k++) {
        t += 0.1f;
        sum += 0.1f * sigma;
    }
    *plain = (double)sum / 2;
    sample_scene scene = stability_ball(radius, 1 / radius, 0);
    shape_light light = stability_white_sky();
    shape_march_options options = shape_march_defaults();
    options.light = SHAPE_MARCH_SINGLE;
    *ours = -log(stability_look(&scene, &light, &options, shape_dvec3_make(0, 0, 5 * radius),
                                shape_dvec3_make(0, 0, -1))) /
            2;
    sample_end(&scene);
}

#define RATIO "optical depth over the truth"

static const stability_row rows[] = {
    {"eye inside a primitive", "marched from its entry, behind the eye", "intervals are cut at the eye",
     RATIO, 0.999, 1.001, eye_inside, 1},
    {"eye at a primitive's centre", "the direction from the centre is 0/0",
     "u alone is used, never a direction from a centre", "least value of a picture from there", 0, 1e9,
     eye_at_centre, 0},
    {"light grid's border", "trilinear weights carried on outwards: more light than the sun's",
     "constant beyond the outermost centres, and a cell of clear air all round", "largest share of sunlight",
     0, 1, grid_border, 0},
    {"cloud of 0.1 mm", "steps of 0.1 m", "steps from the cloud's own size", RATIO, 0.999, 1.001, scene_unit,
     5e-5},
    {"cloud of 2,000 km", "steps of 0.1 m by adding: a million do not cross it", "the same", RATIO, 0.999,
     1.001, huge_unit, 1e6},
};

const stability_part stability_places = {"Places and units", rows, sizeof rows / sizeof *rows};
