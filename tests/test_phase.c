/* Phase functions: normalised, with the mean cosine they claim, sampled as their value says, finite at the limits. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "shape/phase.h"

static const double pi = 3.14159265358979323846;

static shape_medium medium(shape_phase_kind kind, float g, float droplet)
{
    shape_medium m = shape_medium_defaults();
    m.phase = kind;
    m.g = g;
    m.droplet = droplet;
    return m;
}

/* The integral of value * cos^power over the sphere between two cosines. The substitution cos = 1 - 2 t^4 packs the
 * midpoints where forward peaks are; their error is below 1e-5 with 4000 of them. */
static double integrate(const shape_medium *m, int power, double from, double to)
{
    const int n = 4000;
    double t0 = pow((1 - to) / 2, 0.25), t1 = pow((1 - from) / 2, 0.25), h = (t1 - t0) / n, sum = 0;
    for (int i = 0; i < n; i++) {
        double t = t0 + h * (i + 0.5), c = 1 - 2 * t * t * t * t;
        sum += (double)shape_phase(m, (float)c) * (power ? c : 1) * 8 * t * t * t * h;
    }
    return 2 * pi * sum;
}

static const struct {
    shape_phase_kind kind;
    float g, droplet;
} cases[] = {
    {SHAPE_PHASE_HG, 0, 10},           {SHAPE_PHASE_HG, 1e-4f, 10},      {SHAPE_PHASE_HG, 0.5f, 10},
    {SHAPE_PHASE_HG, -0.7f, 10},       {SHAPE_PHASE_HG, 0.85f, 10},      {SHAPE_PHASE_HG, 0.97f, 10},
    {SHAPE_PHASE_ISOTROPIC, 0.5f, 10}, {SHAPE_PHASE_RAYLEIGH, 0.5f, 10}, {SHAPE_PHASE_MIE, 0, 5},
    {SHAPE_PHASE_MIE, 0, 12},          {SHAPE_PHASE_MIE, 0, 50},         {SHAPE_PHASE_TWO_LOBE, 0.8f, 10}};
enum { CASES = sizeof cases / sizeof cases[0] };

static void integral_is_one_and_mean_cosine_as_claimed(void **state)
{
    (void)state;
    for (size_t i = 0; i < CASES; i++) {
        shape_medium m = medium(cases[i].kind, cases[i].g, cases[i].droplet);
        /* The peak of the largest droplets is 4e-6 wide in the cosine, a float's step there 6e-8: 2e-4 is lost. */
        assert_true(fabs(integrate(&m, 0, -1, 1) - 1) < 3e-4);
        assert_true(fabs(integrate(&m, 1, -1, 1) - (double)shape_phase_mean_cosine(&m)) < 3e-4);
    }
}

/* Numbers from 0 to 1 in equal steps must fall into each bin as often as its integral says. */
static void sampling_agrees_with_value(void **state)
{
    (void)state;
    static const double edges[] = {-1, -0.8, -0.3, 0.1, 0.5, 0.8, 0.95, 0.99, 0.999, 1};
    enum { BINS = sizeof edges / sizeof edges[0] - 1, DRAWS = 100000 };
    for (size_t i = 0; i < CASES; i++) {
        shape_medium m = medium(cases[i].kind, cases[i].g, cases[i].droplet);
        int count[BINS] = {0};
        for (int k = 0; k < DRAWS; k++) {
            float c = shape_phase_sample(&m, ((float)k + 0.5f) / DRAWS);
            assert_true(c >= -1 && c <= 1);
            int bin = 0;
            while (bin < BINS - 1 && (double)c >= edges[bin + 1])
                bin++;
            count[bin]++;
        }
        for (int bin = 0; bin < BINS; bin++)
            assert_true(fabs((double)count[bin] / DRAWS - integrate(&m, 0, edges[bin], edges[bin + 1])) <
                        3e-4);
    }
}

static void stays_finite_at_the_limits(void **state)
{
    (void)state;
    static const float gs[] = {-1, -0.99999994f, -0.9999f, 0, 1e-8f, 0.9999f, 0.99999994f, 1};
    static const float cosines[] = {-1, -0.9999999f, 0, 0.9999999f, 1};
    for (size_t i = 0; i < sizeof gs / sizeof gs[0]; i++) {
        shape_medium m = medium(SHAPE_PHASE_HG, gs[i], 10);
        for (size_t j = 0; j < sizeof cosines / sizeof cosines[0]; j++) {
            assert_true(isfinite(shape_phase(&m, cosines[j])));
            assert_true(shape_phase(&m, cosines[j]) >= 0);
        }
        for (int k = 0; k <= 16; k++) {
            float c = shape_phase_sample(&m, fminf((float)k / 16, 0x1.fffffep-1f));
            assert_true(c >= -1 && c <= 1);
        }
    }
}

static void renormalised_is_one_straight_on(void **state)
{
    (void)state;
    /* Its definition: hg divided by hg at the angle 0. */
    for (float g = -0.9f; g < 0.95f; g += 0.3f) {
        assert_true(fabsf(shape_phase_hg_renormalised(g, 1) - 1) < 1e-5f);
        float ratio = shape_phase_hg(g, 0.2f) / shape_phase_hg(g, 1);
        assert_true(fabsf(shape_phase_hg_renormalised(g, 0.2f) - ratio) < 1e-4f * ratio);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(integral_is_one_and_mean_cosine_as_claimed),
        cmocka_unit_test(sampling_agrees_with_value),
        cmocka_unit_test(stays_finite_at_the_limits),
        cmocka_unit_test(renormalised_is_one_straight_on),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
