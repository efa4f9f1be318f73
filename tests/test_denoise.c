/* The denoiser against pictures whose truth is known. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "shape/denoise.h"
#include "shape/random.h"

enum { W = 64, H = 48, N = 3 * W * H };

typedef struct noisy {
    float truth[N], radiance[N], variance[N], result[N];
} noisy;

/* A normal deviate as the sum of twelve uniform ones. */
static float deviate(shape_random *random)
{
    double sum = -6;
    for (int i = 0; i < 12; i++)
        sum += shape_random_u32(random) * 0x1p-32;
    return (float)sum;
}

/* Two halves of radiance 1 and `right`, with noise of standard deviation sigma, equal in the channels as in a path
 * tracer's grey clouds. */
static void make(noisy *p, float right, float sigma)
{
    shape_random random = shape_random_seed(1, 2);
    for (int i = 0; i < N / 3; i++) {
        float noise = sigma * deviate(&random);
        for (int c = 0; c < 3; c++) {
            p->truth[3 * i + c] = i % W < W / 2 ? 1 : right;
            p->radiance[3 * i + c] = p->truth[3 * i + c] + noise;
            p->variance[3 * i + c] = sigma * sigma;
        }
    }
}

static double square_error(const float *a, const float *b)
{
    double sum = 0;
    for (int i = 0; i < N; i++)
        sum += ((double)a[i] - (double)b[i]) * ((double)a[i] - (double)b[i]);
    return sum / N;
}

/* The mean over 225 pixels would divide the squared error by 225; the weights' own noise and the borders leave at least
 * a tenth of that gain. The mean radiance moves by no more than the noise of the picture's mean, three deviations. */
static void noise_on_a_plain_goes(void **state)
{
    (void)state;
    static noisy p;
    make(&p, 1, 0.1f);
    assert_int_equal(shape_denoise(p.radiance, p.variance, W, H, p.result, NULL), SHAPE_OK);
    assert_true(square_error(p.result, p.truth) < 0.01 / 20);
    double mean = 0;
    for (int i = 0; i < N; i++)
        mean += (double)p.result[i] / N;
    assert_true(fabs(mean - 1) < 3 * 0.1 / sqrt(W * H));
}

/* A step of ten deviations: pixels beside it must stay on their side, so their error is no larger than noise. */
static void an_edge_stays(void **state)
{
    (void)state;
    static noisy p;
    make(&p, 2, 0.1f);
    assert_int_equal(shape_denoise(p.radiance, p.variance, W, H, p.result, NULL), SHAPE_OK);
    double sum = 0;
    for (int y = 0; y < H; y++)
        for (int x = W / 2 - 1; x <= W / 2; x++)
            sum += pow((double)p.result[3 * (y * W + x)] - (double)p.truth[3 * (y * W + x)], 2);
    assert_true(sum / (2 * H) < 0.01 / 4);
    assert_true(square_error(p.result, p.truth) < 0.01 / 20);
}

static void what_has_no_noise_stays_as_it_is(void **state)
{
    (void)state;
    static noisy p;
    make(&p, 1, 0.1f);
    memset(p.variance, 0, sizeof p.variance);
    assert_int_equal(shape_denoise(p.radiance, p.variance, W, H, p.result, NULL), SHAPE_OK);
    assert_memory_equal(p.result, p.radiance, sizeof p.radiance);
}

/* A pixel all of whose paths ended in the dark has a variance of 0, which is chance and no knowledge. */
static void a_dark_speck_goes(void **state)
{
    (void)state;
    static noisy p;
    make(&p, 1, 0.5f);
    size_t at = 3 * (size_t)(W * (H / 2) + W / 2);
    for (size_t c = 0; c < 3; c++)
        p.radiance[at + c] = p.variance[at + c] = 0;
    assert_int_equal(shape_denoise(p.radiance, p.variance, W, H, p.result, NULL), SHAPE_OK);
    assert_true(p.result[at] > 0.5f);
}

/* One bright path of some dozen in the sky: its variance is the square of its mean. The sky around keeps its radiance to
 * the last bit, but for the eight neighbours that share its variance. */
static void a_bright_speck_leaves_no_box(void **state)
{
    (void)state;
    static noisy p;
    make(&p, 1, 0);
    size_t at = 3 * (size_t)(W * (H / 2) + W / 2);
    for (size_t c = 0; c < 3; c++) {
        p.radiance[at + c] = 1.5f;
        p.variance[at + c] = 0.25f;
    }
    assert_int_equal(shape_denoise(p.radiance, p.variance, W, H, p.result, NULL), SHAPE_OK);
    assert_true(p.result[at] < 1.1f);
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++)
            if (abs(x - W / 2) > 1 || abs(y - H / 2) > 1)
                assert_true(p.result[3 * (y * W + x)] == 1);
}

static void bad_pictures_are_refused(void **state)
{
    (void)state;
    static noisy p;
    shape_error error;
    make(&p, 1, 0.1f);
    assert_int_equal(shape_denoise(p.radiance, p.variance, 0, H, p.result, &error), SHAPE_ERROR_ARGUMENT);
    p.radiance[7] = NAN;
    assert_int_equal(shape_denoise(p.radiance, p.variance, W, H, p.result, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "x 2, y 0"));
    p.radiance[7] = 1;
    p.variance[3] = -1;
    assert_int_equal(shape_denoise(p.radiance, p.variance, W, H, p.result, &error), SHAPE_ERROR_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(noise_on_a_plain_goes),
                                       cmocka_unit_test(an_edge_stays),
                                       cmocka_unit_test(what_has_no_noise_stays_as_it_is),
                                       cmocka_unit_test(a_dark_speck_goes),
                                       cmocka_unit_test(a_bright_speck_leaves_no_box),
                                       cmocka_unit_test(bad_pictures_are_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
