/* The settings of a cloud's field and of its medium: defaults and ranges (docs/fields.md). */
#include "shape/set.h"

shape_layer shape_layer_defaults(void)
{
    shape_layer layer = {.bounds = SHAPE_BOUNDS_SPHERE,
                         .noise = SHAPE_NOISE_LATTICE,
                         .blend = 0.5f,
                         .gain = 1,
                         .worley_gain = 1,
                         .worley_frequency = 1,
                         .worley_octaves = 3,
                         .stretch = {1, 1, 1},
                         .coverage = 0.5f,
                         .ramp = {0.45f, 0.65f}};
    return layer;
}

shape_field shape_field_defaults(void)
{
    shape_field field = {.model = SHAPE_MODEL_SPHEROID,
                         .kappa = 0.5f,
                         .octaves = 5,
                         .noise_scale = 0,
                         .edge = 4.2f,
                         .seed = 1};
    field.layer = shape_layer_defaults();
    return field;
}

shape_medium shape_medium_defaults(void)
{
    shape_medium medium = {.extinction = 2,
                           .albedo = 1,
                           .phase = SHAPE_PHASE_HG,
                           .g = 0.85f,
                           .g2 = -0.3f,
                           .lobe_mix = 0.3f,
                           .droplet = 10};
    return medium;
}

bool shape_detail_is_on(const shape_detail *detail)
{
    return detail->smoothness > 0 || detail->displace > 0 || detail->billow > 0 || detail->wisp > 0;
}

/* --- ranges --- */

/* A member, its name and its range, low and high inclusive. */
typedef struct range {
    const char *name;
    float value, low, high;
    const char *text;
} range;

static shape_status check_ranges(const range *ranges, size_t count, shape_error *error)
{
    for (size_t i = 0; i < count; i++)
        if (!(ranges[i].value >= ranges[i].low && ranges[i].value <= ranges[i].high))
            return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "%s is %g (it must be %s)", ranges[i].name,
                                   (double)ranges[i].value, ranges[i].text);
    return SHAPE_OK;
}

#define COUNT(array) (sizeof(array) / sizeof *(array))

static shape_status check_detail(const shape_field *field, shape_error *error)
{
    const shape_detail *d = &field->detail;
    const range ranges[] = {{"smoothness", d->smoothness, 0, 1, "0 to 1"},
                            {"displace", d->displace, 0, 1e9f, "0 to 1e9"},
                            {"displace-scale", d->displace_scale, 0, 1e9f, "0 to 1e9"},
                            {"billow", d->billow, 0, 1, "0 to 1"},
                            {"wisp", d->wisp, 0, 1, "0 to 1"},
                            {"detail-depth", d->detail_depth, 0, 1, "0 to 1"},
                            {"detail-scale", d->detail_scale, 0, 1e9f, "0 to 1e9"}};
    shape_status status = check_ranges(ranges, COUNT(ranges), error);
    if (status)
        return status;
    bool layer = field->model == SHAPE_MODEL_LAYER, metaball = field->model == SHAPE_MODEL_METABALL;
    if (d->smoothness > 0 && (layer || metaball))
        return shape_error_set(
            error, SHAPE_ERROR_ARGUMENT,
            "smoothness is %g with the model %s, which has no union to smooth (set it to 0)",
            (double)d->smoothness, layer ? "layer" : "metaball");
    if ((d->billow > 0 || d->wisp > 0) && layer)
        return shape_error_set(
            error, SHAPE_ERROR_ARGUMENT,
            "billow or wisp is set with the model layer, which is all noise (set both to 0)");
    return SHAPE_OK;
}

static shape_status check_layer(const shape_layer *l, shape_error *error)
{
    const range ranges[] = {
        {"the layer's bounds", (float)l->bounds, 0, SHAPE_BOUNDS_ALTITUDES, "known ones"},
        {"the layer's noise", (float)l->noise, 0, SHAPE_NOISE_PERLIN_WORLEY, "a known one"},
        {"blend", l->blend, 0, 1, "0 to 1"},
        {"gain", l->gain, 0, 100, "0 to 100"},
        {"worley-gain", l->worley_gain, 0, 100, "0 to 100"},
        {"worley-frequency", l->worley_frequency, 1e-3f, 1e3f, "0.001 to 1000"},
        {"worley-octaves", (float)l->worley_octaves, 1, 8, "1 to 8"},
        {"stretch along x", l->stretch[0], 1e-3f, 1e3f, "0.001 to 1000"},
        {"stretch along y", l->stretch[1], 1e-3f, 1e3f, "0.001 to 1000"},
        {"stretch along z", l->stretch[2], 1e-3f, 1e3f, "0.001 to 1000"},
        {"coverage", l->coverage, 0, 1, "0 to 1"},
        {"cut", l->cut, 0, 0.999f, "0 to 0.999"},
        {"the ramp's A", l->ramp[0], 0, 1, "0 to 1"},
        {"the ramp's B", l->ramp[1], l->ramp[0], 1, "A to 1"},
        {"falloff", l->falloff, 0, 1, "0 to 1"},
        {"fade-bottom", l->fade_bottom, 0, 1, "0 to 1"},
        {"fade-top", l->fade_top, 0, 1, "0 to 1"},
        {"fade-side", l->fade_side, 0, 1, "0 to 1"},
        {"planet-radius", l->planet_radius, 0, 1e9f, "0 to 1e9"}};
    shape_status status = check_ranges(ranges, COUNT(ranges), error);
    if (!status && l->planet_radius > 0 && l->bounds != SHAPE_BOUNDS_ALTITUDES)
        return shape_error_set(
            error, SHAPE_ERROR_ARGUMENT,
            "planet-radius is %g without altitudes (only bounds of altitudes can be curved)",
            (double)l->planet_radius);
    return status;
}

shape_status shape_field_check(const shape_field *field, shape_error *error)
{
    if ((int)field->model < SHAPE_MODEL_UNIFORM || field->model > SHAPE_MODEL_GRID)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                               "the field model is %d (it must be a known model)", (int)field->model);
    if (field->octaves < 1 || field->octaves > 16)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "octaves is %d (it must be 1 to 16)",
                               field->octaves);
    const range ranges[] = {{"kappa", field->kappa, 0, 1, "0 to 1"},
                            {"noise-scale", field->noise_scale, 0, 1e9f, "above 0, at most 1e9"},
                            {"edge", field->edge, 0, 1e9f, "0 to 1e9"}};
    shape_status status = check_ranges(ranges, COUNT(ranges), error);
    if (!status)
        status = check_detail(field, error);
    if (!status && field->model == SHAPE_MODEL_LAYER)
        status = check_layer(&field->layer, error);
    return status;
}

static shape_status out_of_range(const char *what, double value, const char *allowed, shape_error *error)
{
    return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "%s is %g (it must be %s)", what, value, allowed);
}

shape_status shape_medium_check(const shape_medium *medium, shape_error *error)
{
    if (!(medium->extinction >= 0 && medium->extinction <= 1e9f))
        return out_of_range("extinction", medium->extinction, "0 to 1e9", error);
    if (!(medium->albedo >= 0 && medium->albedo <= 1))
        return out_of_range("albedo", medium->albedo, "0 to 1", error);
    if ((int)medium->phase < SHAPE_PHASE_HG || medium->phase > SHAPE_PHASE_TWO_LOBE)
        return out_of_range("the phase function", medium->phase, "a known one", error);
    if (!(medium->g > -1 && medium->g < 1))
        return out_of_range("g", medium->g, "above -1 and below 1", error);
    if (!(medium->g2 > -1 && medium->g2 < 1))
        return out_of_range("g2", medium->g2, "above -1 and below 1", error);
    if (!(medium->lobe_mix >= 0 && medium->lobe_mix <= 1))
        return out_of_range("lobe-mix", medium->lobe_mix, "0 to 1", error);
    if (!(medium->droplet >= 5 && medium->droplet <= 50))
        return out_of_range("droplet", medium->droplet, "5 to 50", error);
    return SHAPE_OK;
}
