/* Marched rendering: the union of the clouds' intervals along each ray, cut into panels, each summed by a rule. Steps are
 * fixed or grow geometrically (Páleník 2016 Eq. 3.17) within an interval, whose last step ends where it does, so that no
 * cutting planes appear (Eq. 4.1, 4.2). */
#include "light/march.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "base/memory.h"
#include "light/rows.h"

/* Beyond that depth nothing is seen: 1e-8. */
static const double deep_enough = 18.4;
enum { MAX_PANELS = 100000 };

shape_march_options shape_march_defaults(void)
{
    shape_march_options options;
    memset(&options, 0, sizeof options);
    options.rule = SHAPE_RULE_EXPONENTIAL;
    options.light = SHAPE_MARCH_GRID;
    options.growth = 1;
    options.resolution = 48;
    options.samples = 1;
    options.seed = 1;
    return options;
}

shape_status shape_march_check(const shape_march_options *options, shape_error *error)
{
    const char *wrong = NULL;
    if (options->rule < SHAPE_RULE_RIEMANN_LEFT || options->rule > SHAPE_RULE_EXPONENTIAL)
        wrong = "rule: there is none of that number";
    else if (options->light < SHAPE_MARCH_SINGLE || options->light > SHAPE_MARCH_GRID)
        wrong = "light: there is none of that number";
    else if (!(options->step >= 0 && options->step < 1e9))
        wrong = "step: must be from 0 to 1e9 metres";
    else if (!(options->light_step >= 0 && options->light_step < 1e9))
        wrong = "light_step: must be from 0 to 1e9 metres";
    else if (!(options->growth >= 1 && options->growth <= 2))
        wrong = "growth: must be from 1 to 2";
    else if (options->resolution < 2 || options->resolution > 256)
        wrong = "resolution: must be from 2 to 256";
    else if (options->samples < 1 || options->samples > 4096)
        wrong = "samples: must be from 1 to 4096";
    return wrong ? shape_error_set(error, SHAPE_ERROR_ARGUMENT, "march %s", wrong) : SHAPE_OK;
}

/* The longest side of the world box around all clouds. */
static double longest_side(const shape_volume *volume)
{
    shape_dvec3 low = {INFINITY, INFINITY, INFINITY}, high = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < volume->cloud_count; i++) {
        shape_dvec3 a, b;
        if (shape_box_is_empty(volume->clouds[i].box))
            continue;
        shape_frame_box(&volume->clouds[i].frame, volume->clouds[i].box, &a, &b);
        low = shape_dvec3_make(fmin(low.x, a.x), fmin(low.y, a.y), fmin(low.z, a.z));
        high = shape_dvec3_make(fmax(high.x, b.x), fmax(high.y, b.y), fmax(high.z, b.z));
    }
    double side = fmax(high.x - low.x, fmax(high.y - low.y, high.z - low.z));
    return side > 0 ? side : 1;
}

static shape_status light_cloud(shape_marcher *m, size_t i, shape_dvec3 eye, shape_error *error)
{
    march_cloud *cloud = &m->clouds[i];
    shape_lightgrid_options options = shape_lightgrid_defaults();
    float upper[3], lower[3];
    cloud->cloud = &m->volume->clouds[i];
    if (m->options.light != SHAPE_MARCH_GRID || shape_box_is_empty(cloud->cloud->box))
        return SHAPE_OK;
    options.resolution = m->options.resolution;
    shape_status status = shape_lightgrid_build(m->volume, i, &m->light, &options, &cloud->grid, error);
    if (status)
        return status;
    const int *n = cloud->grid.size;
    cloud->seen = calloc((size_t)n[0] * (size_t)n[1] * (size_t)n[2], 4 * sizeof *cloud->seen);
    if (!cloud->seen)
        return shape_error_memory(error);
    shape_sky_mean(&m->sky, upper, lower);
    shape_lightgrid_seen(&cloud->grid, cloud->cloud, &m->light, upper, lower, eye, cloud->seen);
    return SHAPE_OK;
}

shape_status shape_marcher_create(const shape_volume *volume, const shape_light *light, shape_dvec3 eye,
                                  const shape_march_options *options, shape_marcher **marcher,
                                  shape_error *error)
{
    shape_status status = shape_march_check(options, error);
    if (!status)
        status = shape_light_check(light, error);
    if (status)
        return status;
    shape_marcher *m = calloc(1, sizeof *m);
    if (m)
        m->clouds = calloc(volume->cloud_count + 1, sizeof *m->clouds);
    if (!m || !m->clouds) {
        free(m);
        return shape_error_memory(error);
    }
    float upper[3], lower[3];
    m->volume = volume;
    m->light = *light;
    m->sky = shape_sky_make(light);
    m->options = *options;
    m->step = options->step > 0 ? options->step : longest_side(volume) / 100;
    m->light_step = options->light_step > 0 ? options->light_step : 2 * m->step;
    shape_sky_mean(&m->sky, upper, lower);
    for (int c = 0; c < 3; c++)
        m->ambient[c] = (upper[c] + lower[c]) / 2;
    for (size_t i = 0; i < volume->cloud_count && !status; i++)
        status = light_cloud(m, i, eye, error);
    if (status) {
        shape_marcher_destroy(m);
        return status;
    }
    *marcher = m;
    return SHAPE_OK;
}

void shape_marcher_destroy(shape_marcher *m)
{
    if (!m)
        return;
    for (size_t i = 0; i < m->volume->cloud_count; i++) {
        shape_lightgrid_free(&m->clouds[i].grid);
        free(m->clouds[i].seen);
    }
    free(m->clouds);
    free(m);
}

void shape_march_scratch_free(shape_march_scratch *scratch)
{
    for (size_t i = 0; i < scratch->view_count; i++)
        shape_candidates_free(&scratch->views[i]);
    free(scratch->views);
    free(scratch->edges);
    shape_candidates_free(&scratch->shadow);
    memset(scratch, 0, sizeof *scratch);
}

static shape_status prepare_scratch(shape_march_scratch *scratch, size_t clouds, shape_error *error)
{
    if (scratch->view_count == clouds)
        return SHAPE_OK;
    shape_march_scratch_free(scratch);
    scratch->views = calloc(clouds + 1, sizeof *scratch->views);
    if (!scratch->views)
        return shape_error_memory(error);
    scratch->view_count = clouds;
    return SHAPE_OK;
}

static int compare_edges(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* The joined intervals of all clouds on the ray, as pairs of edges sorted by their start. */
static shape_status find_intervals(march_ray *ray, size_t *count)
{
    shape_march_scratch *scratch = ray->scratch;
    *count = 0;
    for (size_t i = 0; i < scratch->view_count; i++) {
        const shape_volume_cloud *cloud = ray->marcher->clouds[i].cloud;
        shape_ray local = shape_volume_ray(cloud, ray->origin, ray->direction);
        shape_candidates *found = &scratch->views[i];
        float t0 = 0, t1 = INFINITY, a, b;
        found->count = 0;
        if (!shape_box_intersect(cloud->box, local, &t0, &t1))
            continue;
        if (shape_cloud_candidates(cloud, local, t0, t1, found, ray->error))
            return SHAPE_ERROR_MEMORY;
        size_t first, next = 0;
        while (shape_candidates_join(found, t0, t1, &first, &next, &a, &b)) {
            if (shape_array_reserve((void **)&scratch->edges, &scratch->edge_capacity, *count + 2,
                                    sizeof(float), ray->error))
                return SHAPE_ERROR_MEMORY;
            scratch->edges[(*count)++] = a;
            scratch->edges[(*count)++] = b;
        }
    }
    if (scratch->view_count > 1 && *count > 2)
        qsort(scratch->edges, *count / 2, 2 * sizeof(float), compare_edges);
    return SHAPE_OK;
}

/* Marches one interval by panels of equal or growing width that fill it exactly. */
static void march_interval(march_ray *ray, float from, float to)
{
    const shape_march_options *options = &ray->marcher->options;
    double q = options->growth, panel = ray->marcher->step * march_panel_steps(options->rule), length;
    length = (double)to - (double)from;
    double wanted = q > 1 ? log1p(length / panel * (q - 1)) / log(q) : length / panel;
    int panels = (int)fmin(ceil(wanted * (1 - 1e-9)), MAX_PANELS);
    panels = panels < 1 ? 1 : panels;
    double whole = q > 1 ? pow(q, panels) - 1 : panels;
    float a = from;
    for (int i = 1; i <= panels && ray->depth < deep_enough; i++) {
        double share = (q > 1 ? pow(q, i) - 1 : i) / whole;
        float b = i < panels ? (float)((double)from + length * share) : to;
        march_panel(ray, options->rule, a, b);
        a = b;
    }
}

shape_status shape_march_radiance(const shape_marcher *marcher, shape_dvec3 origin, shape_dvec3 direction,
                                  shape_random *random, shape_march_scratch *scratch, double rgb[3],
                                  shape_error *error)
{
    march_ray ray = {marcher, origin, direction, scratch, random, SHAPE_OK, error, 0, {0, 0, 0}};
    size_t count;
    shape_status status = prepare_scratch(scratch, marcher->volume->cloud_count, error);
    if (!status)
        status = find_intervals(&ray, &count);
    if (status)
        return status;
    for (size_t i = 0; i < count;) {
        float from = scratch->edges[i], to = scratch->edges[i + 1];
        for (i += 2; i < count && scratch->edges[i] <= to; i += 2)
            to = fmaxf(to, scratch->edges[i + 1]);
        march_interval(&ray, from, to);
    }
    float sky[3];
    shape_sky_radiance(&marcher->sky,
                       shape_vec3_make((float)direction.x, (float)direction.y, (float)direction.z), sky);
    for (int c = 0; c < 3; c++)
        rgb[c] = ray.rgb[c] + exp(-ray.depth) * (double)sky[c];
    return ray.status;
}

/* The mean of a pixel's rays: through its middle where there is one, else scattered by the R2 sequence (Roberts 2018). */
static shape_status render_pixel(const shape_marcher *m, const shape_view *view, const shape_camera *camera,
                                 int x, int y, shape_march_scratch *scratch, float out[3])
{
    uint64_t index = (uint64_t)y * (uint64_t)view->width + (uint64_t)x;
    double sum[3] = {0, 0, 0}, rgb[3];
    int n = m->options.samples;
    for (int i = 0; i < n; i++) {
        shape_random random = shape_random_seed(shape_hash(m->options.seed) ^ index, (uint64_t)i);
        double u = 0.5 + 0.7548776662466927 * i, v = 0.5 + 0.5698402909980532 * i;
        shape_dvec3 d = shape_camera_direction(camera, view, x + u - floor(u), y + v - floor(v));
        shape_status status = shape_march_radiance(m, camera->origin, d, m->options.jitter ? &random : NULL,
                                                   scratch, rgb, NULL);
        if (status)
            return status;
        for (int c = 0; c < 3; c++)
            sum[c] += rgb[c];
    }
    for (int c = 0; c < 3; c++)
        out[c] = (float)(sum[c] / n);
    return SHAPE_OK;
}

/* A picture being marched. */
typedef struct march_picture {
    const shape_marcher *marcher;
    const shape_view *view;
    shape_camera camera;
    float *radiance;
} march_picture;

static shape_status render_row(void *context, int y)
{
    const march_picture *picture = context;
    float *out = picture->radiance + (size_t)y * (size_t)picture->view->width * 3;
    shape_march_scratch scratch;
    shape_status status = SHAPE_OK;
    memset(&scratch, 0, sizeof scratch);
    for (int x = 0; x < picture->view->width && !status; x++)
        status = render_pixel(picture->marcher, picture->view, &picture->camera, x, y, &scratch, out + 3 * x);
    shape_march_scratch_free(&scratch);
    return status;
}

shape_status shape_march_render(const shape_marcher *m, const shape_view *view, float *radiance,
                                bool *cancelled, shape_error *error)
{
    shape_status status = shape_view_check(view, error);
    if (status)
        return status;
    march_picture picture = {m, view, shape_view_camera(view), radiance};
    rows_progress progress = {m->options.progress, m->options.progress_context, 0, 1};
    bool stopped;
    status = rows_share(view->height, render_row, &picture, &progress, &stopped);
    if (cancelled)
        *cancelled = stopped;
    return status ? shape_error_memory(error) : SHAPE_OK;
}
