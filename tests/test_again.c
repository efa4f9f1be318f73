/* Grids made again after an edit: what an edit changes is found, and baked voxels, columns along the sun and light grids
 * that are made again only there are, to the bit, what they are when they are made anew. (To the bit, since the same sums are
 * taken in the same order: no tolerance.) */
#include "volume_sample.h"

#include "shape/bake.h"
#include "shape/change.h"
#include "shape/lightgrid.h"
#include "shape/sunsweep.h"

/* --- a cloud, and the same after an edit --- */

typedef enum cloud_kind { SPHERES, ELLIPSOIDS, DETAILS, BALLS, KINDS } cloud_kind;

static shape_set *new_kind(cloud_kind kind, shape_random *random)
{
    shape_set *set = new_set();
    shape_cloud *cloud = new_cloud(set, kind == BALLS ? SHAPE_MODEL_UNIFORM : SHAPE_MODEL_SPHEROID);
    cloud->field.noise_scale = 0.6f;
    if (kind == DETAILS) {
        cloud->field.detail.smoothness = 0.2f;
        cloud->field.detail.displace = 0.3f;
        cloud->field.detail.billow = 0.5f;
        cloud->field.detail.wisp = 0.5f;
    }
    add_random(set, 0, random, kind == ELLIPSOIDS ? 3 : 14, kind == ELLIPSOIDS ? 14 : 4, 4, 0.5, 1.5);
    /* Eight that hold the box where it is while those within move. */
    for (int corner = 0; corner < 8; corner++)
        add_sphere(set, 0, corner & 1 ? 6 : -6, corner & 2 ? 6 : -6, corner & 4 ? 6 : -6, 0.7);
    return set;
}

/* A copy of cloud 0 and its list. */
static shape_set *copy_of(const shape_set *from)
{
    shape_set *set = new_set();
    new_cloud(set, from->clouds[0].field.model);
    set->clouds[0].field = from->clouds[0].field;
    set->clouds[0].medium = from->clouds[0].medium;
    const shape_primitives *list = shape_set_list_const(from, 0);
    shape_error error;
    for (size_t i = 0; i < list->sphere_count; i++)
        must(shape_primitives_add_sphere(shape_set_list(set, 0), list->spheres[i], &error), &error);
    for (size_t i = 0; i < list->ellipsoid_count; i++) {
        const shape_ellipsoid *e = &list->ellipsoids[i];
        add_ellipsoid(set, 0, shape_vec3_make(e->x, e->y, e->z), e->a, e->b, e->c, e->q);
        shape_set_list(set, 0)->ellipsoids[i].q = e->q; /* to the bit: adding makes it a unit once more */
    }
    return set;
}

typedef enum edit_kind {
    MOVE,
    RESIZE,
    REMOVE,
    ADD,
    SEVERAL,
    SHUFFLE,
    BORDER_IN,
    BORDER_OUT,
    EDITS
} edit_kind;

/* One of those within: the last eight spheres hold the box. */
static shape_sphere *inner(shape_primitives *list, shape_random *random)
{
    size_t count = list->sphere_count - 8;
    return &list->spheres[(size_t)(shape_random_unit(random) * (double)count)];
}

static void edit(shape_set *set, edit_kind kind, shape_random *random)
{
    shape_primitives *list = shape_set_list(set, 0);
    shape_sphere *s = inner(list, random), *held = &list->spheres[list->sphere_count - 1];
    switch (kind) {
    case MOVE:
        s->x += draw(random, -1, 1), s->y += draw(random, -1, 1), s->z += draw(random, -1, 1);
        break;
    case RESIZE:
        s->radius *= draw(random, 0.5, 1.5);
        break;
    case REMOVE:
        memmove(s, s + 1, (size_t)(held - s) * sizeof *s);
        list->sphere_count--;
        break;
    case ADD:
        add_sphere(set, 0, (double)draw(random, -4, 4), (double)draw(random, -4, 4),
                   (double)draw(random, -4, 4), 0.8);
        list = shape_set_list(set, 0);
        shape_sphere added = list->spheres[list->sphere_count - 1];
        memmove(list->spheres + 1, list->spheres, (list->sphere_count - 1) * sizeof added);
        list->spheres[0] = added;
        break;
    case SEVERAL:
        edit(set, MOVE, random);
        edit(set, RESIZE, random);
        edit(set, ADD, random);
        if (list->ellipsoid_count)
            list->ellipsoids[0].x += 0.5f, list->ellipsoids[0].b *= 1.2f;
        break;
    case SHUFFLE: {
        shape_sphere first = list->spheres[0];
        list->spheres[0] = *s;
        *s = first;
        break;
    }
    case BORDER_IN:
        held->x -= 0.4f, held->y -= 0.1f;
        break;
    case BORDER_OUT:
        held->x += 1.3f;
        break;
    case EDITS:
        break;
    }
}

typedef struct pair {
    shape_set *sets[2];
    shape_volume *volumes[2];
    shape_change change;
} pair;

/* before's set is given away. */
static pair new_pair(shape_set *before, edit_kind kind, shape_random *random)
{
    shape_error error;
    pair p = {.sets = {before, copy_of(before)}};
    edit(p.sets[1], kind, random);
    for (int i = 0; i < 2; i++)
        p.volumes[i] = new_volume(p.sets[i]);
    shape_volume_keep_boxes(p.volumes[1], p.volumes[0]);
    must(shape_change_find(&p.volumes[0]->clouds[0], &p.volumes[1]->clouds[0], &p.change, &error), &error);
    return p;
}

static void drop_pair(pair *p)
{
    shape_change_free(&p->change);
    for (int i = 0; i < 2; i++) {
        shape_volume_destroy(p->volumes[i]);
        shape_set_destroy(p->sets[i]);
    }
}

/* --- finding what has changed --- */

static void changes_are_found(void **state)
{
    (void)state;
    static const size_t boxes[EDITS] = {
        [MOVE] = 2, [RESIZE] = 2, [REMOVE] = 1, [ADD] = 1, [SEVERAL] = 7, [SHUFFLE] = 0, [BORDER_IN] = 2};
    shape_random random = shape_random_seed(5, 0);
    for (int kind = 0; kind < EDITS; kind++) {
        pair p = new_pair(new_kind(SPHERES, &random), (edit_kind)kind, &random);
        assert_int_equal(p.change.all, kind == BORDER_OUT);
        if (kind == SEVERAL) /* it may draw the same sphere twice, which then is one that moved and grew */
            assert_true(p.change.count == boxes[kind] || p.change.count == boxes[kind] - 2);
        else if (!p.change.all)
            assert_int_equal(p.change.count, boxes[kind]);
        assert_int_equal(shape_change_is_any(&p.change), kind != SHUFFLE);
        drop_pair(&p);
    }
}

/* Outside the boxes, all densities are the same to the bit; inside some, else the test would see nothing. */
static void density_outside_is_the_same(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(6, 0);
    long inside = 0;
    for (int kind = 0; kind < KINDS; kind++)
        for (int round = 0; round < 8; round++) {
            pair p = new_pair(new_kind((cloud_kind)kind, &random), (edit_kind)(round % BORDER_OUT), &random);
            for (int i = 0; i < 4000; i++) {
                shape_vec3 at = draw_point(&random, 7);
                float a = shape_cloud_density(&p.volumes[0]->clouds[0], at),
                      b = shape_cloud_density(&p.volumes[1]->clouds[0], at);
                if (!shape_change_touches(&p.change, (shape_box){at, at}))
                    assert_true(a == b);
                else
                    inside += a != b;
            }
            drop_pair(&p);
        }
    assert_true(inside > 50);
}

static void all_changes_where_it_must(void **state)
{
    (void)state;
    shape_error error;
    shape_change change;
    shape_random random = shape_random_seed(7, 0);
    shape_set *set = new_kind(SPHERES, &random), *other = copy_of(set);
    other->clouds[0].field.kappa *= 0.5f;
    shape_volume *a = new_volume(set), *b = new_volume(other);
    must(shape_change_find(&a->clouds[0], &b->clouds[0], &change, &error), &error);
    assert_true(change.all);
    shape_volume_destroy(b);
    /* A placement and a medium change no density. */
    other->clouds[0].field = set->clouds[0].field;
    other->clouds[0].frame.m[0][3] = 5;
    other->clouds[0].medium.extinction = 9;
    b = new_volume(other);
    must(shape_change_find(&a->clouds[0], &b->clouds[0], &change, &error), &error);
    assert_false(shape_change_is_any(&change));
    shape_volume_destroy(b);
    shape_volume_destroy(a);
    /* The sum over metaballs is everywhere. */
    set->clouds[0].field.model = other->clouds[0].field.model = SHAPE_MODEL_METABALL;
    edit(other, MOVE, &random);
    a = new_volume(set), b = new_volume(other);
    shape_volume_keep_boxes(b, a);
    must(shape_change_find(&a->clouds[0], &b->clouds[0], &change, &error), &error);
    assert_true(change.all);
    shape_volume_destroy(b);
    shape_volume_destroy(a);
    shape_set_destroy(set);
    shape_set_destroy(other);
}

/* A crowd of things that are all alike, at the ends of which two differ: found, or given up, but not in the square of their
 * number (which would take minutes). */
static void crowds_are_compared_quickly(void **state)
{
    (void)state;
    enum { MANY = 300000 };
    shape_error error;
    shape_change change;
    shape_volume_cloud clouds[2] = {0};
    shape_primitives lists[2] = {0};
    for (int i = 0; i < 2; i++) {
        must(shape_primitives_reserve(&lists[i], MANY, 0, &error), &error);
        lists[i].sphere_count = MANY;
        for (size_t k = 0; k < MANY; k++)
            lists[i].spheres[k] = (shape_sphere){0, 0, 0, 1};
        lists[i].spheres[0].x = lists[i].spheres[MANY - 1].y = (float)i;
        clouds[i].field = shape_field_defaults();
        clouds[i].support = 1;
        clouds[i].list = clouds[i].shape_list = &lists[i];
    }
    must(shape_change_find(&clouds[0], &clouds[1], &change, &error), &error);
    assert_true(shape_change_is_any(&change));
    shape_change_free(&change);
    for (int i = 0; i < 2; i++)
        free(lists[i].spheres);
}

/* --- baked voxels --- */

static size_t byte_count(const shape_baked *b)
{
    return 2 * (size_t)b->size[0] * (size_t)b->size[1] * (size_t)b->size[2];
}

static void same_baked(const shape_baked *a, const shape_baked *b)
{
    assert_memory_equal(a->size, b->size, sizeof a->size);
    assert_memory_equal(&a->box, &b->box, sizeof a->box);
    assert_memory_equal(a->voxels, b->voxels, byte_count(a));
}

/* Where a flag is 0 nothing differs. Returns the share of bricks that are flagged. */
static double check_flags(const shape_baked *before, const shape_baked *after, const uint8_t *flags)
{
    const int *n = after->size, nx = n[0] / 8, ny = n[1] / 8;
    size_t flagged = 0;
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++)
            for (int x = 0; x < n[0]; x++) {
                size_t i = ((size_t)z * (size_t)n[1] + (size_t)y) * (size_t)n[0] + (size_t)x;
                bool flag =
                    flags[((size_t)(z / 8) * (size_t)ny + (size_t)(y / 8)) * (size_t)nx + (size_t)(x / 8)];
                flagged += flag;
                if (!flag)
                    assert_memory_equal(before->voxels + 2 * i, after->voxels + 2 * i, 2);
            }
    return (double)flagged / ((double)byte_count(after) / 2);
}

static void baked_again_is_baked_anew(void **state)
{
    (void)state;
    shape_error error;
    shape_random random = shape_random_seed(8, 0);
    for (int kind = 0; kind < KINDS; kind++)
        for (int round = 0; round < EDITS; round++) {
            pair p = new_pair(new_kind((cloud_kind)kind, &random), (edit_kind)round, &random);
            const shape_volume_cloud *clouds[2] = {&p.volumes[0]->clouds[0], &p.volumes[1]->clouds[0]};
            shape_baked before, again, anew;
            uint8_t *flags;
            float voxel = shape_bake_voxel(clouds[0], 0.01f, 100000);
            must(shape_bake(clouds[0], voxel, 1, &before, &error), &error);
            must(shape_bake(clouds[0], voxel, 2, &again, &error), &error);
            must(shape_bake(clouds[1], voxel, 1, &anew, &error), &error);
            must(shape_bake_again(clouds[1], &p.change, 2, (shape_stop){0}, &again, &flags, &error), &error);
            same_baked(&again, &anew);
            if (round != BORDER_OUT) {
                double share = check_flags(&before, &again, flags);
                assert_true(round == SHUFFLE ? share == 0 : share > 0 && share < 0.75);
            }
            free(flags);
            shape_baked_free(&before);
            shape_baked_free(&again);
            shape_baked_free(&anew);
            drop_pair(&p);
        }
}

/* --- columns along the sun, and light grids --- */

static shape_sunsweep *sweep_of(const shape_volume *volume, const shape_light *light, int cells, int threads,
                                shape_sunsweep *from, const shape_change *change)
{
    shape_error error;
    shape_sunsweep *sweep;
    shape_sunsweep_options options = {.threads = threads, .keep = true, .from = from, .changes = change};
    must(shape_sunsweep_create_with(volume, light, &cells, &options, &sweep, &error), &error);
    return sweep;
}

static shape_lightgrid grid_of(const shape_volume *volume, const shape_light *light, int resolution,
                               const shape_sunsweep *sweep, const shape_lightgrid *from,
                               const shape_change *change, bool scattering)
{
    shape_error error;
    shape_lightgrid grid;
    shape_lightgrid_options options = shape_lightgrid_defaults();
    options.resolution = resolution;
    options.sweep = sweep;
    options.threads = 1;
    options.from = from;
    options.change = change;
    options.scattering = scattering;
    must(shape_lightgrid_build(volume, 0, light, &options, &grid, &error), &error);
    return grid;
}

static void same_grid(const shape_lightgrid *a, const shape_lightgrid *b)
{
    size_t cells = (size_t)a->size[0] * (size_t)a->size[1] * (size_t)a->size[2];
    assert_memory_equal(a->size, b->size, sizeof a->size);
    assert_memory_equal(&a->box, &b->box, sizeof a->box);
    assert_memory_equal(a->cells, b->cells, cells * SHAPE_LIGHTGRID_VALUES * sizeof *a->cells);
    assert_memory_equal(a->densities, b->densities, cells * sizeof *a->densities);
}

enum { SWEPT = 24, LIT = 12 };

static void lit_again_is_lit_anew(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(9, 0);
    shape_light light = shape_light_defaults();
    for (int kind = 0; kind < KINDS; kind++)
        for (int round = 0; round < EDITS; round++) {
            light.sun = shape_sun_direction((double)draw(&random, -180, 180), (double)draw(&random, 5, 85));
            pair p = new_pair(new_kind((cloud_kind)kind, &random), (edit_kind)round, &random);
            const shape_change *change = &p.change;
            shape_sunsweep *first = sweep_of(p.volumes[0], &light, SWEPT, 1, NULL, NULL);
            shape_lightgrid before = grid_of(p.volumes[0], &light, LIT, first, NULL, NULL, true);
            shape_sunsweep *again = sweep_of(p.volumes[1], &light, SWEPT, round % 2 + 1, first, change),
                           *anew = sweep_of(p.volumes[1], &light, SWEPT, 1, NULL, NULL);
            if (round != BORDER_OUT)
                assert_true(shape_sunsweep_rows(again) * 4 < shape_sunsweep_rows(anew) * 3);
            shape_lightgrid a = grid_of(p.volumes[1], &light, LIT, again, &before, change, true),
                            b = grid_of(p.volumes[1], &light, LIT, anew, NULL, NULL, true);
            same_grid(&a, &b);
            /* Without scattering, the sun's own light is new and the rest as it was. */
            shape_lightgrid quick = grid_of(p.volumes[1], &light, LIT, again, &before, change, false);
            size_t cells = (size_t)b.size[0] * (size_t)b.size[1] * (size_t)b.size[2];
            for (size_t i = 0; i < cells * SHAPE_LIGHTGRID_VALUES; i++)
                assert_true(quick.cells[i] == (i % SHAPE_LIGHTGRID_VALUES == 0 ? b.cells[i]
                                               : round == BORDER_OUT           ? 0
                                                                               : before.cells[i]));
            shape_lightgrid_free(&quick);
            shape_lightgrid_free(&before);
            shape_lightgrid_free(&a);
            shape_lightgrid_free(&b);
            shape_sunsweep_destroy(first);
            shape_sunsweep_destroy(again);
            shape_sunsweep_destroy(anew);
            drop_pair(&p);
        }
}

/* Edits that follow each other, each from what the last one gave: nothing piles up. */
static void many_edits_in_a_row(void **state)
{
    (void)state;
    enum { STEPS = 12 };
    shape_error error;
    shape_random random = shape_random_seed(10, 0);
    shape_light light = shape_light_defaults();
    light.sun = shape_sun_direction(30, 50);
    shape_set *set = new_kind(SPHERES, &random);
    shape_volume *volume = new_volume(set);
    shape_baked baked;
    float voxel = shape_bake_voxel(&volume->clouds[0], 0.01f, 100000);
    must(shape_bake(&volume->clouds[0], voxel, 1, &baked, &error), &error);
    shape_sunsweep *sweep = sweep_of(volume, &light, SWEPT, 1, NULL, NULL);
    shape_lightgrid grid = grid_of(volume, &light, LIT, sweep, NULL, NULL, true);
    for (int step = 0; step < STEPS; step++) {
        shape_set *next = copy_of(set);
        edit(next, (edit_kind)(step % EDITS), &random);
        shape_volume *then = new_volume(next);
        shape_change change;
        shape_volume_keep_boxes(then, volume);
        must(shape_change_find(&volume->clouds[0], &then->clouds[0], &change, &error), &error);
        shape_volume_destroy(volume); /* sweeps outlive it */
        must(shape_bake_again(&then->clouds[0], &change, 1, (shape_stop){0}, &baked, NULL, &error), &error);
        shape_sunsweep *again = sweep_of(then, &light, SWEPT, 1, sweep, &change);
        shape_lightgrid lit = grid_of(then, &light, LIT, again, &grid, &change, true);
        shape_sunsweep_destroy(sweep);
        shape_lightgrid_free(&grid);
        shape_set_destroy(set);
        shape_change_free(&change);
        set = next, volume = then, sweep = again, grid = lit;
    }
    shape_baked anew;
    must(shape_bake(&volume->clouds[0], voxel, 1, &anew, &error), &error);
    same_baked(&baked, &anew);
    shape_sunsweep *other = sweep_of(volume, &light, SWEPT, 1, NULL, NULL);
    shape_lightgrid lit = grid_of(volume, &light, LIT, other, NULL, NULL, true);
    same_grid(&grid, &lit);
    shape_lightgrid_free(&lit);
    shape_lightgrid_free(&grid);
    shape_sunsweep_destroy(other);
    shape_sunsweep_destroy(sweep);
    shape_baked_free(&anew);
    shape_baked_free(&baked);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* The sun moves: columns are others, densities stay. The extinction changes: columns are summed again and no density asked. */
static void sun_and_medium(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(11, 0);
    shape_light light = shape_light_defaults(), later = light;
    light.sun = shape_sun_direction(30, 50);
    later.sun = shape_sun_direction(40, 20);
    shape_set *set = new_kind(DETAILS, &random);
    shape_volume *volume = new_volume(set);
    shape_sunsweep *sweep = sweep_of(volume, &light, SWEPT, 1, NULL, NULL),
                   *moved = sweep_of(volume, &later, SWEPT, 1, sweep, NULL);
    assert_true(shape_sunsweep_rows(moved) > 0);
    shape_lightgrid first = grid_of(volume, &light, LIT, sweep, NULL, NULL, true),
                    kept = grid_of(volume, &later, LIT, moved, &first, NULL, true),
                    anew = grid_of(volume, &later, LIT, moved, NULL, NULL, true);
    same_grid(&kept, &anew);
    shape_lightgrid_free(&kept);
    shape_lightgrid_free(&anew);
    volume->clouds[0].medium.extinction = 0.7f;
    shape_sunsweep *thin = sweep_of(volume, &light, SWEPT, 2, sweep, NULL),
                   *thin_anew = sweep_of(volume, &light, SWEPT, 1, NULL, NULL);
    assert_int_equal(shape_sunsweep_rows(thin), 0);
    kept = grid_of(volume, &light, LIT, thin, &first, NULL, true);
    anew = grid_of(volume, &light, LIT, thin_anew, NULL, NULL, true);
    same_grid(&kept, &anew);
    shape_lightgrid_free(&first);
    shape_lightgrid_free(&kept);
    shape_lightgrid_free(&anew);
    shape_sunsweep_destroy(sweep);
    shape_sunsweep_destroy(moved);
    shape_sunsweep_destroy(thin);
    shape_sunsweep_destroy(thin_anew);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* Columns without kept densities are the same sums. */
static void keeping_changes_nothing(void **state)
{
    (void)state;
    shape_error error;
    shape_random random = shape_random_seed(12, 0);
    shape_light light = shape_light_defaults();
    light.sun = shape_sun_direction(-100, 35);
    const int cells = SWEPT;
    shape_set *set = new_kind(SPHERES, &random);
    shape_volume *volume = new_volume(set);
    shape_sunsweep *kept = sweep_of(volume, &light, SWEPT, 1, NULL, NULL), *plain;
    must(shape_sunsweep_create(volume, &light, &cells, 2, &plain, &error), &error);
    assert_int_equal(shape_sunsweep_bytes(kept), 2 * shape_sunsweep_bytes(plain));
    for (int i = 0; i < 5000; i++) {
        shape_vec3 p = draw_point(&random, 8);
        assert_true(shape_sunsweep_depth(kept, 0, p) == shape_sunsweep_depth(plain, 0, p));
    }
    shape_sunsweep_destroy(kept);
    shape_sunsweep_destroy(plain);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(changes_are_found),         cmocka_unit_test(density_outside_is_the_same),
        cmocka_unit_test(all_changes_where_it_must), cmocka_unit_test(crowds_are_compared_quickly),
        cmocka_unit_test(baked_again_is_baked_anew), cmocka_unit_test(lit_again_is_lit_anew),
        cmocka_unit_test(many_edits_in_a_row),       cmocka_unit_test(sun_and_medium),
        cmocka_unit_test(keeping_changes_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
