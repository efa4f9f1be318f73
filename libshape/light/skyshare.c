/* The sky in the directions of the ordinates. A clear day's is two to ten times as bright near the sun and the horizon
 * as across (light/sky.c), and below the horizon it fades from its haze to the ground; a forward scattering cloud shows
 * from which side its light came. */
#include <math.h>
#include <stdbool.h>

#include "light/ordinates.h"

/* Luminance (Rec. 709): the shape is taken from it, the colour from the mean. */
static float luminance(const shape_sky *sky, shape_vec3 direction)
{
    float rgb[3];
    shape_sky_radiance(sky, direction, rgb);
    return 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2];
}

/* The ordinate nearest to a direction of travel, of those that come from the same half of the sky; -1: none does. */
static int nearest(shape_vec3 travel, shape_vec3 up, bool from_above)
{
    float best = -2;
    int found = -1;
    for (int i = 0; i < ORDINATES_DIRECTIONS; i++) {
        float o[3];
        ordinates_direction(i, o);
        float near = o[0] * travel.x + o[1] * travel.y + o[2] * travel.z;
        if ((o[0] * up.x + o[1] * up.y + o[2] * up.z < 0) == from_above && near > best) {
            best = near;
            found = i;
        }
    }
    return found;
}

static shape_vec3 into_cloud(const shape_volume_cloud *cloud, shape_vec3 world)
{
    shape_dvec3 d = {(double)world.x, (double)world.y, (double)world.z};
    d = shape_dvec3_normalize(shape_frame_direction(&cloud->inverse, d));
    return shape_vec3_make((float)d.x, (float)d.y, (float)d.z);
}

static void share_half(const shape_sky *sky, const shape_volume_cloud *cloud, bool above,
                       float shares[ORDINATES_DIRECTIONS])
{
    enum { ROWS = 12, COLUMNS = 32 }; /* equal solid angles */
    float sum[ORDINATES_DIRECTIONS] = {0}, whole = 0;
    int count[ORDINATES_DIRECTIONS] = {0}, met = 0;
    const shape_vec3 up = into_cloud(cloud, shape_vec3_make(0, 1, 0));
    for (int i = 0; i < ROWS; i++)
        for (int j = 0; j < COLUMNS; j++) {
            float high = ((float)i + 0.5f) / ROWS, level = sqrtf(1 - high * high);
            float turn = ((float)j + 0.5f) * (6.2831853f / COLUMNS);
            shape_vec3 from = {level * sinf(turn), above ? high : -high, level * cosf(turn)};
            int to = nearest(shape_vec3_scale(into_cloud(cloud, from), -1), up, above);
            if (to >= 0) {
                sum[to] += luminance(sky, from);
                count[to]++;
            }
        }
    for (int i = 0; i < ORDINATES_DIRECTIONS; i++)
        if (count[i]) {
            sum[i] /= (float)count[i];
            whole += sum[i];
            met++;
        }
    /* The ordinates weigh alike: their mean is to be 1, so that the sky is as bright as its mean says. */
    for (int i = 0; i < ORDINATES_DIRECTIONS; i++)
        if (count[i] && whole > 0)
            shares[i] = sum[i] * (float)met / whole;
}

void ordinates_sky_shares(const shape_sky *sky, const shape_volume_cloud *cloud,
                          float shares[ORDINATES_DIRECTIONS])
{
    for (int i = 0; i < ORDINATES_DIRECTIONS; i++)
        shares[i] = 1;
    if (sky->kind != SHAPE_SKY_CLEAR)
        return;
    share_half(sky, cloud, true, shares);
    share_half(sky, cloud, false, shares);
}
