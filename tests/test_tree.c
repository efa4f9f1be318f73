/* The bounding-box tree: its look-up against the plain loop over all primitives, its links, its size and depth. */
#include "volume_sample.h"

#include <time.h>

/* Leaves stand in depth-first order; every skip leaps over exactly its own subtree; boxes hold their children. Returns
 * the depth. */
static size_t check_links(const shape_tree *tree, size_t primitives, const shape_primitives *list)
{
    assert_int_equal(tree->count, primitives ? 2 * primitives - 1 : 0);
    size_t *ends = malloc((tree->count + 1) * sizeof *ends), depth = 0, deepest = 0;
    unsigned char *seen = calloc(primitives + 1, 1);
    assert_non_null(ends);
    assert_non_null(seen);
    for (size_t i = 0; i < tree->count; i++) {
        const shape_tree_node *node = &tree->nodes[i];
        size_t skip = (size_t)node->skip;
        assert_true(node->skip == (float)skip && skip > i && skip <= tree->count);
        while (depth && ends[depth - 1] <= i)
            depth--;
        if (depth)
            assert_true(skip <= ends[depth - 1]);
        ends[depth++] = skip;
        deepest = depth > deepest ? depth : deepest;
        if (node->content == 0) {
            assert_true(skip >= i + 3);
            const shape_tree_node *left = &tree->nodes[i + 1], *right = &tree->nodes[(size_t)left->skip];
            shape_box both =
                shape_box_join((shape_box){left->min, left->max}, (shape_box){right->min, right->max});
            assert_memory_equal(&both.min, &node->min, sizeof both.min);
            assert_memory_equal(&both.max, &node->max, sizeof both.max);
            assert_int_equal((size_t)right->skip, skip);
        } else {
            assert_int_equal(skip, i + 1);
            bool sphere = node->content > 0;
            size_t number = (size_t)fabsf(node->content) - 1;
            assert_true(number < (sphere ? list->sphere_count : list->ellipsoid_count));
            number += sphere ? 0 : list->sphere_count;
            assert_false(seen[number]);
            seen[number] = 1;
        }
    }
    for (size_t i = 0; i < primitives; i++)
        assert_true(seen[i]);
    free(ends);
    free(seen);
    return deepest;
}

static float plain_u2(const shape_primitives *list, shape_vec3 p)
{
    float least = INFINITY;
    for (size_t i = 0; i < list->sphere_count; i++)
        least = fminf(least, shape_sphere_u2(&list->spheres[i], p));
    for (size_t i = 0; i < list->ellipsoid_count; i++)
        least = fminf(least, shape_ellipsoid_u2(&list->ellipsoids[i], p));
    return least;
}

/* The tree gives the loop's number, bit for bit, wherever that is within the support; outside, a number above it. A
 * box's rounding may cost what lies within 1e-5 of a surface. */
static void compare(const shape_set *set, int points, double half)
{
    shape_volume *volume = new_volume(set);
    const shape_volume_cloud *cloud = &volume->clouds[0];
    check_links(cloud->tree, shape_primitives_count(cloud->list), cloud->list);
    shape_random random = shape_random_seed(99, (uint64_t)points);
    float support2 = cloud->support * cloud->support;
    int within = 0;
    for (int i = 0; i < points; i++) {
        shape_vec3 p = i % 4 ? point_near(cloud->list, &random) : draw_point(&random, half);
        float plain = plain_u2(cloud->list, p), fast = shape_cloud_u2(cloud, p);
        if (plain < support2 * (1 - 1e-5f)) {
            assert_true(fast == plain);
            within++;
        } else if (plain > support2 * (1 + 1e-5f)) {
            assert_true(fast > support2);
        }
    }
    assert_true(within > points / 10);
    shape_volume_destroy(volume);
}

static void finds_what_the_plain_loop_finds(void **state)
{
    (void)state;
    static const size_t counts[] = {1, 2, 3, 7, 33, 400, 5000};
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        shape_random random = shape_random_seed(10, i);
        shape_set *set = new_set();
        shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_UNIFORM);
        size_t ellipsoids = counts[i] / 3;
        add_random(set, 0, &random, counts[i] - ellipsoids, ellipsoids, 20, 0.05, 4);
        compare(set, counts[i] > 1000 ? 800 : 4000, 25);
        cloud->field.model = SHAPE_MODEL_METABALL; /* larger supports */
        compare(set, counts[i] > 1000 ? 200 : 2000, 25);
        shape_set_destroy(set);
    }
}

static void copes_with_one_place_and_needles(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(20, 0);
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_UNIFORM);
    for (int i = 0; i < 1000; i++) /* all centres in one place: nothing to split by */
        add_sphere(set, 0, 3, -2, 5, 1 + 0.001 * (i % 17));
    compare(set, 2000, 8);
    shape_set_destroy(set);

    set = new_set();
    new_cloud(set, SHAPE_MODEL_UNIFORM);
    for (int i = 0; i < 1000; i++) { /* needles and coins, turned any way */
        float thin = draw_size(&random, 1e-3, 1e-2), wide = draw_size(&random, 1, 10);
        add_ellipsoid(set, 0, draw_point(&random, 10), wide, thin, i % 2 ? thin : wide,
                      draw_rotation(&random));
    }
    compare(set, 2000, 10);
    shape_set_destroy(set);

    set = new_set();
    new_cloud(set, SHAPE_MODEL_UNIFORM);
    for (int i = 0; i < 500; i++) /* sizes from a millimetre to a kilometre, in one line */
        add_sphere(set, 0, draw(&random, -1e4, 1e4), 0, 0, draw_size(&random, 1e-3, 1e3));
    compare(set, 2000, 1e4);
    shape_set_destroy(set);
}

static void copies_share_a_tree_and_others_do_not(void **state)
{
    (void)state;
    shape_error error;
    shape_set *set = new_set();
    shape_random random = shape_random_seed(30, 0);
    new_cloud(set, SHAPE_MODEL_UNIFORM);
    add_random(set, 0, &random, 10, 3, 5, 0.1, 1);
    new_cloud(set, SHAPE_MODEL_UNIFORM);
    add_random(set, 1, &random, 4, 3, 5, 0.1, 1);
    shape_frame frame = shape_frame_identity();
    size_t copy, meta;
    must(shape_set_add_copy(set, 0, &frame, &copy, &error), &error);
    must(shape_set_add_copy(set, 0, &frame, &meta, &error), &error);
    set->clouds[meta].field.model = SHAPE_MODEL_METABALL; /* another support: another tree */
    new_cloud(set, SHAPE_MODEL_UNIFORM);                  /* empty */
    shape_volume *volume = new_volume(set);
    assert_int_equal(volume->cloud_count, 5);
    assert_ptr_equal(volume->clouds[0].tree, volume->clouds[copy].tree);
    assert_ptr_not_equal(volume->clouds[0].tree, volume->clouds[1].tree);
    assert_ptr_not_equal(volume->clouds[0].tree, volume->clouds[meta].tree);
    assert_int_equal(volume->tree_count, 4);
    assert_int_equal(volume->clouds[4].tree->count, 0);
    assert_true(shape_cloud_u2(&volume->clouds[4], shape_vec3_make(0, 0, 0)) > 1);
    for (size_t i = 0; i < volume->cloud_count; i++)
        assert_ptr_equal(volume->clouds[i].tree, &volume->trees[volume->clouds[i].tree_index]);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

static size_t build_many(shape_set *set, double *seconds)
{
    struct timespec start, end;
    shape_tree tree;
    shape_error error;
    const shape_primitives *list = shape_set_list_const(set, 0);
    clock_gettime(CLOCK_MONOTONIC, &start);
    must(shape_tree_build(list, 1, &tree, &error), &error);
    clock_gettime(CLOCK_MONOTONIC, &end);
    *seconds = (double)(end.tv_sec - start.tv_sec) + 1e-9 * (double)(end.tv_nsec - start.tv_nsec);
    size_t depth = check_links(&tree, shape_primitives_count(list), list);
    shape_tree_free(&tree);
    return depth;
}

/* 200,000 spheres, evenly strewn, at one place, and on a line whose gaps double: halving takes 18 levels. The time
 * allowed is some twenty times what a plain build on an idle processor takes; a quadratic one would take hours. */
static void two_hundred_thousand_stay_shallow_and_quick(void **state)
{
    (void)state;
    enum { MANY = 200000 };
    for (int kind = 0; kind < 3; kind++) {
        shape_random random = shape_random_seed(40, (uint64_t)kind);
        shape_set *set = new_set();
        new_cloud(set, SHAPE_MODEL_UNIFORM);
        for (int i = 0; i < MANY; i++) {
            shape_vec3 p = kind == 0 ? draw_point(&random, 100) : shape_vec3_make(1, 2, 3);
            double x = kind == 2 ? pow(2, 1e-4 * i) : (double)p.x;
            add_sphere(set, 0, x, (double)p.y, (double)p.z, 0.5);
        }
        double seconds;
        size_t depth = build_many(set, &seconds);
        print_message("kind %d: depth %zu, %.2f s\n", kind, depth, seconds);
        assert_true(depth <= 60);
        assert_true(seconds < 20);
        shape_set_destroy(set);
    }
}

static void the_same_list_gives_the_same_tree(void **state)
{
    (void)state;
    shape_error error;
    shape_random random = shape_random_seed(50, 0);
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_UNIFORM);
    add_random(set, 0, &random, 900, 300, 10, 0.1, 2);
    shape_tree a, b;
    must(shape_tree_build(shape_set_list_const(set, 0), 1.5f, &a, &error), &error);
    must(shape_tree_build(shape_set_list_const(set, 0), 1.5f, &b, &error), &error);
    assert_int_equal(a.count, b.count);
    assert_memory_equal(a.nodes, b.nodes, a.count * sizeof *a.nodes);
    shape_tree_free(&a);
    shape_tree_free(&b);
    shape_set_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_what_the_plain_loop_finds),
        cmocka_unit_test(copes_with_one_place_and_needles),
        cmocka_unit_test(copies_share_a_tree_and_others_do_not),
        cmocka_unit_test(two_hundred_thousand_stay_shallow_and_quick),
        cmocka_unit_test(the_same_list_gives_the_same_tree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
