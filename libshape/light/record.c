/* A cloud's record for the shaders. What its texels hold stands in shape/record.h; shaders/field/cloud.glsl reads them. */
#include "shape/record.h"

#include <math.h>

#include "shape/beam.h"
#include "shape/phase.h"

static void put(float texel[4], double x, double y, double z, double w)
{
    texel[0] = (float)x, texel[1] = (float)y, texel[2] = (float)z, texel[3] = (float)w;
}

/* What details and layers add. */
static void fill_details(shape_record record, const shape_volume_cloud *c, const shape_record_places *places)
{
    const shape_detail *d = &c->field.detail;
    const shape_layer *l = &c->field.layer;
    put(record[24], 1, (double)places->shape_spheres, (double)places->shape_ellipsoids,
        (double)c->detail_tree->count);
    put(record[25], (double)places->shape_nodes, d->smoothness, d->displace, c->inverse_displace_scale);
    put(record[26], d->billow, d->wisp, c->inverse_detail_depth, c->inverse_detail_scale);
    put(record[27], c->base, c->inverse_height, 0, 0);
    for (int use = 0; use < 4; use++) {
        record[28 + use / 2][use % 2 * 2] = (float)(c->keys[use] & 0xffff);
        record[28 + use / 2][use % 2 * 2 + 1] = (float)(c->keys[use] >> 16);
    }
    put(record[30], l->bounds, l->noise, l->blend, l->gain);
    put(record[31], l->worley_gain, l->worley_frequency, l->worley_octaves, l->planet_radius);
    put(record[32], l->ramp[0], l->ramp[1], l->coverage, l->cut);
    put(record[33], l->falloff, l->fade_bottom, l->fade_top, l->fade_side);
    put(record[34], c->inverse_cell.x, c->inverse_cell.y, c->inverse_cell.z, 0);
}

void shape_record_fill(shape_record record, const shape_volume_cloud *c, const shape_record_places *places)
{
    double scale = cbrt(fabs(shape_frame_determinant(&c->frame)));
    float share, rest, mean = shape_phase_mean_cosine(&c->medium);
    shape_delta_scaling(mean, &share, &rest);
    put(record[3], c->box.min.x, c->box.min.y, c->box.min.z,
        (double)c->medium.extinction * (double)c->most); /* baked densities are in units of the largest */
    put(record[4], c->box.max.x, c->box.max.y, c->box.max.z, (double)places->nodes);
    put(record[5], c->field.kappa, c->field.octaves, c->inverse_noise_scale, c->field.model);
    put(record[6], (double)places->spheres, (double)places->ellipsoids, (double)c->tree->count, c->support);
    put(record[7], c->field.edge, (double)c->list->sphere_count, (double)c->list->ellipsoid_count,
        scale / (double)c->inverse_noise_scale);
    for (int octave = 0; octave < SHAPE_OCTAVES_MAX; octave++) {
        const int *o = c->offsets[octave];
        record[12 + octave / 4][octave % 4] =
            (float)(octave < c->field.octaves ? o[0] + 64 * o[1] + 4096 * o[2] : 0);
    }
    put(record[16], c->medium.albedo, c->medium.phase, c->medium.g, c->medium.g2);
    put(record[17], c->medium.lobe_mix, mean, share, rest);
    for (int i = 24; i < SHAPE_RECORD_TEXELS; i++)
        put(record[i], 0, 0, 0, 0);
    if (c->detailed)
        fill_details(record, c, places);
    const shape_beam_peak peak = shape_beam_peak_make(&c->medium);
    record[34][3] = peak.ahead;
    record[35][3] = fminf(peak.cap, 1e30f);
}

void shape_record_set_light(shape_record record, const shape_volume_cloud *cloud, const shape_lightgrid *grid,
                            const int place[3])
{
    static const int beginning[3];
    const int *first = place ? place : beginning;
    put(record[8], first[0], first[1], first[2], 0);
    put(record[9], grid->size[0], grid->size[1], grid->size[2], cloud->medium.droplet);
    put(record[10], grid->box.min.x, grid->box.min.y, grid->box.min.z, 0);
    put(record[11], grid->box.max.x, grid->box.max.y, grid->box.max.z, 0);
}

void shape_record_set_eye(shape_record record, const shape_volume_cloud *cloud, shape_dvec3 eye)
{
    shape_dvec3 local = shape_frame_point(&cloud->inverse, eye);
    for (int row = 0; row < 3; row++)
        put(record[row], cloud->inverse.m[row][0], cloud->inverse.m[row][1], cloud->inverse.m[row][2],
            (&local.x)[row]);
}
