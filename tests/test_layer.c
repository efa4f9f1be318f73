/* Layers and details: support, coverage, ramp, falloff, shells, the closed form of the smooth union, identities. */
#include "volume_sample.h"

#include "shape/layer.h"
#include "shape/lightgrid.h"

static shape_volume *layer_volume(shape_set *set, const shape_layer_options *options)
{
    shape_error error;
    size_t index;
    must(shape_set_add_cloud(set, "layer", &index, &error), &error);
    must(shape_layer_make(options, &set->clouds[index], shape_set_list(set, index), &error), &error);
    return new_volume(set);
}

static shape_vec3 point_in(shape_box box, shape_random *random, double grow)
{
    float p[3];
    for (int axis = 0; axis < 3; axis++) {
        double low = (double)(&box.min.x)[axis], high = (double)(&box.max.x)[axis],
               more = grow * (high - low);
        p[axis] = draw(random, low - more, high + more);
    }
    return shape_vec3_make(p[0], p[1], p[2]);
}

/* Every kind of cloud with details, and every kind of bounds, from random primitives. */
static void make_sample(shape_set *set, uint64_t kind)
{
    shape_random random = shape_random_seed(400, kind);
    shape_cloud *cloud = new_cloud(set, kind < 3 ? (shape_model)kind : SHAPE_MODEL_LAYER);
    cloud->field.noise_scale = 0.5f;
    cloud->field.seed = kind + 1;
    cloud->field.detail.displace = kind % 2 || kind == 2 ? 0.8f : 0;
    if (kind < 2) {
        cloud->field.detail.smoothness = 0.25f;
        cloud->field.detail.billow = kind ? 0.5f : 0;
    }
    cloud->field.layer.bounds = (shape_bounds)(kind % 3);
    cloud->field.layer.noise = (shape_noise_kind)(kind % 4);
    cloud->field.layer.coverage = 1;
    if (cloud->field.layer.bounds == SHAPE_BOUNDS_ALTITUDES)
        cloud->field.layer.planet_radius = kind < 8 ? 9 : 0;
    add_random(set, 0, &random, 4, 5, 4, 0.4, 2);
}
enum { SAMPLES = 12 };

/* Outside the box, and where no support holds the point, there is nothing; asked without the support's distance, the
 * density is the same. */
static void density_stays_in_its_support(void **state)
{
    (void)state;
    for (uint64_t kind = 0; kind < SAMPLES; kind++) {
        shape_set *set = new_set();
        make_sample(set, kind);
        shape_volume *volume = new_volume(set);
        const shape_volume_cloud *cloud = &volume->clouds[0];
        shape_random random = shape_random_seed(401, kind);
        long dense = 0;
        for (int i = 0; i < 20000; i++) {
            shape_vec3 p = point_in(cloud->box, &random, 0.3);
            float density = shape_cloud_density_at(cloud, p, 0);
            bool in_box = p.x >= cloud->box.min.x && p.x <= cloud->box.max.x && p.y >= cloud->box.min.y &&
                          p.y <= cloud->box.max.y && p.z >= cloud->box.min.z && p.z <= cloud->box.max.z;
            dense += density > 0;
            assert_true(density >= 0 && density <= 1);
            assert_true(density == 0 ||
                        (in_box && shape_cloud_u2(cloud, p) <= cloud->support * cloud->support));
            assert_true(shape_cloud_density(cloud, p) == density);
        }
        assert_true(dense > 20);
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
}

/* A ray through a support marches over all of the density on it: what the intervals hold is what the points say. */
static void intervals_hold_all_density(void **state)
{
    (void)state;
    shape_error error;
    shape_candidates found = {0};
    for (uint64_t kind = 0; kind < SAMPLES; kind++) {
        shape_set *set = new_set();
        make_sample(set, kind);
        shape_volume *volume = new_volume(set);
        const shape_volume_cloud *cloud = &volume->clouds[0];
        shape_random random = shape_random_seed(402, kind);
        for (int i = 0; i < 40; i++) {
            shape_ray ray = {point_in(cloud->box, &random, 0), draw_direction(&random)};
            must(shape_cloud_candidates(cloud, ray, -30, 30, &found, &error), &error);
            for (float t = -30; t < 30; t += 0.05f) {
                shape_vec3 p = shape_vec3_add(ray.origin, shape_vec3_scale(ray.direction, t));
                if (!(shape_cloud_density_at(cloud, p, 0) > 0))
                    continue;
                bool held = false;
                for (size_t k = 0; k < found.count && !held; k++)
                    held = t >= found.items[k].t_in - 1e-3f && t <= found.items[k].t_out + 1e-3f;
                assert_true(held);
            }
        }
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
    shape_candidates_free(&found);
}

static void coverage_goes_from_nothing_to_full(void **state)
{
    (void)state;
    for (int noise = 0; noise < 4; noise++) {
        float before[500] = {0};
        for (int step = 0; step <= 10; step++) {
            shape_layer_options options = shape_layer_options_defaults();
            options.layer.noise = (shape_noise_kind)noise;
            options.layer.coverage = (float)step / 10;
            shape_set *set = new_set();
            shape_volume *volume = layer_volume(set, &options);
            shape_random random = shape_random_seed(403, 1);
            for (int i = 0; i < 500; i++) {
                shape_vec3 p = {draw(&random, -9.9, 9.9), draw(&random, 0.1, 5.9), draw(&random, -9.9, 9.9)};
                float density = shape_cloud_density(&volume->clouds[0], p);
                assert_true(density >= before[i]);
                assert_true(step > 0 || density == 0);
                assert_true(step < 10 || density == 1);
                before[i] = density;
            }
            shape_volume_destroy(volume);
            shape_set_destroy(set);
        }
    }
}

/* The same noise through other thresholds: density is smoothstep of one number a point, and cut moves that number. */
static void the_ramp_is_a_smoothstep(void **state)
{
    (void)state;
    shape_layer_options options = shape_layer_options_defaults();
    options.layer.gain = options.layer.worley_gain = 2;
    options.layer.ramp[0] = 0, options.layer.ramp[1] = 1;
    shape_layer_options narrow = options, cut = options;
    narrow.layer.ramp[0] = 0.4f, narrow.layer.ramp[1] = 0.6f;
    cut.layer.cut = 0.3f;
    shape_set *a = new_set(), *b = new_set(), *c = new_set();
    shape_volume *wide = layer_volume(a, &options), *ramp = layer_volume(b, &narrow),
                 *less = layer_volume(c, &cut);
    shape_random random = shape_random_seed(404, 1);
    for (int i = 0; i < 5000; i++) {
        shape_vec3 p = {draw(&random, -10, 10), draw(&random, 0, 6), draw(&random, -10, 10)};
        /* The inverse of y = x^2 (3 - 2x) on 0 to 1. */
        double y = (double)shape_cloud_density(&wide->clouds[0], p), x = 0.5 - sin(asin(1 - 2 * y) / 3);
        double t = fmin(fmax((x - 0.4) / 0.2, 0), 1), u = fmax((x - 0.3) / 0.7, 0);
        if (y <= 0 || y >= 1)
            continue;
        /* The inverse loses half of the digits near 0 and 1: 2e-3 = 5 sqrt(1e-7), by the ramp's slope of 7.5. */
        assert_float_equal(shape_cloud_density(&ramp->clouds[0], p), t * t * (3 - 2 * t), 1e-2);
        assert_float_equal(shape_cloud_density(&less->clouds[0], p), u * u * (3 - 2 * u), 1e-2);
    }
    shape_volume_destroy(wide);
    shape_volume_destroy(ramp);
    shape_volume_destroy(less);
    shape_set_destroy(a);
    shape_set_destroy(b);
    shape_set_destroy(c);
}

/* Article 003: a cloud of noise in a falloff does not touch the grid's wall, even where the noise is full. */
static void falloffs_never_touch_the_wall(void **state)
{
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        shape_layer_options options = shape_layer_options_defaults();
        options.layer.bounds = (shape_bounds)kind;
        options.layer.coverage = 1;
        options.layer.ramp[0] = 0;
        options.layer.ramp[1] = 0;
        options.layer.falloff = 0.3f;
        shape_set *set = new_set();
        shape_volume *volume = layer_volume(set, &options);
        const shape_volume_cloud *cloud = &volume->clouds[0];
        shape_random random = shape_random_seed(405, 1);
        long dense = 0;
        for (int i = 0; i < 20000; i++) {
            shape_vec3 p = point_in(cloud->box, &random, 0);
            float x = p.x / 10, y = (p.y - 3) / 3, z = p.z / 10, r2 = x * x + y * y + z * z;
            float density = shape_cloud_density(cloud, p);
            dense += density > 0;
            assert_true(r2 < 1 || density == 0);
            assert_true(r2 > 0.48f || density == 1); /* within 1 - falloff it is as full as without */
            (&p.x)[i % 3] = (&cloud->box.min.x)[3 * (i / 3 % 2) + i % 3];
            assert_true(shape_cloud_density(cloud, p) == 0);
        }
        assert_true(dense > 1000);
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
}

/* A full layer between two altitudes is a shell: dense exactly where the distance from the planet's centre says so. */
static void shells_follow_the_planet(void **state)
{
    (void)state;
    static const double radii[3] = {40, 1000, 6371000};
    for (int i = 0; i < 3; i++) {
        shape_layer_options options = shape_layer_options_defaults();
        options.layer.bounds = SHAPE_BOUNDS_ALTITUDES;
        options.layer.coverage = 1;
        options.extent[0] = options.extent[2] = 50;
        options.extent[1] = 2;
        options.base = 5;
        options.planet_radius = radii[i];
        shape_set *set = new_set();
        shape_volume *volume = layer_volume(set, &options);
        const shape_volume_cloud *cloud = &volume->clouds[0];
        shape_random random = shape_random_seed(406, 1);
        long dense = 0;
        for (int k = 0; k < 20000; k++) {
            shape_vec3 p = point_in(cloud->box, &random, 0.1);
            double x = (double)p.x, y = (double)p.y, z = (double)p.z, rim = sqrt(x * x + z * z);
            double altitude = sqrt(x * x + z * z + (radii[i] + y) * (radii[i] + y)) - radii[i];
            double doubt = fmin(fabs(rim - 25), fmin(fabs(altitude - 5), fabs(altitude - 7)));
            bool inside = rim < 25 && altitude > 5 && altitude < 7;
            if (doubt > 1e-4) /* single precision of 50 m */
                assert_float_equal(shape_cloud_density(cloud, p), inside, 0);
            dense += inside;
        }
        assert_true(dense > 300);
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
}

/* Two spheres of radius 1: in the plane between them both distances are u, and the smooth union is u - k there. */
static void smooth_union_has_its_closed_form(void **state)
{
    (void)state;
    for (int step = 1; step <= 4; step++) {
        float k = 0.1f * (float)step;
        shape_set *set = new_set();
        shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_UNIFORM);
        cloud->field.detail.smoothness = k;
        add_sphere(set, 0, -0.6, 0, 0, 1);
        add_sphere(set, 0, 0.6, 0, 0, 1);
        shape_volume *volume = new_volume(set);
        double low = 0, high = 4;
        for (int i = 0; i < 40; i++) { /* where the waist's surface is */
            double y = (low + high) / 2;
            bool inside = shape_cloud_density(&volume->clouds[0], shape_vec3_make(0, (float)y, 0)) > 0;
            low = inside ? y : low;
            high = inside ? high : y;
        }
        assert_float_equal(low, sqrt((1 + (double)k) * (1 + (double)k) - 0.36), 1e-5);
        /* at any other place the two-argument formula of article 001 */
        shape_random random = shape_random_seed(407, (uint64_t)step);
        for (int i = 0; i < 5000; i++) {
            shape_vec3 p = draw_point(&random, 2);
            double rest = (double)p.y * (double)p.y + (double)p.z * (double)p.z;
            double a = sqrt(((double)p.x + 0.6) * ((double)p.x + 0.6) + rest),
                   b = sqrt(((double)p.x - 0.6) * ((double)p.x - 0.6) + rest);
            double h = fmax(4 * (double)k - fabs(a - b), 0) / (4 * (double)k),
                   u = fmin(a, b) - h * h * (double)k;
            if (fabs(u - 1) > 1e-5)
                assert_float_equal(shape_cloud_density(&volume->clouds[0], p), u < 1, 0);
        }
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
}

/* Small details change little: with smoothness, displacement and erosion of 1e-6 the density is that without, but within
 * 1e-4 of where it jumps; with zeros it is the same to the bit. */
static void small_details_vanish(void **state)
{
    (void)state;
    for (int model = 0; model < 3; model++)
        for (int which = 0; which < 5; which++) {
            shape_set *plain = new_set(), *detailed = new_set();
            for (int i = 0; i < 2; i++) {
                shape_set *set = i ? detailed : plain;
                shape_random random = shape_random_seed(408, (uint64_t)model);
                new_cloud(set, (shape_model)model);
                add_random(set, 0, &random, 15, 15, 3, 0.4, 2);
            }
            shape_detail *d = &detailed->clouds[0].field.detail;
            float *members[] = {&d->displace, &d->billow, &d->wisp, &d->smoothness};
            d->displace_scale = 3, d->detail_scale = 2,
            d->detail_depth = 0.3f; /* alone they change nothing */
            if (which < 4 && !(which == 3 && model == SHAPE_MODEL_METABALL))
                *members[which] = 1e-6f;
            shape_volume *a = new_volume(plain), *b = new_volume(detailed);
            shape_random random = shape_random_seed(409, (uint64_t)model);
            long differ = 0;
            enum { COUNT = 5000 };
            for (int i = 0; i < COUNT; i++) {
                shape_vec3 p = point_near(shape_set_list(plain, 0), &random);
                float with = shape_cloud_density(&b->clouds[0], p),
                      without = shape_cloud_density(&a->clouds[0], p);
                differ += fabsf(with - without) > 1e-5f;
                assert_true(which < 4 || with == without);
            }
            assert_true(differ <= COUNT / 500);
            shape_volume_destroy(a);
            shape_volume_destroy(b);
            shape_set_destroy(plain);
            shape_set_destroy(detailed);
        }
}

/* Billows and wisps only take away, each on its own side, and nothing below their depth. */
static void erosion_stays_near_the_surface(void **state)
{
    (void)state;
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_UNIFORM);
    add_sphere(set, 0, 0, 0, 0, 2);
    long gone[2][2] = {{0, 0}, {0, 0}};
    for (int wisp = 0; wisp < 2; wisp++) {
        shape_detail *d = &set->clouds[0].field.detail;
        d->billow = wisp ? 0 : 1;
        d->wisp = wisp ? 1 : 0;
        d->detail_depth = 0.4f;
        shape_volume *volume = new_volume(set);
        shape_random random = shape_random_seed(410, 1);
        for (int i = 0; i < 20000; i++) {
            shape_vec3 p = draw_point(&random, 2);
            float u = shape_vec3_length(p) / 2, density = shape_cloud_density(&volume->clouds[0], p);
            assert_true(u <= 1 || density == 0);
            assert_true(u > 0.6f || density == 1);
            if (u > 0.7f && u < 0.99f && fabsf(p.y) > 1)
                gone[wisp][p.y > 0] += density < 0.5f;
        }
        shape_volume_destroy(volume);
    }
    assert_true(gone[0][1] > 2 * gone[0][0] && gone[1][0] > 2 * gone[1][1]);
    shape_set_destroy(set);
}

/* A full box of a known extinction is as deep as it is thick, so the light grid finds exp(-depth) behind it. */
static void light_goes_through_layers(void **state)
{
    (void)state;
    shape_error error;
    shape_layer_options options = shape_layer_options_defaults();
    options.layer.coverage = 1;
    options.extinction = 0.5;
    shape_set *set = new_set();
    shape_volume *volume = layer_volume(set, &options);
    shape_candidates scratch = {0};
    double depth;
    must(shape_volume_optical_depth(volume, shape_dvec3_make(1, 20, 2), shape_dvec3_make(0, -1, 0), 0, 1e30f,
                                    0.1f, &scratch, &depth, &error),
         &error);
    assert_float_equal(depth, 0.5 * 6, 0.5 * 0.1 * 2); /* within a step at each wall */
    shape_candidates_free(&scratch);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

static void settings_are_checked(void **state)
{
    (void)state;
    shape_error error;
    shape_field field = shape_field_defaults();
    struct {
        float *member, bad;
        const char *says;
    } cases[] = {{&field.layer.coverage, 1.1f, "coverage"},
                 {&field.layer.cut, 1, "cut"},
                 {&field.layer.ramp[0], 0.9f, "ramp's B"},
                 {&field.layer.ramp[1], NAN, "ramp's B"},
                 {&field.layer.stretch[2], 0, "stretch along z"},
                 {&field.layer.falloff, -1, "falloff"},
                 {&field.layer.planet_radius, 5, "planet-radius"},
                 {&field.detail.displace, INFINITY, "displace"},
                 {&field.detail.smoothness, 0.1f, "smoothness"},
                 {&field.detail.billow, 0.1f, "billow"},
                 {&field.layer.worley_frequency, 0, "worley-frequency"}};
    field.model = SHAPE_MODEL_LAYER;
    must(shape_field_check(&field, &error), &error);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        float good = *cases[i].member;
        *cases[i].member = cases[i].bad;
        assert_int_equal(shape_field_check(&field, &error), SHAPE_ERROR_ARGUMENT);
        assert_non_null(strstr(error.text, cases[i].says));
        *cases[i].member = good;
    }
    for (int preset = 0; preset < 3; preset++) {
        shape_layer_options options = shape_layer_options_preset((shape_layer_preset)preset);
        must(shape_layer_options_check(&options, &error), &error);
    }
    shape_layer_options options = shape_layer_options_defaults();
    options.extent[1] = 0;
    assert_int_equal(shape_layer_options_check(&options, &error), SHAPE_ERROR_ARGUMENT);
    struct {
        double base, planet, extinction;
        const char *part;
    } wrong[] = {{2e8, 0, 1, "base is 2e+08"},
                 {NAN, 0, 1, "base is nan"},
                 {0, -1, 1, "planet-radius is -1"},
                 {-2000, 1000, 1, "above the planet's centre"},
                 {0, 0, -1, "extinction is -1"}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        options = shape_layer_options_defaults();
        options.base = wrong[i].base;
        options.planet_radius = wrong[i].planet;
        options.extinction = wrong[i].extinction;
        assert_int_equal(shape_layer_options_check(&options, &error), SHAPE_ERROR_ARGUMENT);
        if (!strstr(error.text, wrong[i].part))
            fail_msg("\"%s\" does not say \"%s\"", error.text, wrong[i].part);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(density_stays_in_its_support),
        cmocka_unit_test(intervals_hold_all_density),
        cmocka_unit_test(coverage_goes_from_nothing_to_full),
        cmocka_unit_test(the_ramp_is_a_smoothstep),
        cmocka_unit_test(falloffs_never_touch_the_wall),
        cmocka_unit_test(shells_follow_the_planet),
        cmocka_unit_test(smooth_union_has_its_closed_form),
        cmocka_unit_test(small_details_vanish),
        cmocka_unit_test(erosion_stays_near_the_surface),
        cmocka_unit_test(light_goes_through_layers),
        cmocka_unit_test(settings_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
