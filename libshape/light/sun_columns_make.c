/* One cloud's columns along the sun: the first light pass of Jiménez 2018 section 3.5 without its march from every cell. A
 * cloud's grid has layers across the axis that the sun runs along most steeply; from layer to layer the columns move with
 * the sun's light (a sheared grid), so that a column's sum is the optical depth along the sun. */
#include "light/sun_columns.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "field/clones.h"
#include "field/row.h"
#include "light/lightgrid_layout.h"

enum {
    ROWS = 8,    /* of a layer, for which primitives are gathered at once, at most */
    BLOCKS = 16, /* of rows at least, where there is more than one thread: so they end together */
    LARGE = 8192 /* cells: below these waking a thread takes longer than it saves */
};

static void lay_out(const shape_volume_cloud *cloud, shape_dvec3 sun, int resolution, sun_layout *c)
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
    c->upward = (&d.x)[up] > 0 ? 1 : 0;
    c->length = (float)fmin(cloud->medium.extinction / steepest, 1e30);
    for (int i = 0; i < 2; i++) {
        c->shear[i] = (float)(-(&d.x)[c->axis[i]] / cell[c->axis[i]] / steepest);
        float over = -c->shear[i] * (float)(c->size[2] - 1);
        c->first[i] = (int)floorf(fminf(over, 0)) - 1;
        c->count[i] = (int)ceilf(fmaxf(over, 0)) + c->size[i] + 1 - c->first[i];
    }
}

static float layer_place(const sun_layout *c, int layer)
{
    int index = c->upward ? c->size[2] - 1 - layer : layer;
    return c->low[2] + c->cell[2] * ((float)index + 0.5f);
}

/* The columns [*first, *end) that cross the grid in a layer. */
static void find_range(const sun_layout *c, int side, int layer, int *first, int *end)
{
    float moved = c->shear[side] * (float)layer;
    *first = (int)ceilf(-moved) - c->first[side];
    *end = (int)floorf((float)(c->size[side] - 1) - moved) - c->first[side] + 1;
}

/* Columns that are being made. */
typedef struct columns_work {
    const shape_volume_cloud *cloud; /* with no more octaves than the cells can show */
    const sun_columns *columns;
    float *density;             /* the columns', or, where none are kept, its depths, not yet summed */
    const shape_change *change; /* NULL: all rows are evaluated, and density is zeroed */
    bool sum_all;               /* though few rows have changed */
    shape_stop stop;
} columns_work;

/* The first of the cells of a row. */
static size_t row_start(const sun_layout *c, int layer, int row)
{
    return ((size_t)layer * (size_t)c->count[1] + (size_t)row) * (size_t)c->count[0];
}

/* Where rows [from, to) of a layer have their points: points gets a row of them, *first its first column, box what is around their
 * cells. False where they have none. */
static bool find_rows(const sun_layout *c, int layer, int *from, int *to, field_row *points, int *first,
                      shape_box *box)
{
    int end, first_row, end_row;
    find_range(c, 0, layer, first, &end);
    find_range(c, 1, layer, &first_row, &end_row);
    *from = *from > first_row ? *from : first_row;
    *to = *to < end_row ? *to : end_row;
    if (*first >= end || *from >= *to)
        return false;
    const int *axis = c->axis;
    float moved[2];
    *points = (field_row){axis[0], end - *first, {0}, c->cell[0]};
    for (int side = 0; side < 2; side++)
        moved[side] = c->shear[side] * (float)layer + (float)c->first[side];
    points->low[axis[0]] = c->low[0] + c->cell[0] * (moved[0] + (float)*first);
    points->low[axis[2]] = layer_place(c, layer);
    points->low[axis[1]] = 0;
    box->min = (shape_vec3){points->low[0], points->low[1], points->low[2]};
    box->max = box->min;
    (&box->max.x)[axis[0]] += c->cell[0] * (float)points->count;
    (&box->min.x)[axis[1]] = c->low[1] + c->cell[1] * (moved[1] + (float)*from);
    (&box->max.x)[axis[1]] = c->low[1] + c->cell[1] * (moved[1] + (float)*to);
    return true;
}

/* Densities of a layer's rows [from, to). */
static shape_status fill_rows(const columns_work *work, int layer, int from, int to, row_forms *list,
                              shape_error *error)
{
    const shape_volume_cloud *cloud = work->cloud;
    const sun_layout *c = &work->columns->at;
    const bool grid = cloud->field.model == SHAPE_MODEL_GRID;
    field_row points;
    shape_box box;
    int first;
    if (!find_rows(c, layer, &from, &to, &points, &first, &box))
        return SHAPE_OK;
    shape_status status = row_collect(cloud, box.min, box.max, list, error);
    if (status || !list->count)
        return status;
    const float moved = c->shear[1] * (float)layer + (float)c->first[1];
    for (int j = from; j < to && !status; j++) {
        float u2[ROW_MOST];
        points.low[c->axis[1]] = c->low[1] + c->cell[1] * (moved + (float)j + 0.5f);
        row_u2(list, cloud->support, &points, u2);
        for (int i = 0; i < points.count && grid; i++)
            u2[i] = 0;
        row_density(cloud, list, &points, u2, work->density + row_start(c, layer, j) + first);
        status = row_stopped(list, error);
    }
    return status;
}

/* Fills a row again where the change touches it; *filled: it did. */
static shape_status fill_row_again(const columns_work *work, int layer, int row, row_forms *list,
                                   bool *filled, shape_error *error)
{
    const sun_layout *c = &work->columns->at;
    int from = row, to = row + 1, first;
    field_row points;
    shape_box box;
    *filled = false;
    if (!find_rows(c, layer, &from, &to, &points, &first, &box) || !shape_change_touches(work->change, box))
        return SHAPE_OK;
    memset(work->density + row_start(c, layer, row), 0, (size_t)c->count[0] * sizeof *work->density);
    *filled = true;
    return fill_rows(work, layer, row, row + 1, list, error);
}

/* Densities become optical depths at the middles of cells, down one row of columns; both may be the same array. */
NEPHELE_CLONES
static void add_up(const sun_layout *c, int row, const float *density, float *restrict above, float *depth)
{
    const int count = c->count[0];
    const float length = c->length, most = SUN_DEEPEST;
    for (int i = 0; i < count; i++)
        above[i] = 0;
    for (int layer = 0; layer < c->size[2]; layer++) {
        const size_t start = ((size_t)layer * (size_t)c->count[1] + (size_t)row) * (size_t)count;
        const float *from = density + start;
        float *to = depth + start;
#pragma omp simd
        for (int i = 0; i < count; i++) {
            float own = from[i] * length;
            own = own < most ? own : most;
            to[i] = above[i] + 0.5f * own;
            above[i] += own;
        }
    }
}

/* As in shape/bake.h: no more octaves than the cells can show, the mean of the rest. */
static shape_volume_cloud with_fewer_octaves(const sun_order *order, const sun_layout *c)
{
    const shape_volume_cloud *cloud = order->cloud;
    shape_volume_cloud copy = *cloud;
    float edge = fminf(c->cell[0], fminf(c->cell[1], c->cell[2])), noise = 1 / cloud->inverse_noise_scale;
    int octaves = 1;
    for (; octaves < cloud->field.octaves && noise > edge; octaves++)
        noise /= 2;
    copy.mean_octaves = cloud->field.octaves - octaves;
    copy.field.octaves = octaves;
    copy.stop = &order->stop;
    return copy;
}

enum { MOST_COLUMNS = 3 * 258 };

/* Rows [row, row + rows) of columns, from the top to the bottom: nobody else needs them, so threads never wait. Returns how
 * many were evaluated. */
static int sweep_rows(const columns_work *work, int row, int rows, row_forms *list, shape_error *error)
{
    const sun_layout *c = &work->columns->at;
    float above[MOST_COLUMNS];
    for (int layer = 0; layer < c->size[2]; layer++)
        if (fill_rows(work, layer, row, row + rows, list, error))
            return 0;
    for (int j = row; j < row + rows && j < c->count[1]; j++)
        add_up(c, j, work->density, above, work->columns->depth);
    return rows * c->size[2];
}

/* Row `row` of columns, where the change touches it. */
static int sweep_row_again(const columns_work *work, int row, row_forms *list, shape_error *error)
{
    const sun_layout *c = &work->columns->at;
    float above[MOST_COLUMNS];
    int evaluated = 0;
    for (int layer = 0; layer < c->size[2]; layer++) {
        bool filled;
        if (fill_row_again(work, layer, row, list, &filled, error))
            return 0;
        evaluated += filled;
    }
    if (evaluated || work->sum_all)
        add_up(c, row, work->density, above, work->columns->depth);
    return evaluated;
}

static shape_status sweep_blocks(const columns_work *work, int rows, int threads, uint64_t *evaluated,
                                 shape_error *error)
{
    const int blocks = (work->columns->at.count[1] + rows - 1) / rows;
    uint64_t sum = 0;
    shape_status status = SHAPE_OK;
#pragma omp parallel num_threads(threads) reduction(+ : sum)
    {
        row_forms list = {.watch.stop = work->stop};
        shape_error own = {0};
#pragma omp for schedule(dynamic, 1) nowait
        for (int i = 0; i < blocks; i++) {
            if (own.status)
                continue;
            sum += (uint64_t)(work->change ? sweep_row_again(work, i, &list, &own)
                                           : sweep_rows(work, i * rows, rows, &list, &own));
        }
        free(list.items);
        shape_error_join(&own, &status, error);
    }
    *evaluated += sum;
    return status;
}

/* --- new ones, and earlier ones --- */

size_t sun_columns_cells(const sun_layout *at)
{
    return (size_t)at->count[0] * (size_t)at->count[1] * (size_t)at->size[2];
}

void sun_columns_drop(sun_columns *columns)
{
    if (!columns || atomic_fetch_sub(&columns->uses, 1) > 1)
        return;
    free(columns->density);
    free(columns->depth);
    free(columns);
}

static sun_columns *create(const sun_layout *at, bool keep)
{
    sun_columns *columns = calloc(1, sizeof *columns);
    if (!columns)
        return NULL;
    atomic_init(&columns->uses, 1);
    columns->at = *at;
    columns->depth = calloc(sun_columns_cells(at), sizeof *columns->depth);
    if (columns->depth && keep)
        columns->density = calloc(sun_columns_cells(at), sizeof *columns->density);
    if (columns->depth && !(keep && !columns->density))
        return columns;
    sun_columns_drop(columns);
    return NULL;
}

/* A copy, which may be changed. */
static sun_columns *copy(const sun_columns *from)
{
    sun_columns *columns = create(&from->at, true);
    const size_t bytes = sun_columns_cells(&from->at) * sizeof(float);
    if (columns) {
        memcpy(columns->depth, from->depth, bytes);
        memcpy(columns->density, from->density, bytes);
    }
    return columns;
}

/* Everything of a layout but what its sums are multiplied by. */
static bool same_place(const sun_layout *a, const sun_layout *b)
{
    return !memcmp(a, b, offsetof(sun_layout, length));
}

/* Threads for so many rows of columns; *rows: how many of them are taken at once. */
static int share_out(const sun_layout *at, int threads, int *rows)
{
    threads = sun_columns_cells(at) < LARGE ? 1 : threads;
    *rows = ROWS;
    while (threads > 1 && *rows > 1 && at->count[1] < *rows * BLOCKS)
        *rows /= 2;
    return threads;
}

static shape_status make_new(const sun_order *order, const sun_layout *at, sun_columns **made,
                             uint64_t *count, shape_error *error)
{
    int rows, threads = share_out(at, order->threads, &rows);
    sun_columns *columns = create(at, order->keep);
    if (!columns)
        return shape_error_memory(error);
    const shape_volume_cloud coarse = with_fewer_octaves(order, at);
    const columns_work work = {.cloud = &coarse,
                               .columns = columns,
                               .density = columns->density ? columns->density : columns->depth,
                               .stop = order->stop};
    shape_status status = sweep_blocks(&work, rows, threads, count, error);
    if (status)
        sun_columns_drop(columns);
    else
        *made = columns;
    return status;
}

/* From earlier ones that lie in the same place. */
static shape_status make_again(const sun_order *order, const sun_layout *at, sun_columns **earlier,
                               sun_columns **made, uint64_t *count, shape_error *error)
{
    static const shape_change none = {0};
    const shape_change *change = order->change ? order->change : &none;
    const bool same_length = (*earlier)->at.length == at->length;
    if (same_length && !shape_change_is_any(change)) {
        atomic_fetch_add(&(*earlier)->uses, 1);
        *made = *earlier;
        return SHAPE_OK;
    }
    sun_columns *columns = *earlier;
    if (atomic_load(&columns->uses) > 1)
        columns = copy(columns);
    else
        *earlier = NULL;
    if (!columns)
        return shape_error_memory(error);
    columns->at = *at;
    const shape_volume_cloud coarse = with_fewer_octaves(order, at);
    const columns_work work = {.cloud = &coarse,
                               .columns = columns,
                               .density = columns->density,
                               .change = change,
                               .sum_all = !same_length,
                               .stop = order->stop};
    int rows;
    shape_status status = sweep_blocks(&work, 1, share_out(at, order->threads, &rows), count, error);
    if (status)
        sun_columns_drop(columns);
    else
        *made = columns;
    return status;
}

shape_status sun_columns_make(const sun_order *order, sun_columns **earlier, sun_columns **made,
                              uint64_t *rows, shape_error *error)
{
    sun_layout at;
    memset(&at, 0, sizeof at);
    lay_out(order->cloud, order->sun, order->resolution, &at);
    bool all = order->change && order->change->all;
    if (order->keep && !all && *earlier && (*earlier)->density && same_place(&(*earlier)->at, &at))
        return make_again(order, &at, earlier, made, rows, error);
    return make_new(order, &at, made, rows, error);
}
