/* Pictures drawn by OpenGL as a whole: numbers only, energy kept, samples that refine, a view that moves, and what is
 * made in the background. */
#include "gl_picture.h"

static shape_set *any_set(shape_random *random, int i)
{
    shape_set *set = new_set();
    for (int k = 0; k <= i % 3; k++) {
        shape_cloud *cloud = new_cloud(set, (shape_model)((i + k) % 3));
        cloud->field.noise_scale = draw_size(random, 0.2, 2);
        cloud->field.kappa = draw(random, 0, 1);
        cloud->medium.extinction = draw_size(random, 0.01, 1000);
        cloud->medium.albedo = i % 4 ? draw(random, 0, 1) : 1;
        cloud->medium.phase = (shape_phase_kind)((i + k) % 5);
        cloud->medium.g = draw(random, -0.99, 0.99);
        if (k < 2)
            add_random(set, (size_t)k, random, (size_t)i % 7, (size_t)i % 4, 2, 0.05, 2);
    }
    return set;
}

static void pictures_hold_no_nan_and_nothing_negative(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(503, 0);
    for (int i = 0; i < 10; i++) {
        shape_set *set = any_set(&random, i);
        shape_vec3 e = draw_point(&random, i % 2 ? 2 : 8);
        shape_view view = view_of(10, 6, shape_dvec3_make((double)e.x, (double)e.y, (double)e.z),
                                  shape_dvec3_make(0, 0, 0), draw(&random, 5, 120));
        if (i % 5 == 0)
            view.eye = shape_dvec3_make(0, i % 2 ? 4 : -4, 0); /* straight down, straight up */
        shape_light light = shape_light_defaults();
        light.sky = (shape_sky_kind)(i % 3);
        light.sky_radiance[0] = 0.5f;
        light.sun = shape_sun_direction(draw(&random, 0, 360), draw(&random, -90, 90));
        for (int method = SHAPE_GL_DEFAULT; method <= SHAPE_GL_PAPER_NDT; method++) {
            float *rgba = render(set, (shape_gl_method)method, &view, &light, true, 2);
            for (int k = 0; k < 10 * 6 * 4; k++)
                if (!(rgba[k] >= 0 && rgba[k] < 1e6f) || (k % 4 == 3 && rgba[k] > 1))
                    fail_msg("view %d, method %d, value %d: %g", i, method, k, (double)rgba[k]);
            free(rgba);
        }
        shape_set_destroy(set);
    }
}

/* Albedo 1 under a constant sky, no sun: no brighter than the sky anywhere, and no darker than what the light grid's
 * coarseness costs (measured: a few per cent). */
static void white_furnace(void **state)
{
    (void)state;
    shape_set *set = new_set();
    shape_cloud *cloud = black_cloud(set, 1);
    cloud->medium.albedo = 1;
    cloud->medium.phase = SHAPE_PHASE_ISOTROPIC;
    add_sphere(set, 0, 0, 0, 0, 2);
    shape_light light = white_sky();
    for (int i = 0; i < 3; i++)
        light.sun_irradiance[i] = 0;
    shape_view view = view_of(32, 18, shape_dvec3_make(0, 0, 8), shape_dvec3_make(0, 0, 0), 40);
    for (int method = SHAPE_GL_DEFAULT; method <= SHAPE_GL_EXACT; method++) {
        float *rgba = render(set, (shape_gl_method)method, &view, &light, true, 1);
        double least = 9, most = 0;
        for (int i = 0; i < 32 * 18 * 4; i += 4) {
            least = fmin(least, (double)rgba[i]);
            most = fmax(most, (double)rgba[i]);
        }
        print_message("furnace, method %d: %.4f to %.4f\n", method, least, most);
        assert_true(least > 0.99 && most < 1.01);
        free(rgba);
    }
    shape_set_destroy(set);
}

static void samples_refine_one_picture(void **state)
{
    (void)state;
    shape_set *set = new_set();
    shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_SPHEROID);
    cloud->field.noise_scale = 0.4f;
    add_sphere(set, 0, 0, 0, 0, 2);
    shape_view view = view_of(24, 16, shape_dvec3_make(0, 0, 8), shape_dvec3_make(0, 0, 0), 40);
    shape_light light = shape_light_defaults();
    float *truth = render(set, SHAPE_GL_EXACT, &view, &light, true, 64);
    double error[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++) {
        float *rgba = render(set, SHAPE_GL_EXACT, &view, &light, true, 1 << (2 * k));
        for (int i = 0; i < 24 * 16 * 4; i++)
            error[k] += pow((double)rgba[i] - (double)truth[i], 2);
        free(rgba);
    }
    print_message("squared error of 1, 4, 16 samples: %.4g %.4g %.4g\n", error[0], error[1], error[2]);
    assert_true(error[1] < error[0] && error[2] < 0.3 * error[0]);
    free(truth);
    shape_set_destroy(set);
}

/* A moving view is drawn at every second pixel and filled in: near the picture of the view at rest, at sizes that do not
 * divide, with one cloud in a tile and with several, and again after a still picture. */
static void a_moving_view_is_near_the_still_one(void **state)
{
    (void)state;
    shape_set *set = new_set();
    for (int i = 0; i < 3; i++) {
        shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_SPHEROID);
        cloud->field.noise_scale = 0.4f;
        cloud->medium.extinction = 4;
        cloud->frame.m[0][3] = 1.5 * i - 2;
        cloud->frame.m[2][3] = 0.5 * i;
        add_sphere(set, (size_t)i, 0, 0, 0, 1.2);
    }
    shape_view view = view_of(133, 75, shape_dvec3_make(0, 0.5, 8), shape_dvec3_make(0, 0, 0), 40);
    shape_light light = shape_light_defaults();
    float *still = render(set, SHAPE_GL_DEFAULT, &view, &light, true, 16);
    shape_gl_renderer *renderer = find_renderer(SHAPE_GL_DEFAULT, true);
    shape_volume *volume = new_volume(set);
    shape_error error;
    must(shape_gl_load(renderer, volume, &error), &error);
    must(shape_gl_light(renderer, &light, &error), &error);
    size_t values = 133 * 75 * 4;
    float *moving = malloc(values * sizeof *moving);
    assert_non_null(moving);
    double before = 0;
    for (int round = 0; round < 2; round++) {
        must(shape_gl_draw_moving(renderer, &view, &error), &error);
        must(shape_gl_read(renderer, moving, &error), &error);
        double sum = 0, worst = 0;
        for (size_t i = 0; i < values; i++) {
            double difference = (double)moving[i] - (double)still[i];
            sum += difference * difference;
            worst = fmax(worst, fabs(difference));
        }
        sum = sqrt(sum / (double)values);
        print_message("moving against still: rms %.4f, most %.4f\n", sum, worst);
        /* A tenth is what neighbours may differ by, and one sample has noise that the mean of sixteen has not. */
        assert_true(sum < 0.01 && worst < 0.3 && sum > 0);
        assert_true(round == 0 || sum == before);
        before = sum;
        must(shape_gl_draw(renderer, &view, 0, &error), &error);
    }
    shape_volume_destroy(volume);
    free(moving);
    free(still);
    shape_set_destroy(set);
}

/* In the background: something at once, and in the end the picture that one gets by waiting, to rounding; nothing is left of
 * the coarse one. A nearer view asks for finer voxels and gets those. */
static void what_is_made_meanwhile_is_the_same(void **state)
{
    (void)state;
    shape_set *set = new_set();
    shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_SPHEROID);
    cloud->field.noise_scale = 1.2f;
    for (int i = 0; i < 5; i++)
        add_sphere(set, 0, 1.5 * i - 3, 0.3 * i, 0, 2);
    shape_light light = shape_light_defaults();
    shape_view view = view_of(96, 54, shape_dvec3_make(0, 0.5, 40), shape_dvec3_make(0, 0, 0), 30);
    shape_gl_options options = shape_gl_defaults();
    options.light.resolution = 24;
    options.background = true;
    options.bake_voxels = 3000000;
    shape_error error;
    shape_gl_renderer *renderer[2];
    for (int i = 0; i < 2; i++) {
        options.background = i == 0;
        must(shape_gl_create(&options, &renderer[i], &error), &error);
    }
    shape_volume *volume = new_volume(set);
    size_t values = 96 * 54 * 4;
    float *pictures[2] = {malloc(values * sizeof(float)), malloc(values * sizeof(float))};
    assert_true(pictures[0] && pictures[1]);
    for (int round = 0; round < 2; round++, view.eye.z = 12) {
        for (int i = 0; i < 2; i++) {
            if (round == 0) {
                must(shape_gl_load(renderer[i], volume, &error), &error);
                must(shape_gl_light(renderer[i], &light, &error), &error);
            }
            int frames = 0;
            do {
                must(shape_gl_draw_moving(renderer[i], &view, &error), &error);
                shape_gl_finish();
                assert_true(frames++ < 100000);
            } while (shape_gl_pending(renderer[i]));
            assert_int_equal(shape_gl_refined(renderer[i]), i == 0);
            assert_true(i == 1 || frames > 1);
            must(shape_gl_draw(renderer[i], &view, 0, &error), &error);
            must(shape_gl_read(renderer[i], pictures[i], &error), &error);
        }
        /* The textures of voxels have other sizes, so places in them are rounded otherwise, and bytes are filtered with 8
         * bits of a voxel's width: now and then one weight of a ray's is another 256th. (0.02: another picture.) */
        size_t other = 0;
        for (size_t k = 0; k < values; k++) {
            assert_float_equal(pictures[0][k], pictures[1][k], 1e-3);
            other += pictures[0][k] != pictures[1][k];
        }
        print_message("made meanwhile: %zu of %zu values are others\n", other, values);
        assert_true(other < values / 100);
    }
    for (int i = 0; i < 2; i++) {
        shape_gl_destroy(renderer[i]);
        free(pictures[i]);
    }
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

static void draw_until_done(shape_gl_renderer *renderer, const shape_view *view)
{
    shape_error error;
    int frames = 0;
    do {
        must(shape_gl_draw_moving(renderer, view, &error), &error);
        shape_gl_finish();
        assert_true(frames++ < 100000);
    } while (shape_gl_pending(renderer));
}

/* Twenty clouds before the eye and twenty behind it: those behind are neither lit nor baked until the view turns to them,
 * and then the others are kept. A sun that moves makes new light and bakes nothing. Waiting or in the background. */
static void only_what_changes_is_made_again(void **state)
{
    (void)state;
    shape_error error;
    shape_set *set = new_set();
    for (int i = 0; i < 40; i++) {
        shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_SPHEROID);
        cloud->frame.m[0][3] = 2 * (i % 5) - 4;
        cloud->frame.m[1][3] = 2 * (i / 5 % 4) - 3;
        cloud->frame.m[2][3] = i < 20 ? -40 : 40;
        add_sphere(set, (size_t)i, 0, 0, 0, 0.8);
    }
    shape_volume *volume = new_volume(set);
    shape_light light = shape_light_defaults();
    for (int background = 0; background < 2; background++) {
        shape_gl_options options = shape_gl_defaults();
        options.light.resolution = 12;
        options.background = background;
        shape_gl_renderer *renderer;
        must(shape_gl_create(&options, &renderer, &error), &error);
        must(shape_gl_load(renderer, volume, &error), &error);
        must(shape_gl_light(renderer, &light, &error), &error);
        shape_view view = view_of(64, 36, shape_dvec3_make(0, 0, 0), shape_dvec3_make(0, 0, -40), 30);
        draw_until_done(renderer, &view);
        shape_gl_costs first = shape_gl_get_costs(renderer);
        /* In the background there is a first light, and a finer one; voxels may be fine enough at once. */
        assert_int_equal(first.lit_clouds, background ? 40 : 20);
        assert_true(first.baked_clouds == 20 || (background && first.baked_clouds == 40));

        light.sun = shape_sun_direction(120, 30 + background);
        must(shape_gl_light(renderer, &light, &error), &error);
        draw_until_done(renderer, &view);
        shape_gl_costs turned = shape_gl_get_costs(renderer);
        assert_int_equal(turned.lit_clouds, 2 * first.lit_clouds);
        assert_int_equal(turned.baked_clouds, first.baked_clouds);

        view.target = shape_dvec3_make(0, 0, 40);
        draw_until_done(renderer, &view);
        shape_gl_costs behind = shape_gl_get_costs(renderer);
        assert_int_equal(behind.lit_clouds, 3 * first.lit_clouds);
        assert_int_equal(behind.baked_clouds, 2 * first.baked_clouds);

        view.target = shape_dvec3_make(0, 0, -40);
        draw_until_done(renderer, &view);
        shape_gl_costs back = shape_gl_get_costs(renderer);
        if (background) { /* what was made before is still there */
            assert_int_equal(back.lit_clouds, behind.lit_clouds);
            assert_int_equal(back.baked_clouds, behind.baked_clouds);
        }
        shape_gl_destroy(renderer);
    }
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* Ten clouds before the eye, and 990 behind it and beside it, out of its sight and not between it and the sun: what is made,
 * sent and marched is what the ten alone take, and the picture is the same, in the first frame and after refinement. */
static void clouds_out_of_sight_cost_nothing(void **state)
{
    (void)state;
    enum { TEN = 10, THOUSAND = 1000, VALUES = 64 * 36 * 4 };
    shape_error error;
    shape_gl_costs costs[2][2];
    float *pictures[2] = {malloc(VALUES * sizeof(float)), malloc(VALUES * sizeof(float))};
    assert_true(pictures[0] && pictures[1]);
    for (int k = 0; k < 2; k++) {
        shape_set *set = new_set();
        for (int i = 0; i < (k ? THOUSAND : TEN); i++) {
            shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_SPHEROID);
            cloud->frame.m[0][3] = i < TEN ? 3 * (i % 5) - 6 : 3 * (i % 50) - 75;
            cloud->frame.m[1][3] = i < TEN ? 2 * (i / 5) - 1 : 0;
            cloud->frame.m[2][3] = i < TEN ? -40 : 20 + 3 * (i / 50);
            add_sphere(set, (size_t)i, 0, 0, 0, 1.2);
            add_sphere(set, (size_t)i, 0.5, 0.8, 0, 0.7);
        }
        shape_volume *volume = new_volume(set);
        shape_light light = shape_light_defaults();
        light.sun = shape_sun_direction(90, 40);
        shape_gl_options options = shape_gl_defaults();
        options.light.resolution = 16;
        options.background = true;
        shape_gl_renderer *renderer;
        must(shape_gl_create(&options, &renderer, &error), &error);
        must(shape_gl_load(renderer, volume, &error), &error);
        must(shape_gl_light(renderer, &light, &error), &error);
        shape_view view = view_of(64, 36, shape_dvec3_make(0, 0, 0), shape_dvec3_make(0, 0, -40), 30);
        must(shape_gl_draw_moving(renderer, &view, &error), &error);
        costs[k][0] = shape_gl_get_costs(renderer);
        draw_until_done(renderer, &view);
        must(shape_gl_draw(renderer, &view, 0, &error), &error);
        must(shape_gl_read(renderer, pictures[k], &error), &error);
        costs[k][1] = shape_gl_get_costs(renderer);
        shape_gl_destroy(renderer);
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
    assert_int_equal(costs[0][0].light_bytes, costs[1][0].light_bytes);
    assert_int_equal(costs[0][0].lit_clouds, TEN);
    for (int when = 0; when < 2; when++) {
        assert_int_equal(costs[0][when].lit_clouds, costs[1][when].lit_clouds);
        assert_int_equal(costs[0][when].baked_clouds, costs[1][when].baked_clouds);
        assert_int_equal(costs[0][when].baked_bytes, costs[1][when].baked_bytes);
    }
    assert_true(costs[0][1].baked_bytes > 0 && costs[0][1].steps_per_pixel > 0);
    assert_float_equal(costs[0][1].steps_per_pixel, costs[1][1].steps_per_pixel, 0);
    assert_float_equal(costs[0][1].fetches_per_pixel, costs[1][1].fetches_per_pixel, 0);
    assert_memory_equal(pictures[0], pictures[1], VALUES * sizeof(float));
    free(pictures[0]);
    free(pictures[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_hold_no_nan_and_nothing_negative),
        cmocka_unit_test(white_furnace),
        cmocka_unit_test(samples_refine_one_picture),
        cmocka_unit_test(a_moving_view_is_near_the_still_one),
        cmocka_unit_test(what_is_made_meanwhile_is_the_same),
        cmocka_unit_test(only_what_changes_is_made_again),
        cmocka_unit_test(clouds_out_of_sight_cost_nothing),
    };
    return cmocka_run_group_tests(tests, open_context, close_pictures);
}
