/* The sun's light that was scattered only within the phase function's peak, and what of it is scattered on towards the
 * eye: the delta scaling with the peak cut off (Potter 1970), and the peak spread round the sun by as many turns as
 * there were (Goudsmit and Saunderson 1940). With x the optical depth to the sun, p the phase function, r = min(p, cap)
 * and w f the share of extinction that is scattering within the peak, the source is
 *
 *   w (exp(-(1 - w f) x) r + exp(-x) (p - r) + (exp(-(1 - w f) x) - exp(-x)) f V)
 *
 * The first is all light that has not left the peak, the second what had not been scattered yet, the third what had. n
 * scatterings on the way are distributed as Poisson has it with mean w f x; V has the mean cosine m of the peak, to the
 * power of 1 and n, the mean of their number where it is not 0: that of von Mises and Fisher, k exp(k (cos - 1)) / (2
 * pi), with k = 1/2 - 1 / ((1 + n) log m), which is 1 / (1 - m^(1 + n)) but for terms of the first order. A light grid
 * as it is seen holds exp(-(1 - w f) x), and exp(-x) is a power of it. And what goes straight on near the eye. Mirrored
 * by shaders/light/beam.glsl. */
#include "shape/beam.h"

#include <math.h>

#include "shape/lightgrid.h"
#include "shape/phase.h"

shape_beam_peak shape_beam_peak_make(const shape_medium *medium)
{
    enum { POINTS = 256, HALVINGS = 30 };
    shape_beam_peak peak = {INFINITY, 1, shape_phase_mean_cosine(medium)};
    float value[POINTS], cosine[POINTS], weight[POINTS], sum = 0, low = 0, high = 0, share, rest;
    shape_delta_scaling(peak.rest, &share, &rest);
    if (share <= 0)
        return peak;
    for (int i = 0; i < POINTS; i++) {
        float u = ((float)i + 0.5f) / POINTS; /* most of them in the peak */
        cosine[i] = 1 - 2 * u * u * u * u;
        value[i] = shape_phase(medium, cosine[i]);
        weight[i] = u * u * u;
        sum += value[i] * weight[i];
        high = fmaxf(high, value[i]);
    }
    for (int k = 0; k < HALVINGS; k++) {
        float middle = 0.5f * (low + high), below = 0;
        for (int i = 0; i < POINTS; i++)
            below += fminf(value[i], middle) * weight[i];
        if (below < (1 - share) * sum)
            low = middle;
        else
            high = middle;
    }
    float above = 0, ahead = 0, left = 0, blunt = 0;
    for (int i = 0; i < POINTS; i++) {
        above += fmaxf(value[i] - high, 0) * weight[i];
        ahead += fmaxf(value[i] - high, 0) * weight[i] * cosine[i];
        left += fminf(value[i], high) * weight[i];
        blunt += fminf(value[i], high) * weight[i] * cosine[i];
    }
    peak.cap = high;
    /* Of two lobes the higher may look back; its light then counts as going on, widely. */
    peak.ahead = above > 0 ? fmaxf(ahead / above, 1e-3f) : 1;
    peak.rest = left > 0 ? blunt / left : rest;
    return peak;
}

shape_beam shape_beam_make(const shape_medium *medium, const shape_beam_peak *peak, float cosine)
{
    float rest, phase = shape_phase(medium, cosine);
    shape_beam beam = {.blunt = fminf(phase, peak->cap), .aside = -logf(peak->ahead), .cosine = cosine};
    beam.peak = phase - beam.blunt;
    shape_delta_scaling(shape_phase_mean_cosine(medium), &beam.share, &rest);
    return beam;
}

float shape_beam_source(const shape_beam *beam, float albedo, float seen, float straight)
{
    float source = beam->blunt * seen;
    if (beam->share > 0 && seen > 0) {
        const float inside = albedo * beam->share, turns = -logf(seen) * inside / fmaxf(1 - inside, 1e-5f);
        const float bare = expf(-turns); /* of what is seen, what has not been scattered */
        const float narrow = 0.5f + (1 - bare) / (beam->aside * (1 - bare + turns) + 1e-6f);
        const float spread = narrow * 0.159154943f * expf(narrow * (beam->cosine - 1));
        source += seen * (bare * beam->peak + (1 - bare) * (1 - straight) * beam->share * spread);
    }
    return albedo * source;
}

float shape_beam_straight(float cells2)
{
    return 1 / (1 + cells2 / 16);
}

float shape_beam_kept(const shape_beam *beam, float albedo, float cells2)
{
    /* A point's value is interpolated from middles whose squares are larger by a half in the mean: a sixth along each axis. */
    return 1 - albedo * beam->share * shape_beam_straight(cells2 + 0.5f);
}
