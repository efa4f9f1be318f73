/* What follows from a cloud's settings and its primitives: supports, margins, its box, the size of its noise
 * (docs/fields.md). */
#include <math.h>
#include <stdlib.h>

#include "shape/set.h"

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
        double depth = sagitta(planet_radius, r, r); /* no fmax: gcc 12 for arm64 breaks down over it */
        most = depth > most ? depth : most;
    }
    for (size_t i = 0; i < list->ellipsoid_count; i++) {
        const shape_ellipsoid *e = &list->ellipsoids[i];
        double depth = sagitta(planet_radius, fmax((double)e->a, (double)e->c), (double)e->b);
        most = depth > most ? depth : most;
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

/* The value that would stand at `place` if all were sorted (Hoare 1961); reorders them. */
static float select_value(float *values, size_t count, size_t place)
{
    size_t low = 0, high = count - 1;
    while (low < high) {
        float pivot = values[low + (high - low) / 2]; /* NOLINT: all are filled */
        size_t i = low, j = high;
        for (;;) {
            while (values[i] < pivot) /* NOLINT: the pivot ends both loops */
                i++;
            while (pivot < values[j]) /* NOLINT */
                j--;
            if (i >= j)
                break;
            float swap = values[i];
            values[i++] = values[j];
            values[j--] = swap;
        }
        /* values[low..j] <= pivot <= values[j+1..high]; where both met on the pivot itself, j is its place. */
        if (place <= j)
            high = j;
        else
            low = j + 1;
    }
    return values[place];
}

shape_status shape_cloud_choose_noise_scale(shape_cloud *cloud, const shape_primitives *list,
                                            shape_error *error)
{
    if (cloud->field.noise_scale > 0)
        return SHAPE_OK;
    size_t count = shape_primitives_count(list);
    if (!count) {
        cloud->field.noise_scale = 0.2f;
        return SHAPE_OK;
    }
    float *radii = malloc(count * sizeof *radii);
    if (!radii)
        return shape_error_memory(error);
    for (size_t i = 0; i < list->sphere_count; i++)
        radii[i] = list->spheres[i].radius;
    for (size_t i = 0; i < list->ellipsoid_count; i++) {
        const shape_ellipsoid *e = &list->ellipsoids[i];
        radii[list->sphere_count + i] = (e->a + e->b + e->c) / 3;
    }
    cloud->field.noise_scale = select_value(radii, count, count / 2) / 5;
    free(radii);
    return SHAPE_OK;
}
