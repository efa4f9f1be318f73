/* Non-local means of a path-traced picture, from the variance of its pixels (Buades et al. 2005; Rousselle, Knaus and
 * Zwicker 2012, section 4). */
#include "shape/denoise.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>

enum {
    WINDOW = 7, /* how far similar pixels are looked for */
    PATCH = 2   /* how far around two pixels their likeness is measured */
};

/* Differences below this share of the noise are likeness: the paper's k for strong noise is 0.45 with two buffers; in one
 * buffer a patch resembles its own noise, which a wider k makes up for. */
static const float strength = 0.7f;

typedef struct picture {
    const float *radiance, *raw; /* raw: the variance as it was estimated */
    float *variance;             /* smoothed */
    int width, height;
} picture;

static int clamp(int x, int last)
{
    return x < 0 ? 0 : x > last ? last : x;
}

static size_t offset_of(const picture *p, int x, int y)
{
    return 3 * ((size_t)clamp(y, p->height - 1) * (size_t)p->width + (size_t)clamp(x, p->width - 1));
}

/* The variance is itself estimated from few samples, and is 0 where chance ended every path in the dark, so each pixel
 * takes the mean of its 3x3 neighbours; but one that a bright path has made noisier than that keeps what it has. */
static void smooth_variance(const picture *p, const float *variance)
{
#pragma omp parallel for
    for (int y = 0; y < p->height; y++)
        for (int x = 0; x < p->width; x++)
            for (size_t c = 0; c < 3; c++) {
                float sum = 0;
                for (int j = -1; j <= 1; j++)
                    for (int i = -1; i <= 1; i++)
                        sum += variance[offset_of(p, x + i, y + j) + c];
                size_t at = offset_of(p, x, y) + c;
                p->variance[at] = fmaxf(sum / 9, variance[at]);
            }
}

/* How much two pixels differ beyond what their noise explains, in units of that noise; about 0 where they are alike
 * (Eq. 1 of Rousselle et al.). */
static float unlikeness(const picture *p, size_t a, size_t b)
{
    const float least = 1e-10f; /* keeps the quotient finite between pixels without noise */
    float sum = 0;
    for (size_t c = 0; c < 3; c++) {
        float d = p->radiance[a + c] - p->radiance[b + c];
        float va = p->variance[a + c], vb = p->variance[b + c], both = va + (vb < va ? vb : va);
        sum += (d * d - both) / (least + strength * strength * (va + vb));
    }
    return sum / 3;
}

/* Sums of row y's weights and weighted radiances for the neighbours at one offset; column: unlikeness summed over the
 * patch's height, one number a column and PATCH more at either side. */
static void add_offset(const picture *p, int y, int dx, int dy, float *column, float *sums)
{
    const float area = (2 * PATCH + 1) * (2 * PATCH + 1);
    if (y + dy < 0 || y + dy >= p->height)
        return;
    for (int x = -PATCH; x < p->width + PATCH; x++) {
        float sum = 0;
        for (int j = -PATCH; j <= PATCH; j++)
            sum += unlikeness(p, offset_of(p, x, y + j), offset_of(p, x + dx, y + dy + j));
        column[x + PATCH] = sum;
    }
    for (int x = 0; x < p->width; x++) {
        if (x + dx < 0 || x + dx >= p->width)
            continue;
        float sum = 0;
        for (int i = 0; i <= 2 * PATCH; i++)
            sum += column[x + i];
        float weight = expf(-fmaxf(sum / area, 0));
        const float *neighbour = p->radiance + offset_of(p, x + dx, y + dy);
        for (int c = 0; c < 3; c++)
            sums[4 * x + c] += weight * neighbour[c];
        sums[4 * x + 3] += weight;
    }
}

/* The variance that is usual about a pixel, channel c: the mean of its own and its eight neighbours', unless most of them
 * have next to none, as in the sky beside a cloud; then the middle one. */
static float usual_variance(const picture *p, int x, int y, size_t c)
{
    const float little =
        0.02f; /* of the mean: a cloud's middle one is more, however rare its bright paths are */
    float sorted[9] = {0}, sum = 0;
    int count = 0;
    for (int j = -1; j <= 1; j++)
        for (int i = -1; i <= 1; i++) {
            float v = p->raw[offset_of(p, x + i, y + j) + c];
            int k = count++;
            for (; k > 0 && sorted[k - 1] > v; k--)
                sorted[k] = sorted[k - 1];
            sorted[k] = v;
            sum += v;
        }
    return sorted[4] > little * sum / 9 ? sum / 9 : sorted[4];
}

/* A pixel moves no further than three standard deviations of its own: otherwise one bright path that strayed into the
 * sky, so noisy that the sky is like it, would leave a box as large as the window. Its own is what is usual about it, if
 * that is more: a pixel that chance left dark moves, one of the sky beside a cloud does not. */
static float bounded(const picture *p, int x, int y, size_t c, float value)
{
    size_t at = offset_of(p, x, y) + c;
    float most = 3 * sqrtf(fmaxf(p->raw[at], usual_variance(p, x, y, c))), own = p->radiance[at];
    return fminf(fmaxf(value, own - most), own + most);
}

/* One row of the result. scratch holds width + 2 PATCH and 4 width numbers. */
static void filter_row(const picture *p, int y, float *scratch, float *result)
{
    float *sums = scratch + p->width + 2 * PATCH;
    for (int i = 0; i < 4 * p->width; i++)
        sums[i] = 0;
    for (int dy = -WINDOW; dy <= WINDOW; dy++)
        for (int dx = -WINDOW; dx <= WINDOW; dx++)
            add_offset(p, y, dx, dy, scratch, sums);
    for (int x = 0; x < p->width; x++) {
        size_t at = offset_of(p, x, y);
        for (size_t c = 0; c < 3; c++) /* a pixel is like itself, so its weight is not 0 */
            result[at + c] = bounded(p, x, y, c, sums[4 * (size_t)x + c] / sums[4 * (size_t)x + 3]);
    }
}

static shape_status check(const float *radiance, const float *variance, int width, int height,
                          shape_error *error)
{
    if (width < 1 || height < 1)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "a picture of %dx%d pixels: each side must be at least 1", width, height);
    for (size_t i = 0; i < 3 * (size_t)width * (size_t)height; i++)
        if (!isfinite(radiance[i]) || !isfinite(variance[i]) || variance[i] < 0)
            return shape_error_set(
                error, SHAPE_ERROR_ARGUMENT,
                "radiance %g of variance %g at x %zu, y %zu (such pictures cannot be denoised)",
                (double)radiance[i], (double)variance[i], i / 3 % (size_t)width, i / 3 / (size_t)width);
    return SHAPE_OK;
}

/* All rows; false where a thread had no memory. */
static bool filter(const picture *p, float *result)
{
    int short_of_memory = 0;
#pragma omp parallel
    {
        float *scratch = malloc((5 * (size_t)p->width + 2 * PATCH) * sizeof *scratch);
#pragma omp for schedule(dynamic, 1)
        for (int y = 0; y < p->height; y++) {
            if (scratch) {
                filter_row(p, y, scratch, result);
                continue;
            }
#pragma omp atomic write
            short_of_memory = 1;
        }
        free(scratch);
    }
    return !short_of_memory;
}

shape_status shape_denoise(const float *radiance, const float *variance, int width, int height, float *result,
                           shape_error *error)
{
    shape_status status = check(radiance, variance, width, height, error);
    if (status)
        return status;
    picture p = {radiance, variance, malloc(3 * (size_t)width * (size_t)height * sizeof(float)), width,
                 height};
    if (!p.variance)
        return shape_error_memory(error);
    smooth_variance(&p, variance);
    bool done = filter(&p, result);
    free(p.variance);
    return done ? SHAPE_OK : shape_error_memory(error);
}
