/* By what OpenGL lights a point: each law of depth against the march's picture with the same law, ambient light and emission
 * against their closed form, what surfaces get of the sky, and that nothing of it stays when it is off again. */
#include "gl_picture.h"
#include "shape/march.h"

enum { WIDE = 96, HIGH = 72, VALUES = WIDE * HIGH * 4 };

static const shape_gl_lighting usual = {.powder = 2, .octaves = 8};

/* One cloud, or two with other media whose boxes overlap in part, so that pixels with one and with several are there. */
static shape_set *clouds(int count)
{
    shape_set *set = new_set();
    for (int i = 0; i < count; i++) {
        shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_UNIFORM);
        cloud->field.noise_scale = 0.2f; /* which steps go by */
        cloud->medium.extinction = i ? 3 : 2;
        cloud->medium.albedo = i ? 0.9f : 1;
        cloud->medium.phase = i ? SHAPE_PHASE_TWO_LOBE : SHAPE_PHASE_HG;
        cloud->medium.g = 0.6f;
        cloud->medium.g2 = -0.4f;
        cloud->medium.lobe_mix = 0.4f;
        add_sphere(set, (size_t)i, i ? 2.2 : -1, i ? 0.6 : 0, 0, i ? 1.5 : 2);
    }
    return set;
}

static shape_view front_view(void)
{
    return view_of(WIDE, HIGH, shape_dvec3_make(3, 2, 12), shape_dvec3_make(0.5, 0, 0), 40);
}

static shape_light side_sun(void)
{
    shape_light light = shape_light_defaults();
    light.sun = shape_sun_direction(90, 40);
    light.sky = SHAPE_SKY_CONSTANT;
    for (int c = 0; c < 3; c++)
        light.sky_radiance[c] = 0.3f + 0.2f * (float)c;
    return light;
}

static shape_gl_renderer *open_renderer(int method, const shape_gl_lighting *lighting,
                                        const shape_opaque *opaque, const shape_volume *volume)
{
    shape_error error;
    shape_gl_renderer *renderer;
    shape_gl_options options = shape_gl_defaults();
    options.method = (shape_gl_method)method;
    options.lighting = *lighting;
    options.light.resolution = 48;
    options.light.opaque = opaque;
    must(shape_gl_create(&options, &renderer, &error), &error);
    must(shape_gl_load(renderer, volume, &error), &error);
    return renderer;
}

static void picture(shape_gl_renderer *renderer, const shape_light *light, int samples, float *rgba)
{
    shape_error error;
    shape_view view = front_view();
    must(shape_gl_light(renderer, light, &error), &error);
    for (int i = 0; i < samples; i++)
        must(shape_gl_draw(renderer, &view, i, &error), &error);
    must(shape_gl_read(renderer, rgba, &error), &error);
}

static void march(const shape_volume *volume, const shape_light *light, const shape_march_options *options,
                  float *rgb)
{
    shape_error error;
    shape_marcher *marcher;
    shape_view view = front_view();
    must(shape_marcher_create(volume, light, view.eye, options, &marcher, &error), &error);
    must(shape_march_render(marcher, &view, rgb, NULL, &error), &error);
    shape_marcher_destroy(marcher);
}

/* The relMSE of shape/imageerror.h over the pixels that are cloud: at the rims density decides, not light. */
static double relative_error(const float *rgba, const float *rgb)
{
    double sum = 0, count = 0;
    for (int i = 0; i < WIDE * HIGH; i++)
        for (int c = 0; c < 3 && rgba[4 * i + 3] > 0.9f; c++, count++) {
            double a = (double)rgba[4 * i + c], b = (double)rgb[3 * i + c];
            sum += (a - b) * (a - b) / (b * b + 0.01);
        }
    assert_true(count > 0.1 * 3 * WIDE * HIGH);
    return sum / count;
}

typedef struct law_case {
    shape_gl_law law;
    shape_march_light light;
    double powder;
    int octaves;
} law_case;

/* The march's depths are its own steps'; the viewer's are interpolated between cells, one to a pixel and a half, and the baked
 * density blurs rims by a voxel. A law whose term is dropped is another law of the list. */
static void check_laws(int method, const shape_set *set, const law_case *all, int count)
{
    enum { MOST = 6 };
    static float drawn[VALUES], marched[MOST][WIDE * HIGH * 3];
    shape_error error;
    shape_volume *volume = new_volume(set);
    shape_light light = side_sun();
    shape_gl_renderer *renderer = open_renderer(method, &usual, NULL, volume);
    for (int i = 0; i < count; i++) {
        shape_march_options options = shape_march_defaults();
        options.light = all[i].light;
        options.powder = all[i].powder;
        options.octaves = all[i].octaves;
        march(volume, &light, &options, marched[i]);
    }
    for (int i = 0; i < count; i++) {
        shape_gl_lighting lighting = usual;
        lighting.law = all[i].law;
        lighting.powder = (float)all[i].powder;
        lighting.octaves = all[i].octaves;
        must(shape_gl_set_lighting(renderer, &lighting, &error), &error);
        picture(renderer, &light, 3, drawn);
        double own = relative_error(drawn, marched[i]), next = 1;
        for (int k = 0; k < count; k++)
            next = k == i ? next : fmin(next, relative_error(drawn, marched[k]));
        print_message("method %d, law %d, powder %.1f, octaves %d: relMSE %.5f; of the next law %.5f\n",
                      method, (int)all[i].law, all[i].powder, all[i].octaves, own, next);
        assert_true(own < 0.0025);
        assert_true(next > 3 * own);
    }
    shape_gl_destroy(renderer);
    shape_volume_destroy(volume);
}

/* Compiling a law for Mesa's llvmpipe takes a second or two, so each method has those that matter, and each law a method. */
static void laws_of_the_preview_are_the_marchs(void **state)
{
    (void)state;
    static const law_case all[] = {{SHAPE_GL_LAW_SINGLE, SHAPE_MARCH_SINGLE, 2, 8},
                                   {SHAPE_GL_LAW_POWDER, SHAPE_MARCH_POWDER, 2, 8},
                                   {SHAPE_GL_LAW_POWDER, SHAPE_MARCH_POWDER, 0.5, 8},
                                   {SHAPE_GL_LAW_OCTAVES, SHAPE_MARCH_OCTAVES, 2, 8},
                                   {SHAPE_GL_LAW_OCTAVES, SHAPE_MARCH_OCTAVES, 2, 2}};
    shape_set *set = clouds(2);
    check_laws(SHAPE_GL_DEFAULT, set, all, sizeof all / sizeof *all);
    shape_set_destroy(set);
}

static void laws_of_the_exact_view_are_the_marchs(void **state)
{
    (void)state;
    static const law_case all[] = {{SHAPE_GL_LAW_POWDER, SHAPE_MARCH_POWDER, 2, 8},
                                   {SHAPE_GL_LAW_POWDER_ANGLE, SHAPE_MARCH_POWDER_ANGLE, 2, 8},
                                   {SHAPE_GL_LAW_BEER_MAX, SHAPE_MARCH_BEER_MAX, 2, 8},
                                   {SHAPE_GL_LAW_OCTAVES, SHAPE_MARCH_OCTAVES, 2, 8}};
    shape_set *set = clouds(1);
    check_laws(SHAPE_GL_EXACT, set, all, sizeof all / sizeof *all);
    shape_set_destroy(set);
}

/* Lit by nothing but what is the same at every point: the source function is a constant J, so a pixel is J times how much of
 * it the cloud covers, in each method, with the grid's light and with a law, at rest and moving. */
static void ambient_light_and_emission_are_constants(void **state)
{
    (void)state;
    static float drawn[VALUES];
    shape_error error;
    shape_set *set = clouds(1);
    shape_volume *volume = new_volume(set);
    shape_light dark = shape_light_defaults();
    shape_view view = front_view();
    const shape_medium *medium = &volume->clouds[0].medium;
    dark.sky = SHAPE_SKY_NONE;
    memset(dark.sun_irradiance, 0, sizeof dark.sun_irradiance);
    for (int method = SHAPE_GL_DEFAULT; method <= SHAPE_GL_EXACT; method++) {
        shape_gl_renderer *renderer = open_renderer(method, &usual, NULL, volume);
        for (int i = 0; i < 4; i++) {
            shape_gl_lighting lighting = usual;
            const float colour[3] = {0.2f, 0.5f, 0.9f};
            bool emits = i % 2;
            lighting.law = i / 2 ? SHAPE_GL_LAW_POWDER : SHAPE_GL_LAW_GRID;
            memcpy(emits ? lighting.emission : lighting.ambient, colour, sizeof colour);
            must(shape_gl_set_lighting(renderer, &lighting, &error), &error);
            picture(renderer, &dark, 1, drawn);
            if (i % 3 == 0)
                must(shape_gl_draw_moving(renderer, &view, &error), &error);
            if (i % 3 == 0)
                must(shape_gl_read(renderer, drawn, &error), &error);
            /* By the grid a ray is left with a little less of the extinction, up to the square of four cells over the way. */
            double tolerance = lighting.law == SHAPE_GL_LAW_GRID ? 1e-3 : 1e-4;
            double factor = emits ? 1 / (double)medium->extinction : (double)medium->albedo, covered = 0;
            for (int k = 0; k < WIDE * HIGH; k++) {
                const float *pixel = drawn + 4 * k;
                covered += (double)pixel[3] / (WIDE * HIGH);
                for (int c = 0; c < 3; c++)
                    assert_float_equal((double)pixel[c], factor * (double)(colour[c] * pixel[3]), tolerance);
            }
            assert_true(covered > 0.1);
        }
        shape_gl_destroy(renderer);
    }
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* What a law lit leaves no trace where it is off again; ambient light and emission likewise. */
static void off_is_as_it_was(void **state)
{
    (void)state;
    static float first[VALUES], other[VALUES], again[VALUES];
    shape_error error;
    shape_set *set = clouds(1);
    shape_volume *volume = new_volume(set);
    shape_light light = side_sun();
    shape_gl_lighting lighting = {SHAPE_GL_LAW_POWDER, 2, 8, {0.1f, 0.2f, 0.3f}, {0.3f, 0.2f, 0.1f}};
    shape_gl_renderer *renderer = open_renderer(SHAPE_GL_DEFAULT, &usual, NULL, volume);
    picture(renderer, &light, 1, first);
    must(shape_gl_set_lighting(renderer, &lighting, &error), &error);
    picture(renderer, &light, 1, other);
    must(shape_gl_set_lighting(renderer, &usual, &error), &error);
    picture(renderer, &light, 1, again);
    assert_memory_equal(first, again, sizeof first);
    assert_true(memcmp(first, other, sizeof first) != 0);
    lighting = usual;
    lighting.ambient[1] = NAN;
    assert_int_equal(shape_gl_set_lighting(renderer, &lighting, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "ambient"));
    shape_gl_destroy(renderer);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* A surface has the sky's light where the clouds have it, as in the march. */
static void surfaces_have_the_clouds_sky(void **state)
{
    (void)state;
    static float drawn[VALUES];
    const float grey[3] = {0.25f, 0.5f, 0.75f};
    shape_error error;
    shape_set *set = clouds(1);
    shape_volume *volume = new_volume(set);
    shape_opaque *opaque = shape_opaque_create(&error);
    must(shape_opaque_add_ground(opaque, -40, grey, &error), &error);
    must(shape_opaque_finish(opaque, &error), &error);
    shape_light light = white_sky();
    memset(light.sun_irradiance, 0, sizeof light.sun_irradiance);
    shape_gl_renderer *renderer = open_renderer(SHAPE_GL_DEFAULT, &usual, opaque, volume);
    for (int i = 0; i < 2; i++) {
        shape_gl_lighting lighting = usual;
        lighting.law = i ? SHAPE_GL_LAW_POWDER : SHAPE_GL_LAW_GRID;
        must(shape_gl_set_lighting(renderer, &lighting, &error), &error);
        picture(renderer, &light, 1, drawn);
        const float *corner = drawn + 4 * ((HIGH - 1) * WIDE);
        for (int c = 0; c < 3; c++)
            assert_float_equal((double)corner[c], i ? 0 : (double)grey[c], 1e-5);
    }
    shape_gl_destroy(renderer);
    shape_opaque_destroy(opaque);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(laws_of_the_preview_are_the_marchs),
                                       cmocka_unit_test(laws_of_the_exact_view_are_the_marchs),
                                       cmocka_unit_test(ambient_light_and_emission_are_constants),
                                       cmocka_unit_test(off_is_as_it_was),
                                       cmocka_unit_test(surfaces_have_the_clouds_sky)};
    return cmocka_run_group_tests(tests, open_context, close_context);
}
