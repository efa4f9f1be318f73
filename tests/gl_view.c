/* Pictures drawn by OpenGL without a window, against closed forms and against the C library. With albedo 0 and a sky of
 * constant radiance 1 a pixel is the transmittance of its ray. Runs on whatever OpenGL there is; none is a failure. */
#include "volume_sample.h"

#include "shape_gl.h"

static shape_gl_context *context;

static int open_context(void **state)
{
    (void)state;
    shape_error error;
    if (shape_gl_context_create(&context, &error)) {
        print_error("%s\n", error.text);
        return -1;
    }
    return 0;
}

static shape_light white_sky(void)
{
    shape_light light = shape_light_defaults();
    light.sky = SHAPE_SKY_CONSTANT;
    for (int i = 0; i < 3; i++)
        light.sky_radiance[i] = 1;
    return light;
}

static shape_view view_of(int width, int height, shape_dvec3 eye, shape_dvec3 target, double fov)
{
    shape_view view = shape_view_defaults();
    view.width = width, view.height = height, view.eye = eye, view.target = target, view.fov = fov;
    return view;
}

/* One renderer a method, with the scattered light solved for and without: shaders are compiled once. */
static shape_gl_renderer *renderers[SHAPE_GL_PAPER_NDT + 1][2];

static int close_context(void **state)
{
    (void)state;
    for (int method = 0; method <= SHAPE_GL_PAPER_NDT; method++)
        for (int i = 0; i < 2; i++)
            shape_gl_destroy(renderers[method][i]);
    shape_gl_context_destroy(context);
    return 0;
}

static shape_gl_renderer *find_renderer(shape_gl_method method, bool scattering)
{
    shape_error error;
    shape_gl_renderer **renderer = &renderers[method][scattering];
    shape_gl_options options = shape_gl_defaults();
    options.method = method;
    options.light.resolution = 10;
    options.light.scattering = scattering;
    if (!*renderer)
        must(shape_gl_create(&options, renderer, &error), &error);
    return *renderer;
}

/* A picture of the mean of some samples; the caller frees it. */
static float *render(const shape_set *set, shape_gl_method method, const shape_view *view,
                     const shape_light *light, bool scattering, int samples)
{
    shape_error error;
    shape_gl_renderer *renderer = find_renderer(method, scattering);
    shape_volume *volume = new_volume(set);
    must(shape_gl_load(renderer, volume, &error), &error);
    must(shape_gl_light(renderer, light, &error), &error);
    for (int i = 0; i < samples; i++)
        must(shape_gl_draw(renderer, view, i, &error), &error);
    float *rgba = malloc((size_t)view->width * (size_t)view->height * 4 * sizeof *rgba);
    assert_non_null(rgba);
    must(shape_gl_read(renderer, rgba, &error), &error);
    shape_volume_destroy(volume);
    return rgba;
}

static shape_cloud *black_cloud(shape_set *set, float extinction)
{
    shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_UNIFORM);
    cloud->medium.albedo = 0;
    cloud->medium.extinction = extinction;
    return cloud;
}

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

/* --- nothing but numbers --- */

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

/* In the background: something at once, and in the end the very picture that one gets by waiting; nothing is left of the
 * coarse one. A nearer view asks for finer voxels and gets those. */
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
        assert_memory_equal(pictures[0], pictures[1], values * sizeof(float));
    }
    for (int i = 0; i < 2; i++) {
        shape_gl_destroy(renderer[i]);
        free(pictures[i]);
    }
    shape_volume_destroy(volume);
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
        cmocka_unit_test(pictures_hold_no_nan_and_nothing_negative),
        cmocka_unit_test(white_furnace),
        cmocka_unit_test(samples_refine_one_picture),
        cmocka_unit_test(a_moving_view_is_near_the_still_one),
        cmocka_unit_test(what_is_made_meanwhile_is_the_same),
    };
    return cmocka_run_group_tests(tests, open_context, close_context);
}
