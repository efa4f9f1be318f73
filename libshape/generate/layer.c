/* Layers: the primitive that bounds one, and presets. Thicknesses and heights are those of the cloud atlas (WMO 2017);
 * extinctions follow from usual water contents and droplets of 10 micrometres' radius, 1.5 times the one over the other. */
#include "shape/layer.h"

shape_layer_options shape_layer_options_defaults(void)
{
    shape_layer_options options = {
        .layer = shape_layer_defaults(), .extent = {20, 6, 20}, .octaves = 5, .extinction = 2};
    options.layer.bounds = SHAPE_BOUNDS_BOX;
    options.layer.noise = SHAPE_NOISE_PERLIN_WORLEY;
    return options;
}

static void set_extent(shape_layer_options *options, double x, double y, double z, double base)
{
    options->extent[0] = x, options->extent[1] = y, options->extent[2] = z;
    options->base = base;
}

static void set_stretch(shape_layer *layer, float x, float y, float z)
{
    layer->stretch[0] = x, layer->stretch[1] = y, layer->stretch[2] = z;
}

static void make_stratus(shape_layer_options *options)
{
    shape_layer *l = &options->layer;
    set_extent(options, 3000, 200, 3000, 300);
    options->noise_scale = 150;
    options->extinction = 0.05;
    l->noise = SHAPE_NOISE_PERLIN;
    set_stretch(l, 2, 0.7f, 2);
    l->bounds = SHAPE_BOUNDS_ALTITUDES;
    l->gain = 1.5f;
    l->coverage = 0.75f;
    l->ramp[0] = 0.2f, l->ramp[1] = 0.8f;
    l->fade_bottom = 0.35f, l->fade_top = 0.5f, l->fade_side = 0.3f;
}

static void make_stratocumulus(shape_layer_options *options)
{
    shape_layer *l = &options->layer;
    set_extent(options, 4000, 400, 4000, 600);
    options->noise_scale = 350;
    options->extinction = 0.06;
    set_stretch(l, 1, 1, 2.2f);
    l->bounds = SHAPE_BOUNDS_ALTITUDES;
    l->blend = 0.5f;
    l->gain = 2.5f;
    l->worley_gain = 2.0f;
    l->coverage = 0.5f;
    l->ramp[0] = 0.3f, l->ramp[1] = 0.5f;
    l->fade_bottom = 0.15f, l->fade_top = 0.9f, l->fade_side = 0.3f;
}

static void make_fog(shape_layer_options *options)
{
    shape_layer *l = &options->layer;
    set_extent(options, 400, 30, 400, 0);
    options->noise_scale = 25;
    options->extinction = 0.04;
    l->noise = SHAPE_NOISE_PERLIN;
    set_stretch(l, 2, 0.6f, 2);
    l->bounds = SHAPE_BOUNDS_ALTITUDES;
    l->gain = 2.0f;
    l->coverage = 0.75f;
    l->ramp[0] = 0, l->ramp[1] = 1;
    l->fade_top = 1, l->fade_side = 0.3f;
}

shape_layer_options shape_layer_options_preset(shape_layer_preset preset)
{
    shape_layer_options options = shape_layer_options_defaults();
    switch (preset) {
    case SHAPE_LAYER_STRATUS:
        make_stratus(&options);
        break;
    case SHAPE_LAYER_STRATOCUMULUS:
        make_stratocumulus(&options);
        break;
    case SHAPE_LAYER_FOG:
        make_fog(&options);
        break;
    }
    return options;
}

static shape_status out_of_range(const char *what, double value, const char *range, shape_error *error)
{
    return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "%s is %g (it must be %s)", what, value, range);
}

/* The field that the options ask for, over what the cloud has. */
static shape_field make_field(const shape_layer_options *options, shape_field field)
{
    field.model = SHAPE_MODEL_LAYER;
    field.layer = options->layer;
    field.octaves = options->octaves;
    field.noise_scale = (float)options->noise_scale;
    field.layer.planet_radius = options->planet_radius > 0
                                    ? (float)(options->planet_radius + options->base + options->extent[1] / 2)
                                    : 0;
    return field;
}

shape_status shape_layer_options_check(const shape_layer_options *options, shape_error *error)
{
    for (int i = 0; i < 3; i++)
        if (!(options->extent[i] >= 1e-3 && options->extent[i] <= 1e8))
            return out_of_range("extent", options->extent[i], "0.001 to 1e8", error);
    if (!(options->base >= -1e8 && options->base <= 1e8))
        return out_of_range("base", options->base, "within +-1e8", error);
    if (!(options->planet_radius >= 0 && options->planet_radius <= 1e8))
        return out_of_range("planet-radius", options->planet_radius, "0 to 1e8", error);
    if (options->planet_radius > 0 && options->planet_radius + options->base < 0)
        return out_of_range("base", options->base, "above the planet's centre", error);
    if (!(options->extinction >= 0 && options->extinction <= 1e9))
        return out_of_range("extinction", options->extinction, "0 to 1e9", error);
    shape_field field = make_field(options, shape_field_defaults());
    return shape_field_check(&field, error);
}

shape_status shape_layer_make(const shape_layer_options *options, shape_cloud *cloud, shape_primitives *list,
                              shape_error *error)
{
    shape_status status = shape_layer_options_check(options, error);
    if (status)
        return status;
    const double *extent = options->extent;
    float y = (float)(options->base + extent[1] / 2);
    if (extent[0] == extent[1] && extent[1] == extent[2]) {
        shape_sphere sphere = {0, y, 0, (float)(extent[0] / 2)};
        status = shape_primitives_add_sphere(list, sphere, error);
    } else {
        shape_ellipsoid ellipsoid = {.y = y,
                                     .a = (float)(extent[0] / 2),
                                     .b = (float)(extent[1] / 2),
                                     .c = (float)(extent[2] / 2),
                                     .q = shape_quat_identity()};
        status = shape_primitives_add_ellipsoid(list, ellipsoid, error);
    }
    if (status)
        return status;
    cloud->field = make_field(options, cloud->field);
    cloud->medium.extinction = (float)options->extinction;
    return shape_cloud_choose_noise_scale(cloud, list, error);
}
