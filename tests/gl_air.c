/* Air drawn by OpenGL: Koschmieder's closed forms, the shadow of things in it, the march's picture, parts without a seam, and
 * the same bytes as ever where there is none. */
#include "gl_picture.h"
#include "shape/air.h"
#include "shape/march.h"

enum { WIDE = 48, HIGH = 36 };
static const float grey[3] = {0.25f, 0.5f, 0.75f};
static const double visibility = 50;

static void add_rectangle(shape_opaque *opaque, const shape_dvec3 corners[4])
{
    shape_error error;
    shape_dvec3 points[4];
    uint32_t indices[] = {0, 1, 2, 0, 2, 3};
    memcpy(points, corners, sizeof points);
    const shape_mesh mesh = {.points = points, .indices = indices, .point_count = 4, .triangle_count = 2};
    must(shape_opaque_add(opaque, &mesh, NULL, grey, &error), &error);
}

/* Draws samples of a volume into rgba; a renderer's light may be set again and again. */
static void picture(shape_gl_renderer *renderer, const shape_view *view, const shape_light *light,
                    int samples, float *rgba)
{
    shape_error error;
    must(shape_gl_light(renderer, light, &error), &error);
    for (int i = 0; i < samples; i++)
        must(shape_gl_draw(renderer, view, i, &error), &error);
    must(shape_gl_read(renderer, rgba, &error), &error);
}

static shape_gl_renderer *open_renderer(int method, const shape_opaque *opaque, const shape_volume *volume)
{
    shape_error error;
    shape_gl_renderer *renderer;
    shape_gl_options options = shape_gl_defaults();
    options.method = (shape_gl_method)method;
    options.light.resolution = 24;
    options.light.opaque = opaque;
    must(shape_gl_create(&options, &renderer, &error), &error);
    must(shape_gl_load(renderer, volume, &error), &error);
    return renderer;
}

/* A wall 20 m before the eye under a roof that ends half way: the sun stands in the zenith. What the eye sees of it is
 * exp(-depth) times what it sees of it without air, and the air's light, less the sun's share under the roof. Slices are 32
 * where a shadow may be, so the roof's edge is known to a thirtieth of them or so. */
static void walls_fade_and_shadows_show(void **state)
{
    (void)state;
    static float clear[WIDE * HIGH * 4], hazy[WIDE * HIGH * 4];
    shape_error error;
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_UNIFORM);
    add_sphere(set, 0, 0, -500, 0, 1);
    shape_volume *volume = new_volume(set);
    const shape_dvec3 wall[] = {{-60, -60, 0}, {60, -60, 0}, {60, 60, 0}, {-60, 60, 0}};
    const shape_dvec3 roof[] = {{-60, 30, 10}, {60, 30, 10}, {60, 30, 40}, {-60, 30, 40}};
    const double sigma = 3.912 / visibility;
    const float mean[3] = {1, 1, 1};
    for (int roofed = 0; roofed < 2; roofed++)
        for (int method = SHAPE_GL_DEFAULT; method <= SHAPE_GL_EXACT; method++) {
            shape_opaque *opaque = shape_opaque_create(&error);
            add_rectangle(opaque, wall);
            if (roofed)
                add_rectangle(opaque, roof);
            must(shape_opaque_finish(opaque, &error), &error);
            shape_light light = white_sky();
            shape_view view = view_of(WIDE, HIGH, shape_dvec3_make(0, 0, 20), shape_dvec3_make(0, 0, 0), 20);
            double share[3];
            light.sun = shape_dvec3_make(0, 1, 0);
            shape_gl_renderer *renderer = open_renderer(method, opaque, volume);
            picture(renderer, &view, &light, 1, clear);
            light.air.visibility = visibility;
            picture(renderer, &view, &light, 4, hazy);
            shape_air_sun_share(&light, mean, 0, share);
            const float *a = clear + 4 * (HIGH / 2 * WIDE + WIDE / 2), *b = hazy + (a - clear);
            double dark = roofed ? share[0] * (1 - exp(-sigma * 10)) : 0, left = exp(-sigma * 20);
            print_message("roof %d, method %d: %.5f, by formula %.5f\n", roofed, method, (double)b[0],
                          left * (double)a[0] + 1 - left - dark);
            for (int c = 0; c < 3; c++)
                assert_float_equal((double)b[c], left * (double)a[c] + 1 - left - dark,
                                   roofed ? 0.05 * dark : 2e-4);
            shape_gl_destroy(renderer);
            shape_opaque_destroy(opaque);
        }
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* A cloud before a low sun, over the ground. */
static shape_set *cloud_set(void)
{
    shape_set *set = new_set();
    shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_UNIFORM);
    cloud->medium.extinction = 1;
    add_sphere(set, 0, 0, 4, 0, 2);
    add_sphere(set, 0, 2.5f, 3.5f, 0, 1.5f);
    return set;
}

static shape_light low_sun(double far)
{
    shape_light light = shape_light_defaults();
    light.sun = shape_sun_direction(170, 25);
    light.air.visibility = far;
    return light;
}

/* The march's picture, of rays at the same places, under a sky of one radiance (the clear one is laid out every eighth pixel,
 * too coarse for so small a picture). What is left are baked density and the light grid's cells, as without air, and shafts
 * that are laid out every eighth pixel. */
static void it_is_what_the_march_makes(void **state)
{
    (void)state;
    static float drawn[WIDE * HIGH * 4], marched[WIDE * HIGH * 3];
    shape_error error;
    shape_set *set = cloud_set();
    shape_volume *volume = new_volume(set);
    shape_opaque *opaque = shape_opaque_create(&error);
    must(shape_opaque_add_ground(opaque, 0, grey, &error), &error);
    must(shape_opaque_finish(opaque, &error), &error);
    shape_light light = low_sun(40);
    light.sky = SHAPE_SKY_CONSTANT;
    for (int c = 0; c < 3; c++)
        light.sky_radiance[c] = 0.3f + 0.2f * (float)c;
    shape_view view = view_of(WIDE, HIGH, shape_dvec3_make(3, 2, 14), shape_dvec3_make(0, 3, 0), 45);
    shape_march_options options = shape_march_defaults();
    shape_marcher *marcher;
    options.opaque = opaque;
    options.resolution = 24;
    options.samples = 8;
    must(shape_marcher_create(volume, &light, view.eye, &options, &marcher, &error), &error);
    must(shape_march_render(marcher, &view, marched, NULL, &error), &error);
    for (int method = SHAPE_GL_DEFAULT; method <= SHAPE_GL_EXACT; method++) {
        shape_gl_renderer *renderer = open_renderer(method, opaque, volume);
        double sum = 0;
        picture(renderer, &view, &light, 8, drawn);
        for (int i = 0; i < WIDE * HIGH; i++)
            for (int c = 0; c < 3; c++) {
                double a = (double)drawn[4 * i + c], b = (double)marched[3 * i + c];
                sum += (a - b) * (a - b) / (b * b + 0.01);
            }
        print_message("method %d: relMSE to the march %.5f\n", method, sum / (3 * WIDE * HIGH));
        assert_true(sum / (3 * WIDE * HIGH) < 0.001);
        shape_gl_destroy(renderer);
    }
    shape_marcher_destroy(marcher);
    shape_opaque_destroy(opaque);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* Air that was there and is gone leaves no trace; a view that moves has it, too, and stays near the one at rest. */
static void off_is_as_it_was(void **state)
{
    (void)state;
    static float first[WIDE * HIGH * 4], hazy[WIDE * HIGH * 4], again[WIDE * HIGH * 4];
    shape_error error;
    shape_set *set = cloud_set();
    shape_volume *volume = new_volume(set);
    shape_view view = view_of(WIDE, HIGH, shape_dvec3_make(3, 2, 14), shape_dvec3_make(0, 3, 0), 45);
    shape_light with = low_sun(40), without = low_sun(0);
    for (int method = SHAPE_GL_DEFAULT; method <= SHAPE_GL_EXACT; method++) {
        shape_gl_renderer *renderer = open_renderer(method, NULL, volume);
        picture(renderer, &view, &without, 2, first);
        picture(renderer, &view, &with, 2, hazy);
        picture(renderer, &view, &without, 2, again);
        assert_memory_equal(first, again, sizeof first);
        assert_true(memcmp(first, hazy, sizeof first) != 0);
        must(shape_gl_light(renderer, &with, &error), &error);
        must(shape_gl_draw_moving(renderer, &view, &error), &error);
        must(shape_gl_read(renderer, again, &error), &error);
        double apart = 0;
        for (int i = 0; i < 4 * WIDE * HIGH; i++)
            apart += fabs((double)again[i] - (double)hazy[i]) / (4 * WIDE * HIGH);
        print_message("method %d: moving, %.4f from the picture at rest\n", method, apart);
        assert_true(apart < 0.02);
        shape_gl_destroy(renderer);
    }
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* Drawn in parts of 64 pixels. Slices are laid out by each part's own columns, which are the whole's. */
static void parts_join_without_a_seam(void **state)
{
    (void)state;
    enum { W = 150, H = 110, SIDE = 64 };
    static float whole[W * H * 4], part[SIDE * SIDE * 4];
    shape_set *set = cloud_set();
    shape_volume *volume = new_volume(set);
    shape_light light = low_sun(40);
    shape_view view = view_of(W, H, shape_dvec3_make(3, 2, 14), shape_dvec3_make(0, 3, 0), 45);
    shape_gl_renderer *renderer = open_renderer(SHAPE_GL_DEFAULT, NULL, volume);
    picture(renderer, &view, &light, 2, whole);
    double most = 0;
    for (int y = 0; y < H; y += SIDE)
        for (int x = 0; x < W; x += SIDE) {
            shape_gl_part p = {x, y, W - x < SIDE ? W - x : SIDE, H - y < SIDE ? H - y : SIDE};
            shape_gl_set_part(renderer, p);
            picture(renderer, &view, &light, 2, part);
            for (int j = 0; j < p.width * p.height; j++)
                for (int c = 0; c < 4; c++)
                    most = fmax(
                        most,
                        fabs(
                            (double)part[4 * j + c] -
                            (double)whole[4 * ((H - y - p.height + j / p.width) * W + x + j % p.width) + c]));
        }
    print_message("parts are off by %.2g\n", most);
    assert_true(most < 1e-4);
    shape_gl_destroy(renderer);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(walls_fade_and_shadows_show), cmocka_unit_test(it_is_what_the_march_makes),
        cmocka_unit_test(off_is_as_it_was), cmocka_unit_test(parts_join_without_a_seam)};
    return cmocka_run_group_tests(tests, open_context, close_context);
}
