/* Mean densities of a light grid's cells, from eight points each: what the scattered light needs, no finer. */
#include "light/lightgrid_density.h"

#include <omp.h>
#include <stdlib.h>

#include "field/row.h"
#include "light/lightgrid_layout.h"

/* Adds the densities of a row of half cells, for which the primitives are known. */
static void add_half_row(const shape_volume_cloud *cloud, row_forms *list, const field_row *row, float *sums)
{
    enum { WHOLE = ROW_MOST / 2 };
    float u2[ROW_MOST], density[ROW_MOST];
    int cells = row->count / 2;
    for (int begin = 0; begin < cells; begin += WHOLE) {
        field_row part = *row;
        part.low[0] += part.step * (float)(2 * begin);
        part.count = 2 * (cells - begin < WHOLE ? cells - begin : WHOLE);
        row_u2(list, cloud->support, &part, u2);
        for (int i = 0; i < part.count && cloud->field.model == SHAPE_MODEL_GRID; i++)
            u2[i] = 0;
        row_density(cloud, list, &part, u2, density);
        for (int i = 0; i < part.count / 2; i++)
            sums[begin + i] += density[2 * i] + density[2 * i + 1];
    }
}

/* A row of cells along x. */
static shape_status fill_row(const shape_volume_cloud *cloud, const shape_lightgrid *grid, int y, int z,
                             row_forms *list, shape_error *error)
{
    const int across = grid->size[0];
    float *out = grid->densities + ((size_t)z * (size_t)grid->size[1] + (size_t)y) * (size_t)across;
    for (int x = 0; x < across; x++)
        out[x] = 0;
    shape_status status = row_collect(cloud, lightgrid_point(grid, 0, y, z, 0, 0, 0),
                                      lightgrid_point(grid, across, y, z, 0, 1, 1), list, error);
    for (int corner = 0; corner < 4 && list->count && !status; corner++) {
        shape_vec3 low =
            lightgrid_point(grid, 0, y, z, 0, corner & 1 ? 0.75f : 0.25f, corner & 2 ? 0.75f : 0.25f);
        field_row row = {
            0, 2 * across, {low.x, low.y, low.z}, (grid->box.max.x - grid->box.min.x) / (float)(2 * across)};
        add_half_row(cloud, list, &row, out);
        status = row_stopped(list, error);
    }
    for (int x = 0; x < across; x++)
        out[x] /= 8;
    return status;
}

static bool is_touched(const shape_change *change, const shape_lightgrid *grid, int y, int z)
{
    const float more = 0.01f; /* of a cell: places of cells are rounded */
    return !change ||
           shape_change_touches(
               change, (shape_box){lightgrid_point(grid, 0, y, z, 0, -more, -more),
                                   lightgrid_point(grid, grid->size[0], y, z, 0, 1 + more, 1 + more)});
}

shape_status lightgrid_fill_densities(const shape_volume_cloud *cloud, const shape_lightgrid *grid,
                                      const shape_change *change, int threads, shape_stop stop,
                                      shape_error *error)
{
    const int rows = grid->size[1] * grid->size[2];
    shape_status status = SHAPE_OK;
#pragma omp parallel num_threads(threads)
    {
        row_forms list = {.watch.stop = stop};
        shape_error own = {0};
#pragma omp for schedule(dynamic, 4)
        for (int i = 0; i < rows; i++) {
            const int y = i % grid->size[1], z = i / grid->size[1];
            if (!own.status && is_touched(change, grid, y, z))
                fill_row(cloud, grid, y, z, &list, &own);
        }
        free(list.items);
        shape_error_join(&own, &status, error);
    }
    return status;
}
