/* Generators and edits when memory runs out: each allocation fails once, is reported as such, and nothing is left
 * behind. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "shape/combine.h"
#include "shape/gaussian.h"
#include "shape/metaball.h"
#include "shape/prune.h"
#include "shape/refine.h"
#include "shape/scatter.h"
#include "shape/transform.h"

/* The build links this program with --wrap, so that every allocation passes here. */
void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
void __real_free(void *block);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t size);
void __wrap_free(void *block);

static long allocations_left = -1; /* below 0: no limit */
static long live;                  /* blocks */

static int refuse(void)
{
    return allocations_left >= 0 && allocations_left-- == 0;
}

void *__wrap_malloc(size_t size)
{
    void *block = refuse() ? NULL : __real_malloc(size);
    live += block != NULL;
    return block;
}

void *__wrap_calloc(size_t count, size_t size)
{
    void *block = refuse() ? NULL : __real_calloc(count, size);
    live += block != NULL;
    return block;
}

void *__wrap_realloc(void *old, size_t size)
{
    void *block = refuse() ? NULL : __real_realloc(old, size);
    live += block && !old;
    return block;
}

void __wrap_free(void *block)
{
    live -= block != NULL;
    __real_free(block);
}

static shape_status append_copy(shape_set *set, shape_error *error)
{
    shape_set *other = shape_set_create(error);
    shape_status status = other ? shape_set_append(other, set, error) : SHAPE_ERROR_MEMORY;
    if (!status)
        status = shape_set_append(set, other, error);
    shape_set_destroy(other);
    return status;
}

/* Every function of these headers that takes memory, with enough primitives for the tree to sort them. */
static shape_status make_and_edit(shape_set *set, shape_error *error)
{
    static shape_point2 places[50];
    shape_gaussian gaussian = shape_gaussian_defaults();
    shape_metaball metaball = shape_metaball_defaults();
    shape_grow grow = shape_grow_defaults();
    shape_clip clip = shape_clip_defaults();
    shape_transform transform = shape_transform_defaults();
    gaussian.count = 200;
    grow.count = 2;
    transform.scale[0] = 2;
    shape_status status = shape_set_add_cloud(set, "a", NULL, error);
    if (!status)
        status = shape_set_add_cloud(set, "b", NULL, error);
    if (!status)
        status = shape_gaussian_make(&gaussian, 1, shape_set_list(set, 0), NULL, error);
    if (!status)
        status = shape_metaball_make(&metaball, 1, shape_set_list(set, 1), error);
    if (!status)
        status = shape_scatter(50, 10, 10, 1, places, NULL, error);
    if (!status)
        status = shape_primitives_grow(shape_set_list(set, 0), &grow, 1, NULL, error);
    if (!status)
        status = append_copy(set, error);
    if (!status)
        status = shape_set_transform(set, NULL, &transform, error);
    if (!status)
        status = shape_set_clip(set, NULL, &clip, NULL, NULL, error);
    if (!status)
        status = shape_primitives_prune(shape_set_list(set, 0), NULL, error);
    return status;
}

static void every_failed_allocation_is_an_error(void **state)
{
    (void)state;
    long before = live, failures = 0;
    for (;; failures++) {
        shape_error error;
        allocations_left = failures;
        shape_set *set = shape_set_create(&error);
        shape_status status = set ? make_and_edit(set, &error) : SHAPE_ERROR_MEMORY;
        int used_up = allocations_left < 0;
        allocations_left = -1;
        shape_set_destroy(set);
        assert_int_equal(live, before);
        if (!status && !used_up)
            break;
        assert_int_equal(status, SHAPE_ERROR_MEMORY);
        assert_non_null(strstr(error.text, "memory"));
        assert_true(failures < 1000);
    }
    assert_true(failures >= 30);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_failed_allocation_is_an_error)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
