/* The methods of 2018 twice: the CPU's picture (light/paper.c) and the shader's (view/paper.frag) are one. Both march
 * the same steps in single precision with one filter of the noise; they differ by rounding, which now and then turns a
 * step at the threshold n < gamma to the other side, worth at most a step's share of a pixel (Mesa's software rasteriser:
 * root mean square 2e-6). The tolerance leaves room for GPUs, which filter with weights of 8 bits. */
#include "gl_context.h"

#include "shape/paper.h"

enum { W = 64, H = 36, N = W * H };

static void draw_by_gl(const shape_volume *volume, const shape_view *view, const shape_light *light,
                       const shape_paper_options *options, float *rgba)
{
    shape_error error;
    shape_gl_renderer *renderer;
    shape_gl_options gl = shape_gl_defaults();
    gl.method = options->sweep ? SHAPE_GL_PAPER_NDT : SHAPE_GL_PAPER;
    gl.paper_lod = options->lod;
    gl.light.resolution = options->resolution;
    must(shape_gl_create(&gl, &renderer, &error), &error);
    must(shape_gl_load(renderer, volume, &error), &error);
    must(shape_gl_light(renderer, light, &error), &error);
    for (int i = 0; i < options->samples; i++)
        must(shape_gl_draw(renderer, view, i, &error), &error);
    must(shape_gl_read(renderer, rgba, &error), &error);
    shape_gl_destroy(renderer);
}

/* How far the two pictures are apart: root mean square, difference of the means, largest. */
static void compare(const shape_set *set, const shape_view *view, const shape_paper_options *options,
                    const char *what)
{
    static float rgba[4 * N], rgb[3 * N];
    shape_error error;
    shape_volume *volume = new_volume(set);
    shape_light light = shape_light_defaults();
    double squares = 0, bias = 0, worst = 0, mean = 0, cover = 0, steps;
    draw_by_gl(volume, view, &light, options, rgba);
    must(shape_paper_render(volume, view, &light, options, rgb, &steps, NULL, &error), &error);
    for (int i = 0; i < N; i++)
        for (int c = 0; c < 3; c++) {
            double difference = (double)rgba[4 * i + c] - (double)rgb[3 * i + c];
            squares += difference * difference / (3 * N);
            bias += difference / (3 * N);
            mean += (double)rgb[3 * i + c] / (3 * N);
            worst = fmax(worst, fabs(difference));
            cover += (double)rgba[4 * i + 3] / (3 * N);
        }
    print_message("%s: mean %.4f, rms %.6f, bias %.7f, worst %.5f, cover %.2f, %.1f steps a ray\n", what,
                  mean, sqrt(squares), bias, worst, cover, steps);
    assert_true(cover > 0.1 && steps > 1);
    assert_true(sqrt(squares) < 2e-3);
    assert_true(fabs(bias) < 2e-4);
    assert_true(worst < 0.06);
    shape_volume_destroy(volume);
}

static shape_view near_view(void)
{
    shape_view view = shape_view_defaults();
    view.width = W, view.height = H;
    view.eye = shape_dvec3_make(1, 0.5, 8);
    view.target = shape_dvec3_make(0, 0, 0);
    return view;
}

static shape_set *heap(shape_model model)
{
    shape_random random = shape_random_seed(502, 0);
    shape_set *set = new_set();
    shape_cloud *cloud = new_cloud(set, model);
    cloud->field.noise_scale = 0.3f;
    cloud->medium.extinction = 3;
    cloud->frame.m[1][3] = -0.3;
    add_random(set, 0, &random, 20, 6, 1.5, 0.5, 1.2);
    return set;
}

static void spheroids_are_one_picture(void **state)
{
    (void)state;
    shape_view view = near_view();
    shape_set *set = heap(SHAPE_MODEL_SPHEROID);
    shape_paper_options options = shape_paper_defaults();
    for (int sweep = 0; sweep < 2; sweep++) {
        options.sweep = sweep;
        compare(set, &view, &options, sweep ? "paper-ndt" : "paper");
    }
    options.lod = true;
    compare(set, &view, &options, "paper-ndt, distance formula");
    shape_set_destroy(set);
}

static void other_models_and_more_samples(void **state)
{
    (void)state;
    shape_view view = near_view();
    shape_paper_options options = shape_paper_defaults();
    options.samples = 3;
    options.resolution = 12;
    for (int model = SHAPE_MODEL_UNIFORM; model <= SHAPE_MODEL_METABALL; model++) {
        shape_set *set = heap((shape_model)model);
        compare(set, &view, &options,
                model == SHAPE_MODEL_UNIFORM    ? "uniform"
                : model == SHAPE_MODEL_SPHEROID ? "spheroid"
                                                : "metaball");
        shape_set_destroy(set);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(spheroids_are_one_picture),
                                       cmocka_unit_test(other_models_and_more_samples)};
    return cmocka_run_group_tests(tests, open_context, close_context);
}
