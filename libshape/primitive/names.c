/* The names of a set's clouds in a hash table with open addressing (FNV-1a), so that adding n clouds takes n steps and
 * not n^2. The table is grown behind the clouds' array: whoever fills that array himself need not know of it. */
#include "primitive/names.h"

#include <stdlib.h>
#include <string.h>

static size_t hash_of(const char *name)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (; *name; name++)
        hash = (hash ^ (unsigned char)*name) * 0x100000001b3u;
    return (size_t)(hash ^ hash >> 32);
}

/* The slot that holds the name, or the free one where it belongs. */
static size_t slot_of(const shape_set *set, const char *name)
{
    size_t mask = set->name_slot_count - 1, slot = hash_of(name) & mask;
    while (set->name_slots[slot] && strcmp(set->clouds[set->name_slots[slot] - 1].name, name))
        slot = (slot + 1) & mask;
    return slot;
}

shape_status shape_names_update(shape_set *set, shape_error *error)
{
    bool rebuild = set->named_count > set->cloud_count;
    size_t slots = set->name_slot_count;
    while (slots < 2 * set->cloud_count + 16) /* at most half of them full */
        slots = slots ? 2 * slots : 16;
    if (slots != set->name_slot_count || rebuild) {
        uint32_t *made = calloc(slots, sizeof *made);
        if (!made)
            return shape_error_memory(error);
        free(set->name_slots);
        set->name_slots = made;
        set->name_slot_count = slots;
        set->named_count = 0;
    }
    for (; set->named_count < set->cloud_count; set->named_count++)
        set->name_slots[slot_of(set, set->clouds[set->named_count].name)] = (uint32_t)set->named_count + 1;
    return SHAPE_OK;
}

bool shape_names_taken(const shape_set *set, const char *name)
{
    return set->name_slots[slot_of(set, name)] != 0;
}
