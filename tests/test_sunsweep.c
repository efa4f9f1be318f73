/* The swept optical depth: against chords of balls, against the march from every cell, shadows between clouds, threads,
 * and that only what is asked for is swept. Rows of densities: against densities point by point. */
#include "volume_sample.h"

#include "field/row.h"
#include "light/sunsweep.h"

static shape_light light_from(double azimuth, double height)
{
    shape_light light = shape_light_defaults();
    light.sun = shape_sun_direction(azimuth, height);
    return light;
}

static shape_sunsweep *new_sweep(const shape_volume *volume, shape_light light, const int *cells, int threads)
{
    shape_error error;
    shape_sunsweep *sweep = NULL;
    must(shape_sunsweep_create(volume, &light, cells, threads, &sweep, &error), &error);
    return sweep;
}

static shape_lightgrid build_by(const shape_volume *volume, size_t cloud, shape_light light, int resolution,
                                const shape_sunsweep *sweep, float step, int threads)
{
    shape_error error;
    shape_lightgrid grid;
    shape_lightgrid_options options = shape_lightgrid_defaults();
    options.resolution = resolution;
    options.scattering = false;
    options.sweep = sweep;
    options.step = step;
    options.threads = threads;
    must(shape_lightgrid_build(volume, cloud, &light, &options, &grid, &error), &error);
    return grid;
}

static shape_lightgrid build(const shape_volume *volume, size_t cloud, shape_light light, int resolution,
                             const shape_sunsweep *sweep, int threads)
{
    return build_by(volume, cloud, light, resolution, sweep, shape_lightgrid_defaults().step, threads);
}

static size_t cell_count(const shape_lightgrid *grid)
{
    return (size_t)grid->size[0] * (size_t)grid->size[1] * (size_t)grid->size[2];
}

/* Rows along each axis, by short steps and by steps of more than a cell of the noise, near the origin and far from it. */
static void rows_are_their_points(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(71, 0);
    long inside = 0, apart = 0;
    for (int round = 0; round < 60; round++) {
        shape_set *set = new_set();
        shape_cloud *cloud = new_cloud(set, round % 5 == 0 ? SHAPE_MODEL_UNIFORM : SHAPE_MODEL_SPHEROID);
        cloud->field.noise_scale = draw_size(&random, 0.01, 3);
        cloud->field.kappa = draw(&random, 0, 1);
        cloud->field.octaves = 1 + round % 16;
        add_random(set, 0, &random, 12, 8, 2, 0.2, 1.5);
        shape_volume *volume = new_volume(set);
        shape_volume_cloud *c = &volume->clouds[0];
        c->mean_octaves = round % 3;
        row_forms list = {0};
        shape_error error;
        must(row_collect(c, c->box.min, c->box.max, &list, &error), &error);
        assert_int_equal(list.count, 20);
        for (int k = 0; k < 40; k++) {
            field_row row = {k % 3, 1 + k * 8, {0}, 0};
            float u2[ROW_MOST], density[ROW_MOST];
            shape_vec3 p = draw_point(&random, 2);
            memcpy(row.low, &p, sizeof row.low);
            row.low[row.axis] = -3;
            row.step = 6 / (float)row.count;
            row_u2(&list, c->support, &row, u2);
            row_density(c, &list, &row, u2, density);
            for (int i = 0; i < row.count; i++) {
                p = shape_vec3_make(row.low[0], row.low[1], row.low[2]);
                (&p.x)[row.axis] += row.step * ((float)i + 0.5f);
                float wanted_u2 = shape_cloud_u2(c, p), wanted = shape_cloud_density_at(c, p, wanted_u2);
                if (wanted_u2 <= 0.9999f || u2[i] <= 0.9999f)
                    assert_float_equal(u2[i], wanted_u2, 1e-4);
                /* Where noise meets the cloud's edge a rounding decides. */
                inside += wanted > 0;
                apart += fabsf(density[i] - wanted) > 2e-5f;
            }
        }
        free(list.items);
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
    print_message("%ld points with density, %ld differ\n", inside, apart);
    assert_true(inside > 50000 && apart * 2000 < inside);
}

/* Metres of the ray from p inside a ball. */
static double chord(shape_dvec3 p, shape_dvec3 d, shape_dvec3 centre, double radius)
{
    shape_dvec3 v = shape_dvec3_sub(p, centre);
    double b = shape_dvec3_dot(v, d), room = b * b - shape_dvec3_dot(v, v) + radius * radius;
    return room <= 0 ? 0 : fmax(sqrt(room) - b, 0) - fmax(-sqrt(room) - b, 0);
}

/* A ball of even density, from suns on all sides: a chord is known to a cell's edge at both ends, and no better. */
static void depth_is_sigma_times_the_way_to_the_sun(void **state)
{
    (void)state;
    static const double suns[][2] = {{80, 50}, {0, 90},   {0, -90}, {90, 0},
                                     {270, 5}, {180, 10}, {45, 35}, {200, -30}};
    shape_set *set = new_set();
    new_cloud(set, SHAPE_MODEL_UNIFORM)->medium.extinction = 1.5f;
    add_sphere(set, 0, 1, 2, -3, 2);
    set->clouds[0].frame =
        (shape_frame){{{0, 0, 1, 1e5}, {1, 0, 0, 0}, {0, 1, 0, -3}}}; /* turned and far away */
    shape_volume *volume = new_volume(set);
    shape_dvec3 middle = shape_frame_point(&volume->clouds[0].frame, shape_dvec3_make(1, 2, -3));
    shape_random random = shape_random_seed(5, 0);
    for (size_t k = 0; k < sizeof suns / sizeof *suns; k++) {
        shape_light light = light_from(suns[k][0], suns[k][1]);
        const int cells = 40;
        shape_sunsweep *sweep = new_sweep(volume, light, &cells, 0);
        double sum = 0, worst = 0;
        for (int i = 0; i < 2000; i++) {
            shape_vec3 p = shape_vec3_add(shape_vec3_make(1, 2, -3), draw_point(&random, 2));
            shape_dvec3 world = shape_frame_point(&volume->clouds[0].frame, shape_dvec3_make(p.x, p.y, p.z));
            double truth = 1.5 * chord(world, light.sun, middle, 2);
            double off = fabs((double)shape_sunsweep_depth(sweep, 0, p) - truth);
            sum += off * off;
            worst = fmax(worst, off);
        }
        sum = sqrt(sum / 2000);
        print_message("sun %g, %g: rms %.4f, most %.4f of 6\n", suns[k][0], suns[k][1], sum, worst);
        /* A cell is 0.105 m, 0.16 of optical depth; at the rim a chord changes by (2 r cell)^0.5 within one. */
        assert_true(sum < 0.16 * 0.5 && worst < 1.5 * sqrt(2 * 2 * 2 * 0.105));
        shape_sunsweep_destroy(sweep);
    }
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

static shape_set *cumulus(float extinction)
{
    shape_random random = shape_random_seed(400, 0);
    shape_set *set = new_set();
    shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_SPHEROID);
    cloud->field.noise_scale = 0.4f;
    cloud->medium.extinction = extinction;
    add_random(set, 0, &random, 25, 10, 3, 0.7, 2.5);
    return set;
}

/* Root of the mean square, and mean, of what more of the sun's light comes through in one grid than in another. */
static double apart(const shape_lightgrid *a, const shape_lightgrid *b, double *mean)
{
    double sum = 0;
    size_t cells = cell_count(a);
    *mean = 0;
    for (size_t i = 0; i < cells; i++) {
        double d = exp(-(double)a->cells[i * SHAPE_LIGHTGRID_VALUES]) -
                   exp(-(double)b->cells[i * SHAPE_LIGHTGRID_VALUES]);
        sum += d * d;
        *mean += d / (double)cells;
    }
    return sqrt(sum / (double)cells);
}

/* The twin: a march from every cell, by steps so short that it is the truth. The sweep's optical depths, as shares of the
 * sun's light, are as near to it as those of the march with its usual steps, give or take a cell's width: */
static void the_march_agrees(void **state)
{
    (void)state;
    shape_set *set = cumulus(2);
    shape_volume *volume = new_volume(set);
    shape_light light = light_from(60, 40);
    const struct {
        int cells, grid;
        double tolerance;
    } cases[] = {{40, 40, 0.05}, {40, 23, 0.05}, {80, 40, 0.03}, {24, 12, 0.07}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        shape_sunsweep *sweep = new_sweep(volume, light, &cases[k].cells, 0);
        shape_lightgrid swept = build(volume, 0, light, cases[k].grid, sweep, 0),
                        marched = build(volume, 0, light, cases[k].grid, NULL, 0),
                        truth = build_by(volume, 0, light, cases[k].grid, NULL, 0.1f, 0);
        double mean, usual = apart(&marched, &truth, &mean), off = apart(&swept, &truth, &mean);
        print_message("%d cells, grid of %d: rms %.4f, mean %.4f; march by usual steps: rms %.4f\n",
                      cases[k].cells, cases[k].grid, off, mean, usual);
        assert_true(off < cases[k].tolerance && fabs(mean) < 0.01);
        shape_lightgrid_free(&swept);
        shape_lightgrid_free(&marched);
        shape_lightgrid_free(&truth);
        shape_sunsweep_destroy(sweep);
    }
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* Two clouds in each other's shadow; by the sweep's own grid and by a coarser one, both large enough for more threads. */
static void threads_change_no_bit(void **state)
{
    (void)state;
    shape_set *set = cumulus(2);
    shape_cloud *other = new_cloud(set, SHAPE_MODEL_SPHEROID);
    shape_light light = light_from(60, 40);
    for (int axis = 0; axis < 3; axis++)
        other->frame.m[axis][3] = 6 * (&light.sun.x)[axis];
    add_sphere(set, 1, 0, 0, 0, 2);
    shape_volume *volume = new_volume(set);
    for (int grid = 40; grid >= 20; grid -= 20) {
        const int cells[2] = {40, 0};
        shape_sunsweep *sweep = new_sweep(volume, light, cells, 1);
        assert_int_equal(shape_sunsweep_count(sweep), 2);
        shape_lightgrid one = build(volume, 0, light, grid, sweep, 1);
        shape_sunsweep_destroy(sweep);
        for (int threads = 2; threads <= 5; threads += 3) {
            sweep = new_sweep(volume, light, cells, threads);
            shape_lightgrid many = build(volume, 0, light, grid, sweep, threads);
            assert_memory_equal(one.cells, many.cells,
                                cell_count(&one) * SHAPE_LIGHTGRID_VALUES * sizeof(float));
            shape_lightgrid_free(&many);
            shape_sunsweep_destroy(sweep);
        }
        shape_lightgrid_free(&one);
    }
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* A ball low over the first, towards the sun, and one that overlaps with it. */
static void clouds_shadow_each_other(void **state)
{
    (void)state;
    shape_light light = light_from(70, 40);
    for (int overlap = 0; overlap < 2; overlap++) {
        shape_set *set = new_set();
        for (int i = 0; i < 2; i++) {
            shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_UNIFORM);
            cloud->medium.extinction = i ? 0.4f : 0.7f;
            double away = i ? (overlap ? 1.5 : 40) : 0;
            for (int axis = 0; axis < 3; axis++)
                cloud->frame.m[axis][3] = away * (&light.sun.x)[axis];
            add_sphere(set, (size_t)i, 0, 0, 0, i ? 1.5 : 2);
        }
        shape_volume *volume = new_volume(set);
        const int cells[2] = {40, overlap ? 40 : 0};
        shape_sunsweep *sweep = new_sweep(volume, light, cells, 0);
        assert_int_equal(shape_sunsweep_count(sweep), 2);
        shape_random random = shape_random_seed(9, 0);
        double sum = 0;
        for (int i = 0; i < 1000; i++) {
            shape_vec3 p = draw_point(&random, 2);
            shape_dvec3 world = {p.x, p.y, p.z};
            double truth =
                0.7 * chord(world, light.sun, shape_dvec3_make(0, 0, 0), 2) +
                0.4 * chord(world, light.sun, shape_dvec3_scale(light.sun, overlap ? 1.5 : 40), 1.5);
            sum += pow((double)shape_sunsweep_depth(sweep, 0, p) - truth, 2);
        }
        print_message("overlap %d: rms %.4f\n", overlap, sqrt(sum / 1000));
        /* Half a cell of the first, and one of the coarse grid of a caster that was not asked for. */
        assert_true(sqrt(sum / 1000) < 0.08);
        shape_sunsweep_destroy(sweep);
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
}

/* A thousand clouds in a square, ten of which are asked for: these are swept, and those before the sun. */
static void only_what_is_asked_for_is_swept(void **state)
{
    (void)state;
    shape_set *set = new_set();
    int cells[1000] = {0};
    for (int i = 0; i < 1000; i++) {
        shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_UNIFORM);
        cloud->frame.m[0][3] = 10 * (i % 100);
        cloud->frame.m[2][3] = 10 * (i / 100);
        add_sphere(set, (size_t)i, 0, 0, 0, 1);
        cells[i] = i % 100 < 10 && i < 100 ? 8 : 0;
    }
    shape_volume *volume = new_volume(set);
    shape_sunsweep *high = new_sweep(volume, light_from(90, 70), cells, 0),
                   *low = new_sweep(volume, light_from(90, 0), cells, 0);
    assert_int_equal(shape_sunsweep_count(high), 10);
    assert_int_equal(shape_sunsweep_count(low), 100); /* the whole row lies before it */
    assert_true(shape_sunsweep_depth(high, 999, shape_vec3_make(0, 0, 0)) == 0);
    shape_sunsweep_destroy(high);
    shape_sunsweep_destroy(low);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

/* The pairs that the sorted walk finds are those of the plain double loop, and whatever truly shades is among them. */
static void casters_are_those_of_the_double_loop(void **state)
{
    (void)state;
    shape_random random = shape_random_seed(77, 0);
    shape_error error;
    for (int round = 0; round < 20; round++) {
        shape_set *set = new_set();
        for (int i = 0; i < 60; i++) {
            shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_UNIFORM);
            shape_vec3 p = draw_point(&random, 20);
            for (int axis = 0; axis < 3; axis++)
                cloud->frame.m[axis][3] = (double)(&p.x)[axis];
            if (i % 10 != 3) /* a few are empty */
                add_sphere(set, (size_t)i, 0, 0, 0, (double)draw_size(&random, 0.3, 4));
        }
        shape_volume *volume = new_volume(set);
        shape_vec3 d = draw_direction(&random);
        shape_dvec3 sun = shape_dvec3_normalize(shape_dvec3_make(d.x, d.y, d.z));
        shadow_pairs pairs;
        must(shadow_pairs_find(volume, sun, &pairs, &error), &error);
        for (size_t i = 0; i < 60; i++)
            for (size_t j = 0; j < 60; j++) {
                bool found = false;
                for (size_t k = pairs.first[i]; k < pairs.first[i + 1]; k++)
                    found = found || pairs.casters[k] == j;
                if (i == j || i % 10 == 3 || j % 10 == 3) {
                    assert_false(found);
                    continue;
                }
                const shape_sphere *a = &volume->clouds[i].list->spheres[0],
                                   *b = &volume->clouds[j].list->spheres[0];
                shape_dvec3 apart = {volume->clouds[j].frame.m[0][3] - volume->clouds[i].frame.m[0][3],
                                     volume->clouds[j].frame.m[1][3] - volume->clouds[i].frame.m[1][3],
                                     volume->clouds[j].frame.m[2][3] - volume->clouds[i].frame.m[2][3]};
                double ahead = shape_dvec3_dot(apart, sun),
                       across = sqrt(fmax(shape_dvec3_dot(apart, apart) - ahead * ahead, 0)),
                       reach = (double)a->radius + (double)b->radius;
                if (across < reach && ahead > 0) {
                    assert_true(found);
                    assert_true(shape_sun_may_shade(&volume->clouds[j], &volume->clouds[i], sun));
                }
                /* A box's corner is at most the square root of 3 further than the ball's rim, and boxes seen from the
                 * sun meet by their corners once more so far away. */
                if (across > 2.46 * reach || ahead < -1.74 * reach) {
                    assert_false(found);
                    assert_false(shape_sun_may_shade(&volume->clouds[j], &volume->clouds[i], sun));
                }
            }
        shadow_pairs_free(&pairs);
        shape_volume_destroy(volume);
        shape_set_destroy(set);
    }
}

/* Other models go point by point, and awkward sizes stay finite. */
static void any_cloud_can_be_swept(void **state)
{
    (void)state;
    static const struct {
        double x, radius, extinction;
    } cases[] = {{0, 1e-3, 1e6}, {0, 1e4, 1e9},    {1e6, 1, 1},    {3e7, 1, 1},
                 {1e15, 1, 1},   {0, 1e-15, 1e30}, {0, 1e15, 1e30}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++)
        for (int model = SHAPE_MODEL_UNIFORM; model <= SHAPE_MODEL_METABALL; model++) {
            shape_set *set = new_set();
            shape_cloud *cloud = new_cloud(set, (shape_model)model);
            cloud->medium.extinction = (float)cases[k].extinction;
            cloud->field.noise_scale = (float)cases[k].radius;
            add_sphere(set, 0, cases[k].x, 0, 0, cases[k].radius);
            shape_volume *volume = new_volume(set);
            shape_light light = light_from(60, 40);
            const int cells = 8;
            shape_sunsweep *sweep = new_sweep(volume, light, &cells, 0);
            shape_lightgrid grid = build(volume, 0, light, 8, sweep, 0);
            double most = 0;
            for (size_t i = 0; i < cell_count(&grid); i++) {
                float value = grid.cells[i * SHAPE_LIGHTGRID_VALUES];
                assert_true(value >= 0 && value <= 60000);
                most = fmax(most, (double)value);
            }
            if (cases[k].x == 0 && cases[k].radius > 1e-10 && cases[k].radius < 1e10)
                assert_true(most > 0);
            shape_lightgrid_free(&grid);
            shape_sunsweep_destroy(sweep);
            shape_volume_destroy(volume);
            shape_set_destroy(set);
        }
}

/* The scattered light of a coarser grid, interpolated: near that of the whole grid, and without steps between cells. */
static void coarse_scattering_is_near(void **state)
{
    (void)state;
    shape_error error;
    shape_set *set = cumulus(2);
    shape_volume *volume = new_volume(set);
    shape_light light = light_from(60, 40);
    const int cells = 24;
    shape_sunsweep *sweep = new_sweep(volume, light, &cells, 0);
    shape_lightgrid grids[2];
    for (int i = 0; i < 2; i++) {
        shape_lightgrid_options options = shape_lightgrid_defaults();
        options.resolution = cells;
        options.sweep = sweep;
        options.scattering_resolution = i ? 12 : 0;
        must(shape_lightgrid_build(volume, 0, &light, &options, &grids[i], &error), &error);
    }
    double off = 0, sum = 0;
    for (size_t i = 0; i < cell_count(&grids[0]); i++) {
        const float *a = grids[0].cells + i * SHAPE_LIGHTGRID_VALUES,
                    *b = grids[1].cells + i * SHAPE_LIGHTGRID_VALUES;
        assert_true(a[0] == b[0]);
        off += fabs((double)a[1] - (double)b[1]);
        sum += (double)a[1];
    }
    print_message("scattered light by half the cells: %.3f of it elsewhere\n", off / sum);
    assert_true(off > 0 && off < 0.2 * sum);
    for (int i = 0; i < 2; i++)
        shape_lightgrid_free(&grids[i]);
    shape_sunsweep_destroy(sweep);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

static void checks_name_what_is_wrong(void **state)
{
    (void)state;
    shape_error error;
    shape_set *set = cumulus(1);
    shape_volume *volume = new_volume(set);
    shape_light light = light_from(60, 40);
    shape_sunsweep *sweep = NULL;
    int cells = 1;
    assert_int_equal(shape_sunsweep_create(volume, &light, &cells, 0, &sweep, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "1 cells"));
    cells = 0;
    sweep = new_sweep(volume, light, &cells, 0);
    shape_lightgrid grid;
    shape_lightgrid_options options = shape_lightgrid_defaults();
    options.sweep = sweep;
    assert_int_equal(shape_lightgrid_build(volume, 0, &light, &options, &grid, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "not swept"));
    shape_sunsweep_destroy(sweep);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_are_their_points),
        cmocka_unit_test(depth_is_sigma_times_the_way_to_the_sun),
        cmocka_unit_test(the_march_agrees),
        cmocka_unit_test(threads_change_no_bit),
        cmocka_unit_test(clouds_shadow_each_other),
        cmocka_unit_test(only_what_is_asked_for_is_swept),
        cmocka_unit_test(casters_are_those_of_the_double_loop),
        cmocka_unit_test(any_cloud_can_be_swept),
        cmocka_unit_test(coarse_scattering_is_near),
        cmocka_unit_test(checks_name_what_is_wrong),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
