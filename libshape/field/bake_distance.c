/* How far it is from each block of a baked grid to the nearest one with any density, counted like a king's moves. Two passes
 * over the blocks, each from its neighbours that were passed before: the chessboard distance, exactly (Rosenfeld and Pfaltz
 * 1968). */
#include "field/bake_distance.h"

#include <stdlib.h>
#include <string.h>

enum { BLOCK = SHAPE_BAKE_BLOCK, RINGS = 24 }; /* beyond, blocks say RINGS + 1, which is still true */

static void count_blocks(const shape_baked *baked, int n[3])
{
    for (int axis = 0; axis < 3; axis++)
        n[axis] = baked->size[axis] / BLOCK;
}

static size_t first_voxel(const shape_baked *baked, int x, int y, int z)
{
    return ((size_t)(z * BLOCK) * (size_t)baked->size[1] + (size_t)(y * BLOCK)) * (size_t)baked->size[0] +
           (size_t)(x * BLOCK);
}

static bool has_matter(const shape_baked *baked, int x, int y, int z)
{
    const size_t nx = (size_t)baked->size[0], slice = nx * (size_t)baked->size[1];
    const uint8_t *from = baked->voxels + 2 * first_voxel(baked, x, y, z);
    for (size_t k = 0; k < BLOCK; k++)
        for (size_t j = 0; j < BLOCK; j++)
            for (size_t i = 0; i < BLOCK; i++)
                if (from[2 * (k * slice + j * nx + i)])
                    return true;
    return false;
}

static void write_block(const shape_baked *baked, int x, int y, int z, uint8_t distance)
{
    const size_t nx = (size_t)baked->size[0], slice = nx * (size_t)baked->size[1];
    uint8_t *to = baked->voxels + 2 * first_voxel(baked, x, y, z);
    for (size_t k = 0; k < BLOCK; k++)
        for (size_t j = 0; j < BLOCK; j++)
            for (size_t i = 0; i < BLOCK; i++)
                to[2 * (k * slice + j * nx + i) + 1] = distance;
}

/* The least of a row's three blocks about x, plus one, where that is less than *least. */
static void look(const uint8_t *row, int nx, int x, uint8_t *least)
{
    uint8_t found = row[x];
    if (x > 0 && row[x - 1] < found)
        found = row[x - 1];
    if (x + 1 < nx && row[x + 1] < found)
        found = row[x + 1];
    if (found + 1 < *least)
        *least = (uint8_t)(found + 1);
}

/* One row of a pass: `side` -1 looks at the rows before it (above, and in the layer above), 1 at those after. */
static void pass_row(const int n[3], uint8_t *distance, int y, int z, int side)
{
    const int nx = n[0];
    uint8_t *row = distance + ((size_t)z * (size_t)n[1] + (size_t)y) * (size_t)nx;
    const int layer = z + side;
    for (int i = 0; i < nx; i++) {
        const int x = side < 0 ? i : nx - 1 - i;
        uint8_t least = row[x];
        if (!least)
            continue;
        if (i > 0 && row[x + side] + 1 < least)
            least = (uint8_t)(row[x + side] + 1);
        if (y + side >= 0 && y + side < n[1])
            look(row + side * nx, nx, x, &least);
        for (int other = y - 1; other <= y + 1 && layer >= 0 && layer < n[2]; other++)
            if (other >= 0 && other < n[1])
                look(distance + ((size_t)layer * (size_t)n[1] + (size_t)other) * (size_t)nx, nx, x, &least);
        row[x] = least;
    }
}

/* From 0 where there is matter and RINGS + 1 elsewhere. */
static void find_distances(const int n[3], uint8_t *distance)
{
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++)
            pass_row(n, distance, y, z, -1);
    for (int z = n[2] - 1; z >= 0; z--)
        for (int y = n[1] - 1; y >= 0; y--)
            pass_row(n, distance, y, z, 1);
}

/* The brick that a block lies in. */
static size_t brick_of(const int n[3], int x, int y, int z)
{
    const int per = SHAPE_BAKE_BRICK / BLOCK;
    return ((size_t)(z / per) * (size_t)(n[1] / per) + (size_t)(y / per)) * (size_t)(n[0] / per) +
           (size_t)(x / per);
}

/* Which blocks hold matter. Returns whether that is another answer than the distances in the voxels give. */
static bool find_matter(const shape_baked *baked, const int n[3], const uint8_t *made, uint8_t *distance)
{
    bool other = !made;
    size_t i = 0;
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++)
            for (int x = 0; x < n[0]; x++, i++) {
                bool matter = !made || baked->voxels[2 * first_voxel(baked, x, y, z) + 1] == 0, was = matter;
                if (!made || made[brick_of(n, x, y, z)])
                    matter = has_matter(baked, x, y, z);
                other = other || matter != was;
                distance[i] = matter ? 0 : RINGS + 1;
            }
    return other;
}

static void write_all(shape_baked *baked, const int n[3], const uint8_t *distance)
{
    const size_t nx = (size_t)baked->size[0], ny = (size_t)baked->size[1], nz = (size_t)baked->size[2];
    for (size_t z = 0; z < nz; z++)
        for (size_t y = 0; y < ny; y++) {
            uint8_t *row = baked->voxels + 2 * (z * ny + y) * nx;
            const uint8_t *from = distance + ((z / BLOCK) * (size_t)n[1] + y / BLOCK) * (size_t)n[0];
            for (size_t x = 0; x < nx; x++)
                row[2 * x + 1] = from[x / BLOCK];
        }
}

static void write_changed(shape_baked *baked, const int n[3], const uint8_t *distance, uint8_t *differ)
{
    size_t i = 0;
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++)
            for (int x = 0; x < n[0]; x++, i++) {
                if (baked->voxels[2 * first_voxel(baked, x, y, z) + 1] == distance[i])
                    continue;
                write_block(baked, x, y, z, distance[i]);
                differ[brick_of(n, x, y, z)] = 1;
            }
}

shape_status bake_distances(shape_baked *baked, const uint8_t *made, uint8_t *differ, shape_error *error)
{
    int n[3];
    count_blocks(baked, n);
    uint8_t *distance = calloc((size_t)n[0] * (size_t)n[1], (size_t)n[2]);
    if (!distance)
        return shape_error_memory(error);
    if (find_matter(baked, n, made, distance)) {
        find_distances(n, distance);
        if (made)
            write_changed(baked, n, distance, differ);
        else
            write_all(baked, n, distance);
    }
    free(distance);
    return SHAPE_OK;
}
