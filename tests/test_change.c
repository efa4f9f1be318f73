/* What shape_change_find tells of two clouds: nothing where they are equal, all where anything differs that every point's
 * density depends on, else boxes around the primitives that only one of them has. */
#include "volume_sample.h"

#include "shape/change.h"

static shape_set *set;
static shape_volume *volume;

/* Three spheres and two ellipsoids. */
static int make_scene(void **state)
{
    (void)state;
    shape_error error;
    set = new_set();
    must(shape_set_add_cloud(set, "a", NULL, &error), &error);
    for (int i = 0; i < 3; i++) {
        const shape_sphere s = {3.0f * (float)i, 0, 0, 1};
        must(shape_primitives_add_sphere(shape_set_list(set, 0), s, &error), &error);
    }
    for (int i = 0; i < 2; i++) {
        const shape_ellipsoid e = {.x = 3.0f * (float)i, .y = 4, .a = 1, .b = 2, .c = 1, .q = {0, 0, 0, 1}};
        must(shape_primitives_add_ellipsoid(shape_set_list(set, 0), e, &error), &error);
    }
    must(shape_cloud_choose_noise_scale(&set->clouds[0], shape_set_list(set, 0), &error), &error);
    volume = new_volume(set);
    return 0;
}

static int drop_scene(void **state)
{
    (void)state;
    shape_volume_destroy(volume);
    shape_set_destroy(set);
    return 0;
}

static shape_change find(const shape_volume_cloud *before, const shape_volume_cloud *after)
{
    shape_error error;
    shape_change change;
    must(shape_change_find(before, after, &change, &error), &error);
    return change;
}

/* The lowest bit of a member is another one: true for false, the next number, the next model. */
static void test_members_that_count(void **state)
{
    (void)state;
#define MEMBER(member)                                                                                       \
    {                                                                                                        \
#member, offsetof(shape_volume_cloud, member)                                                        \
    }
    static const struct {
        const char *name;
        size_t at;
    } members[] = {
        MEMBER(field.model),   MEMBER(field.kappa),  MEMBER(field.octaves), MEMBER(field.noise_scale),
        MEMBER(field.edge),    MEMBER(field.seed),   MEMBER(field.detail),  MEMBER(box.min.x),
        MEMBER(box.min.y),     MEMBER(box.min.z),    MEMBER(box.max.x),     MEMBER(box.max.y),
        MEMBER(box.max.z),     MEMBER(support),      MEMBER(margin),        MEMBER(most),
        MEMBER(portable),      MEMBER(mean_octaves), MEMBER(detailed),      MEMBER(base),
        MEMBER(inverse_height)};
    shape_volume_cloud own = volume->clouds[0];
    shape_change change = find(&own, &own);
    assert_false(shape_change_is_any(&change));
    for (size_t i = 0; i < sizeof members / sizeof *members; i++) {
        shape_volume_cloud other = own;
        ((unsigned char *)&other)[members[i].at] ^= 1;
        change = find(&own, &other);
        if (!change.all)
            fail_msg("%s differs, and nothing is said to have changed", members[i].name);
        assert_true(shape_change_is_any(&change));
        assert_true(shape_change_touches(&change, own.box));
        shape_change_free(&change);
    }
    /* The placement, the medium and what the clouds are named by do not count. */
    shape_volume_cloud moved = own;
    moved.frame.m[0][3] += 7;
    moved.medium.extinction *= 2;
    moved.tree_index++;
    change = find(&own, &moved);
    assert_false(shape_change_is_any(&change));
    /* A layer's own numbers count for a layer alone. */
    moved = own;
    moved.field.layer.coverage += 0.25f;
    change = find(&own, &moved);
    assert_false(shape_change_is_any(&change));
    own.field.model = moved.field.model = SHAPE_MODEL_LAYER;
    change = find(&own, &moved);
    assert_true(change.all);
    /* Other voxels. */
    own = moved = volume->clouds[0];
    shape_primitives list = *own.shape_list;
    static double voxels;
    list.grid = (struct shape_grid *)&voxels; /* never looked into */
    moved.shape_list = &list;
    change = find(&own, &moved);
    assert_true(change.all);
}

static shape_change find_lists(shape_model model, const shape_primitives *a, const shape_primitives *b)
{
    shape_volume_cloud before = volume->clouds[0], after = before;
    before.field.model = after.field.model = model;
    before.shape_list = a;
    after.shape_list = b;
    return find(&before, &after);
}

static void test_primitives(void **state)
{
    (void)state;
    const shape_primitives *own = volume->clouds[0].shape_list;
    for (int kind = 0; kind < 4; kind++) {
        shape_sphere spheres[3];
        shape_ellipsoid ellipsoids[2];
        shape_primitives other = *own;
        memcpy(spheres, own->spheres, sizeof spheres);
        memcpy(ellipsoids, own->ellipsoids, sizeof ellipsoids);
        other.spheres = spheres;
        other.ellipsoids = ellipsoids;
        if (kind == 0)
            spheres[1].radius = 0.5f;
        else if (kind == 1)
            ellipsoids[1].a = 0.5f;
        else if (kind == 2)
            other.sphere_count--;
        else
            other.ellipsoid_count--;
        /* Each primitive of a metaball counts everywhere. */
        shape_change change = find_lists(SHAPE_MODEL_METABALL, own, &other);
        assert_true(change.all);
        /* One that changed counts as it was and as it is; one that is gone, once. */
        change = find_lists(SHAPE_MODEL_SPHEROID, own, &other);
        assert_false(change.all);
        assert_int_equal(change.count, kind < 2 ? 2 : 1);
        const shape_box far = {{100, 100, 100}, {101, 101, 101}};
        assert_false(shape_change_touches(&change, far));
        assert_true(shape_change_touches(&change, volume->clouds[0].box));
        /* A box that touches along two axes does not touch. */
        for (int axis = 0; axis < 6; axis++) {
            shape_box aside = change.boxes[0];
            float *low = &(&aside.min.x)[axis / 2], *high = &(&aside.max.x)[axis / 2];
            *low = axis % 2 ? *high + 50 : *low - 60;
            *high = *low + 5;
            bool meets_other = change.count == 2 && *low <= (&change.boxes[1].max.x)[axis / 2] &&
                               *high >= (&change.boxes[1].min.x)[axis / 2];
            assert_int_equal(shape_change_touches(&change, aside), meets_other);
        }
        shape_change_free(&change);
    }
    shape_change none = find_lists(SHAPE_MODEL_METABALL, own, own);
    assert_false(shape_change_is_any(&none));
    const shape_primitives empty = {0};
    none = find_lists(SHAPE_MODEL_METABALL, &empty, &empty);
    assert_false(shape_change_is_any(&none));
    shape_change all_gone = find_lists(SHAPE_MODEL_SPHEROID, own, &empty);
    assert_int_equal(all_gone.count, 5);
    shape_change_free(&all_gone);
}

/* More differences than boxes are kept, and so many primitives alike that telling them apart takes too long. */
static void test_too_many(void **state)
{
    (void)state;
    enum { MANY = SHAPE_CHANGE_BOXES + 100, ALIKE = 2000 };
    shape_sphere *spheres = malloc(MANY * sizeof *spheres);
    assert_non_null(spheres);
    for (int i = 0; i < MANY; i++)
        spheres[i] = (shape_sphere){(float)i, 0, 0, 1};
    const shape_primitives many = {.spheres = spheres, .sphere_count = MANY}, empty = {0};
    shape_change change = find_lists(SHAPE_MODEL_SPHEROID, &many, &empty);
    assert_true(change.all);
    shape_change_free(&change);
    change = find_lists(SHAPE_MODEL_SPHEROID, &empty, &many);
    assert_true(change.all);
    shape_change_free(&change);
    for (int i = 0; i < ALIKE; i++)
        spheres[i] = (shape_sphere){0, 0, 0, 1};
    const shape_primitives alike = {.spheres = spheres, .sphere_count = ALIKE},
                           others = {.spheres = spheres + ALIKE, .sphere_count = 10};
    change = find_lists(SHAPE_MODEL_SPHEROID, &alike, &others);
    assert_true(change.all);
    shape_change_free(&change);
    free(spheres);
}

/* --- boxes that are kept --- */

static void test_kept_boxes(void **state)
{
    (void)state;
    shape_volume_cloud cloud = volume->clouds[0], earlier = cloud;
    shape_volume now = {.clouds = &cloud, .cloud_count = 1}, before = {.clouds = &earlier, .cloud_count = 1};
    const shape_box own = {{0, 0, 0}, {10, 10, 10}};
    const struct {
        shape_box old;
        bool kept;
    } cases[] = {{{{-1, -1, -1}, {10, 10, 10}}, true},  {{{0, 0, 0}, {11, 11, 11}}, true},
                 {{{-1, -1, -1}, {11, 11, 11}}, false}, /* much larger: 1.7 times */
                 {{{1, -1, -1}, {10, 10, 10}}, false},  {{{-1, 1, -1}, {10, 10, 10}}, false},
                 {{{-1, -1, 1}, {10, 10, 10}}, false},  {{{-1, -1, -1}, {9, 10, 10}}, false},
                 {{{-1, -1, -1}, {10, 9, 10}}, false},  {{{-1, -1, -1}, {10, 10, 9}}, false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        cloud.box = own;
        earlier.box = cases[i].old;
        shape_volume_keep_boxes(&now, &before);
        const shape_box *wanted = cases[i].kept ? &cases[i].old : &own;
        assert_memory_equal(&cloud.box, wanted, sizeof own);
    }
    before.cloud_count = 0; /* a cloud that was not there before */
    cloud.box = own;
    shape_volume_keep_boxes(&now, &before);
    assert_memory_equal(&cloud.box, &own, sizeof own);
    cloud.box = (shape_box){{1, 1, 1}, {0, 0, 0}}; /* nothing in it */
    before.cloud_count = 1;
    earlier.box = own;
    shape_volume_keep_boxes(&now, &before);
    assert_true(shape_box_is_empty(cloud.box));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_members_that_count),
                                       cmocka_unit_test(test_primitives), cmocka_unit_test(test_too_many),
                                       cmocka_unit_test(test_kept_boxes)};
    return cmocka_run_group_tests(tests, make_scene, drop_scene);
}
