/* What the window's thread, the drawing one and the reference's look at: sets, and what is opaque. */
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

/* --- what is opaque --- */

struct view_things {
    shape_opaque *opaque;
    atomic_int uses;
};

view_things *view_things_make(shape_opaque *opaque)
{
    view_things *things = malloc(sizeof *things);
    if (!things) {
        shape_opaque_destroy(opaque);
        return NULL;
    }
    things->opaque = opaque;
    atomic_init(&things->uses, 1);
    return things;
}

view_things *view_things_keep(view_things *things)
{
    if (things)
        atomic_fetch_add(&things->uses, 1);
    return things;
}

void view_things_drop(view_things *things)
{
    if (things && atomic_fetch_sub(&things->uses, 1) == 1) {
        shape_opaque_destroy(things->opaque);
        free(things);
    }
}

const shape_opaque *view_things_get(const view_things *things)
{
    return things ? things->opaque : NULL;
}
