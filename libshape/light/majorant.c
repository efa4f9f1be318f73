/* Builds the majorant grid: which primitives reach into a cell, and what their extinction is bounded by there. The
 * bounds follow from those of u and of the noise over the cell: the spheroid's n < gamma(u, n) (Jiménez 2018 Eq. 2) caps n by
 * the largest n that still passes at the least u. */
#include "light/majorant.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "light/blocks.h"
#include "shape/grid.h"

#define ALL_PRIMITIVES UINT32_MAX

enum { MAX_CELLS = 1 << 20, MAX_METABALLS_BOUNDED = 256 };
static const size_t max_found = (size_t)1 << 25; /* half a gigabyte while building */

/* A primitive (or all of a metaball cloud) that reaches into a cell, with the range of its u there. */
typedef struct found_primitive {
    uint32_t cloud, primitive;
    float low, high;
} found_primitive;

typedef struct found_list {
    size_t *first; /* cells + 1 */
    found_primitive *items;
} found_list;

static void ellipsoid_map(const shape_ellipsoid *e, double m[3][4])
{
    double r[3][3], axes[3] = {(double)e->a, (double)e->b, (double)e->c};
    shape_quat_matrix(e->q, r);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            m[i][j] = r[j][i] / axes[i];
        m[i][3] = -(m[i][0] * (double)e->x + m[i][1] * (double)e->y + m[i][2] * (double)e->z);
    }
}

static void sphere_map(const shape_sphere *s, double m[3][4])
{
    double inverse = 1 / (double)s->radius, centre[3] = {(double)s->x, (double)s->y, (double)s->z};
    memset(m, 0, 12 * sizeof(double));
    for (int i = 0; i < 3; i++) {
        m[i][i] = inverse;
        m[i][3] = -centre[i] * inverse;
    }
}

static shape_status prepare_cloud(majorant_grid *grid, const shape_volume_cloud *source,
                                  majorant_cloud *cloud, shape_error *error)
{
    cloud->cloud = source;
    cloud->extinction = source->medium.extinction;
    cloud->mean = majorant_noise_mean(source);
    cloud->whole = source->detailed || source->field.model == SHAPE_MODEL_METABALL ||
                   source->field.model == SHAPE_MODEL_GRID;
    memcpy(cloud->to_local, source->inverse.m, sizeof cloud->to_local);
    shape_dvec3 offset = shape_frame_point(&source->inverse, grid->origin);
    cloud->to_local[0][3] = offset.x;
    cloud->to_local[1][3] = offset.y;
    cloud->to_local[2][3] = offset.z;
    shape_dvec3 low, high;
    shape_frame_box(&source->frame, source->box, &low, &high);
    for (int a = 0; a < 3; a++) { /* boxes are of single precision */
        double margin = 1e-5 * ((&high.x)[a] - (&low.x)[a]);
        cloud->low[a] = (&low.x)[a] - (&grid->origin.x)[a] - margin;
        cloud->high[a] = (&high.x)[a] - (&grid->origin.x)[a] + margin;
    }
    majorant_threshold_tables(cloud);
    size_t count = source->list->ellipsoid_count;
    cloud->ellipsoids = malloc((count + 1) * sizeof *cloud->ellipsoids);
    if (!cloud->ellipsoids)
        return shape_error_memory(error);
    for (size_t i = 0; i < count; i++) {
        double m[3][4];
        ellipsoid_map(&source->list->ellipsoids[i], m);
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 4; c++)
                cloud->ellipsoids[i].m[r][c] = (float)m[r][c];
    }
    return SHAPE_OK;
}

/* The cells that a box in the cloud's frame touches. False where there are none. */
static bool cell_range(const majorant_grid *grid, const majorant_cloud *cloud, shape_box box, int low[3],
                       int high[3])
{
    shape_dvec3 min, max;
    shape_frame_box(&cloud->cloud->frame, box, &min, &max);
    min = shape_dvec3_sub(min, grid->origin);
    max = shape_dvec3_sub(max, grid->origin);
    double from[3] = {min.x, min.y, min.z}, to[3] = {max.x, max.y, max.z};
    for (int a = 0; a < 3; a++) {
        double f = floor(from[a] * grid->inverse_cell[a] - 1e-6),
               t = floor(to[a] * grid->inverse_cell[a] + 1e-6);
        if (!(t >= 0 && f < grid->n[a]))
            return false;
        low[a] = f > 0 ? (int)f : 0;
        high[a] = t < grid->n[a] ? (int)t : grid->n[a] - 1;
    }
    return true;
}

/* outer after inner, 3x4 maps. */
static void compose(const double outer[3][4], const double inner[3][4], double out[3][4])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            out[i][j] = outer[i][0] * inner[0][j] + outer[i][1] * inner[1][j] + outer[i][2] * inner[2][j] +
                        (j == 3 ? outer[i][3] : 0);
}

/* The radius in unit space of a cell about its middle. */
static double cell_radius(const majorant_grid *grid, const double m[3][4])
{
    double most = 0;
    for (int k = 0; k < 4; k++) {
        double h[3] = {grid->cell[0] / 2, k & 1 ? -grid->cell[1] / 2 : grid->cell[1] / 2,
                       k & 2 ? -grid->cell[2] / 2 : grid->cell[2] / 2};
        double sum = 0;
        for (int i = 0; i < 3; i++) {
            double v = m[i][0] * h[0] + m[i][1] * h[1] + m[i][2] * h[2];
            sum += v * v;
        }
        most = sum > most ? sum : most; /* no fmax: gcc 12 for arm64 breaks down over it */
    }
    return sqrt(most) * (1 + 1e-6) + 1e-7;
}

/* What to do with a cell that something reaches into: count it, or also store it. */
static void note(const majorant_grid *grid, found_list *found, bool store, int x, int y, int z,
                 found_primitive item)
{
    size_t index = (size_t)x + (size_t)grid->n[0] * ((size_t)y + (size_t)grid->n[1] * (size_t)z);
    if (store)
        found->items[found->first[index]] = item;
    found->first[index]++;
}

static void scan_primitive(const majorant_grid *grid, uint32_t index, uint32_t primitive, shape_box box,
                           const double map[3][4], found_list *found, bool store)
{
    const majorant_cloud *cloud = &grid->clouds[index];
    int low[3], high[3];
    double m[3][4];
    if (!cell_range(grid, cloud, box, low, high))
        return;
    compose(map, (const double(*)[4])cloud->to_local, m);
    double radius = cell_radius(grid, (const double(*)[4])m), support = (double)cloud->cloud->support;
    for (int z = low[2]; z <= high[2]; z++)
        for (int y = low[1]; y <= high[1]; y++)
            for (int x = low[0]; x <= high[0]; x++) {
                double p[3] = {(x + 0.5) * grid->cell[0], (y + 0.5) * grid->cell[1],
                               (z + 0.5) * grid->cell[2]};
                double sum = 0;
                for (int i = 0; i < 3; i++) {
                    double v = m[i][0] * p[0] + m[i][1] * p[1] + m[i][2] * p[2] + m[i][3];
                    sum += v * v;
                }
                double u = sqrt(sum);
                if (u - radius > support)
                    continue;
                found_primitive item = {index, primitive, (float)fmax(u - radius, 0), (float)(u + radius)};
                note(grid, found, store, x, y, z, item);
            }
}

static void scan_cloud(const majorant_grid *grid, uint32_t index, found_list *found, bool store)
{
    const shape_volume_cloud *cloud = grid->clouds[index].cloud;
    const shape_primitives *list = cloud->list;
    int low[3], high[3];
    if (cloud->field.model == SHAPE_MODEL_GRID ||
        (cloud->field.model == SHAPE_MODEL_METABALL && !cloud->detailed)) {
        found_primitive item = {index, ALL_PRIMITIVES, 0, 1};
        if (cell_range(grid, &grid->clouds[index], cloud->box, low, high))
            for (int z = low[2]; z <= high[2]; z++)
                for (int y = low[1]; y <= high[1]; y++)
                    for (int x = low[0]; x <= high[0]; x++)
                        note(grid, found, store, x, y, z, item);
        return;
    }
    double map[3][4];
    for (size_t i = 0; i < list->sphere_count; i++) {
        sphere_map(&list->spheres[i], map);
        scan_primitive(grid, index, (uint32_t)i, shape_sphere_box(&list->spheres[i], cloud->support),
                       (const double(*)[4])map, found, store);
    }
    for (size_t i = 0; i < list->ellipsoid_count; i++) {
        ellipsoid_map(&list->ellipsoids[i], map);
        scan_primitive(grid, index, (uint32_t)(list->sphere_count + i),
                       shape_ellipsoid_box(&list->ellipsoids[i], cloud->support), (const double(*)[4])map,
                       found, store);
    }
}

static size_t cell_count(const majorant_grid *grid)
{
    return (size_t)grid->n[0] * (size_t)grid->n[1] * (size_t)grid->n[2];
}

/* Counts, makes room, then stores, cell after cell. SHAPE_ERROR_LIMIT asks for a coarser grid. */
static shape_status find_primitives(const majorant_grid *grid, found_list *found, shape_error *error)
{
    size_t cells = cell_count(grid), sum = 0;
    found->first = calloc(cells + 1, sizeof *found->first);
    found->items = NULL;
    if (!found->first)
        return shape_error_memory(error);
    for (size_t i = 0; i < grid->cloud_count; i++)
        scan_cloud(grid, (uint32_t)i, found, false);
    for (size_t i = 0; i <= cells; i++) {
        size_t here = found->first[i];
        found->first[i] = sum;
        sum += here;
    }
    if (sum > max_found)
        return shape_error_set(error, SHAPE_ERROR_LIMIT, "too many primitives overlap (use fewer)");
    found->items = malloc((sum + 1) * sizeof *found->items);
    if (!found->items)
        return shape_error_memory(error);
    for (size_t i = 0; i < grid->cloud_count; i++)
        scan_cloud(grid, (uint32_t)i, found, true);
    memmove(found->first + 1, found->first, cells * sizeof *found->first);
    found->first[0] = 0;
    return SHAPE_OK;
}

/* Bounds of a metaball cloud's field F over a cell. */
static void metaball_range(const majorant_cloud *cloud, const double middle[3], double radius, double *low,
                           double *high)
{
    const shape_primitives *list = cloud->cloud->list;
    *low = *high = 0;
    for (size_t i = 0; i < list->sphere_count + list->ellipsoid_count; i++) {
        double m[3][4], sum = 0;
        double reach = radius;
        if (i < list->sphere_count) {
            sphere_map(&list->spheres[i], m);
            reach /= (double)list->spheres[i].radius;
        } else {
            const shape_ellipsoid *e = &list->ellipsoids[i - list->sphere_count];
            ellipsoid_map(e, m);
            reach /= fmin((double)e->a, fmin((double)e->b, (double)e->c));
        }
        for (int r = 0; r < 3; r++) {
            double v = m[r][0] * middle[0] + m[r][1] * middle[1] + m[r][2] * middle[2] + m[r][3];
            sum += v * v;
        }
        double near = fmax(sqrt(sum) - reach, 0), far = sqrt(sum) + reach;
        *low += 1 / fmax(far * far, 1e-6);
        *high += 1 / fmax(near * near, 1e-6);
    }
    *low *= 1 - 1e-5;
    *high *= 1 + 1e-5;
}

typedef struct cell_box {
    double middle[3], half[3], radius; /* in the cloud's frame */
} cell_box;

static cell_box local_box(const majorant_grid *grid, const majorant_cloud *cloud, size_t index)
{
    size_t nx = (size_t)grid->n[0], ny = (size_t)grid->n[1];
    size_t at[3] = {index % nx, index / nx % ny, index / nx / ny};
    cell_box box;
    for (int i = 0; i < 3; i++) {
        box.middle[i] = cloud->to_local[i][3];
        box.half[i] = 0;
        for (int j = 0; j < 3; j++) {
            box.middle[i] += cloud->to_local[i][j] * ((double)at[j] + 0.5) * grid->cell[j];
            box.half[i] += fabs(cloud->to_local[i][j]) * grid->cell[j] / 2;
        }
    }
    box.radius = sqrt(box.half[0] * box.half[0] + box.half[1] * box.half[1] + box.half[2] * box.half[2]);
    return box;
}

/* With details the density is the noise, taken where the displacement leads, or less of it. */
static void detailed_range(const majorant_grid *grid, const majorant_cloud *cloud, size_t index, float *least,
                           float *most)
{
    cell_box box = local_box(grid, cloud, index);
    float low;
    *least = 0;
    *most = 1;
    if (cloud->cloud->field.model != SHAPE_MODEL_SPHEROID &&
        cloud->cloud->field.model != SHAPE_MODEL_METABALL)
        return;
    for (int a = 0; a < 3; a++)
        box.half[a] += (double)cloud->cloud->field.detail.displace;
    majorant_noise_range(cloud->cloud, box.middle, box.half, &low, most);
    *most = fminf(*most, 1);
}

/* A little more than the cell, as a place in it may be rounded out of it. */
static void grid_range(const majorant_grid *grid, const majorant_cloud *cloud, size_t index, float *least,
                       float *most)
{
    cell_box box = local_box(grid, cloud, index);
    double low[3], high[3];
    for (int a = 0; a < 3; a++) {
        double margin = 1e-3 + 1e-6 * fabs(box.middle[a]);
        low[a] = box.middle[a] - box.half[a] - margin;
        high[a] = box.middle[a] + box.half[a] + margin;
    }
    shape_grid_range(cloud->cloud->list->grid, low, high, least, most);
}

/* The range of the density of one cloud over a cell, with its least u in [low, high]. */
static void density_range(const majorant_grid *grid, const majorant_cloud *cloud, size_t index, double low,
                          double high, majorant_group *group, float *least, float *most)
{
    shape_model model = cloud->cloud->field.model;
    float noise_low, noise_high;
    if (cloud->cloud->detailed) {
        detailed_range(grid, cloud, index, least, most);
        return;
    }
    if (model == SHAPE_MODEL_GRID) {
        grid_range(grid, cloud, index, least, most);
        return;
    }
    *least = high <= 1 ? 1 : 0;
    *most = low <= 1 ? 1 : 0;
    if (model == SHAPE_MODEL_UNIFORM || *most <= 0)
        return;
    cell_box box = local_box(grid, cloud, index);
    *least = 0;
    if (model == SHAPE_MODEL_METABALL) {
        double edge = (double)cloud->cloud->field.edge, field_low = 0, field_high = INFINITY;
        if (cloud->cloud->list->sphere_count + cloud->cloud->list->ellipsoid_count <= MAX_METABALLS_BOUNDED)
            metaball_range(cloud, box.middle, box.radius, &field_low, &field_high);
        *most = 0;
        if (field_high < 1)
            return;
        majorant_noise_range(cloud->cloud, box.middle, box.half, &noise_low, &noise_high);
        if (edge * (double)noise_low > field_high)
            return;
        *most = fminf(noise_high, edge > 0 ? (float)fmin(field_high / edge * 1.00001, 2) : 1);
        if (field_low >= 1 && edge * (double)noise_high < field_low)
            *least = noise_low;
        return;
    }
    float top = cloud->top[(int)(low * MAJORANT_TABLE)];
    majorant_noise_range(cloud->cloud, box.middle, box.half, &noise_low, &noise_high);
    *most = noise_low < top ? fminf(noise_high, top) : 0;
    if (high < 1 && noise_high < cloud->bottom[(int)(high * MAJORANT_TABLE) + 1])
        *least = noise_low;
    group->low = noise_low;
    group->high = noise_high;
}

/* One cloud's share of a cell: the primitives that can be nearest there, and the bounds. False where it is empty. */
static bool refine_group(const majorant_grid *grid, size_t index, const found_primitive *items, size_t count,
                         uint32_t *entries, majorant_group *group)
{
    const majorant_cloud *cloud = &grid->clouds[items[0].cloud];
    double low = INFINITY, high = INFINITY;
    float least, most;
    for (size_t i = 0; i < count; i++) {
        low = fmin(low, (double)items[i].low);
        high = fmin(high, (double)items[i].high);
    }
    group->low = 0;
    group->high = 1;
    density_range(grid, cloud, index, low, high, group, &least, &most);
    group->min = least * cloud->extinction;
    group->max = most * cloud->extinction;
    group->cloud = items[0].cloud;
    group->spheres = group->ellipsoids = 0;
    for (size_t i = 0; i < count; i++) {
        if (cloud->whole || (double)items[i].low > high)
            continue;
        size_t spheres = cloud->cloud->list->sphere_count;
        bool sphere = items[i].primitive < spheres;
        entries[group->spheres + group->ellipsoids] =
            sphere ? items[i].primitive : (uint32_t)(items[i].primitive - spheres);
        group->spheres += sphere;
        group->ellipsoids += !sphere;
    }
    return group->max > 0;
}

static void refine_cell(majorant_grid *grid, const found_list *found, size_t index)
{
    majorant_cell *cell = &grid->cells[index];
    double min = 0, max = 0;
    cell->count = 0;
    for (size_t i = found->first[index], end = found->first[index + 1]; i < end;) {
        size_t next = i + 1;
        while (next < end && found->items[next].cloud == found->items[i].cloud)
            next++;
        majorant_group *group = &grid->groups[cell->first + cell->count];
        group->first = (uint32_t)i;
        if (refine_group(grid, index, &found->items[i], next - i, &grid->entries[i], group)) {
            min += (double)group->min;
            max += (double)group->max;
            cell->count++;
        }
        i = next;
    }
    cell->min = (float)min;
    cell->max = (float)max;
}

static shape_status fill_cells(majorant_grid *grid, const found_list *found, shape_error *error)
{
    size_t cells = cell_count(grid), groups = 0;
    grid->cells = calloc(cells + 1, sizeof *grid->cells);
    grid->entries = malloc((found->first[cells] + 1) * sizeof *grid->entries);
    if (!grid->cells || !grid->entries)
        return shape_error_memory(error);
    for (size_t c = 0; c < cells; c++) {
        grid->cells[c].first = (uint32_t)groups;
        for (size_t i = found->first[c]; i < found->first[c + 1]; i++) /* NOLINTNEXTLINE: all are filled */
            groups += i == found->first[c] || found->items[i].cloud != found->items[i - 1].cloud;
    }
    grid->groups = malloc((groups + 1) * sizeof *grid->groups);
    if (!grid->groups)
        return shape_error_memory(error);
#pragma omp parallel for schedule(dynamic, 256)
    for (size_t c = 0; c < cells; c++)
        refine_cell(grid, found, c);
    return SHAPE_OK;
}

/* The edge that a cell should have for a cloud [m, world]: a little more than a lattice cell, as finer ones bound the noise
 * better but take longer to walk through, and a part of the whole at the most. */
static double wanted_cell(const shape_volume_cloud *cloud)
{
    double scale = cbrt(fabs(shape_frame_determinant(&cloud->frame)));
    double sides = ((double)cloud->box.max.x - (double)cloud->box.min.x) +
                   ((double)cloud->box.max.y - (double)cloud->box.min.y) +
                   ((double)cloud->box.max.z - (double)cloud->box.min.z);
    double size = 1.3 * (double)cloud->field.noise_scale;
    if (cloud->field.model == SHAPE_MODEL_UNIFORM || !(size > 0))
        size = sides / 3 / 32;
    return fmin(size, sides / 3 / 16) * scale;
}

/* World box and resolution. False where there is nothing to see. */
static bool lay_out(majorant_grid *grid, const shape_volume *volume)
{
    shape_dvec3 min = {INFINITY, INFINITY, INFINITY}, max = {-INFINITY, -INFINITY, -INFINITY};
    double size = INFINITY;
    for (size_t i = 0; i < volume->cloud_count; i++) {
        const shape_volume_cloud *cloud = &volume->clouds[i];
        shape_dvec3 a, b;
        if (shape_box_is_empty(cloud->box) || !(cloud->medium.extinction > 0))
            continue;
        shape_frame_box(&cloud->frame, cloud->box, &a, &b);
        min = shape_dvec3_make(fmin(min.x, a.x), fmin(min.y, a.y), fmin(min.z, a.z));
        max = shape_dvec3_make(fmax(max.x, b.x), fmax(max.y, b.y), fmax(max.z, b.z));
        size = fmin(size, wanted_cell(cloud));
    }
    if (!(size < INFINITY))
        return false;
    shape_dvec3 extent = shape_dvec3_sub(max, min);
    grid->extent[0] = extent.x, grid->extent[1] = extent.y, grid->extent[2] = extent.z;
    grid->origin = min;
    double total;
    do {
        total = 1;
        for (int a = 0; a < 3; a++) {
            double n = fmin(fmax(ceil(grid->extent[a] / size), 8), 4096);
            grid->n[a] = (int)n;
            total *= n;
        }
        size *= 1.25;
    } while (total > MAX_CELLS);
    return true;
}

static void size_cells(majorant_grid *grid)
{
    for (int a = 0; a < 3; a++) {
        grid->cell[a] = grid->extent[a] / grid->n[a];
        grid->inverse_cell[a] = 1 / grid->cell[a];
    }
}

static void find_sparse(majorant_grid *grid)
{
    for (size_t i = 0; i < grid->cloud_count; i++) {
        const majorant_cloud *cloud = &grid->clouds[i];
        for (int a = 0; a < 3 && cloud->high[a] > cloud->low[a]; a++)
            grid->sparse = grid->sparse || cloud->high[a] - cloud->low[a] < 4 * grid->cell[a];
    }
}

static shape_status add_blocks(majorant_grid *grid, shape_error *error)
{
    grid->blocks = malloc(sizeof *grid->blocks);
    return grid->blocks ? block_grid_build(grid->blocks, grid->clouds[0].cloud, grid->origin, error)
                        : shape_error_memory(error);
}

shape_status majorant_grid_build(majorant_grid *grid, const shape_volume *volume, shape_error *error)
{
    memset(grid, 0, sizeof *grid);
    if (!lay_out(grid, volume))
        return SHAPE_OK;
    grid->clouds = calloc(volume->cloud_count, sizeof *grid->clouds);
    if (!grid->clouds)
        return shape_error_memory(error);
    shape_status status = SHAPE_OK;
    for (size_t i = 0; i < volume->cloud_count && !status; i++) {
        status = prepare_cloud(grid, &volume->clouds[i], &grid->clouds[i], error);
        grid->cloud_count = i + 1;
    }
    if (!status && volume->cloud_count == 1 && volume->clouds[0].field.model == SHAPE_MODEL_GRID)
        return add_blocks(grid, error);
    while (!status) {
        found_list found = {NULL, NULL};
        size_cells(grid);
        status = find_primitives(grid, &found, error);
        if (!status)
            status = fill_cells(grid, &found, error);
        free(found.first);
        free(found.items);
        bool coarser = status == SHAPE_ERROR_LIMIT && cell_count(grid) > 512;
        if (!coarser)
            break;
        for (int a = 0; a < 3; a++)
            grid->n[a] = (grid->n[a] + 1) / 2;
        status = SHAPE_OK;
    }
    find_sparse(grid);
    return status;
}

void majorant_grid_free(majorant_grid *grid)
{
    for (size_t i = 0; i < grid->cloud_count; i++)
        free(grid->clouds[i].ellipsoids);
    if (grid->blocks)
        block_grid_free(grid->blocks);
    free(grid->blocks);
    free(grid->clouds);
    free(grid->cells);
    free(grid->groups);
    free(grid->entries);
    memset(grid, 0, sizeof *grid);
}
