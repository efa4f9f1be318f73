/* Marched rendering: the union of the clouds' intervals along each ray, cut into panels, each summed by a rule. Steps are
 * fixed, grow geometrically (Páleník 2016 Eq. 3.17) or with the distance (section 3.4), and fill an interval exactly, so
 * that no cutting planes appear (chapter 4 there). */
#include "light/march.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "light/rows.h"
#include "primitive/grid_look.h"

enum { MAX_PANELS = 100000 };

/* --- options --- */

shape_march_options shape_march_defaults(void)
{
    shape_march_options options;
    memset(&options, 0, sizeof options);
    options.rule = SHAPE_RULE_EXPONENTIAL;
    options.light = SHAPE_MARCH_GRID;
    options.growth = 1.02;
    options.share = 0.01;
    options.resolution = 48;
    options.samples = 1;
    options.powder = 2;
    options.octaves = SHAPE_MARCH_OCTAVES_MAX;
    options.shade = 1;
    options.forward = 0.5;
    options.cutoff = 1e-8;
    options.alpha_power = 1;
    options.seed = 1;
    return options;
}

static const char *find_wrong_choice(const shape_march_options *o)
{
    if (o->rule < SHAPE_RULE_RIEMANN_LEFT || o->rule > SHAPE_RULE_EXPONENTIAL)
        return "rule: there is none of that number";
    if (o->light < SHAPE_MARCH_SINGLE || o->light > SHAPE_MARCH_GRID)
        return "light: there is none of that number";
    if (o->shadow < SHAPE_SHADOW_MARCH || o->shadow > SHAPE_SHADOW_GRID)
        return "shadow: there is none of that number";
    if (o->stepping < SHAPE_STEP_FIXED || o->stepping > SHAPE_STEP_EXPONENTIAL)
        return "stepping: there is none of that number";
    if (o->jitter < SHAPE_JITTER_NONE || o->jitter > SHAPE_JITTER_BLUE)
        return "jitter: there is none of that number";
    if (o->end < SHAPE_END_CUT || o->end > SHAPE_END_ADAPT)
        return "end: there is none of that number";
    if (o->silver && (o->light == SHAPE_MARCH_GRID || o->light == SHAPE_MARCH_OCTAVES))
        return "silver: the lights grid and octaves have a phase function of their own";
    if (shape_lamp_shines(&o->lamp) && !shape_march_takes_lamp(o->light, o->shadow))
        return "lamp: light and shadow grids and two passes know the sun alone (choose another light or "
               "shadow)";
    return NULL;
}

static const char *find_wrong_number(const shape_march_options *o)
{
    if (!(o->step >= 0 && o->step < 1e9))
        return "step: must be from 0 to 1e9 metres";
    if (!(o->light_step >= 0 && o->light_step < 1e9))
        return "light_step: must be from 0 to 1e9 metres";
    if (!(o->growth >= 1 && o->growth <= 2))
        return "growth: must be from 1 to 2";
    if (!(o->share > 0 && o->share <= 1))
        return "share: must be above 0 and at most 1";
    if (o->resolution < 2 || o->resolution > 256)
        return "resolution: must be from 2 to 256";
    if (o->samples < 1 || o->samples > 4096)
        return "samples: must be from 1 to 4096";
    if (!(o->powder >= 0 && o->powder <= 1000))
        return "powder: must be from 0 to 1000";
    if (!(o->shade >= 0 && o->shade <= 1))
        return "shade: must be from 0 to 1";
    if (!(o->forward >= 0 && o->forward <= 1))
        return "forward: must be from 0 to 1";
    if (o->octaves < 1 || o->octaves > SHAPE_MARCH_OCTAVES_MAX)
        return "octaves: must be from 1 to 8";
    for (int c = 0; c < 3; c++)
        if (!(o->emission[c] >= 0 && o->emission[c] <= 1e9f))
            return "emission: must be from 0 to 1e9";
    for (int c = 0; c < 3; c++)
        if (!(o->ambient[c] >= 0 && o->ambient[c] <= 1e9f))
            return "ambient: must be from 0 to 1e9";
    if (!(o->lock >= 0 && o->lock <= 1e9))
        return "lock: must be from 0 to 1e9 points a metre";
    if (!(o->cutoff >= 1e-12 && o->cutoff <= 0.1))
        return "cutoff: must be from 1e-12 to 0.1";
    if (!(o->alpha_power >= 0.01 && o->alpha_power <= 100))
        return "alpha_power: must be from 0.01 to 100";
    if (!(o->alpha_peel >= 0 && o->alpha_peel <= 1))
        return "alpha_peel: must be from 0 to 1";
    return NULL;
}

shape_status shape_march_check(const shape_march_options *options, shape_error *error)
{
    const char *wrong = find_wrong_choice(options);
    if (!wrong)
        wrong = find_wrong_number(options);
    return wrong ? shape_error_set(error, SHAPE_ERROR_ARGUMENT, "march %s", wrong)
                 : shape_lamp_check(&options->lamp, error);
}

bool shape_march_takes_lamp(shape_march_light light, shape_march_shadow shadow)
{
    return light == SHAPE_MARCH_HARRIS || (march_needs_depth(light) && shadow != SHAPE_SHADOW_GRID);
}

/* --- a marcher --- */

/* The world box around all clouds. */
static void find_box(shape_marcher *m)
{
    m->low = shape_dvec3_make(INFINITY, INFINITY, INFINITY);
    m->high = shape_dvec3_scale(m->low, -1);
    for (size_t i = 0; i < m->volume->cloud_count; i++) {
        const shape_volume_cloud *cloud = &m->volume->clouds[i];
        shape_dvec3 a, b;
        if (shape_box_is_empty(cloud->box))
            continue;
        shape_frame_box(&cloud->frame, cloud->box, &a, &b);
        m->low = shape_dvec3_make(fmin(m->low.x, a.x), fmin(m->low.y, a.y), fmin(m->low.z, a.z));
        m->high = shape_dvec3_make(fmax(m->high.x, b.x), fmax(m->high.y, b.y), fmax(m->high.z, b.z));
    }
    if (!(m->low.x <= m->high.x))
        m->low = m->high = shape_dvec3_make(0, 0, 0);
}

static void choose_steps(shape_marcher *m)
{
    shape_dvec3 side = shape_dvec3_sub(m->high, m->low);
    double longest = fmax(side.x, fmax(side.y, side.z));
    longest = longest > 0 ? longest : 1;
    m->step = m->options.step > 0 ? m->options.step : longest / 100;
    m->light_step = m->options.light_step > 0 ? m->options.light_step : 2 * m->step;
    m->deep = -log(m->options.cutoff);
    if (m->volume->cloud_count == 1 && m->volume->clouds[0].field.model == SHAPE_MODEL_GRID &&
        !(m->options.lock > 0))
        m->voxels = m->volume->clouds[0].list->grid;
}

/* The grid that the options' light looks up, if any. */
static shape_status build_grid(shape_marcher *m, size_t i, int channel, shape_lightgrid *grid,
                               shape_error *error)
{
    shape_lightgrid_options options = shape_lightgrid_defaults();
    options.channel = channel;
    options.resolution = m->options.resolutions ? m->options.resolutions[i] : m->options.resolution;
    options.opaque = m->options.opaque;
    if (m->options.light == SHAPE_MARCH_GRID)
        return shape_lightgrid_build(m->volume, i, &m->light, &options, grid, error);
    if (m->options.light == SHAPE_MARCH_TWO_PASS)
        return shape_lightgrid_build_2018(m->volume, i, &m->light, options.resolution, (float)m->light_step,
                                          grid, error);
    if (m->options.shadow != SHAPE_SHADOW_GRID || !march_needs_depth(m->options.light))
        return SHAPE_OK;
    options.scattering = false;
    options.opaque = NULL; /* asked at the point itself */
    return shape_lightgrid_build(m->volume, i, &m->light, &options, grid, error);
}

/* A coloured cloud's light is solved once a channel, and each is taken from its own solution. */
static shape_status light_channels(shape_marcher *m, size_t i, shape_dvec3 eye, shape_error *error)
{
    march_cloud *cloud = &m->clouds[i];
    size_t cells = 0;
    for (int c = 0; c < 3; c++) {
        shape_lightgrid_free(&cloud->grid);
        shape_status status = build_grid(m, i, c, &cloud->grid, error);
        const int *n = cloud->grid.size;
        if (status)
            return status;
        cells = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
        m->work->cells += cells;
        m->work->visits += cloud->grid.visits;
        float *seen = calloc(cells, MARCH_SEEN * sizeof *seen);
        if (!cloud->seen)
            cloud->seen = calloc(cells, MARCH_SEEN_COLOURED * sizeof *seen);
        if (!seen || !cloud->seen) {
            free(seen);
            return shape_error_memory(error);
        }
        status = shape_lightgrid_seen(&cloud->grid, cloud->cloud, &m->light, &m->sky, m->upper, m->lower, eye,
                                      seen, error);
        for (size_t k = 0; k < cells; k++) {
            float *to = cloud->seen + MARCH_SEEN_COLOURED * k;
            to[c] = seen[MARCH_SEEN * k + (size_t)c];
            to[3 + c] = seen[MARCH_SEEN * k + 3];
        }
        free(seen);
        if (status)
            return status;
    }
    return SHAPE_OK;
}

static shape_status light_cloud(shape_marcher *m, size_t i, shape_dvec3 eye, shape_error *error)
{
    march_cloud *cloud = &m->clouds[i];
    cloud->cloud = &m->volume->clouds[i];
    cloud->peak = shape_beam_peak_make(&cloud->cloud->medium);
    cloud->hidden = m->options.resolutions && m->options.resolutions[i] == 0;
    shape_dvec3 sun = shape_frame_direction(&cloud->cloud->inverse, m->light.sun);
    if (cloud->cloud->field.model == SHAPE_MODEL_GRID)
        cloud->sun = grid_way_make(cloud->cloud->list->grid,
                                   shape_vec3_make((float)sun.x, (float)sun.y, (float)sun.z));
    if (cloud->hidden || shape_box_is_empty(cloud->cloud->box))
        return SHAPE_OK;
    if (m->options.light == SHAPE_MARCH_GRID && shape_cloud_is_coloured(cloud->cloud))
        return light_channels(m, i, eye, error);
    shape_status status = build_grid(m, i, -1, &cloud->grid, error);
    const int *n = cloud->grid.size;
    m->work->cells += (uint64_t)n[0] * (uint64_t)n[1] * (uint64_t)n[2];
    m->work->visits += cloud->grid.visits;
    if (status || m->options.light != SHAPE_MARCH_GRID)
        return status;
    cloud->seen = calloc((size_t)n[0] * (size_t)n[1] * (size_t)n[2], MARCH_SEEN * sizeof *cloud->seen);
    if (!cloud->seen)
        return shape_error_memory(error);
    for (int axis = 0; axis < 3; axis++)
        (&cloud->cells.x)[axis] =
            (float)n[axis] / ((&cloud->grid.box.max.x)[axis] - (&cloud->grid.box.min.x)[axis]);
    return shape_lightgrid_seen(&cloud->grid, cloud->cloud, &m->light, &m->sky, m->upper, m->lower, eye,
                                cloud->seen, error);
}

static shape_status make_blue(shape_marcher *m, shape_error *error)
{
    if (m->options.jitter != SHAPE_JITTER_BLUE && !m->has_air)
        return SHAPE_OK;
    m->blue = malloc(BLUENOISE_COUNT * sizeof *m->blue);
    return m->blue ? bluenoise_make(m->options.seed, m->blue, error) : shape_error_memory(error);
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
    if (!m)
        return shape_error_memory(error);
    m->volume = volume;
    m->clouds = calloc(volume->cloud_count + 1, sizeof *m->clouds);
    m->work = calloc(1, sizeof *m->work);
    if (!m->clouds || !m->work) {
        free(m->clouds);
        free(m->work);
        free(m);
        return shape_error_memory(error);
    }
    m->light = *light;
    m->sky = shape_sky_make(light);
    m->options = *options;
    for (int c = 0; c < 3; c++)
        m->has_sun = m->has_sun || light->sun_irradiance[c] > 0;
    m->has_lamp = shape_lamp_shines(&options->lamp);
    m->has_air = shape_air_is(&light->air);
    if (m->has_air)
        shape_air_mean(&m->sky, m->sky_mean);
    find_box(m);
    choose_steps(m);
    shape_sky_mean(&m->sky, m->upper, m->lower);
    status = make_blue(m, error);
    for (size_t i = 0; i < volume->cloud_count && !status; i++)
        if (options->light == SHAPE_MARCH_HARRIS && shape_cloud_is_coloured(&volume->clouds[i]))
            status =
                shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                                "march light: Harris' recurrence has no colours (choose another light, or "
                                "leave the grid's colour out)");
    for (size_t i = 0; i < volume->cloud_count && !status; i++)
        status = light_cloud(m, i, eye, error);
    m->options.resolutions = NULL;
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
    free(m->work);
    free(m->blue);
    free(m);
}

shape_march_work shape_marcher_work(const shape_marcher *m)
{
    return *m->work;
}

void shape_march_scratch_free(shape_march_scratch *scratch)
{
    march_path_free(&scratch->view);
    march_path_free(&scratch->sun);
    shape_candidates_free(&scratch->shadow);
    free(scratch->air);
    memset(scratch, 0, sizeof *scratch);
}

/* --- a ray --- */

/* An interval cut into panels: where panel x ends, for a real x from 0 to `panels`. */
typedef struct panels {
    shape_march_stepping stepping;
    double from, length, growth, count;
} panels;

/* z_k = (1 + h)^k z_0, with h made so that whole panels fill the interval (Páleník 2016 Eq. 3.16). */
static panels cut_exponentially(double from, double to, double share)
{
    panels p = {SHAPE_STEP_EXPONENTIAL, from, to - from, 1, 1};
    p.count = fmin(fmax(ceil(log(to / from) / log1p(share) * (1 - 1e-9)), 1), MAX_PANELS);
    p.growth = pow(to / from, 1 / p.count);
    return p;
}

/* Equal panels, or growing ones whose first is made to fit (Eq. 4.2). */
static panels cut_by_growth(double from, double to, double panel, double q)
{
    panels p = {q > 1 ? SHAPE_STEP_GEOMETRIC : SHAPE_STEP_FIXED, from, to - from, q, 1};
    double wanted = q > 1 ? log1p(p.length / panel * (q - 1)) / log(q) : p.length / panel;
    p.count = fmin(fmax(ceil(wanted * (1 - 1e-9)), 1), MAX_PANELS);
    return p;
}

static double panel_end(const panels *p, double x)
{
    if (x >= p->count)
        return p->from + p->length;
    if (p->stepping == SHAPE_STEP_EXPONENTIAL)
        return p->from * pow(p->growth, x);
    double share = p->stepping == SHAPE_STEP_GEOMETRIC
                       ? (pow(p->growth, x) - 1) / (pow(p->growth, p->count) - 1)
                       : x / p->count;
    return p->from + p->length * share;
}

static inline bool is_empty(const shape_grid *grid, const shape_ray *ray, float t)
{
    unsigned cell[3];
    return !grid_find(grid, ray->origin.x + ray->direction.x * t, ray->origin.y + ray->direction.y * t,
                      ray->origin.z + ray->direction.z * t, cell);
}

/* Marches the panels up to `end`, where something opaque stands. */
static void march_panels(march_ray *ray, const panels *p, float end)
{
    shape_rule rule = ray->marcher->options.rule;
    const shape_grid *voxels = rule == SHAPE_RULE_EXPONENTIAL ? ray->marcher->voxels : NULL;
    shape_ray local = ray->scratch->view.rays[0];
    float a = (float)p->from;
    /* A step that begins later makes the first one shorter and adds one. */
    for (double x = ray->first; ray->depth < ray->marcher->deep && a < end; x++) {
        float b = fminf((float)panel_end(p, x), end);
        march_air_knot(ray, (double)a);
        /* Most steps by voxels are seen where there is nothing. */
        if (b > a && !(voxels && is_empty(voxels, &local, a + (b - a) * 0.5f)))
            march_panel(ray, rule, a, b);
        march_air_knot(ray, (double)b);
        a = b;
        if (x >= p->count)
            break;
    }
}

/* From the ray to the grid of points that starts are locked to: the shift of the interval's first point. */
static shape_dvec3 lock_shift(const march_ray *ray, float from)
{
    double f = ray->marcher->options.lock;
    shape_dvec3 p = shape_dvec3_add(ray->origin, shape_dvec3_scale(ray->direction, (double)from));
    shape_dvec3 q = shape_dvec3_make(floor(p.x * f) / f, floor(p.y * f) / f, floor(p.z * f) / f);
    return shape_dvec3_sub(q, p);
}

/* Marches one interval by panels that fill it exactly. */
static void march_interval(march_ray *ray, float from, float to, float end)
{
    const shape_marcher *m = ray->marcher;
    const shape_march_options *o = &m->options;
    int steps = march_panel_steps(o->rule);
    if (o->end == SHAPE_END_ADAPT)
        to = fminf(to, end);
    if (o->lock > 0)
        ray->shift = lock_shift(ray, from);
    if (o->stepping == SHAPE_STEP_EXPONENTIAL) {
        /* Near the eye steps would shrink to nothing: one does. */
        float near = fminf(to, fmaxf((float)(m->step * steps), 1e-6f * to));
        if (from < near) {
            march_panels(ray, &(panels){SHAPE_STEP_FIXED, (double)from, (double)(near - from), 1, 1}, end);
            from = near;
        }
        panels p = cut_exponentially((double)from, (double)to, pow(1 + o->share, steps) - 1);
        if (from < to)
            march_panels(ray, &p, end);
        return;
    }
    panels p = cut_by_growth((double)from, (double)to, m->step * steps,
                             o->stepping == SHAPE_STEP_GEOMETRIC ? o->growth : 1);
    march_panels(ray, &p, end);
}

/* Coverage raised to a power, and none where there is little (Páleník 2016 section 5.1). */
static double correct_alpha(const shape_march_options *o, double alpha)
{
    return alpha < o->alpha_peel ? 0 : o->alpha_power == 1 ? alpha : pow(alpha, o->alpha_power);
}

shape_status shape_march_radiance(const shape_marcher *marcher, shape_dvec3 origin, shape_dvec3 direction,
                                  double start, shape_march_scratch *scratch, double rgb[3],
                                  shape_error *error)
{
    march_ray ray = {.marcher = marcher,
                     .origin = origin,
                     .direction = direction,
                     .scratch = scratch,
                     .first = 1 - start,
                     .status = SHAPE_OK,
                     .error = error};
    size_t count;
    shape_opaque_hit hit;
    shape_status status = march_path_find(marcher, &scratch->view, origin, direction, false, &count, error);
    if (status)
        return status;
    bool met = marcher->options.opaque &&
               shape_opaque_find(marcher->options.opaque, origin, direction, INFINITY, &hit);
    /* A few roundings before the surface (Páleník's bias b), or a sample at the end could lie behind it, in its shadow. */
    float end = met ? (float)(hit.t * (1 - 2.5e-7)) : INFINITY;
    scratch->air_count = 0;
    if (marcher->has_air)
        ray.air = shape_air_along(&marcher->light, &marcher->sky, marcher->sky_mean, origin, direction);
    for (size_t i = 0; i < count && scratch->view.edges[i] < end; i += 2)
        march_interval(&ray, scratch->view.edges[i], scratch->view.edges[i + 1], end);
    double behind[3] = {0, 0, 0}, left = exp(-ray.depth);
    double alpha = correct_alpha(&marcher->options, 1 - left), gain = 1;
    if (alpha != 1 - left) {
        gain = left < 1 ? alpha / -expm1(-ray.depth) : 0;
        left = 1 - alpha;
    }
    if (left > 0)
        march_background(&ray, met ? &hit : NULL, behind);
    double airlight[3] = {0, 0, 0};
    if (marcher->has_air)
        left *= march_air_add(&ray, met ? hit.t : INFINITY, gain, airlight);
    for (int c = 0; c < 3; c++)
        rgb[c] = gain * ray.rgb[c] + left * behind[c] + airlight[c];
    return ray.status;
}

/* --- a picture --- */

static double golden(double start, int i)
{
    start += 0.6180339887498949 * i;
    return start - floor(start);
}

static double blue_start(const shape_marcher *m, int x, int y)
{
    return (m->blue[y % BLUENOISE_SIZE * BLUENOISE_SIZE + x % BLUENOISE_SIZE] + 0.5) / BLUENOISE_COUNT;
}

/* How much later the steps of a pixel's ray number i begin: further rays by the golden ratio. */
static double jitter(const shape_marcher *m, int width, int x, int y, int i)
{
    uint64_t index = (uint64_t)y * (uint64_t)width + (uint64_t)x;
    shape_random random = shape_random_seed(shape_hash(m->options.seed) ^ index, 0);
    double start = 0;
    if (m->options.jitter == SHAPE_JITTER_NONE)
        return 0;
    if (m->options.jitter == SHAPE_JITTER_BLUE)
        start = blue_start(m, x, y);
    else
        start = shape_random_unit(&random);
    return golden(start, i);
}

/* The mean of a pixel's rays: through its middle where there is one, else scattered by the R2 sequence (Roberts 2018). */
static shape_status render_pixel(const shape_marcher *m, const shape_view *view, const shape_camera *camera,
                                 int x, int y, shape_march_scratch *scratch, float out[3])
{
    double sum[3] = {0, 0, 0}, rgb[3];
    int n = m->options.samples;
    for (int i = 0; i < n; i++) {
        double u = 0.5 + 0.7548776662466927 * i, v = 0.5 + 0.5698402909980532 * i;
        shape_dvec3 d = shape_camera_direction(camera, view, x + u - floor(u), y + v - floor(v));
        if (m->has_air)
            scratch->air_start = golden(blue_start(m, x, y), i);
        shape_status status =
            shape_march_radiance(m, camera->origin, d, jitter(m, view->width, x, y, i), scratch, rgb, NULL);
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
    uint64_t *looks = &picture->marcher->work->looks;
#pragma omp atomic
    *looks += scratch.looks;
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
