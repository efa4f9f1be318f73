/* The light pass: optical depth against closed forms, threads, the white furnace, energy, published reflectances of a
 * slab, turning with the frame; and the grid of 2018. */
#include "volume_sample.h"

#include "light/ordinates.h"
#include "shape/lightgrid.h"

static const double pi = 3.14159265358979323846;

static shape_light light_from(double azimuth, double height)
{
    shape_light light = shape_light_defaults();
    light.sun = shape_sun_direction(azimuth, height);
    light.sky = SHAPE_SKY_CONSTANT; /* even: what is said here of values 2 and 3 is said of such a sky */
    return light;
}

static shape_lightgrid build(const shape_volume *volume, shape_light light, int resolution, bool scattering,
                             int threads)
{
    shape_error error;
    shape_lightgrid grid;
    shape_lightgrid_options options = shape_lightgrid_defaults();
    options.resolution = resolution;
    options.scattering = scattering;
    options.threads = threads;
    must(shape_lightgrid_build(volume, 0, &light, &options, &grid, &error), &error);
    return grid;
}

static size_t cell_count(const shape_lightgrid *grid)
{
    return (size_t)grid->size[0] * (size_t)grid->size[1] * (size_t)grid->size[2];
}

static shape_dvec3 cell_centre(const shape_lightgrid *grid, size_t i)
{
    size_t at[3] = {i % (size_t)grid->size[0], i / (size_t)grid->size[0] % (size_t)grid->size[1],
                    i / (size_t)grid->size[0] / (size_t)grid->size[1]};
    const float *low = &grid->box.min.x, *high = &grid->box.max.x;
    double p[3];
    for (int axis = 0; axis < 3; axis++)
        p[axis] = (double)low[axis] +
                  ((double)high[axis] - (double)low[axis]) * ((double)at[axis] + 0.5) / grid->size[axis];
    return shape_dvec3_make(p[0], p[1], p[2]);
}

/* Metres of the ray from p inside a ball. */
static double chord(shape_dvec3 p, shape_dvec3 d, shape_dvec3 centre, double radius)
{
    shape_dvec3 v = shape_dvec3_sub(p, centre);
    double b = shape_dvec3_dot(v, d), room = b * b - shape_dvec3_dot(v, v) + radius * radius;
    if (room <= 0)
        return 0;
    return fmax(sqrt(room) - b, 0) - fmax(-sqrt(room) - b, 0);
}

static void optical_depth_is_sigma_times_the_way_to_the_sun(void **state)
{
    (void)state;
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_UNIFORM)->medium.extinction = 1.5f;
    add_sphere(set, 0, 1, 2, -3, 2);
    new_cloud(set, SHAPE_MODEL_UNIFORM)->medium.extinction = 0.5f; /* its shadow falls on the first */
    add_sphere(set, 1, 4, 6, -3, 1.5);
    shape_volume *volume = new_volume(set);
    shape_light light = light_from(80, 50);
    shape_lightgrid grid = build(volume, light, 24, false, 0);
    long shaded = 0;
    for (size_t i = 0; i < cell_count(&grid); i++) {
        shape_dvec3 p = cell_centre(&grid, i);
        double truth = 1.5 * chord(p, light.sun, shape_dvec3_make(1, 2, -3), 2) +
                       0.5 * chord(p, light.sun, shape_dvec3_make(4, 6, -3), 1.5);
        const float *cell = grid.cells + i * SHAPE_LIGHTGRID_VALUES;
        /* Near the rim a chord changes with the square root of the place, known to a millionth of a metre. */
        assert_float_equal(cell[0], truth, 5e-3);
        if (truth > 0.5)
            assert_float_equal(cell[0], truth, 1e-4);
        shaded += truth > 0.5;
        for (int k = 1; k < SHAPE_LIGHTGRID_VALUES; k++)
            assert_true(cell[k] == 0); /* no scattering was asked for */
    }
    assert_true(shaded > 2000);
    shape_lightgrid_free(&grid);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

static shape_set *cumulus(float albedo, float g, float extinction)
{
    shape_random random = shape_random_seed(400, 0);
    shape_set *set = new_set();
    shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_SPHEROID);
    cloud->field.noise_scale = 0.4f;
    cloud->medium.albedo = albedo;
    cloud->medium.g = g;
    cloud->medium.extinction = extinction;
    add_random(set, 0, &random, 25, 10, 3, 0.7, 2.5);
    return set;
}

static void threads_change_no_bit(void **state)
{
    (void)state;
    shape_set *set = cumulus(0.99f, 0.85f, 4);
    shape_volume *volume = new_volume(set);
    shape_lightgrid one = build(volume, light_from(60, 40), 14, true, 1);
    for (int threads = 2; threads <= 5; threads += 3) {
        shape_lightgrid many = build(volume, light_from(60, 40), 14, true, threads);
        assert_memory_equal(one.size, many.size, sizeof one.size);
        assert_memory_equal(one.cells, many.cells, cell_count(&one) * SHAPE_LIGHTGRID_VALUES * sizeof(float));
        shape_lightgrid_free(&many);
    }
    shape_lightgrid_free(&one);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* Albedo 1 under a sky of radiance 1 all round: radiance is 1 everywhere, whatever the cloud. Source iteration nears
 * it from below, slower the deeper the cloud: to 1 % in balls of (scaled) optical diameter 10. In the last one, of 30,
 * it has not come to the middle when it is stopped; what is asked there is only that it makes no light. */
static void white_furnace(void **state)
{
    (void)state;
    static const struct {
        bool ball;
        float g, extinction;
        double tolerance;
    } cases[] = {{false, 0, 2, 1e-4}, {false, 0.85f, 10, 1e-4}, {false, -0.5f, 1, 1e-4},
                 {true, 0, 2, 0.003}, {true, 0.85f, 7, 0.003},  {true, 0, 6, 0.003}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        shape_set *set = cases[k].ball ? new_set() : cumulus(1, cases[k].g, cases[k].extinction);
        if (cases[k].ball) {
            shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_UNIFORM);
            cloud->medium.g = cases[k].g;
            cloud->medium.extinction = cases[k].extinction;
            add_sphere(set, 0, 0, 0, 0, 2.5);
        }
        shape_volume *volume = new_volume(set);
        shape_lightgrid grid = build(volume, light_from(60, 40), 18, true, 0);
        double least = INFINITY, most = 0;
        for (size_t i = 0; i < cell_count(&grid); i++) {
            const float *cell = grid.cells + i * SHAPE_LIGHTGRID_VALUES;
            double sum = (double)cell[2] + (double)cell[3];
            least = fmin(least, sum);
            most = fmax(most, sum);
        }
        print_message("furnace, %s, g %g, extinction %g: %.5f to %.5f\n", cases[k].ball ? "ball" : "cumulus",
                      (double)cases[k].g, (double)cases[k].extinction, least, most);
        assert_true(least > 1 - cases[k].tolerance);
        assert_true(most < 1 + cases[k].tolerance);
        shape_lightgrid_free(&grid);
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
}

static void black_clouds_scatter_nothing(void **state)
{
    (void)state;
    shape_set *set = cumulus(0, 0.85f, 3);
    shape_volume *volume = new_volume(set);
    shape_lightgrid grid = build(volume, light_from(60, 40), 14, true, 0);
    for (size_t i = 0; i < cell_count(&grid); i++) {
        const float *cell = grid.cells + i * SHAPE_LIGHTGRID_VALUES;
        assert_true(cell[1] == 0 && cell[4] == 0 && cell[5] == 0 && cell[6] == 0);
        assert_true(cell[2] >= 0 && cell[3] >= 0 && cell[2] + cell[3] <= 1.00001f); /* the sky behind it */
    }
    shape_lightgrid_free(&grid);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* In a vacuum the sky is seen unweakened: one half from above, one half from below; nothing is scattered. */
static void clear_air_shows_the_sky(void **state)
{
    (void)state;
    shape_set *set = cumulus(1, 0, 0);
    shape_volume *volume = new_volume(set);
    shape_lightgrid grid = build(volume, light_from(0, 90), 12, true, 0);
    for (size_t i = 0; i < cell_count(&grid); i++) {
        const float *cell = grid.cells + i * SHAPE_LIGHTGRID_VALUES;
        assert_true(cell[0] == 0 && cell[1] == 0);
        assert_float_equal(cell[2], 0.5, 1e-5);
        assert_float_equal(cell[3], 0.5, 1e-5);
        /* The mean of -cos over the half sphere is 1/4 in truth; four-point quadrature gives .2615. */
        assert_float_equal(cell[7], -0.25, 0.02);
    }
    shape_lightgrid_free(&grid);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* Reflectance of a slab of `cells` cells between clear ones, lit from straight above. Its cells are so wide that no
 * light leaves by the sides. */
static void slab(double tau, float g, int cells, double *reflected, double *transmitted)
{
    float *extinction = calloc((size_t)cells + 2, sizeof *extinction),
          *beam = calloc((size_t)cells + 2, sizeof *beam);
    float *moments = calloc(((size_t)cells + 2) * ORDINATES_CELL, sizeof *moments), share, rest;
    assert_true(extinction && beam && moments);
    shape_delta_scaling(g, &share, &rest);
    double scaled = tau * (1 - (double)share); /* albedo 1 */
    for (int i = 0; i < cells + 2; i++) {      /* from the bottom */
        extinction[i] = i > 0 && i <= cells ? (float)(scaled / cells) : 0;
        beam[i] = i > cells ? 1
                  : i == 0  ? (float)exp(-scaled)
                            : (float)exp(-scaled * (cells - i + 0.5) / cells);
    }
    ordinates_problem p = {.size = {1, cells + 2, 1},
                           .cell = {1e12f, 1, 1e12f},
                           .extinction = extinction,
                           .beam = beam,
                           .albedo = 1,
                           .g = rest,
                           .sun_travel = {0, -1, 0},
                           .up = {0, 1, 0},
                           .moments = moments};
    shape_error error;
    must(ordinates_solve(&p, 400, 1e-5f, 1, &error), &error);
    *reflected = 4 * pi * (double)moments[((size_t)cells + 1) * ORDINATES_CELL + 2 * ORDINATES_LANES];
    *transmitted = exp(-scaled) - 4 * pi * (double)moments[2 * ORDINATES_LANES];
    free(extinction);
    free(beam);
    free(moments);
}

/* Against adding and doubling with 32 points (van de Hulst's tables for g = 0). What is allowed is what four points a
 * half sphere, first differences and the delta scaling reach. */
static void slab_reflects_what_the_tables_say(void **state)
{
    (void)state;
    static const struct {
        double tau, g, reflectance, tolerance;
    } cases[] = {{0.5, 0, .20251, 0.01}, {1, 0, .34133, 0.01},    {2, 0, .51751, 0.01},
                 {4, 0, .69093, 0.01},   {8, 0, .82180, 0.01},    {4, 0.5, .50897, 0.02},
                 {8, 0.5, .68897, 0.02}, {4, 0.85, .19092, 0.10}, {8, 0.85, .35843, 0.05}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double reflected, transmitted;
        slab(cases[i].tau, (float)cases[i].g, 64, &reflected, &transmitted);
        print_message("slab, tau %g, g %g: R %.5f (%.5f), R + T %.5f\n", cases[i].tau, cases[i].g, reflected,
                      cases[i].reflectance, reflected + transmitted);
        assert_true(fabs(reflected / cases[i].reflectance - 1) < cases[i].tolerance);
        /* No light is lost or made: 400 rounds and midpoints of exp over 64 cells are good to 1e-3. */
        assert_true(fabs(reflected + transmitted - 1) < 1e-3);
    }
}

/* Turning cloud, frame and sun together by a quarter turn changes nothing but the names of the axes; turning the frame
 * one way and the primitives the other leaves the world as it was. */
static void turning_the_frame_turns_the_light(void **state)
{
    (void)state;
    shape_set *set = cumulus(1, 0.5f, 2), *turned = cumulus(1, 0.5f, 2);
    shape_light light = light_from(30, 35), with = light;
    /* x to y, y to z, z to x: the frame carries the cloud, and the sun goes with it. Up does not. */
    turned->clouds[0].frame = (shape_frame){{{0, 0, 1, 1e5}, {1, 0, 0, 0}, {0, 1, 0, -3}}};
    with.sun = shape_dvec3_make(light.sun.z, light.sun.x, light.sun.y);
    shape_volume *a = new_volume(set), *b = new_volume(turned);
    shape_lightgrid one = build(a, light, 14, true, 0), two = build(b, with, 14, true, 0);
    assert_memory_equal(one.size, two.size, sizeof one.size);
    double scattered = 0;
    for (size_t i = 0; i < cell_count(&one); i++) {
        const float *p = one.cells + i * SHAPE_LIGHTGRID_VALUES, *q = two.cells + i * SHAPE_LIGHTGRID_VALUES;
        /* 100 km away a march begins within 1e-11 m of the same place; a jump of density may fall between. */
        assert_float_equal(p[0], q[0], 0.05);
        assert_float_equal(p[1], q[1], 5e-4);
        assert_float_equal(p[2] + p[3], q[2] + q[3], 1e-3);
        for (int k = 4; k < 7; k++)
            assert_float_equal(p[k], q[k], 5e-4);
        scattered = fmax(scattered, (double)p[1]);
    }
    assert_true(scattered > 0.02);
    shape_lightgrid_free(&one);
    shape_lightgrid_free(&two);
    shape_volume_destroy(a);
    shape_volume_destroy(b);
    shape_set_destroy(set);
    shape_set_destroy(turned);
}

/* A cloud twice as large with half the extinction per metre is the same cloud. */
static void scale_and_extinction_trade(void **state)
{
    (void)state;
    shape_set *set = cumulus(1, 0.5f, 2), *large = cumulus(1, 0.5f, 1);
    large->clouds[0].frame = (shape_frame){{{2, 0, 0, 5}, {0, 2, 0, 0}, {0, 0, 2, 0}}};
    shape_volume *a = new_volume(set), *b = new_volume(large);
    shape_lightgrid one = build(a, light_from(30, 35), 14, true, 0),
                    two = build(b, light_from(30, 35), 14, true, 0);
    for (size_t i = 0; i < cell_count(&one) * SHAPE_LIGHTGRID_VALUES; i++)
        assert_float_equal(one.cells[i], two.cells[i], (i % SHAPE_LIGHTGRID_VALUES ? 5e-4 : 0.05));
    shape_lightgrid_free(&one);
    shape_lightgrid_free(&two);
    shape_volume_destroy(a);
    shape_volume_destroy(b);
    shape_set_destroy(set);
    shape_set_destroy(large);
}

/* Jiménez 2018 Eq. 7 for a light of 1: exp(-tau) and forward light of 0.5 * 0.0001 / (4 pi) a metre. */
static void grid_of_2018_is_transmittance_and_a_trace(void **state)
{
    (void)state;
    shape_error error;
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_UNIFORM)->medium.extinction = 0.8f;
    add_sphere(set, 0, -1, 0.5, 2, 1.5);
    shape_volume *volume = new_volume(set);
    shape_light light = light_from(120, 25);
    shape_lightgrid grid;
    const float step = 0.01f;
    must(shape_lightgrid_build_2018(volume, 0, &light, 16, step, &grid, &error), &error);
    assert_int_equal(cell_count(&grid), 16 * 16 * 16);
    for (size_t i = 0; i < cell_count(&grid); i++) {
        double way = chord(cell_centre(&grid, i), light.sun, shape_dvec3_make(-1, 0.5, 2), 1.5),
               tau = 0.8 * way;
        double trace = 0.5 * 0.0001 / (4 * pi) * (1 - exp(-tau)) / 0.8;
        const float *cell = grid.cells + i * SHAPE_LIGHTGRID_VALUES;
        /* The march takes whole steps: up to one too many. */
        assert_true((double)cell[0] <= exp(-tau) + trace + 1e-5);
        assert_true((double)cell[0] >= exp(-tau - 0.8 * 1.01 * (double)step) + trace - 1e-5);
        for (int k = 1; k < SHAPE_LIGHTGRID_VALUES; k++)
            assert_true(cell[k] == 0);
    }
    shape_lightgrid_free(&grid);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

static void awkward_clouds_give_finite_grids(void **state)
{
    (void)state;
    static const struct {
        double x, radius, extinction;
    } cases[] = {{0, 1e-3, 1e6}, {0, 1e4, 1e9},    {1e6, 1, 1},    {3e7, 1, 1},
                 {1e15, 1, 1},   {0, 1e-15, 1e30}, {0, 1e15, 1e30}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        shape_set *set = new_set();
        shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_UNIFORM);
        cloud->medium.extinction = (float)cases[k].extinction;
        cloud->field.noise_scale = (float)cases[k].radius;
        add_sphere(set, 0, cases[k].x, 0, 0, cases[k].radius);
        shape_volume *volume = new_volume(set);
        shape_lightgrid grid = build(volume, light_from(60, 40), 8, true, 0);
        for (size_t i = 0; i < cell_count(&grid) * SHAPE_LIGHTGRID_VALUES; i++)
            if (!(fabsf(grid.cells[i]) <= 60000))
                fail_msg("case %zu, cell %zu, value %zu: %g", k, i / SHAPE_LIGHTGRID_VALUES,
                         i % SHAPE_LIGHTGRID_VALUES, (double)grid.cells[i]);
        for (int axis = 0; axis < 3; axis++)
            assert_true((&grid.box.max.x)[axis] > (&grid.box.min.x)[axis]);
        shape_lightgrid_free(&grid);
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_UNIFORM); /* empty */
    shape_volume *volume = new_volume(set);
    shape_lightgrid grid = build(volume, light_from(60, 40), 8, true, 0);
    for (size_t i = 0; i < cell_count(&grid); i++)
        assert_true(grid.cells[i * SHAPE_LIGHTGRID_VALUES] == 0);
    shape_lightgrid_free(&grid);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

static void checks_name_what_is_wrong(void **state)
{
    (void)state;
    shape_error error;
    shape_lightgrid grid;
    shape_set *set = cumulus(1, 0, 1);
    shape_volume *volume = new_volume(set);
    shape_light light = shape_light_defaults();
    shape_lightgrid_options options = shape_lightgrid_defaults();
    assert_int_equal(shape_lightgrid_build(volume, 1, &light, &options, &grid, &error), SHAPE_ERROR_ARGUMENT);
    options.resolution = 1;
    assert_int_equal(shape_lightgrid_build(volume, 0, &light, &options, &grid, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "1 cells"));
    options = shape_lightgrid_defaults();
    options.step = 0;
    assert_int_equal(shape_lightgrid_build(volume, 0, &light, &options, &grid, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "step"));
    assert_int_equal(shape_lightgrid_build_2018(volume, 0, &light, 40, -1, &grid, &error),
                     SHAPE_ERROR_ARGUMENT);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(optical_depth_is_sigma_times_the_way_to_the_sun),
        cmocka_unit_test(threads_change_no_bit),
        cmocka_unit_test(white_furnace),
        cmocka_unit_test(black_clouds_scatter_nothing),
        cmocka_unit_test(clear_air_shows_the_sky),
        cmocka_unit_test(slab_reflects_what_the_tables_say),
        cmocka_unit_test(turning_the_frame_turns_the_light),
        cmocka_unit_test(scale_and_extinction_trade),
        cmocka_unit_test(grid_of_2018_is_transmittance_and_a_trace),
        cmocka_unit_test(awkward_clouds_give_finite_grids),
        cmocka_unit_test(checks_name_what_is_wrong),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
