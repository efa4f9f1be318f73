/* A record of the LAYR chunk: the details of a cloud's field and its layer (docs/neph-format.md). */
#include "file/neph_layout.h"

/* The members of shape_detail, in the order of the file. */
static void list_details(const shape_detail *d, float values[7])
{
    const float all[7] = {d->smoothness, d->displace,     d->displace_scale, d->billow,
                          d->wisp,       d->detail_depth, d->detail_scale};
    memcpy(values, all, sizeof all);
}

bool neph_needs_layer(const shape_field *field)
{
    float details[7];
    list_details(&field->detail, details);
    for (int i = 0; i < 7; i++)
        if (details[i] != 0)
            return true;
    return field->model == SHAPE_MODEL_LAYER;
}

size_t neph_count_layers(const shape_set *set)
{
    size_t count = 0;
    for (size_t i = 0; i < set->cloud_count; i++)
        count += neph_needs_layer(&set->clouds[i].field);
    return count;
}

void neph_put_layer(unsigned char *to, uint32_t cloud, const shape_field *field)
{
    const shape_layer *l = &field->layer;
    float details[7];
    list_details(&field->detail, details);
    neph_put_u32(to + NEPH_LAYER_CLOUD, cloud);
    neph_put_floats(to + NEPH_LAYER_DETAIL, details, 7);
    if (field->model != SHAPE_MODEL_LAYER)
        return;
    const float fades[3] = {l->fade_bottom, l->fade_top, l->fade_side};
    neph_put_u32(to + NEPH_LAYER_BOUNDS, (uint32_t)l->bounds);
    neph_put_u32(to + NEPH_LAYER_NOISE, (uint32_t)l->noise);
    neph_put_u32(to + NEPH_LAYER_WORLEY_OCTAVES, (uint32_t)l->worley_octaves);
    neph_put_f32(to + NEPH_LAYER_BLEND, l->blend);
    neph_put_f32(to + NEPH_LAYER_GAIN, l->gain);
    neph_put_f32(to + NEPH_LAYER_WORLEY_GAIN, l->worley_gain);
    neph_put_f32(to + NEPH_LAYER_WORLEY_FREQUENCY, l->worley_frequency);
    neph_put_floats(to + NEPH_LAYER_STRETCH, l->stretch, 3);
    neph_put_f32(to + NEPH_LAYER_COVERAGE, l->coverage);
    neph_put_f32(to + NEPH_LAYER_CUT, l->cut);
    neph_put_floats(to + NEPH_LAYER_RAMP, l->ramp, 2);
    neph_put_f32(to + NEPH_LAYER_FALLOFF, l->falloff);
    neph_put_floats(to + NEPH_LAYER_FADES, fades, 3);
    neph_put_f32(to + NEPH_LAYER_PLANET_RADIUS, l->planet_radius);
}

void neph_get_layer(const unsigned char *from, shape_field *field)
{
    float d[7];
    neph_get_floats(d, from + NEPH_LAYER_DETAIL, 7);
    field->detail = (shape_detail){d[0], d[1], d[2], d[3], d[4], d[5], d[6]};
    if (field->model != SHAPE_MODEL_LAYER)
        return;
    field->layer = (shape_layer){.bounds = (shape_bounds)neph_get_small(from + NEPH_LAYER_BOUNDS),
                                 .noise = (shape_noise_kind)neph_get_small(from + NEPH_LAYER_NOISE),
                                 .worley_octaves = neph_get_small(from + NEPH_LAYER_WORLEY_OCTAVES),
                                 .blend = neph_get_f32(from + NEPH_LAYER_BLEND),
                                 .gain = neph_get_f32(from + NEPH_LAYER_GAIN),
                                 .worley_gain = neph_get_f32(from + NEPH_LAYER_WORLEY_GAIN),
                                 .worley_frequency = neph_get_f32(from + NEPH_LAYER_WORLEY_FREQUENCY),
                                 .coverage = neph_get_f32(from + NEPH_LAYER_COVERAGE),
                                 .cut = neph_get_f32(from + NEPH_LAYER_CUT),
                                 .falloff = neph_get_f32(from + NEPH_LAYER_FALLOFF),
                                 .fade_bottom = neph_get_f32(from + NEPH_LAYER_FADES),
                                 .fade_top = neph_get_f32(from + NEPH_LAYER_FADES + 4),
                                 .fade_side = neph_get_f32(from + NEPH_LAYER_FADES + 8),
                                 .planet_radius = neph_get_f32(from + NEPH_LAYER_PLANET_RADIUS)};
    neph_get_floats(field->layer.stretch, from + NEPH_LAYER_STRETCH, 3);
    neph_get_floats(field->layer.ramp, from + NEPH_LAYER_RAMP, 2);
}
