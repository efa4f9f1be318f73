/* Optical depth to the sun by running sums: the columns of all clouds (sun_columns.h), and the shadows that they throw on each
 * other. */
#include "shape/sunsweep.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "base/stop.h"
#include "light/sun_columns.h"
#include "light/sunsweep.h"

enum {
    CASTER_CELLS = 16,
    LARGE = 8192 /* cells: below these waking a thread takes longer than it saves */
};

static const float MOST = SUN_DEEPEST;

struct shape_sunsweep {
    const shape_volume *volume;
    size_t count;          /* of clouds */
    sun_columns **columns; /* a cloud each; NULL: not swept */
    uint64_t rows;         /* that were evaluated for it */
    shadow_pairs pairs;
    bool *asked;
};

/* --- looking up --- */

/* From one cloud's frame to another's. */
static shape_frame between(const shape_volume_cloud *from, const shape_volume_cloud *to)
{
    return shape_frame_multiply(&to->inverse, &from->frame);
}

static shape_vec3 carry(const shape_frame *frame, shape_vec3 p)
{
    shape_dvec3 q = shape_frame_point(frame, shape_dvec3_make(p.x, p.y, p.z));
    return shape_vec3_make((float)q.x, (float)q.y, (float)q.z);
}

float shape_sunsweep_depth(const shape_sunsweep *s, size_t cloud, shape_vec3 p)
{
    if (!s->asked[cloud])
        return 0;
    float sum = sun_columns_depth(s->columns[cloud], p);
    for (size_t i = s->pairs.first[cloud]; i < s->pairs.first[cloud + 1]; i++) {
        size_t caster = s->pairs.casters[i];
        shape_frame frame = between(&s->volume->clouds[cloud], &s->volume->clouds[caster]);
        sum += sun_columns_depth(s->columns[caster], carry(&frame, p));
    }
    return fminf(sum, MOST);
}

bool sunsweep_has(const shape_sunsweep *s, size_t cloud)
{
    return s->asked[cloud];
}

/* Adds what columns give at each cell of a row of the grid; the points are carried into the columns' cloud. */
static void add_row(const sun_columns *c, const shape_frame *frame, int row, shape_lightgrid *grid)
{
    shape_vec3 size = shape_vec3_sub(grid->box.max, grid->box.min);
    float *cells = grid->cells + (size_t)row * (size_t)grid->size[0] * SHAPE_LIGHTGRID_VALUES;
    float y = grid->box.min.y + size.y * ((float)(row % grid->size[1]) + 0.5f) / (float)grid->size[1],
          z = grid->box.min.z + size.z * ((float)(row / grid->size[1]) + 0.5f) / (float)grid->size[2];
    for (int i = 0; i < grid->size[0]; i++) {
        float x = grid->box.min.x + size.x * ((float)i + 0.5f) / (float)grid->size[0];
        cells[i * SHAPE_LIGHTGRID_VALUES] += sun_columns_depth(c, carry(frame, shape_vec3_make(x, y, z)));
    }
}

/* What the cloud itself throws on a part of its cells: a layer of columns where its grid is the one that was swept, else all
 * that has the same z. */
static void fill_part(const sun_columns *own, bool same, int part, shape_lightgrid *grid)
{
    if (same)
        sun_columns_fill_layer(own, part, grid);
    else
        sun_columns_add_slab(own, grid, part);
}

/* The shadows of all others on the cells of one z, in their order. */
static void add_casters(const shape_sunsweep *s, size_t cloud, int z, shape_lightgrid *grid)
{
    for (size_t i = s->pairs.first[cloud]; i < s->pairs.first[cloud + 1]; i++) {
        const size_t caster = s->pairs.casters[i];
        shape_frame frame = between(&s->volume->clouds[cloud], &s->volume->clouds[caster]);
        for (int y = 0; y < grid->size[1]; y++)
            add_row(s->columns[caster], &frame, z * grid->size[1] + y, grid);
    }
    const size_t slab = (size_t)grid->size[0] * (size_t)grid->size[1];
    float *depth = grid->cells + (size_t)z * slab * SHAPE_LIGHTGRID_VALUES;
    for (size_t i = 0; i < slab; i++, depth += SHAPE_LIGHTGRID_VALUES)
        *depth = *depth < MOST ? *depth : MOST;
}

shape_status sunsweep_fill(const shape_sunsweep *s, size_t cloud, int threads, shape_stop stop,
                           shape_lightgrid *grid, shape_error *error)
{
    const sun_columns *own = s->columns[cloud];
    const bool same = sun_columns_same_grid(own, grid);
    const int parts = same ? own->at.size[2] : grid->size[2];
    const size_t casters = s->pairs.first[cloud + 1] - s->pairs.first[cloud],
                 cells = (size_t)grid->size[0] * (size_t)grid->size[1] * (size_t)grid->size[2];
    /* Its own grid is copied, a cell in a few nanoseconds; elsewhere each cell is looked up. */
    threads = cells * (casters + (same ? 0 : 1)) < 2 * LARGE ? 1 : threads;
    bool stopped = false;
#pragma omp parallel num_threads(threads) reduction(|| : stopped)
    {
        stop_watch watch = {.stop = stop};
#pragma omp for schedule(static)
        for (int i = 0; i < parts; i++)
            if (!stop_now(&watch))
                fill_part(own, same, i, grid);
#pragma omp for schedule(static)
        for (int z = 0; z < grid->size[2]; z++)
            if (!stop_now(&watch))
                add_casters(s, cloud, z, grid);
        stopped = stopped || watch.stopped;
    }
    return stopped ? stop_error(error) : SHAPE_OK;
}

/* --- all clouds --- */

/* How fine each cloud is swept, 0: not at all. */
static shape_status choose_cells(const shape_sunsweep *s, const int *wanted, int *cells, shape_error *error)
{
    for (size_t i = 0; i < s->volume->cloud_count; i++) {
        if (wanted[i] != 0 && (wanted[i] < 2 || wanted[i] > 256))
            return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                                   "a sweep of %d cells (it must be 2 to 256, or 0)", wanted[i]);
        s->asked[i] = wanted[i] != 0;
        if (wanted[i])
            cells[i] = wanted[i];
        for (size_t k = s->pairs.first[i]; k < s->pairs.first[i + 1] && wanted[i]; k++) {
            size_t caster = s->pairs.casters[k];
            if (!wanted[caster])
                cells[caster] = CASTER_CELLS;
        }
    }
    return SHAPE_OK;
}

typedef struct sweep_work {
    shape_sunsweep *sweep;
    shape_dvec3 sun;
    const int *cells;
    const shape_sunsweep_options *options;
} sweep_work;

static shape_status sweep_one(const sweep_work *work, size_t i, int threads, uint64_t *rows,
                              shape_error *error)
{
    const shape_sunsweep_options *o = work->options;
    shape_sunsweep *from = o->from;
    sun_columns *none = NULL, **earlier = from && i < from->count ? &from->columns[i] : &none;
    const sun_order order = {.cloud = &work->sweep->volume->clouds[i],
                             .sun = work->sun,
                             .resolution = work->cells[i],
                             .threads = threads,
                             .keep = o->keep,
                             .change = o->changes ? &o->changes[i] : NULL,
                             .stop = o->stop};
    return sun_columns_make(&order, earlier, &work->sweep->columns[i], rows, error);
}

/* Each thread takes whole clouds where there are many, else all take one after the other. Not one loop with an `if`: OpenMP
 * takes that for a region within a region, and makes new threads for each inner one. */
static shape_status sweep_all(const sweep_work *work, int threads, shape_error *error)
{
    int count = (int)work->sweep->count, swept = 0;
    uint64_t rows = 0;
    for (int i = 0; i < count; i++)
        swept += work->cells[i] != 0;
    shape_status status = SHAPE_OK;
    if (swept < 2 * threads) {
        for (int i = 0; i < count && !status; i++)
            if (work->cells[i])
                status = sweep_one(work, (size_t)i, threads, &rows, error);
        work->sweep->rows = rows;
        return status;
    }
    bool failed = false;
#pragma omp parallel for schedule(dynamic) num_threads(threads) reduction(+ : rows)
    for (int i = 0; i < count; i++) {
        shape_error own = {0};
        bool given_up;
#pragma omp atomic read
        given_up = failed;
        if (given_up || !work->cells[i] || !sweep_one(work, (size_t)i, 1, &rows, &own))
            continue;
#pragma omp atomic write
        failed = true;
        shape_error_join(&own, &status, error);
    }
    work->sweep->rows = rows;
    return status;
}

static shape_sunsweep *create(const shape_volume *volume)
{
    shape_sunsweep *s = calloc(1, sizeof *s);
    if (!s)
        return NULL;
    s->volume = volume;
    s->count = volume->cloud_count;
    s->columns = calloc(s->count + 1, sizeof(sun_columns *));
    s->asked = calloc(s->count + 1, sizeof *s->asked);
    if (s->columns && s->asked)
        return s;
    shape_sunsweep_destroy(s);
    return NULL;
}

shape_status shape_sunsweep_create_with(const shape_volume *volume, const shape_light *light,
                                        const int *cells, const shape_sunsweep_options *options,
                                        shape_sunsweep **made, shape_error *error)
{
    shape_sunsweep *s = create(volume);
    int *chosen = calloc(volume->cloud_count + 1, sizeof *chosen);
    shape_status status = s && chosen ? SHAPE_OK : shape_error_memory(error);
    if (!status)
        status = shadow_pairs_find(volume, light->sun, &s->pairs, error);
    if (!status)
        status = choose_cells(s, cells, chosen, error);
    if (!status) {
        const sweep_work work = {s, light->sun, chosen, options};
        status = sweep_all(&work, options->threads > 0 ? options->threads : omp_get_max_threads(), error);
    }
    free(chosen);
    if (status) {
        shape_sunsweep_destroy(s);
        return status;
    }
    *made = s;
    return SHAPE_OK;
}

shape_status shape_sunsweep_create(const shape_volume *volume, const shape_light *light, const int *cells,
                                   int threads, shape_sunsweep **made, shape_error *error)
{
    const shape_sunsweep_options options = {.threads = threads};
    return shape_sunsweep_create_with(volume, light, cells, &options, made, error);
}

void shape_sunsweep_destroy(shape_sunsweep *s)
{
    if (!s)
        return;
    for (size_t i = 0; s->columns && i < s->count; i++)
        sun_columns_drop(s->columns[i]);
    shadow_pairs_free(&s->pairs);
    free(s->columns);
    free(s->asked);
    free(s);
}

size_t shape_sunsweep_count(const shape_sunsweep *s)
{
    size_t swept = 0;
    for (size_t i = 0; i < s->count; i++)
        swept += s->columns[i] != NULL;
    return swept;
}

size_t shape_sunsweep_bytes(const shape_sunsweep *s)
{
    size_t cells = 0;
    for (size_t i = 0; i < s->count; i++)
        if (s->columns[i])
            cells += sun_columns_cells(&s->columns[i]->at) * (s->columns[i]->density ? 2 : 1);
    return cells * sizeof(float);
}

uint64_t shape_sunsweep_rows(const shape_sunsweep *s)
{
    return s->rows;
}
