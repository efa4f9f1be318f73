/* Generators and edits when memory runs out: each allocation fails once, is reported as such, and nothing is left
 * behind. */
#include "failing_memory.h"

#include "shape/combine.h"
#include "shape/gaussian.h"
#include "shape/metaball.h"
#include "shape/prune.h"
#include "shape/refine.h"
#include "shape/scatter.h"
#include "shape/transform.h"

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

static shape_status make_and_drop(shape_error *error)
{
    shape_set *set = shape_set_create(error);
    shape_status status = set ? make_and_edit(set, error) : SHAPE_ERROR_MEMORY;
    shape_set_destroy(set);
    return status;
}

static void every_failed_allocation_is_an_error(void **state)
{
    (void)state;
    fail_each(make_and_drop, 30, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_failed_allocation_is_an_error)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
