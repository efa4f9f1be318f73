/* A set that the window's thread and the drawing one look at. */
#include <stdatomic.h>
#include <stdlib.h>

#include "render.h"

struct view_shared {
    shape_set *set;
    atomic_int uses;
};

view_shared *view_shared_make(shape_set *set)
{
    view_shared *shared = malloc(sizeof *shared);
    if (!shared) {
        shape_set_destroy(set);
        return NULL;
    }
    shared->set = set;
    atomic_init(&shared->uses, 1);
    return shared;
}

view_shared *view_shared_keep(view_shared *shared)
{
    if (shared)
        atomic_fetch_add(&shared->uses, 1);
    return shared;
}

void view_shared_drop(view_shared *shared)
{
    if (shared && atomic_fetch_sub(&shared->uses, 1) == 1) {
        shape_set_destroy(shared->set);
        free(shared);
    }
}

const shape_set *view_shared_set(const view_shared *shared)
{
    return shared->set;
}
