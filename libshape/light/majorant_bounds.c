/* Bounds of the fields over a box: of the noise exactly, octave by octave, and of the spheroid's threshold. */
#include <math.h>

#include "light/majorant.h"

/* More than the roundings of a sum of octaves. */
static const float slack = 1e-5f;

float majorant_noise_mean(const shape_volume_cloud *cloud)
{
    int octaves = cloud->field.octaves;
    return 0.5f * (ldexpf(1, -octaves) - ldexpf(1, -octaves - cloud->mean_octaves));
}

/* The coordinates of [low, high] at which a piecewise linear function may have its extremes: the ends and the whole
 * numbers between. Returns how many, or 0 where there are too many. */
static int list_knots(double low, double high, double knots[8])
{
    int count = 0;
    if (!(high - low < 6))
        return 0;
    knots[count++] = low;
    for (double k = floor(low) + 1; k < high; k++)
        knots[count++] = k;
    knots[count++] = high;
    return count;
}

/* The range over a box of one octave (trilinear between whole numbers), 0 to 1. */
static void octave_range(const shape_volume_cloud *cloud, int octave, const double low[3],
                         const double high[3], float *least, float *most)
{
    double knots[3][8];
    int count[3];
    *least = 0, *most = 1;
    for (int a = 0; a < 3; a++) {
        count[a] = list_knots(low[a], high[a], knots[a]);
        if (!count[a] || !(fabs(low[a]) < 1e6))
            return;
    }
    /* Finer octaves weigh too little to be worth more looks. */
    if (count[0] * count[1] * count[2] > 64)
        return;
    *least = 1, *most = 0;
    for (int x = 0; x < count[0]; x++)
        for (int y = 0; y < count[1]; y++)
            for (int z = 0; z < count[2]; z++) {
                shape_vec3 q = {(float)knots[0][x], (float)knots[1][y], (float)knots[2][z]};
                float value = 2 * shape_noise_fbm(cloud->noise, &cloud->offsets[octave], 1, q);
                *least = fminf(*least, value);
                *most = fmaxf(*most, value);
            }
}

void majorant_noise_range(const shape_volume_cloud *cloud, const double middle[3], const double half[3],
                          float *low, float *high)
{
    double scale = (double)cloud->inverse_noise_scale, from[3], to[3];
    float weight = 0.5f;
    *low = majorant_noise_mean(cloud) - slack;
    *high = majorant_noise_mean(cloud) + slack;
    for (int i = 0; i < cloud->field.octaves; i++, scale *= 2, weight /= 2) {
        float least, most;
        for (int a = 0; a < 3; a++) {
            /* Points are rounded to floats before the noise sees them. */
            double room = half[a] * 1.0001 + 1e-6 * fabs(middle[a]);
            from[a] = (middle[a] - room) * scale;
            to[a] = (middle[a] + room) * scale;
        }
        octave_range(cloud, i, from, to, &least, &most);
        *low += weight * least;
        *high += weight * most;
    }
    *low = fmaxf(*low, 0);
}

static double gamma_of(double u, double kappa, double n)
{
    return exp(-u / fmax((1 - kappa) + 2 * kappa * n, 1e-6));
}

/* gamma grows with n, so iterating from above falls to the largest n with n = gamma and from below climbs to the
 * smallest; wherever it is stopped it is a bound. */
void majorant_threshold_tables(majorant_cloud *cloud)
{
    double kappa = (double)cloud->cloud->field.kappa;
    for (int i = 0; i <= MAJORANT_TABLE + 1; i++) {
        double u = (double)i / MAJORANT_TABLE, above = 1, below = 0;
        for (int k = 0; k < 200; k++) {
            above = gamma_of(u, kappa, above);
            below = gamma_of(u, kappa, below);
        }
        cloud->top[i] = (float)above + slack;
        cloud->bottom[i] = (float)below - slack;
    }
}
