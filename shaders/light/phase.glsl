// Phase functions, the mirror of libshape/light/phase.c. Values per steradian; kinds are those of shape_phase_kind.
// cos_theta is taken between the direction of travel before and after scattering.

const float phase_inverse_4pi = 0.0795774715459;

float phase_base(float g, float c)
{
    float a = abs(g), gap = g < 0.0 ? 1.0 + c : 1.0 - c;
    return max((1.0 - a) * (1.0 - a) + 2.0 * a * max(gap, 0.0), 1e-20);
}

// Henyey and Greenstein 1941.
float phase_hg(float g, float c)
{
    float base = phase_base(g, c);
    return phase_inverse_4pi * (1.0 - g) * (1.0 + g) / (base * sqrt(base));
}

// Draine 2003.
float phase_draine(float g, float alpha, float c)
{
    return phase_hg(g, c) * (1.0 + alpha * c * c) / (1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0);
}

// Jendersie and d'Eon 2023; d is the droplet's diameter in micrometres, 5 to 50.
float phase_mie(float d, float c)
{
    float g_hg = exp(-0.0990567 / (d - 1.67154));
    float g_draine = exp(-2.20679 / (d + 3.91029) - 0.428934);
    float alpha = exp(3.62489 - 8.29288 / (d + 5.52825));
    float weight = exp(-0.599085 / (d - 0.641583) - 0.665888);
    return (1.0 - weight) * phase_hg(g_hg, c) + weight * phase_draine(g_draine, alpha, c);
}

float phase_value(int kind, float g, float g2, float mix_, float droplet, float cos_theta)
{
    if (kind == 0)
        return phase_hg(g, cos_theta);
    if (kind == 2)
        return 0.75 * phase_inverse_4pi * (1.0 + cos_theta * cos_theta);
    if (kind == 3)
        return phase_mie(droplet, cos_theta);
    if (kind == 4)
        return (1.0 - mix_) * phase_hg(g, cos_theta) + mix_ * phase_hg(g2, cos_theta);
    return phase_inverse_4pi;
}
