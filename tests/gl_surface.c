/* Opaque things in pictures drawn by OpenGL: rays end at them, their edges have no halo, they stand in the shadow of
 * clouds and of each other, and the whole is what shape/march.h makes of it. Where the numbers are known in closed form,
 * light is a sky of radiance 1 (a matt surface of albedo a then has radiance a) or a sun in the zenith. */
#include "gl_picture.h"
#include "shape/march.h"

enum { WIDE = 33, HIGH = 25 };
static const float grey[3] = {0.25f, 0.5f, 0.75f};

/* A rectangle across the z axis, of half sides a and b around (x, 0, z). */
static void add_rectangle(shape_opaque *opaque, double x, double a, double b, double z)
{
    shape_error error;
    shape_dvec3 points[] = {{x - a, -b, z}, {x + a, -b, z}, {x + a, b, z}, {x - a, b, z}};
    uint32_t indices[] = {0, 1, 2, 0, 2, 3};
    const shape_mesh mesh = {.points = points, .indices = indices, .point_count = 4, .triangle_count = 2};
    must(shape_opaque_add(opaque, &mesh, NULL, grey, &error), &error);
}

static void add_square(shape_opaque *opaque, double half, double z)
{
    add_rectangle(opaque, 0, half, half, z);
}

static shape_opaque *new_opaque(void)
{
    shape_error error;
    shape_opaque *opaque = shape_opaque_create(&error);
    assert_non_null(opaque);
    return opaque;
}

/* A picture with opaque things, of some samples; moving: as of a view that moves. The caller frees it. */
static float *draw_with(const shape_set *set, shape_opaque *opaque, shape_gl_method method,
                        const shape_view *view, const shape_light *light, bool moving, int samples)
{
    shape_error error;
    shape_gl_renderer *renderer;
    shape_gl_options options = shape_gl_defaults();
    options.method = method;
    options.light.resolution = 24;
    options.light.opaque = opaque;
    must(shape_opaque_finish(opaque, &error), &error);
    must(shape_gl_create(&options, &renderer, &error), &error);
    shape_volume *volume = new_volume(set);
    must(shape_gl_load(renderer, volume, &error), &error);
    must(shape_gl_light(renderer, light, &error), &error);
    for (int i = 0; i < samples; i++)
        must(moving ? shape_gl_draw_moving(renderer, view, &error) : shape_gl_draw(renderer, view, i, &error),
             &error);
    float *rgba = malloc((size_t)view->width * (size_t)view->height * 4 * sizeof *rgba);
    assert_non_null(rgba);
    must(shape_gl_read(renderer, rgba, &error), &error);
    shape_gl_destroy(renderer);
    shape_volume_destroy(volume);
    return rgba;
}

static const float *pixel_of(const float *rgba, int x, int y)
{
    return rgba + 4 * (y * WIDE + x);
}

static shape_light black_sky_sun_above(void)
{
    shape_light light = shape_light_defaults();
    light.sky = SHAPE_SKY_NONE;
    light.sun = shape_dvec3_make(0, 1, 0);
    return light;
}

/* A square through the middle of a uniform black ball of radius 2: what is seen of it has come through the ball's near
 * half. Outside the ball the square is as bright as its albedo, beside the square there is the sky. */
static void a_ray_ends_at_what_is_opaque(void **state)
{
    (void)state;
    shape_set *set = new_set();
    black_cloud(set, 0.4f);
    add_sphere(set, 0, 0, 0, 0, 2);
    shape_opaque *opaque = new_opaque();
    add_square(opaque, 3, 0);
    shape_light light = white_sky();
    memset(light.sun_irradiance, 0, sizeof light.sun_irradiance);
    shape_view view = view_of(WIDE, HIGH, shape_dvec3_make(0, 0, 12), shape_dvec3_make(0, 0, 0), 45);
    for (int method = SHAPE_GL_DEFAULT; method <= SHAPE_GL_EXACT; method++) {
        float *rgba = draw_with(set, opaque, (shape_gl_method)method, &view, &light, false, 4);
        const float *middle = pixel_of(rgba, WIDE / 2, HIGH / 2), *corner = pixel_of(rgba, 0, 0);
        const float *beside = pixel_of(rgba, WIDE / 2 + 7, HIGH / 2); /* 2.8 m from the middle */
        /* exact: steps fit the interval; default: voxels and their filter (measured 0.012). */
        const double allowed = method == SHAPE_GL_EXACT ? 1e-3 : 0.02;
        for (int c = 0; c < 3; c++) {
            assert_float_equal((double)middle[c], (double)grey[c] * exp(-0.4 * 2), allowed);
            assert_float_equal((double)beside[c], (double)grey[c], 1e-5);
            assert_float_equal((double)corner[c], 1, 1e-5);
        }
        assert_true(middle[3] == 1 && beside[3] == 1); /* it covers the sky */
        assert_float_equal((double)corner[3], 0, 1e-6);
        free(rgba);
    }
    shape_opaque_destroy(opaque);
    shape_set_destroy(set);
}

/* A square before a dense bright cloud: where it covers a pixel and all its neighbours nothing of the cloud may be mixed
 * in, also not by the filling of a view that moves. */
static void a_moving_view_has_no_halo(void **state)
{
    (void)state;
    shape_set *set = new_set();
    shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_UNIFORM);
    cloud->medium.extinction = 4;
    add_sphere(set, 0, 0, 0, 0, 3);
    shape_opaque *opaque = new_opaque();
    add_square(opaque, 1.3, 4);
    shape_light light = white_sky();
    light.sun = shape_dvec3_make(0, 0, -1); /* from behind: the square's front is lit by the sky alone */
    shape_view view = view_of(WIDE, HIGH, shape_dvec3_make(0, 0, 12), shape_dvec3_make(0, 0, 0), 45);
    float *rgba = draw_with(set, opaque, SHAPE_GL_DEFAULT, &view, &light, true, 1);
    double pixel = 8 * 2 * tan(22.5 / 180 * 3.14159265358979) / HIGH; /* metres at the square */
    int inside = 0, outside = 0;
    for (int y = 0; y < HIGH; y++)
        for (int x = 0; x < WIDE; x++) {
            double away = fmax(abs(x - WIDE / 2), abs(y - HIGH / 2)) * pixel;
            const float *p = pixel_of(rgba, x, y);
            if (away < 1.3 - 0.5 * pixel) {
                inside++;
                for (int c = 0; c < 3; c++)
                    assert_float_equal((double)p[c], (double)grey[c], 1e-5);
            } else if (away > 1.3 + 0.5 * pixel && away < 1.3 + 2.5 * pixel) {
                outside++; /* cloud, or sky of radiance 1: nothing of the square, whose red is 0.25 */
                assert_true(p[0] > 0.6f && fabsf(p[0] - p[2]) < 0.02f);
            }
        }
    assert_true(inside > 40 && outside > 40);
    free(rgba);
    shape_opaque_destroy(opaque);
    shape_set_destroy(set);
}

/* A post narrower than a pixel, where no ray of a moving view's first pass meets it, and its neighbours agree about the
 * cloud behind: it stands there all the same, and is not veiled. */
static void a_moving_view_keeps_thin_things(void **state)
{
    (void)state;
    shape_set *set = new_set();
    shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_UNIFORM);
    cloud->medium.extinction = 4;
    add_sphere(set, 0, 0, 0, 0, 3);
    shape_opaque *opaque = new_opaque();
    double pixel = 8 * 2 * tan(22.5 / 180 * 3.14159265358979) / HIGH; /* metres at the post */
    add_rectangle(opaque, pixel, 0.4 * pixel, 0.5, 4);
    shape_light light = white_sky();
    light.sun = shape_dvec3_make(0, 0, -1);
    shape_view view = view_of(WIDE, HIGH, shape_dvec3_make(0, 0, 12), shape_dvec3_make(0, 0, 0), 45);
    float *rgba = draw_with(set, opaque, SHAPE_GL_DEFAULT, &view, &light, true, 1);
    const float *post = pixel_of(rgba, WIDE / 2 + 1, HIGH / 2),
                *beside = pixel_of(rgba, WIDE / 2 + 2, HIGH / 2);
    for (int c = 0; c < 3; c++)
        assert_float_equal((double)post[c], (double)grey[c], 1e-5);
    assert_true(beside[0] > 0.6f);
    free(rgba);
    shape_opaque_destroy(opaque);
    shape_set_destroy(set);
}

/* A black ball of radius 2 and a square over the ground, the sun in the zenith, no sky: the ground's radiance is albedo
 * irradiance / pi, times exp(-sigma chord) under the ball, nothing under the square. Looked at from above, obliquely. */
static void shadows_fall_on_the_ground(void **state)
{
    (void)state;
    shape_error error;
    shape_set *set = new_set();
    black_cloud(set, 0.4f);
    add_sphere(set, 0, 0, 5, 0, 2);
    shape_opaque *opaque = new_opaque();
    const shape_frame flat = {{{1, 0, 0, 8}, {0, 0, 1, 3}, {0, -1, 0, 0}}}; /* level, at x 8, y 3 */
    shape_dvec3 points[] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    uint32_t indices[] = {0, 1, 2, 0, 2, 3};
    const shape_mesh mesh = {.points = points, .indices = indices, .point_count = 4, .triangle_count = 2};
    must(shape_opaque_add(opaque, &mesh, &flat, grey, &error), &error);
    must(shape_opaque_add_ground(opaque, 0, grey, &error), &error);
    shape_light light = black_sky_sun_above();
    const double lit = (double)grey[1] * (double)light.sun_irradiance[1] / 3.14159265358979;
    /* Each looks at one place from so low that nothing stands before it. */
    const struct {
        double x, wanted, allowed;
    } places[] = {
        {0, lit * exp(-0.4 * 4), 0.03 * lit}, /* the grid's cells average a curved ball: measured 0.016 */
        {8, 0, 1e-6},
        {4, lit, 1e-5 * lit},
        {-30, lit, 1e-5 * lit}};
    for (size_t i = 0; i < sizeof places / sizeof *places; i++)
        for (int method = SHAPE_GL_DEFAULT; method <= SHAPE_GL_EXACT; method++) {
            shape_dvec3 target = {places[i].x, 0, 0}, eye = {places[i].x, 1, 9};
            shape_view view = view_of(WIDE, HIGH, eye, target, 2);
            float *rgba = draw_with(set, opaque, (shape_gl_method)method, &view, &light, false, 1);
            double got = (double)pixel_of(rgba, WIDE / 2, HIGH / 2)[1];
            print_message("x %g, method %d: %.5f, by formula %.5f\n", places[i].x, method, got,
                          places[i].wanted);
            assert_float_equal(got, places[i].wanted, places[i].allowed);
            free(rgba);
        }
    shape_opaque_destroy(opaque);
    shape_set_destroy(set);
}

/* The same scene by shape/march.h: a cloud with a square in it, over the ground, sun and clear sky. What is left of the
 * difference is the baked density, shadow edges and the places within a pixel; the square's share alone is ten times it. */
static void it_is_what_the_march_makes(void **state)
{
    (void)state;
    shape_error error;
    shape_set *set = new_set();
    shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_UNIFORM);
    cloud->medium.extinction = 1;
    add_sphere(set, 0, 0, 4, 0, 2);
    add_sphere(set, 0, 1.5f, 3.5f, 0, 1.5f);
    shape_opaque *opaque = new_opaque();
    add_square(opaque, 3, 0.2);
    must(shape_opaque_add_ground(opaque, 0, grey, &error), &error);
    shape_light light = shape_light_defaults();
    shape_view view = view_of(WIDE, HIGH, shape_dvec3_make(3, 4, 14), shape_dvec3_make(0, 3, 0), 45);
    float *drawn = draw_with(set, opaque, SHAPE_GL_DEFAULT, &view, &light, false, 8);

    shape_march_options options = shape_march_defaults();
    options.opaque = opaque;
    options.resolution = 24;
    options.samples = 4;
    shape_marcher *marcher;
    shape_volume *volume = new_volume(set);
    float marched[3 * WIDE * HIGH];
    must(shape_marcher_create(volume, &light, view.eye, &options, &marcher, &error), &error);
    must(shape_march_render(marcher, &view, marched, NULL, &error), &error);
    double sum = 0;
    for (int i = 0; i < WIDE * HIGH; i++)
        for (int c = 0; c < 3; c++) {
            double a = (double)drawn[4 * i + c], b = (double)marched[3 * i + c];
            sum += (a - b) * (a - b) / (b * b + 0.01);
        }
    double relmse = sum / (3 * WIDE * HIGH);
    print_message("relMSE to the march: %.5f\n", relmse);
    assert_true(relmse < 0.004);
    shape_marcher_destroy(marcher);
    shape_volume_destroy(volume);
    free(drawn);
    shape_opaque_destroy(opaque);
    shape_set_destroy(set);
}

static bool is_like(const float *a, const float *b)
{
    for (int c = 0; c < 4; c++)
        if (fabsf(a[c] - b[c]) > 1e-5f * (1 + fabsf(b[c])))
            return false;
    return true;
}

/* A picture drawn in parts of 64 pixels is the whole one: clouds, sky, things and ground, of two samples. Only where the
 * edge of a triangle goes through a sample's very place may the rasteriser's rounding decide otherwise: five pixels of
 * 16,500, when all 900 along the parts' borders would be seams. */
static void parts_join_without_a_seam(void **state)
{
    (void)state;
    enum { W = 150, H = 110, SIDE = 64 };
    shape_error error;
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_SPHEROID);
    add_sphere(set, 0, 0, 4, 0, 2);
    add_sphere(set, 0, 2.5f, 3.5f, 0, 1.5f);
    shape_opaque *opaque = new_opaque();
    add_square(opaque, 2.2, 0.2);
    must(shape_opaque_add_ground(opaque, 0, grey, &error), &error);
    must(shape_opaque_finish(opaque, &error), &error);
    shape_volume *volume = new_volume(set);
    shape_light light = shape_light_defaults();
    shape_view view = view_of(W, H, shape_dvec3_make(3, 4, 14), shape_dvec3_make(0, 3, 0), 45);
    static float whole[W * H * 4], part[SIDE * SIDE * 4];
    for (int method = SHAPE_GL_DEFAULT; method <= SHAPE_GL_EXACT; method++) {
        shape_gl_renderer *renderer;
        shape_gl_options options = shape_gl_defaults();
        options.method = (shape_gl_method)method;
        options.light.resolution = 12;
        options.light.opaque = opaque;
        must(shape_gl_create(&options, &renderer, &error), &error);
        must(shape_gl_load(renderer, volume, &error), &error);
        must(shape_gl_light(renderer, &light, &error), &error);
        for (int i = 0; i < 2; i++)
            must(shape_gl_draw(renderer, &view, i, &error), &error);
        must(shape_gl_read(renderer, whole, &error), &error);
        int different = 0;
        for (int y = 0; y < H; y += SIDE)
            for (int x = 0; x < W; x += SIDE) {
                shape_gl_part p = {x, y, W - x < SIDE ? W - x : SIDE, H - y < SIDE ? H - y : SIDE};
                shape_gl_set_part(renderer, p);
                for (int i = 0; i < 2; i++)
                    must(shape_gl_draw(renderer, &view, i, &error), &error);
                must(shape_gl_read(renderer, part, &error), &error);
                for (int j = 0; j < p.width * p.height; j++)
                    different += !is_like(
                        part + 4 * j, whole + 4 * ((H - y - p.height + j / p.width) * W + x + j % p.width));
            }
        shape_gl_destroy(renderer);
        print_message("method %d: %d pixels of parts are not the whole picture's\n", method, different);
        assert_true(different <= 5);
    }
    shape_volume_destroy(volume);
    shape_opaque_destroy(opaque);
    shape_set_destroy(set);
}

/* Every pixel below the horizon's rows is ground and every one above sky, to the picture's edges, in each sample. */
static void the_ground_has_no_gaps(void **state)
{
    (void)state;
    shape_set *set = new_set();
    shape_error error;
    shape_opaque *opaque = new_opaque();
    must(shape_opaque_add_ground(opaque, 0, grey, &error), &error);
    shape_light light = white_sky();
    memset(light.sun_irradiance, 0, sizeof light.sun_irradiance);
    shape_view view = view_of(WIDE, HIGH, shape_dvec3_make(4, 6, 30), shape_dvec3_make(0, 6, 0), 45);
    for (int samples = 1; samples <= 4; samples++) {
        float *rgba = draw_with(set, opaque, SHAPE_GL_DEFAULT, &view, &light, false, samples);
        for (int y = 0; y < HIGH; y++)
            for (int x = 0; x < WIDE && abs(y - HIGH / 2) > 1; x++)
                assert_float_equal((double)pixel_of(rgba, x, y)[0], y > HIGH / 2 ? (double)grey[0] : 1, 1e-5);
        free(rgba);
    }
    shape_opaque_destroy(opaque);
    shape_set_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ray_ends_at_what_is_opaque),    cmocka_unit_test(a_moving_view_has_no_halo),
        cmocka_unit_test(a_moving_view_keeps_thin_things), cmocka_unit_test(shadows_fall_on_the_ground),
        cmocka_unit_test(it_is_what_the_march_makes),      cmocka_unit_test(parts_join_without_a_seam),
        cmocka_unit_test(the_ground_has_no_gaps)};
    return cmocka_run_group_tests(tests, open_context, close_pictures);
}
