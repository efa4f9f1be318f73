/* For tests: sets to write, and a comparison of sets. */
#ifndef NEPH_SAMPLE_H
#define NEPH_SAMPLE_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "shape/neph.h"
#include "shape/random.h"
#include "shape/set.h"

static inline void must(shape_status status, const shape_error *error)
{
    if (status)
        fail_msg("%s", error->text);
}

static inline float sample_range(shape_random *random, double low, double high)
{
    return (float)shape_random_range(random, low, high);
}

static inline void sample_primitives(shape_primitives *list, shape_random *random, size_t spheres,
                                     size_t ellipsoids)
{
    shape_error error;
    for (size_t i = 0; i < spheres; i++) {
        shape_sphere s = {sample_range(random, -9, 9), sample_range(random, -9, 9),
                          sample_range(random, -9, 9), sample_range(random, 0.01, 3)};
        must(shape_primitives_add_sphere(list, s, &error), &error);
    }
    for (size_t i = 0; i < ellipsoids; i++) {
        shape_ellipsoid e = {.x = sample_range(random, -9, 9),
                             .y = sample_range(random, -9, 9),
                             .z = sample_range(random, -9, 9),
                             .a = sample_range(random, 0.01, 3),
                             .b = sample_range(random, 0.01, 3),
                             .c = sample_range(random, 0.01, 3),
                             .q = {sample_range(random, -1, 1), sample_range(random, -1, 1),
                                   sample_range(random, -1, 1), sample_range(random, 0.1, 1)}};
        must(shape_primitives_add_ellipsoid(list, e, &error), &error);
    }
}

/* Details and, for a layer, all that a layer record holds. */
static inline void sample_layer(shape_field *field, shape_random *random)
{
    shape_layer *l = &field->layer;
    *l = shape_layer_defaults();
    bool layer = field->model == SHAPE_MODEL_LAYER;
    if (shape_random_u32(random) % 2) {
        field->detail.displace = sample_range(random, 0, 2);
        field->detail.displace_scale = sample_range(random, 0, 2);
        if (!layer && field->model != SHAPE_MODEL_METABALL)
            field->detail.smoothness = sample_range(random, 0, 1);
        if (!layer) {
            field->detail.billow = sample_range(random, 0, 1);
            field->detail.wisp = sample_range(random, 0, 1);
        }
        field->detail.detail_depth = sample_range(random, 0, 1);
        field->detail.detail_scale = sample_range(random, 0, 2);
    }
    if (!layer)
        return;
    l->bounds = (shape_bounds)(shape_random_u32(random) % 3);
    l->noise = (shape_noise_kind)(shape_random_u32(random) % 4);
    l->worley_octaves = 1 + (int)(shape_random_u32(random) % 8);
    l->blend = sample_range(random, 0, 1);
    l->gain = sample_range(random, 0, 9);
    l->worley_gain = sample_range(random, 0, 9);
    l->worley_frequency = sample_range(random, 0.1, 9);
    for (int i = 0; i < 3; i++)
        l->stretch[i] = sample_range(random, 0.1, 9);
    l->coverage = sample_range(random, 0, 1);
    l->cut = sample_range(random, 0, 0.9);
    l->ramp[0] = sample_range(random, 0, 0.5);
    l->ramp[1] = sample_range(random, 0.5, 1);
    l->falloff = sample_range(random, 0, 1);
    l->fade_bottom = sample_range(random, 0, 1);
    l->fade_top = sample_range(random, 0, 1);
    l->fade_side = sample_range(random, 0, 1);
    l->planet_radius = l->bounds == SHAPE_BOUNDS_ALTITUDES ? sample_range(random, 0, 100) : 0;
}

static inline void sample_settings(shape_cloud *cloud, shape_random *random)
{
    for (int i = 0; i < 12; i++)
        cloud->frame.m[i / 4][i % 4] = shape_random_range(random, -1, 1) + (i % 5 == 0 ? 3 : 0);
    cloud->seed = (uint64_t)shape_random_u32(random) << 32 | shape_random_u32(random);
    cloud->field = (shape_field){.model = (shape_model)(shape_random_u32(random) % 5),
                                 .kappa = sample_range(random, 0, 1),
                                 .octaves = 1 + (int)(shape_random_u32(random) % 16),
                                 .noise_scale = sample_range(random, 0.01, 2),
                                 .edge = sample_range(random, 0, 9),
                                 .seed = (uint64_t)shape_random_u32(random) << 32 | shape_random_u32(random)};
    sample_layer(&cloud->field, random);
    cloud->medium = (shape_medium){.extinction = sample_range(random, 0, 9),
                                   .albedo = sample_range(random, 0, 1),
                                   .phase = (shape_phase_kind)(shape_random_u32(random) % 5),
                                   .g = sample_range(random, -0.9, 0.9),
                                   .g2 = sample_range(random, -0.9, 0.9),
                                   .lobe_mix = sample_range(random, 0, 1),
                                   .droplet = sample_range(random, 5, 50)};
    int length = (int)(shape_random_u32(random) % SHAPE_MADE_BY_MAX);
    for (int i = 0; i < length; i++)
        cloud->made_by[i] = (char)(' ' + shape_random_u32(random) % 94);
    cloud->made_by[length] = 0;
}

/* A set of a few random clouds: lists of their own, empty lists, copies that share one, extras. */
static inline shape_set *sample_random_set(uint64_t seed)
{
    shape_error error;
    shape_random random = shape_random_seed(seed, 42);
    shape_set *set = shape_set_create(&error);
    size_t clouds = shape_random_u32(&random) % 5;
    for (size_t i = 0; i < clouds; i++) {
        size_t index;
        must(shape_set_add_cloud(set, i % 2 ? "W\xc3\xb6lkchen \xe2\x98\x81" : "cloud", &index, &error),
             &error);
        size_t spheres = shape_random_u32(&random) % 9, ellipsoids = shape_random_u32(&random) % 5;
        sample_primitives(shape_set_list(set, index), &random, spheres, ellipsoids);
        sample_settings(&set->clouds[index], &random);
        if (shape_random_u32(&random) % 2) {
            must(shape_set_add_copy(set, index, &set->clouds[index].frame, NULL, &error), &error);
            if (shape_random_u32(&random) % 2)
                sample_settings(&set->clouds[index + 1], &random);
        }
    }
    size_t extras = shape_random_u32(&random) % 3;
    for (size_t i = 0; i < extras; i++) {
        unsigned char bytes[64];
        size_t size = shape_random_u32(&random) % sizeof bytes;
        for (size_t k = 0; k < size; k++)
            bytes[k] = (unsigned char)shape_random_u32(&random);
        must(shape_set_add_extra(set, i ? "note" : "Zz09", shape_random_u32(&random), bytes, size, &error),
             &error);
    }
    return set;
}

/* The content of tests/frozen/v1.0-two-clouds.neph: a cloud, a placed copy of it, and an extra. */
static inline shape_set *sample_two_clouds(void)
{
    shape_error error;
    shape_set *set = shape_set_create(&error);
    must(shape_set_add_cloud(set, "puff, \"small\"", NULL, &error), &error);
    shape_primitives *list = shape_set_list(set, 0);
    const shape_sphere spheres[2] = {{0, 1, 0, 1.5f}, {-1.25f, 0.5f, 2, 0.1f}};
    const shape_ellipsoid ellipsoid = {
        .x = 4, .y = -2, .z = 0.25f, .a = 3, .b = 2, .c = 0.5f, .q = {0, 0.6f, 0, 0.8f}};
    must(shape_primitives_add_sphere(list, spheres[0], &error), &error);
    must(shape_primitives_add_sphere(list, spheres[1], &error), &error);
    must(shape_primitives_add_ellipsoid(list, ellipsoid, &error), &error);
    shape_cloud *cloud = &set->clouds[0];
    snprintf(cloud->made_by, sizeof cloud->made_by, "neph-test 0.1.0 --count 3 caf\xc3\xa9.lsys");
    cloud->seed = UINT64_C(18446744073709551615);
    cloud->field.noise_scale = 0.2f;
    cloud->field.seed = 7;
    cloud->medium.phase = SHAPE_PHASE_TWO_LOBE;
    const shape_frame frame = {{{2, 0, 0, 200000.004}, {0, 0, -2, 10}, {0, 2, 0, -0.125}}};
    must(shape_set_add_copy(set, 0, &frame, NULL, &error), &error);
    set->clouds[1].field.model = SHAPE_MODEL_METABALL;
    must(shape_set_add_extra(set, "note", 0, "kept", 4, &error), &error);
    return set;
}

/* As docs/neph-format.md says it. */
static inline bool needs_layer_record(const shape_field *field)
{
    const shape_detail *d = &field->detail;
    return field->model == SHAPE_MODEL_LAYER || d->smoothness != 0 || d->displace != 0 ||
           d->displace_scale != 0 || d->billow != 0 || d->wisp != 0 || d->detail_depth != 0 ||
           d->detail_scale != 0;
}

static inline bool has_layer_record(const shape_set *set)
{
    for (size_t i = 0; i < set->cloud_count; i++)
        if (needs_layer_record(&set->clouds[i].field))
            return true;
    return false;
}

static inline void assert_same_floats(const void *a, const void *b, size_t count)
{
    if (count)
        assert_memory_equal(a, b, count * sizeof(float));
}

static inline void assert_same_cloud(const shape_cloud *a, const shape_cloud *b)
{
    assert_string_equal(a->name, b->name);
    assert_string_equal(a->made_by, b->made_by);
    assert_true(a->seed == b->seed && a->list == b->list);
    assert_memory_equal(&a->frame, &b->frame, sizeof a->frame);
    assert_true(a->field.seed == b->field.seed && a->field.model == b->field.model &&
                a->field.octaves == b->field.octaves);
    assert_true(a->field.kappa == b->field.kappa && a->field.noise_scale == b->field.noise_scale &&
                a->field.edge == b->field.edge);
    assert_memory_equal(&a->field.detail, &b->field.detail, sizeof a->field.detail);
    assert_memory_equal(&a->field.layer, &b->field.layer, sizeof a->field.layer);
    assert_memory_equal(&a->medium, &b->medium, sizeof a->medium);
}

static inline void assert_same_set(const shape_set *a, const shape_set *b)
{
    assert_true(a->cloud_count == b->cloud_count && a->list_count == b->list_count &&
                a->extra_count == b->extra_count);
    for (size_t i = 0; i < a->cloud_count; i++)
        assert_same_cloud(&a->clouds[i], &b->clouds[i]);
    for (size_t i = 0; i < a->list_count; i++) {
        const shape_primitives *x = &a->lists[i], *y = &b->lists[i];
        assert_true(x->sphere_count == y->sphere_count && x->ellipsoid_count == y->ellipsoid_count);
        assert_same_floats(x->spheres, y->spheres, 4 * x->sphere_count);
        assert_same_floats(x->ellipsoids, y->ellipsoids, 12 * x->ellipsoid_count);
    }
    for (size_t i = 0; i < a->extra_count; i++) {
        const shape_extra *x = &a->extras[i], *y = &b->extras[i];
        assert_true(x->list == y->list && x->size == y->size && !memcmp(x->type, y->type, 4));
        if (x->size)
            assert_memory_equal(x->bytes, y->bytes, x->size);
    }
}

#endif
