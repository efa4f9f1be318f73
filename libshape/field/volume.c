/* A set made ready to be looked at: supports, trees, noise (shape/volume.h). */
#include "shape/volume.h"

#include <stdlib.h>

#include "field/detail.h"
#include "shape/grid.h"

/* Points that have the same place here have the same supports. */
static bool same_supports(const shape_set *set, const shape_volume *volume, size_t i, size_t j)
{
    const shape_volume_cloud *a = &volume->clouds[i], *b = &volume->clouds[j];
    return set->clouds[i].list == set->clouds[j].list && a->support == b->support && a->margin == b->margin;
}

/* A list whose primitives, grown by the factor `support` alone, are those of `from` grown by factor and margin. */
static shape_status grow_list(const shape_primitives *from, float support, float margin, shape_primitives *to,
                              shape_error *error)
{
    shape_status status = shape_primitives_reserve(to, from->sphere_count, from->ellipsoid_count, error);
    for (size_t i = 0; i < from->sphere_count && !status; i++) {
        shape_sphere s = shape_sphere_grow(&from->spheres[i], support, margin);
        s.radius /= support;
        to->spheres[to->sphere_count++] = s;
    }
    for (size_t i = 0; i < from->ellipsoid_count && !status; i++) {
        shape_ellipsoid e = shape_ellipsoid_grow(&from->ellipsoids[i], support, margin);
        e.a /= support, e.b /= support, e.c /= support;
        to->ellipsoids[to->ellipsoid_count++] = e;
    }
    return status;
}

/* How many clouds before this one are looked at for something to share. */
enum { LOOK_BACK = 4096 };

/* The primitives of cloud i's supports. */
static shape_status find_list(const shape_set *set, shape_volume *volume, size_t i, shape_error *error)
{
    shape_volume_cloud *cloud = &volume->clouds[i];
    cloud->list = cloud->shape_list;
    if (!(cloud->margin > 0))
        return SHAPE_OK;
    for (size_t j = i; j-- > 0 && i - j < LOOK_BACK;)
        if (same_supports(set, volume, i, j)) {
            cloud->grown_index = volume->clouds[j].grown_index;
            cloud->list = volume->clouds[j].list;
            return SHAPE_OK;
        }
    cloud->grown_index = (uint32_t)volume->grown_count;
    shape_primitives *grown = &volume->grown[volume->grown_count++];
    cloud->list = grown;
    return grow_list(cloud->shape_list, cloud->support, cloud->margin, grown, error);
}

/* The tree of cloud i's supports: an earlier cloud's where they agree. */
static shape_status find_tree(const shape_set *set, shape_volume *volume, size_t i, shape_error *error)
{
    shape_volume_cloud *cloud = &volume->clouds[i];
    for (size_t j = i; j-- > 0 && i - j < LOOK_BACK;)
        if (same_supports(set, volume, i, j)) {
            cloud->tree_index = volume->clouds[j].tree_index;
            return SHAPE_OK;
        }
    cloud->tree_index = (uint32_t)volume->tree_count;
    return shape_tree_build(cloud->list, cloud->support, &volume->trees[volume->tree_count++], error);
}

/* The tree that a detailed density asks. */
static shape_status find_shape_tree(const shape_set *set, shape_volume *volume, size_t i, shape_error *error)
{
    shape_volume_cloud *cloud = &volume->clouds[i];
    float reach = detail_reach(&cloud->field, cloud->support);
    for (size_t j = i; j-- > 0 && i - j < LOOK_BACK;) {
        const shape_volume_cloud *other = &volume->clouds[j];
        if (other->detailed && set->clouds[i].list == set->clouds[j].list &&
            detail_reach(&other->field, other->support) == reach) {
            cloud->detail_tree_index = other->detail_tree_index;
            return SHAPE_OK;
        }
    }
    cloud->detail_tree_index = (uint32_t)volume->tree_count;
    return shape_tree_build(cloud->shape_list, reach, &volume->trees[volume->tree_count++], error);
}

static shape_status prepare(const shape_set *set, shape_volume *volume, size_t i, bool bare,
                            shape_error *error)
{
    shape_volume_cloud *cloud = &volume->clouds[i];
    cloud->frame = set->clouds[i].frame;
    cloud->field = set->clouds[i].field;
    cloud->medium = set->clouds[i].medium;
    cloud->shape_list = shape_set_list_const(set, i);
    bool grid = cloud->field.model == SHAPE_MODEL_GRID;
    if (grid != (cloud->shape_list->grid != NULL))
        return shape_error_set(
            error, SHAPE_ERROR_ARGUMENT,
            "cloud \"%s\" has the model grid without a voxel grid, or one with another model",
            set->clouds[i].name);
    if (grid && shape_detail_is_on(&cloud->field.detail))
        return shape_error_set(
            error, SHAPE_ERROR_ARGUMENT,
            "cloud \"%s\" has details with the model grid, whose density is its voxels' (set "
            "them to 0)",
            set->clouds[i].name);
    cloud->most = grid ? cloud->shape_list->grid->most * cloud->shape_list->grid->gain : 1;
    if (!shape_frame_invert(&cloud->frame, &cloud->inverse))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "cloud \"%s\" has a frame without an inverse",
                               set->clouds[i].name);
    cloud->noise = volume->noise;
    shape_noise_offsets(cloud->field.seed, cloud->field.octaves, cloud->offsets);
    cloud->inverse_noise_scale = cloud->field.noise_scale > 0 ? 1 / cloud->field.noise_scale : 1;
    cloud->support = shape_cloud_support(&set->clouds[i], cloud->shape_list);
    cloud->margin = shape_cloud_margin(&set->clouds[i], cloud->shape_list);
    cloud->box = shape_cloud_box(&set->clouds[i], cloud->shape_list);
    cloud->detailed = cloud->field.model == SHAPE_MODEL_LAYER || shape_detail_is_on(&cloud->field.detail);
    shape_status status = find_list(set, volume, i, error);
    if (!status && !bare)
        status = find_tree(set, volume, i, error);
    if (!status && cloud->detailed) {
        detail_prepare(cloud);
        status = find_shape_tree(set, volume, i, error);
    }
    return status;
}

static bool has_noise(const shape_set *set)
{
    for (size_t i = 0; i < set->cloud_count; i++)
        if (set->clouds[i].field.model != SHAPE_MODEL_UNIFORM ||
            shape_detail_is_on(&set->clouds[i].field.detail))
            return true;
    return false;
}

static shape_status create(const shape_set *set, bool bare, shape_volume **volume, shape_error *error)
{
    shape_volume *made = calloc(1, sizeof *made);
    if (!made)
        return shape_error_memory(error);
    made->clouds = calloc(set->cloud_count + 1, sizeof *made->clouds);
    made->trees = calloc(2 * set->cloud_count + 1, sizeof *made->trees);
    made->grown = calloc(set->cloud_count + 1, sizeof *made->grown);
    shape_status status = made->clouds && made->trees && made->grown ? SHAPE_OK : shape_error_memory(error);
    if (!status && !(bare && !has_noise(set)))
        status = shape_noise_create(&made->noise, error);
    for (size_t i = 0; i < set->cloud_count && !status; i++) {
        status = prepare(set, made, i, bare, error);
        made->cloud_count = i + 1;
    }
    for (size_t i = 0; i < made->cloud_count; i++) {
        made->clouds[i].tree = &made->trees[made->clouds[i].tree_index];
        if (made->clouds[i].detailed)
            made->clouds[i].detail_tree = &made->trees[made->clouds[i].detail_tree_index];
    }
    if (status) {
        shape_volume_destroy(made);
        return status;
    }
    *volume = made;
    return SHAPE_OK;
}

shape_status shape_volume_create(const shape_set *set, shape_volume **volume, shape_error *error)
{
    return create(set, false, volume, error);
}

shape_status shape_volume_create_bare(const shape_set *set, shape_volume **volume, shape_error *error)
{
    return create(set, true, volume, error);
}

void shape_volume_destroy(shape_volume *volume)
{
    if (!volume)
        return;
    for (size_t i = 0; i < volume->tree_count; i++)
        shape_tree_free(&volume->trees[i]);
    for (size_t i = 0; i < volume->grown_count; i++) {
        free(volume->grown[i].spheres);
        free(volume->grown[i].ellipsoids);
    }
    shape_noise_destroy(volume->noise);
    free(volume->grown);
    free(volume->trees);
    free(volume->clouds);
    free(volume);
}
