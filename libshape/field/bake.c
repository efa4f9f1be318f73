/* Density to a grid, block by block: a block asks the tree once which primitives touch it, then each voxel asks those. */
#include "shape/bake.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "field/bake_distance.h"
#include "field/row.h"

enum { BRICK = SHAPE_BAKE_BRICK }; /* what a thread takes and the tree is asked about */

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

/* Box and size of a grid of baked->voxel. */
static shape_status place(const shape_volume_cloud *cloud, shape_baked *baked, shape_error *error)
{
    const float voxel = baked->voxel;
    shape_box box = cloud->box;
    if (shape_box_is_empty(box))
        box = (shape_box){{0, 0, 0}, {voxel, voxel, voxel}};
    double count = 1;
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
    return SHAPE_OK;
}

static shape_status lay_out(const shape_volume_cloud *cloud, float voxel, shape_baked *baked,
                            shape_error *error)
{
    baked->voxel = voxel;
    shape_status status = place(cloud, baked, error);
    if (status)
        return status;
    baked->voxels = calloc((size_t)baked->size[0] * (size_t)baked->size[1] * (size_t)baked->size[2], 2);
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
            row_density(cloud, list, &points, u2, density);
            if (list->watch.stopped)
                return row_stopped(list, error);
            uint8_t *row = baked->voxels + 2 * (((size_t)(brick[2] * BRICK + k) * (size_t)baked->size[1] +
                                                 (size_t)(brick[1] * BRICK + j)) *
                                                    (size_t)baked->size[0] +
                                                (size_t)(brick[0] * BRICK));
            for (int i = 0; i < BRICK; i++)
                row[2 * i] = (uint8_t)(unit * density[i] + 0.5f);
        }
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

/* One piece of work: the bricks of a grid, all or some. */
typedef struct bricks_work {
    const shape_volume_cloud *cloud;
    const shape_baked *baked;
    const uint8_t *wanted; /* a flag a brick; NULL: all, and the grid is zeroed */
    shape_stop stop;
} bricks_work;

static void count_bricks(const shape_baked *baked, int n[3])
{
    for (int axis = 0; axis < 3; axis++)
        n[axis] = baked->size[axis] / BRICK;
}

static void clear_brick(const shape_baked *baked, const int brick[3])
{
    for (int k = 0; k < BRICK; k++)
        for (int j = 0; j < BRICK; j++) {
            size_t row =
                (size_t)(brick[2] * BRICK + k) * (size_t)baked->size[1] + (size_t)(brick[1] * BRICK + j);
            uint8_t *voxels = baked->voxels + 2 * (row * (size_t)baked->size[0] + (size_t)(brick[0] * BRICK));
            for (int i = 0; i < BRICK; i++)
                voxels[2 * i] = 0;
        }
}

/* A row of bricks along x. */
static void fill_row(const bricks_work *work, int row, row_forms *list, shape_error *error)
{
    int n[3];
    count_bricks(work->baked, n);
    for (int x = 0; x < n[0] && !error->status; x++) {
        const int brick[3] = {x, row % n[1], row / n[1]};
        if (work->wanted && !work->wanted[(size_t)row * (size_t)n[0] + (size_t)x])
            continue;
        if (work->wanted)
            clear_brick(work->baked, brick);
        fill_brick(work->cloud, work->baked, brick, list, error);
    }
}

static shape_status fill_bricks(const bricks_work *work, int threads, shape_error *error)
{
    int n[3];
    shape_status status = SHAPE_OK;
    count_bricks(work->baked, n);
    threads = threads > 0 ? threads : omp_get_max_threads();
#pragma omp parallel num_threads(threads)
    {
        row_forms list = {.watch.stop = work->stop};
        shape_error own = {0};
#pragma omp for schedule(dynamic, 1)
        for (int row = 0; row < n[1] * n[2]; row++)
            if (!own.status)
                fill_row(work, row, &list, &own);
        free(list.items);
        shape_error_join(&own, &status, error);
    }
    return status;
}

shape_status shape_bake_with(const shape_volume_cloud *cloud, float voxel, int threads, shape_stop stop,
                             shape_baked *baked, shape_error *error)
{
    memset(baked, 0, sizeof *baked);
    if (!(voxel > 0))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "a voxel of %g m (it must be above 0)",
                               (double)voxel);
    shape_status status = lay_out(cloud, voxel, baked, error);
    if (status)
        return status;
    shape_volume_cloud coarse = with_fewer_octaves(cloud, voxel);
    coarse.stop = &stop;
    const bricks_work work = {&coarse, baked, NULL, stop};
    status = fill_bricks(&work, threads, error);
    if (!status)
        status = bake_distances(baked, NULL, NULL, error);
    if (status)
        shape_baked_free(baked);
    return status;
}

shape_status shape_bake(const shape_volume_cloud *cloud, float voxel, int threads, shape_baked *baked,
                        shape_error *error)
{
    return shape_bake_with(cloud, voxel, threads, (shape_stop){0}, baked, error);
}

/* --- again, after an edit --- */

/* Flags the bricks that a box touches. */
static void flag_box(const shape_baked *baked, shape_box box, uint8_t *flags)
{
    int n[3], first[3], last[3];
    count_bricks(baked, n);
    for (int axis = 0; axis < 3; axis++) {
        /* In double precision, and a hundredth of a brick more on both sides: a brick's own place is rounded. */
        double low = (double)(&baked->box.min.x)[axis], edge = (double)baked->voxel * BRICK;
        first[axis] = (int)fmax(floor(((double)(&box.min.x)[axis] - low) / edge - 0.01), 0);
        last[axis] = (int)fmin(floor(((double)(&box.max.x)[axis] - low) / edge + 0.01), n[axis] - 1);
    }
    for (int z = first[2]; z <= last[2]; z++)
        for (int y = first[1]; y <= last[1]; y++)
            for (int x = first[0]; x <= last[0]; x++)
                flags[((size_t)z * (size_t)n[1] + (size_t)y) * (size_t)n[0] + (size_t)x] = 1;
}

static size_t brick_count(const shape_baked *baked)
{
    int n[3];
    count_bricks(baked, n);
    return (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
}

/* All of it anew, with the same voxel. */
static shape_status bake_all(const shape_volume_cloud *cloud, int threads, shape_stop stop,
                             shape_baked *baked, uint8_t **bricks, shape_error *error)
{
    float voxel = baked->voxel;
    shape_baked_free(baked);
    shape_status status = shape_bake_with(cloud, voxel, threads, stop, baked, error);
    if (status || !bricks)
        return status;
    *bricks = malloc(brick_count(baked));
    if (!*bricks) {
        shape_baked_free(baked);
        return shape_error_memory(error);
    }
    memset(*bricks, 1, brick_count(baked));
    return SHAPE_OK;
}

/* Whether the cloud's grid would lie where this one lies. */
static bool lies_there(const shape_volume_cloud *cloud, const shape_baked *baked)
{
    shape_baked now = {.voxel = baked->voxel};
    shape_error error;
    return !place(cloud, &now, &error) && !memcmp(now.size, baked->size, sizeof now.size) &&
           !memcmp(&now.box, &baked->box, sizeof now.box);
}

shape_status shape_bake_again(const shape_volume_cloud *cloud, const shape_change *change, int threads,
                              shape_stop stop, shape_baked *baked, uint8_t **bricks, shape_error *error)
{
    if (bricks)
        *bricks = NULL;
    if (change->all || !lies_there(cloud, baked))
        return bake_all(cloud, threads, stop, baked, bricks, error);
    /* Which are baked; then, which differ. */
    uint8_t *flags = calloc(brick_count(baked), 1), *differ = calloc(brick_count(baked), 1);
    shape_status status = flags && differ ? SHAPE_OK : shape_error_memory(error);
    for (size_t i = 0; i < change->count && !status; i++)
        flag_box(baked, change->boxes[i], flags);
    if (!status) {
        shape_volume_cloud coarse = with_fewer_octaves(cloud, baked->voxel);
        coarse.stop = &stop;
        const bricks_work work = {&coarse, baked, flags, stop};
        status = fill_bricks(&work, threads, error);
    }
    if (!status) {
        memcpy(differ, flags, brick_count(baked));
        status = bake_distances(baked, flags, differ, error);
    }
    free(flags);
    if (status)
        shape_baked_free(baked);
    if (!status && bricks)
        *bricks = differ;
    else
        free(differ);
    return status;
}

void shape_baked_free(shape_baked *baked)
{
    free(baked->voxels);
    memset(baked, 0, sizeof *baked);
}
