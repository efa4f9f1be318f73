/* The sun's first scattering by the delta scaling with the peak cut off (Potter 1970): with x the optical depth to the sun, p the
 * phase function and r = min(p, cap) the source is w (exp(-x) (p - r) + exp(-(1 - w f) x) r). A light grid as it is seen holds
 * the second exponential, and the first is a power of it. And what goes straight on near the eye. Mirrored by
 * shaders/light/beam.glsl. */
#include "shape/beam.h"

#include <math.h>

#include "shape/lightgrid.h"
#include "shape/phase.h"

float shape_beam_cap(const shape_medium *medium)
{
    enum { POINTS = 256, HALVINGS = 30 };
    float value[POINTS], weight[POINTS], sum = 0, low = 0, high = 0, share, rest;
    shape_delta_scaling(shape_phase_mean_cosine(medium), &share, &rest);
    if (share <= 0)
        return INFINITY;
    for (int i = 0; i < POINTS; i++) {
        float u = ((float)i + 0.5f) / POINTS; /* cos = 1 - 2 u^4: most of them in the peak */
        value[i] = shape_phase(medium, 1 - 2 * u * u * u * u);
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
    return high;
}

shape_beam shape_beam_make(const shape_medium *medium, float cap, float cosine)
{
    float rest, phase = shape_phase(medium, cosine);
    shape_beam beam = {.blunt = fminf(phase, cap)};
    beam.peak = phase - beam.blunt;
    shape_delta_scaling(shape_phase_mean_cosine(medium), &beam.share, &rest);
    return beam;
}

float shape_beam_source(const shape_beam *beam, float albedo, float seen)
{
    float source = beam->blunt * seen;
    if (beam->peak > 0)
        source += beam->peak * powf(seen, 1 / fmaxf(1 - albedo * beam->share, 1e-5f));
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
