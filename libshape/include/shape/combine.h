/* Several sets made one, and changes to lists that clouds share. */
#ifndef SHAPE_COMBINE_H
#define SHAPE_COMBINE_H

#include "shape/set.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Adds another set's clouds, lists and unknown chunks behind those of `set`; what was shared in it stays shared. A
 * cloud whose name is taken gets a number behind it. `other`, which is another set than `set`, is not changed. Errors: memory; the set is then to be
 * destroyed. */
shape_status shape_set_append(shape_set *set, const shape_set *other, shape_error *error);

/* A change of lists: for each selected cloud `describe` writes the parameters of the change (key_size bytes, every
 * byte set) as they are for that cloud, and `apply` changes a list accordingly. */
typedef struct shape_list_change {
    size_t key_size;
    shape_status (*describe)(const shape_set *set, size_t cloud, void *key, void *context,
                             shape_error *error);
    shape_status (*apply)(shape_primitives *list, uint32_t number, const void *key, void *context,
                          shape_error *error);
    void *context;
} shape_list_change;

/* Applies a change to the lists of the clouds whose `selected` is true (NULL: all). Clouds that shared a list and have
 * equal keys share the changed one; a list that another cloud still uses as it was is copied first. `number` is the
 * list's as it was before. A list that nobody uses any more goes. Errors: memory, those of the functions; the set is
 * then to be destroyed. */
shape_status shape_set_change_lists(shape_set *set, const bool *selected, const shape_list_change *change,
                                    shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
