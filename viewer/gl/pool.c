/* The baked densities that are on the GPU: one 3-D texture that they come into and leave one by one, so that what has not
 * changed is not sent again. Places are whole cells of 16 voxels, found by first fit. */
#include <stdlib.h>
#include <string.h>

#include "gl_private.h"

enum { CELL = 16, FIRST_SIDE = 144, FIRST_DEPTH = 48 };

static int cells_of(int texels)
{
    return (texels + CELL - 1) / CELL;
}

static uint8_t *cell_at(const gl_pool *pool, int x, int y, int z)
{
    const size_t nx = (size_t)(pool->size[0] / CELL), ny = (size_t)(pool->size[1] / CELL);
    return pool->taken + ((size_t)z * ny + (size_t)y) * nx + (size_t)x;
}

/* Whether all cells of a box are free; else *next gets the x after the last taken one of the row that was met. */
static bool is_free(const gl_pool *pool, const int at[3], const int size[3], int *next)
{
    for (int z = 0; z < size[2]; z++)
        for (int y = 0; y < size[1]; y++)
            for (int x = size[0] - 1; x >= 0; x--)
                if (*cell_at(pool, at[0] + x, at[1] + y, at[2] + z)) {
                    *next = at[0] + x + 1;
                    return false;
                }
    return true;
}

static void mark(gl_pool *pool, const gl_dense *dense, uint8_t value)
{
    const int *n = dense->baked.size, *place = dense->place;
    for (int z = 0; z < cells_of(n[2]); z++)
        for (int y = 0; y < cells_of(n[1]); y++)
            memset(cell_at(pool, place[0] / CELL, place[1] / CELL + y, place[2] / CELL + z), value,
                   (size_t)cells_of(n[0]));
}

/* A place for it, which is then taken; false where there is none. */
static bool find_place(gl_pool *pool, gl_dense *dense)
{
    int size[3], room[3], at[3];
    for (int axis = 0; axis < 3; axis++) {
        size[axis] = cells_of(dense->baked.size[axis]);
        room[axis] = pool->size[axis] / CELL - size[axis];
    }
    for (at[2] = 0; at[2] <= room[2]; at[2]++)
        for (at[1] = 0; at[1] <= room[1]; at[1]++)
            for (at[0] = 0; at[0] <= room[0];) {
                int next = at[0];
                if (!is_free(pool, at, size, &next)) {
                    at[0] = next;
                    continue;
                }
                for (int axis = 0; axis < 3; axis++)
                    dense->place[axis] = at[axis] * CELL;
                mark(pool, dense, 1);
                return true;
            }
    return false;
}

/* Sends layers [dense->sent, sent + layers) of it. */
static void send_layers(const gl_pool *pool, gl_dense *dense, int layers)
{
    const int *n = dense->baked.size, *place = dense->place;
    const uint8_t *from = dense->baked.voxels + 2 * (size_t)n[0] * (size_t)n[1] * (size_t)dense->sent;
    gl_settle();
    glBindTexture(GL_TEXTURE_3D, pool->texture);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexSubImage3D(GL_TEXTURE_3D, 0, place[0], place[1], place[2] + dense->sent, n[0], n[1], layers, GL_RG,
                    GL_UNSIGNED_BYTE, from);
    dense->sent += layers;
}

/* The same texture with another size, which loses what is in it: what had been sent is sent again. */
static shape_status resize(gl_pool *pool, const int size[3], shape_error *error)
{
    uint8_t *taken =
        calloc((size_t)(size[0] / CELL) * (size_t)(size[1] / CELL) * (size_t)(size[2] / CELL), 1);
    if (!taken)
        return shape_error_memory(error);
    free(pool->taken);
    pool->taken = taken;
    memcpy(pool->size, size, sizeof pool->size);
    if (!pool->texture) {
        pool->texture = gl_volume_texture(size, GL_RG8, GL_RG, GL_UNSIGNED_BYTE, NULL);
    } else {
        gl_settle();
        glBindTexture(GL_TEXTURE_3D, pool->texture);
        glTexImage3D(GL_TEXTURE_3D, 0, GL_RG8, size[0], size[1], size[2], 0, GL_RG, GL_UNSIGNED_BYTE, NULL);
    }
    for (size_t i = 0; i < pool->count; i++) {
        gl_dense *dense = pool->items[i];
        int sent = dense->sent;
        mark(pool, dense, 1);
        dense->sent = 0;
        if (sent)
            send_layers(pool, dense, sent);
        pool->resent_bytes += 2 * (size_t)dense->baked.size[0] * (size_t)dense->baked.size[1] * (size_t)sent;
    }
    return SHAPE_OK;
}

/* At least so many texels, as whole cells. Never a power of two: Mesa compiles shaders anew where that changes. */
static int side_of(int texels)
{
    int side = cells_of(texels) * CELL;
    return side & (side - 1) ? side : side + CELL;
}

/* Makes room for a box, and not much more: Mesa fills a new texture with zeros, and a picture waits for that. */
static shape_status grow(gl_pool *pool, const int needed[3], int limit, shape_error *error)
{
    int size[3] = {FIRST_SIDE, FIRST_SIDE, FIRST_DEPTH};
    for (int axis = 0; axis < 3; axis++) {
        size[axis] = pool->size[axis] > size[axis] ? pool->size[axis] : size[axis];
        if (size[axis] < needed[axis])
            size[axis] = side_of(needed[axis]);
    }
    if (!memcmp(size, pool->size, sizeof size)) { /* it would fit, but there is no place left */
        const int axis = size[2] < limit / 2 ? 2 : size[1] < size[0] ? 1 : 0;
        const int more = needed[axis] > size[axis] / 2 ? needed[axis] : size[axis] / 2;
        size[axis] = side_of(size[axis] + more);
    }
    if (size[0] > limit || size[1] > limit || size[2] > limit)
        return shape_error_set(error, SHAPE_ERROR_LIMIT,
                               "the grids of %zu clouds do not fit into this GPU's 3-D textures (%d a side)",
                               pool->count + 1, limit);
    return resize(pool, size, error);
}

static shape_status add(gl_pool *pool, gl_dense *dense, int limit, shape_error *error)
{
    if (pool->count == pool->capacity) {
        size_t more = pool->capacity ? 2 * pool->capacity : 64;
        gl_dense **items = realloc(pool->items, more * sizeof *items);
        if (!items)
            return shape_error_memory(error);
        pool->items = items;
        pool->capacity = more;
    }
    while (!pool->texture || !find_place(pool, dense)) {
        shape_status status = grow(pool, dense->baked.size, limit, error);
        if (status)
            return status;
    }
    dense->sent = 0;
    dense->resident = true;
    pool->items[pool->count++] = gl_dense_share(dense);
    return SHAPE_OK;
}

shape_status gl_pool_place(gl_pool *pool, const gl_baked *baked, int limit, shape_error *error)
{
    shape_status status = SHAPE_OK;
    for (int i = 0; i < baked->count && !status; i++)
        if (baked->dense[i] && !baked->dense[i]->resident)
            status = add(pool, baked->dense[i], limit, error);
    return status;
}

bool gl_pool_send(gl_pool *pool, const gl_baked *baked, size_t most, size_t *bytes)
{
    size_t sent = 0;
    bool all = true;
    for (int i = 0; i < baked->count; i++) {
        gl_dense *dense = baked->dense[i];
        if (!dense || dense->sent == dense->baked.size[2])
            continue;
        const size_t layer = 2 * (size_t)dense->baked.size[0] * (size_t)dense->baked.size[1];
        const int left = dense->baked.size[2] - dense->sent;
        size_t layers = sent < most ? (most - sent) / layer + 1 : 0;
        layers = layers < (size_t)left ? layers : (size_t)left;
        if (layers)
            send_layers(pool, dense, (int)layers);
        sent += layers * layer;
        all = all && dense->sent == dense->baked.size[2];
    }
    *bytes += sent + pool->resent_bytes;
    pool->resent_bytes = 0;
    return all;
}

/* Bricks [x, x + run) of a row of them. */
static void send_run(const gl_dense *dense, int x, int y, int z, int run)
{
    enum { BRICK = SHAPE_BAKE_BRICK };
    const int *n = dense->baked.size, *place = dense->place;
    const size_t first =
        ((size_t)(z * BRICK) * (size_t)n[1] + (size_t)(y * BRICK)) * (size_t)n[0] + (size_t)(x * BRICK);
    glTexSubImage3D(GL_TEXTURE_3D, 0, place[0] + x * BRICK, place[1] + y * BRICK, place[2] + z * BRICK,
                    run * BRICK, BRICK, BRICK, GL_RG, GL_UNSIGNED_BYTE, dense->baked.voxels + 2 * first);
}

void gl_pool_patch(const gl_pool *pool, const gl_dense *dense, const uint8_t *bricks, size_t *bytes)
{
    enum { BRICK = SHAPE_BAKE_BRICK };
    const int *n = dense->baked.size, nx = n[0] / BRICK, rows = n[1] / BRICK * (n[2] / BRICK);
    if (!dense->resident || dense->sent < n[2])
        return; /* what is to be sent yet is sent as it is now */
    glBindTexture(GL_TEXTURE_3D, pool->texture);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, n[0]);
    glPixelStorei(GL_UNPACK_IMAGE_HEIGHT, n[1]);
    for (int row = 0; row < rows; row++)
        for (int x = 0, run; x < nx; x += run) {
            const uint8_t *flags = bricks + (size_t)row * (size_t)nx;
            for (run = 1; x + run < nx && !flags[x] == !flags[x + run];)
                run++;
            if (!flags[x])
                continue;
            send_run(dense, x, row % (n[1] / BRICK), row / (n[1] / BRICK), run);
            *bytes += (size_t)run * 2 * BRICK * BRICK * BRICK;
        }
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    glPixelStorei(GL_UNPACK_IMAGE_HEIGHT, 0);
}

void gl_pool_keep(gl_pool *pool, const gl_baked *const sets[], int count)
{
    size_t kept = 0;
    for (size_t i = 0; i < pool->count; i++)
        pool->items[i]->kept = false;
    for (int set = 0; set < count; set++)
        for (int i = 0; sets[set] && i < sets[set]->count; i++)
            if (sets[set]->dense[i])
                sets[set]->dense[i]->kept = true;
    for (size_t i = 0; i < pool->count; i++) {
        gl_dense *dense = pool->items[i];
        if (dense->kept) {
            pool->items[kept++] = dense;
            continue;
        }
        mark(pool, dense, 0);
        dense->resident = false;
        gl_dense_drop(dense);
    }
    pool->count = kept;
}

void gl_pool_free(gl_pool *pool)
{
    gl_pool_keep(pool, NULL, 0);
    glDeleteTextures(1, &pool->texture);
    free(pool->taken);
    free(pool->items);
    memset(pool, 0, sizeof *pool);
}
