/* Density to a grid, block by block: a block asks the tree once which primitives touch it, then each voxel asks those. */
#include "shape/bake.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "field/row.h"

enum {
    BLOCK = SHAPE_BAKE_BLOCK,
    BRICK = 2 * BLOCK
}; /* bricks are what a thread takes and the tree is asked about */

float shape_bake_voxel(const shape_volume_cloud *cloud, float wanted, size_t most)
{
    if (shape_box_is_empty(cloud->box))
        return wanted;
    shape_vec3 size = shape_vec3_sub(cloud->box.max, cloud->box.min);
    float voxel = wanted;
    for (int round = 0; round < 200; round++, voxel *= 1.05f) {
        double count = 1;
        for (int axis = 0; axis < 3; axis++)
            count *= ceil((double)((&size.x)[axis] / voxel)) + 2 * BRICK;
        if (count <= (double)most)
            break;
    }
    return voxel;
}

static shape_status lay_out(const shape_volume_cloud *cloud, float voxel, shape_baked *baked,
                            shape_error *error)
{
    shape_box box = cloud->box;
    if (shape_box_is_empty(box))
        box = (shape_box){{0, 0, 0}, {voxel, voxel, voxel}};
    double count = 1;
    baked->voxel = voxel;
    for (int axis = 0; axis < 3; axis++) {
        float low = (&box.min.x)[axis], high = (&box.max.x)[axis];
        double wanted = ceil((double)(high - low) / (double)voxel) + 2;
        double bricks = ceil(wanted / BRICK);
        count *= bricks * BRICK;
        if (!(count < 2e9))
            return shape_error_set(error, SHAPE_ERROR_LIMIT,
                                   "a voxel of %g m makes too large a grid (take a larger one)",
                                   (double)voxel);
        baked->size[axis] = (int)bricks * BRICK;
        float middle = 0.5f * low + 0.5f * high, half = 0.5f * voxel * (float)baked->size[axis];
        (&baked->box.min.x)[axis] = middle - half;
        (&baked->box.max.x)[axis] = middle + half;
    }
    baked->voxels = calloc((size_t)count, 2);
    return baked->voxels ? SHAPE_OK : shape_error_memory(error);
}

static shape_status fill_brick(const shape_volume_cloud *cloud, const shape_baked *baked, const int brick[3],
                               row_forms *list, shape_error *error)
{
    float corner[3], u2[BRICK], density[BRICK];
    for (int axis = 0; axis < 3; axis++)
        corner[axis] = (&baked->box.min.x)[axis] + baked->voxel * (float)(brick[axis] * BRICK);
    float edge = baked->voxel * BRICK;
    shape_vec3 low = {corner[0], corner[1], corner[2]}, high = {low.x + edge, low.y + edge, low.z + edge};
    shape_status status = row_collect(cloud, low, high, list, error);
    if (status || !list->count)
        return status;
    const float unit = 255 / cloud->most;
    for (int k = 0; k < BRICK; k++)
        for (int j = 0; j < BRICK; j++) {
            field_row points = {0, BRICK, {corner[0], corner[1], corner[2]}, baked->voxel};
            points.low[1] += baked->voxel * ((float)j + 0.5f);
            points.low[2] += baked->voxel * ((float)k + 0.5f);
            row_u2(list, cloud->support, &points, u2);
            row_density(cloud, &points, u2, density);
            uint8_t *row = baked->voxels + 2 * (((size_t)(brick[2] * BRICK + k) * (size_t)baked->size[1] +
                                                 (size_t)(brick[1] * BRICK + j)) *
                                                    (size_t)baked->size[0] +
                                                (size_t)(brick[0] * BRICK));
            for (int i = 0; i < BRICK; i++)
                row[2 * i] = (uint8_t)(unit * density[i] + 0.5f);
        }
    return SHAPE_OK;
}

/* One king's-move step along an axis: each block takes the least of itself and its two neighbours plus one. Three axes
 * make one ring. */
static void spread(const int n[3], const uint8_t *from, uint8_t *to, int stride, int axis)
{
    size_t total = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
    for (size_t i = 0; i < total; i++) {
        int place = (int)(i / (size_t)stride) % n[axis];
        uint8_t least = from[i];
        if (place > 0 && from[i - (size_t)stride] < least)
            least = from[i - (size_t)stride];
        if (place + 1 < n[axis] && from[i + (size_t)stride] < least)
            least = from[i + (size_t)stride];
        to[i] = least;
    }
}

/* Rings of blocks round those with matter, up to RINGS; beyond, blocks say RINGS + 1, which is still true. */
static void find_distances(const int n[3], uint8_t *distance, uint8_t *a, uint8_t *b)
{
    enum { RINGS = 24 };
    size_t total = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
    for (size_t i = 0; i < total; i++)
        a[i] = distance[i]; /* 0: matter, 1: none */
    for (int ring = 1; ring <= RINGS; ring++) {
        spread(n, a, b, 1, 0);
        spread(n, b, a, n[0], 1);
        spread(n, a, b, n[0] * n[1], 2);
        memcpy(a, b, total);
        size_t left = 0;
        for (size_t i = 0; i < total; i++) {
            distance[i] = (uint8_t)(distance[i] + a[i]);
            left += a[i];
        }
        if (!left)
            break;
    }
}

static shape_status fill_distances(shape_baked *baked, shape_error *error)
{
    int n[3];
    for (int axis = 0; axis < 3; axis++)
        n[axis] = baked->size[axis] / BLOCK;
    size_t total = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
    uint8_t *blocks = malloc(3 * total);
    if (!blocks)
        return shape_error_memory(error);
    memset(blocks, 1, total);
    const size_t nx = (size_t)baked->size[0], ny = (size_t)baked->size[1], nz = (size_t)baked->size[2];
    for (size_t z = 0; z < nz; z++)
        for (size_t y = 0; y < ny; y++) {
            const uint8_t *row = baked->voxels + 2 * (z * ny + y) * nx;
            uint8_t *to = blocks + ((z / BLOCK) * (size_t)n[1] + y / BLOCK) * (size_t)n[0];
            for (size_t x = 0; x < nx; x++)
                if (row[2 * x])
                    to[x / BLOCK] = 0;
        }
    find_distances(n, blocks, blocks + total, blocks + 2 * total);
    for (size_t z = 0; z < nz; z++)
        for (size_t y = 0; y < ny; y++) {
            uint8_t *row = baked->voxels + 2 * (z * ny + y) * nx;
            const uint8_t *from = blocks + ((z / BLOCK) * (size_t)n[1] + y / BLOCK) * (size_t)n[0];
            for (size_t x = 0; x < nx; x++)
                row[2 * x + 1] = from[x / BLOCK];
        }
    free(blocks);
    return SHAPE_OK;
}

/* The cloud with no more octaves than the voxels can show; the mean of the rest stays. */
static shape_volume_cloud with_fewer_octaves(const shape_volume_cloud *cloud, float voxel)
{
    shape_volume_cloud copy = *cloud;
    float cell = 1 / cloud->inverse_noise_scale;
    int octaves = 1;
    while (octaves < cloud->field.octaves && cell > voxel) {
        octaves++;
        cell /= 2;
    }
    copy.mean_octaves = cloud->field.octaves - octaves;
    copy.field.octaves = octaves;
    return copy;
}

shape_status shape_bake(const shape_volume_cloud *cloud, float voxel, int threads, shape_baked *baked,
                        shape_error *error)
{
    memset(baked, 0, sizeof *baked);
    if (!(voxel > 0))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "a voxel of %g m (it must be above 0)",
                               (double)voxel);
    shape_status status = lay_out(cloud, voxel, baked, error);
    if (status)
        return status;
    threads = threads > 0 ? threads : omp_get_max_threads();
    shape_volume_cloud coarse = with_fewer_octaves(cloud, voxel);
    int nx = baked->size[0] / BRICK, ny = baked->size[1] / BRICK, nz = baked->size[2] / BRICK;
#pragma omp parallel num_threads(threads)
    {
        row_forms list = {0};
        shape_error own = {0};
#pragma omp for schedule(dynamic, 1)
        for (int row = 0; row < ny * nz; row++)
            for (int x = 0; x < nx && !own.status; x++)
                fill_brick(&coarse, baked, (int[3]){x, row % ny, row / ny}, &list, &own);
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
    if (!status)
        status = fill_distances(baked, error);
    if (status)
        shape_baked_free(baked);
    return status;
}

void shape_baked_free(shape_baked *baked)
{
    free(baked->voxels);
    memset(baked, 0, sizeof *baked);
}
