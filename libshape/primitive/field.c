/* The settings of a cloud's field: defaults, ranges, and the supports that follow from them (docs/fields.md). */
#include "shape/set.h"

#include <math.h>

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

/* --- supports --- */

float shape_cloud_support(const shape_cloud *cloud, const shape_primitives *list)
{
    const shape_field *field = &cloud->field;
    if (field->model == SHAPE_MODEL_METABALL)
        return sqrtf((float)shape_primitives_count(list));
    if (list->grid)
        return 1.7320508f; /* its one ellipsoid touches the box */
    if (field->model != SHAPE_MODEL_LAYER)
        return 1.0f + field->detail.smoothness;
    switch (field->layer.bounds) {
    case SHAPE_BOUNDS_SPHERE:
        break;
    case SHAPE_BOUNDS_BOX:
        return 1.7320508f;
    case SHAPE_BOUNDS_ALTITUDES:
        return 1.4142135f;
    }
    return 1.0f;
}

/* How far a shell of a planet dips below the flat slab of the same primitive, at the rim. */
static double sagitta(double planet_radius, double rim, double half_thickness)
{
    double radius = fmax(planet_radius - half_thickness, 0);
    return radius - sqrt(fmax(radius * radius - rim * rim, 0));
}

static double list_sagitta(const shape_primitives *list, double planet_radius)
{
    double most = 0;
    for (size_t i = 0; i < list->sphere_count; i++) {
        double r = (double)list->spheres[i].radius;
        most = fmax(most, sagitta(planet_radius, r, r));
    }
    for (size_t i = 0; i < list->ellipsoid_count; i++) {
        const shape_ellipsoid *e = &list->ellipsoids[i];
        most = fmax(most, sagitta(planet_radius, fmax((double)e->a, (double)e->c), (double)e->b));
    }
    return most;
}

float shape_cloud_margin(const shape_cloud *cloud, const shape_primitives *list)
{
    const shape_field *field = &cloud->field;
    float margin = field->detail.displace;
    if (field->model == SHAPE_MODEL_LAYER && field->layer.bounds == SHAPE_BOUNDS_ALTITUDES &&
        field->layer.planet_radius > 0)
        margin += (float)(1.0001 * list_sagitta(list, (double)field->layer.planet_radius));
    return margin;
}

shape_sphere shape_sphere_grow(const shape_sphere *sphere, float support, float margin)
{
    shape_sphere grown = *sphere;
    grown.radius = sphere->radius * support + margin;
    return grown;
}

shape_ellipsoid shape_ellipsoid_grow(const shape_ellipsoid *ellipsoid, float support, float margin)
{
    /* With s = sqrt(trace A^2 / trace M^2): (1 + 1/s) A^2 + (1 + s) M^2 holds the sum of both. */
    shape_ellipsoid grown = *ellipsoid;
    float a = ellipsoid->a * support, b = ellipsoid->b * support, c = ellipsoid->c * support;
    if (margin > 0) {
        float s = sqrtf((a * a + b * b + c * c) / (3 * margin * margin));
        float keep = 1 + 1 / s, add = (1 + s) * margin * margin;
        a = sqrtf(keep * a * a + add);
        b = sqrtf(keep * b * b + add);
        c = sqrtf(keep * c * c + add);
    }
    grown.a = a, grown.b = b, grown.c = c;
    return grown;
}

/* The box around what an ellipsoid bounds in a layer. A linear image's half extents: of the cube's, the sums of the rows'
 * magnitudes; of the cylinder's, that of its axis and the norm of the rest. */
static shape_box bounds_box(const shape_ellipsoid *e, shape_bounds bounds)
{
    if (bounds == SHAPE_BOUNDS_SPHERE)
        return shape_ellipsoid_box(e, 1);
    double m[3][3], half[3];
    shape_quat_matrix(e->q, m);
    for (int i = 0; i < 3; i++) {
        double x = fabs(m[i][0]) * (double)e->a, y = fabs(m[i][1]) * (double)e->b,
               z = fabs(m[i][2]) * (double)e->c;
        half[i] = y + (bounds == SHAPE_BOUNDS_BOX ? x + z : sqrt(x * x + z * z));
    }
    shape_box box = {{(float)(e->x - half[0]), (float)(e->y - half[1]), (float)(e->z - half[2])},
                     {(float)(e->x + half[0]), (float)(e->y + half[1]), (float)(e->z + half[2])}};
    return box;
}

/* The box of a list's spheres, each radius times `grow`; empty where there are none. */
static shape_box spheres_box(const shape_primitives *list, float grow)
{
    shape_box box = shape_box_empty();
    shape_vec3 low = box.min, high = box.max;
    for (size_t i = 0; i < list->sphere_count; i++) {
        const shape_sphere *s = &list->spheres[i];
        float r = s->radius * grow;
        low.x = s->x - r < low.x ? s->x - r : low.x;
        low.y = s->y - r < low.y ? s->y - r : low.y;
        low.z = s->z - r < low.z ? s->z - r : low.z;
        high.x = s->x + r > high.x ? s->x + r : high.x;
        high.y = s->y + r > high.y ? s->y + r : high.y;
        high.z = s->z + r > high.z ? s->z + r : high.z;
    }
    box.min = low;
    box.max = high;
    return box;
}

shape_box shape_cloud_box(const shape_cloud *cloud, const shape_primitives *list)
{
    bool grid = list->grid != NULL, layer = grid || cloud->field.model == SHAPE_MODEL_LAYER;
    shape_bounds bounds = grid ? SHAPE_BOUNDS_BOX : cloud->field.layer.bounds;
    float grow = layer ? 1 : shape_cloud_support(cloud, list), margin = shape_cloud_margin(cloud, list);
    shape_box box = spheres_box(list, grow);
    for (size_t i = 0; i < list->ellipsoid_count; i++) {
        const shape_ellipsoid *e = &list->ellipsoids[i];
        box = shape_box_join(box, layer ? bounds_box(e, bounds) : shape_ellipsoid_box(e, grow));
    }
    if (margin > 0 && !shape_box_is_empty(box)) {
        shape_vec3 by = {margin, margin, margin};
        box.min = shape_vec3_sub(box.min, by);
        box.max = shape_vec3_add(box.max, by);
    }
    return box;
}
