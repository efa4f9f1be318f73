/* The sky: finite and not negative for every direction and sun, without an edge at the horizon, blue by day. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "shape/view.h"

static shape_sky sky_at(double height)
{
    shape_light light = shape_light_defaults();
    light.sun = shape_sun_direction(30, height);
    return shape_sky_make(&light);
}

static shape_vec3 direction(double azimuth, double height)
{
    shape_dvec3 d = shape_sun_direction(azimuth, height);
    return shape_vec3_make((float)d.x, (float)d.y, (float)d.z);
}

static void is_finite_and_not_negative(void **state)
{
    (void)state;
    float rgb[3];
    for (int sun = -90; sun <= 90; sun += 3) {
        shape_sky sky = sky_at(sun);
        for (int height = -90; height <= 90; height += 3)
            for (int azimuth = 0; azimuth < 360; azimuth += 15) {
                shape_sky_radiance(&sky, direction(azimuth, height), rgb);
                for (int c = 0; c < 3; c++)
                    /* 100 kcd/m^2 in the radiance's unit is pi: no sky but the sun itself is brighter. */
                    assert_true(rgb[c] >= 0 && rgb[c] < 3.2f);
            }
    }
}

static void has_no_edge_at_the_horizon(void **state)
{
    (void)state;
    float below[3], above[3];
    for (int sun = -10; sun <= 90; sun += 10) {
        shape_sky sky = sky_at(sun);
        for (int azimuth = 0; azimuth < 360; azimuth += 20) {
            shape_sky_radiance(&sky, direction(azimuth, -0.01), below);
            shape_sky_radiance(&sky, direction(azimuth, 0.01), above);
            for (int c = 0; c < 3;
                 c++) /* a fiftieth of a degree: a step would be far more than half a percent */
                assert_true(fabsf(below[c] - above[c]) < 0.005f * (above[c] + 0.01f));
        }
    }
}

static void grows_darker_as_the_sun_sinks(void **state)
{
    (void)state;
    float last = INFINITY;
    for (int sun = 0; sun >= -18; sun -= 3) {
        shape_sky sky = sky_at(sun);
        float upper[3], lower[3];
        shape_sky_mean(&sky, upper, lower);
        assert_true(upper[1] < last);
        last = upper[1];
    }
    assert_true(last < 0.001f); /* e^-6 of the sunset's 0.15 */
}

static void is_blue_by_day_and_warm_at_sunset(void **state)
{
    (void)state;
    float rgb[3];
    shape_sky day = sky_at(45), evening = sky_at(0);
    shape_sky_radiance(&day, direction(210, 45), rgb);
    assert_true(rgb[2] > 2 * rgb[0] && rgb[2] > rgb[1] && rgb[1] > rgb[0]);
    shape_sky_radiance(&evening, direction(30, 1), rgb);
    assert_true(rgb[0] > rgb[1] && rgb[1] > rgb[2]);
}

/* The model's irradiance for a clear day: 10 to 20 klx of skylight beside a sun of 100 klx. */
static void gives_a_clear_days_irradiance(void **state)
{
    (void)state;
    shape_sky sky = sky_at(45);
    double sum = 0;
    float rgb[3];
    for (int i = 0; i < 90; i++)
        for (int j = 0; j < 360; j += 5) {
            double height = (i + 0.5) * 0.0174532925;
            shape_sky_radiance(&sky, direction(j, i + 0.5), rgb);
            double y = 0.2126 * (double)rgb[0] + 0.7152 * (double)rgb[1] + 0.0722 * (double)rgb[2];
            sum += y * sin(height) * cos(height) * 0.0174532925 * 5 * 0.0174532925;
        }
    assert_true(sum > 0.1 * 3.14159 && sum < 0.3 * 3.14159);
}

static void other_kinds_do_what_they_say(void **state)
{
    (void)state;
    shape_light light = shape_light_defaults();
    float rgb[3], upper[3], lower[3];
    light.sky = SHAPE_SKY_CONSTANT;
    light.sky_radiance[0] = 1, light.sky_radiance[1] = 2, light.sky_radiance[2] = 3;
    shape_sky sky = shape_sky_make(&light);
    shape_sky_mean(&sky, upper, lower);
    for (int c = 0; c < 3; c++) {
        assert_true(fabsf(upper[c] - (float)(c + 1)) < 1e-4f);
        assert_true(fabsf(lower[c] - (float)(c + 1)) < 1e-4f);
    }
    light.sky = SHAPE_SKY_NONE;
    sky = shape_sky_make(&light);
    shape_sky_radiance(&sky, direction(0, 30), rgb);
    assert_true(rgb[0] == 0 && rgb[1] == 0 && rgb[2] == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(is_finite_and_not_negative),    cmocka_unit_test(has_no_edge_at_the_horizon),
        cmocka_unit_test(grows_darker_as_the_sun_sinks), cmocka_unit_test(is_blue_by_day_and_warm_at_sunset),
        cmocka_unit_test(gives_a_clear_days_irradiance), cmocka_unit_test(other_kinds_do_what_they_say),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
