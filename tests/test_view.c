/* The camera: rays where they should be, and a framed box that lies in the picture and fills it. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "shape/view.h"

static void assert_near(shape_dvec3 a, shape_dvec3 b, double tolerance)
{
    assert_true(shape_dvec3_length(shape_dvec3_sub(a, b)) <= tolerance);
}

static void rays_go_through_middle_and_corners(void **state)
{
    (void)state;
    shape_view view = shape_view_defaults();
    view.width = 200, view.height = 100, view.fov = 90;
    view.eye = shape_dvec3_make(1, 2, 3);
    view.target = shape_dvec3_make(1, 2, -7);
    shape_camera camera = shape_view_camera(&view);
    /* Looking along -z with 90 degrees: the upper edge rises by 45, and the picture is twice as wide. */
    assert_near(shape_camera_direction(&camera, &view, 100, 50), shape_dvec3_make(0, 0, -1), 1e-12);
    assert_near(shape_camera_direction(&camera, &view, 100, 0),
                shape_dvec3_normalize(shape_dvec3_make(0, 1, -1)), 1e-12);
    assert_near(shape_camera_direction(&camera, &view, 200, 0),
                shape_dvec3_normalize(shape_dvec3_make(2, 1, -1)), 1e-12);
    assert_near(shape_camera_direction(&camera, &view, 0, 100),
                shape_dvec3_normalize(shape_dvec3_make(-2, -1, -1)), 1e-12);
}

static void looks_straight_up_and_down(void **state)
{
    (void)state;
    shape_view view = shape_view_defaults();
    for (int sign = -1; sign <= 1; sign += 2) {
        view.eye = shape_dvec3_make(0, 0, 0);
        view.target = shape_dvec3_make(0, sign, 0);
        shape_camera camera = shape_view_camera(&view);
        assert_near(camera.forward, shape_dvec3_make(0, sign, 0), 1e-12);
        assert_true(fabs(shape_dvec3_length(camera.up) - tan(22.5 * 3.14159265358979 / 180)) < 1e-12);
        assert_true(fabs(shape_dvec3_dot(camera.up, camera.right)) < 1e-12);
    }
}

static void sun_stands_where_the_angles_say(void **state)
{
    (void)state;
    assert_near(shape_sun_direction(0, 0), shape_dvec3_make(0, 0, 1), 1e-12);
    assert_near(shape_sun_direction(90, 0), shape_dvec3_make(1, 0, 0), 1e-12);
    assert_near(shape_sun_direction(123, 90), shape_dvec3_make(0, 1, 0), 1e-12);
}

/* The largest |x| or |y| of the box's corners in the picture, where 1 is its edge. */
static double extent(const shape_view *view, shape_dvec3 min, shape_dvec3 max)
{
    shape_camera camera = shape_view_camera(view);
    double most = 0;
    for (int i = 0; i < 8; i++) {
        shape_dvec3 corner = {i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z};
        shape_dvec3 v = shape_dvec3_sub(corner, camera.origin);
        double depth = shape_dvec3_dot(v, camera.forward);
        assert_true(depth > 0);
        double x = shape_dvec3_dot(v, camera.right) / shape_dvec3_dot(camera.right, camera.right) / depth;
        double y = shape_dvec3_dot(v, camera.up) / shape_dvec3_dot(camera.up, camera.up) / depth;
        most = fmax(most, fmax(fabs(x), fabs(y)));
    }
    return most;
}

static void framed_box_fills_the_picture_and_no_more(void **state)
{
    (void)state;
    static const int sizes[][2] = {{640, 360}, {100, 100}, {100, 400}, {4000, 300}, {1, 16384}};
    static const double boxes[][3] = {{1, 1, 1}, {10, 1, 1}, {1, 10, 1}, {0.01, 1, 100}, {300, 2, 300}};
    static const double fovs[] = {5, 45, 120};
    shape_light light = shape_light_defaults();
    for (int s = 0; s < 5; s++)
        for (int b = 0; b < 5; b++)
            for (int f = 0; f < 3; f++) {
                shape_view view = shape_view_defaults();
                view.width = sizes[s][0], view.height = sizes[s][1], view.fov = fovs[f];
                shape_dvec3 min = {1000, -50, 3};
                shape_dvec3 max =
                    shape_dvec3_add(min, shape_dvec3_make(boxes[b][0], boxes[b][1], boxes[b][2]));
                shape_view_frame(&view, &light, min, max);
                assert_int_equal(shape_view_check(&view, NULL), SHAPE_OK);
                /* The nearest corner touches the margin, 0.92 of the way to the edge. */
                assert_true(fabs(extent(&view, min, max) - 0.92) < 1e-6);
                assert_true(view.eye.y < (min.y + max.y) / 2);
            }
}

static void frames_a_point_too(void **state)
{
    (void)state;
    shape_light light = shape_light_defaults();
    shape_view view = shape_view_defaults();
    shape_dvec3 point = {5, 6, 7};
    light.sun = shape_sun_direction(0, 90);
    shape_view_frame(&view, &light, point, point);
    assert_int_equal(shape_view_check(&view, NULL), SHAPE_OK);
}

static void checks_name_what_is_wrong(void **state)
{
    (void)state;
    shape_error error;
    shape_view view = shape_view_defaults();
    view.fov = 180;
    assert_int_equal(shape_view_check(&view, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "fov"));
    view = shape_view_defaults();
    view.target = view.eye;
    assert_int_equal(shape_view_check(&view, &error), SHAPE_ERROR_ARGUMENT);
    view = shape_view_defaults();
    view.width = 0;
    assert_int_equal(shape_view_check(&view, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "size"));
    shape_light light = shape_light_defaults();
    assert_int_equal(shape_light_check(&light, &error), SHAPE_OK);
    light.sun_irradiance[1] = NAN;
    assert_int_equal(shape_light_check(&light, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "sun_irradiance"));
    light = shape_light_defaults();
    light.sun = shape_dvec3_make(0, 0.5, 0);
    assert_int_equal(shape_light_check(&light, &error), SHAPE_ERROR_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_go_through_middle_and_corners),
        cmocka_unit_test(looks_straight_up_and_down),
        cmocka_unit_test(sun_stands_where_the_angles_say),
        cmocka_unit_test(framed_box_fills_the_picture_and_no_more),
        cmocka_unit_test(frames_a_point_too),
        cmocka_unit_test(checks_name_what_is_wrong),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
