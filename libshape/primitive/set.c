/* The primitive set: its clouds and lists, the box round them, what it checks of a whole set. */
#include "shape/set.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "primitive/list.h"
#include "primitive/names.h"
#include "shape/grid.h"

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

shape_status shape_set_add_grid(shape_set *set, const char *name, shape_grid *grid, const shape_frame *frame,
                                size_t *index, shape_error *error)
{
    size_t made;
    shape_status status = shape_set_add_cloud(set, name, &made, error);
    if (status) {
        shape_grid_release(grid);
        return status;
    }
    shape_cloud *cloud = &set->clouds[made];
    shape_primitives *list = shape_set_list(set, made);
    list->grid = grid;
    cloud->frame = *frame;
    cloud->field.model = SHAPE_MODEL_GRID;
    /* How fine the field is, for all that chooses steps by it: voxels, in steps of a quarter at the finest. */
    cloud->field.noise_scale = 4;
    cloud->field.octaves = 2;
    float half[3];
    for (int a = 0; a < 3; a++)
        half[a] = 0.5f * (float)(grid->points[a] - 1);
    shape_ellipsoid box = {.x = half[0],
                           .y = half[1],
                           .z = half[2],
                           .a = half[0],
                           .b = half[1],
                           .c = half[2],
                           .q = shape_quat_identity()};
    if (index)
        *index = made;
    return shape_primitives_add_ellipsoid(list, box, error);
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
            status = list_check_sphere(&list->spheres[i], error);
        for (size_t i = 0; i < list->ellipsoid_count && !status; i++) {
            const shape_quat *q = &list->ellipsoids[i].q;
            status = list_check_ellipsoid(&list->ellipsoids[i], error);
            float norm = q->x * q->x + q->y * q->y + q->z * q->z + q->w * q->w;
            if (!status && !(fabsf(norm - 1) <= 2e-3f))
                status =
                    shape_error_set(error, SHAPE_ERROR_FORMAT,
                                    "an ellipsoid's quaternion has length %g, not 1", (double)sqrtf(norm));
        }
    }
    return status;
}
