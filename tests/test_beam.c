/* The sun's first scattering for each ray: the phase function without its peak, its closed form in a light grid, and that a
 * picture's brightness changes evenly as the eye flies through a light grid's cells towards the sun. */
#include "volume_sample.h"

#include "shape/beam.h"
#include "shape/lightgrid.h"
#include "shape/march.h"
#include "shape/phase.h"

static const double pi = 3.14159265358979323846;

static shape_medium medium_of(shape_phase_kind kind, float g)
{
    shape_medium medium = shape_medium_defaults();
    medium.phase = kind;
    medium.g = g;
    return medium;
}

/* Its mean cosine is 0.05, so it has a peak by the delta scaling, which is its backward lobe. */
static shape_medium two_lobes_that_look_back(void)
{
    shape_medium medium = medium_of(SHAPE_PHASE_TWO_LOBE, 0.3f);
    medium.g2 = -0.95f;
    medium.lobe_mix = 0.2f;
    return medium;
}

/* With the peak cut off the integral over the sphere is 1 - f, both parts are the function again, and have the mean cosines
 * that are said. The cap is found on 256 points and here are 200,000: 1e-3, of the cosine of what is left 2e-3. */
static void what_is_left_without_the_peak_has_its_share(void **state)
{
    (void)state;
    enum { POINTS = 200000 };
    const shape_medium media[] = {medium_of(SHAPE_PHASE_HG, 0.85f), medium_of(SHAPE_PHASE_HG, 0.4f),
                                  medium_of(SHAPE_PHASE_MIE, 0),    medium_of(SHAPE_PHASE_TWO_LOBE, 0.8f),
                                  medium_of(SHAPE_PHASE_HG, -0.5f), medium_of(SHAPE_PHASE_RAYLEIGH, 0)};
    for (size_t k = 0; k < sizeof media / sizeof media[0]; k++) {
        float share, rest;
        const shape_beam_peak peak = shape_beam_peak_make(&media[k]);
        double sum = 0, turned = 0, above = 0, ahead = 0;
        shape_delta_scaling(shape_phase_mean_cosine(&media[k]), &share, &rest);
        for (int i = 0; i < POINTS; i++) {
            double u = (i + 0.5) / POINTS; /* cos = 1 - 2 u^4 */
            float cosine = (float)(1 - 2 * u * u * u * u);
            shape_beam beam = shape_beam_make(&media[k], &peak, cosine);
            assert_true(beam.blunt >= 0 && beam.peak >= 0 && beam.blunt <= peak.cap);
            assert_float_equal(beam.blunt + beam.peak, shape_phase(&media[k], cosine),
                               1e-6f * shape_phase(&media[k], cosine));
            const double ring = 2 * pi * 8 * u * u * u / POINTS;
            sum += ring * (double)beam.blunt;
            turned += ring * (double)(beam.blunt * cosine);
            above += ring * (double)beam.peak;
            ahead += ring * (double)(beam.peak * cosine);
        }
        print_message("phase function %d: %.5f left of 1 - %.5f\n", (int)media[k].phase, sum, (double)share);
        assert_true(fabs(sum - (1 - (double)share)) < 1e-3);
        assert_true(fabs(turned / sum - (double)peak.rest) < 2e-3);
        if (share > 0)
            assert_true(fabs(ahead / above - (double)peak.ahead) < 1e-3);
        else
            assert_true(peak.ahead == 1 && !(above > 0));
    }
}

/* The source over all directions is what is scattered at all of the light that has not left the peak, w exp(-(1 - w f) x): the
 * three parts are r, p - r and a distribution, of (1 - f), f exp(-w f x) and f (1 - exp(-w f x)). That of von Mises and Fisher is
 * taken without its backward end, exp(-2 / (1 - cos)) of it, below 1e-3 here. In clear air it is the albedo times the phase function; near the
 * eye what has been scattered before is on the ray already. */
static void no_light_of_the_peak_is_lost(void **state)
{
    (void)state;
    enum { POINTS = 20000 };
    shape_medium medium = medium_of(SHAPE_PHASE_HG, 0.85f);
    const shape_beam_peak peak = shape_beam_peak_make(&medium);
    for (int k = 0; k < 12; k++) {
        const float albedo = k % 2 ? 1 : 0.7f, depth = 1.5f * (float)(k / 2),
                    thin = 1 - albedo * 0.85f * 0.85f;
        const float seen = expf(-thin * depth);
        double sum = 0;
        for (int i = 0; i < POINTS; i++) {
            double u = (i + 0.5) / POINTS;
            shape_beam beam = shape_beam_make(&medium, &peak, (float)(1 - 2 * u * u * u * u));
            sum += 2 * pi * (double)shape_beam_source(&beam, albedo, seen, 0) * 8 * u * u * u / POINTS;
            assert_true(shape_beam_source(&beam, albedo, 0, 0) == 0);
        }
        print_message("albedo %g, depth %g: %.4f of %.4f\n", (double)albedo, (double)depth, sum,
                      (double)(albedo * seen));
        assert_true(fabs(sum / (double)(albedo * seen) - 1) < 4e-3);
        shape_beam beam = shape_beam_make(&medium, &peak, 0.95f);
        float p = shape_phase_hg(0.85f, 0.95f), r = fminf(p, peak.cap);
        float want = albedo * (expf(-depth) * (p - r) + seen * r);
        assert_float_equal(shape_beam_source(&beam, albedo, seen, 1), want, 1e-4f * want);
    }
    const shape_medium back = two_lobes_that_look_back();
    const shape_beam_peak other = shape_beam_peak_make(&back);
    for (int k = 0; k <= 20; k++) {
        const shape_beam beam = shape_beam_make(&back, &other, 1 - 0.1f * (float)k);
        for (float seen = 1; seen > 1e-30f; seen *= 0.01f)
            assert_true(shape_beam_source(&beam, 1, seen, 0) > 0 &&
                        isfinite(shape_beam_source(&beam, 1, seen, 0)));
    }
    shape_beam clear = shape_beam_make(&medium, &peak, 0.9f);
    assert_float_equal(shape_beam_source(&clear, 1, 1, 0), shape_phase_hg(0.85f, 0.9f), 1e-5f);
}

/* The mean radiance of a few directions around the sun's, from an eye in the ball. */
static double look_to_the_sun(const shape_volume *volume, const shape_light *light, shape_dvec3 eye)
{
    enum { SIDE = 12 };
    shape_error error;
    shape_march_options options = shape_march_defaults();
    shape_marcher *marcher;
    shape_march_scratch scratch = {0};
    double sum = 0;
    options.resolution = 12;
    must(shape_marcher_create(volume, light, eye, &options, &marcher, &error), &error);
    for (int i = 0; i < SIDE * SIDE; i++) {
        double x = 1.2 * ((i % SIDE + 0.5) / SIDE - 0.5), y = 1.2 * ((double)(i / SIDE) + 0.5) / SIDE - 0.6,
               rgb[3];
        shape_dvec3 d = shape_dvec3_normalize(shape_dvec3_make(x, y, 1));
        must(shape_march_radiance(marcher, eye, d, 0.5, &scratch, rgb, &error), &error);
        sum += rgb[1] / (SIDE * SIDE);
    }
    shape_march_scratch_free(&scratch);
    shape_marcher_destroy(marcher);
    return sum;
}

/* An even ball of optical diameter 5 and three cells of flight towards the sun, in quarters of a cell: what is seen of the sun's
 * light rises smoothly, so that second differences are a small part of the mean: with the phase function taken by cells they
 * were 0.026 of it, and now are 0.011. */
static void brightness_changes_evenly_from_cell_to_cell(void **state)
{
    (void)state;
    enum { STEPS = 13 };
    shape_set *set = new_set();
    shape_cloud *cloud = new_cloud(set, SHAPE_MODEL_UNIFORM);
    cloud->medium.g = 0.85f;
    cloud->medium.extinction = 1;
    cloud->medium.albedo = 1;
    add_sphere(set, 0, 0, 0, 0, 2.5);
    shape_volume *volume = new_volume(set);
    shape_light light = shape_light_defaults();
    double mean[STEPS], worst = 0;
    light.sun = shape_dvec3_make(0, 0, 1);
    light.sky = SHAPE_SKY_NONE;
    for (int i = 0; i < STEPS; i++) {
        mean[i] = look_to_the_sun(volume, &light, shape_dvec3_make(0.05, 0.03, -0.7 + 5.0 / 12 / 4 * i));
        print_message("%.4f ", mean[i]);
    }
    for (int i = 1; i < STEPS - 1; i++)
        worst = fmax(worst, fabs(mean[i - 1] - 2 * mean[i] + mean[i + 1]) / mean[i]);
    print_message("\nlargest second difference %.4f of the mean\n", worst);
    assert_true(worst < 0.016);
    shape_volume_destroy(volume);
    shape_set_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_left_without_the_peak_has_its_share),
        cmocka_unit_test(no_light_of_the_peak_is_lost),
        cmocka_unit_test(brightness_changes_evenly_from_cell_to_cell),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
