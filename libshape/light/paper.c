/* Jiménez 2018 Algorithm 1 with the light of Algorithm 3 (with the step's length, which its line 2 lacks), or with the
 * sweep of Algorithm 2. Mirrored by shaders/view/paper.frag, in single precision like it; what is wrong with the method
 * stays wrong here. */
#include "shape/paper.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "light/rows.h"
#include "shape/lightgrid.h"
#include "shape/phase.h"

static const float transmittance_end = 1e-6f, usual_step = 0.1f, largest = 1e30f;

shape_paper_options shape_paper_defaults(void)
{
    shape_paper_options options;
    memset(&options, 0, sizeof options);
    options.resolution = 40;
    options.samples = 1;
    return options;
}

shape_status shape_paper_check(const shape_paper_options *options, shape_error *error)
{
    if (options->resolution < 2 || options->resolution > 256)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "paper resolution %d: must be from 2 to 256",
                               options->resolution);
    if (options->samples < 1 || options->samples > 4096)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "paper samples %d: must be from 1 to 4096",
                               options->samples);
    return SHAPE_OK;
}

/* A support that the ray meets, and its number, which orders what begins at one place. */
typedef struct paper_candidate {
    shape_candidate hit;
    size_t number;
} paper_candidate;

/* The candidates of one row's rays. */
typedef struct paper_scratch {
    paper_candidate *items;
    size_t count, capacity;
} paper_scratch;

typedef struct paper_picture {
    const shape_volume *volume;
    const shape_view *view;
    const shape_light *light;
    const shape_paper_options *options;
    const shape_lightgrid *grids; /* one a cloud */
    shape_camera camera;
    shape_sky sky;
    float *radiance;
    double *row_steps;
} paper_picture;

typedef struct paper_ray {
    const paper_picture *picture;
    shape_vec3 world; /* direction */
    float transmittance, rgb[3];
    uint64_t steps;
} paper_ray;

/* Every primitive of a hit box is tested, as printed; no tree. */
static shape_status find_candidates(const shape_volume_cloud *cloud, shape_ray ray, paper_scratch *scratch)
{
    const shape_primitives *list = cloud->list;
    scratch->count = 0;
    for (size_t i = 0; i < list->sphere_count + list->ellipsoid_count; i++) {
        paper_candidate found = {{0, 0, 0}, i};
        bool meets = i < list->sphere_count
                         ? shape_sphere_intersect(&list->spheres[i], cloud->support, ray, &found.hit)
                         : shape_ellipsoid_intersect(&list->ellipsoids[i - list->sphere_count],
                                                     cloud->support, ray, &found.hit);
        if (!meets || found.hit.t_out <= 0)
            continue;
        if (shape_array_reserve((void **)&scratch->items, &scratch->capacity, scratch->count + 1,
                                sizeof *scratch->items, NULL))
            return SHAPE_ERROR_MEMORY;
        scratch->items[scratch->count++] = found;
    }
    return SHAPE_OK;
}

static int compare_entries(const void *a, const void *b)
{
    const paper_candidate *x = a, *y = b;
    if (x->hit.t_in != y->hit.t_in)
        return x->hit.t_in > y->hit.t_in ? 1 : -1;
    return (x->number > y->number) - (x->number < y->number);
}

/* Value 0 of the light grid, filtered as a texture is: constant beyond the outermost centres. */
static float received_light(const shape_lightgrid *grid, shape_vec3 p)
{
    const float *at = &p.x, *low = &grid->box.min.x, *high = &grid->box.max.x;
    size_t first[3], next[3];
    float share[3], sum = 0;
    for (int a = 0; a < 3; a++) {
        float x = (at[a] - low[a]) / (high[a] - low[a]) * (float)grid->size[a];
        x = fminf(fmaxf(x, 0.5f), (float)grid->size[a] - 0.5f) - 0.5f;
        first[a] = (size_t)x;
        next[a] = first[a] + 1 < (size_t)grid->size[a] ? first[a] + 1 : first[a];
        share[a] = x - (float)first[a];
    }
    for (int k = 0; k < 8; k++) {
        size_t x = k & 1 ? next[0] : first[0], y = k & 2 ? next[1] : first[1], z = k & 4 ? next[2] : first[2];
        size_t cell = (z * (size_t)grid->size[1] + y) * (size_t)grid->size[0] + x;
        sum += (k & 1 ? share[0] : 1 - share[0]) * (k & 2 ? share[1] : 1 - share[1]) *
               (k & 4 ? share[2] : 1 - share[2]) * grid->cells[cell * SHAPE_LIGHTGRID_VALUES];
    }
    return sum;
}

/* Algorithm 3 and Eq. 13: reflected and scattered light of one step. */
static void add_light(paper_ray *ray, const shape_volume_cloud *cloud, float rho, shape_vec3 p, float width)
{
    const paper_picture *picture = ray->picture;
    const shape_medium *medium = &cloud->medium;
    float received = received_light(&picture->grids[cloud - picture->volume->clouds], p);
    float passed = expf(-medium->extinction * rho * width);
    float cosine = ray->world.x * (float)picture->light->sun.x + ray->world.y * (float)picture->light->sun.y +
                   ray->world.z * (float)picture->light->sun.z;
    float light = 0.31830988618f * medium->albedo * received * (1 + shape_phase(medium, cosine));
    for (int c = 0; c < 3; c++)
        ray->rgb[c] += (1 - passed) * ray->transmittance * light * picture->light->sun_irradiance[c];
    ray->transmittance *= passed;
}

/* As printed: A exp(-|eye - centre| delta), which makes shorter steps far away; A = 0.1, delta = 0.01. Held above
 * 0.005. */
static float step_length(const paper_picture *picture, const shape_volume_cloud *cloud, shape_ray ray)
{
    if (!picture->options->lod)
        return usual_step;
    shape_vec3 middle = shape_vec3_scale(shape_vec3_add(cloud->box.min, cloud->box.max), 0.5f);
    return fmaxf(0.1f * expf(-shape_vec3_length(shape_vec3_sub(ray.origin, middle)) * 0.01f), 0.005f);
}

/* From its own entry to its own exit, with its own gamma; the sweep goes on from *t. */
static void march_candidate(paper_ray *ray, const shape_volume_cloud *cloud, shape_ray local,
                            const shape_candidate *c, float *t)
{
    const shape_paper_options *options = ray->picture->options;
    float width = step_length(ray->picture, cloud, local), support2 = cloud->support * cloud->support;
    float kappa = cloud->field.kappa;
    if (!options->sweep)
        *t = fmaxf(c->t_in, 0);
    else if (*t > c->t_out)
        return;
    else
        *t = fmaxf(*t, c->t_in);
    while (*t <= c->t_out && ray->transmittance >= transmittance_end) {
        shape_vec3 p = shape_vec3_add(local.origin, shape_vec3_scale(local.direction, *t));
        float rho = shape_noise_fbm(cloud->noise, cloud->offsets, cloud->field.octaves,
                                    shape_vec3_scale(p, cloud->inverse_noise_scale));
        float u = sqrtf(fmaxf(support2 + c->a * (*t - c->t_in) * (*t - c->t_out), 0));
        float gamma = expf(-u / fmaxf((1 - kappa) + 2 * kappa * rho, 1e-6f));
        ray->steps++;
        if (cloud->field.model == SHAPE_MODEL_UNIFORM)
            add_light(ray, cloud, 1, p, width);
        else if (rho < gamma)
            add_light(ray, cloud, rho, p, width);
        *t += fmaxf(width, 1e-6f * *t); /* below that a step would stand still */
    }
}

static shape_status trace_ray(const paper_picture *picture, shape_dvec3 direction, paper_scratch *scratch,
                              paper_ray *ray)
{
    memset(ray, 0, sizeof *ray);
    ray->picture = picture;
    ray->world = shape_vec3_make((float)direction.x, (float)direction.y, (float)direction.z);
    ray->transmittance = 1;
    for (size_t i = 0; i < picture->volume->cloud_count && ray->transmittance >= transmittance_end; i++) {
        const shape_volume_cloud *cloud = &picture->volume->clouds[i];
        shape_ray local = shape_volume_ray(cloud, picture->camera.origin, direction);
        float t0 = 0, t1 = largest, t = 0;
        if (!shape_box_intersect(cloud->box, local, &t0, &t1))
            continue;
        if (find_candidates(cloud, local, scratch))
            return SHAPE_ERROR_MEMORY;
        if (scratch->count > 1)
            qsort(scratch->items, scratch->count, sizeof *scratch->items, compare_entries);
        for (size_t k = 0; k < scratch->count && ray->transmittance >= transmittance_end; k++)
            march_candidate(ray, cloud, local, &scratch->items[k].hit, &t);
    }
    float sky[3];
    shape_sky_radiance(&picture->sky, ray->world, sky);
    for (int c = 0; c < 3; c++)
        ray->rgb[c] += ray->transmittance * sky[c];
    return SHAPE_OK;
}

static shape_status render_row(void *context, int y)
{
    const paper_picture *picture = context;
    const shape_view *view = picture->view;
    paper_scratch scratch = {NULL, 0, 0};
    shape_status status = SHAPE_OK;
    int n = picture->options->samples;
    for (int x = 0; x < view->width && !status; x++) {
        float *out = picture->radiance + 3 * ((size_t)y * (size_t)view->width + (size_t)x);
        double sum[3] = {0, 0, 0};
        for (int i = 0; i < n && !status; i++) {
            paper_ray ray;
            /* The R2 sequence (Roberts 2018), from the pixel's middle; the shader counts from below. */
            double u = 0.5 + 0.7548776662466927 * i, v = 0.5 + 0.5698402909980532 * i;
            status = trace_ray(
                picture,
                shape_camera_direction(&picture->camera, view, x + u - floor(u), y + 1 - (v - floor(v))),
                &scratch, &ray);
            for (int c = 0; c < 3; c++)
                sum[c] += (double)ray.rgb[c];
            picture->row_steps[y] += (double)ray.steps;
        }
        for (int c = 0; c < 3; c++)
            out[c] = (float)(sum[c] / n);
    }
    free(scratch.items);
    return status;
}

/* The light grids of all clouds; the caller frees what is there, also after an error. */
static shape_status light_clouds(const shape_volume *volume, const shape_light *light, int resolution,
                                 shape_lightgrid *grids, shape_error *error)
{
    shape_status status = SHAPE_OK;
    for (size_t i = 0; i < volume->cloud_count && !status; i++)
        status = shape_lightgrid_build_2018(volume, i, light, resolution, usual_step, &grids[i], error);
    return status;
}

static shape_status render(paper_picture *picture, double *steps, bool *cancelled, shape_error *error)
{
    const shape_view *view = picture->view;
    rows_progress progress = {picture->options->progress, picture->options->progress_context, 0, 1};
    bool stopped = false;
    shape_status status = rows_share(view->height, render_row, picture, &progress, &stopped);
    double sum = 0;
    for (int y = 0; y < view->height; y++)
        sum += picture->row_steps[y];
    if (steps)
        *steps = sum / ((double)view->width * view->height * picture->options->samples);
    if (cancelled)
        *cancelled = stopped;
    return status ? shape_error_memory(error) : SHAPE_OK;
}

shape_status shape_paper_render(const shape_volume *volume, const shape_view *view, const shape_light *light,
                                const shape_paper_options *options, float *radiance, double *steps,
                                bool *cancelled, shape_error *error)
{
    shape_status status = shape_paper_check(options, error);
    if (!status)
        status = shape_view_check(view, error);
    if (!status)
        status = shape_light_check(light, error);
    if (status)
        return status;
    for (size_t i = 0; i < volume->cloud_count; i++)
        if (volume->clouds[i].field.model == SHAPE_MODEL_GRID)
            return shape_error_set(
                error, SHAPE_ERROR_ARGUMENT,
                "the paper's methods draw primitives, not voxel grids (choose another --method)");
    shape_lightgrid *grids = calloc(volume->cloud_count + 1, sizeof *grids);
    paper_picture picture = {volume,
                             view,
                             light,
                             options,
                             grids,
                             shape_view_camera(view),
                             shape_sky_make(light),
                             radiance,
                             calloc((size_t)view->height, sizeof(double))};
    if (!grids || !picture.row_steps)
        status = shape_error_memory(error);
    if (!status)
        status = light_clouds(volume, light, options->resolution, grids, error);
    if (!status)
        status = render(&picture, steps, cancelled, error);
    for (size_t i = 0; grids && i < volume->cloud_count; i++)
        shape_lightgrid_free(&grids[i]);
    free(grids);
    free(picture.row_steps);
    return status;
}
