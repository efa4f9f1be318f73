/* Rays drawn by OpenGL, against closed forms and against the C library: single shapes, crowds, the field, and the methods
 * of 2018. */
#include "gl_picture.h"

/* Optical depth of a view's pixel by the C library, in its centre. */
static double depth_at(const shape_volume *volume, const shape_view *view, int x, int y, float step)
{
    shape_error error;
    shape_candidates scratch = {0};
    shape_camera camera = shape_view_camera(view);
    shape_dvec3 direction = shape_camera_direction(&camera, view, x + 0.5, y + 0.5);
    double depth;
    must(shape_volume_optical_depth(volume, view->eye, direction, 0, 1e30f, step, &scratch, &depth, &error),
         &error);
    shape_candidates_free(&scratch);
    return depth;
}

/* Every pixel of one sample of `method` against exp(-depth) of the C library, and how much of the picture is cloud.
 * What is cut off at a transmittance of 1e-4 counts as 0. */
static void compare_with_c(const shape_set *set, shape_gl_method method, shape_view view, int samples,
                           double tolerance, double least_share)
{
    shape_light light = white_sky();
    float *rgba = render(set, method, &view, &light, false, samples);
    shape_volume *volume = new_volume(set);
    int covered = 0;
    double worst = 0;
    for (int y = 0; y < view.height; y++)
        for (int x = 0; x < view.width; x++) {
            const float *pixel = rgba + 4 * (y * view.width + x);
            double truth = exp(-depth_at(volume, &view, x, y, 0.01f));
            for (int k = 0; k < 3; k++) {
                if (!(fabs((double)pixel[k] - truth) <= tolerance))
                    fail_msg("pixel %d,%d is %.7g, in truth %.7g", x, y, (double)pixel[k], truth);
                worst = fmax(worst, fabs((double)pixel[k] - truth));
            }
            assert_float_equal(pixel[3], 1 - truth, tolerance + 1e-6);
            covered += truth < 0.999;
        }
    assert_true(covered >= least_share * view.width * view.height);
    shape_volume_destroy(volume);
    free(rgba);
}

/* --- closed forms --- */

static double chord(shape_dvec3 origin, shape_dvec3 d, shape_dvec3 centre, double radius)
{
    shape_dvec3 v = shape_dvec3_sub(origin, centre);
    double b = shape_dvec3_dot(v, d), room = b * b - shape_dvec3_dot(v, v) + radius * radius;
    return room <= 0 ? 0 : fmax(sqrt(room) - b, 0) - fmax(-sqrt(room) - b, 0);
}

/* One sphere in front of the camera, around it, behind it: exp(-sigma chord) in every pixel. */
static void one_sphere_is_exp_of_sigma_times_chord(void **state)
{
    (void)state;
    shape_light light = white_sky();
    static const double eyes[][3] = {{0, 0, 8}, {0.7, -0.5, 0.9}, {0, 0, 0}, {0, 0, -8}, {1, 1, 60}};
    static const double fovs[] = {35, 60, 90, 45, 4};
    for (int i = 0; i < 5; i++) {
        shape_set *set = new_set();
        black_cloud(set, 0.6f);
        add_sphere(set, 0, 0, 0, 0, 2);
        shape_dvec3 eye = {eyes[i][0], eyes[i][1], eyes[i][2]}, target = {0, 0.1, i == 3 ? -20 : -0.1};
        shape_view view = view_of(48, 27, eye, target, fovs[i]);
        float *rgba = render(set, SHAPE_GL_EXACT, &view, &light, false, 1);
        shape_camera camera = shape_view_camera(&view);
        for (int y = 0; y < view.height; y++)
            for (int x = 0; x < view.width; x++) {
                shape_dvec3 d = shape_camera_direction(&camera, &view, x + 0.5, y + 0.5);
                double truth = exp(-0.6 * chord(eye, d, shape_dvec3_make(0, 0, 0), 2)),
                       is = (double)rgba[4 * (y * view.width + x)];
                /* A chord is known to the square root of the rim's rounding, from 60 m 4e-6 * 2 * 2 m^2. */
                if (!(fabs(is - truth) <=
                      1e-4 + (chord(eye, d, shape_dvec3_make(0, 0, 0), 2) < 0.05 ? 2e-3 : 0)))
                    fail_msg("eye %d, pixel %d,%d is %.7g, in truth %.7g", i, x, y, is, truth);
            }
        free(rgba);
        shape_set_destroy(set);
    }
}

static void a_union_counts_overlaps_once(void **state)
{
    (void)state;
    shape_set *set = new_set();
    black_cloud(set, 0.8f);
    add_sphere(set, 0, -0.7, 0, 0, 1.2);
    add_sphere(set, 0, 0.7, 0.2, 0, 1.2);
    add_sphere(set, 0, 0, 0, -4, 1); /* behind a gap */
    compare_with_c(set, SHAPE_GL_EXACT,
                   view_of(48, 27, shape_dvec3_make(0, 0, 6), shape_dvec3_make(0, 0, 0), 40), 1, 2e-4, 0.2);
    shape_set_destroy(set);
}

static void turned_ellipsoids_and_eyes_within(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(500, 0);
    shape_set *set = new_set();
    black_cloud(set, 0.5f);
    add_random(set, 0, &random, 0, 12, 1.5, 0.3, 2);
    for (int i = 0; i < 4; i++) {
        shape_vec3 eye = draw_point(&random, i % 2 ? 1 : 5);
        compare_with_c(set, SHAPE_GL_EXACT,
                       view_of(32, 18, shape_dvec3_make((double)eye.x, (double)eye.y, (double)eye.z),
                               shape_dvec3_make(0, 0, 0), 60),
                       1, 2e-4, 0.1);
    }
    shape_set_destroy(set);
}

/* Where two clouds overlap their extinctions add. A step over a border takes the value at its sample: the mean of many
 * samples is right to a step's share of the optical depth. */
static void overlapping_clouds_add(void **state)
{
    (void)state;
    shape_set *set = new_set();
    black_cloud(set, 0.5f)->field.noise_scale = 0.2f;
    black_cloud(set, 1.5f)->field.noise_scale = 0.2f;
    black_cloud(set, 0.25f)->field.noise_scale = 0.2f;
    add_sphere(set, 0, -0.5, 0, 0, 1);
    add_sphere(set, 1, 0.5, 0, 0, 1);
    add_sphere(set, 2, 0, 0, 0, 2.5);
    set->clouds[1].frame = (shape_frame){{{1, 0, 0, 0}, {0, 1.5, 0, 0.1}, {0, 0, 1, -0.3}}};
    /* One ray in the middle of each pixel only: a narrow view, so that the places within a pixel matter little. */
    compare_with_c(set, SHAPE_GL_EXACT,
                   view_of(8, 5, shape_dvec3_make(0.2, 0.1, 6), shape_dvec3_make(0, 0, 0), 4), 16, 5e-3, 0.9);
    shape_set_destroy(set);
}

/* 4 mm across, 200 km from the origin: single precision there has steps of 16 mm. */
static void small_things_far_away_keep_their_shape(void **state)
{
    (void)state;
    shape_set *set = new_set();
    shape_cloud *cloud = black_cloud(set, 400);
    cloud->field.noise_scale = 0.001f;
    cloud->frame.m[0][3] = 200000.004;
    cloud->frame.m[1][3] = 0.002;
    cloud->frame.m[2][3] = -150000.001;
    add_sphere(set, 0, 0, 0, 0, 0.002);
    add_ellipsoid(set, 0, shape_vec3_make(0.002f, 0.001f, 0), 0.0015f, 0.0004f, 0.001f,
                  shape_quat_normalize((shape_quat){0.1f, 0.3f, -0.2f, 0.9f}));
    compare_with_c(set, SHAPE_GL_EXACT,
                   view_of(32, 18, shape_dvec3_make(200000.004, 0.002, -150000.001 + 0.012),
                           shape_dvec3_make(200000.0045, 0.0023, -150000.001), 45),
                   1, 2e-4, 0.05);
    shape_set_destroy(set);
}

static void an_eye_far_away_comes_to_an_end(void **state)
{
    (void)state;
    shape_set *set = new_set();
    black_cloud(set, 1)->field.noise_scale = 0.05f;
    add_sphere(set, 0, 0, 0, 0, 1);
    /* 300 km away: steps of 6 mm could not be counted in single precision. */
    shape_view view = view_of(8, 8, shape_dvec3_make(0, 0, 3e5), shape_dvec3_make(0, 0, 0), 2e-4);
    compare_with_c(set, SHAPE_GL_EXACT, view, 1, 0.1, 0.5);
    shape_set_destroy(set);
}

/* --- ten thousand primitives on one ray --- */

static void in_a_row(int count)
{
    shape_set *set = new_set();
    black_cloud(set, 20.0f / (float)count)->field.noise_scale = 1;
    for (int i = 0; i < count; i++)
        add_sphere(set, 0, 0.1 * sin(i), 0.1 * cos(i), -0.6 * i, 0.25);
    compare_with_c(set, SHAPE_GL_EXACT,
                   view_of(4, 3, shape_dvec3_make(0, 0, 5), shape_dvec3_make(0, 0, 0), 0.001), 1, 1e-3, 1);
    shape_set_destroy(set);
}

static void five_hundred_in_a_row(void **state)
{
    (void)state;
    in_a_row(500);
}

static void ten_thousand_in_a_row(void **state)
{
    (void)state;
    in_a_row(10000);
}

static void at_one_place(int count)
{
    shape_set *set = new_set();
    black_cloud(set, 0.7f);
    for (int i = 0; i < count; i++)
        add_sphere(set, 0, 0, 0, 0, 1 + 1.0 * i / count);
    compare_with_c(set, SHAPE_GL_EXACT,
                   view_of(4, 3, shape_dvec3_make(0, 0, 6), shape_dvec3_make(0, 0, 0), 20), 1, 1e-3, 1);
    shape_set_destroy(set);
}

static void three_hundred_at_one_place(void **state)
{
    (void)state;
    at_one_place(300);
}

static void ten_thousand_at_one_place(void **state)
{
    (void)state;
    at_one_place(10000);
}

/* Two crowds, of two clouds, that overlap anyhow: more than any list in a shader holds. */
static void crowds_of_two_clouds(void **state)
{
    (void)state;
    shape_set *set = new_set();
    shape_random random = shape_random_seed(501, 0);
    black_cloud(set, 0.4f)->field.noise_scale = 0.1f;
    black_cloud(set, 0.2f)->field.noise_scale = 0.1f;
    for (int i = 0; i < 200; i++) {
        shape_vec3 p = draw_point(&random, 0.5);
        add_sphere(set, (size_t)i % 2, (double)p.x, (double)p.y, (double)p.z,
                   (double)draw(&random, 0.6, 1.4));
    }
    compare_with_c(set, SHAPE_GL_EXACT,
                   view_of(4, 3, shape_dvec3_make(0, 0, 6), shape_dvec3_make(0, 0, 0), 4), 8, 5e-3, 1);
    shape_set_destroy(set);
}

/* --- the same picture from both fields --- */

/* The march of shaders/view/march.frag for a `spheroid`, in C: steps of an eighth of a noise cell or half a pixel,
 * one density anywhere in each. */
static double march_in_c(const shape_volume_cloud *cloud, const shape_view *view, shape_dvec3 direction,
                         double random, shape_candidates *scratch)
{
    shape_error error;
    shape_ray ray = shape_volume_ray(cloud, view->eye, direction);
    must(shape_cloud_candidates(cloud, ray, 0, 1e30f, scratch, &error), &error);
    double pixel = 2 * tan(view->fov * 3.14159265358979 / 360) / view->height, tau = 0;
    size_t first, next = 0;
    float t0, t1;
    while (shape_candidates_join(scratch, 0, 1e30f, &first, &next, &t0, &t1))
        for (double t = (double)t0; t < (double)t1;) {
            double width =
                fmin(fmax(0.125 / (double)cloud->inverse_noise_scale, 0.5 * pixel * t), (double)t1 - t);
            float s = (float)(t + width * random);
            shape_vec3 p = shape_vec3_add(ray.origin, shape_vec3_scale(ray.direction, s));
            tau += width *
                   (double)shape_cloud_density_at(cloud, p, shape_candidates_u2(scratch, first, next, 1, s));
            t += width;
        }
    return exp(-tau * (double)cloud->medium.extinction);
}

static void c_field_and_glsl_field_give_one_picture(void **state)
{
    (void)state;
    enum { W = 64, H = 36, SAMPLES = 32 };
    shape_random random = shape_random_seed(502, 0);
    shape_set *set = new_set();
    shape_cloud *cloud = black_cloud(set, 3);
    cloud->field.model = SHAPE_MODEL_SPHEROID;
    cloud->field.noise_scale = 0.3f;
    add_random(set, 0, &random, 20, 6, 1.5, 0.5, 1.2);
    shape_view view = view_of(W, H, shape_dvec3_make(1, 0.5, 8), shape_dvec3_make(0, 0, 0), 40);
    shape_light light = white_sky();
    float *rgba = render(set, SHAPE_GL_EXACT, &view, &light, false, SAMPLES);
    shape_volume *volume = new_volume(set);
    shape_camera camera = shape_view_camera(&view);
    shape_candidates scratch = {0};
    double squares = 0, bias = 0, cover = 0, worst = 0;
    for (int i = 0; i < W * H; i++) {
        double sum = 0;
        for (int k = 0; k < SAMPLES; k++) {
            double x = i % W + fmod(0.5 + 0.7548776662466927 * k, 1),
                   y = i / W + 1 - fmod(0.5 + 0.5698402909980532 * k, 1);
            sum += march_in_c(&volume->clouds[0], &view, shape_camera_direction(&camera, &view, x, y),
                              shape_random_unit(&random), &scratch);
        }
        double difference = (double)rgba[4 * i] - sum / SAMPLES;
        squares += difference * difference;
        bias += difference;
        cover += 1 - sum / SAMPLES;
        worst = fmax(worst, fabs(difference));
    }
    print_message("rms %.5f, mean %.6f, worst %.4f, mean cover %.3f\n", sqrt(squares / (W * H)),
                  bias / (W * H), worst, cover / (W * H));
    assert_true(cover / (W * H) > 0.1);
    /* Both estimate one number by 32 random starts of some 40 steps of 0.04 m: a pixel differs by below a per cent. */
    assert_true(sqrt(squares / (W * H)) < 0.01);
    assert_true(fabs(bias / (W * H)) < 5e-4);
    shape_candidates_free(&scratch);
    free(rgba);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* --- the methods of 2018 --- */

static void paper_methods_agree_where_nothing_overlaps(void **state)
{
    (void)state;
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_SPHEROID)->field.noise_scale = 0.5f;
    add_sphere(set, 0, 0, 0, 0, 2);
    shape_view view = view_of(48, 27, shape_dvec3_make(0, 0, 7), shape_dvec3_make(0, 0, 0), 40);
    shape_light light = shape_light_defaults();
    float *one = render(set, SHAPE_GL_PAPER, &view, &light, true, 1);
    float *two = render(set, SHAPE_GL_PAPER_NDT, &view, &light, true, 1);
    double cover = 0;
    for (int i = 0; i < 48 * 27 * 4; i++) {
        assert_float_equal(one[i], two[i], 1e-6);
        cover += i % 4 == 3 ? (double)one[i] / (48 * 27) : 0;
    }
    assert_true(cover > 0.1);
    free(one);
    free(two);
    add_sphere(set, 0, 1, 0, 1, 2); /* overlapping, they part: one marches twice */
    one = render(set, SHAPE_GL_PAPER, &view, &light, true, 1);
    two = render(set, SHAPE_GL_PAPER_NDT, &view, &light, true, 1);
    double denser = 0;
    for (int i = 3; i < 48 * 27 * 4; i += 4)
        denser += (double)one[i] - (double)two[i];
    assert_true(denser > 1);
    free(one);
    free(two);
    shape_set_destroy(set);
}

/* A black uniform sphere in the paper's method: whole steps of 0.1 m, the last one overhanging. */
static void paper_method_is_beers_law_in_whole_steps(void **state)
{
    (void)state;
    shape_set *set = new_set();
    black_cloud(set, 0.6f);
    add_sphere(set, 0, 0, 0, 0, 2);
    shape_light light = white_sky();
    shape_view view = view_of(32, 18, shape_dvec3_make(0, 0, 8), shape_dvec3_make(0, 0, 0), 35);
    float *rgba = render(set, SHAPE_GL_PAPER, &view, &light, false, 1);
    shape_camera camera = shape_view_camera(&view);
    for (int i = 0; i < 32 * 18; i++) {
        shape_dvec3 d = shape_camera_direction(&camera, &view, i % 32 + 0.5, i / 32 + 0.5);
        double length = chord(view.eye, d, shape_dvec3_make(0, 0, 0), 2), is = (double)rgba[4 * i];
        assert_true(is <= exp(-0.6 * length) + 1e-4);
        assert_true(is >= exp(-0.6 * (length > 0 ? length + 0.1001 : 1e-3)) - 1e-4);
    }
    free(rgba);
    shape_set_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_sphere_is_exp_of_sigma_times_chord),
        cmocka_unit_test(a_union_counts_overlaps_once),
        cmocka_unit_test(turned_ellipsoids_and_eyes_within),
        cmocka_unit_test(overlapping_clouds_add),
        cmocka_unit_test(small_things_far_away_keep_their_shape),
        cmocka_unit_test(an_eye_far_away_comes_to_an_end),
        cmocka_unit_test(five_hundred_in_a_row),
        cmocka_unit_test(ten_thousand_in_a_row),
        cmocka_unit_test(three_hundred_at_one_place),
        cmocka_unit_test(ten_thousand_at_one_place),
        cmocka_unit_test(crowds_of_two_clouds),
        cmocka_unit_test(c_field_and_glsl_field_give_one_picture),
        cmocka_unit_test(paper_methods_agree_where_nothing_overlaps),
        cmocka_unit_test(paper_method_is_beers_law_in_whole_steps),
    };
    return cmocka_run_group_tests(tests, open_context, close_pictures);
}
