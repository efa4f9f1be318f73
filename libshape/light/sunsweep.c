/* Optical depth to the sun by running sums: the first light pass of Jiménez 2018 section 3.5 without its march from every
 * cell. A cloud's grid has layers across the axis that the sun runs along most steeply; from layer to layer the columns
 * move with the sun's light (a sheared grid), so that a column's sum is the optical depth along the sun. */
#include "shape/sunsweep.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "field/clones.h"
#include "field/row.h"
#include "light/lightgrid_layout.h"
#include "light/sunsweep.h"

enum {
    CASTER_CELLS = 16,
    ROWS = 8,    /* of a layer, for which primitives are gathered at once, at most */
    BLOCKS = 16, /* of rows at least, where there is more than one thread: so they end together */
    LARGE = 8192 /* cells: below these waking a thread takes longer than it saves */
};

static const float MOST = 60000; /* a half-float's range */

/* One cloud's columns. Arrays are in the order: along a row, across the rows, from layer to layer. */
typedef struct sun_columns {
    int axis[3], size[3];  /* samples in a layer's rows, rows, layers */
    float low[3], cell[3]; /* of the grid [m, cloud's frame] */
    bool upward;           /* the sun lies at the upper end of the layers' axis */
    float shear[2];        /* how far a column moves from a layer to the next [cells] */
    int first[2], count[2];
    float length; /* of a column within a layer [m, world], times extinction */
    float *depth; /* [layers, from the sun][count[1]][count[0]]: densities, then sums; NULL: not swept */
} sun_columns;

struct shape_sunsweep {
    const shape_volume *volume;
    sun_columns *columns;
    shadow_pairs pairs;
    bool *asked;
};

/* --- a cloud's own columns --- */

static void lay_out(const shape_volume_cloud *cloud, shape_dvec3 sun, int resolution, sun_columns *c)
{
    shape_lightgrid grid;
    shape_dvec3 d = shape_frame_direction(&cloud->inverse, sun); /* a metre of the world */
    double cell[3], steepest = -1;
    int up = 1;
    lightgrid_lay_out(cloud, resolution, &grid);
    for (int axis = 0; axis < 3; axis++) {
        cell[axis] = ((double)(&grid.box.max.x)[axis] - (double)(&grid.box.min.x)[axis]) / grid.size[axis];
        if (fabs((&d.x)[axis]) / cell[axis] > steepest)
            steepest = fabs((&d.x)[axis]) / cell[axis], up = axis;
    }
    c->axis[2] = up;
    c->axis[0] = up == 0 ? 1 : 0; /* rows along x where they can be */
    c->axis[1] = 3 - up - c->axis[0];
    for (int i = 0; i < 3; i++) {
        c->size[i] = grid.size[c->axis[i]];
        c->low[i] = (&grid.box.min.x)[c->axis[i]];
        c->cell[i] = (float)cell[c->axis[i]];
    }
    c->upward = (&d.x)[up] > 0;
    c->length = (float)fmin(cloud->medium.extinction / steepest, 1e30);
    for (int i = 0; i < 2; i++) {
        c->shear[i] = (float)(-(&d.x)[c->axis[i]] / cell[c->axis[i]] / steepest);
        float over = -c->shear[i] * (float)(c->size[2] - 1);
        c->first[i] = (int)floorf(fminf(over, 0)) - 1;
        c->count[i] = (int)ceilf(fmaxf(over, 0)) + c->size[i] + 1 - c->first[i];
    }
}

static float layer_place(const sun_columns *c, int layer)
{
    int index = c->upward ? c->size[2] - 1 - layer : layer;
    return c->low[2] + c->cell[2] * ((float)index + 0.5f);
}

/* The columns [*first, *end) that cross the grid in a layer. */
static void find_range(const sun_columns *c, int side, int layer, int *first, int *end)
{
    float moved = c->shear[side] * (float)layer;
    *first = (int)ceilf(-moved) - c->first[side];
    *end = (int)floorf((float)(c->size[side] - 1) - moved) - c->first[side] + 1;
}

/* Densities of a layer's rows [row, row + rows). */
static shape_status fill_rows(const shape_volume_cloud *cloud, const sun_columns *c, int layer, int row,
                              int rows, row_forms *list, shape_error *error)
{
    int first, end, first_row, end_row;
    find_range(c, 0, layer, &first, &end);
    find_range(c, 1, layer, &first_row, &end_row);
    int from = row > first_row ? row : first_row, to = row + rows < end_row ? row + rows : end_row;
    if (first >= end || from >= to)
        return SHAPE_OK;
    const bool grid = cloud->field.model == SHAPE_MODEL_GRID;
    const int *axis = c->axis;
    float moved[2], u2[ROW_MOST];
    field_row points = {axis[0], end - first, {0}, c->cell[0]};
    for (int side = 0; side < 2; side++)
        moved[side] = c->shear[side] * (float)layer + (float)c->first[side];
    points.low[axis[0]] = c->low[0] + c->cell[0] * (moved[0] + (float)first);
    points.low[axis[2]] = layer_place(c, layer);
    shape_vec3 low = {points.low[0], points.low[1], points.low[2]}, high = low;
    (&high.x)[axis[0]] += c->cell[0] * (float)points.count;
    (&low.x)[axis[1]] = c->low[1] + c->cell[1] * (moved[1] + (float)from);
    (&high.x)[axis[1]] = c->low[1] + c->cell[1] * (moved[1] + (float)to);
    shape_status status = row_collect(cloud, low, high, list, error);
    if (status || !list->count)
        return status;
    for (int j = from; j < to; j++) {
        float *out = c->depth + ((size_t)layer * (size_t)c->count[1] + (size_t)j) * (size_t)c->count[0];
        points.low[axis[1]] = c->low[1] + c->cell[1] * (moved[1] + (float)j + 0.5f);
        row_u2(list, cloud->support, &points, u2);
        for (int i = 0; i < points.count && grid; i++)
            u2[i] = 0;
        row_density(cloud, &points, u2, out + first);
    }
    return SHAPE_OK;
}

/* Densities become optical depths at the middles of cells, down one row of columns. */
NEPHELE_CLONES
static void add_up(const sun_columns *c, int row, float *restrict above)
{
    const int count = c->count[0];
    const float length = c->length;
    for (int i = 0; i < count; i++)
        above[i] = 0;
    for (int layer = 0; layer < c->size[2]; layer++) {
        float *restrict cells =
            c->depth + ((size_t)layer * (size_t)c->count[1] + (size_t)row) * (size_t)count;
#pragma omp simd
        for (int i = 0; i < count; i++) {
            float own = cells[i] * length;
            own = own < MOST ? own : MOST;
            cells[i] = above[i] + 0.5f * own;
            above[i] += own;
        }
    }
}

/* As in shape/bake.h: no more octaves than the cells can show, the mean of the rest. */
static shape_volume_cloud with_fewer_octaves(const shape_volume_cloud *cloud, const sun_columns *c)
{
    shape_volume_cloud copy = *cloud;
    float edge = fminf(c->cell[0], fminf(c->cell[1], c->cell[2])), noise = 1 / cloud->inverse_noise_scale;
    int octaves = 1;
    for (; octaves < cloud->field.octaves && noise > edge; octaves++)
        noise /= 2;
    copy.mean_octaves = cloud->field.octaves - octaves;
    copy.field.octaves = octaves;
    return copy;
}

/* Rows [row, row + rows) of columns, from the top to the bottom: nobody else needs them, so threads never wait. */
static shape_status sweep_rows(const shape_volume_cloud *cloud, const sun_columns *c, int row, int rows,
                               row_forms *list, shape_error *error)
{
    enum { MOST_COLUMNS = 3 * 258 };
    float above[MOST_COLUMNS];
    for (int layer = 0; layer < c->size[2]; layer++)
        if (fill_rows(cloud, c, layer, row, rows, list, error))
            return error->status;
    for (int j = row; j < row + rows && j < c->count[1]; j++)
        add_up(c, j, above);
    return SHAPE_OK;
}

static shape_status sweep_blocks(const shape_volume_cloud *cloud, const sun_columns *c, int rows, int threads,
                                 shape_error *error)
{
    const int blocks = (c->count[1] + rows - 1) / rows;
    shape_status status = SHAPE_OK;
#pragma omp parallel num_threads(threads)
    {
        row_forms list = {0};
        shape_error own = {0};
#pragma omp for schedule(dynamic, 1) nowait
        for (int i = 0; i < blocks; i++)
            if (!own.status)
                sweep_rows(cloud, c, i * rows, rows, &list, &own);
        free(list.items);
        if (own.status) {
#pragma omp critical
            {
                status = own.status;
                if (error)
                    *error = own;
            }
        }
    }
    return status;
}

static shape_status sweep_cloud(const shape_volume_cloud *cloud, shape_dvec3 sun, int resolution, int threads,
                                sun_columns *c, shape_error *error)
{
    lay_out(cloud, sun, resolution, c);
    const size_t cells = (size_t)c->count[0] * (size_t)c->count[1] * (size_t)c->size[2];
    c->depth = calloc(cells, sizeof *c->depth);
    if (!c->depth)
        return shape_error_memory(error);
    const shape_volume_cloud coarse = with_fewer_octaves(cloud, c);
    int rows = ROWS;
    threads = cells < LARGE ? 1 : threads;
    while (threads > 1 && rows > 1 && c->count[1] < rows * BLOCKS)
        rows /= 2;
    return sweep_blocks(&coarse, c, rows, threads, error);
}

/* --- looking up --- */

/* Optical depth to the sun at a point of the cloud's frame, through this cloud alone. */
static float look_up(const sun_columns *c, shape_vec3 p)
{
    float layer = ((&p.x)[c->axis[2]] - c->low[2]) / c->cell[2] - 0.5f, at[3];
    layer = c->upward ? (float)(c->size[2] - 1) - layer : layer;
    if (!(layer > -1))
        return 0;
    for (int side = 0; side < 2; side++) {
        at[side] = ((&p.x)[c->axis[side]] - c->low[side]) / c->cell[side] - 0.5f - c->shear[side] * layer -
                   (float)c->first[side];
        if (!(at[side] >= 0 && at[side] < (float)(c->count[side] - 1)))
            return 0;
    }
    at[2] = layer < (float)(c->size[2] - 1) ? layer : (float)(c->size[2] - 1);
    int i = (int)at[0], j = (int)at[1],
        k = (int)(at[2] + 1) - 1; /* -1: above the first layer, where nothing is */
    float x = at[0] - (float)i, y = at[1] - (float)j, z = at[2] - (float)k, value[2] = {0, 0};
    for (int half = 0; half < 2; half++) {
        int number = k + half < c->size[2] ? k + half : c->size[2] - 1;
        if (number < 0)
            continue;
        const float *near = c->depth +
                            ((size_t)number * (size_t)c->count[1] + (size_t)j) * (size_t)c->count[0] +
                            (size_t)i,
                    *far = near + c->count[0];
        float a = near[0] + x * (near[1] - near[0]), b = far[0] + x * (far[1] - far[0]);
        value[half] = a + y * (b - a);
    }
    return value[0] + z * (value[1] - value[0]);
}

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
    float sum = look_up(&s->columns[cloud], p);
    for (size_t i = s->pairs.first[cloud]; i < s->pairs.first[cloud + 1]; i++) {
        size_t caster = s->pairs.casters[i];
        shape_frame frame = between(&s->volume->clouds[cloud], &s->volume->clouds[caster]);
        sum += look_up(&s->columns[caster], carry(&frame, p));
    }
    return fminf(sum, MOST);
}

bool sunsweep_has(const shape_sunsweep *s, size_t cloud)
{
    return s->asked[cloud];
}

/* The cloud's own depths where its grid is the one that was swept: cells lie on the layers, and a layer's columns lie a
 * fixed part of a cell beside them. */
NEPHELE_CLONES
static void fill_layer_row(const float *restrict near, const float *restrict far, float x, float y, int count,
                           float *restrict out)
{
#pragma omp simd
    for (int i = 0; i < count; i++) {
        float a = near[i] + x * (near[i + 1] - near[i]), b = far[i] + x * (far[i + 1] - far[i]);
        out[i] = a + y * (b - a);
    }
}

static bool same_grid(const sun_columns *c, const shape_lightgrid *grid)
{
    for (int i = 0; i < 3; i++)
        if (c->size[i] != grid->size[c->axis[i]])
            return false;
    return true;
}

static void fill_own(const sun_columns *c, int layer, shape_lightgrid *grid)
{
    float row[ROW_MOST], part[2];
    int from[2], at[3];
    for (int side = 0; side < 2; side++) {
        float place = -c->shear[side] * (float)layer - (float)c->first[side];
        from[side] = (int)place;
        part[side] = place - (float)from[side];
    }
    at[c->axis[2]] = c->upward ? c->size[2] - 1 - layer : layer;
    for (int j = 0; j < c->size[1]; j++) {
        const float *near =
            c->depth + ((size_t)layer * (size_t)c->count[1] + (size_t)(from[1] + j)) * (size_t)c->count[0] +
            (size_t)from[0];
        fill_layer_row(near, near + c->count[0], part[0], part[1], c->size[0], row);
        at[c->axis[1]] = j;
        at[c->axis[0]] = 0;
        size_t cell =
            ((size_t)at[2] * (size_t)grid->size[1] + (size_t)at[1]) * (size_t)grid->size[0] + (size_t)at[0];
        size_t stride = c->axis[0] == 0 ? 1 : (size_t)grid->size[0];
        for (int i = 0; i < c->size[0]; i++)
            grid->cells[(cell + (size_t)i * stride) * SHAPE_LIGHTGRID_VALUES] = row[i];
    }
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
        cells[i * SHAPE_LIGHTGRID_VALUES] += look_up(c, carry(frame, shape_vec3_make(x, y, z)));
    }
}

/* What the cloud itself throws on a part of its cells: a layer of columns where its grid is the one that was swept, else all
 * that has the same z. */
static void fill_part(const sun_columns *own, bool same, int part, shape_lightgrid *grid)
{
    const shape_frame identity = shape_frame_identity();
    if (same)
        fill_own(own, part, grid);
    for (int y = 0; y < grid->size[1] && !same; y++)
        add_row(own, &identity, part * grid->size[1] + y, grid);
}

/* The shadows of all others on the cells of one z, in their order. */
static void add_casters(const shape_sunsweep *s, size_t cloud, int z, shape_lightgrid *grid)
{
    for (size_t i = s->pairs.first[cloud]; i < s->pairs.first[cloud + 1]; i++) {
        const size_t caster = s->pairs.casters[i];
        shape_frame frame = between(&s->volume->clouds[cloud], &s->volume->clouds[caster]);
        for (int y = 0; y < grid->size[1]; y++)
            add_row(&s->columns[caster], &frame, z * grid->size[1] + y, grid);
    }
    const size_t slab = (size_t)grid->size[0] * (size_t)grid->size[1];
    float *depth = grid->cells + (size_t)z * slab * SHAPE_LIGHTGRID_VALUES;
    for (size_t i = 0; i < slab; i++, depth += SHAPE_LIGHTGRID_VALUES)
        *depth = *depth < MOST ? *depth : MOST;
}

void sunsweep_fill(const shape_sunsweep *s, size_t cloud, int threads, shape_lightgrid *grid)
{
    const sun_columns *own = &s->columns[cloud];
    const bool same = same_grid(own, grid);
    const int parts = same ? own->size[2] : grid->size[2];
    const size_t casters = s->pairs.first[cloud + 1] - s->pairs.first[cloud],
                 cells = (size_t)grid->size[0] * (size_t)grid->size[1] * (size_t)grid->size[2];
    /* Its own grid is copied, a cell in a few nanoseconds; elsewhere each cell is looked up. */
    threads = cells * (casters + (same ? 0 : 1)) < 2 * LARGE ? 1 : threads;
#pragma omp parallel num_threads(threads)
    {
#pragma omp for schedule(static)
        for (int i = 0; i < parts; i++)
            fill_part(own, same, i, grid);
#pragma omp for schedule(static)
        for (int z = 0; z < grid->size[2]; z++)
            add_casters(s, cloud, z, grid);
    }
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

/* Each thread takes whole clouds where there are many, else all take one after the other. Not one loop with an `if`: OpenMP
 * takes that for a region within a region, and makes new threads for each inner one. */
static shape_status sweep_all(const shape_sunsweep *s, shape_dvec3 sun, const int *cells, int threads,
                              shape_error *error)
{
    int count = (int)s->volume->cloud_count, swept = 0;
    for (int i = 0; i < count; i++)
        swept += cells[i] != 0;
    shape_status status = SHAPE_OK;
    if (swept < 2 * threads) {
        for (int i = 0; i < count && !status; i++)
            if (cells[i])
                status = sweep_cloud(&s->volume->clouds[i], sun, cells[i], threads, &s->columns[i], error);
        return status;
    }
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (int i = 0; i < count; i++) {
        shape_error own = {0};
        if (!cells[i] || !sweep_cloud(&s->volume->clouds[i], sun, cells[i], 1, &s->columns[i], &own))
            continue;
#pragma omp critical
        {
            status = own.status;
            if (error)
                *error = own;
        }
    }
    return status;
}

shape_status shape_sunsweep_create(const shape_volume *volume, const shape_light *light, const int *cells,
                                   int threads, shape_sunsweep **made, shape_error *error)
{
    size_t count = volume->cloud_count;
    shape_sunsweep *s = calloc(1, sizeof *s);
    int *chosen = calloc(count + 1, sizeof *chosen);
    if (s) {
        s->volume = volume;
        s->columns = calloc(count + 1, sizeof *s->columns);
        s->asked = calloc(count + 1, sizeof *s->asked);
    }
    shape_status status = s && chosen && s->columns && s->asked ? SHAPE_OK : shape_error_memory(error);
    if (!status)
        status = shadow_pairs_find(volume, light->sun, &s->pairs, error);
    if (!status)
        status = choose_cells(s, cells, chosen, error);
    if (!status)
        status = sweep_all(s, light->sun, chosen, threads > 0 ? threads : omp_get_max_threads(), error);
    free(chosen);
    if (status) {
        shape_sunsweep_destroy(s);
        return status;
    }
    *made = s;
    return SHAPE_OK;
}

void shape_sunsweep_destroy(shape_sunsweep *s)
{
    if (!s)
        return;
    for (size_t i = 0; s->columns && i < s->volume->cloud_count; i++)
        free(s->columns[i].depth);
    shadow_pairs_free(&s->pairs);
    free(s->columns);
    free(s->asked);
    free(s);
}

size_t shape_sunsweep_count(const shape_sunsweep *s)
{
    size_t swept = 0;
    for (size_t i = 0; i < s->volume->cloud_count; i++)
        swept += s->columns[i].depth != NULL;
    return swept;
}
