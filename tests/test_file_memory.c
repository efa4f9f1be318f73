/* Pictures and scenes when memory runs out: PNG, EXR and PFM written and read, scenes written and read.
 * Each allocation of ours, of OpenEXR and of jansson fails once; it is reported as such, and nothing is left behind.
 * (libpng and zlib take memory past this test; cli_memory.sh makes theirs fail.) */
#include "failing_memory.h"

#include <jansson.h>

#include "shape/image.h"
#include "shape/scene.h"
#include "shape/transform.h"

static shape_image_format format;

static shape_status add_all(shape_image *image, shape_error *error)
{
    shape_status status = SHAPE_OK;
    if (format != SHAPE_IMAGE_PFM)
        status = shape_image_add_alpha(image, error);
    if (!status && format == SHAPE_IMAGE_EXR)
        status = shape_image_add_layer(image, "variance", error);
    return status;
}

static shape_status write_and_read(shape_error *error)
{
    const shape_image_text text = {"source", "a test"};
    shape_image_options options = shape_image_options_defaults();
    options.texts = &text;
    options.text_count = 1;
    unsigned char *bytes;
    size_t size;
    shape_image *back, *image = shape_image_create(5, 40, error); /* more lines than an EXR's chunk has */
    if (!image)
        return SHAPE_ERROR_MEMORY;
    for (int i = 0; i < 3 * 5 * 40; i++)
        image->pixels[i] = (float)(i % 17) / 16;
    shape_status status = add_all(image, error);
    if (!status)
        status = shape_image_encode(image, format, &options, &bytes, &size, error);
    if (!status) {
        status = shape_image_decode(bytes, size, &back, error);
        free(bytes);
    }
    if (!status) {
        /* What OpenEXR can do without must not show. */
        if (format != SHAPE_IMAGE_PNG)
            assert_memory_equal(image->pixels, back->pixels, 3 * 5 * 40 * sizeof(float));
        shape_image_destroy(back);
    }
    shape_image_destroy(image);
    return status;
}

static void pictures(void **state)
{
    (void)state;
    for (int f = SHAPE_IMAGE_PNG; f <= SHAPE_IMAGE_PFM; f++) {
        format = (shape_image_format)f;
        fail_each(write_and_read, f == SHAPE_IMAGE_EXR ? 20 : 4, f == SHAPE_IMAGE_EXR ? 12 : 0);
    }
}

static shape_status fill_scene(shape_scene *scene, shape_error *error)
{
    shape_scene_cloud *cloud;
    shape_transform place = shape_transform_defaults();
    shape_status status = shape_scene_add_cloud(scene, &cloud, error);
    if (!status)
        status = shape_scene_set_text(&cloud->generator, "neph-gauss", error);
    if (!status)
        status = shape_scene_add_option(&cloud->options, "count", "12", error);
    if (!status)
        status = shape_scene_add_option(&cloud->options, "no-hollow", NULL, error);
    for (int i = 0; i < 5 && !status; i++)
        status = shape_scene_add_copy(cloud, &place, error);
    return status;
}

static shape_status read_back(shape_scene *scene, shape_error *error)
{
    shape_scene *back;
    char *text;
    size_t size;
    shape_status status = shape_scene_encode(scene, &text, &size, error);
    live++; /* the text, which open_memstream took past this test, and the encoder gives back on an error */
    if (status)
        return status;
    status = shape_scene_decode(text, size, "a.json", &back, error);
    free(text);
    if (!status)
        shape_scene_destroy(back);
    return status;
}

static shape_status keep_scene(shape_error *error)
{
    shape_scene *scene = shape_scene_create(error);
    shape_status status = scene ? fill_scene(scene, error) : SHAPE_ERROR_MEMORY;
    if (!status)
        status = read_back(scene, error);
    shape_scene_destroy(scene);
    return status;
}

static void scenes(void **state)
{
    (void)state;
    json_set_alloc_funcs(malloc, free);
    other_errors = 1; /* where a token finds no memory, jansson finds a mistake in the text */
    fail_each(keep_scene, 20, 0);
    other_errors = 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(pictures), cmocka_unit_test(scenes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
