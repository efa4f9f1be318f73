/* Seeded random streams and reproducible elementary functions. The functions reduce their argument to a small
 * interval and sum a Taylor series there until it no longer changes a double; no table, no fused operation. */
#include "shape/random.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/random_inline.h"

uint64_t shape_hash(uint64_t value)
{
    return random_hash(value);
}

shape_random shape_random_seed(uint64_t seed, uint64_t stream)
{
    return random_seed(seed, stream);
}

uint32_t shape_random_u32(shape_random *random)
{
    return random_u32(random);
}

double shape_random_unit(shape_random *random)
{
    return random_unit(random);
}

double shape_random_range(shape_random *random, double low, double high)
{
    return random_range(random, low, high);
}

double shape_random_normal(shape_random *random)
{
    for (;;) {
        double u = 2 * shape_random_unit(random) - 1, v = 2 * shape_random_unit(random) - 1;
        double s = u * u + v * v;
        if (s > 0 && s < 1)
            return u * sqrt(-2 * shape_log(s) / s);
    }
}

/* 2^k for |k| <= 1022, by its bits. */
static double power_of_two(int k)
{
    uint64_t bits = (uint64_t)(k + 1023) << 52;
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* ln 2 in two parts, the first with 21 zero bits at its end, so that k times it is exact (Cody and Waite 1980). */
static const double ln2_high = 0x1.62e42feep-1, ln2_low = 0x1.a39ef35793c76p-33;

double shape_exp(double x)
{
    if (x != x)
        return x;
    if (x > 709.782712893384)
        return INFINITY;
    if (x < -745.2)
        return 0;
    double k = floor(x * 1.4426950408889634 + 0.5);
    double r = (x - k * ln2_high) - k * ln2_low; /* |r| <= 0.347 */
    double sum = 1;
    for (int n = 14; n > 0; n--) /* 0.347^15 / 15! < 2^-60 */
        sum = 1 + r * sum / n;
    int half = (int)k / 2;
    return sum * power_of_two(half) * power_of_two((int)k - half);
}

double shape_log(double x)
{
    if (x != x || x < 0)
        return NAN;
    if (x == 0)
        return -INFINITY;
    if (x > DBL_MAX)
        return x;
    int k = 0;
    if (x < DBL_MIN) {
        x *= 0x1p54;
        k = -54;
    }
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    k += (int)(bits >> 52) - 1023;
    bits = (bits & 0xfffffffffffffu) | 0x3ff0000000000000u;
    double m;
    memcpy(&m, &bits, sizeof m);
    if (m > 1.4142135623730951) {
        m /= 2;
        k++;
    }
    /* ln m = 2 artanh s with s = (m - 1) / (m + 1), |s| <= 0.1716; written f - s (f - R) to keep the last bits. */
    double f = m - 1, s = f / (m + 1), s2 = s * s, sum = 0;
    for (int n = 23; n >= 3; n -= 2) /* 0.1716^24 < 2^-60 */
        sum = s2 * (1.0 / n + sum);
    return k * ln2_high + (f - (s * (f - 2 * sum) - k * ln2_low));
}

/* c[0] + c[1] z + ... + c[7] z^7 as a tree (Estrin 1960), whose branches a processor works on at once. */
static inline double eight_terms(double z, const double c[8])
{
    double z2 = z * z, z4 = z2 * z2;
    return ((c[0] + c[1] * z) + (c[2] + c[3] * z) * z2) + ((c[4] + c[5] * z) + (c[6] + c[7] * z) * z2) * z4;
}

/* sin and cos of r + low, |r| <= pi/4, where low is what r lacks, below its last place: Taylor's series; the terms left
 * out are below 2^-60. */
static inline double sin_series(double r, double low)
{
    static const double c[8] = {
        -1.0 / 6,        1.0 / 120,        -1.0 / 5040,          1.0 / 362880,
        -1.0 / 39916800, 1.0 / 6227020800, -1.0 / 1307674368000, 1.0 / 355687428096000};
    double r2 = r * r;
    return r + (r * (r2 * eight_terms(r2, c)) + low * (1 - r2 / 2));
}

static inline double cos_series(double r, double low)
{
    static const double c[8] = {
        1.0 / 24,        -1.0 / 720,         1.0 / 40320,          -1.0 / 3628800,
        1.0 / 479001600, -1.0 / 87178291200, 1.0 / 20922789888000, -1.0 / 6402373705728000};
    double r2 = r * r, half = r2 / 2;
    return 1 - (half + (r * low - r2 * r2 * eight_terms(r2, c)));
}

/* floor for |x| < 2^62: a call of libm's takes longer than what it is needed for. */
static inline double whole(double x)
{
    double cut = (double)(int64_t)x;
    return cut > x ? cut - 1 : cut;
}

/* x modulo pi/2 in [-pi/4, pi/4], as a sum r + *low, and which quarter it was in. pi/2 in three parts (Cody and Waite);
 * the products with the first two are exact, and Knuth's sum keeps what their difference loses. */
static inline double reduce(double x, double *low, int *quarter)
{
    double k = whole(x * 0.6366197723675814 + 0.5);
    double a = x - k * 0x1.921fb544p0, b = k * 0x1.0b4611a6p-34;
    double r = a - b, part = r - a;
    double rest = ((a - (r - part)) - (b + part)) - k * 0x1.3198a2e037073p-69;
    double sum = r + rest;
    *low = (r - sum) + rest;
    *quarter = (int)((int64_t)k & 3);
    return sum;
}

void shape_sin_cos(double x, double *sine, double *cosine)
{
    if (!(fabs(x) < 1e9)) { /* NaN for infinity; a turn beyond 1e9 radians means nothing */
        *sine = x - x;
        *cosine = x - x == 0 ? 1 : x - x;
        return;
    }
    int quarter;
    double low, r = reduce(x, &low, &quarter), s = sin_series(r, low), c = cos_series(r, low);
    *sine = quarter & 1 ? c : s;
    *cosine = quarter & 1 ? s : c;
    *sine = quarter & 2 ? -*sine : *sine;
    *cosine = quarter == 1 || quarter == 2 ? -*cosine : *cosine;
}

double shape_sin(double x)
{
    double s, c;
    shape_sin_cos(x, &s, &c);
    return s;
}

double shape_cos(double x)
{
    double s, c;
    shape_sin_cos(x, &s, &c);
    return c;
}

double shape_pow(double x, double y)
{
    if (y == floor(y) && fabs(y) <= 64) {
        double result = 1, base = y < 0 ? 1 / x : x;
        for (int n = (int)fabs(y); n; n >>= 1, base *= base)
            if (n & 1)
                result *= base;
        return result;
    }
    if (x == 0)
        return y > 0 ? 0 : INFINITY;
    return shape_exp(y * shape_log(x));
}
