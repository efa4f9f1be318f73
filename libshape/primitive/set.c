/* The primitive set: storage, defaults, boxes. */
#include "shape/set.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "primitive/names.h"
#include "shape/grid.h"

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

static shape_status out_of_range(const char *what, double value, const char *range, shape_error *error)
{
    return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "%s is %g (it must be %s)", what, value, range);
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

shape_set *shape_set_create(shape_error *error)
{
    shape_set *set = calloc(1, sizeof *set);
    if (!set)
        shape_error_memory(error);
    return set;
}

void shape_set_destroy(shape_set *set)
{
    if (!set)
        return;
    for (size_t i = 0; i < set->list_count; i++) {
        free(set->lists[i].spheres);
        free(set->lists[i].ellipsoids);
        shape_grid_release(set->lists[i].grid);
    }
    for (size_t i = 0; i < set->extra_count; i++)
        free(set->extras[i].bytes);
    free(set->clouds);
    free(set->lists);
    free(set->extras);
    free(set->name_slots);
    free(set);
}

/* Copies wanted into name, cut at a whole UTF-8 character, with a number behind it where it is taken. */
static void choose_name(const shape_set *set, const char *wanted, char name[SHAPE_NAME_MAX + 1])
{
    enum { ROOM = SHAPE_NAME_MAX - 12 };
    size_t length = strlen(wanted);
    if (length > ROOM) {
        length = ROOM;
        while (length && ((unsigned char)wanted[length] & 0xc0) == 0x80)
            length--;
    }
    if (!length) {
        wanted = "cloud";
        length = strlen(wanted);
    }
    snprintf(name, SHAPE_NAME_MAX + 1, "%.*s", (int)length, wanted);
    for (size_t number = set->cloud_count ? set->cloud_count + 1 : 2; shape_names_taken(set, name); number++)
        snprintf(name, SHAPE_NAME_MAX + 1, "%.*s-%zu", (int)length, wanted, number);
}

/* Room for one cloud more, and a table of names to choose its own by. */
static shape_status reserve_cloud(shape_set *set, shape_error *error)
{
    shape_status status = shape_names_update(set, error);
    return status ? status
                  : shape_array_reserve((void **)&set->clouds, &set->cloud_capacity, set->cloud_count + 1,
                                        sizeof *set->clouds, error);
}

shape_status shape_set_add_cloud(shape_set *set, const char *name, size_t *index, shape_error *error)
{
    if (reserve_cloud(set, error) || shape_array_reserve((void **)&set->lists, &set->list_capacity,
                                                         set->list_count + 1, sizeof *set->lists, error))
        return SHAPE_ERROR_MEMORY;
    shape_cloud *cloud = &set->clouds[set->cloud_count];
    memset(cloud, 0, sizeof *cloud);
    memset(&set->lists[set->list_count], 0, sizeof *set->lists);
    choose_name(set, name, cloud->name);
    cloud->frame = shape_frame_identity();
    cloud->field = shape_field_defaults();
    cloud->medium = shape_medium_defaults();
    cloud->seed = 1;
    cloud->list = (uint32_t)set->list_count++;
    if (index)
        *index = set->cloud_count;
    set->cloud_count++;
    return SHAPE_OK;
}

shape_status shape_set_add_copy(shape_set *set, size_t of, const shape_frame *frame, size_t *index,
                                shape_error *error)
{
    if (of >= set->cloud_count)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "there is no cloud number %zu to copy", of);
    shape_frame placed = *frame; /* it may lie in the array that is about to move */
    if (reserve_cloud(set, error))
        return SHAPE_ERROR_MEMORY;
    shape_cloud *cloud = &set->clouds[set->cloud_count];
    *cloud = set->clouds[of];
    choose_name(set, set->clouds[of].name, cloud->name);
    cloud->frame = placed;
    if (index)
        *index = set->cloud_count;
    set->cloud_count++;
    return SHAPE_OK;
}

shape_status shape_set_add_extra(shape_set *set, const char type[4], uint32_t list, const void *bytes,
                                 size_t size, shape_error *error)
{
    unsigned char *copy = malloc(size ? size : 1);
    if (!copy)
        return shape_error_memory(error);
    if (shape_array_reserve((void **)&set->extras, &set->extra_capacity, set->extra_count + 1,
                            sizeof *set->extras, error)) {
        free(copy);
        return SHAPE_ERROR_MEMORY;
    }
    shape_extra *extra = &set->extras[set->extra_count++];
    memcpy(extra->type, type, 4);
    extra->list = list;
    extra->size = size;
    extra->bytes = copy;
    if (size)
        memcpy(copy, bytes, size);
    return SHAPE_OK;
}

shape_primitives *shape_set_list(shape_set *set, size_t cloud)
{
    return &set->lists[set->clouds[cloud].list];
}

const shape_primitives *shape_set_list_const(const shape_set *set, size_t cloud)
{
    return &set->lists[set->clouds[cloud].list];
}

static bool finite3(float x, float y, float z)
{
    return isfinite(x) && isfinite(y) && isfinite(z);
}

static bool positive(float x)
{
    return x > 0 && isfinite(x);
}

static shape_status check_sphere(const shape_sphere *s, shape_error *error)
{
    if (!finite3(s->x, s->y, s->z) || !positive(s->radius))
        return shape_error_set(
            error, SHAPE_ERROR_ARGUMENT,
            "a sphere has centre %g,%g,%g and radius %g (they must be finite, the radius above 0)",
            (double)s->x, (double)s->y, (double)s->z, (double)s->radius);
    return SHAPE_OK;
}

static shape_status check_ellipsoid(const shape_ellipsoid *e, shape_error *error)
{
    if (!finite3(e->x, e->y, e->z) || !positive(e->a) || !positive(e->b) || !positive(e->c) ||
        !finite3(e->q.x, e->q.y, e->q.z) || !isfinite(e->q.w))
        return shape_error_set(
            error, SHAPE_ERROR_ARGUMENT,
            "an ellipsoid has centre %g,%g,%g and semi-axes %g,%g,%g (they must be finite, the axes above 0)",
            (double)e->x, (double)e->y, (double)e->z, (double)e->a, (double)e->b, (double)e->c);
    return SHAPE_OK;
}

shape_status shape_primitives_reserve(shape_primitives *list, size_t spheres, size_t ellipsoids,
                                      shape_error *error)
{
    if (shape_array_reserve((void **)&list->spheres, &list->sphere_capacity, spheres, sizeof *list->spheres,
                            error))
        return SHAPE_ERROR_MEMORY;
    return shape_array_reserve((void **)&list->ellipsoids, &list->ellipsoid_capacity, ellipsoids,
                               sizeof *list->ellipsoids, error);
}

shape_status shape_primitives_add_sphere(shape_primitives *list, shape_sphere sphere, shape_error *error)
{
    shape_status status = check_sphere(&sphere, error);
    if (!status)
        status = shape_primitives_reserve(list, list->sphere_count + 1, 0, error);
    if (!status)
        list->spheres[list->sphere_count++] = sphere;
    return status;
}

shape_status shape_primitives_add_ellipsoid(shape_primitives *list, shape_ellipsoid ellipsoid,
                                            shape_error *error)
{
    shape_status status = check_ellipsoid(&ellipsoid, error);
    if (!status)
        status = shape_primitives_reserve(list, 0, list->ellipsoid_count + 1, error);
    if (status)
        return status;
    ellipsoid.q = shape_quat_normalize(ellipsoid.q);
    ellipsoid.pad0 = ellipsoid.pad1 = 0;
    list->ellipsoids[list->ellipsoid_count++] = ellipsoid;
    return SHAPE_OK;
}

size_t shape_primitives_count(const shape_primitives *list)
{
    return list->sphere_count + list->ellipsoid_count;
}

shape_box shape_sphere_box(const shape_sphere *s, float grow)
{
    float r = s->radius * grow;
    shape_box box = {{s->x - r, s->y - r, s->z - r}, {s->x + r, s->y + r, s->z + r}};
    return box;
}

shape_box shape_ellipsoid_box(const shape_ellipsoid *e, float grow)
{
    /* The support function of a linear image of the ball: half extents are the norms of the rows of R diag(a). */
    double m[3][3], half[3];
    shape_quat_matrix(e->q, m);
    for (int i = 0; i < 3; i++)
        half[i] = grow * sqrt(m[i][0] * m[i][0] * e->a * e->a + m[i][1] * m[i][1] * e->b * e->b +
                              m[i][2] * m[i][2] * e->c * e->c);
    shape_box box = {{(float)(e->x - half[0]), (float)(e->y - half[1]), (float)(e->z - half[2])},
                     {(float)(e->x + half[0]), (float)(e->y + half[1]), (float)(e->z + half[2])}};
    return box;
}

bool shape_set_cloud_bounds(const shape_set *set, size_t cloud, shape_dvec3 *min, shape_dvec3 *max)
{
    shape_box box = shape_cloud_box(&set->clouds[cloud], shape_set_list_const(set, cloud));
    if (shape_box_is_empty(box))
        return false;
    shape_frame_box(&set->clouds[cloud].frame, box, min, max);
    return true;
}

bool shape_set_bounds(const shape_set *set, shape_dvec3 *min, shape_dvec3 *max)
{
    bool any = false;
    for (size_t i = 0; i < set->cloud_count; i++) {
        shape_dvec3 a, b;
        if (!shape_set_cloud_bounds(set, i, &a, &b))
            continue;
        if (!any) {
            *min = a, *max = b;
            any = true;
        }
        *min = shape_dvec3_make(fmin(min->x, a.x), fmin(min->y, a.y), fmin(min->z, a.z));
        *max = shape_dvec3_make(fmax(max->x, b.x), fmax(max->y, b.y), fmax(max->z, b.z));
    }
    return any;
}

/* The value that would stand at `place` if all were sorted (Hoare 1961); reorders them. */
static float select_value(float *values, size_t count, size_t place)
{
    size_t low = 0, high = count - 1;
    while (low < high) {
        float pivot = values[low + (high - low) / 2];
        size_t i = low, j = high;
        for (;;) {
            while (values[i] < pivot)
                i++;
            while (pivot < values[j])
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

static shape_status check_cloud(const shape_set *set, const shape_cloud *cloud, shape_error *error)
{
    if (cloud->list >= set->list_count)
        return shape_error_set(error, SHAPE_ERROR_FORMAT, "cloud \"%s\" names list %u of %zu", cloud->name,
                               cloud->list, set->list_count);
    for (int i = 0; i < 12; i++)
        if (!isfinite(cloud->frame.m[i / 4][i % 4]))
            return shape_error_set(error, SHAPE_ERROR_FORMAT, "cloud \"%s\" has a frame that is not finite",
                                   cloud->name);
    shape_frame inverse;
    if (!shape_frame_invert(&cloud->frame, &inverse))
        return shape_error_set(error, SHAPE_ERROR_FORMAT,
                               "cloud \"%s\" has a frame without an inverse (a zero scale)", cloud->name);
    shape_status status = shape_field_check(&cloud->field, error);
    return status ? status : shape_medium_check(&cloud->medium, error);
}

static int compare_names(const void *a, const void *b)
{
    return strcmp((*(const shape_cloud *const *)a)->name, (*(const shape_cloud *const *)b)->name);
}

static shape_status check_names(const shape_set *set, shape_error *error)
{
    if (!set->cloud_count)
        return SHAPE_OK;
    const shape_cloud **sorted = malloc(set->cloud_count * sizeof *sorted);
    if (!sorted)
        return shape_error_memory(error);
    for (size_t i = 0; i < set->cloud_count; i++)
        sorted[i] = &set->clouds[i];
    qsort(sorted, set->cloud_count, sizeof *sorted, compare_names);
    shape_status status = SHAPE_OK;
    for (size_t i = 1; i < set->cloud_count && !status; i++)
        if (!strcmp(sorted[i - 1]->name, sorted[i]->name))
            status =
                shape_error_set(error, SHAPE_ERROR_FORMAT, "two clouds are called \"%s\"", sorted[i]->name);
    free(sorted);
    return status;
}

shape_status shape_set_check(const shape_set *set, shape_error *error)
{
    shape_status status = check_names(set, error);
    for (size_t i = 0; i < set->cloud_count && !status; i++)
        status = check_cloud(set, &set->clouds[i], error);
    for (size_t l = 0; l < set->list_count; l++) {
        const shape_primitives *list = &set->lists[l];
        for (size_t i = 0; i < list->sphere_count && !status; i++)
            status = check_sphere(&list->spheres[i], error);
        for (size_t i = 0; i < list->ellipsoid_count && !status; i++) {
            const shape_quat *q = &list->ellipsoids[i].q;
            status = check_ellipsoid(&list->ellipsoids[i], error);
            float norm = q->x * q->x + q->y * q->y + q->z * q->z + q->w * q->w;
            if (!status && !(fabsf(norm - 1) <= 2e-3f))
                status =
                    shape_error_set(error, SHAPE_ERROR_FORMAT,
                                    "an ellipsoid's quaternion has length %g, not 1", (double)sqrtf(norm));
        }
    }
    return status;
}
