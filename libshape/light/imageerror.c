/* Errors between two pictures: RMSE, relMSE (Rousselle et al. 2011), the largest, the best exposure, a heat map. */
#include "shape/imageerror.h"

#include <math.h>
#include <stddef.h>

static shape_status check_finite(const float *values, size_t count, int width, const char *which,
                                 shape_error *error)
{
    static const char *const names[] = {"red", "green", "blue"};
    for (size_t i = 0; i < count; i++)
        if (!isfinite(values[i]))
            return shape_error_set(
                error, SHAPE_ERROR_ARGUMENT,
                "the %s picture holds %g at x %zu, y %zu (%s) (such pictures cannot be compared)", which,
                (double)values[i], i / 3 % (size_t)width, i / 3 / (size_t)width, names[i % 3]);
    return SHAPE_OK;
}

static shape_status check_pictures(const float *a, const float *b, int width, int height, shape_error *error)
{
    if (width < 1 || height < 1)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "pictures of %dx%d pixels: each side must be at least 1", width, height);
    size_t count = (size_t)width * (size_t)height * 3;
    shape_status status = check_finite(a, count, width, "first", error);
    return status ? status : check_finite(b, count, width, "second", error);
}

static double weight(double b)
{
    return 1 / (b * b + SHAPE_IMAGEERROR_EPSILON);
}

/* relMSE of s a against b is quadratic in s: its least is at sum(w a b) / sum(w a a). */
static double best_exposure(const float *a, const float *b, size_t count)
{
    double across = 0, square = 0;
    for (size_t i = 0; i < count; i++) {
        across += weight(b[i]) * a[i] * b[i];
        square += weight(b[i]) * a[i] * a[i];
    }
    return square > 0 ? across / square : 0;
}

static double relative_error(const float *a, const float *b, size_t count, double exposure)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        double d = exposure * a[i] - b[i];
        sum += weight(b[i]) * d * d;
    }
    return sum / (double)count;
}

shape_status shape_imageerror_measure(const float *a, const float *b, int width, int height,
                                      shape_imageerror *result, shape_error *error)
{
    shape_status status = check_pictures(a, b, width, height, error);
    if (status)
        return status;
    size_t pixels = (size_t)width * (size_t)height, count = pixels * 3, worst = 0;
    shape_imageerror r = {0};
    double squares = 0;
    for (size_t i = 0; i < count; i++) {
        double d = (double)a[i] - b[i];
        squares += d * d;
        if (fabs(d) > r.largest) {
            r.largest = fabs(d);
            worst = i;
        }
        r.mean_a[i % 3] += (double)a[i] / (double)pixels;
        r.mean_b[i % 3] += (double)b[i] / (double)pixels;
    }
    r.rmse = sqrt(squares / (double)count);
    r.x = (int)(worst / 3 % (size_t)width);
    r.y = (int)(worst / 3 / (size_t)width);
    r.channel = (int)(worst % 3);
    r.relmse = relative_error(a, b, count, 1);
    r.exposure = best_exposure(a, b, count);
    r.exposed_relmse = relative_error(a, b, count, r.exposure);
    *result = r;
    return SHAPE_OK;
}

/* t in [0, 1] to a colour whose luminance rises all the way. */
static void heat_colour(double t, float rgb[3])
{
    static const float stops[5][3] = {
        {0, 0, 0}, {0.05f, 0.05f, 0.6f}, {0.8f, 0.05f, 0.1f}, {1, 0.75f, 0.05f}, {1, 1, 1}};
    int i = t >= 1 ? 3 : (int)(4 * t);
    float f = (float)(4 * t - i);
    for (int c = 0; c < 3; c++)
        rgb[c] = stops[i][c] * (1 - f) + stops[i + 1][c] * f;
}

shape_status shape_imageerror_map(const float *a, const float *b, int width, int height, double full,
                                  float *heat, shape_error *error)
{
    shape_status status = check_pictures(a, b, width, height, error);
    if (status)
        return status;
    if (!(full > 0 && isfinite(full)))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "full %g: must be above 0", full);
    size_t pixels = (size_t)width * (size_t)height;
    for (size_t i = 0; i < pixels; i++) {
        double e = sqrt(relative_error(a + 3 * i, b + 3 * i, 3, 1));
        double t = e > 0 ? 1 + log10(e / full) / 3 : 0;
        heat_colour(t < 0 ? 0 : t > 1 ? 1 : t, heat + 3 * i);
    }
    return SHAPE_OK;
}
