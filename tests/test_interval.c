/* Rays: the slab test, entries and exits, joined intervals against plain sampling, u^2 along the ray, optical depth. */
#include "volume_sample.h"

static const double step_of_float = 5.9604644775390625e-8;

/* How far off u^2 may come out in single precision: a place is known to within 16 roundings of the largest number on
 * the way to it, and u changes by 1 / (smallest semi-axis) a metre. */
static double u2_tolerance(double reach, double smallest, double u2)
{
    double u = reach * 16 * step_of_float / smallest;
    return 2 * sqrt(fmax(u2, 1)) * u + u * u;
}

static double reach_of(shape_ray ray, shape_dvec3 centre, double t)
{
    double most = fabs(t) * (double)shape_vec3_length(ray.direction);
    most = fmax(most, (double)shape_vec3_length(ray.origin));
    return fmax(most, shape_dvec3_length(centre));
}

/* Whether a point is in any primitive: 1 and 0 for certain, -1 where it is too close to a surface to say. *least is
 * the exact u^2, *tolerance its allowance. */
static int truth_at(const shape_primitives *list, shape_ray ray, double t, double *least, double *tolerance)
{
    shape_dvec3 p = along(ray, t);
    int answer = 0;
    *least = INFINITY;
    *tolerance = 0;
    for (size_t i = 0; i < shape_primitives_count(list); i++) {
        bool sphere = i < list->sphere_count;
        const shape_sphere *s = sphere ? &list->spheres[i] : NULL;
        const shape_ellipsoid *e = sphere ? NULL : &list->ellipsoids[i - list->sphere_count];
        double u2 = sphere ? exact_sphere_u2(s, p) : exact_ellipsoid_u2(e, p);
        double smallest = sphere ? (double)s->radius : (double)fminf(e->a, fminf(e->b, e->c));
        shape_dvec3 centre = sphere ? shape_dvec3_make((double)s->x, (double)s->y, (double)s->z)
                                    : shape_dvec3_make((double)e->x, (double)e->y, (double)e->z);
        double allowed = u2_tolerance(reach_of(ray, centre, t), smallest, u2);
        if (u2 < 1 - allowed)
            answer = 1;
        else if (u2 < 1 + allowed && answer == 0)
            answer = -1;
        if (u2 < 1 + allowed)
            *tolerance = fmax(*tolerance, allowed);
        *least = fmin(*least, u2);
    }
    return answer;
}

typedef struct tally {
    long points, inside, doubtful;
} tally;

static bool in_intervals(const shape_candidates *found, float t_min, float t_max, float t, size_t *first,
                         size_t *end)
{
    size_t next = 0;
    float t0, t1;
    while (shape_candidates_join(found, t_min, t_max, first, &next, &t0, &t1))
        if (t >= t0 && t <= t1) {
            *end = next;
            return true;
        }
    return false;
}

/* The intervals come in order, do not overlap, lie within the range, and use up all candidates. */
static void check_order(const shape_candidates *found, float t_min, float t_max)
{
    size_t first, next = 0, last = 0;
    float t0, t1, end = -INFINITY;
    while (shape_candidates_join(found, t_min, t_max, &first, &next, &t0, &t1)) {
        assert_int_equal(first, last);
        assert_true(next > first && next <= found->count);
        assert_true(t0 >= t_min && t1 <= t_max && t0 <= t1);
        assert_true(t0 > end);
        for (size_t i = first; i < next; i++) {
            assert_true(i == 0 || found->items[i].t_in >= found->items[i - 1].t_in);
            assert_true(found->items[i].t_in < t_max && found->items[i].t_out > t_min);
        }
        end = t1;
        last = next;
    }
    assert_int_equal(last, found->count);
}

static void check_ray(const shape_volume_cloud *cloud, shape_ray ray, float t_min, float t_max, int samples,
                      shape_random *random, shape_candidates *found, tally *sum)
{
    shape_error error;
    must(shape_cloud_candidates(cloud, ray, t_min, t_max, found, &error), &error);
    check_order(found, t_min, t_max);
    for (int i = 0; i < samples; i++) {
        float t = draw(random, (double)t_min, (double)t_max);
        if (found->count && i % 2) { /* between an entry and an exit, where things happen */
            const shape_candidate *c = &found->items[(size_t)i % found->count];
            t = c->t_in + (c->t_out - c->t_in) * draw(random, -0.2, 1.2);
        }
        if (!(t > t_min && t < t_max))
            continue;
        size_t first = 0, end = 0;
        double least, tolerance;
        int truth = truth_at(cloud->list, ray, (double)t, &least, &tolerance);
        bool marched = in_intervals(found, t_min, t_max, t, &first, &end);
        sum->points++;
        sum->inside += truth == 1;
        sum->doubtful += truth < 0;
        if (truth >= 0 && marched != (truth == 1))
            fail_msg("t = %.9g is %s the intervals, u^2 = %.9g there", (double)t, marched ? "in" : "outside",
                     least);
        if (truth == 1 && marched) {
            float u2 = shape_candidates_u2(found, first, end, 1, t);
            if (!(fabs((double)u2 - least) <= 4 * tolerance + 1e-5))
                fail_msg("t = %.9g: u^2 is %.9g along the ray, %.9g in truth (allowed %g)", (double)t,
                         (double)u2, least, 4 * tolerance);
        }
    }
}

/* Enough was seen, and the exceptions stay below a share. */
static void check_tally(const tally *sum, long least_inside, double doubt)
{
    assert_true(sum->inside >= least_inside);
    assert_true((double)sum->doubtful <= doubt * (double)sum->points);
}

static shape_ray ray_make(shape_vec3 origin, shape_vec3 direction)
{
    shape_ray ray = {origin, direction};
    return ray;
}

static shape_set *crowd(uint64_t stream, size_t spheres, size_t ellipsoids)
{
    shape_random random = shape_random_seed(100, stream);
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_UNIFORM);
    add_random(set, 0, &random, spheres, ellipsoids, 6, 0.3, 3);
    return set;
}

static void joined_intervals_hold_what_the_primitives_hold(void **state)
{
    (void)state;
    enum { SETS = 20, RAYS = 500, SAMPLES = 24 }; /* 10,000 rays */
    tally sum = {0, 0, 0};
    shape_candidates found = {0};
    for (uint64_t k = 0; k < SETS; k++) {
        shape_set *set = crowd(k, 1 + k % 12, k % 7);
        shape_volume *volume = new_volume(set);
        shape_random random = shape_random_seed(101, k);
        for (int i = 0; i < RAYS; i++) {
            shape_vec3 origin = draw_point(&random, 15), direction = draw_direction(&random);
            if (i % 3) /* aimed at the crowd */
                direction = shape_vec3_scale(shape_vec3_sub(draw_point(&random, 6), origin), 0.05f);
            if (i % 5 == 0) /* not of unit length */
                direction = shape_vec3_scale(direction, draw(&random, 0.01, 10));
            if (shape_vec3_length(direction) > 0)
                check_ray(&volume->clouds[0], ray_make(origin, direction), i % 2 ? 0 : -30, 60, SAMPLES,
                          &random, &found, &sum);
        }
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
    check_tally(&sum, 10000, 1e-4);
    shape_candidates_free(&found);
}

static void axis_parallel_rays_and_signed_zeros(void **state)
{
    (void)state;
    tally sum = {0, 0, 0};
    shape_candidates found = {0};
    shape_set *set = crowd(50, 12, 8);
    shape_volume *volume = new_volume(set);
    shape_random random = shape_random_seed(102, 0);
    for (int i = 0; i < 3000; i++) {
        float d[3] = {i & 1 ? 0.0f : -0.0f, i & 2 ? 0.0f : -0.0f, i & 4 ? 0.0f : -0.0f};
        d[i % 3] = i & 8 ? 1.0f : -1.0f;
        if (i % 7 == 0)
            d[(i + 1) % 3] = 0.5f; /* in a plane */
        shape_vec3 origin = draw_point(&random, 8);
        check_ray(&volume->clouds[0], ray_make(origin, shape_vec3_make(d[0], d[1], d[2])), -30, 30, 16,
                  &random, &found, &sum);
    }
    check_tally(&sum, 8000, 1e-4);
    shape_candidates_free(&found);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

static void starts_inside_and_grazes(void **state)
{
    (void)state;
    tally sum = {0, 0, 0};
    shape_candidates found = {0};
    shape_set *set = crowd(60, 10, 6);
    shape_volume *volume = new_volume(set);
    const shape_primitives *list = volume->clouds[0].list;
    shape_random random = shape_random_seed(103, 0);
    for (int i = 0; i < 3000; i++) {
        const shape_sphere *s = &list->spheres[i % 10];
        shape_vec3 c = {s->x, s->y, s->z}, d = draw_direction(&random);
        shape_vec3 aside = shape_vec3_cross(d, draw_direction(&random));
        aside = shape_vec3_scale(aside, 1 / shape_vec3_length(aside));
        /* A start inside, a tangent (a hair inside, a hair outside), a ray through the very centre. */
        static const float off[] = {0.5f, 0.9999f, 1.0001f, 1, 0, 0.999999f};
        shape_vec3 near = shape_vec3_add(c, shape_vec3_scale(aside, s->radius * off[i % 6]));
        if (i % 6)
            near = shape_vec3_sub(near, shape_vec3_scale(d, 5));
        check_ray(&volume->clouds[0], ray_make(near, d), 0, 30, 24, &random, &found, &sum);
    }
    check_tally(&sum, 8000, 0.15);
    shape_candidates_free(&found);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

static void needles_coins_and_sizes_a_million_apart(void **state)
{
    (void)state;
    tally sum = {0, 0, 0};
    shape_candidates found = {0};
    for (uint64_t k = 0; k < 8; k++) {
        shape_random random = shape_random_seed(104, k);
        shape_set *set = new_set();
        new_cloud(set, SHAPE_MODEL_UNIFORM);
        for (int i = 0; i < 6; i++) {
            float thin = draw_size(&random, 0.01, 0.03), wide = draw_size(&random, 1, 5);
            add_ellipsoid(set, 0, draw_point(&random, 3), wide, thin, i % 2 ? thin : wide,
                          draw_rotation(&random));
        }
        add_sphere(set, 0, 0, 0, 0, k % 2 ? 1e3 : 1);
        add_sphere(set, 0, k % 2 ? 1000.0005 : 1.5, 0, 0, k % 2 ? 1e-3 : 0.02);
        shape_volume *volume = new_volume(set);
        for (int i = 0; i < 300; i++) {
            shape_vec3 origin = draw_point(&random, 6);
            shape_vec3 aim = shape_vec3_sub(draw_point(&random, 2), origin);
            if (shape_vec3_length(aim) > 0)
                check_ray(&volume->clouds[0],
                          ray_make(origin, shape_vec3_scale(aim, 1 / shape_vec3_length(aim))), -10, 20, 24,
                          &random, &found, &sum);
        }
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
    check_tally(&sum, 3000, 0.005);
    shape_candidates_free(&found);
}

/* A sphere of 1,000 m seen from 1,000 km: half the chord squared is r^2 - b^2, which is known to 2 r times the error of
 * b. With b^2 taken as a difference of squares of the distance (1e12), nothing would be left of it. */
static void far_spheres_do_not_cancel(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(105, 0);
    for (int i = 0; i < 5000; i++) {
        shape_vec3 way = draw_direction(&random);
        shape_sphere s = {1e6f * way.x, 1e6f * way.y, 1e6f * way.z, 1000};
        shape_vec3 aim = {s.x + draw(&random, -700, 700), s.y + draw(&random, -700, 700),
                          s.z + draw(&random, -700, 700)};
        shape_ray ray = {{0, 0, 0}, shape_vec3_scale(aim, 1 / shape_vec3_length(aim))};
        shape_dvec3 c = {(double)s.x, (double)s.y, (double)s.z};
        shape_dvec3 d = {(double)ray.direction.x, (double)ray.direction.y, (double)ray.direction.z};
        double a = shape_dvec3_dot(d, d), middle = shape_dvec3_dot(c, d) / a;
        shape_dvec3 off = shape_dvec3_sub(c, shape_dvec3_scale(d, middle));
        double half2 = (1e6 - shape_dvec3_dot(off, off)) / a;
        shape_candidate hit;
        bool meets = shape_sphere_intersect(&s, 1, ray, &hit);
        double allowed = 2 * 1000 * 8 * step_of_float * 1e6;
        if (half2 > allowed) {
            assert_true(meets);
            double half = ((double)hit.t_out - (double)hit.t_in) / 2,
                   mid = ((double)hit.t_out + (double)hit.t_in) / 2;
            /* The ends themselves are rounded to steps of 1/16 m. */
            assert_true(fabs(half * half - half2) <= allowed + 2 * half * 16 * step_of_float * 1e6);
            assert_true(fabs(mid - middle) <= 8 * step_of_float * 1e6);
        } else if (half2 < -allowed) {
            assert_false(meets);
        }
    }
}

/* The ray's stretch in a box, the largest entry and the least exit in double precision. */
static bool plain_slabs(shape_box box, shape_ray ray, double *t0, double *t1)
{
    const float *low = &box.min.x, *high = &box.max.x, *o = &ray.origin.x, *d = &ray.direction.x;
    for (int axis = 0; axis < 3; axis++) {
        if (d[axis] == 0) {
            if (o[axis] < low[axis] || o[axis] > high[axis])
                return false;
            continue;
        }
        double a = ((double)low[axis] - (double)o[axis]) / (double)d[axis];
        double b = ((double)high[axis] - (double)o[axis]) / (double)d[axis];
        *t0 = fmax(*t0, fmin(a, b));
        *t1 = fmin(*t1, fmax(a, b));
    }
    return *t0 <= *t1;
}

static void slab_test_agrees_with_plain_slabs(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(106, 0);
    long hits = 0, close = 0;
    for (int i = 0; i < 40000; i++) {
        shape_vec3 a = draw_point(&random, 3), b = draw_point(&random, 3);
        shape_box box = {shape_vec3_make(fminf(a.x, b.x), fminf(a.y, b.y), fminf(a.z, b.z)),
                         shape_vec3_make(fmaxf(a.x, b.x), fmaxf(a.y, b.y), fmaxf(a.z, b.z))};
        shape_ray ray = {draw_point(&random, 5), {0, 0, 0}};
        ray.direction = shape_vec3_sub(draw_point(&random, 2), ray.origin);
        float *o = &ray.origin.x, *d = &ray.direction.x;
        if (i % 4 == 1)
            d[i % 3] = i & 4 ? 0.0f : -0.0f;
        if (i % 8 == 5) /* in a face of the box, and along it */
            o[i % 3] = i & 16 ? (&box.min.x)[i % 3] : (&box.max.x)[i % 3];
        if (i % 16 == 3) /* two zeros */
            d[(i + 1) % 3] = 0, d[(i + 2) % 3] = -0.0f, d[i % 3] = 1;
        if (i % 32 == 6) /* a box without thickness */
            (&box.min.x)[i % 3] = (&box.max.x)[i % 3];
        float t0 = i % 2 ? 0 : -20, t1 = 20;
        double s0 = (double)t0, s1 = (double)t1;
        bool truth = plain_slabs(box, ray, &s0, &s1), told = shape_box_intersect(box, ray, &t0, &t1);
        hits += truth;
        if (fabs(s1 - s0) < 1e-5 * (1 + fabs(s0)) && s1 != s0) {
            close++;
            continue; /* an edge or a corner */
        }
        assert_int_equal(told, truth);
        if (truth) {
            assert_true(fabs((double)t0 - s0) <= 2e-6 * (1 + fabs(s0)));
            assert_true(fabs((double)t1 - s1) <= 2e-6 * (1 + fabs(s1)));
        }
    }
    assert_true(hits > 4000);
    assert_true(close < 400);
}

static void box_is_left_alone_where_it_is_missed(void **state)
{
    (void)state;
    shape_box box = {{-1, -1, -1}, {1, 1, 1}};
    float t0 = 0, t1 = 9;
    assert_false(shape_box_intersect(box, ray_make((shape_vec3){0, 2, 5}, (shape_vec3){0, 0, -1}), &t0, &t1));
    assert_true(t0 == 0 && t1 == 9);
    assert_false(shape_box_intersect(box, ray_make((shape_vec3){0, 0, 5}, (shape_vec3){0, 0, 1}), &t0, &t1));
    assert_true(
        shape_box_intersect(box, ray_make((shape_vec3){0, 1, 5}, (shape_vec3){0, -0.0f, -1}), &t0, &t1));
    assert_true(t0 == 4 && t1 == 6);
}

static void optical_depth_of_a_sphere_is_sigma_times_chord(void **state)
{
    (void)state;
    shape_error error;
    shape_candidates scratch = {0};
    shape_set *set = new_set();
    shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_UNIFORM);
    cloud->medium.extinction = 1.75f;
    add_sphere(set, 0, 0.25, -0.5, 0.125, 2);
    shape_volume *volume = new_volume(set);
    shape_random random = shape_random_seed(107, 0);
    for (int i = 0; i < 2000; i++) {
        shape_dvec3 origin = {0.25, -0.5, 3.125},
                    aim = {draw(&random, -1.5, 1.5), draw(&random, -2, 1), 0.125}, d;
        if (i % 4 == 0) /* from inside */
            origin = shape_dvec3_make(0.5, -0.25, 0.125);
        d = shape_dvec3_normalize(shape_dvec3_sub(aim, origin));
        shape_dvec3 v = shape_dvec3_sub(origin, shape_dvec3_make(0.25, -0.5, 0.125));
        double b = shape_dvec3_dot(v, d), c = shape_dvec3_dot(v, v) - 4, half = sqrt(b * b - c);
        double chord = c < 0 ? half - b : 2 * half, depth;
        float step = draw(&random, 0.01, 5);
        must(shape_volume_optical_depth(volume, origin, d, 0, 1e30f, step, &scratch, &depth, &error), &error);
        assert_true(fabs(depth / (1.75 * chord) - 1) < 1e-6);
        /* Parts add up to the whole. */
        double first, second;
        float cut = draw(&random, 0, 5);
        must(shape_volume_optical_depth(volume, origin, d, 0, cut, step, &scratch, &first, &error), &error);
        must(shape_volume_optical_depth(volume, origin, d, cut, 9, step, &scratch, &second, &error), &error);
        assert_true(fabs(first + second - depth) < 2e-6 * depth);
    }
    shape_volume_destroy(volume);
    shape_set_destroy(set);
    shape_candidates_free(&scratch);
}

/* Overlaps count once within a cloud, twice between clouds; a placed, turned and scaled copy is as deep as its metres
 * of the world are many. */
static void optical_depth_of_unions_and_placed_clouds(void **state)
{
    (void)state;
    shape_error error;
    shape_candidates scratch = {0};
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_UNIFORM)->medium.extinction = 1;
    add_sphere(set, 0, -0.5, 0, 0, 1);
    add_sphere(set, 0, 0.5, 0, 0, 1);
    shape_dvec3 right = {1, 0, 0};
    double depth;
    shape_volume *volume = new_volume(set);
    must(shape_volume_optical_depth(volume, shape_dvec3_make(-8, 0, 0), right, 0, 1e30f, 0.1f, &scratch,
                                    &depth, &error),
         &error);
    assert_true(fabs(depth - 3) < 2e-6);
    shape_volume_destroy(volume);
    size_t index;
    shape_frame frame = {
        {{0, 0, 3, 200000}, {3, 0, 0, 7}, {0, 3, 0, -1e6}}}; /* x -> y, y -> z, z -> x, thrice */
    must(shape_set_add_copy(set, 0, &frame, &index, &error), &error);
    volume = new_volume(set);
    must(shape_volume_optical_depth(volume, shape_dvec3_make(200000, -10, -1e6), shape_dvec3_make(0, 1, 0), 0,
                                    1e30f, 0.1f, &scratch, &depth, &error),
         &error);
    assert_true(fabs(depth - 9) < 1e-5);
    shape_volume_destroy(volume);
    frame = shape_frame_identity();
    set->clouds[1].frame = frame;
    set->clouds[1].medium.extinction = 0.25f;
    volume = new_volume(set);
    must(shape_volume_optical_depth(volume, shape_dvec3_make(-8, 0, 0), right, 0, 1e30f, 0.1f, &scratch,
                                    &depth, &error),
         &error);
    assert_true(fabs(depth - 3 * 1.25) < 4e-6);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
    shape_candidates_free(&scratch);
}

/* Ten thousand spheres on one ray, apart and all at one point. */
static void ten_thousand_on_one_ray(void **state)
{
    (void)state;
    shape_error error;
    shape_candidates scratch = {0};
    for (int kind = 0; kind < 2; kind++) {
        shape_set *set = new_set();
        new_cloud(set, SHAPE_MODEL_UNIFORM)->medium.extinction = 1;
        for (int i = 0; i < 10000; i++)
            add_sphere(set, 0, 0, 0, kind ? 0 : i, kind ? 1 + i / 10000.0 : 0.25);
        shape_volume *volume = new_volume(set);
        double depth, truth = kind ? 2 * 1.9999 : 5000;
        must(shape_volume_optical_depth(volume, shape_dvec3_make(0, 0, -50), shape_dvec3_make(0, 0, 1), 0,
                                        1e30f, 0.05f, &scratch, &depth, &error),
             &error);
        assert_int_equal(scratch.count, 10000);
        /* A chord's ends are rounded to a float of up to 10,050 m: 5e-4 of half a metre, evenly either way. */
        assert_true(fabs(depth / truth - 1) < (kind ? 1e-5 : 1e-4));
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
    shape_candidates_free(&scratch);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(joined_intervals_hold_what_the_primitives_hold),
        cmocka_unit_test(axis_parallel_rays_and_signed_zeros),
        cmocka_unit_test(starts_inside_and_grazes),
        cmocka_unit_test(needles_coins_and_sizes_a_million_apart),
        cmocka_unit_test(far_spheres_do_not_cancel),
        cmocka_unit_test(slab_test_agrees_with_plain_slabs),
        cmocka_unit_test(box_is_left_alone_where_it_is_missed),
        cmocka_unit_test(optical_depth_of_a_sphere_is_sigma_times_chord),
        cmocka_unit_test(optical_depth_of_unions_and_placed_clouds),
        cmocka_unit_test(ten_thousand_on_one_ray),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
