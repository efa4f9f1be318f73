/* Appending sets, and changing lists that several clouds share (copy on write). */
#include "shape/combine.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "shape/grid.h"

static shape_status copy_list(shape_primitives *to, const shape_primitives *from, shape_error *error)
{
    shape_primitives copy = {0};
    shape_status status = shape_primitives_reserve(&copy, from->sphere_count, from->ellipsoid_count, error);
    if (status) {
        free(copy.spheres);
        return status;
    }
    if (from->sphere_count)
        memcpy(copy.spheres, from->spheres, from->sphere_count * sizeof *from->spheres);
    if (from->ellipsoid_count)
        memcpy(copy.ellipsoids, from->ellipsoids, from->ellipsoid_count * sizeof *from->ellipsoids);
    copy.sphere_count = from->sphere_count;
    copy.ellipsoid_count = from->ellipsoid_count;
    copy.grid = from->grid;
    shape_grid_keep(copy.grid);
    *to = copy;
    return SHAPE_OK;
}

/* Adds a copy of *from, which may be one of the set's own lists. */
static shape_status add_list(shape_set *set, const shape_primitives *from, shape_error *error)
{
    shape_primitives source = *from;
    shape_status status = shape_array_reserve((void **)&set->lists, &set->list_capacity, set->list_count + 1,
                                              sizeof *set->lists, error);
    if (!status)
        status = copy_list(&set->lists[set->list_count], &source, error);
    if (!status)
        set->list_count++;
    return status;
}

shape_status shape_set_append(shape_set *set, const shape_set *other, shape_error *error)
{
    uint32_t offset = (uint32_t)set->list_count;
    shape_status status = SHAPE_OK;
    for (size_t i = 0; i < other->list_count && !status; i++)
        status = add_list(set, &other->lists[i], error);
    for (size_t i = 0; i < other->cloud_count && !status; i++) {
        size_t index;
        status = shape_set_add_cloud(set, other->clouds[i].name, &index, error);
        if (status)
            break;
        set->list_count--; /* the empty one that came with the cloud; it owns nothing yet */
        shape_cloud *cloud = &set->clouds[index];
        shape_cloud copy = other->clouds[i];
        memcpy(copy.name, cloud->name, sizeof copy.name);
        copy.list += offset;
        *cloud = copy;
    }
    for (size_t i = 0; i < other->extra_count && !status; i++) {
        const shape_extra *extra = &other->extras[i];
        status =
            shape_set_add_extra(set, extra->type, extra->list + offset, extra->bytes, extra->size, error);
    }
    return status;
}

static void free_list(shape_primitives *list)
{
    free(list->spheres);
    free(list->ellipsoids);
    shape_grid_release(list->grid);
    memset(list, 0, sizeof *list);
}

/* Lets each list that lost all its clouds to changed copies be replaced by the first of these, so that list numbers
 * stay where they were, and drops what is unused. origin[l] is the list from which the changed list l was made. */
static void settle_lists(shape_set *set, const uint32_t *origin, size_t old_count, uint32_t *place,
                         size_t *uses)
{
    for (size_t i = 0; i < set->cloud_count; i++)
        uses[set->clouds[i].list]++;
    for (size_t l = 0; l < set->list_count; l++)
        place[l] = (uint32_t)l;
    for (size_t l = old_count; l < set->list_count; l++) {
        uint32_t old = origin[l];
        if (uses[old] || !uses[l])
            continue;
        free_list(&set->lists[old]);
        set->lists[old] = set->lists[l];
        memset(&set->lists[l], 0, sizeof set->lists[l]);
        place[l] = old;
        uses[old] = uses[l];
        uses[l] = 0;
    }
    size_t kept = old_count; /* lists of old are never dropped: an unknown chunk may speak of one */
    for (size_t l = old_count; l < set->list_count; l++) {
        if (place[l] != l)
            continue;
        set->lists[kept] = set->lists[l];
        place[l] = (uint32_t)kept++;
    }
    set->list_count = kept;
    for (size_t i = 0; i < set->cloud_count; i++)
        set->clouds[i].list = place[set->clouds[i].list];
}

/* One changed list: what it was made from, and by which parameters. */
typedef struct made_list {
    uint32_t from, list;
    size_t cloud; /* whose key */
} made_list;

typedef struct change_state {
    shape_set *set;
    const shape_list_change *change;
    made_list *made;
    size_t made_count;
    unsigned char *keys; /* one a cloud */
    uint32_t *origin, *place;
    size_t *uses;
    size_t old_count;
} change_state;

static shape_status change_cloud(change_state *state, size_t cloud, shape_error *error)
{
    shape_set *set = state->set;
    size_t key_size = state->change->key_size;
    unsigned char *key = state->keys + cloud * key_size;
    shape_status status = state->change->describe(set, cloud, key, state->change->context, error);
    if (status)
        return status;
    uint32_t from = set->clouds[cloud].list;
    for (size_t m = 0; m < state->made_count; m++) {
        const made_list *made = &state->made[m];
        if (made->from == from && !memcmp(state->keys + made->cloud * key_size, key, key_size)) {
            set->clouds[cloud].list = made->list;
            return SHAPE_OK;
        }
    }
    status = add_list(set, &set->lists[from], error);
    if (status)
        return status;
    made_list made = {from, (uint32_t)(set->list_count - 1), cloud};
    state->made[state->made_count++] = made;
    state->origin[made.list] = from;
    set->clouds[cloud].list = made.list;
    return state->change->apply(&set->lists[made.list], from, key, state->change->context, error);
}

shape_status shape_set_change_lists(shape_set *set, const bool *selected, const shape_list_change *change,
                                    shape_error *error)
{
    size_t clouds = set->cloud_count, most = set->list_count + clouds;
    if (!clouds)
        return SHAPE_OK;
    change_state state = {.set = set, .change = change, .old_count = set->list_count};
    state.made = malloc(clouds * sizeof *state.made);
    state.keys = malloc(clouds * (change->key_size ? change->key_size : 1));
    state.origin = malloc(most * sizeof *state.origin);
    state.place = malloc(most * sizeof *state.place);
    state.uses = calloc(most, sizeof *state.uses);
    shape_status status = SHAPE_OK;
    if (!state.made || !state.keys || !state.origin || !state.place || !state.uses)
        status = shape_error_memory(error);
    for (size_t i = 0; i < clouds && !status; i++)
        if (!selected || selected[i])
            status = change_cloud(&state, i, error);
    if (!status)
        settle_lists(set, state.origin, state.old_count, state.place, state.uses);
    free(state.made);
    free(state.keys);
    free(state.origin);
    free(state.place);
    free(state.uses);
    return status;
}
