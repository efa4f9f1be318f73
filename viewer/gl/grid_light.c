/* The light grids of the clouds in sight: as solved, and as one eye sees them, each in one atlas. Each cloud's is as fine
 * as the view needs, and stays until it needs another. */
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "gl_private.h"
#include "shape/record.h"

static size_t cell_count(const int size[3])
{
    return (size_t)size[0] * (size_t)size[1] * (size_t)size[2];
}

static void drop_lit(gl_lit *lit)
{
    if (!lit || atomic_fetch_sub(&lit->uses, 1) > 1)
        return;
    shape_lightgrid_free(&lit->grid);
    free(lit->shade);
    free(lit);
}

static gl_lit *share(gl_lit *lit)
{
    if (lit)
        atomic_fetch_add(&lit->uses, 1);
    return lit;
}

static void drop_swept(gl_swept *swept)
{
    if (!swept || atomic_fetch_sub(&swept->uses, 1) > 1)
        return;
    shape_sunsweep_destroy(swept->sweep);
    free(swept);
}

void gl_light_drop(gl_light *light)
{
    if (!light || --light->uses)
        return;
    for (int i = 0; i < light->count; i++)
        drop_lit(light->lit[i]);
    drop_swept(light->swept);
    glDeleteTextures(1, &light->a);
    glDeleteTextures(1, &light->b);
    glDeleteTextures(1, &light->seen);
    glDeleteTextures(1, &light->shade_texture);
    glDeleteTextures(1, &light->depth);
    free(light->lit);
    free(light->boxes);
    free(light->cells);
    free(light->shade);
    free(light);
}

static float longest_side(const shape_volume_cloud *c)
{
    float longest = 0;
    for (int axis = 0; axis < 3; axis++)
        longest = fmaxf(longest, (&c->box.max.x)[axis] - (&c->box.min.x)[axis]);
    return longest;
}

double gl_largest_side(const shape_volume *volume, const shape_view *view)
{
    shape_camera camera = shape_view_camera(view);
    double largest = 0;
    for (size_t i = 0; i < volume->cloud_count; i++) {
        const shape_volume_cloud *c = &volume->clouds[i];
        /* Where the eye is inside, it fills the picture. */
        if (c->tree->count && gl_in_sight(c, &camera, 1))
            largest =
                fmax(largest, fmin((double)longest_side(c) / gl_pixel_size(c, view), 4.0 * view->height));
    }
    return largest;
}

/* How many cells along its longest side a cloud's light needs in a view: a cell about a pixel and a half, or its share of the
 * largest cloud's; in steps of the square root of 2, so that a view that moves a little keeps its light. */
static int wanted_cells(const gl_order *order, size_t cloud)
{
    const shape_volume_cloud *c = &order->volume->clouds[cloud];
    int most = order->light_options.resolution;
    if (order->paper)
        return most;
    double pixels = 1.5, fewest = 12, cells = most;
    if (order->light_pixels > 0) {
        pixels = order->light_pixels / most;
        fewest = fmax(4, most / 8.0);
    }
    double metre = gl_pixel_size(c, &order->view);
    while (cells > fewest && cells / sqrt(2) * pixels * metre >= (double)longest_side(c))
        cells /= sqrt(2);
    return (int)(cells + 0.5);
}

gl_fit gl_light_fit(const gl_light *light, const gl_order *order, double wider)
{
    gl_fit fit = GL_FITS;
    shape_camera camera = shape_view_camera(&order->view);
    for (int i = 0; i < light->count && !order->paper; i++) {
        const shape_volume_cloud *c = &order->volume->clouds[i];
        if (!c->tree->count || !gl_in_sight(c, &camera, wider)) {
            if (c->tree->count && order->all_clouds && !light->lit[i])
                return GL_MISSING;
            continue;
        }
        if (!light->lit[i])
            return GL_MISSING;
        gl_fit own = gl_fit_sizes(light->lit[i]->wanted, wanted_cells(order, (size_t)i));
        if (light->lit[i]->stale && own < GL_TOO_COARSE)
            own = GL_TOO_COARSE;
        fit = own > fit ? own : fit;
    }
    return fit;
}

/* After an edit: all that is there is taken over or made again with the same cells, but what is of another place or medium. */
static void choose_again(const gl_order *order, gl_light *light, int *cells)
{
    const gl_update *update = order->update;
    for (size_t i = 0; i < order->volume->cloud_count; i++) {
        gl_lit *last = order->light_from->lit[i];
        if (!last || update->changes[i].all || update->replaced[i])
            continue;
        if (update->shaded[i])
            cells[i] = last->cells;
        else
            light->lit[i] = share(last);
    }
}

/* Takes over what does of the last light; of the rest cells[i] gets with how many cells it is lit, 0: not at all. */
static void choose(const gl_order *order, gl_light *light, int *cells)
{
    shape_camera camera = shape_view_camera(&order->view);
    const gl_light *old = order->light_from;
    size_t kept = 0;
    for (size_t i = 0; i < order->volume->cloud_count; i++) {
        const shape_volume_cloud *c = &order->volume->clouds[i];
        gl_lit *last = old ? old->lit[i] : NULL;
        /* Clouds throw their shadows on things and into the air from wherever they are. */
        bool near =
            order->paper || order->all_clouds || (c->tree->count && gl_in_sight(c, &camera, GL_MARGIN));
        int own = near ? wanted_cells(order, i) : 0;
        bool good = last && near &&
                    (order->missing_only || (last->wanted == own && !last->stale) ||
                     (order->lenient && !last->stale && gl_fit_sizes(last->wanted, own) == GL_TOO_FINE));
        if (last && !near && order->lenient) {
            kept += cell_count(last->grid.size);
            good = kept <= GL_KEPT_CELLS;
        }
        if (good)
            light->lit[i] = share(last);
        else
            cells[i] = own;
    }
}

/* A cloud's light from before, of as many cells, whose densities are still true, or NULL. */
static const gl_lit *earlier_of(const gl_order *order, size_t cloud, int cells)
{
    const gl_light *const lights[] = {order->light_from, order->dense_from};
    for (int i = 0; i < 2; i++)
        if (lights[i] && lights[i]->lit[cloud] && lights[i]->lit[cloud]->cells == cells)
            return lights[i]->lit[cloud];
    return NULL;
}

static shape_status build(const gl_order *order, const shape_sunsweep *sweep, size_t cloud, int cells,
                          int swept, int threads, gl_lit **made, shape_error *error)
{
    gl_lit *lit = calloc(1, sizeof *lit);
    if (!lit)
        return shape_error_memory(error);
    shape_lightgrid_options options = order->light_options;
    options.resolution = cells;
    options.threads = threads;
    options.sweep = sweep;
    options.scattering_resolution = order->scattering_cells;
    options.stop = order->stop;
    const gl_lit *last = earlier_of(order, cloud, cells);
    options.from = last ? &last->grid : NULL;
    if (order->update) {
        options.change = &order->update->changes[cloud];
        options.scattering = false;
    }
    shape_status status =
        order->paper ? shape_lightgrid_build_2018_with(order->volume, cloud, order->light, cells, 0.1f,
                                                       order->stop, &lit->grid, error)
                     : shape_lightgrid_build(order->volume, cloud, order->light, &options, &lit->grid, error);
    atomic_init(&lit->uses, 1);
    if (!status && options.opaque && !order->paper)
        status = gl_shade_make(order, &options, cloud, lit, error);
    if (status) {
        drop_lit(lit);
        return status;
    }
    lit->wanted = order->first ? 0 : cells; /* the first one fits no view */
    if (order->update) {
        lit->wanted = last->wanted;
        lit->stale = true;
    }
    lit->cells = cells;
    lit->swept = swept;
    *made = lit;
    return SHAPE_OK;
}

/* Each cloud on one thread. */
static shape_status build_many(const gl_order *order, const shape_sunsweep *sweep, const int *cells,
                               const int *swept, int threads, gl_light *light, shape_error *error)
{
    shape_status status = SHAPE_OK;
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (int i = 0; i < light->count; i++) {
        shape_error own = {0};
        if (!cells[i] || !build(order, sweep, (size_t)i, cells[i], swept[i], 1, &light->lit[i], &own))
            continue;
        shape_error_join(&own, &status, error);
    }
    return status;
}

/* Sweeps; what the last sweep has of it is taken over. */
static shape_status make_sweep(const gl_order *order, const int *swept, shape_sunsweep **sweep,
                               shape_error *error)
{
    const gl_light *last = order->light_from;
    const shape_sunsweep_options options = {.threads = order->threads,
                                            .keep = order->lenient,
                                            .from = last && last->swept ? last->swept->sweep : NULL,
                                            .changes = order->update ? order->update->changes : NULL,
                                            .stop = order->stop};
    return shape_sunsweep_create_with(order->volume, order->light, swept, &options, sweep, error);
}

/* Keeps a sweep that is not too large for those that follow, while someone may edit; else destroys it. */
static shape_status keep_sweep(const gl_order *order, shape_sunsweep *sweep, gl_light *light,
                               shape_status status, shape_error *error)
{
    if (status || !order->lenient || shape_sunsweep_bytes(sweep) > GL_KEPT_SWEEP) {
        shape_sunsweep_destroy(sweep);
        return status;
    }
    light->swept = calloc(1, sizeof *light->swept);
    if (!light->swept) {
        shape_sunsweep_destroy(sweep);
        return shape_error_memory(error);
    }
    atomic_init(&light->swept->uses, 1);
    light->swept->sweep = sweep;
    return SHAPE_OK;
}

/* Lights the chosen clouds, one after the other unless they are many. (Not one loop with an `if`: OpenMP makes new threads
 * for each region within a region, even where the outer one has a single thread.) */
static shape_status build_all(const gl_order *order, const int *cells, gl_light *light, shape_error *error)
{
    enum { FINEST_SWEEP = 256 };
    int count = (int)order->volume->cloud_count, chosen = 0, threads = omp_get_max_threads();
    int *swept = calloc((size_t)count + 1, sizeof *swept);
    shape_sunsweep *sweep = NULL;
    shape_status status = swept ? SHAPE_OK : shape_error_memory(error);
    threads = order->threads > 0 ? order->threads : threads;
    for (int i = 0; i < count && !status; i++) {
        chosen += cells[i] > 0;
        /* Twice as fine as the light: as near to the truth as a march from each cell, in a tenth of its time. */
        swept[i] = order->first || 2 * cells[i] > FINEST_SWEEP ? cells[i] : 2 * cells[i];
        if (order->update && cells[i])
            swept[i] = order->light_from->lit[i]->swept;
    }
    if (!status && chosen && !order->paper)
        status = make_sweep(order, swept, &sweep, error);
    if (!status && chosen >= 2 * threads)
        status = build_many(order, sweep, cells, swept, threads, light, error);
    else
        for (int i = 0; i < count && !status; i++)
            if (cells[i])
                status = build(order, sweep, (size_t)i, cells[i], swept[i], threads, &light->lit[i], error);
    light->made = chosen;
    free(swept);
    return sweep ? keep_sweep(order, sweep, light, status, error) : status;
}

/* Places for all grids, and the scratch. */
static shape_status pack(gl_light *light, int texture_limit, shape_error *error)
{
    for (int i = 0; i < light->count; i++)
        memset(light->boxes[i].size, 0, sizeof light->boxes[i].size);
    for (int i = 0; i < light->count; i++)
        if (light->lit[i])
            memcpy(light->boxes[i].size, light->lit[i]->grid.size, sizeof light->boxes[i].size);
    shape_status status = gl_atlas_pack(light->boxes, light->count, texture_limit - 1, light->size, error);
    if (status)
        return status;
    /* Never a power of two: Mesa compiles shaders anew where that changes. */
    for (int axis = 0; axis < 3; axis++)
        while ((light->size[axis] & (light->size[axis] - 1)) == 0)
            light->size[axis]++;
    free(light->cells);
    light->cells = calloc(cell_count(light->size) * 4, sizeof *light->cells);
    if (!light->cells)
        return shape_error_memory(error);
    bool shaded = false;
    for (int i = 0; i < light->count; i++)
        shaded = shaded || (light->lit[i] && light->lit[i]->shade);
    return shaded ? gl_shade_pack(light, error) : SHAPE_OK;
}

static shape_status create(int count, gl_light **made, shape_error *error)
{
    gl_light *light = calloc(1, sizeof *light);
    if (!light)
        return shape_error_memory(error);
    light->uses = 1;
    light->count = count;
    light->lit = calloc((size_t)count + 1, sizeof(gl_lit *));
    light->boxes = calloc((size_t)count + 1, sizeof *light->boxes);
    if (light->lit && light->boxes) {
        *made = light;
        return SHAPE_OK;
    }
    light->count = 0;
    gl_light_drop(light);
    return shape_error_memory(error);
}

shape_status gl_light_make(const gl_order *order, gl_light **made, shape_error *error)
{
    const size_t count = order->volume->cloud_count;
    gl_light *light = NULL;
    int *cells = calloc(count + 1, sizeof *cells);
    shape_status status = cells ? create((int)count, &light, error) : shape_error_memory(error);
    if (!status) {
        if (order->update)
            choose_again(order, light, cells);
        else
            choose(order, light, cells);
        status = build_all(order, cells, light, error);
    }
    if (!status)
        status = pack(light, order->texture_limit, error);
    free(cells);
    if (status) {
        gl_light_drop(light);
        return status;
    }
    *made = light;
    return SHAPE_OK;
}

shape_status gl_light_join(const gl_light *first, const gl_light *second, int texture_limit, gl_light **made,
                           shape_error *error)
{
    gl_light *light = NULL;
    shape_status status = create(first->count, &light, error);
    for (int i = 0; i < first->count && !status; i++)
        light->lit[i] = share(first->lit[i] ? first->lit[i] : second->lit[i]);
    if (!status)
        status = pack(light, texture_limit, error);
    if (status) {
        gl_light_drop(light);
        return status;
    }
    light->made = first->made;
    light->swept = first->swept ? first->swept : second->swept;
    if (light->swept)
        atomic_fetch_add(&light->swept->uses, 1);
    *made = light;
    return SHAPE_OK;
}

/* `values` of each cell, from value `first` on, of all grids as one texture. */
static GLuint value_texture(gl_light *light, int first, size_t values)
{
    memset(light->cells, 0, cell_count(light->size) * 4 * sizeof *light->cells);
    for (int i = 0; i < light->count; i++) {
        const gl_box *box = &light->boxes[i];
        if (!light->lit[i])
            continue;
        const float *from = light->lit[i]->grid.cells + first;
        for (int z = 0; z < box->size[2]; z++)
            for (int y = 0; y < box->size[1]; y++) {
                float *to =
                    light->cells +
                    (((size_t)(box->place[2] + z) * (size_t)light->size[1] + (size_t)(box->place[1] + y)) *
                         (size_t)light->size[0] +
                     (size_t)box->place[0]) *
                        values;
                for (size_t x = 0; x < (size_t)box->size[0]; x++, from += SHAPE_LIGHTGRID_VALUES)
                    memcpy(to + values * x, from, values * sizeof *to);
            }
    }
    return values == 1 ? gl_volume_texture(light->size, GL_R32F, GL_RED, GL_FLOAT, light->cells)
                       : gl_volume_texture(light->size, GL_RGBA32F, GL_RGBA, GL_FLOAT, light->cells);
}

void gl_light_upload(gl_light *light)
{
    light->a = value_texture(light, 0, 4);
    light->b = value_texture(light, 4, 4);
}

void gl_light_upload_depths(gl_light *light, shape_gl_renderer *renderer)
{
    if (light->depth)
        return;
    light->depth = value_texture(light, 0, 1);
    renderer->costs.light_bytes += cell_count(light->size) * sizeof *light->cells;
}

void gl_light_place(const gl_light *light, gl_scene *scene, const shape_volume *volume)
{
    for (int i = 0; i < light->count; i++) {
        float *record = scene->records + (size_t)i * GL_RECORD_TEXELS * 4;
        if (light->lit[i])
            shape_record_set_light((float(*)[4])record, &volume->clouds[i], &light->lit[i]->grid,
                                   light->boxes[i].place);
    }
}

static shape_status compose_one(const gl_light *light, const shape_gl_renderer *r, shape_dvec3 eye, int cloud,
                                float *to, shape_error *error)
{
    if (!light->lit[cloud])
        return SHAPE_OK;
    shape_status status = shape_lightgrid_seen(&light->lit[cloud]->grid, &r->volume->clouds[cloud], &r->light,
                                               &r->sky, r->sky_upper, r->sky_lower, eye, to, error);
    if (!status)
        gl_law_glow(r, &r->volume->clouds[cloud].medium, cell_count(light->boxes[cloud].size), to);
    return status;
}

/* Many clouds are shared out, since one by one each would keep all threads waiting for the last. */
static shape_status compose_all(const gl_light *light, const shape_gl_renderer *r, shape_dvec3 eye,
                                const size_t *first, shape_error *error)
{
    const gl_scene *scene = &r->scene;
    const int count = scene->shown_count;
    shape_status status = SHAPE_OK;
    if (count == 1)
        return compose_one(light, r, eye, scene->shown[0], light->cells, error);
#pragma omp parallel for schedule(dynamic)
    for (int i = 0; i < count; i++) {
        shape_error own = {0};
        if (!compose_one(light, r, eye, scene->shown[i], light->cells + 4 * first[i], &own))
            continue;
        shape_error_join(&own, &status, error);
    }
    return status;
}

/* Where each shown cloud's cells begin in the scratch, which is as large as all of them together. */
static void place_scratch(const gl_light *light, const gl_scene *scene, size_t *first)
{
    size_t next = 0;
    for (int i = 0; i < scene->shown_count; i++) {
        first[i] = next;
        next += light->lit[scene->shown[i]] ? cell_count(light->boxes[scene->shown[i]].size) : 0;
    }
}

shape_status gl_light_compose(gl_light *light, shape_gl_renderer *renderer, shape_dvec3 eye,
                              shape_error *error)
{
    const gl_scene *scene = &renderer->scene;
    const int count = scene->shown_count;
    size_t *first = malloc(((size_t)count + 1) * sizeof *first);
    if (!first)
        return shape_error_memory(error);
    place_scratch(light, scene, first);
    shape_status status = compose_all(light, renderer, eye, first, error);
    if (status) {
        free(first);
        return status;
    }
    if (!light->seen)
        light->seen = gl_volume_texture(light->size, GL_RGBA32F, GL_RGBA, GL_FLOAT, NULL);
    gl_settle();
    glBindTexture(GL_TEXTURE_3D, light->seen);
    for (int i = 0; i < count; i++) {
        const gl_box *box = &light->boxes[scene->shown[i]];
        if (!light->lit[scene->shown[i]])
            continue;
        glTexSubImage3D(GL_TEXTURE_3D, 0, box->place[0], box->place[1], box->place[2], box->size[0],
                        box->size[1], box->size[2], GL_RGBA, GL_FLOAT, light->cells + 4 * first[i]);
        renderer->costs.light_bytes += cell_count(box->size) * 4 * sizeof *light->cells;
    }
    free(first);
    return SHAPE_OK;
}
