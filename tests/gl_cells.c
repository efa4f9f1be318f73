/* How many cells the viewer's light grids have: by a cloud's size in pixels, or, with fixed_light, as many as are asked for,
 * shared out by the clouds' sizes in the picture. What neph-view --error finds and says is of such grids. */
#include "gl_context.h"

#include "gl_private.h"

/* A ball of 2 m at the origin, and beside it one of a quarter of that size. */
static shape_set *two_balls(void)
{
    shape_set *set = new_set();
    shape_error error;
    for (int i = 0; i < 2; i++) {
        shape_sphere ball = {i ? 3.0f : 0.0f, 0, 0, i ? 0.5f : 2.0f};
        must(shape_set_add_cloud(set, "ball", NULL, &error), &error);
        set->clouds[i].field.model = SHAPE_MODEL_UNIFORM;
        must(shape_primitives_add_sphere(shape_set_list(set, (size_t)i), ball, &error), &error);
    }
    return set;
}

/* The cells along the longest side of both clouds' grids, in a picture from that far off. */
static void cells_from(double away, int resolution, bool fixed, int cells[2])
{
    shape_error error;
    shape_gl_renderer *renderer;
    shape_gl_options options = shape_gl_defaults();
    shape_set *set = two_balls();
    shape_volume *volume = new_volume(set);
    shape_light light = shape_light_defaults();
    shape_view view = shape_view_defaults();
    view.width = 64, view.height = 36;
    view.eye = shape_dvec3_make(0, 0, away);
    options.light.resolution = resolution;
    options.light.scattering = false;
    options.fixed_light = fixed;
    must(shape_gl_create(&options, &renderer, &error), &error);
    must(shape_gl_load(renderer, volume, &error), &error);
    must(shape_gl_light(renderer, &light, &error), &error);
    must(shape_gl_draw(renderer, &view, 0, &error), &error);
    for (int i = 0; i < 2; i++) {
        const gl_lit *lit = renderer->grids.light->lit[i];
        assert_non_null(lit);
        cells[i] = 0;
        for (int axis = 0; axis < 3; axis++)
            cells[i] = lit->grid.size[axis] > cells[i] ? lit->grid.size[axis] : cells[i];
        assert_int_equal(cells[i], lit->cells);
    }
    shape_gl_destroy(renderer);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* Near or far: the largest has what was asked for, and each twice as much as with half of it. The other one is a quarter as
 * large: a quarter of the cells, in steps of the square root of 2, of which the nearer side's perspective may take one. */
static void fixed_cells_are_those_asked_for(void **state)
{
    (void)state;
    for (double away = 8; away <= 512; away *= 4) {
        int half[2], whole[2];
        cells_from(away, 24, true, half);
        cells_from(away, 48, true, whole);
        assert_int_equal(half[0], 24);
        assert_int_equal(whole[0], 48);
        assert_in_range(whole[1], 48 / 4, 48 / 4 * 1.5);
        assert_in_range(half[1], whole[1] / 2, whole[1] / 2 + 1);
    }
}

/* Otherwise a cell is a pixel and a half at least: far off, half as many asked for are no fewer. A ball of 4 m, 128 m away, is 14
 * pixels: 12 cells, the fewest. */
static void else_cells_follow_the_pixels(void **state)
{
    (void)state;
    int half[2], whole[2];
    cells_from(128, 24, false, half);
    cells_from(128, 48, false, whole);
    assert_int_equal(half[0], 12);
    assert_int_equal(whole[0], 12);
    cells_from(3, 48, false, whole);
    assert_int_equal(whole[0], 48);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(fixed_cells_are_those_asked_for),
                                       cmocka_unit_test(else_cells_follow_the_pixels)};
    return cmocka_run_group_tests(tests, open_context, close_context);
}
