/* Pictures that are drawn without shaders, until these are compiled. */
#include "gl_picture.h"

enum { WIDTH = 133, HEIGHT = 75, VALUES = WIDTH * HEIGHT * 4 };

static shape_set *clouds(int count)
{
    shape_set *set = new_set();
    for (int i = 0; i < count; i++) {
        shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_SPHEROID);
        cloud->field.noise_scale = 0.4f;
        cloud->medium.extinction = 4;
        cloud->frame.m[0][3] = 1.5 * i - 2;
        cloud->frame.m[2][3] = 0.5 * i;
        add_sphere(set, (size_t)i, 0, 0, 0, 1.2);
    }
    return set;
}

static double rms(const float *a, const float *b)
{
    double sum = 0;
    for (int i = 0; i < VALUES; i++)
        sum += pow((double)a[i] - (double)b[i], 2);
    return sqrt(sum / VALUES);
}

/* The second picture of a view that stands still is painted by the processor, the tenth by the shaders, of the same grids with
 * the same starts: the change over must not be seen. Textures of bytes are filtered with 8 bits of a texel's width, so up to
 * 1/256 of the density, and single rays that end elsewhere; a display step is 1/255. The first picture is a quick one, of
 * every fourth pixel each way, and may lack what is finer. In parts of the picture, with one cloud and with several. */
static void shaders_take_over_unseen(void **state)
{
    (void)state;
    shape_error error;
    for (int count = 1; count <= 3; count += 2) {
        shape_set *set = clouds(count);
        shape_volume *volume = new_volume(set);
        shape_light light = shape_light_defaults();
        shape_view view = view_of(WIDTH, HEIGHT, shape_dvec3_make(0, 0.5, 8), shape_dvec3_make(0, 0, 0), 40);
        shape_gl_options options = shape_gl_defaults();
        shape_gl_renderer *renderer;
        float *pictures[10];
        options.light.resolution = 16;
        options.early = true;
        must(shape_gl_create(&options, &renderer, &error), &error);
        must(shape_gl_load(renderer, volume, &error), &error);
        must(shape_gl_light(renderer, &light, &error), &error);
        for (int i = 0; i < 10; i++) {
            pictures[i] = malloc(VALUES * sizeof(float));
            assert_non_null(pictures[i]);
            must(shape_gl_draw_moving(renderer, &view, &error), &error);
            assert_int_equal(shape_gl_pending(renderer), i < (count > 1 ? 4 : 3));
            must(shape_gl_read(renderer, pictures[i], &error), &error);
        }
        double first = rms(pictures[0], pictures[9]), early = rms(pictures[1], pictures[9]);
        print_message("%d clouds: first picture %.5f, second %.5f from the shaders'\n", count, first, early);
        assert_true(early < 1.0 / 255 && early > 0); /* 0: nothing was painted by the processor */
        assert_true(first < 0.05 && first > early);
        assert_memory_equal(pictures[8], pictures[9], VALUES * sizeof(float));
        for (int i = 0; i < 10; i++)
            free(pictures[i]);
        shape_gl_destroy(renderer);
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
}

/* A view that rests after its very first picture is drawn by the shaders at once, as it is later: they have all they need. */
static void a_view_may_rest_at_once(void **state)
{
    (void)state;
    shape_error error;
    float *pictures[2] = {malloc(VALUES * sizeof(float)), malloc(VALUES * sizeof(float))};
    assert_true(pictures[0] && pictures[1]);
    shape_set *set = clouds(1);
    shape_volume *volume = new_volume(set);
    shape_light light = shape_light_defaults();
    shape_view view = view_of(WIDTH, HEIGHT, shape_dvec3_make(0, 0.5, 8), shape_dvec3_make(0, 0, 0), 40);
    shape_gl_options options = shape_gl_defaults();
    shape_gl_renderer *renderer;
    options.light.resolution = 16;
    options.early = true;
    must(shape_gl_create(&options, &renderer, &error), &error);
    must(shape_gl_load(renderer, volume, &error), &error);
    must(shape_gl_light(renderer, &light, &error), &error);
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < (i ? 6 : 1); k++)
            must(shape_gl_draw_moving(renderer, &view, &error), &error);
        must(shape_gl_draw(renderer, &view, 0, &error), &error);
        must(shape_gl_read(renderer, pictures[i], &error), &error);
    }
    double covered = 0;
    for (int k = 3; k < VALUES; k += 4)
        covered += (double)pictures[0][k];
    assert_true(covered > 100);
    assert_memory_equal(pictures[0], pictures[1], VALUES * sizeof(float));
    shape_gl_destroy(renderer);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
    free(pictures[0]);
    free(pictures[1]);
}

/* More clouds over one another than a ray is marched through, and none at all: numbers, and nothing beyond the picture. */
static void crowds_and_empty_skies_are_painted(void **state)
{
    (void)state;
    shape_error error;
    float *rgba = malloc(VALUES * sizeof *rgba);
    assert_non_null(rgba);
    for (int count = 1; count <= 40; count += 39) {
        shape_set *set = clouds(count);
        for (int i = 0; i < count; i++) {
            set->clouds[i].frame.m[0][3] = 0.01 * i;
            set->clouds[i].frame.m[2][3] = count > 1 ? 0.3 * i : 50; /* one: behind the eye */
        }
        shape_volume *volume = new_volume(set);
        shape_light light = shape_light_defaults();
        shape_view view = view_of(WIDTH, HEIGHT, shape_dvec3_make(0, 0, 20), shape_dvec3_make(0, 0, 0), 40);
        shape_gl_options options = shape_gl_defaults();
        shape_gl_renderer *renderer;
        options.light.resolution = 4;
        options.bake_voxels = 100000; /* 2500 each, were there no least: none of them in the cloud */
        options.early = true;
        must(shape_gl_create(&options, &renderer, &error), &error);
        must(shape_gl_load(renderer, volume, &error), &error);
        must(shape_gl_light(renderer, &light, &error), &error);
        for (int i = 0; i < 2; i++) {
            double coverage = 0;
            must(shape_gl_draw_moving(renderer, &view, &error), &error);
            must(shape_gl_read(renderer, rgba, &error), &error);
            for (int k = 0; k < VALUES; k++) {
                assert_true(rgba[k] >= 0 && rgba[k] < 1e3f);
                coverage += k % 4 == 3 ? (double)rgba[k] : 0;
            }
            assert_true(count > 1 ? coverage > 100 : coverage == 0);
        }
        shape_gl_destroy(renderer);
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
    free(rgba);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shaders_take_over_unseen),
        cmocka_unit_test(a_view_may_rest_at_once),
        cmocka_unit_test(crowds_and_empty_skies_are_painted),
    };
    return cmocka_run_group_tests(tests, open_context, close_pictures);
}
