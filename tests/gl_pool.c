/* The pool of baked densities: no two overlap, what is sent arrives, slices are as small as asked for, and what is already
 * there is not sent again. Growth by clouds: what is out of sight is neither made nor sent. */
#include "gl_context.h"

#include "gl_private.h"

enum { MANY = 40 };

/* A set of grids of random sizes; the voxels of number i are i + 1. */
static gl_dense *new_dense(shape_random *random, int number)
{
    gl_dense *dense = calloc(1, sizeof *dense);
    assert_non_null(dense);
    atomic_init(&dense->uses, 1);
    size_t bytes = 2;
    for (int axis = 0; axis < 3; axis++) {
        dense->baked.size[axis] = 8 * (1 + (int)(shape_random_unit(random) * 12));
        bytes *= (size_t)dense->baked.size[axis];
    }
    dense->baked.voxels = malloc(bytes);
    assert_non_null(dense->baked.voxels);
    memset(dense->baked.voxels, number + 1, bytes);
    return dense;
}

static gl_baked *new_baked(int count)
{
    gl_baked *baked = calloc(1, sizeof *baked);
    assert_non_null(baked);
    baked->uses = 1;
    baked->count = count;
    baked->dense = calloc((size_t)count, sizeof(gl_dense *));
    assert_non_null(baked->dense);
    return baked;
}

static size_t bytes_of(const gl_dense *dense)
{
    const int *n = dense->baked.size;
    return 2 * (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
}

/* Every voxel of the texture that belongs to a grid is that grid's; so none lies upon another. */
static void check_texture(const gl_pool *pool, const gl_baked *baked)
{
    const size_t nx = (size_t)pool->size[0], ny = (size_t)pool->size[1];
    uint8_t *texels = malloc(2 * nx * ny * (size_t)pool->size[2]);
    assert_non_null(texels);
    glBindTexture(GL_TEXTURE_3D, pool->texture);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glGetTexImage(GL_TEXTURE_3D, 0, GL_RG, GL_UNSIGNED_BYTE, texels);
    for (int i = 0; i < baked->count; i++) {
        const gl_dense *dense = baked->dense[i];
        size_t wrong = 0;
        if (!dense)
            continue;
        for (int z = 0; z < dense->baked.size[2]; z++)
            for (int y = 0; y < dense->baked.size[1]; y++)
                for (int x = 0; x < 2 * dense->baked.size[0]; x++)
                    wrong +=
                        texels[2 * (((size_t)(dense->place[2] + z) * ny + (size_t)(dense->place[1] + y)) *
                                        nx +
                                    (size_t)dense->place[0]) +
                               (size_t)x] != dense->baked.voxels[0];
        assert_int_equal(wrong, 0);
    }
    free(texels);
}

static void what_is_in_the_pool_stays_whole(void **state)
{
    (void)state;
    shape_error error;
    shape_random random = shape_random_seed(3, 0);
    gl_pool pool = {0};
    gl_baked *baked = new_baked(MANY);
    for (int round = 0; round < 12; round++) {
        size_t changed = 0, sent = 0, size = (size_t)pool.size[2];
        for (int i = 0; i < MANY; i++) {
            if (round && shape_random_unit(&random) > 0.3)
                continue;
            gl_dense_drop(baked->dense[i]);
            baked->dense[i] = round % 3 == 2 && i % 2 ? NULL : new_dense(&random, i);
            changed += baked->dense[i] ? bytes_of(baked->dense[i]) : 0;
        }
        gl_pool_keep(&pool, (const gl_baked *const[]){baked}, 1);
        must(gl_pool_place(&pool, baked, 2048, &error), &error);
        const size_t slice = 100000, layer = 2 * 96 * 96;
        for (bool all = false; !all;) {
            size_t before = sent;
            all = gl_pool_send(&pool, baked, slice, &sent);
            assert_true(sent - before <= slice + layer || size != (size_t)pool.size[2]);
            size = (size_t)pool.size[2];
            assert_true(all || sent > before);
        }
        /* Only what is new is sent, but for the rounds in which the texture has grown. */
        assert_true(sent >= changed);
        if (round > 6)
            assert_int_equal(sent, changed);
        check_texture(&pool, baked);
    }
    gl_pool_keep(&pool, NULL, 0);
    assert_int_equal(pool.count, 0);
    for (size_t i = 0;
         i < (size_t)(pool.size[0] / 16) * (size_t)(pool.size[1] / 16) * (size_t)(pool.size[2] / 16); i++)
        assert_int_equal(pool.taken[i], 0);
    gl_baked_drop(baked);
    gl_pool_free(&pool);
}

static void what_fits_no_texture_is_an_error(void **state)
{
    (void)state;
    shape_error error;
    shape_random random = shape_random_seed(4, 0);
    gl_pool pool = {0};
    gl_baked *baked = new_baked(2);
    for (int i = 0; i < 2; i++)
        baked->dense[i] = new_dense(&random, i);
    baked->dense[1]->baked.size[1] = 4096;
    assert_int_equal(gl_pool_place(&pool, baked, 2048, &error), SHAPE_ERROR_LIMIT);
    assert_non_null(strstr(error.text, "2048 a side"));
    gl_baked_drop(baked);
    gl_pool_free(&pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_in_the_pool_stays_whole),
        cmocka_unit_test(what_fits_no_texture_is_an_error),
    };
    return cmocka_run_group_tests(tests, open_context, close_context);
}
