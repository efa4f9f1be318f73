/* Density: each model against its formula, written out in double precision here; support; frames; extinction. */
#include "volume_sample.h"

#include "shape/noise.h"

/* Jiménez 2018 Eq. 1 on the lattice, straight from its definition. */
static double exact_fbm(const shape_field *field, shape_dvec3 p)
{
    int offsets[SHAPE_OCTAVES_MAX][3];
    shape_noise_offsets(field->seed, field->octaves, offsets);
    double sum = 0;
    for (int k = 0; k < field->octaves; k++) {
        double s = pow(2, k) / (double)field->noise_scale, value = 0;
        double q[3] = {p.x * s + offsets[k][0], p.y * s + offsets[k][1], p.z * s + offsets[k][2]};
        for (int corner = 0; corner < 8; corner++) {
            double weight = 1;
            int at[3];
            for (int axis = 0; axis < 3; axis++) {
                int up = corner >> axis & 1;
                double f = q[axis] - floor(q[axis]);
                weight *= up ? f : 1 - f;
                at[axis] = (int)floor(q[axis]) + up;
            }
            value += weight * (double)shape_noise_lattice(at[0], at[1], at[2]);
        }
        sum += pow(0.5, k + 1) * value;
    }
    return sum;
}

/* The models' formulas. *doubt is how near the point lies to where density jumps. */
static double exact_density(const shape_cloud *cloud, const shape_primitives *list, shape_dvec3 p,
                            double *doubt)
{
    const shape_field *f = &cloud->field;
    double u2 = exact_u2(list, p), n = exact_fbm(f, p), kappa = (double)f->kappa, sum = 0, gamma;
    switch (f->model) {
    case SHAPE_MODEL_UNIFORM:
        *doubt = fabs(u2 - 1);
        return u2 <= 1;
    case SHAPE_MODEL_SPHEROID: /* Eq. 2 and Algorithm 1 */
        gamma = exp(-sqrt(u2) / ((1 - kappa) + 2 * kappa * n));
        *doubt = u2 > 1 ? u2 - 1 : fmin(1 - u2, fabs(n - gamma));
        return u2 <= 1 && n < gamma ? n : 0;
    default: /* Eq. 19 to 21 */
        for (size_t i = 0; i < list->sphere_count; i++)
            sum += 1 / fmax(exact_sphere_u2(&list->spheres[i], p), 1e-6);
        for (size_t i = 0; i < list->ellipsoid_count; i++)
            sum += 1 / fmax(exact_ellipsoid_u2(&list->ellipsoids[i], p), 1e-6);
        *doubt = sum < 1 ? 1 - sum : fmin(sum - 1, fabs((double)f->edge * n - sum));
        return sum >= 1 && (double)f->edge * n <= sum ? n : 0;
    }
}

static shape_set *sample(uint64_t stream, shape_model model)
{
    shape_random random = shape_random_seed(200, stream);
    shape_set *set = new_set();
    shape_cloud *cloud = new_cloud(set, model);
    cloud->field.kappa = draw(&random, 0, 1);
    cloud->field.octaves = 1 + (int)(stream % 7);
    cloud->field.noise_scale = draw(&random, 0.1, 1.5);
    cloud->field.seed = shape_hash(stream);
    add_random(set, 0, &random, 1 + stream % 9, stream % 4, 3, 0.4, 2);
    return set;
}

static void models_follow_their_formulas(void **state)
{
    (void)state;
    for (uint64_t k = 0; k < 30; k++) {
        shape_model model = (shape_model)(k % 3);
        shape_set *set = sample(k, model);
        shape_volume *volume = new_volume(set);
        shape_random random = shape_random_seed(201, k);
        long excepted = 0, dense = 0;
        enum { POINTS = 3000 };
        for (int i = 0; i < POINTS; i++) {
            shape_vec3 p = i % 4 ? point_near(volume->clouds[0].list, &random) : draw_point(&random, 5);
            double doubt,
                truth = exact_density(&set->clouds[0], shape_set_list_const(set, 0),
                                      shape_dvec3_make((double)p.x, (double)p.y, (double)p.z), &doubt);
            float density = shape_cloud_density(&volume->clouds[0], p);
            dense += density > 0;
            if (doubt < 1e-4) {
                excepted++;
                continue;
            }
            /* A coordinate is known to 6e-8 of up to 50 cells; each octave's slope times its weight is below a half. */
            if (!(fabs((double)density - truth) <= 1e-4))
                fail_msg("model %d at %g %g %g: %.7g, not %.7g", (int)model, (double)p.x, (double)p.y,
                         (double)p.z, (double)density, truth);
        }
        assert_true(excepted * 100 <= POINTS);
        assert_true(dense > 100);
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
}

static void pole_of_a_metaball_is_finite(void **state)
{
    (void)state;
    shape_set *set = new_set();
    shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_METABALL);
    add_sphere(set, 0, 1, 2, 3, 0.5);
    add_ellipsoid(set, 0, shape_vec3_make(-2, 0, 0), 1, 0.2f, 0.1f, shape_quat_identity());
    shape_volume *volume = new_volume(set);
    static const shape_vec3 poles[] = {{1, 2, 3}, {-2, 0, 0}};
    for (int i = 0; i < 2; i++) {
        shape_vec3 p = poles[i];
        float density = shape_cloud_density(&volume->clouds[0], p);
        double n = exact_fbm(&cloud->field, shape_dvec3_make((double)p.x, (double)p.y, (double)p.z));
        assert_float_equal(density, n, 1e-5); /* the field is a million there: nothing is cut */
        shape_vec3 next = {nextafterf(p.x, 9), p.y, p.z};
        assert_float_equal(shape_cloud_density(&volume->clouds[0], next), n, 1e-4);
    }
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* N equal balls around a point, all at sqrt(N) radii: the field is exactly 1 there, on the edge of every support. */
static void metaball_support_is_as_wide_as_it_must_be(void **state)
{
    (void)state;
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_METABALL)->field.edge = 0;
    for (int i = 0; i < 16; i++) {
        double angle = i * 0.392699;
        add_sphere(set, 0, 3.99 * cos(angle), 0, 3.99 * sin(angle), 1);
    }
    shape_volume *volume = new_volume(set);
    assert_true(shape_cloud_density(&volume->clouds[0], shape_vec3_make(0, 0, 0)) > 0);
    assert_true(shape_cloud_u2(&volume->clouds[0], shape_vec3_make(0, 0, 0)) < 16);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

static void nothing_outside_the_support_or_its_box(void **state)
{
    (void)state;
    for (uint64_t k = 0; k < 12; k++) {
        shape_set *set = sample(40 + k, (shape_model)(k % 3));
        shape_volume *volume = new_volume(set);
        const shape_volume_cloud *cloud = &volume->clouds[0];
        shape_random random = shape_random_seed(202, k);
        int outside = 0;
        for (int i = 0; i < 4000; i++) {
            shape_vec3 p = draw_point(&random, 20);
            bool in_box = p.x >= cloud->box.min.x && p.x <= cloud->box.max.x && p.y >= cloud->box.min.y &&
                          p.y <= cloud->box.max.y && p.z >= cloud->box.min.z && p.z <= cloud->box.max.z;
            double u2 = exact_u2(cloud->list, shape_dvec3_make((double)p.x, (double)p.y, (double)p.z));
            float support2 = cloud->support * cloud->support;
            if (in_box && u2 < (double)support2 * 1.0001)
                continue;
            outside++;
            assert_true(shape_cloud_density(cloud, p) == 0);
            assert_true(shape_cloud_density_at(cloud, p, support2 * 1.0001f) == 0);
            /* The formulas agree that nothing is there: the support is large enough. */
            double doubt;
            assert_true(exact_density(&set->clouds[0], cloud->list,
                                      shape_dvec3_make((double)p.x, (double)p.y, (double)p.z), &doubt) == 0 ||
                        doubt < 1e-4);
        }
        assert_true(outside > 1000);
        assert_true(shape_cloud_density_at(cloud, shape_vec3_make(0, 0, 0), NAN) == 0);
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
}

/* A cloud turned and moved 200 km, seen at the turned and moved points: the same density, noise and all. */
static void frames_carry_density_along(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(203, 0);
    shape_set *set = sample(4, SHAPE_MODEL_SPHEROID);
    set->clouds[0].medium.extinction = 3;
    shape_volume *volume = new_volume(set);
    double m[3][3];
    shape_quat_matrix(draw_rotation(&random), m);
    shape_set *moved = sample(4, SHAPE_MODEL_SPHEROID);
    moved->clouds[0].medium.extinction = 3;
    shape_frame frame = {{{2 * m[0][0], 2 * m[0][1], 2 * m[0][2], 200000},
                          {2 * m[1][0], 2 * m[1][1], 2 * m[1][2], -70},
                          {2 * m[2][0], 2 * m[2][1], 2 * m[2][2], 123456.789}}};
    moved->clouds[0].frame = frame;
    shape_volume *volume_moved = new_volume(moved);
    int dense = 0, differ = 0;
    for (int i = 0; i < 20000; i++) {
        shape_vec3 p = point_near(volume->clouds[0].list, &random);
        shape_dvec3 here = {(double)p.x, (double)p.y, (double)p.z};
        double a = shape_volume_extinction(volume, here);
        double b = shape_volume_extinction(volume_moved, shape_frame_point(&frame, here));
        dense += a > 0;
        /* 200 km in double precision is known to 3e-11 m; a threshold may fall between the two all the same. */
        differ += !(fabs(a - b) <= 3e-5);
        assert_float_equal(a, 3 * (double)shape_cloud_density(&volume->clouds[0], p), 1e-6);
    }
    assert_true(dense > 500);
    assert_true(differ <= 4);
    shape_volume_destroy(volume);
    shape_volume_destroy(volume_moved);
    shape_set_destroy(set);
    shape_set_destroy(moved);
}

static void extinctions_scale_and_add(void **state)
{
    (void)state;
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_UNIFORM)->medium.extinction = 0.5f;
    new_cloud(set, SHAPE_MODEL_UNIFORM)->medium.extinction = 7;
    add_sphere(set, 0, 0, 0, 0, 2);
    add_sphere(set, 1, 1, 0, 0, 2);
    shape_volume *volume = new_volume(set);
    assert_true(shape_volume_extinction(volume, shape_dvec3_make(0.5, 0, 0)) == 7.5);
    assert_true(shape_volume_extinction(volume, shape_dvec3_make(-1.5, 0, 0)) == 0.5);
    assert_true(shape_volume_extinction(volume, shape_dvec3_make(2.5, 0, 0)) == 7);
    assert_true(shape_volume_extinction(volume, shape_dvec3_make(9, 0, 0)) == 0);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

static void refuses_what_is_not_made_of_primitives(void **state)
{
    (void)state;
    shape_error error;
    shape_volume *volume;
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_UNIFORM);
    new_cloud(set, SHAPE_MODEL_GRID);
    assert_int_equal(shape_volume_create(set, &volume, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "cloud"));
    set->clouds[1].field.model = SHAPE_MODEL_UNIFORM;
    memset(&set->clouds[1].frame, 0, sizeof set->clouds[1].frame);
    assert_int_equal(shape_volume_create(set, &volume, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "frame"));
    shape_set_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(models_follow_their_formulas),
        cmocka_unit_test(pole_of_a_metaball_is_finite),
        cmocka_unit_test(metaball_support_is_as_wide_as_it_must_be),
        cmocka_unit_test(nothing_outside_the_support_or_its_box),
        cmocka_unit_test(frames_carry_density_along),
        cmocka_unit_test(extinctions_scale_and_add),
        cmocka_unit_test(refuses_what_is_not_made_of_primitives),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
