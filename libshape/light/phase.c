/* Phase functions: value, sampling and mean cosine. Henyey and Greenstein 1941; Rayleigh 3/(16 pi) (1 + cos^2)
 * (Páleník 2016 Eq. 2.4 prints 1 - cos^2, which is wrong); two lobes; the Mie fit of Jendersie and d'Eon 2023 for
 * water droplets of 5 to 50 micrometres: a mixture of Henyey-Greenstein and Draine 2003. Mirrored by
 * shaders/light/phase.glsl. */
#include "shape/phase.h"

#include <math.h>

static const float inverse_4pi = 0.0795774715459f;

/* 1 + g^2 - 2 g c, without the cancellation that eats it as |g| and |c| near 1; never 0. */
static float hg_base(float g, float c)
{
    float a = fabsf(g), gap = g < 0 ? 1 + c : 1 - c;
    return fmaxf((1 - a) * (1 - a) + 2 * a * fmaxf(gap, 0), 1e-20f);
}

float shape_phase_hg(float g, float cos_theta)
{
    float base = hg_base(g, cos_theta);
    return inverse_4pi * (1 - g) * (1 + g) / (base * sqrtf(base));
}

float shape_phase_hg_renormalised(float g, float cos_theta)
{
    float base = hg_base(g, cos_theta), forward = 1 - g;
    return forward * forward * forward / (base * sqrtf(base));
}

/* What the fit makes of a droplet's diameter [micrometre]: Jendersie and d'Eon 2023 Eq. 4 to 7. */
typedef struct mie_fit {
    float g_hg, g_draine, alpha, weight;
} mie_fit;

static mie_fit fit_mie(float d)
{
    mie_fit fit = {expf(-0.0990567f / (d - 1.67154f)), expf(-2.20679f / (d + 3.91029f) - 0.428934f),
                   expf(3.62489f - 8.29288f / (d + 5.52825f)),
                   expf(-0.599085f / (d - 0.641583f) - 0.665888f)};
    return fit;
}

static float draine(float g, float alpha, float c)
{
    return shape_phase_hg(g, c) * (1 + alpha * c * c) / (1 + alpha * (1 + 2 * g * g) / 3);
}

static float draine_mean_cosine(float g, float alpha)
{
    return g * (1 + alpha * (3 + 2 * g * g) / 5) / (1 + alpha * (1 + 2 * g * g) / 3);
}

float shape_phase(const shape_medium *medium, float c)
{
    switch (medium->phase) {
    case SHAPE_PHASE_HG:
        return shape_phase_hg(medium->g, c);
    case SHAPE_PHASE_ISOTROPIC:
        return inverse_4pi;
    case SHAPE_PHASE_RAYLEIGH:
        return 0.75f * inverse_4pi * (1 + c * c);
    case SHAPE_PHASE_MIE: {
        mie_fit fit = fit_mie(medium->droplet);
        return (1 - fit.weight) * shape_phase_hg(fit.g_hg, c) +
               fit.weight * draine(fit.g_draine, fit.alpha, c);
    }
    case SHAPE_PHASE_TWO_LOBE:
        return (1 - medium->lobe_mix) * shape_phase_hg(medium->g, c) +
               medium->lobe_mix * shape_phase_hg(medium->g2, c);
    }
    return inverse_4pi;
}

/* The inverse of the cumulative distribution, written so that nothing is divided by g. */
static double sample_hg(double g, double uniform)
{
    double s = 2 * uniform - 1, base = 1 + g * s;
    double c = (s * (1 + g * g) + g / 2 * (s * s * (1 + g * g) + 3 - g * g)) / fmax(base * base, 1e-30);
    return fmin(fmax(c, -1), 1);
}

/* c^3 + 3 c = 8 uniform - 4, by Cardano's formula. */
static double sample_rayleigh(double uniform)
{
    double a = 4 * uniform - 2, k = cbrt(fabs(a) + sqrt(a * a + 1));
    return copysign(k - 1 / k, a);
}

/* The integral of (1 + alpha c^2) base^(-3/2) over c as a function of s = sqrt(base) is, but for a factor and a
 * constant, K / s + 2 b q s - q s^3 / 3 with b = 1 + g^2, q = alpha / (4 g^2), K = 1 + q b^2. It falls as s grows. It is
 * inverted by Newton's steps, kept inside a bracket that shrinks; g > 0. */
static double sample_draine(double g, double alpha, double uniform)
{
    double b = 1 + g * g, q = alpha / (4 * g * g), k = 1 + q * b * b;
    double low = 1 - g, high = 1 + g;
    double first = k / high + 2 * b * q * high - q * high * high * high / 3;
    double last = k / low + 2 * b * q * low - q * low * low * low / 3;
    double wanted = first + uniform * (last - first), s = 1;
    for (int i = 0; i < 60 && high - low > 1e-12; i++) {
        double value = k / s + 2 * b * q * s - q * s * s * s / 3 - wanted;
        double slope = -k / (s * s) + 2 * b * q - q * s * s;
        if (value > 0)
            low = s;
        else
            high = s;
        double next = s - value / slope;
        if (fabs(next - s) < 1e-10)
            break;
        s = next > low && next < high ? next : (low + high) / 2;
    }
    return fmin(fmax((b - s * s) / (2 * g), -1), 1);
}

float shape_phase_sample(const shape_medium *medium, float uniform)
{
    double u = (double)uniform, weight, c = 2 * u - 1;
    switch (medium->phase) {
    case SHAPE_PHASE_HG:
        c = sample_hg((double)medium->g, u);
        break;
    case SHAPE_PHASE_ISOTROPIC:
        break;
    case SHAPE_PHASE_RAYLEIGH:
        c = sample_rayleigh(u);
        break;
    case SHAPE_PHASE_MIE: {
        mie_fit fit = fit_mie(medium->droplet);
        weight = (double)fit.weight;
        c = u < weight ? sample_draine((double)fit.g_draine, (double)fit.alpha, u / weight)
                       : sample_hg((double)fit.g_hg, (u - weight) / (1 - weight));
        break;
    }
    case SHAPE_PHASE_TWO_LOBE:
        weight = (double)medium->lobe_mix;
        c = u < weight ? sample_hg((double)medium->g2, u / weight)
                       : sample_hg((double)medium->g, (u - weight) / (1 - weight));
        break;
    }
    return (float)c;
}

float shape_phase_mean_cosine(const shape_medium *medium)
{
    switch (medium->phase) {
    case SHAPE_PHASE_HG:
        return medium->g;
    case SHAPE_PHASE_ISOTROPIC:
    case SHAPE_PHASE_RAYLEIGH:
        return 0;
    case SHAPE_PHASE_MIE: {
        mie_fit fit = fit_mie(medium->droplet);
        return (1 - fit.weight) * fit.g_hg + fit.weight * draine_mean_cosine(fit.g_draine, fit.alpha);
    }
    case SHAPE_PHASE_TWO_LOBE:
        return (1 - medium->lobe_mix) * medium->g + medium->lobe_mix * medium->g2;
    }
    return 0;
}
